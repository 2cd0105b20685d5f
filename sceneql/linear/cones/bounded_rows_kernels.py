# mypy: ignore-errors
"""Bounded rows of a cone program: ties, stops, motors and dry friction of joints, one number of impulse each.

A row between two bodies has s = J v + given and an impulse x in [low, high], with s >= 0 where x = low, s <= 0 where
x = high, and s = 0 between. Without bounds it is a tie; in [0, inf) a stop; in [-a, a] friction or a motor. A row with
low = high has that impulse. Ties that say the same twice share an impulse near the one guessed: steps are proximal.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.cones import cone_layout_kernels as layout
from sceneql.linear.cones.cone_layout_kernels import (
    ROW,
    ROW_A,
    ROW_C,
    ROW_DS,
    ROW_DX,
    ROW_GIVEN,
    ROW_H,
    ROW_HEAVY,
    ROW_HIGH,
    ROW_J,
    ROW_LONG,
    ROW_LOW,
    ROW_OLD,
    ROW_S,
    ROW_SIZE,
    ROW_X,
)
from sceneql.system.signatures_kernels import A, F, I, N

PRODUCT = types.void(A, I, N, N)


@lean_inlined
def row_pair(ints, k):
    """Where the integers of a row's pair are."""
    return ints[layout.PAIRS_AT] + layout.PAIR * ints[ints[layout.ROW_INTS_AT] + k]


@lean_inlined
def moves(floats, c):
    """Whether the impulse of a row is not given by its bounds."""
    return floats[c + ROW_HIGH] > floats[c + ROW_LOW] and floats[c + ROW_HEAVY] > 0.0


@lean(PRODUCT)
def to_rows(floats, ints, of, at):
    """J times the bodies' six numbers ``of``, to ``at``."""
    for k in range(ints[layout.ROWS]):
        c, pair, total = ints[layout.ROWS_AT] + ROW * k, row_pair(ints, k), 0.0
        for side in range(2):
            body = ints[pair + side]
            if body >= 0:
                to = ints[layout.BODIES_AT] + layout.BODY * body + of
                for j in range(6):
                    total += floats[c + ROW_J + 6 * side + j] * floats[to + j]
        floats[c + at] = total


@lean(PRODUCT)
def from_rows(floats, ints, of, at):
    """Adds J^T times the rows' numbers ``of`` to the bodies' six ``at``."""
    for k in range(ints[layout.ROWS]):
        c, pair = ints[layout.ROWS_AT] + ROW * k, row_pair(ints, k)
        x = floats[c + of]
        if x == 0.0:
            continue
        for side in range(2):
            body = ints[pair + side]
            if body >= 0:
                to = ints[layout.BODIES_AT] + layout.BODY * body + at
                for j in range(6):
                    floats[to + j] += x * floats[c + ROW_J + 6 * side + j]


@lean(types.void(A, I))
def momenta_of_rows(floats, ints):
    """Adds the rows' impulses to LEFT, and their sizes to those of the momenta."""
    for k in range(ints[layout.ROWS]):
        c, pair = ints[layout.ROWS_AT] + ROW * k, row_pair(ints, k)
        for side in range(2):
            body = ints[pair + side]
            if body >= 0:
                at = ints[layout.BODIES_AT] + layout.BODY * body
                for j in range(6):
                    part = abs(floats[c + ROW_X] * floats[c + ROW_J + 6 * side + j])
                    floats[at + (layout.AT_FORCE if j < 3 else layout.AT_TORQUE)] += part
    from_rows(floats, ints, ROW_X, layout.AT_LEFT)


@lean(types.void(A, I))
def prepare_rows(floats, ints):
    """Write the effective masses and lengths; impulses into their bounds. A row that moves no body has no impulse."""
    for k in range(ints[layout.ROWS]):
        c, pair = ints[layout.ROWS_AT] + ROW * k, row_pair(ints, k)
        light = straight = 0.0
        for side in range(2):
            body, j = ints[pair + side], c + ROW_J + 6 * side
            if body >= 0:
                at, own = ints[layout.BODIES_AT] + layout.BODY * body, 0.0
                for i in range(3):
                    own += floats[j + i] * floats[j + i] / floats[at + layout.AT_MASS]
                    for m in range(3):
                        own += floats[j + 3 + i] * floats[at + layout.AT_INVERSE + 3 * i + m] * floats[j + 3 + m]
                light += own
                straight += 1.0 / floats[at + layout.AT_MASS] if own > 0.0 else 0.0
        floats[c + ROW_HEAVY] = 1.0 / light if light > 0.0 else 0.0
        floats[c + ROW_LONG] = math.sqrt(straight / light) if light > 0.0 else 1.0
        floats[c + ROW_X] = min(max(floats[c + ROW_X], floats[c + ROW_LOW]), floats[c + ROW_HIGH])
        if light == 0.0:
            floats[c + ROW_X] = 0.0


@lean(types.float64(A, I))
def sizes_of_rows(floats, ints):
    """Write the sizes of what s are sums of; the largest as a velocity."""
    fastest = 0.0
    for k in range(ints[layout.ROWS]):
        c, pair = ints[layout.ROWS_AT] + ROW * k, row_pair(ints, k)
        size = abs(floats[c + ROW_GIVEN])
        for side in range(2):
            body = ints[pair + side]
            if body >= 0:
                at = ints[layout.BODIES_AT] + layout.BODY * body
                for j in range(6):
                    part = abs(floats[at + layout.AT_FREE + j]) + abs(floats[at + layout.AT_V + j])
                    size += abs(floats[c + ROW_J + 6 * side + j]) * part
        floats[c + ROW_SIZE] = size
        fastest = max(fastest, floats[c + ROW_LONG] * size)
    return fastest


@lean(types.void(A, I, F))
def floor_sizes(floats, ints, least):
    """Adds a velocity to all sizes."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_SIZE] += least / floats[c + ROW_LONG]


@lean(types.void(A, A, I))
def add_rows(values, floats, ints):
    """Adds J^T H J of the rows to the matrix of Newton's method."""
    for k in range(ints[layout.ROWS]):
        c, pair = ints[layout.ROWS_AT] + ROW * k, row_pair(ints, k)
        h = floats[c + ROW_H]
        if h == 0.0:
            continue
        for one in range(2):
            for other in range(2):
                a, b = ints[pair + one], ints[pair + other]
                if a < 0 or b < 0:
                    continue
                if one == other:
                    to = ints[ints[layout.DIAGONAL_AT] + a]
                else:
                    to = ints[pair + (layout.PAIR_AB if one == 0 else layout.PAIR_BA)]
                for i in range(6):
                    part = h * floats[c + ROW_J + 6 * one + i]
                    if part != 0.0:
                        for j in range(6):
                            values[to + 6 * i + j] += part * floats[c + ROW_J + 6 * other + j]


@lean(types.void(A, I))
def keep_rows(floats, ints):
    """Keep x, a and c."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_OLD] = floats[c + ROW_X]
        floats[c + ROW_OLD + 1], floats[c + ROW_OLD + 2] = floats[c + ROW_A], floats[c + ROW_C]


@lean(types.void(A, I))
def fetch_rows(floats, ints):
    """Take x, a and c back as they were kept."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_X] = floats[c + ROW_OLD]
        floats[c + ROW_A], floats[c + ROW_C] = floats[c + ROW_OLD + 1], floats[c + ROW_OLD + 2]


@lean(types.UniTuple(F, 2)(A, I))
def see_rows(floats, ints):
    """Write all s; what is left of the rows' law, the largest against the size of the numbers in it.

    Once of the case that holds best, and once of bounds and power alone, as of contacts (cone_finish_kernels.see).
    """
    to_rows(floats, ints, layout.AT_V, ROW_S)
    worst = least = 0.0
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_S] += floats[c + ROW_GIVEN]
        if not moves(floats, c):
            continue
        x, s, size = floats[c + ROW_X], floats[c + ROW_S], floats[c + ROW_SIZE]
        push = floats[c + ROW_HEAVY] * size
        low, high = floats[c + ROW_LOW], floats[c + ROW_HIGH]
        one = max(abs(x - low) / push, max(-s, 0.0) / size)
        other = max(abs(high - x) / push, max(s, 0.0) / size)
        out = max(low - x, x - high) / max(push, abs(x))
        worst = max(worst, max(min(abs(s) / size, min(one, other)), out))
        # Power against the nearer bound on the side that s drives to; a tie has none.
        way = x - low if s > 0.0 else high - x
        part = min(1.0, max(way, 0.0) / max(push, abs(x)))
        least = max(least, max(abs(s) / size * part, out))
    return worst, least


@lean(types.void(A, I, F))
def project_rows(floats, ints, stiff):
    """Write rho times the derivative of P(x - rho s) to H, and P(x - rho s) - x to DX."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_H] = floats[c + ROW_DX] = 0.0
        if not moves(floats, c):
            continue
        x, heavy = floats[c + ROW_X], floats[c + ROW_HEAVY]
        rho = stiff * heavy * max(1.0, abs(x) / (heavy * floats[c + ROW_SIZE]))
        aim = x - rho * floats[c + ROW_S]
        if aim <= floats[c + ROW_LOW]:
            floats[c + ROW_DX] = floats[c + ROW_LOW] - x
        elif aim >= floats[c + ROW_HIGH]:
            floats[c + ROW_DX] = floats[c + ROW_HIGH] - x
        else:
            floats[c + ROW_DX] = -rho * floats[c + ROW_S]
            floats[c + ROW_H] = rho


@lean(types.void(A, I))
def move_rows(floats, ints):
    """Take a step of the impulses, once DS is known."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_X] += floats[c + ROW_DX] - floats[c + ROW_H] * floats[c + ROW_DS]


@lean(types.float64(A, I))
def open_rows(floats, ints):
    """How fast a tie or a stop still opens or is run through [m/s]."""
    worst = 0.0
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if moves(floats, c) and floats[c + ROW_HIGH] == math.inf:
            s = floats[c + ROW_S]
            worst = max(worst, floats[c + ROW_LONG] * (abs(s) if floats[c + ROW_LOW] == -math.inf else -s))
    return worst


@lean(types.void(A, I))
def spring_rows(floats, ints):
    """Springs of the effective masses in place of the bounds: H, and DX for s without them."""
    to_rows(floats, ints, layout.AT_V, ROW_S)
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        used = moves(floats, c)
        floats[c + ROW_S] += floats[c + ROW_GIVEN]
        floats[c + ROW_H] = floats[c + ROW_HEAVY] if used else 0.0
        floats[c + ROW_DX] = -floats[c + ROW_HEAVY] * floats[c + ROW_S] if used else 0.0


@lean(types.float64(A, I))
def fastest_row(floats, ints):
    """The largest s without impulses, as a velocity."""
    found = 0.0
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if moves(floats, c):
            found = max(found, floats[c + ROW_LONG] * abs(floats[c + ROW_S]))
    return found
