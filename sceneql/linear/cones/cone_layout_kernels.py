# mypy: ignore-errors
"""Where the numbers of a cone program stand, with the plan of its factorization for given pairs."""

from numba import types

from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal.layout import BODY_BLOCK, BODY_UNKNOWNS
from sceneql.system.signatures_kernels import A, F, I, N

BODIES, CONTACTS, PAIRS_AT, CONTACT_INTS_AT, DIAGONAL_AT, PLAN_AT, PLAN, BODIES_AT, CONTACTS_AT, VALUES_AT = range(10)
VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, RESULT_AT, TRIES, ITERATIONS, FINISHES = range(10, 20)
ROWS, ROW_INTS_AT, ROWS_AT, HEAD = range(20, 24)
"""Integers of a program: numbers of bodies and (to be written) of contacts; where its pairs, its contacts' pairs (to be
written), the places of the diagonal's blocks and the plan begin; offsets into the floats, and sizes; how many
factorizations may be tried from the guess (to be written); then what a solution took: iterations of the interior-point
method, and factorizations of Newton's method besides; the number of bounded rows (bounded_rows_kernels), where their
pairs begin, the offset of their floats."""

FEW = 6
"""Bodies up to which the matrix is factored as a whole: as quick, and compiled in a tenth of the time."""

PAIR_A, PAIR_B, PAIR_AB, PAIR_BA, PAIR = range(5)
"""Integers of a pair: its bodies (-1: one that is fixed or led), the places of its two blocks beside the diagonal."""

AT_MASS, AT_INERTIA, AT_FREE, AT_V, AT_D, AT_LEFT, AT_FORCE, AT_TORQUE, AT_INVERSE, AT_OLD, BODY = (
    0, 1, 10, 16, 22, 28, 34, 35, 36, 45, 51
)  # fmt: skip
"""Floats of a body. Given: mass, inertia about its center in the world's axes (3, 3), velocity and angular velocity
without contacts. Found: both with contacts (given: a guess). Scratch: a direction, what is left of the momenta's
equations, sizes of the momenta and angular momenta in these, the inverse inertia, velocities to come back to."""

AT_NORMAL, AT_ARM_A, AT_ARM_B, AT_FRICTION, AT_GIVEN, AT_IMPULSE, AT_VELOCITY, AT_FRAME, AT_X, AT_S = (
    0, 3, 6, 9, 10, 13, 16, 19, 28, 31
)  # fmt: skip
AT_DX, AT_DS, AT_Q, AT_LAMBDA, AT_W, AT_ETA, AT_H, AT_B, AT_R, AT_HEAVY = 34, 37, 40, 43, 46, 49, 50, 59, 62, 65
AT_SIZE, AT_OLD_X, AT_SLIDE, AT_SLIP, AT_SLOPE, CONTACT = 66, 67, 73, 75, 76, 77
"""Floats of a contact. Given: normal from b to a, arms from the bodies' centers, coefficient of friction, what is added
to the velocity of a against b: the gap over the step along the normal (or the velocity after a bounce, reversed), less
the velocity of a led body. Found, in the world: impulse on a (given: a guess) and velocity with what was added.
Scratch: frame (3, 3), x, s, their changes, right hand side, scaled point, scaling (3, 1), matrix (3, 3), given velocity
in the frame, what is left of s, effective mass, size of the velocities, x and s to come back to, direction of slip (2),
slip, its change."""

ROW_J, ROW_LOW, ROW_HIGH, ROW_GIVEN, ROW_X, ROW_S = 0, 12, 13, 14, 15, 16
ROW_HEAVY, ROW_LONG, ROW_SIZE, ROW_H, ROW_DX, ROW_DS, ROW_A, ROW_C, ROW_DA, ROW_DC = range(17, 27)
ROW_AIM_A, ROW_AIM_C, ROW_LEFT, ROW_OLD, ROW = 27, 28, 29, 30, 33
"""Floats of a bounded row. Given: J by velocity and angular velocity of the first body of its pair, then of the second;
the bounds of the impulse, what is added to J v. Found: impulse (given: a guess), s. Scratch: effective mass, length
that makes a velocity of s, size of s, matrix, changes of impulse and s; a and c, their changes, what these aim at; what
is left of s; impulse, a and c to come back to."""

RESIDUAL, OVERLAP, BALANCE, RESULT = range(4)
"""Floats that are found: what is left of the equations, of the size of the numbers in them; the largest velocity with
which a contact still closes [m/s]; what is left with each contact's power in place of its law."""

USUAL_TRIES = 4
"""Factorizations that are tried from the guess, by default."""

OTHERS = 1e-2
"""Part of the largest velocity below which one counts as 0 when sizes are compared."""

_BOUNDED = "sceneql.linear.cones.bounded_rows_kernels"
_POINTS = "sceneql.linear.cones.bounded_points_kernels"
# Compiled for programs that have bounded rows: called for these alone.
to_rows = lazy(f"{_BOUNDED}:to_rows", types.void(A, I, N, N))
from_rows = lazy(f"{_BOUNDED}:from_rows", types.void(A, I, N, N))
momenta_of_rows = lazy(f"{_BOUNDED}:momenta_of_rows", types.void(A, I))
prepare_rows = lazy(f"{_BOUNDED}:prepare_rows", types.void(A, I))
sizes_of_rows = lazy(f"{_BOUNDED}:sizes_of_rows", types.float64(A, I))
floor_sizes = lazy(f"{_BOUNDED}:floor_sizes", types.void(A, I, F))
add_rows = lazy(f"{_BOUNDED}:add_rows", types.void(A, A, I))
keep_rows = lazy(f"{_BOUNDED}:keep_rows", types.void(A, I))
fetch_rows = lazy(f"{_BOUNDED}:fetch_rows", types.void(A, I))
see_rows = lazy(f"{_BOUNDED}:see_rows", types.UniTuple(F, 2)(A, I))
project_rows = lazy(f"{_BOUNDED}:project_rows", types.void(A, I, F))
move_rows = lazy(f"{_BOUNDED}:move_rows", types.void(A, I))
open_rows = lazy(f"{_BOUNDED}:open_rows", types.float64(A, I))
spring_rows = lazy(f"{_BOUNDED}:spring_rows", types.void(A, I))
fastest_row = lazy(f"{_BOUNDED}:fastest_row", types.float64(A, I))
begin_rows = lazy(f"{_POINTS}:begin_rows", types.void(A, I, F))
left_rows = lazy(f"{_POINTS}:left_rows", types.float64(A, I))
scale_rows = lazy(f"{_POINTS}:scale_rows", types.UniTuple(F, 2)(A, I))
aim_rows = lazy(f"{_POINTS}:aim_rows", types.void(A, I))
turn_rows = lazy(f"{_POINTS}:turn_rows", types.float64(A, I))
center_rows = lazy(f"{_POINTS}:center_rows", types.void(A, I, F))
advance_rows = lazy(f"{_POINTS}:advance_rows", types.void(A, I, F))


plan_blocks = lazy("sceneql.linear.multifrontal.block_plan_kernels:plan_blocks", types.Tuple((I, N, N))(N, I))


@kernel(types.Tuple((I, N))(N, N, N, I, N, N, N, N))
def lay_out(bodies, most, bounded, pairs, bodies_at, contacts_at, rows_at, scratch_at):
    """The integers of a program of so many bodies, at most so many contacts and so many bounded rows; its floats' end.

    ``pairs`` (m 2,): the bodies of each pair, -1 for one that is fixed or led. Bodies and contacts stand among the
    floats where it is said, and what is needed besides from ``scratch_at`` on.
    """
    count = pairs.size // 2
    edges, both = filled(pairs.size, 0), 0
    for k in range(count):
        if pairs[2 * k] >= 0 and pairs[2 * k + 1] >= 0:
            edges[2 * both], edges[2 * both + 1] = pairs[2 * k], pairs[2 * k + 1]
            both += 1
    if bodies <= FEW:  # pivots in place of a plan, and the whole matrix
        plan, factors, work = filled(BODY_UNKNOWNS * bodies, 0), BODY_UNKNOWNS * BODY_UNKNOWNS * bodies * bodies, 0
    else:
        plan, factors, work = plan_blocks(bodies, edges[: 2 * both])
    contact_ints_at = HEAD + PAIR * count
    row_ints_at = contact_ints_at + most
    diagonal_at = row_ints_at + bounded
    plan_at = diagonal_at + bodies
    ints = filled(plan_at + plan.size, 0)
    for k in range(plan.size):
        ints[plan_at + k] = plan[k]
    place = BODY_BLOCK * bodies
    for k in range(count):
        at = HEAD + PAIR * k
        ints[at + PAIR_A], ints[at + PAIR_B] = pairs[2 * k], pairs[2 * k + 1]
        ints[at + PAIR_AB] = ints[at + PAIR_BA] = -1
        if pairs[2 * k] >= 0 and pairs[2 * k + 1] >= 0:
            ints[at + PAIR_AB], ints[at + PAIR_BA] = place, place + BODY_BLOCK
            place += 2 * BODY_BLOCK
    for k in range(bodies):
        ints[diagonal_at + k] = BODY_BLOCK * k
    ints[BODIES], ints[PAIRS_AT], ints[CONTACT_INTS_AT] = bodies, HEAD, contact_ints_at
    ints[ROWS], ints[ROW_INTS_AT], ints[ROWS_AT] = bounded, row_ints_at, rows_at
    ints[DIAGONAL_AT], ints[PLAN_AT], ints[PLAN] = diagonal_at, plan_at, plan.size
    ints[BODIES_AT], ints[CONTACTS_AT], ints[TRIES] = bodies_at, contacts_at, USUAL_TRIES
    at = scratch_at
    ints[VALUES_AT], ints[VALUES], at = at, place, at + place
    ints[FACTORS_AT], ints[FACTORS], at = at, factors, at + factors
    ints[WORK_AT], ints[WORK], at = at, work, at + work
    ints[RIGHT_AT], at = at, at + 6 * bodies
    ints[RESULT_AT], at = at, at + RESULT
    return ints, at
