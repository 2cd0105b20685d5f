# mypy: ignore-errors
"""Rays at surfaces: the record of a hit, and the mirrored and the refracted ray."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing import record_kernels as records
from renderers.tracing.light.sampling_kernels import across
from renderers.tracing.light.shade_kernels import facing_ratio
from renderers.tracing.record_kernels import NORMAL, PLACE, VIEW, start_of
from renderers.tracing.scene_kernels import part
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.surface_kernels import color_at, normal_at


@part
def describe(scene, scratch, item, t, ox, oy, oz, dx, dy, dz, radius, record):
    """Write the record of a hit item, but for its weight; returns whether the ray comes from its outer side."""
    x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
    skin = normal_at(scene, scratch, item, x, y, z)
    return describe_by(scene, item, skin, x, y, z, dx, dy, dz, radius, record)


@part
def describe_by(scene, item, skin, x, y, z, dx, dy, dz, radius, record):
    """The same for a point, and what ``surface_kernels.normal_at`` says of it."""
    nx, ny, nz, fx, fy, fz, lift, sink, red, green, blue = skin
    outside = dx * fx + dy * fy + dz * fz <= 0.0
    if not outside:
        nx, ny, nz, lift = -nx, -ny, -nz, sink
    r, g, b = color_at(scene, item, (red, green, blue), x, y, z, nx, ny, nz, dx, dy, dz, radius)
    describe_as(scene, item, x, y, z, nx, ny, nz, dx, dy, dz, r, g, b, radius, lift, record)
    return outside


@part
def describe_as(scene, item, x, y, z, nx, ny, nz, dx, dy, dz, r, g, b, radius, lift, record):
    """Write a record, but for its weight, of a point whose normal and color are known."""
    records.put(record, x, y, z, nx, ny, nz, -dx, -dy, -dz, r, g, b)
    record[records.SURFACE] = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    record[records.OWNER] = scene.ints[layout.ITEMS + 4 * item + layout.SHAPE] + 1
    record[records.RADIUS] = radius
    record[records.LIFT] = lift
    record[records.TRACED] = record[records.IMAGED] = 0.0
    record[records.ITEM] = item


@part
def is_plain(scene, item):
    """Whether an item is a half-space of one color."""
    surface = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    kind = scene.ints[layout.ITEMS + 4 * item + layout.KIND]
    return kind == layout.HALF_SPACE and not scene.reals[surface + layout.CHECKER] > 0.0


@part
def describe_plain(scene, item, x, y, z, dx, dy, dz, radius, record):
    """As ``describe`` of what ``is_plain``: most pixels of many pictures, for a fraction of the time."""
    u = scene.reals
    k = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    nx, ny, nz = u[k], u[k + 1], u[k + 2]
    if dx * nx + dy * ny + dz * nz > 0.0:
        nx, ny, nz = -nx, -ny, -nz
    r, g, b = u[s + layout.COLOR], u[s + layout.COLOR + 1], u[s + layout.COLOR + 2]
    describe_as(scene, item, x, y, z, nx, ny, nz, dx, dy, dz, r, g, b, radius, 0.0, record)


@part
def faded(scene, item, record):
    """Share of an endless item that is seen, against the backdrop into which it fades."""
    if item >= scene.ints[layout.ENDLESS_COUNT]:
        return 1.0
    ratio = scene.reals[layout.FADE] / facing_ratio(record)
    return np.exp(-ratio * ratio)


@part
def mirrored(record):
    """Direction of the mirrored ray."""
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    vx, vy, vz = float(record[VIEW]), float(record[VIEW + 1]), float(record[VIEW + 2])
    nv = nx * vx + ny * vy + nz * vz
    return 2.0 * nv * nx - vx, 2.0 * nv * ny - vy, 2.0 * nv * nz - vz


@part
def refracted(record, ratio):
    """Direction of the refracted ray; ``ratio`` of refractive indices, before over behind."""
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    vx, vy, vz = float(record[VIEW]), float(record[VIEW + 1]), float(record[VIEW + 2])
    nv = nx * vx + ny * vy + nz * vz
    along = ratio * nv - np.sqrt(max(1.0 - ratio * ratio * (1.0 - nv * nv), 0.0))
    return along * nx - ratio * vx, along * ny - ratio * vy, along * nz - ratio * vz


@part
def beside(record):
    """(point a pixel's radius along the mirrored ray, that ray's cosine to the normal)."""
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    rx, ry, rz = mirrored(record)
    nv = rx * nx + ry * ny + rz * nz
    hx, hy, hz = rx - nv * nx, ry - nv * ny, rz - nv * nz  # along the surface
    length = np.sqrt(hx * hx + hy * hy + hz * hz)
    if length < 1e-3:
        hx, hy, hz, length = ny, nz, nx, 1.0
    step = record[records.RADIUS] / length
    return record[PLACE] + step * hx, record[PLACE + 1] + step * hy, record[PLACE + 2] + step * hz, nv


@part
def bend(record, nv, mx, my, mz):
    """Turn of the normal to (mx, my, mz) ``beside`` a record: reflections spread by twice that."""
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    side = 1.0 if mx * nx + my * ny + mz * nz >= 0.0 else -1.0
    # Of the difference: the cosine of a record's normal, in single precision, would turn flat surfaces by 3e-4.
    mx, my, mz = side * mx - nx, side * my - ny, side * mz - nz
    return np.sqrt(mx * mx + my * my + mz * mz) / max(nv, 0.1)


@part
def refracted_spread(scene, scratch, record, ratio, radius, spread):
    """Spread of a refracted ray's cone: the change of the ray's direction by its place (Igehy 1999, eq. 12 to 19).

    Of the directions across the ray, that across the plane of incidence, in which the footprint is neither stretched
    by the surface's slant nor by the refraction's: what is finer in the other is left to the rays of a pixel.
    """
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    vx, vy, vz = float(record[VIEW]), float(record[VIEW + 1]), float(record[VIEW + 2])
    ex, ey, ez = ny * vz - nz * vy, nz * vx - nx * vz, nx * vy - ny * vx
    length = np.sqrt(ex * ex + ey * ey + ez * ez)
    if length < 1e-3:
        ex, ey, ez, _, _, _ = across(nx, ny, nz)
        length = 1.0
    step = record[records.RADIUS]
    if step == 0.0:
        return ratio * spread
    ex, ey, ez = ex / length, ey / length, ez / length
    x, y, z = record[PLACE] + step * ex, record[PLACE + 1] + step * ey, record[PLACE + 2] + step * ez
    mx, my, mz, _, _, _, _, _, _, _, _ = normal_at(scene, scratch, int(record[records.ITEM]), x, y, z)
    side = 1.0 if mx * nx + my * ny + mz * nz >= 0.0 else -1.0
    turn = ((side * mx - nx) * ex + (side * my - ny) * ey + (side * mz - nz) * ez) / step
    cosine = facing_ratio(record)
    after = np.sqrt(max(1.0 - ratio * ratio * (1.0 - cosine * cosine), 0.0))
    return ratio * spread - (after - ratio * cosine) * turn * radius


@part
def beneath(scene, scratch, record):
    """The opaque item on whose face a record's face of glass lies, seen from within the glass, or -1.

    Rounding says which of the two a ray meets first, so of a glass on a table some pixels would look into the table.
    """
    x, y, z = start_of(record)
    bx, by, bz = behind(record)
    nx, ny, nz = -float(record[NORMAL]), -float(record[NORMAL + 1]), -float(record[NORMAL + 2])
    far = nx * (bx - x) + ny * (by - y) + nz * (bz - z)
    _, _, light = walk(scene, scratch, x, y, z, nx, ny, nz, 0.0, far, True)
    if light > 0.0:
        return -1
    u = scene.reals
    for item in range(scene.ints[layout.ENDLESS_COUNT]):
        h = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
        if scene.ints[layout.ITEMS + 4 * item + layout.KIND] != layout.HALF_SPACE:
            continue
        if u[h] * bx + u[h + 1] * by + u[h + 2] * bz < u[h + 3] < u[h] * x + u[h + 1] * y + u[h + 2] * z:
            return item
    # A ray within the item, along the face: another face of it may lie on a floor, as this one under the glass.
    ax, ay, az, vx, vy, vz = across(nx, ny, nz)
    dx, dy, dz = 0.8 * ax + 0.6 * vx, 0.8 * ay + 0.6 * vy, 0.8 * az + 0.6 * vz
    t, item, _ = walk(scene, scratch, bx, by, bz, dx, dy, dz, 0.0, np.inf, False)
    if item < 0:
        return -1
    skin = normal_at(scene, scratch, item, bx + t * dx, by + t * dy, bz + t * dz)
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    inside = dx * skin[3] + dy * skin[4] + dz * skin[5] > 0.0
    return item if inside and u[s + layout.TRANSMISSION] == 0.0 else -1


@part
def behind(record):
    """Origin of a ray that goes on through a surface: on its other side."""
    x, y, z = start_of(record)
    return 2.0 * record[PLACE] - x, 2.0 * record[PLACE + 1] - y, 2.0 * record[PLACE + 2] - z
