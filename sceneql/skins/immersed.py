"""Skins in a flow that is solved: it carries them, and they push it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Assembly, Flow, Membrane

KERNELS = "sceneql.skins.spline_kernels"


def immerse(flow: Flow, skin: Membrane, assembly: Assembly) -> None:
    """Add what the flow does to a skin, and the skin to it."""
    box, density = assembly.floats([*flow.low, *flow.spacing]), assembly.floats([flow.density])
    ints = (skin.count, skin.position_at, skin.force_at, box, density, *flow.ints)
    assembly.term("velocity", f"{KERNELS}:carry", ints)
    assembly.term("close", f"{KERNELS}:push", ints)
