# mypy: ignore-errors
"""Tests whether points on rays are inside a tape: for the clips that bound a solid with an exact form."""

import numpy as np

from sceneql.compiled.kernels import lean
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packet_kernels import CHECK_INSIDE
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.tape_ops import HIT, UNDECIDED


@lean(CHECK_INSIDE, inner=True)
def check_inside(code, constants, parts, registers, points, rays, queue, count, row, late, found):
    """Make queued HITs undecided if f >= 0 at ``late`` ray lengths behind the place in a row of ``found``."""
    width = points.shape[1]
    for start in range(0, count, width):
        n = min(width, count - start)
        for i in range(n):
            j = np.uint64(queue[start + i])
            t = rays[6, j] + found[row, j] + late * (rays[7, j] - rays[6, j])
            for axis in range(3):
                points[axis, i] = rays[axis, j] + t * rays[3 + axis, j]
        evaluate(code, constants, parts, registers, points, n)
        last = registers[code.shape[0] - 1]
        for i in range(n):
            j = np.uint64(queue[start + i])
            if found[ray_rows.FOUND_STATUS, j] == HIT and not last[i] < 0.0:
                found[ray_rows.FOUND_STATUS, j] = UNDECIDED
