# mypy: ignore-errors
"""The matrix of a cone program of few bodies, factored as a whole."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.cones.cone_layout_kernels import (
    BODIES,
    CONTACT_INTS_AT,
    DIAGONAL_AT,
    PAIR,
    PAIR_A,
    PAIR_AB,
    PAIR_B,
    PAIR_BA,
    PAIRS_AT,
    PLAN,
    PLAN_AT,
)
from sceneql.linear.dense_kernels import factor
from sceneql.linear.multifrontal.layout import BODY_UNKNOWNS as UNIT
from sceneql.system.signatures_kernels import A, I


@lean_inlined
def add_block(values, place, whole, n, row, column):
    """Add a block of ``values`` to the matrix, in the row and column of two bodies."""
    for i in range(UNIT):
        to = (UNIT * row + i) * n + UNIT * column
        for j in range(UNIT):
            whole[to + j] += values[place + UNIT * i + j]


@lean(types.boolean(A, I, A), inner=True)
def factor_few(values, ints, whole):
    """Factor the matrix of the blocks ``values``, to ``whole``; pivots stand in place of the plan."""
    bodies = ints[BODIES]
    n = UNIT * bodies
    for k in range(n * n):
        whole[k] = 0.0
    for body in range(bodies):
        add_block(values, ints[ints[DIAGONAL_AT] + body], whole, n, body, body)
    for pair in range(ints[PAIRS_AT], ints[CONTACT_INTS_AT], PAIR):
        if ints[pair + PAIR_AB] >= 0:
            add_block(values, ints[pair + PAIR_AB], whole, n, ints[pair + PAIR_A], ints[pair + PAIR_B])
            add_block(values, ints[pair + PAIR_BA], whole, n, ints[pair + PAIR_B], ints[pair + PAIR_A])
    return factor(whole, n, ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]])
