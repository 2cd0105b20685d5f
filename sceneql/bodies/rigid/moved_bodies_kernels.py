# mypy: ignore-errors
"""Bodies at the end of a step of velocities: where they are and how they move, and what ties ask of it.

What ties do is compiled where a body is tied (tied_rows_kernels, tied_step_kernels): it is called for these alone.
"""

from numba import types

from sceneql.bodies.rigid.groups_kernels import MASS
from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS, Q_AT, X_AT, move, place
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.system.signatures_kernels import A, F, I, N

TIES_AT, TIES, SIDES_AT, BODY_GROUPS_AT, BODY_MOVERS_AT, GROUPS, GROUPS_AT, DRIVES, DRIVES_AT = range(9)
ACTIVE_AT, ROW_BODIES_AT, ROWS, FIRST_STEP, HEAD = range(9, 14)
"""Integers of the ties of a step: where those of tie_kernels begin, and their number; where the tables of the rows'
sides, the bodies' groups (-1: tied to nothing) and movers begin; the number of groups and whether each always takes
part; the number of drives, and where they begin; the offset of which groups take part; where the bodies of the bounded
rows begin, two each, and the number of rows: first those of the ties, then four of each drive, its stops, its motor,
its friction; whether no other contact has told of these ties before it."""

AWAY, STEADY, PRESSED, STRUCK = 0.0, 1.0, 2.0, 3.0
"""Ways to step of a group, at ACTIVE_AT."""

_ROWS = "sceneql.bodies.rigid.ties.tied_rows_kernels"
_STEP = "sceneql.bodies.rigid.ties.tied_step_kernels"
begin_ties = lazy(f"{_ROWS}:begin_ties", types.void(F, A, A, A, I))
first_stop = lazy(f"{_ROWS}:first_stop", types.float64(F, A, A, A, I))
rouse = lazy(f"{_ROWS}:rouse", types.void(A, I, N))
write_ties = lazy(f"{_ROWS}:write_ties", types.void(F, A, A, A, I, A))
again = lazy(f"{_STEP}:again", types.boolean(F, A, A, A, A, I, A))
strike = lazy(f"{_STEP}:strike", types.void(A, A, A, I, I, N, A, A))
tied_to = lazy(f"{_STEP}:tied_to", types.boolean(I, A, I, A))
tell_work = lazy(f"{_STEP}:tell_work", types.void(A, I, A, A, A))
end_ties = lazy(f"{_STEP}:end_ties", types.void(F, A, A, I, A, I, A, N, N, types.boolean))


@lean_inlined
def mode_of(floats, own, body):
    """How a body steps."""
    if own.size == 0 or own[own[BODY_GROUPS_AT] + body] < 0:
        return PRESSED
    return floats[own[ACTIVE_AT] + own[own[BODY_GROUPS_AT] + body]]


@lean(types.void(F, A, A, A, A, I, N, N, I, I, A, A))
def place_all(h, y0, y1, free, floats, ints, bodies_at, every, own, touched, found, motions):
    """Write the places of all bodies at the end of the step: those that are not touched are as in ``free``."""
    for k in range(every):
        at, mode = bodies_at + BODY_INTS * k, mode_of(floats, own, k)
        if touched[k] > 0 and mode != STRUCK:
            place(h, free if mode == STEADY else y0, y1, ints, at, found, motions, 6 * k, 1 if mode == STEADY else 0)
            continue
        x, q = ints[at + X_AT], ints[at + Q_AT]
        for c in range(3):
            y1[x + c] = free[x + c]
        if q >= 0:
            for c in range(4):
                y1[q + c] = free[q + c]


@lean(types.void(A, A, A, A, I, N, N, I, I, A, A, A))
def move_all(y0, y1, free, floats, ints, bodies_at, every, own, touched, masses, found, before):
    """Write the motions of the bodies that are touched, and what the impulses took."""
    for k in range(every):
        if touched[k] > 0:
            at, mode = bodies_at + BODY_INTS * k, mode_of(floats, own, k)
            part = 0.5 if mode == STEADY else 1.0
            move(free if mode == STRUCK else y0, y1, ints, at, masses, MASS * k, found, before, 6 * k, part)
