# mypy: ignore-errors
"""Rays against the whole scene: the first hit, or the light that comes through; at once, or by packets."""

from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import ASKED, RAY, SCENE, SCRATCH, crossing_at, part
from renderers.tracing.solids.solids_kernels import NONE, half_space, inverse, quadric, round_solid, triangle
from renderers.tracing.solids.thin_capsules_kernels import thin_round
from sceneql.compiled.kernels import kernel


@part
def meet(scene, scratch, item, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """First crossing of an item inside (near, far), or inf; ``anywhere``: of an implicit object any inner place."""
    kind = scene.ints[layout.ITEMS + 4 * item + layout.KIND]
    k = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
    if kind == layout.HALF_SPACE:
        return half_space(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == layout.TRIANGLE:
        return triangle(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == layout.ROUND:
        return round_solid(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == layout.QUADRIC:
        return quadric(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    if kind == layout.THIN:
        return thin_round(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far)
    last = scratch.shape[0] - 1
    if scratch[last, layout.TOLD] >= layout.PROBING:
        reached = layout.REACHED if kind == layout.IMPLICIT else layout.BEYOND
        scratch[last, layout.TOLD] = max(scratch[last, layout.TOLD], reached)
        return NONE
    if kind == layout.GRID:
        return crossing_at(scene.grid)(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere)
    if scratch[last, layout.TOLD] != 0.0:
        t = scratch[last - 1 - scene.ints[layout.ITEMS + 4 * item + layout.SHAPE], 0]
        if t == t:
            return t if near <= t < far else NONE
    crossing = scene.sheet if kind == layout.SHEET else scene.solid
    return crossing_at(crossing)(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere)


@part
def misses(nodes, k, ox, oy, oz, ix, iy, iz, near, far):
    """Whether a ray (by its inverse direction) misses a node's box."""
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


MET = types.Tuple((types.float64, types.int64, types.float64))


@kernel(MET(SCENE, SCRATCH, *RAY, types.boolean), _nrt=False)
def walk(scene, scratch, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """(t, item, light) of the ray inside (near, far): its first hit, or (inf, -1, 1) for a miss.

    With ``anywhere``, for shadow rays, the walk ends at any hit of an opaque item; ``light`` is the share that comes
    through, straight: clear glass dims it, and its color, by the mean of its channels, but throws no caustics.
    """
    ix = inverse(dx)
    iy = inverse(dy)
    iz = inverse(dz)
    nodes = scene.ints[layout.NODES_AT]
    links = scene.ints[layout.LINKS_AT]
    best = far
    where = NONE
    found = -1
    light = 1.0
    n = 0
    while n < scene.ints[layout.NODE_COUNT]:
        link = links + layout.LINK * n
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
            s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
            light *= 0.95 * scene.reals[s + layout.TRANSMISSION]
            if light == 0.0:
                return where, found, light
            light *= (scene.reals[s] + scene.reals[s + 1] + scene.reals[s + 2]) / 3.0
        n += 1
    return where, found, light


@part
def put_ray(asked, row, ox, oy, oz, dx, dy, dz, far, want):
    """Write a ray into a row of the list for packets."""
    asked[row, 0], asked[row, 1], asked[row, 2] = ox, oy, oz
    asked[row, 3], asked[row, 4], asked[row, 5] = dx, dy, dz
    asked[row, layout.FAR] = far
    asked[row, layout.WANT] = want


@part
def tell(scratch, asked, row):
    """Hand a ray's answers from packets to the next walk."""
    last = scratch.shape[0] - 1
    scratch[last, layout.TOLD] = layout.KNOWN
    for column in range(layout.ANSWERS, asked.shape[1]):
        scratch[last - 1 - int(asked[0, column]), 0] = asked[row, column]


@part
def join(scene, scratch, asked, row, far, anywhere):
    """(whether a listed ray is told by its row alone, what ``walk`` would return for it).

    The walk past all that packets know is joined with their nearest crossing. Where it takes the order in which the
    walk meets several things, the ray is not told: of a shadow ray with two blockers, or with two hits in one place.
    """
    where, item, light = asked[row, layout.REST_AT], asked[row, layout.REST_ITEM], asked[row, layout.REST_LIGHT]
    if asked[row, layout.WANT] == layout.NOTHING:
        return True, where, int(item), light
    if item == layout.WALKED:
        return False, where, -1, light
    nearest, of, several = NONE, 0, False
    for column in range(layout.ANSWERS, asked.shape[1]):
        t = asked[row, column]
        if t != t:
            return False, where, -1, light
        if 0.0 <= t < far:
            several = t == nearest or (anywhere and nearest < NONE) or (several and t > nearest)
            if t < nearest:
                nearest, of = t, int(asked[0, column])
    if nearest == NONE:
        return True, where, int(item), light
    if several or nearest == where or (anywhere and item >= 0):
        return False, where, -1, light
    if where < nearest:
        return True, where, int(item), light
    found = int(scratch[scratch.shape[0] - 2 - of, layout.ITEM_OF])
    if anywhere:
        s = scene.ints[layout.ITEMS + 4 * found + layout.SURFACE_AT]
        light = 0.95 * scene.reals[s + layout.TRANSMISSION]
        if light != 0.0:
            light *= (scene.reals[s] + scene.reals[s + 1] + scene.reals[s + 2]) / 3.0
    return True, nearest, found, light


@kernel(MET(SCENE, SCRATCH, ASKED, types.int64, types.boolean), _nrt=False, inner=True)
def walk_told(scene, scratch, asked, row, anywhere):
    """As ``walk`` for a listed ray, with its answers."""
    ray, last = asked[row], scratch.shape[0] - 1
    tell(scratch, asked, row)
    far = ray[layout.FAR]
    t, item, light = walk(scene, scratch, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], 0.0, far, anywhere)
    scratch[last, layout.TOLD] = 0.0
    return t, item, light


@part
def answer(scene, scratch, asked, anywhere):
    """As ``walk`` for the next ray of the list, by its answers."""
    row = int(asked[0, layout.NEXT])
    asked[0, layout.NEXT] = row + 1
    told, t, item, light = join(scene, scratch, asked, row, asked[row, layout.FAR], anywhere)
    if told:
        return t, item, light
    return walk_told(scene, scratch, asked, row, anywhere)


@kernel(MET(SCENE, SCRATCH, ASKED, *RAY[1:], types.boolean), _nrt=False, inner=True)
def walk_asking(scene, scratch, asked, ox, oy, oz, dx, dy, dz, far, anywhere):
    """``seek`` in the mode PLAIN, and where packets do not know all of the scene."""
    if asked[0, layout.MODE] == layout.PLAIN:
        return walk(scene, scratch, ox, oy, oz, dx, dy, dz, 0.0, far, anywhere)
    row = int(asked[0, layout.NEXT])
    asked[0, layout.NEXT] = row + 1
    last = scratch.shape[0] - 1
    scratch[last, layout.TOLD] = layout.PROBING
    t, item, light = walk(scene, scratch, ox, oy, oz, dx, dy, dz, 0.0, far, anywhere)
    reached = scratch[last, layout.TOLD]
    scratch[last, layout.TOLD] = 0.0
    asked[row, layout.REST_AT], asked[row, layout.REST_ITEM], asked[row, layout.REST_LIGHT] = t, item, light
    if reached < layout.REACHED:
        put_ray(asked, row, ox, oy, oz, dx, dy, dz, far, layout.NOTHING)
        return t, item, light
    if reached == layout.BEYOND:
        asked[row, layout.REST_ITEM] = layout.WALKED
    asked[0, layout.OPEN] = 1.0
    put_ray(asked, row, ox, oy, oz, dx, dy, dz, far, layout.ANYWHERE if anywhere else layout.FIRST)
    return NONE, -1, 1.0


@part
def seek(scene, scratch, asked, ox, oy, oz, dx, dy, dz, far, anywhere):
    """As ``walk`` from the ray's origin on, in the modes PLAIN and ASKING: in this an open ray is listed and misses."""
    if asked[0, layout.MODE] == layout.ASKING and asked[0, layout.ALONE] != 0.0:
        row = int(asked[0, layout.NEXT])
        asked[0, layout.NEXT] = row + 1
        asked[0, layout.OPEN] = 1.0
        put_ray(asked, row, ox, oy, oz, dx, dy, dz, far, layout.ANYWHERE if anywhere else layout.FIRST)
        return NONE, -1, 1.0
    return walk_asking(scene, scratch, asked, ox, oy, oz, dx, dy, dz, far, anywhere)


@part
def ask(scene, scratch, asked, ox, oy, oz, dx, dy, dz, far, anywhere):
    """``seek``, or in the mode TELLING ``answer``."""
    if asked[0, layout.MODE] == layout.TELLING:
        return answer(scene, scratch, asked, anywhere)
    return seek(scene, scratch, asked, ox, oy, oz, dx, dy, dz, far, anywhere)
