# mypy: ignore-errors
"""The path of a body between two instants, and the first place where it meets a surface.

A path is 13 floats: place and velocity at the start, place and velocity at the end, duration: a cubic Hermite curve.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import clear, facing
from sceneql.system.signatures_kernels import A, F, I, N

NEVER = 2.0
MEAN, MOVED = 9, 3
"""Room for a path's mean acceleration, and where in it the correction of its ends stands: place and velocity."""
SEARCH = types.float64(A, F, A, I, N, F)

search = lazy("sceneql.contacts.search_kernels:search", SEARCH)


@lean_inlined
def set_out(k, h, y0, y1, path, mean, ints):
    """The path of body k in a step of length h, and its mean acceleration."""
    at, to = ints[layout.POSITION] + 3 * k, ints[layout.VELOCITY] + 3 * k
    for c in range(3):
        path[c], path[3 + c] = y0[at + c], y0[to + c]
        path[6 + c], path[9 + c] = y1[at + c], y1[to + c]
        mean[c] = (y1[to + c] - y0[to + c]) / h
    path[12] = h


@lean_inlined
def place(path, s):
    """The point at 0 <= s <= 1."""
    h = path[12]
    r = 1.0 - s
    a, b, c, d = r * r * (1.0 + 2.0 * s), r * r * s * h, s * s * (1.0 + 2.0 * r), -s * s * r * h
    x = a * path[0] + b * path[3] + c * path[6] + d * path[9]
    y = a * path[1] + b * path[4] + c * path[7] + d * path[10]
    z = a * path[2] + b * path[5] + c * path[8] + d * path[11]
    return x, y, z


@lean_inlined
def middle(path, k):
    """Middle Bezier coefficient of the velocity's component k."""
    return 3.0 * (path[6 + k] - path[k]) / path[12] - path[3 + k] - path[9 + k]


@lean_inlined
def moving(path, s):
    """The velocity at 0 <= s <= 1."""
    r = 1.0 - s
    a, b, c = r * r, 2.0 * r * s, s * s
    x = a * path[3] + b * middle(path, 0) + c * path[9]
    y = a * path[4] + b * middle(path, 1) + c * path[10]
    z = a * path[5] + b * middle(path, 2) + c * path[11]
    return x, y, z


@lean_inlined
def length_bound(path):
    """An upper bound of the path's length: its duration times the largest Bezier coefficient of the velocity."""
    start = path[3] ** 2 + path[4] ** 2 + path[5] ** 2
    end = path[9] ** 2 + path[10] ** 2 + path[11] ** 2
    between = middle(path, 0) ** 2 + middle(path, 1) ** 2 + middle(path, 2) ** 2
    return path[12] * math.sqrt(max(start, max(end, between)))


@lean_inlined
def clear_piece(path, length, s, ds, floats, ints, at, reach):
    """Whether a body of radius ``reach`` is proved to be clear of the object from s to s + ds."""
    x, y, z = place(path, s + 0.5 * ds)
    return clear(floats, ints, at, x, y, z, 0.5 * ds * length + reach)


@lean_inlined
def stays_above(path, floats, ints, at, reach):
    """Whether a path stays above a plane, or above its start on it: by the control points of its cubic."""
    third = path[12] / 3.0
    start, nx, ny, nz = facing(floats, ints, at, path[0], path[1], path[2])
    end = facing(floats, ints, at, path[6], path[7], path[8])[0]
    leaves = start + third * (path[3] * nx + path[4] * ny + path[5] * nz)
    comes = end - third * (path[9] * nx + path[10] * ny + path[11] * nz)
    lowest = min(end, min(leaves, comes))
    return lowest >= start if start <= reach else lowest > reach


@lean(types.float64(A, A, I, N, F), inner=True)
def first_contact(path, floats, ints, at, reach):
    """Where on the path (0 <= s <= 1) a body of radius ``reach`` first enters the object at ints[at:], or NEVER.

    A body that touches at the start and approaches has s = 0; a separating one is followed until it returns.
    """
    if ints[at + layout.FLAT] != 0 and stays_above(path, floats, ints, at, reach):
        return NEVER
    length = length_bound(path)
    if clear_piece(path, length, 0.0, 1.0, floats, ints, at, reach):
        return NEVER
    return search(path, length, floats, ints, at, reach)
