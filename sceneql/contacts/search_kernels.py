# mypy: ignore-errors
"""The first contact on a path that is not proved to be clear of a surface; compiled at the first such path."""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.body_path_kernels import NEVER, SEARCH, clear_piece, place
from sceneql.contacts.impact_kernels import STILL
from sceneql.contacts.shape_kernels import surface

TOUCH = 1e-12
"""Distance, relative to the coordinates (or to a meter), below which a body touches."""


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


@lean(SEARCH, inner=True)
def search(path, length, floats, ints, at, reach):
    """Where on a path of at most ``length`` [m] a body of radius ``reach`` first enters an object (`first_contact`).

    Pieces of the path that are not proved to be clear of the object are halved until they are shorter than half the
    object's depth and cannot jump over it: there the gap is evaluated.
    """
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
    smallest = min(0.125, (floats[ints[at + layout.DEPTH]] + reach) / length)
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
            if leaving:  # not yet apart: deflate the root at the start
                return root(path, floats, ints, at, reach, start, True, 0.0, approach, s, (gap - start) / s)
            above = gap_at(path, low, floats, ints, at, reach)
            return root(path, floats, ints, at, reach, 0.0, False, low, above, s, gap)
        if gap > touch:
            leaving, contact, slack, low = False, 0.0, 0.0, s
        ds = 2.0 * smallest
    return NEVER
