# mypy: ignore-errors
"""Normal and color of an item at a hit, and the distance of a smooth mesh's facets from the curved surface."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import SCENE, SCRATCH, part, skin_at, texture_at
from renderers.tracing.solids.solids_kernels import local_point
from sceneql.compiled.kernels import kernel

TRIANGLE_NORMALS, TRIANGLE_COLORS, ROUND_COLOR = 9, 18, 7
_f = types.float64


@part
def unit(x, y, z):
    """The vector scaled to length one; (0, 1, 0) for a zero vector."""
    length = np.sqrt(x * x + y * y + z * z)
    if not length > 0.0:
        return 0.0, 1.0, 0.0
    return x / length, y / length, z / length


@part
def quadric_normal(q, k, x, y, z):
    """Outward unit normal of quadric k at a point of its surface: of its box or of the quadric, if that is nearer."""
    p = local_point(q, k, x, y, z, 1.0)
    value = q[k + 18]
    size2 = 0.0
    for axis in range(3):
        slope = 2.0 * q[k + 12 + axis] * p[axis] + q[k + 15 + axis]
        value += (q[k + 12 + axis] * p[axis] + q[k + 15 + axis]) * p[axis]
        size2 += slope * slope
    closest = abs(value) / np.sqrt(size2) if size2 > 0.0 else np.inf
    face, sign = -1, 1.0
    for axis in range(3):
        if abs(p[axis] - q[k + 19 + axis]) < closest:
            closest, face, sign = abs(p[axis] - q[k + 19 + axis]), axis, -1.0
        if abs(p[axis] - q[k + 22 + axis]) < closest:
            closest, face, sign = abs(p[axis] - q[k + 22 + axis]), axis, 1.0
    a, b, c = 0.0, 0.0, 0.0
    for axis in range(3):
        slope = 2.0 * q[k + 12 + axis] * p[axis] + q[k + 15 + axis]
        if face >= 0:
            slope = sign if axis == face else 0.0
        a += slope * q[k + 4 * axis]
        b += slope * q[k + 4 * axis + 1]
        c += slope * q[k + 4 * axis + 2]
    return unit(a, b, c)


@part
def round_normal(r, k, x, y, z):
    """Outward unit normal of a capsule: from the nearest point of its axis."""
    ux, uy, uz = r[k + 3], r[k + 4], r[k + 5]
    px, py, pz = x - r[k], y - r[k + 1], z - r[k + 2]
    uu = ux * ux + uy * uy + uz * uz
    s = 0.0
    if uu > 0.0:
        s = min(max((px * ux + py * uy + pz * uz) / uu, 0.0), 1.0)
    return unit(px - s * ux, py - s * uy, pz - s * uz)


@part
def barycentric(m, k, x, y, z):
    """Weights of the second and third corner of triangle k at a point of its plane."""
    ax, ay, az, bx, by, bz = m[k + 3], m[k + 4], m[k + 5], m[k + 6], m[k + 7], m[k + 8]
    px, py, pz = x - m[k], y - m[k + 1], z - m[k + 2]
    aa = ax * ax + ay * ay + az * az
    ab = ax * bx + ay * by + az * bz
    bb = bx * bx + by * by + bz * bz
    pa = px * ax + py * ay + pz * az
    pb = px * bx + py * by + pz * bz
    rest = aa * bb - ab * ab
    if rest == 0.0:
        return 0.0, 0.0
    return (bb * pa - ab * pb) / rest, (aa * pb - ab * pa) / rest


@part
def triangle_normal(scene, k, x, y, z):
    """(normal, facet normal, lifts): heights of the surface that the normals imply, above the facet and below it.

    A shadow ray that starts lifted does not see the facets (Hanika 2021, Hacking the Shadow Terminator); from the back
    of the facet it starts as far below.
    """
    m = scene.reals
    fx, fy, fz = unit(
        m[k + 4] * m[k + 8] - m[k + 5] * m[k + 7],
        m[k + 5] * m[k + 6] - m[k + 3] * m[k + 8],
        m[k + 3] * m[k + 7] - m[k + 4] * m[k + 6],
    )
    c = k + TRIANGLE_NORMALS
    if m[c] != m[c]:
        return fx, fy, fz, fx, fy, fz, 0.0, 0.0
    v, w = barycentric(m, k, x, y, z)
    nx, ny, nz, lift, sink = 0.0, 0.0, 0.0, 0.0, 0.0
    for corner in range(3):
        weight = 1.0 - v - w if corner == 0 else (v if corner == 1 else w)
        at = 3 * corner
        ex, ey, ez = m[c + at], m[c + at + 1], m[c + at + 2]
        nx += weight * ex
        ny += weight * ey
        nz += weight * ez
        cx, cy, cz = m[k], m[k + 1], m[k + 2]
        if corner > 0:
            cx, cy, cz = cx + m[k + at], cy + m[k + at + 1], cz + m[k + at + 2]
        height = weight * ((cx - x) * ex + (cy - y) * ey + (cz - z) * ez)
        lift, sink = lift + max(0.0, height), sink + max(0.0, -height)
    nx, ny, nz = unit(nx, ny, nz)
    return nx, ny, nz, fx, fy, fz, lift, sink


@part
def corner_mean(m, k, c, x, y, z):
    """At a point of triangle k the three numbers that stand from c on for its first corner, then for the others."""
    v, w = barycentric(m, k, x, y, z)
    u = 1.0 - v - w
    return (
        u * m[c] + v * m[c + 3] + w * m[c + 6],
        u * m[c + 1] + v * m[c + 4] + w * m[c + 7],
        u * m[c + 2] + v * m[c + 5] + w * m[c + 8],
    )


@kernel(types.UniTuple(_f, 11)(SCENE, SCRATCH, types.int64, _f, _f, _f), _nrt=False)
def normal_at(scene, scratch, item, x, y, z):
    """(normal, facet normal, lift above the facet and below it, paint) of an item at a point of its surface.

    Only for meshes the two normals differ; the paint (3) is NaN where the point has no color of its own.
    """
    kind = scene.ints[layout.ITEMS + 4 * item + layout.KIND]
    k = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
    if kind == layout.TRIANGLE:
        nx, ny, nz, fx, fy, fz, lift, sink = triangle_normal(scene, k, x, y, z)
        r, g, b = np.nan, np.nan, np.nan
        ranges = int(scene.reals[scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT] + layout.TEXTURE])
        if ranges > 0:
            px, py, pz = corner_mean(scene.reals, k, k + TRIANGLE_COLORS, x, y, z)
            r, g, b = texture_at(scene.texture)(scene, scratch, ranges, px, py, pz)
        return nx, ny, nz, fx, fy, fz, lift, sink, r, g, b
    r, g, b = np.nan, np.nan, np.nan
    if kind == layout.ROUND or kind == layout.THIN:
        nx, ny, nz = round_normal(scene.reals, k, x, y, z)
    elif kind == layout.QUADRIC:
        nx, ny, nz = quadric_normal(scene.reals, k, x, y, z)
    elif kind == layout.HALF_SPACE:
        nx, ny, nz = scene.reals[k], scene.reals[k + 1], scene.reals[k + 2]
    elif kind == layout.GRID:
        nx, ny, nz, r, g, b = skin_at(scene.grid_skin)(scene, scratch, k, x, y, z)
    else:
        nx, ny, nz, r, g, b = skin_at(scene.skin)(scene, scratch, k, x, y, z)
    return nx, ny, nz, nx, ny, nz, 0.0, 0.0, r, g, b


@part
def skin_of(scene, scratch, item, x, y, z):
    """``normal_at``, of half-spaces and quadrics without a call, whose many numbers take longer than these."""
    kind = scene.ints[layout.ITEMS + 4 * item + layout.KIND]
    k = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
    if kind == layout.HALF_SPACE:
        nx, ny, nz = scene.reals[k], scene.reals[k + 1], scene.reals[k + 2]
    elif kind == layout.QUADRIC:
        nx, ny, nz = quadric_normal(scene.reals, k, x, y, z)
    else:
        return normal_at(scene, scratch, item, x, y, z)
    return nx, ny, nz, nx, ny, nz, 0.0, 0.0, np.nan, np.nan, np.nan


@part
def wave(x, width):
    """Mean over x +- width/2 of the square wave that is 1 on [0, 1), -1 on [1, 2), and so on."""
    if width < 1e-6:
        return 1.0 if x - 2.0 * np.floor(0.5 * x) < 1.0 else -1.0
    a = x + 0.5 * width
    b = x - 0.5 * width
    a = abs(a - 2.0 * np.floor(0.5 * a + 0.5))
    b = abs(b - 2.0 * np.floor(0.5 * b + 0.5))
    return (a - b) / width


@part
def checkered(x, y, z, wx, wy, wz, flat, size):
    """Share of the checker color in a box wx, wy, wz wide around a point; on horizontal faces y does not count."""
    product = wave(x / size, wx / size) * wave(z / size, wz / size)
    if not flat:
        product *= wave(y / size, wy / size)
    return 0.5 - 0.5 * product


@part
def color_at(scene, item, paint, x, y, z, nx, ny, nz, dx, dy, dz, radius):
    """Color of an item at a point: its paint, its own or its surface's, or the checker's mean over the ray's cone."""
    kind = scene.ints[layout.ITEMS + 4 * item + layout.KIND]
    k = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    u = scene.reals
    r, g, b = u[s + layout.COLOR], u[s + layout.COLOR + 1], u[s + layout.COLOR + 2]
    c = k + (TRIANGLE_COLORS if kind == layout.TRIANGLE else ROUND_COLOR)
    if paint[0] == paint[0] and paint[1] == paint[1] and paint[2] == paint[2]:
        r, g, b = paint
    elif kind == layout.TRIANGLE and u[c] == u[c] and u[s + layout.TEXTURE] == 0.0:
        r, g, b = corner_mean(u, k, c, x, y, z)
    elif (kind == layout.ROUND or kind == layout.THIN) and u[c] == u[c]:
        r, g, b = u[c], u[c + 1], u[c + 2]
    size = u[s + layout.CHECKER]
    if size > 0.0:
        # The cone cuts the surface in an ellipse: 2 radius across, longer along the ray's direction in the surface.
        slant = max(abs(dx * nx + dy * ny + dz * nz), 1e-4)
        hx, hy, hz = dx + slant * nx, dy + slant * ny, dz + slant * nz
        lean = np.sqrt(hx * hx + hy * hy + hz * hz)
        if lean > 1e-9:
            hx, hy, hz = hx / lean, hy / lean, hz / lean
        ex, ey, ez = ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx
        wx = 2.0 * radius * np.sqrt(ex * ex + (hx / slant) ** 2)
        wy = 2.0 * radius * np.sqrt(ey * ey + (hy / slant) ** 2)
        wz = 2.0 * radius * np.sqrt(ez * ez + (hz / slant) ** 2)
        m = checkered(x, y, z, wx, wy, wz, abs(ny) > 0.9, size)
        r += m * (u[s + layout.CHECKER_COLOR] - r)
        g += m * (u[s + layout.CHECKER_COLOR + 1] - g)
        b += m * (u[s + layout.CHECKER_COLOR + 2] - b)
    return r, g, b
