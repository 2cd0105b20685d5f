# mypy: ignore-errors
"""Rays against the whole scene: what is met first, or how much light comes through."""

from numba import types

from renderers.tracing.scene_kernels import (
    GRID,
    HALF_SPACE,
    ITEMS,
    KIND,
    LINK,
    LINKS_AT,
    NODE_COUNT,
    NODES_AT,
    QUADRIC,
    RAY,
    REALS_AT,
    ROUND,
    SCENE,
    SCRATCH,
    SHAPE,
    SHEET,
    SURFACE_AT,
    TOLD,
    TRANSMISSION,
    TRIANGLE,
    crossing_at,
    part,
)
from renderers.tracing.solids_kernels import NONE, half_space, inverse, quadric, round_solid, triangle
from sceneql.kernels import kernel


@part
def meet(scene, scratch, item, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """First crossing of an item inside (near, far), or inf; ``anywhere``: of an implicit object any inner place."""
    kind = scene.ints[ITEMS + 4 * item + KIND]
    k = scene.ints[ITEMS + 4 * item + REALS_AT]
    if kind == HALF_SPACE:
        return half_space(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == TRIANGLE:
        return triangle(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == ROUND:
        return round_solid(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == QUADRIC:
        return quadric(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == GRID:
        return crossing_at(scene.grid)(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere)
    last = scratch.shape[0] - 1
    if scratch[last, TOLD] != 0.0:
        t = scratch[last - 1 - scene.ints[ITEMS + 4 * item + SHAPE], 0]
        if t == t:
            return t if near < t < far else NONE
    crossing = scene.sheet if kind == SHEET else scene.solid
    return crossing_at(crossing)(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere)


@part
def misses(nodes, k, ox, oy, oz, ix, iy, iz, near, far):
    """Whether a ray (by its inverse direction) passes a node's box by."""
    a = (nodes[k] - ox) * ix
    b = (nodes[k + 3] - ox) * ix
    enter = max(near, min(a, b))
    leave = min(far, max(a, b))
    a = (nodes[k + 1] - oy) * iy
    b = (nodes[k + 4] - oy) * iy
    enter = max(enter, min(a, b))
    leave = min(leave, max(a, b))
    a = (nodes[k + 2] - oz) * iz
    b = (nodes[k + 5] - oz) * iz
    return min(leave, max(a, b)) < max(enter, min(a, b))


@kernel(types.Tuple((types.float64, types.int64, types.float64))(SCENE, SCRATCH, *RAY, types.boolean), _nrt=False)
def walk(scene, scratch, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """(t, item, light) of the ray inside (near, far): where it first meets an item, or (inf, -1, 1).

    With ``anywhere``, for shadow rays, the walk ends as soon as something opaque is met, no matter where; ``light`` is
    the share that comes through: clear glass dims it, but does not stop it.
    """
    ix = inverse(dx)
    iy = inverse(dy)
    iz = inverse(dz)
    nodes = scene.ints[NODES_AT]
    links = scene.ints[LINKS_AT]
    best = far
    where = NONE
    found = -1
    light = 1.0
    n = 0
    while n < scene.ints[NODE_COUNT]:
        link = links + LINK * n
        if misses(scene.reals, nodes + 6 * n, ox, oy, oz, ix, iy, iz, near, best):
            n = scene.ints[link]
            continue
        first = int(scene.ints[link + 1])
        for item in range(first, first + scene.ints[link + 2]):
            t = meet(scene, scratch, item, ox, oy, oz, dx, dy, dz, near, best, anywhere)
            if not t < best:
                continue
            where = t
            found = item
            if not anywhere:
                best = t
                continue
            light *= 0.95 * scene.reals[scene.ints[ITEMS + 4 * item + SURFACE_AT] + TRANSMISSION]
            if light == 0.0:
                return where, found, light
        n += 1
    return where, found, light
