"""Masses in a flow that is solved: it carries them, they push it, and their inertia is part of its."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.skins import immersed_layout as layout

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, Flow

KERNELS = "sceneql.skins.immersed_kernels"
LADEN = "sceneql.skins.laden_kernels"


def immerse_masses(flow: Flow, bodies: Bodies, peskin: bool, assembly: Assembly) -> None:
    """Add what the flow does to masses, and the masses to it, by splines or Peskin's kernel."""
    from sceneql.flows.varying import fluid_layout

    assert bodies.immersed is not None
    own = flow.varying or flow.ints
    own_flow = layout.HEAD + (fluid_layout.HEAD if flow.varying else 0)
    ints = (
        *(bodies.position_at, bodies.velocity_at, bodies.count, bodies.inverse_at, bodies.immersed.force_at),
        *(bodies.excess_at, assembly.floats([*flow.low, *flow.spacing]), assembly.floats([flow.density])),
        *(int(peskin), own_flow, *own),
    )
    if flow.varying:
        assembly.term("velocity", f"{LADEN}:add", ints)
    assembly.term("velocity", f"{KERNELS}:carry", ints)
    if flow.varying:
        assembly.term("close", f"{LADEN}:bring", ints)
    assembly.term("close", f"{LADEN if flow.varying else KERNELS}:push", ints)
    assembly.after_step(f"{KERNELS}:settle", ints, samples=True)
