# mypy: ignore-errors
"""First roots past jumps of a field, as at whole numbers of floor, the cut of an angle and poles of quotients.

On a piece of a ray with a jump the bounds span both sides of the step, however short the piece, and may contain zero
although both sides are far from it. But on a short piece a step has two or three sides, and each point is on one of
them. So f is bounded once for every choice of sides, by a tape with the steps replaced by their values: where no choice
allows zero, there is no root.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, kernel, lean
from sceneql.field.enclose.interval_kernels import TURN
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.roots.certified_kernels import certify
from sceneql.field.roots.isolation_kernels import BEYOND, LEAPS
from sceneql.field.tape import tape_ops as ops

MOST_STEPS = 4
"""Operations that may jump on one piece."""
SIDES = 3
"""Most sides of a step: sign is -1, 0 or 1."""
PASSED = 64
"""Jumps passed on one ray before the rest is left undecided."""
AGAIN = 2
"""Times that certify goes on from where its evaluations were spent."""
PIECES = 200
"""Pieces examined on the way to one jump."""


@inlined
def sides_of(code, scratch, k):
    """Number of sides of row k if it jumps on the piece whose bounds are in ``scratch``; else 0."""
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
    """Write a row; returns the index of the next one."""
    code[row, 0], code[row, 1], code[row, 2], code[row, 3] = op, left, right, third
    return row + 1


@inlined
def on_sides(code, constants, scratch, sides, steps, count, choice, places, chosen, numbers):
    """Write the tape ``chosen`` with its ``numbers``: the rows ``steps`` are replaced by their values on one side.

    ``choice`` numbers the sides; row k becomes ``places[k]``. Returns how many rows that needs, 0 where there is no
    such side, -1 where the point of a density would not be in three consecutive rows.
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
            elif op == ops.ATAN2:  # the flag allows values beyond pi
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
    """Whether bounds of sign f on a piece exclude an entry, or with ``touching`` a root."""
    if touching:
        return low > 0.0 or (status == ops.WHOLE and high < 0.0) or (status == ops.NOWHERE and sign > 0.0)
    return low >= 0.0 or (status == ops.NOWHERE and sign > 0.0)


@inlined
def clear_on_all_sides(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign, touching):
    """Whether ``clear`` holds on the piece a..b, bounded in ``scratch``, for every choice of sides of its jumps."""
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
    """The end of what is proved clear from t on, at most just behind the first jump; t where nothing is proved."""
    a = t
    width = least
    for _ in range(PIECES):
        if not a < t1:
            break
        b = min(a + width, t1)
        for k in range(code.shape[0]):
            scratch[k, 0] = scratch[k, 1] = np.nan  # rows that are not evaluated have no jump
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
    """(status, t) as ``certify``, which got stuck at t0 and is restarted behind each jump that is proved clear."""
    least = max(finest, 4.0e-15 * (abs(t0) + abs(t1)))
    status = ops.UNDECIDED
    t = t0
    again = AGAIN
    for _ in range(PASSED):
        side = sign
        if touching:
            low, _, _, _, _ = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, 1.0)
            side = 1.0 if low > 0.0 else -1.0
        behind = passed(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, least, side, touching)
        if not behind > t:
            # Before a jump across which a sum changes far less than its terms, certify comes near in small steps, and
            # goes on from where f is proved away from zero: no root at this end is skipped.
            low, _, _, _, _ = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, side)
            if touching or again == 0 or not low > 0.0:
                break
            again -= 1
        status, t = certify(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, behind, t1, finest, sign, anywhere, touching
        )
        if status != ops.UNDECIDED:
            break
    return status, t


@lean(LEAPS, inner=True)
def leaps(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
    """Whether f, whose sign changes within ``near`` of t, is proved to have no root there: it jumps over zero."""
    a, end = t - near, t + near
    for _ in range(PASSED):
        behind = passed(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, end, 0.05 * near, 1.0, True)
        if not a < behind < end:
            return behind == end
        a = behind
    return False
