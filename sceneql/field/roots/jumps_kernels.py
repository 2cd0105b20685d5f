# mypy: ignore-errors
"""Rays past places where a field jumps, as at whole numbers of floor, the cut of an angle and poles of quotients.

Over a piece of a ray with such a place bounds reach from one side of the step to the other, however short the piece,
and seem to hold zero where both sides are far from it. But on a short piece a step has two or three sides, and each
point is on one of them. So f is bounded once for every choice of sides, by a tape that has in place of the steps what
they are there: where no choice allows zero, nothing is met.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, kernel, lean
from sceneql.field.enclose.interval_kernels import TURN
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.roots.certified_kernels import certify
from sceneql.field.roots.isolation_kernels import BEYOND, LEAPS
from sceneql.field.tape import tape_ops as ops

MOST_STEPS = 4
"""Operations that may jump at one place."""
SIDES = 3
"""Of a step at the most: sign is 0 between -1 and 1."""
PASSED = 64
"""Jumps on one ray, before what is left is undecided."""
PIECES = 200
"""Looked at on the way to one jump."""


@inlined
def sides_of(code, scratch, k):
    """How many sides row k has where it jumps within the piece that ``scratch`` holds bounds of; else 0."""
    op, left, right = code[k, 0], code[k, 1], code[k, 2]
    if op == ops.FLOOR or op == ops.SIGN:
        apart = scratch[k, 1] - scratch[k, 0]
        return int(apart) + 1 if 1.0 <= apart <= SIDES - 1 else 0
    if op == ops.ATAN2 and code[k, 3] == 0:
        return 2 if scratch[right, 1] < 0.0 and scratch[left, 0] <= 0.0 <= scratch[left, 1] else 0
    if op == ops.DIV and scratch[right, 0] <= 0.0 <= scratch[right, 1]:
        return 2 if scratch[right, 0] < 0.0 else 1
    return 0


@inlined
def put(code, row, op, left, right, third):
    """Write a row; the number of the next one."""
    code[row, 0], code[row, 1], code[row, 2], code[row, 3] = op, left, right, third
    return row + 1


@inlined
def on_sides(code, constants, scratch, sides, steps, count, choice, places, chosen, numbers):
    """Write the tape ``chosen`` with its ``numbers`` in which the rows ``steps`` are what they are on the chosen sides.

    Row k of the old one is at ``places[k]`` of the new one. Returns how many rows that needs, 0 where there is no such
    side, -1 where a point of parts would no longer stand in three rows that follow each other.
    """
    n = step = 0
    for i in range(constants.shape[0]):
        numbers[i] = constants[i]
    numbers[constants.shape[0]] = -TURN
    for k in range(code.shape[0]):
        op, left, right, third = code[k, 0], code[k, 1], code[k, 2], code[k, 3]
        if op != ops.CONSTANT and op != ops.DENSITY and op != ops.SKELETON and not (op >= ops.X and op <= ops.Z):
            left, right = places[left], places[right]
        elif op == ops.DENSITY or op == ops.SKELETON:
            if places[third + 2] != places[third] + 2:
                return -1
            third = places[third]
        if step < count and steps[step] == k:
            side = choice % SIDES
            choice //= SIDES
            if side >= sides[step]:
                return 0
            if op == ops.FLOOR or op == ops.SIGN:
                number = constants.shape[0] + 1 + step
                numbers[number] = scratch[k, 0] + side
                n = put(chosen, n, ops.CONSTANT, number, 0, 0)
            elif op == ops.ATAN2:  # the flag lets it go on beyond pi
                n = put(chosen, n, op, left, right, 1)
                if side == 1:
                    n = put(chosen, n, ops.CONSTANT, constants.shape[0], 0, 0)
                    n = put(chosen, n, ops.ADD, n - 2, n - 1, 0)
            else:
                n = put(chosen, n, ops.ABS, right, right, 0)
                n = put(chosen, n, op, left, n - 1, 0)
                if side == 1:
                    n = put(chosen, n, ops.NEG, n - 1, n - 1, 0)
            step += 1
        else:
            n = put(chosen, n, op, left, right, third)
        places[k] = n - 1
    for row in range(n, chosen.shape[0]):
        put(chosen, row, ops.COPY, row - 1, row - 1, 0)
    return n


@inlined
def clear(low, high, status, sign, touching):
    """Whether nothing is met on a piece with these bounds of sign f."""
    return low > 0.0 or (touching and status == ops.WHOLE and high < 0.0) or (status == ops.NOWHERE and sign > 0.0)


@inlined
def clear_on_all_sides(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign, touching):
    """Whether nothing is met on the piece a..b, whose bounds ``scratch`` holds, on any side of what jumps there."""
    steps = np.empty(MOST_STEPS, np.int64)
    sides = np.empty(MOST_STEPS, np.int64)
    count = 0
    for k in range(code.shape[0]):
        many = sides_of(code, scratch, k)
        if many > 0:
            if count == MOST_STEPS:
                return False
            steps[count] = k
            sides[count] = many
            count += 1
    if count == 0:
        return False
    rows = code.shape[0] + 2 * count
    places = np.zeros(code.shape[0], np.int64)
    chosen = np.empty((rows, 4), code.dtype)
    numbers = np.empty(constants.shape[0] + 1 + count)
    room = np.empty((rows + scratch.shape[0] - code.shape[0], scratch.shape[1]))
    for choice in range(SIDES**count):
        n = on_sides(code, constants, scratch, sides, steps, count, choice, places, chosen, numbers)
        if n < 0:
            return False
        if n > 0:
            low, high, _, _, status = on_ray(chosen, numbers, parts, room, ox, oy, oz, dx, dy, dz, a, b, sign)
            if not clear(low, high, status, sign, touching):
                return False
    return True


@kernel(f"float64({ops.TAPE}{', float64' * 10}, boolean)", inner=True)
def passed(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, least, sign, touching):
    """How far from t on nothing is met, at the most to behind the first jump; t where none is proved."""
    a = t
    width = least
    for _ in range(PIECES):
        if not a < t1:
            break
        b = min(a + width, t1)
        for k in range(code.shape[0]):
            scratch[k, 0] = scratch[k, 1] = np.nan  # what is not reached tells of no jump
        low, high, _, _, status = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign)
        if clear(low, high, status, sign, touching):
            a = b
            width *= 2.0
        elif width > least:
            width = max(0.25 * width, least)
        else:
            if clear_on_all_sides(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign, touching):
                a = b
            break
    return a


@lean(BEYOND, inner=True)
def beyond(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, finest, sign, anywhere, touching):
    """(status, t) as ``certify``, which could not tell at t0, and is asked again behind each jump where nothing is."""
    least = max(finest, 4.0e-15 * (abs(t0) + abs(t1)))
    status = ops.UNDECIDED
    t = t0
    for _ in range(PASSED):
        side = sign
        if touching:
            low, _, _, _, _ = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, 1.0)
            side = 1.0 if low > 0.0 else -1.0
        behind = passed(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, least, side, touching)
        if not behind > t:
            break
        status, t = certify(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, behind, t1, finest, sign, anywhere, touching
        )
        if status != ops.UNDECIDED:
            break
    return status, t


@lean(LEAPS, inner=True)
def leaps(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
    """Whether f has no root within ``near`` of t, where its sign changes: it jumps over zero."""
    a, end = t - near, t + near
    for _ in range(PASSED):
        behind = passed(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, end, 0.05 * near, 1.0, True)
        if not a < behind < end:
            return behind == end
        a = behind
    return False
