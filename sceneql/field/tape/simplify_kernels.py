# mypy: ignore-errors
"""Tapes shortened for a box: without branches of min and max that cannot win, and without parts out of reach.

In the box the short tape gives the same bits as the whole one, so that neighboring boxes agree on their common face.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.skeleton import skeleton_parts_kernels as part
from sceneql.field.skeleton.density_kernels import offset
from sceneql.field.skeleton.falloff_kernels import WYVILL
from sceneql.field.skeleton.skeleton_bounds_kernels import box_of, skeleton_near
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.short_rows_kernels import ALIAS, LIVE, mark, write_row


@inlined
def within_reach(parts, i, scratch, p):
    """Whether the box in rows p..p+2 of scratch may be within reach of part i."""
    x, y, z, hx, hy, hz = box_of(scratch, p)
    wx, wy, wz = offset(parts, i, x, y, z)
    blur = 1.0e-12 * (abs(x) + abs(y) + abs(z) + abs(parts[i, 0]) + abs(parts[i, 1]) + abs(parts[i, 2]) + parts[i, 6])
    blur += 1.0e-12 * (abs(parts[i, 3]) + abs(parts[i, 4]) + abs(parts[i, 5]))
    distance = np.sqrt(wx * wx + wy * wy + wz * wz)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    return distance < parts[i, 6] + diagonal + blur


@inlined
def winner(code, k, scratch):
    """The row with the value of row k all over the box: a branch of min or max that must win, else k itself."""
    op = code[k, 0]
    if op == ops.MIN or op == ops.MAX:
        left = code[k, 1]
        right = code[k, 2]
        if scratch[left, 1] < scratch[right, 0]:
            return int(scratch[left if op == ops.MIN else right, ALIAS])
        if scratch[right, 1] < scratch[left, 0]:
            return int(scratch[right if op == ops.MIN else left, ALIAS])
    return k


@inlined
def plain_parts(near, first, found):
    """Rewrite the skeleton parts in rows first..found-1 of near as rows of DENSITY; returns the row after them.

    0, and nothing done, unless all are points or segments of one radius, alone in their groups, with Wyvill's kernel.
    """
    group = -1.0
    for i in range(first, found, part.STRIDE):
        flat = near[i + 1, part.SHAPE] == part.SEGMENT and near[i + 1, part.KERNEL] == WYVILL
        if not flat or near[i + 1, part.RADIUS_B] != near[i, part.RADIUS] or near[i + 1, part.GROUP] == group:
            return 0
        group = near[i + 1, part.GROUP]
    rows = first
    for i in range(first, found, part.STRIDE):
        for j in range(8):
            near[rows, j] = near[i, j]
        rows += 1
    return rows


@lean("UniTuple(int64, 2)(int32[:, ::1], float64[:, ::1], float64[:, ::1], boolean, int32[:, ::1], float64[:, ::1])")
def simplify(code, parts, scratch, whole, short, near):
    """Write the tape shortened for a box into ``short`` and ``near``, as large as code and parts; (rows, parts) used.

    ``scratch`` is as ``interval_kernels.box`` left it; ``whole``: the tape is defined all over that box. Where it is
    not, all rows stay: a NaN in any branch makes the value NaN, and ``box`` may have stopped before the end.
    """
    last = code.shape[0] - 1
    for k in range(last + 1):
        scratch[k, ALIAS] = winner(code, k, scratch) if whole else k
    mark(code, last, scratch)
    rows = 0
    found = 0
    for k in range(last + 1):
        if scratch[k, LIVE] == 0.0:
            continue
        op = code[k, 0]
        write_row(code, k, scratch, short, rows)
        if op == ops.SKELETON and whole:
            short[rows, 1] = found
            found = skeleton_near(parts, code[k, 1], code[k, 2], scratch, code[k, 3], near, found)
            behind = plain_parts(near, short[rows, 1], found)
            if behind > 0:
                short[rows, 0] = ops.DENSITY
                found = behind
            short[rows, 2] = found
        elif op == ops.DENSITY or op == ops.SKELETON:
            short[rows, 1] = found
            for i in range(code[k, 1], code[k, 2]):
                if not whole or within_reach(parts, i, scratch, code[k, 3]):
                    for j in range(8):
                        near[found, j] = parts[i, j]
                    found += 1
            short[rows, 2] = found
        rows += 1
    return rows, found
