"""Skins in a flow that is solved: it carries them, and they push it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Assembly, Flow, Membrane

KERNELS = "sceneql.skins.spline_kernels"
BY_MASS = "sceneql.skins.spline_by_mass_kernels"


def immerse(flow: Flow, skin: Membrane, peskin: bool, assembly: Assembly) -> None:
    """Add what the flow does to a skin, and the skin to it, by splines or Peskin's kernel."""
    box, kernels = assembly.floats([*flow.low, *flow.spacing]), KERNELS
    if flow.varying:
        from sceneql.flows.varying.fluid_layout import MASSES

        kernels, dense = BY_MASS, flow.varying[MASSES]
    else:
        dense = assembly.floats([flow.density])
    ints = (skin.count, skin.position_at, skin.force_at, box, dense, int(peskin), *flow.ints)
    assembly.term("velocity", f"{kernels}:carry", ints)
    assembly.term("close", f"{kernels}:push", ints)
