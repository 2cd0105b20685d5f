# mypy: ignore-errors
"""Gradients of a tape at a few points close together: densities are sums over the parts in their reach alone, and
skeletons are not asked for values that no slope depends on."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.compiled.lanes_kernels import BYTES, below, load, spread, store
from sceneql.field.packets.point_blocks_kernels import list_in_beam
from sceneql.field.skeleton.skeleton_kernels import part_gradient
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.batch_gradient_kernels import differentiate
from sceneql.field.tape.batch_kernels import BATCH, evaluate

ABREAST = BYTES // 8
"""Points in lanes."""
TOGETHER = 128
"""Parts in reach of the points in lanes up to which each is summed for all of them."""
MANY = 32
"""Parts of a density from which on those in reach are looked for."""
GROW = 1.0 + 1e-9
"""Factor of a squared reach, against rounding."""


@inlined
def many_points(code):
    """Whether a tape has a density of MANY parts, and no skeleton, whose hierarchy finds those in reach itself."""
    found = False
    for k in range(code.shape[0]):
        if code[k, 0] == ops.SKELETON:
            return False
        found = found or (code[k, 0] == ops.DENSITY and code[k, 2] - code[k, 1] >= MANY)
    return found


@inlined
def slopes_alone(code, rest):
    """Copy a tape to ``rest`` (rows, 4), and make KEEP of the skeletons in it whose values no gradient depends on.

    These are values that are added up, and multiplied by constants, and nothing else.
    """
    rows = code.shape[0]
    for k in range(rows):
        rest[k, 0] = 0
    for k in range(rows - 1, -1, -1):
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        if op == ops.ADD or op == ops.SUB or op == ops.NEG or op == ops.COPY:
            needed = rest[k, 0] != 0
        elif op == ops.MUL and (code[left, 0] == ops.CONSTANT or code[right, 0] == ops.CONSTANT):
            needed = rest[k, 0] != 0
        else:
            needed = True
        if op == ops.DENSITY or op == ops.SKELETON:
            left, right = code[k, 3], code[k, 3] + 1
            rest[code[k, 3] + 2, 0] = 1
        if needed and not (op == ops.CONSTANT or op == ops.X or op == ops.Y or op == ops.Z):
            rest[left, 0] = rest[right, 0] = 1
    for k in range(rows):
        idle = code[k, 0] == ops.SKELETON and rest[k, 0] == 0
        for column in range(4):
            rest[k, column] = code[k, column]
        if idle:
            rest[k, 0] = ops.KEEP


@inlined
def extent(x, n):
    """Least and largest of n numbers."""
    low = high = x[0]
    for i in range(1, n):
        low, high = min(low, x[i]), max(high, x[i])
    return low, high


@inlined
def apart(a, b, low, high):
    """Distance along an axis of a piece between a and b from low..high."""
    return max(max(low - max(a, b), min(a, b) - high), 0.0)


@inlined
def keep_near(parts, start, stop, x, y, z, n, near, kept):
    """Append the parts start..stop-1 in whose reach the box around n points is to ``near``; returns its length."""
    x0, x1 = extent(x, n)
    y0, y1 = extent(y, n)
    z0, z1 = extent(z, n)
    for part in range(start, stop):
        dx = apart(parts[part, 0], parts[part, 3], x0, x1)
        dy = apart(parts[part, 1], parts[part, 4], y0, y1)
        dz = apart(parts[part, 2], parts[part, 5], z0, z1)
        if not dx * dx + dy * dy + dz * dz > parts[part, 6] * parts[part, 6] * GROW:
            for column in range(8):
                near[kept, column] = parts[part, column]
            kept += 1
    return kept


@inlined
def points_slope(parts, start, listed, kept, x, y, z):
    """Gradient of the listed lone points with Wyvill's kernel at places in lanes, as ``part_gradient`` has it."""
    u = v = w = spread(0.0)
    for j in range(kept):
        i = np.uint64(start + listed[j])
        square, weight = parts[i, 6] * parts[i, 6], parts[i, 7]
        wx, wy, wz = x - parts[i, 0], y - parts[i, 1], z - parts[i, 2]
        s = (wx * wx + wy * wy + wz * wz) / square
        rest = 1.0 - s
        slope = weight * below(s, 1.0, -3.0 * rest * rest, 0.0)
        steep = 2.0 * slope * (1.0 / square)
        u, v, w = u + steep * wx, v + steep * wy, w + steep * wz
    return u, v, w


@inlined
def skeleton_slopes(code, constants, parts, registers, slope, rest, blocks, base, listed, n):
    """``differentiate`` of a tape with one skeleton, of points in ``blocks``: by those in reach alone, which points in
    lanes have together if these are not many."""
    rows = code.shape[0]
    row = 0
    for k in range(rows):
        row = k if code[k, 0] == ops.SKELETON else row
    differentiate(code[:row], constants, parts, registers, slope, n)
    p, start = code[row, 3], code[row, 1]
    for first in range(0, n, ABREAST):
        some = min(ABREAST, n - first)
        own = slice(first, first + some)
        x0, x1 = extent(registers[p, own], some)
        y0, y1 = extent(registers[p + 1, own], some)
        z0, z1 = extent(registers[p + 2, own], some)
        dx, dy, dz = 0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * (z1 - z0)
        around = np.sqrt(dx * dx + dy * dy + dz * dz)
        kept = list_in_beam(blocks, base, x0 + dx, y0 + dy, z0 + dz, 1.0, 0.0, 0.0, 0.0, around, listed)
        if kept <= TOGETHER:
            u, v, w = points_slope(
                parts, start, listed, kept, load(registers[p], first), load(registers[p + 1], first),
                load(registers[p + 2], first),
            )  # fmt: skip
            for axis in range(3):
                du, dv, dw = (
                    load(slope[p, axis], first),
                    load(slope[p + 1, axis], first),
                    load(slope[p + 2, axis], first),
                )
                store(slope[row, axis], first, u * du + v * dv + w * dw)
            continue
        for i in range(first, first + some):
            x, y, z = registers[p, i], registers[p + 1, i], registers[p + 2, i]
            kept = list_in_beam(blocks, base, x, y, z, 1.0, 0.0, 0.0, 0.0, 0.0, listed)
            u = v = w = 0.0
            for j in range(kept):
                _, gx, gy, gz = part_gradient(parts, start + listed[j], x, y, z)
                u, v, w = u + gx, v + gy, w + gz
            for axis in range(3):
                slope[row, axis, i] = u * slope[p, axis, i] + v * slope[p + 1, axis, i] + w * slope[p + 2, axis, i]
    for k in range(rows):
        for column in range(4):
            rest[k, column] = code[k, column]
        if k <= row:
            rest[k, 0] = ops.KEEP
    differentiate(rest, constants, parts, registers, slope, n)


@lean(
    f"void({BATCH}, float64[:, :, ::1], float64[:, ::1], int32[:, :, ::1], float64[:, ::1], float32[:, ::1], int64, "
    "int64[::1], int64)",
    inner=True,
)
def gradients(code, constants, parts, registers, slope, points, codes, near, blocks, base, listed, n):
    """Gradients at n ``points`` (3, LANES) into the last of ``slope`` (rows, 3, LANES), bit for bit as of all parts.

    Of a tape with one skeleton, of points alone, ``blocks`` from column ``base`` on are as point_blocks_kernels has
    them; else ``base`` is below 0. ``registers`` (rows, LANES), ``codes`` (2, rows, 4), ``near`` (parts, 8) and
    ``listed`` (parts,) are working memory.
    """
    rows = code.shape[0]
    if not many_points(code):
        rest = codes[0, :rows]
        slopes_alone(code, rest)
        for k in range(rows):
            for i in range(n if rest[k, 0] == ops.KEEP else 0):
                registers[k, i] = 1.0
        evaluate(rest, constants, parts, registers, points, n)
        if base >= 0:
            skeleton_slopes(code, constants, parts, registers, slope, rest, blocks, base, listed, n)
        else:
            differentiate(code, constants, parts, registers, slope, n)
        return
    rest, whole = codes[0, :rows], codes[1, :rows]
    for k in range(rows):
        for column in range(4):
            rest[k, column] = whole[k, column] = code[k, column]
    kept = 0
    for k in range(rows):
        if code[k, 0] == ops.DENSITY:
            # The points at which it is asked are those of the rows before.
            evaluate(rest[:k], constants, near, registers, points, n)
            for j in range(k):
                rest[j, 0] = ops.KEEP
            p, first = code[k, 3], kept
            kept = keep_near(
                parts, code[k, 1], code[k, 2], registers[p], registers[p + 1], registers[p + 2], n, near, kept
            )  # fmt: skip
            rest[k, 1] = whole[k, 1] = first
            rest[k, 2] = whole[k, 2] = kept
    evaluate(rest, constants, near, registers, points, n)
    differentiate(whole, constants, near, registers, slope, n)
