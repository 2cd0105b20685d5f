# mypy: ignore-errors
"""The plain picture of the comparison: one ray a pixel, one shadow ray, Lambert; every ray goes in packets."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packet_kernels import LANES, PACKET, has
from sceneql.field.packets.packet_roots_kernels import first_roots
from sceneql.field.roots.density_roots_kernels import ROW_OF
from sceneql.field.roots.polynomial_kernels import POLYNOMIAL
from sceneql.field.tape.batch_gradient_kernels import differentiate
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.tape_ops import DENSITY, HIT, UNDECIDED

TILE = 16
AMBIENT = 0.15
LIFT = 1e-4
"""Where shadow rays begin, relative to the ball's radius."""


@inlined
def cut(rays, n, radius, start):
    """Cut n rays to their pieces inside the ball about the origin, from ``start`` on."""
    ox, oy, oz, dx, dy, dz = rays[0], rays[1], rays[2], rays[3], rays[4], rays[5]
    begin, end = rays[6], rays[7]
    for j in range(n):
        b = ox[j] * dx[j] + oy[j] * dy[j] + oz[j] * dz[j]
        left = b * b - (ox[j] * ox[j] + oy[j] * oy[j] + oz[j] * oz[j] - radius * radius)
        half = np.sqrt(left if left > 0.0 else 0.0)
        first = -b - half if -b - half > start else start
        begin[j] = first if left > 0.0 else 0.0
        end[j] = half - b if left > 0.0 else 0.0


@inlined
def aim(rays, n, pixels, x, y, view):
    """Rays through the pixels (2, n) about the point x, y of the window."""
    size, far = view[4, 0], view[4, 1]
    across, down = pixels[0], pixels[1]
    for axis in range(3):
        place, way = rays[axis], rays[3 + axis]
        right, up, forward = view[0, axis], view[1, axis], view[2, axis]
        for j in range(n):
            place[j] = (x + size * across[j]) * right + (y - size * down[j]) * up - far * forward
            way[j] = forward


@inlined
def shade(code, known, sign, constants, parts, doubles, points, slopes, view, n):
    """Lambert's law at n points into the first row of the last of ``slopes``: 0, where the light is not faced.

    ``sign`` times the tape grows outward; its gradient asks for the values of the first ``known`` rows.
    """
    evaluate(code[:known], constants, parts, doubles, points, n)
    differentiate(code, constants, parts, doubles, slopes, n)
    last = code.shape[0] - 1
    lx, ly, lz = sign * view[3, 0], sign * view[3, 1], sign * view[3, 2]
    gx, gy, gz = slopes[last, 0], slopes[last, 1], slopes[last, 2]
    for i in range(n):
        x, y, z = gx[i], gy[i], gz[i]
        faces = (x * lx + y * ly + z * lz) / np.sqrt(x * x + y * y + z * z + 1e-300)
        gx[i] = faces if faces > 0.0 else 0.0


@lean(
    f"UniTuple(int64, 3)({PACKET}, float32[::1], float32[::1], int64[::1], float64[:, ::1], float32[:, ::1],"
    " int64[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[:, ::1], int32[:, ::1], float32[:, ::1], float64[:, ::1], int64[::1], int64[::1], float64[:, ::1],"
    " float32[:, ::1], float64[::1], int32[:, ::1], float64[:, :, ::1], float64[:, ::1], int64[:, ::1],"
    " float64[:, ::1], float64[:, ::1], float64, int64, int64, float32[::1], float32[::1])",
)
def draw_row(
    code,
    constants,
    singles,
    registers,
    point,
    status,
    lanes,
    ids,
    rays,
    asked,
    queue,
    found,
    parts,
    scratch,
    beams,
    doubles,
    points,
    short,
    near_singles,
    near_parts,
    plan,
    order,
    room,
    table,
    flat,
    other,
    slopes,
    pixels,
    numbers,
    starts,
    view,
    radius,
    row,
    width,
    picture,
    depth,
):
    """Draw a row of tiles into ``picture`` (h w,), the places [t] of its hits into ``depth``, -1 for none.

    ``pixels`` (2, n): those of a tile, in the order of its rays, those of a column of 16 close together; ``numbers``
    (5, n): where these are in the picture, the rays column by column, and working memory, as is ``starts`` (3, n).
    ``view`` (5, 3): right, up and the way of the rays, the light, (pixel size, distance of the eye's plane, 0).
    Returns (enclosures, certified rays, undecided rays).
    """
    height = len(picture) // width
    size = view[4, 0]
    n = TILE * TILE
    spent = 0
    certified = 0
    undecided = 0
    top = row * TILE
    offsets, turns, hits, faced, spots = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4]
    # Of a density field, a bundle that hits something has left the parts that matter to it.
    near_of = near_parts if has(code, DENSITY) or plan[ROW_OF] >= 0 else parts
    rows = slice(top * width, (top + TILE) * width)
    picture[rows] = 0.0
    depth[rows] = -1.0
    for tile in range((width + TILE - 1) // TILE):
        left = tile * TILE
        x, y = size * (left + 0.5 - 0.5 * width), size * (0.5 * height - top - 0.5)
        across, down = x + 0.5 * size * (TILE - 1), y - 0.5 * size * (TILE - 1)
        if across * across + down * down > (radius + size * TILE) ** 2:
            continue
        aim(rays, n, pixels, x, y, view)
        cut(rays, n, radius, 0.0)
        if left + TILE > width or top + TILE > height:
            for j in range(n):
                if left + pixels[0, j] >= width or top + pixels[1, j] >= height:
                    rays[7, j] = rays[6, j]
        a, b = first_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, n, False, found,
            parts, scratch, beams, doubles, points, short, near_singles, near_parts, plan, order, room, table, flat,
            other,
        )  # fmt: skip
        spent += a
        certified += b
        base = top * width + left
        met = 0
        outcomes, roots, begins = found[ray_rows.FOUND_STATUS], found[ray_rows.FOUND_ROOT], rays[6]
        for i in range(n):
            j = np.uint64(turns[i])
            hits[np.uint64(met)] = turns[i]
            met += 1 if outcomes[j] == HIT else 0
            undecided += 1 if outcomes[j] == UNDECIDED else 0
        if met == n:  # as they stand
            for i in range(n):
                hits[i] = i
        near = short if has(code, DENSITY) or plan[ROW_OF] >= 0 else code
        length, sign = code.shape[0], 1.0
        known = length
        if b == 0:  # all hits are roots of what has an exact form, which alone tells their slopes
            if plan[ROW_OF] >= 0:
                known, sign = plan[ROW_OF], -1.0
                length = known + 1
            elif plan[POLYNOMIAL] >= 0:
                inner = 0
                for i in range(met):
                    j = np.uint64(hits[i])
                    inner += 1 if roots[j] > begins[j] else 0
                if inner == met:  # none begins inside, at the ball
                    known = length = plan[POLYNOMIAL] + 1
        near = near[:length]
        light = slopes[length - 1, 0]
        facing = 0
        for start in range(0, met, LANES):
            some = min(LANES, met - start)
            own = hits[start:]
            for axis in range(3):
                p, place = points[axis], starts[axis, start:]
                if met == n:
                    o, d, t = rays[axis, start:], rays[3 + axis, start:], roots[start:]
                    for i in range(some):
                        p[i] = place[i] = o[i] + t[i] * d[i]
                else:
                    o, d = rays[axis], rays[3 + axis]
                    for i in range(some):
                        j = np.uint64(own[i])
                        p[i] = place[i] = o[j] + roots[j] * d[j]
            shade(near, known, sign, constants, near_of, doubles, points, slopes, view, some)
            for i in range(some):
                j = np.uint64(own[i])
                at = np.uint64(base + offsets[j])
                depth[at] = roots[j]
                picture[at] = AMBIENT + (1.0 - AMBIENT) * light[i]
                faced[np.uint64(facing)] = start + i
                facing += 1 if light[i] > 0.0 else 0
        if facing == 0:
            continue
        if facing == n:
            for j in range(n):
                spots[j] = base + offsets[j]
            for axis in range(3):
                o, place = rays[axis], starts[axis]
                for j in range(n):
                    o[j] = place[j]
        else:
            # The rays to the light stand in columns again.
            groups = (facing + TILE - 1) // TILE
            taken = 0
            for g in range(groups):
                for ray in range(g, facing, groups):
                    j, k = np.uint64(ray), np.uint64(faced[np.uint64(taken)])
                    spots[j] = base + offsets[np.uint64(hits[k])]
                    rays[0, j], rays[1, j], rays[2, j] = starts[0, k], starts[1, k], starts[2, k]
                    taken += 1
        for axis in range(3):
            way, along = rays[3 + axis], view[3, axis]
            for j in range(facing):
                way[j] = along
        cut(rays, facing, radius, LIFT * radius)
        a, b = first_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, facing, True, found,
            parts, scratch, beams, doubles, points, short, near_singles, near_parts, plan, order, room, table, flat,
            other,
        )  # fmt: skip
        spent += a
        certified += b
        for j in range(facing):
            undecided += 1 if outcomes[j] == UNDECIDED else 0
            if outcomes[j] == HIT:
                picture[np.uint64(spots[j])] = AMBIENT
    return spent, certified, undecided
