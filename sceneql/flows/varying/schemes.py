"""Preparation of steps of flows of several fluids (step_kernels.py), and their stability."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.flows.schemes.multistep import control
from sceneql.system import Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.island.system import System

UNSOLVED = "a value is no longer finite, or fluid crosses more than half a cell in a step: it is too long"
"""Message on a failed step."""


def stepper(order: int, step: float | None, tolerance: float = 0.0, largest: float | None = None) -> Stepper:
    """The stepper: steps of a fixed length [s], or adaptive ones by a tolerance up to ``largest`` [s]."""
    method = Method(
        step="sceneql.flows.varying.step_kernels:step", order=order, numbers=(order,), settings=(), last_stage=0
    )
    steps = control(step, tolerance, largest, UNSOLVED)
    return Stepper(method, steps, Needs(prepare="sceneql.flows.varying.schemes:prepare"))


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of step_kernels.step. Raises ScriptError for an island without such a flow."""
    import numpy as np

    from sceneql.flows.layout import FACES
    from sceneql.flows.varying.step_kernels import HEAD, SIZES
    from sceneql.quantities.diagnostic import Diagnostic, ScriptError

    flow = system.fields.flow
    if flow is None or not flow.varying:
        _, _, part, spans = system.ranges[0]
        message = f"this solver marches a flow of several fluids, and '{part}' has one density and viscosity"
        raise ScriptError([Diagnostic("no-flow", message, spans[0], "let auto march it")])
    tallies = {grid.at + int(np.prod(grid.cells.shape)) for grid in system.fields.grids}
    follow = {at for at, _ in system.following}
    blocks = [(at, end - at - (end - 1 in tallies)) for at, end, *_ in system.ranges if at not in follow]
    head = (*stepper.method.numbers, len(blocks), HEAD + 2 * len(blocks))
    settings = np.zeros(SIZES + len(blocks))
    settings[:SIZES] = -np.inf, -np.inf, 0.0, stepper.control.tolerance
    cells = int(np.prod(flow.cells.shape))
    return Prepared(
        settings=settings,
        numbers=np.array([*head, *np.ravel(blocks), *flow.varying], dtype=np.int64),
        work=4 * len(system.y) + 12 * flow.ints[FACES] + 2 * cells,
        text=f"mass takes momentum along, viscosity implicit by conjugate gradients, then a projection{flow.pressure}",
    )


def growth(order: int, decay: float, turn: float, step: float) -> float:
    """Growth factor of a step for y' = -decay y + i turn y, the first part implicit, the second explicit.

    For order 2 the smaller one of this and ``_swing``.
    """
    implicit, explicit = -step * decay, 1j * step * turn
    if order == 1:
        return abs((1.0 + explicit) / (1.0 - implicit))
    half = (1.0 + 0.5 * explicit + 0.25 * implicit) / (1.0 - 0.25 * implicit)
    grown = abs((1.0 + explicit * half + implicit / 3.0 * (1.0 + half)) / (1.0 - implicit / 3.0))
    return min(grown, _swing(decay, turn, step))


def _swing(decay: float, turn: float, step: float) -> float:
    """Growth factor of order 2 for x' = v, v' = -turn^2 x - decay v: skins and springs oscillating with the fluid."""
    z, d = (step * turn) ** 2, step * decay
    # v at the middle and the end and x at the end, as functions of x and step v at the start
    half_x, half_v = -0.5 * z / (1.0 + 0.25 * d), (1.0 - 0.25 * d - 0.25 * z) / (1.0 + 0.25 * d)
    end_x = (-z - d / 3.0 * half_x) / (1.0 + d / 3.0)
    end_v = (1.0 - 0.5 * z - d / 3.0 * (1.0 + half_v)) / (1.0 + d / 3.0)
    middle = 0.5 * (1.0 + half_x + end_v)
    product = (1.0 + half_x) * end_v - half_v * end_x
    apart = middle * middle - product
    return float(product**0.5 if apart < 0.0 else abs(middle) + apart**0.5)
