# mypy: ignore-errors
"""The plain picture of the comparison: one ray a pixel, one shadow ray, Lambert; every ray goes in packets."""

import numpy as np

from sceneql.field.batch_gradient_kernels import differentiate
from sceneql.field.batch_kernels import evaluate
from sceneql.field.hunt_kernels import FOUND_ROOT, FOUND_STATUS
from sceneql.field.packet_kernels import LANES, PACKET
from sceneql.field.packet_roots_kernels import first_roots
from sceneql.field.tape_ops import DENSITY, HIT, UNDECIDED
from sceneql.kernels import inlined, lean

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


@lean(
    f"UniTuple(int64, 3)({PACKET}, float32[::1], float32[::1], int64[::1], float64[:, ::1], float32[:, ::1],"
    " int64[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[:, ::1], int32[:, ::1], float32[:, ::1], float64[:, ::1], int64[::1], int64[::1], float64[:, ::1],"
    " float32[:, ::1], float64[::1], int32[:, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64,"
    " int64, float32[:, ::1], float64[:, ::1])",
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
    view,
    radius,
    row,
    picture,
    depth,
):
    """Draw a row of tiles into ``picture`` (h, w), the places [t] of its hits into ``depth``, -1 for none.

    ``pixels`` (2, n): those of a tile, in the order of its rays, those of a column of 16 close together.
    ``view`` (5, 3): right, up and the way of the rays, the light, (pixel size, distance of the eye's plane, 0).
    Returns (enclosures, certified rays, undecided rays).
    """
    height, width = picture.shape
    size = view[4, 0]
    last = code.shape[0] - 1
    n = TILE * TILE
    spent = 0
    certified = 0
    undecided = 0
    lx, ly, lz = view[3, 0], view[3, 1], view[3, 2]
    top = row * TILE
    picture[top : top + TILE] = 0.0
    depth[top : top + TILE] = -1.0
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
        met = 0
        for j in range(n):
            undecided += found[FOUND_STATUS, j] == UNDECIDED
            if found[FOUND_STATUS, j] == HIT:
                depth[top + int(pixels[1, j]), left + int(pixels[0, j])] = found[FOUND_ROOT, j]
                queue[met] = j
                met += 1
        if met == 0:
            continue
        # Of a density field, a bundle that hits something has left the parts that matter to it.
        near, near_of = code, parts
        for k in range(last + 1):
            if code[k, 0] == DENSITY or plan[0] >= 0:
                near, near_of = short, near_parts
        for j in range(n):
            rays[7, j] = rays[6, j] = 0.0
        facing = 0
        for start in range(0, met, LANES):
            hits = min(LANES, met - start)
            for i in range(hits):
                j = queue[start + i]
                t = found[FOUND_ROOT, j]
                for axis in range(3):
                    points[axis, i] = rays[axis, j] + t * rays[3 + axis, j]
            evaluate(near, constants, near_of, doubles, points, hits)
            differentiate(near, constants, near_of, doubles, slopes, hits)
            gx, gy, gz = slopes[last, 0], slopes[last, 1], slopes[last, 2]
            for i in range(hits):
                nx, ny, nz = gx[i], gy[i], gz[i]
                gx[i] = (nx * lx + ny * ly + nz * lz) / np.sqrt(nx * nx + ny * ny + nz * nz + 1e-300)
            for i in range(hits):
                j = queue[start + i]
                shade = AMBIENT
                if gx[i] > 0.0:
                    shade += (1.0 - AMBIENT) * gx[i]
                    for axis in range(3):
                        rays[axis, j] = points[axis, i]
                        rays[3 + axis, j] = view[3, axis]
                    queue[facing] = j
                    facing += 1
                picture[top + int(pixels[1, j]), left + int(pixels[0, j])] = shade
        if facing == 0:
            continue
        for j in range(n):
            asked[0, j] = 0.0
        for i in range(facing):
            asked[0, queue[i]] = 1.0
        cut(rays, n, radius, LIFT * radius)
        for j in range(n):
            if asked[0, j] == 0.0:
                rays[7, j] = rays[6, j]
        a, b = first_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, n, True, found,
            parts, scratch, beams, doubles, points, short, near_singles, near_parts, plan, order, room, table, flat,
            other,
        )  # fmt: skip
        spent += a
        certified += b
        for j in range(n):
            undecided += found[FOUND_STATUS, j] == UNDECIDED
            if found[FOUND_STATUS, j] == HIT:
                picture[top + int(pixels[1, j]), left + int(pixels[0, j])] = AMBIENT
    return spent, certified, undecided
