# mypy: ignore-errors
"""First roots of an implicit object along the camera's rays, in bundles of 16 x 16 pixels (sceneql.field)."""

import numpy as np
from numba import types

from renderers.tracing.camera_kernels import camera_ray
from renderers.tracing.scene_kernels import SCENE, WIDTH, part
from renderers.tracing.solids_kernels import box_span, inverse
from sceneql.field.hunt_kernels import FOUND_ROOT, FOUND_STATUS
from sceneql.field.packet_roots_kernels import ARGUMENTS, first_roots
from sceneql.field.tape_ops import HIT, MISS
from sceneql.kernels import lean

TILE, BLOCK = 16, 4


@part
def pixel_of(j):
    """(x, y) in its tile of the pixel of ray j: a column of rays is a block of pixels, four make a larger one."""
    g, r = j % TILE, j // TILE
    x, y = g & 1 | (g >> 1) & 2, (g >> 1) & 1 | (g >> 2) & 2
    return x * BLOCK + r % BLOCK, y * BLOCK + r // BLOCK


@part
def aim(reals, rays, j, px, py, box):
    """Ray j through a picture's point, cut to what lies in a box (2, 3)."""
    ox, oy, oz, dx, dy, dz, _, _ = camera_ray(reals, px, py)
    rays[0, j], rays[1, j], rays[2, j] = ox, oy, oz
    rays[3, j], rays[4, j], rays[5, j] = dx, dy, dz
    enter, leave = 0.0, np.inf
    for axis in range(3):
        first, last = box_span(box[0, axis], box[1, axis], rays[axis, j], inverse(rays[3 + axis, j]))
        enter, leave = max(enter, first), min(leave, last)
    rays[6, j], rays[7, j] = enter, leave
    if not enter < leave:
        rays[6, j] = rays[7, j] = 0.0


@lean(types.void(SCENE, *ARGUMENTS, types.float64[:, ::1], types.int64[::1], types.int64, types.float64[::1]))
def meet_tiles(
    scene, code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, found, parts, scratch,
    beams, doubles, points, short, near_singles, near_parts, plan, order, room, table, flat, other, box, window, start,
    answers,
):  # fmt: skip
    """Where the camera's rays through rows start.. of a picture first meet {f < 0} in ``box``, into ``answers`` (n,).

    inf: nowhere; NaN: not told, ask for that ray alone. ``window`` (x0, x1, y0, y1) has all pixels that see the box;
    what is outside of it must be inf before.
    """
    width = int(scene.reals[WIDTH])
    rows = answers.shape[0] // width
    for top in range(start, start + rows, TILE):
        if top + TILE <= window[2] or top > window[3]:
            continue
        for left in range(window[0] // TILE * TILE, min(window[1] + 1, width), TILE):
            for j in range(TILE * TILE):
                x, y = pixel_of(j)
                aim(scene.reals, rays, j, left + x + 0.5, top + y + 0.5, box)
                if left + x >= width or top + y >= start + rows:
                    rays[7, j] = rays[6, j]
            first_roots(
                code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, TILE * TILE, False,
                found, parts, scratch, beams, doubles, points, short, near_singles, near_parts,
                plan, order, room, table, flat, other,
            )  # fmt: skip
            for j in range(TILE * TILE):
                x, y = pixel_of(j)
                if left + x < width and top + y < start + rows and found[FOUND_STATUS, j] != MISS:
                    t = found[FOUND_ROOT, j]
                    # A ray that begins inside leaves first; what is undecided is told by the certified routine alone.
                    settled = found[FOUND_STATUS, j] == HIT and t > 0.0
                    answers[(top + y - start) * width + left + x] = t if settled else np.nan
