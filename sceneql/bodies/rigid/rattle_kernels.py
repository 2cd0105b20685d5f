# mypy: ignore-errors
"""Drifts of splittings that end where ties hold: the kicks before them get impulses along the ties where they began.

With the velocities closed behind the step (tie_settle_kernels) this is RATTLE (Andersen 1983, J. Comput. Phys. 52,
24-34), symplectic and reversible in time where forces depend on the places alone.
"""

from sceneql.bodies.rigid.ties.tie_kernels import survey
from sceneql.bodies.rigid.ties.tie_layout import KEPT, KEPT_AT, MOVED_AT, MOVERS_AT, RIGHT_AT, ROWS, ROWS_AT
from sceneql.bodies.rigid.ties.tie_matrix_kernels import factor, solve
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_C,
    AT_J,
    AT_MASS,
    AT_SIZE,
    FIRST,
    MOMENTUM,
    MOVED,
    MOVER,
    POSITION,
    ROTATION,
    ROW_INTS,
    SCRATCH,
    VELOCITY,
)
from sceneql.bodies.rigid.ties.tie_settle_kernels import CLOSED
from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_FREE_MOTION, free_motion_at
from sceneql.stepping.splitting_kernels import drift
from sceneql.system.signatures_kernels import TIED_DRIFT_OF

MOST_ROUNDS = 50
"""Rounds, each of which leaves a part of the gaps that is in proportion to the step's length."""


@lean(TIED_DRIFT_OF, inner=True)
def end_tied(functions, h, y0, kicked, y1, floats, all_ints, ints):
    """Impulses along the rows at y0, in `kicked`, and drifts from there to y1, until the ties hold in y1."""
    survey(0.0, y0, floats, ints)
    if factor(floats, ints) == 0.0:
        return
    for k in range(ints[ROWS]):
        to = ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH]
        for c in range(KEPT):
            floats[ints[KEPT_AT] + KEPT * k + c] = floats[to + AT_J + c]
    for _ in range(MOST_ROUNDS):
        survey(0.0, y1, floats, ints)
        worst = 0.0
        for k in range(ints[ROWS]):
            to = ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH]
            worst = max(worst, abs(floats[to + AT_C]) / max(floats[to + AT_SIZE], 1e-300))
            floats[ints[RIGHT_AT] + k] = -floats[to + AT_C] / h
        if worst <= CLOSED:
            return
        solve(floats, ints)
        for k in range(ints[ROWS]):
            row, own, impulse = ints[ROWS_AT] + ROW_INTS * k, ints[KEPT_AT] + KEPT * k, floats[ints[RIGHT_AT] + k]
            for side in range(2):
                at = ints[MOVERS_AT] + MOVER * ints[row + FIRST + side]
                if ints[at + POSITION] >= 0:
                    inverse = floats[ints[MOVED_AT] + MOVED * ints[row + FIRST + side] + AT_MASS]
                    for c in range(3):
                        kicked[ints[at + VELOCITY] + c] += impulse * (inverse * floats[own + 6 * side + c])
                    if ints[at + ROTATION] >= 0:
                        for c in range(3):
                            kicked[ints[at + MOMENTUM] + c] += impulse * floats[own + 6 * side + 3 + c]
        for k in range(y1.size):
            y1[k] = kicked[k]
        drift(free_motion_at(functions[AT_FREE_MOTION]), h, y1, floats, all_ints)
