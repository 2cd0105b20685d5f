# mypy: ignore-errors
"""Where the numbers of a cone program stand (cone_rows_kernels), with the plan of its factorization for given pairs."""

from numba import types

from sceneql.compiled.kernels import kernel
from sceneql.linear import cone_rows_kernels as rows
from sceneql.linear.block_order_kernels import filled
from sceneql.linear.block_plan_kernels import BLOCK, plan_blocks
from sceneql.system.signatures_kernels import I, N


@kernel(types.Tuple((I, N))(N, N, I, N, N, N))
def lay_out(bodies, most, pairs, bodies_at, contacts_at, scratch_at):
    """The integers of a program of so many bodies and at most so many contacts, and where its floats end.

    ``pairs`` (m 2,): the bodies of each pair, -1 for one that is fixed or led. Bodies and contacts stand among the
    floats where it is said, and what is needed besides from ``scratch_at`` on.
    """
    count = pairs.size // 2
    edges, both = filled(pairs.size, 0), 0
    for k in range(count):
        if pairs[2 * k] >= 0 and pairs[2 * k + 1] >= 0:
            edges[2 * both], edges[2 * both + 1] = pairs[2 * k], pairs[2 * k + 1]
            both += 1
    plan, factors, work = plan_blocks(bodies, edges[: 2 * both])
    contact_ints_at = rows.HEAD + rows.PAIR * count
    diagonal_at = contact_ints_at + most
    plan_at = diagonal_at + bodies
    ints = filled(plan_at + plan.size, 0)
    for k in range(plan.size):
        ints[plan_at + k] = plan[k]
    place = BLOCK * bodies
    for k in range(count):
        at = rows.HEAD + rows.PAIR * k
        ints[at + rows.PAIR_A], ints[at + rows.PAIR_B] = pairs[2 * k], pairs[2 * k + 1]
        ints[at + rows.PAIR_AB] = ints[at + rows.PAIR_BA] = -1
        if pairs[2 * k] >= 0 and pairs[2 * k + 1] >= 0:
            ints[at + rows.PAIR_AB], ints[at + rows.PAIR_BA] = place, place + BLOCK
            place += 2 * BLOCK
    for k in range(bodies):
        ints[diagonal_at + k] = BLOCK * k
    ints[rows.BODIES], ints[rows.PAIRS_AT], ints[rows.CONTACT_INTS_AT] = bodies, rows.HEAD, contact_ints_at
    ints[rows.DIAGONAL_AT], ints[rows.PLAN_AT], ints[rows.PLAN] = diagonal_at, plan_at, plan.size
    ints[rows.BODIES_AT], ints[rows.CONTACTS_AT], ints[rows.TRIES] = bodies_at, contacts_at, rows.USUAL_TRIES
    at = scratch_at
    ints[rows.VALUES_AT], ints[rows.VALUES], at = at, place, at + place
    ints[rows.FACTORS_AT], ints[rows.FACTORS], at = at, factors, at + factors
    ints[rows.WORK_AT], ints[rows.WORK], at = at, work, at + work
    ints[rows.RIGHT_AT], at = at, at + 6 * bodies
    ints[rows.RESULT_AT], at = at, at + rows.RESULT
    return ints, at
