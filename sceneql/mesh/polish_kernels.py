# mypy: ignore-errors
"""Roots along grid edges, many at a time, and the normals there."""

from sceneql.field.batch_gradient_kernels import differentiate
from sceneql.field.batch_kernels import evaluate
from sceneql.kernels import inlined

CLOSE = 1.0e-9
"""How near, in parts of an edge, two guesses end the search."""
MOST_TURNS = 60
AXIS, A, FA, B, FB, T, SIDE = range(7)
"""Rows of a search: the edge's axis; bracket [A, B] with f(A) < 0, not f(B) < 0 and their values; guess; last side."""


@inlined
def guess(search, i, turn):
    """The next place of search i: where the chord is zero (Illinois, Dowell & Jarratt 1971), or the middle."""
    a = search[A, i]
    b = search[B, i]
    fa = search[FA, i]
    fb = search[FB, i]
    if fb < 1.0e300 and (turn < 8 or turn % 2 == 0):
        return min(max(a + (b - a) * (fa / (fa - fb)), min(a, b)), max(a, b))
    return 0.5 * (a + b)


@inlined
def polish(code, constants, parts, registers, points, search, starts, h, n):
    """Bring n edges' places T (0 at the node, 1 at the next one) and ``points`` (3, LANES) onto the surface."""
    last = code.shape[0] - 1
    for turn in range(MOST_TURNS):
        worst = 0.0
        for i in range(n):
            t = guess(search, i, turn)
            worst = max(worst, min(abs(t - search[T, i]), abs(search[B, i] - search[A, i])))
            search[T, i] = t
            axis = int(search[AXIS, i])
            points[axis, i] = starts[axis, i] + t * h
        if worst <= CLOSE:
            break
        evaluate(code, constants, parts, registers, points, n)
        for i in range(n):
            f = registers[last, i]
            t = search[T, i]
            if f < 0.0:
                search[A, i] = t
                search[FA, i] = f
                if search[SIDE, i] == -1.0:
                    search[FB, i] *= 0.5
                search[SIDE, i] = -1.0
            else:
                search[B, i] = t
                search[FB, i] = f if f == f else 1.0e300
                if search[SIDE, i] == 1.0:
                    search[FA, i] *= 0.5
                search[SIDE, i] = 1.0


@inlined
def normals(code, constants, parts, registers, slope, points, out, first, n):
    """Unit gradients at n points into out[first:], zero where there is none."""
    last = code.shape[0] - 1
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
