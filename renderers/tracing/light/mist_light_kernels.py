# mypy: ignore-errors
"""Light in mists: what each place of one sends, by single scattering of lamps and by light from around.

A mist takes light from a ray by its absorption and sends its color's share of that on, alike in all directions, so what
it sends where it is thick is its color times the mean of the radiance that arrives over all directions
(Chandrasekhar, Radiative Transfer, 1950, chapter I).
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.bounce_kernels import OPEN_SKY, THROUGH, follow, lost, set_out
from renderers.tracing.light.embers_kernels import met
from renderers.tracing.light.light_kernels import sky_radiance
from renderers.tracing.light.lights_kernels import light_at, reach
from renderers.tracing.light.through_kernels import CLEAR, clearness, go_through
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, mists_at, part
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.solids_kernels import local_point
from renderers.tracing.solids.surface_kernels import normal_at
from sceneql.compiled.kernels import kernel

_i = types.int64
_ways = types.float64[:, ::1]
_around = types.float64[:, :, :, ::1]
NEAREST = 0.5
"""Distance of a lamp [cells] below which it is no brighter: a node stands for its cell."""
COMES, WHOLE, AT, REACH = 0, 3, 6, 9
"""Columns of a place around: radiance of sky and surfaces that comes through mists, that with what mists send (3 each),
where it is (3), and from there on how far it sees in each direction."""
OUT = 1e-3
"""Part of its way out of a solid by which a place is moved farther."""
WIDE = 0.1
"""Radius of the cones by which surfaces around are seen, by their distance."""


@part
def node_counts(u, at):
    """Nodes along x, y, z of the mist whose reals begin at ``at``."""
    return int(u[at + layout.NODES]), int(u[at + layout.NODES + 1]), int(u[at + layout.NODES + 2])


@part
def of_use(u, at, nx, ny, nz, i, j, l):
    """Whether there is mist in one of the eight cells around a node."""
    for c in range(max(l - 1, 0), min(l + 1, nz - 1) + 1):
        for b in range(max(j - 1, 0), min(j + 1, ny - 1) + 1):
            for a in range(max(i - 1, 0), min(i + 1, nx - 1) + 1):
                if u[at + layout.ABSORPTION + (c * ny + b) * nx + a] > 0.0:
                    return True
    return False


@kernel(types.void(SCENE, SCRATCH, _i, _i), _nrt=False)
def light_nodes(scene, scratch, at, l):
    """Write what the nodes of layer l of a mist send of the light of lamps and suns, scattered once."""
    u = scene.reals
    nx, ny, nz = node_counts(u, at)
    source = at + layout.ABSORPTION + nx * ny * nz
    cell = np.sqrt(u[at + layout.TO_WORLD] ** 2 + u[at + layout.TO_WORLD + 4] ** 2 + u[at + layout.TO_WORLD + 8] ** 2)
    for j in range(ny):
        for i in range(nx):
            if not of_use(u, at, nx, ny, nz, i, j, l):
                continue
            x, y, z = local_point(u, at + layout.TO_WORLD, float(i), float(j), float(l), 1.0)
            r = g = b = 0.0
            for light in range(scene.ints[layout.LIGHT_COUNT]):
                dx, dy, dz, far, ir, ig, ib = light_at(u, light, x, y, z)
                if far < np.inf:
                    dim = min(1.0, (far / (NEAREST * cell)) ** 2)
                    ir, ig, ib = dim * ir, dim * ig, dim * ib
                    far = reach(far, u[layout.LIGHTS + layout.LIGHT * light + 7], 1.0)
                _, _, share = walk(scene, scratch, x, y, z, dx, dy, dz, 0.0, far, True)
                if share > 0.0:
                    share *= mists_at(scene.mist)(scene, x, y, z, dx, dy, dz, 0.0, far, layout.LEFT)[0]
                    share /= 4.0 * np.pi
                    r, g, b = r + share * ir, g + share * ig, b + share * ib
            node = source + 3 * ((l * ny + j) * nx + i)
            u[node] = u[at + layout.MIST_COLOR] * r
            u[node + 1] = u[at + layout.MIST_COLOR + 1] * g
            u[node + 2] = u[at + layout.MIST_COLOR + 2] * b


@part
def scaled(index, count, wanted):
    """The place among ``wanted`` numbers, spread as far, of one of ``count``."""
    return index / (count - 1) * (wanted - 1)


@part
def place_in(u, at, around, i, j, l):
    """The world's place (3) of a place of ``around``, which are spread over the mist's grid."""
    nx, ny, nz = node_counts(u, at)
    x, y, z = scaled(i, around.shape[2], nx), scaled(j, around.shape[1], ny), scaled(l, around.shape[0], nz)
    return local_point(u, at + layout.TO_WORLD, x, y, z, 1.0)


@part
def in_the_open(scene, scratch, directions, x, y, z):
    """A place (3), or where it leaves the solid that it is in, in the direction in which that is nearest."""
    nearest, way = np.inf, -1
    for d in range(directions.shape[0]):
        dx, dy, dz = directions[d, 0], directions[d, 1], directions[d, 2]
        t, item, _ = walk(scene, scratch, x, y, z, dx, dy, dz, 0.0, nearest, False)
        if item >= 0 and t < nearest and clearness(scene, item) <= CLEAR:
            skin = normal_at(scene, scratch, item, x + t * dx, y + t * dy, z + t * dz)
            nearest, way = t, (d if skin[3] * dx + skin[4] * dy + skin[5] * dz > 0.0 else -1)
    if way < 0:
        return x, y, z
    nearest *= 1.0 + OUT
    return (
        x + nearest * directions[way, 0],
        y + nearest * directions[way, 1],
        z + nearest * directions[way, 2],
    )


@kernel(types.void(SCENE, SCRATCH, ASKED, types.float64[::1], _i, _ways, _around, _i), _nrt=False)
def gather_around(scene, scratch, asked, way, at, directions, around, l):
    """Write the mean of the radiance of sky and surfaces that comes through mists, at the places of layer l.

    The first guess of it with what mists send is that which would come without them: equal light from all sides stays
    equal in white mist. ``asked`` (1, ANSWERS) is PLAIN, and ``way`` (WAY,)
    working memory.
    """
    u = scene.reals
    for j in range(around.shape[1]):
        for i in range(around.shape[2]):
            out = around[l, j, i]
            out[:] = 0.0
            x, y, z = in_the_open(scene, scratch, directions, *place_in(u, at, around, i, j, l))
            out[AT], out[AT + 1], out[AT + 2] = x, y, z
            for d in range(directions.shape[0]):
                dx, dy, dz = directions[d, 0], directions[d, 1], directions[d, 2]
                t, item, _ = walk(scene, scratch, x, y, z, dx, dy, dz, 0.0, np.inf, False)
                r, g, b = sky_radiance(u, dy)
                if item >= 0:
                    way[OPEN_SKY], way[OPEN_SKY + 1], way[OPEN_SKY + 2] = r, g, b
                    way[THROUGH] = np.nan
                    first, radius = t, WIDE * t
                    if clearness(scene, item) > CLEAR:
                        t, item, glass = go_through(scene, scratch, x, y, z, dx, dy, dz, t, radius, item)
                        for c in range(6):
                            way[THROUGH + c] = glass[c]
                        if item < 0:
                            r, g, b = glass[3] + glass[0] * r, glass[4] + glass[1] * g, glass[5] + glass[2] * b
                    if item >= 0:
                        share = met(scene, item, x, y, z)
                        px, py, pz = x + t * dx, y + t * dy, z + t * dz
                        set_out(scene, way, item, px, py, pz, dx, dy, dz, radius, d, share)
                        follow(scene, scratch, asked, way)
                        lr, lg, lb = lost(way)
                        r, g, b = r - lr, g - lg, b - lb
                    t = first
                out[REACH + d] = t
                left = mists_at(scene.mist)(scene, x, y, z, dx, dy, dz, 0.0, t, layout.LEFT)[0]
                r, g, b = r / directions.shape[0], g / directions.shape[0], b / directions.shape[0]
                for c in range(3):
                    out[COMES + c] += left * (r, g, b)[c]
                    out[WHOLE + c] += (r, g, b)[c]


@kernel(types.void(SCENE, _i, _ways, _around, _i), _nrt=False)
def scatter_again(scene, at, directions, around, l):
    """Add to the light from around what mists send now, at the places of layer l."""
    for j in range(around.shape[1]):
        for i in range(around.shape[2]):
            out = around[l, j, i]
            x, y, z = out[AT], out[AT + 1], out[AT + 2]
            r = g = b = 0.0
            for d in range(directions.shape[0]):
                dx, dy, dz = directions[d, 0], directions[d, 1], directions[d, 2]
                _, mr, mg, mb = mists_at(scene.mist)(scene, x, y, z, dx, dy, dz, 0.0, out[REACH + d], layout.LIGHT)
                r, g, b = r + mr, g + mg, b + mb
            for c in range(3):
                out[WHOLE + c] = out[COMES + c] + (r, g, b)[c] / directions.shape[0]


@kernel(types.void(SCENE, _i, types.float64[::1], _around, _i), _nrt=False)
def spread(scene, at, lamps, around, l):
    """Write what the nodes of layer l of a mist send: of lamps, as kept in ``lamps``, and of the light from around."""
    u = scene.reals
    nx, ny, nz = node_counts(u, at)
    source = at + layout.ABSORPTION + nx * ny * nz
    mz, my, mx = around.shape[0], around.shape[1], around.shape[2]
    w = scaled(l, nz, mz)
    c = min(int(w), mz - 2)
    w -= c
    for j in range(ny):
        v = scaled(j, ny, my)
        b = min(int(v), my - 2)
        v -= b
        for i in range(nx):
            if not of_use(u, at, nx, ny, nz, i, j, l):
                continue
            s = scaled(i, nx, mx)
            a = min(int(s), mx - 2)
            s -= a
            red = green = blue = 0.0
            for corner in range(8):
                share = s if corner & 1 else 1.0 - s
                share *= v if corner & 2 else 1.0 - v
                share *= w if corner & 4 else 1.0 - w
                place = around[c + (corner >> 2), b + (corner >> 1 & 1), a + (corner & 1)]
                red, green = red + share * place[WHOLE], green + share * place[WHOLE + 1]
                blue += share * place[WHOLE + 2]
            node = 3 * ((l * ny + j) * nx + i)
            u[source + node] = lamps[node] + u[at + layout.MIST_COLOR] * red
            u[source + node + 1] = lamps[node + 1] + u[at + layout.MIST_COLOR + 1] * green
            u[source + node + 2] = lamps[node + 2] + u[at + layout.MIST_COLOR + 2] * blue
