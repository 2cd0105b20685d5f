# mypy: ignore-errors
"""Roots along grid edges, many at a time, and the normals there."""

from sceneql.compiled.kernels import inlined
from sceneql.field.tape.batch_gradient_kernels import differentiate
from sceneql.field.tape.batch_kernels import evaluate

CLOSE = 1.0e-9
"""Distance of two guesses, relative to the edge, that ends the search: the error of the last is smaller yet.

Only if |f| fell from one to the other, though: where the ends' values differ by many powers of ten, guesses are close
to each other and far from the root. Then a step of CLOSE tests for the root just beyond (after Brent 1973, ch. 4).
"""
MOST_TURNS = 100
HALVES_FROM, HALVES_EACH = 8, 3
"""Turn from which on, and period in which, brackets are halved; two chords must be in succession to be found close."""
UNDEFINED = 1.0e300
"""Replaces values that are undefined."""
A, FA, B, FB, T, SIDE, DX, DY, DZ, LANE, BUSY = range(11)
"""Rows of a search: bracket [A, B] with f(A) < 0, not f(B) < 0, and their values; guess; last side; the edge [m]; the
index of the edge; and whether it goes on, 1 or 0.

The side is -1 for A and 1 for B, twice that where |f| did not fall to half of its value at that end; LEVEL for B where
f is zero at more than one place.
"""
LEVEL = 3.0
ROWS = 11


@inlined
def guess(search, points, starts, turn, n):
    """The next guess: the chord's zero (Illinois, Dowell & Jarratt 1971), or the middle; returns how many moved."""
    busy = 0
    halve = turn >= HALVES_FROM and turn % HALVES_EACH == HALVES_FROM % HALVES_EACH
    for i in range(n):
        a = search[A, i]
        b = search[B, i]
        fa = search[FA, i]
        fb = search[FB, i]
        level = search[SIDE, i] == LEVEL
        share = 0.5 if halve or level or fb >= UNDEFINED or fa <= -UNDEFINED else fa / (fa - fb)
        t = a + (b - a) * share
        near = abs(t - search[T, i]) <= CLOSE
        wide = abs(b - a) > CLOSE
        if near and wide and fb == 0.0 and t == b:  # the end of {f < 0} is searched: also just before b?
            t = b + 0.5 * (CLOSE if a > b else -CLOSE)
            near = False
        elif near and wide and abs(search[SIDE, i]) == 2.0:
            ahead = CLOSE if (search[SIDE, i] < 0.0) == (b > a) else -CLOSE
            t = search[T, i] + ahead
            near = False
        moved = 1 if wide and not near and turn < MOST_TURNS else 0
        busy += moved
        search[BUSY, i] = moved
        search[T, i] = t
        points[0, i] = starts[0, i] + t * search[DX, i]
        points[1, i] = starts[1, i] + t * search[DY, i]
        points[2, i] = starts[2, i] + t * search[DZ, i]
    return busy


@inlined
def parted(search, points, starts, place, first, n):
    """Store the roots of finished searches in place[first:], and move the others to the front; returns their number."""
    busy = 0
    for i in range(n):
        if search[BUSY, i] == 0.0:
            out = first + int(search[LANE, i])
            for axis in range(3):
                place[out, axis] = points[axis, i]
            continue
        if busy < i:
            for row in range(ROWS):
                search[row, busy] = search[row, i]
            for axis in range(3):
                starts[axis, busy] = starts[axis, i]
                points[axis, busy] = points[axis, i]
        busy += 1
    return busy


@inlined
def polish(code, constants, parts, registers, points, search, starts, place, first, n):
    """Find the roots T (0 at the node, 1 at the next) on n edges, and write the points to place[first:].

    Most edges end after four values, some after many: when half of them have ended, the others are compacted.
    """
    found = registers[code.shape[0] - 1]
    left = n
    for i in range(n):
        search[LANE, i] = i
    for turn in range(MOST_TURNS + 1):
        if 2 * guess(search, points, starts, turn, left) <= left:
            left = parted(search, points, starts, place, first, left)
        if left == 0:
            break
        evaluate(code, constants, parts, registers, points, left)
        for i in range(left):
            f = found[i]
            side = search[SIDE, i]
            if f < 0.0:
                search[SIDE, i] = -1.0 if f > 0.5 * search[FA, i] else -2.0
                search[A, i] = search[T, i]
                search[FA, i] = f
                search[FB, i] *= 0.5 if side < 0.0 else 1.0
            else:
                level = f == 0.0 and search[FB, i] == 0.0 and search[T, i] != search[B, i]
                search[SIDE, i] = LEVEL if level else 1.0 if f <= 0.5 * search[FB, i] else 2.0
                search[B, i] = search[T, i]
                search[FB, i] = f if f == f else UNDEFINED
                search[FA, i] *= 0.5 if side > 0.0 else 1.0


@inlined
def normals(code, constants, parts, registers, slope, points, place, out, first, n):
    """Unit gradients at the n points of place[first:] into out[first:], zero where undefined."""
    last = code.shape[0] - 1
    for i in range(n):
        for axis in range(3):
            points[axis, i] = place[first + i, axis]
    evaluate(code, constants, parts, registers, points, n)
    differentiate(code, constants, parts, registers, slope, n)
    for i in range(n):
        x = slope[last, 0, i]
        y = slope[last, 1, i]
        z = slope[last, 2, i]
        length = (x * x + y * y + z * z) ** 0.5
        scale = 1.0 / length if 0.0 < length < 1.0e300 else 0.0
        out[first + i, 0] = x * scale if scale > 0.0 else 0.0
        out[first + i, 1] = y * scale if scale > 0.0 else 0.0
        out[first + i, 2] = z * scale if scale > 0.0 else 0.0
