# mypy: ignore-errors
"""Polygons in the plane as triangles, by cutting off ears (Meisters 1975), with a bound on the work."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined

FLAT = types.float64[:, ::1]
LEFT = types.int64[::1]
FOUND = types.int64[:, ::1]


@lean_inlined
def turn(flat, a, b, c):
    """Twice the signed area of the triangle of three of the points."""
    return (flat[b, 0] - flat[a, 0]) * (flat[c, 1] - flat[a, 1]) - (flat[b, 1] - flat[a, 1]) * (flat[c, 0] - flat[a, 0])


@lean_inlined
def ear_tests(flat, left, count, k):
    """Number of corners that were tested until the triangle at corner k proved an ear; minus it, where it is none.

    An ear turns left and holds no other of the remaining corners.
    """
    a, b, c = left[k - 1 if k else count - 1], left[k], left[(k + 1) % count]
    if turn(flat, a, b, c) <= 0.0:
        return -1
    for j in range(count):
        p = left[j]
        if p == a or p == b or p == c:
            continue
        if turn(flat, a, b, p) >= 0.0 and turn(flat, b, c, p) >= 0.0 and turn(flat, c, a, p) >= 0.0:
            return -1 - j
    return 1 + count


@lean(types.int64(FLAT, types.int64, LEFT, FOUND, types.int64), inner=False)
def cut_ears(flat, count, left, found, work):
    """Triangles (count - 2, 3) of the polygon of the first points of ``flat``, as numbers of them, into ``found``.

    ``left`` is room for ``count`` numbers. Returns what is left of ``work``, a number of tests of corners; below 0 it
    was too little, and ``found`` is not whole. Where no ear is left, of a polygon that crosses itself, any is cut.
    """
    for k in range(count):
        left[k] = k
    made = 0
    while count > 3:
        best = 0
        for k in range(count):
            tests = ear_tests(flat, left, count, k)
            work -= abs(tests)
            if work < 0:
                return work
            if tests > 0:
                best = k
                break
        found[made, 0] = left[best - 1 if best else count - 1]
        found[made, 1] = left[best]
        found[made, 2] = left[(best + 1) % count]
        made += 1
        count -= 1
        for k in range(best, count):
            left[k] = left[k + 1]
    for k in range(3):
        found[made, k] = left[k]
    return work
