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

TILE, BLOCK = 16, 4
AMBIENT = 0.15
LIFT = 1e-4
"""Where shadow rays begin, relative to the ball's radius."""


@inlined
def ball(rays, j, radius, start):
    """Cut ray j to its piece inside the ball about the origin, from ``start`` on."""
    ox, oy, oz, dx, dy, dz = rays[0, j], rays[1, j], rays[2, j], rays[3, j], rays[4, j], rays[5, j]
    b = ox * dx + oy * dy + oz * dz
    left = b * b - (ox * ox + oy * oy + oz * oz - radius * radius)
    rays[6, j] = 0.0
    rays[7, j] = 0.0
    if left > 0.0:
        rays[6, j] = max(-b - np.sqrt(left), start)
        rays[7, j] = -b + np.sqrt(left)


@lean(
    f"UniTuple(int64, 3)({PACKET}, float32[::1], float32[::1], int64[::1], float64[:, ::1], float32[:, ::1],"
    " int64[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[:, ::1], int32[:, ::1], float32[:, ::1], float64[:, ::1], float64[:, :, ::1], float64[:, ::1], float64,"
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
    slopes,
    view,
    radius,
    row,
    picture,
    depth,
):
    """Draw a row of tiles into ``picture`` (h, w), the places [t] of its hits into ``depth``, -1 for none.

    ``view`` (5, 3): right, up and the way of the rays, the light, (pixel size, distance of the eye's plane, 0).
    Returns (enclosures, certified rays, undecided rays).
    """
    height, width = picture.shape
    size = view[4, 0]
    last = code.shape[0] - 1
    spent = 0
    certified = 0
    undecided = 0
    lx, ly, lz = view[3, 0], view[3, 1], view[3, 2]
    for tile in range((width + TILE - 1) // TILE):
        for j in range(TILE * TILE):
            g = j % TILE
            r = j // TILE
            px = tile * TILE + (g % BLOCK) * BLOCK + r % BLOCK
            py = row * TILE + (g // BLOCK) * BLOCK + r // BLOCK
            x = size * (px + 0.5 - 0.5 * width)
            y = size * (0.5 * height - py - 0.5)
            for axis in range(3):
                rays[axis, j] = x * view[0, axis] + y * view[1, axis] - view[4, 1] * view[2, axis]
                rays[3 + axis, j] = view[2, axis]
            ball(rays, j, radius, 0.0)
            if px >= width or py >= height:
                rays[7, j] = 0.0
        n = TILE * TILE
        a, b = first_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, n, False, found,
            parts, scratch, beams, doubles, points, short, near_singles, near_parts,
        )  # fmt: skip
        spent += a
        certified += b
        for j in range(n):
            g = j % TILE
            r = j // TILE
            px = tile * TILE + (g % BLOCK) * BLOCK + r % BLOCK
            py = row * TILE + (g // BLOCK) * BLOCK + r // BLOCK
            hit = found[FOUND_STATUS, j] == HIT
            undecided += found[FOUND_STATUS, j] == UNDECIDED
            if px < width and py < height:
                depth[py, px] = found[FOUND_ROOT, j] if hit else -1.0
                picture[py, px] = 0.0
            if not hit:
                rays[7, j] = rays[6, j]
        # Of a density field, a bundle that hits something has left the parts that matter to it.
        near, near_of = code, parts
        for k in range(last + 1):
            if code[k, 0] == DENSITY:
                near, near_of = short, near_parts
        facing = 0
        for start in range(0, n, LANES):
            hits = 0
            for j in range(start, start + LANES):
                if rays[6, j] < rays[7, j]:
                    t = found[FOUND_ROOT, j]
                    for axis in range(3):
                        points[axis, hits] = rays[axis, j] + t * rays[3 + axis, j]
                    queue[hits] = j
                    hits += 1
            if hits == 0:
                continue
            evaluate(near, constants, near_of, doubles, points, hits)
            differentiate(near, constants, near_of, doubles, slopes, hits)
            for i in range(hits):
                j = queue[i]
                nx, ny, nz = slopes[0, last, i], slopes[1, last, i], slopes[2, last, i]
                nl = (nx * lx + ny * ly + nz * lz) / np.sqrt(nx * nx + ny * ny + nz * nz + 1e-300)
                asked[0, j] = nl
                rays[6, j] = rays[7, j]
                g = j % TILE
                r = j // TILE
                px = tile * TILE + (g % BLOCK) * BLOCK + r % BLOCK
                py = row * TILE + (g // BLOCK) * BLOCK + r // BLOCK
                picture[py, px] = AMBIENT
                if nl > 0.0:
                    picture[py, px] += (1.0 - AMBIENT) * nl
                    for axis in range(3):
                        rays[axis, j] = points[axis, i]
                        rays[3 + axis, j] = view[3, axis]
                    ball(rays, j, radius, LIFT * radius)
                    facing += 1
        if facing == 0:
            continue
        a, b = first_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, n, True, found,
            parts, scratch, beams, doubles, points, short, near_singles, near_parts,
        )  # fmt: skip
        spent += a
        certified += b
        for j in range(n):
            undecided += found[FOUND_STATUS, j] == UNDECIDED
            if found[FOUND_STATUS, j] == HIT:
                g = j % TILE
                r = j // TILE
                px = tile * TILE + (g % BLOCK) * BLOCK + r % BLOCK
                py = row * TILE + (g // BLOCK) * BLOCK + r // BLOCK
                picture[py, px] = AMBIENT
    return spent, certified, undecided
