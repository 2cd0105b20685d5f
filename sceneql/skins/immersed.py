"""Terms of skins in a solved flow: the flow moves them, and their forces act on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Assembly, Flow, Membrane

KERNELS = "sceneql.skins.spline_kernels"
BY_MASS = "sceneql.skins.spline_by_mass_kernels"


def immerse(flow: Flow, skin: Membrane, peskin: bool, assembly: Assembly) -> None:
    """Add the terms by which the flow moves a skin and the skin's forces act on the flow.

    ``peskin``: whether Peskin's kernel interpolates and spreads, instead of splines.
    """
    box, kernels, mode = assembly.floats([*flow.low, *flow.spacing]), KERNELS, -1
    if flow.varying:
        from sceneql.flows.varying.fluid_layout import MASSES, MODE

        kernels, dense, mode = BY_MASS, flow.varying[MASSES], flow.varying[MODE]
    else:
        dense = assembly.floats([flow.density])
    ints = (skin.count, skin.position_at, skin.force_at, box, dense, int(peskin), mode, *flow.ints)
    assembly.term("velocity", f"{kernels}:carry", ints)
    assembly.term("close", f"{kernels}:push", ints, stiff=not flow.varying)
