"""Terms of masses in a solved flow: it moves them, their forces act on it, and their inertia adds to its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows import layout as faces
from sceneql.flows.varying import fluid_layout
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.skins import immersed_layout as layout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Assembly, Bodies, Flow

UPDATES = 40
"""Power iterations for the fastest mode: its rate is then known to a few percent."""
KERNELS = "sceneql.skins.immersed_kernels"
LADEN = "sceneql.skins.laden_kernels"


def immerse_masses(flow: Flow, bodies: Bodies, peskin: bool, assembly: Assembly) -> None:
    """Add the terms between masses and the flow, by splines or Peskin's kernel.

    Raises ScriptError for Peskin's kernel in a flow of varying density.
    """
    assert bodies.immersed is not None
    if flow.varying and peskin:
        text = "Peskin's kernel is here to compare, in flows of one density and viscosity"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), "leave `kernel` out")])
    own = flow.varying or flow.ints
    own_flow = layout.HEAD + (fluid_layout.HEAD if flow.varying else 0)
    ints = (
        *(bodies.position_at, bodies.velocity_at, bodies.count, bodies.inverse_at, bodies.immersed.points.force_at),
        *(bodies.immersed.excess_at, assembly.floats([*flow.low, *flow.spacing]), assembly.floats([flow.density])),
        *(int(peskin), own_flow, *own),
    )
    if flow.varying:
        assembly.term("velocity", f"{LADEN}:add", ints)
    assembly.term("velocity", f"{KERNELS}:carry", ints)
    if flow.varying:
        assembly.term("close", f"{LADEN}:bring", ints)
    assembly.term("close", f"{LADEN if flow.varying else KERNELS}:push", ints)
    assembly.term("constrain", f"{KERNELS}:accelerate", ints)
    assembly.after_step(f"{KERNELS}:settle", ints, samples=True)
    if flow.varying:
        at = flow.varying[fluid_layout.FASTEST]
        assembly.write(at, np.array([max(fastest(flow, bodies, ints, assembly), *assembly.numbers(at, at + 1))]))


def fastest(flow: Flow, bodies: Bodies, ints: Sequence[int], assembly: Assembly) -> float:
    """Largest rate [1/s] at which springs swing or damp masses, in the flow as if its fluid were compressible.

    Power iteration (von Mises & Pollaczek-Geiringer 1929). The pressure, left out here, makes no mode faster.
    """
    from sceneql.skins.swing_kernels import give_way

    if bodies.springs is None or not len(bodies.springs.ends):
        return 0.0
    y, floats, head = assembly.start(), assembly.numbers(), np.array(ints, dtype=np.int64)
    points = y[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3)
    a, b = bodies.springs.ends.T
    ways = points[b] - points[a]
    lengths = np.linalg.norm(ways, axis=1)
    ways /= np.where(lengths > 0.0, lengths, 1.0)[:, None]
    room = [np.zeros(flow.ints[faces.FACES]) for _ in range(2)]
    out, rates = np.zeros(3 * bodies.count), [0.0, 0.0]
    for k, strength in enumerate(bodies.springs.strength):
        x = np.random.default_rng(0).standard_normal((bodies.count, 3))
        for _ in range(UPDATES if strength.any() else 0):
            pulls = (strength * ((x[b] - x[a]) * ways).sum(axis=1))[:, None] * ways
            newtons = np.zeros_like(x)
            np.add.at(newtons, a, pulls)
            np.add.at(newtons, b, -pulls)
            give_way(newtons.ravel(), out, *room, y, floats, head)
            length = np.linalg.norm(out)
            if not 0.0 < length < np.inf:
                break
            rates[k] = float(length / np.linalg.norm(x))
            x = -out.reshape(-1, 3) / length
    return float(max(rates[0] ** 0.5, rates[1]))
