"""The additive (implicit-explicit) Runge-Kutta pair of order 3(2) for flows, and the preparation of its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.flows.schemes.multistep import UNSOLVED, control
from sceneql.system import Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.island.system import System

_D = 1767732205903 / 4055673282236
NODES = (0.0, 1767732205903 / 2027836641118, 3 / 5, 1.0)
WEIGHTS = (1471266399579 / 7840856788654, -4482444167858 / 7529755066697, 11266239266428 / 11593286722821, _D)
EMBEDDED = (
    2756255671327 / 12835298489170,
    -10771552573575 / 22201958757719,
    9247589265047 / 10645013368117,
    2193209047091 / 5459859503100,
)
EXPLICIT = (
    (0.0, 0.0, 0.0, 0.0),
    (1767732205903 / 2027836641118, 0.0, 0.0, 0.0),
    (5535828885825 / 10492691773637, 788022342437 / 10882634858940, 0.0, 0.0),
    (6485989280629 / 16251701735622, -4246266847089 / 9704473918619, 10755448449292 / 10357097424841, 0.0),
)
IMPLICIT = (
    (0.0, 0.0, 0.0, 0.0),
    (_D, _D, 0.0, 0.0),
    (2746238789719 / 10658868560708, -640167445237 / 6845629431997, _D, 0.0),
    WEIGHTS,
)
"""ARK3(2)4L[2]SA (Kennedy & Carpenter 2003, Appl. Numer. Math. 44, 139-181)."""


FIXED = 1e-6
"""Tolerance of the linear solves in steps of fixed length."""


def stepper(tolerance: float, step: float | None, largest: float | None) -> Stepper:
    """The stepper: adaptive steps by a tolerance up to ``largest`` [s], or steps of a fixed length [s]."""
    tableau = (
        *(one for row in EXPLICIT for one in row),
        *(one for row in IMPLICIT for one in row),
        *WEIGHTS,
        *(b - c for b, c in zip(WEIGHTS, EMBEDDED, strict=True)),
        *NODES,
        tolerance if step is None else FIXED,
    )
    method = Method(
        step="sceneql.flows.schemes.additive_kernels:step",
        order=3,
        dense="sceneql.flows.schemes.additive_kernels:dense",
        numbers=(len(NODES),),
        settings=tableau,
        last_stage=0,
    )
    steps = control(step, tolerance, largest, UNSOLVED)
    return Stepper(method, steps, Needs(prepare="sceneql.flows.schemes.additive:prepare"))


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of additive_kernels.step. Raises ScriptError for an island without a flow."""
    import numpy as np

    from sceneql.flows.schemes.additive_kernels import HEAD
    from sceneql.flows.schemes.multistep import operators_of
    from sceneql.flows.schemes.operator_layout import OPERATOR

    flow, operators, velocities, tables, text = operators_of(system)
    tallies = {grid.at + int(np.prod(grid.cells.shape)) for grid in system.fields.grids}
    blocks = [(first, last - first - (last - 1 in tallies)) for first, last, *_ in system.ranges]
    (stages,) = stepper.method.numbers
    tables_at = len(stepper.method.settings) + len(blocks) + 2
    head = (stages, HEAD + OPERATOR * len(operators) + 2 * len(blocks), len(blocks), velocities, len(operators))
    return Prepared(
        settings=np.array([*stepper.method.settings, *[0.0] * len(blocks), 0.0, -np.inf, *tables.numbers]),
        numbers=np.array([*head, tables_at, *np.ravel(operators), *np.ravel(blocks), *flow.ints], dtype=np.int64),
        work=(13 + 2 * stages) * len(system.y),
        text=text,
    )


def growth(decay: complex, turn: float, step: float) -> float:
    """Growth factor of a step for y' = -decay y + i turn y, the first part implicit, the second explicit."""
    implicit, explicit = -step * decay, 1j * step * turn
    stages: list[complex] = []
    for e, d in zip(EXPLICIT, IMPLICIT, strict=True):
        known = sum((explicit * a + implicit * b) * y for a, b, y in zip(e, d, stages, strict=False))
        stages.append((1.0 + known) / (1.0 - implicit * d[len(stages)]))
    beyond = explicit * sum((b - e) * y for b, e, y in zip(WEIGHTS, EXPLICIT[-1], stages, strict=True))
    fast = implicit * IMPLICIT[-1][-1] / (1.0 - implicit * IMPLICIT[-1][-1])
    return abs(stages[-1] + (1.0 - fast * fast) * beyond)
