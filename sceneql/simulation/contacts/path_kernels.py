# mypy: ignore-errors
"""The path of a body between two instants, and the first place where it meets a surface.

A path is 13 floats: place and velocity at the start, place and velocity at the end, duration: a cubic Hermite curve.
"""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.contacts.impulse_kernels import STILL
from sceneql.simulation.contacts.shape_kernels import DEPTH, FLAT, clear, facing, surface
from sceneql.system_kernels import A, F, I, N

NEVER = 2.0
TOUCH = 1e-12
"""Distance, as a part of the coordinates (or of a meter), below which a body touches."""


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
def gap_at(path, s, floats, ints, at, reach):
    """Distance of the body from the surface at s."""
    x, y, z = place(path, s)
    return surface(floats, ints, at, x, y, z)[0] - reach


@lean_inlined
def root(path, floats, ints, at, reach, contact, deflate, low, f_low, high, f_high):
    """The zero of gap - contact in [low, high] by false position (Illinois rule: Dowell & Jarratt 1971)."""
    side = 0
    last = high
    for _ in range(80):
        if f_low <= 0.0:
            return low
        s = low + (high - low) * f_low / (f_low - f_high)
        if abs(s - last) <= 1e-15:
            return s
        last = s
        f = gap_at(path, s, floats, ints, at, reach) - contact
        if deflate:
            f /= s
        if f >= 0.0:
            low, f_low = s, f
            if side > 0:
                f_high *= 0.5
            side = 1
        else:
            high, f_high = s, f
            if side < 0:
                f_low *= 0.5
            side = -1
    return last


@lean_inlined
def clear_piece(path, length, s, ds, floats, ints, at, reach):
    """Whether it is proved that a body of that reach is clear of the object from s to s + ds."""
    x, y, z = place(path, s + 0.5 * ds)
    return clear(floats, ints, at, x, y, z, 0.5 * ds * length + reach)


@lean_inlined
def stays_above(path, floats, ints, at, reach):
    """Whether a path does not come down to a plane, or not below where it starts to leave it: by its control points."""
    third = path[12] / 3.0
    start, nx, ny, nz = facing(floats, ints, at, path[0], path[1], path[2])
    end = facing(floats, ints, at, path[6], path[7], path[8])[0]
    leaves = start + third * (path[3] * nx + path[4] * ny + path[5] * nz)
    comes = end - third * (path[9] * nx + path[10] * ny + path[11] * nz)
    lowest = min(end, min(leaves, comes))
    return lowest >= start if start <= reach else lowest > reach


@lean(types.float64(A, A, I, N, F), inner=True)
def first_contact(path, floats, ints, at, reach):
    """Where on the path (0 <= s <= 1) a body of that reach first enters the object at ints[at:]; NEVER if nowhere.

    Pieces of the path are proved to be clear of the object, halved where they are not, down to those that are shorter
    than half the object's depth, which cannot jump over it: there the gap is looked at. A body that touches at the
    start and approaches has s = 0; one that leaves is followed until it comes back.
    """
    if ints[at + FLAT] != 0 and stays_above(path, floats, ints, at, reach):
        return NEVER
    length = length_bound(path)
    if clear_piece(path, length, 0.0, 1.0, floats, ints, at, reach):
        return NEVER
    x, y, z = place(path, 0.0)
    d, nx, ny, nz = surface(floats, ints, at, x, y, z)
    start = d - reach
    touch = TOUCH * max(1.0, max(abs(x), max(abs(y), abs(z))))
    leaving = start <= touch
    approach = (path[3] * nx + path[4] * ny + path[5] * nz) * path[12]
    if leaving and approach < -STILL * path[12]:
        return 0.0
    if length == 0.0:
        return NEVER
    smallest = min(0.125, (floats[ints[at + DEPTH]] + reach) / length)
    contact = min(start, 0.0)
    slack = touch if leaving else 0.0
    low, s, ds = 0.0, 0.0, 0.5
    while s < 1.0:
        ds = min(ds, 1.0 - s)
        while ds > smallest and not clear_piece(path, length, s, ds, floats, ints, at, reach):
            ds *= 0.5
        if ds > smallest:
            s, ds = s + ds, 2.0 * ds
            leaving, contact, slack, low = False, 0.0, 0.0, s
            continue
        s = min(1.0, s + smallest)
        gap = gap_at(path, s, floats, ints, at, reach)
        if gap < contact - slack:
            if leaving:  # not yet apart: the root at the start is divided out
                return root(path, floats, ints, at, reach, start, True, 0.0, approach, s, (gap - start) / s)
            above = gap_at(path, low, floats, ints, at, reach)
            return root(path, floats, ints, at, reach, 0.0, False, low, above, s, gap)
        if gap > touch:
            leaving, contact, slack, low = False, 0.0, 0.0, s
        ds = 2.0 * smallest
    return NEVER
