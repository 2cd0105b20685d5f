# mypy: ignore-errors
"""Cubes with corners of one sign that may yet contain surface: proved empty or full, or counted."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.steepness_kernels import steepness, turning
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_ops import NOWHERE, TAPE, WHOLE
from sceneql.mesh.cubes.cull_kernels import CLEAR, CUT, verdict
from sceneql.mesh.cubes.extract_kernels import NODES, sample
from sceneql.mesh.cubes.grid import BLOCK

SIDE = BLOCK // 2
"""Pairs of cubes along a block."""
DEEPEST = 2
"""How often a cube may be halved before it is left unresolved."""
SHALLOW = 1.0e-12
"""Depth to which f may go to the other side of zero by rounding, where it touches zero."""


@inlined
def proved(code, constants, parts, scratch, x, y, z, half, negative, least):
    """Whether f is proved to keep its sign in the box of half side ``half`` about a point.

    By its range, by the mean value form, or by ``least``, the least |f| at the box's corners: of a function that is
    monotone along an axis the least value lies on a face.
    """
    low, high, status = box(
        code, constants, parts, scratch, x - half, x + half, y - half, y + half, z - half, z + half
    )  # fmt: skip
    if status == NOWHERE:
        return not negative
    if negative:
        if status != WHOLE:
            return False
        if high < SHALLOW:
            return True
    elif low >= -SHALLOW:
        return True
    if status != WHOLE:
        return False
    gx, gy, gz = steepness(code, constants, parts, scratch)
    if gx + gy + gz < 1.0e300 and least > half * turning(scratch, code.shape[0] - 1) * (1.0 + 1.0e-9):
        return True
    f = value(code, constants, parts, scratch, x, y, z)
    return abs(f) > half * (gx + gy + gz) * (1.0 + 1.0e-9) and (f < 0.0) == negative


@inlined
def doubtful(code, constants, parts, scratch, x, y, z, half, negative, least, deepest, stack):
    """Volume [m^3] of the parts of a cube that are not proved to have its corners' sign; |f| there >= ``least``."""
    volume = 0.0
    stack[0, 0] = x
    stack[0, 1] = y
    stack[0, 2] = z
    stack[0, 3] = 0.0
    top = 1
    while top > 0:
        top -= 1
        x = stack[top, 0]
        y = stack[top, 1]
        z = stack[top, 2]
        depth = stack[top, 3]
        side = half * 0.5**depth
        if proved(code, constants, parts, scratch, x, y, z, side, negative, least if depth == 0.0 else 0.0):
            continue
        if depth == deepest:
            volume += 8.0 * side * side * side
            continue
        for k in range(8):
            stack[top, 0] = x + (0.5 * side if k & 1 else -0.5 * side)
            stack[top, 1] = y + (0.5 * side if k & 2 else -0.5 * side)
            stack[top, 2] = z + (0.5 * side if k & 4 else -0.5 * side)
            stack[top, 3] = depth + 1.0
            top += 1
    return volume


@inlined
def of_corners(values, x, y, z):
    """(whether f < 0 at a cube's first corner, least |f| at its corners); infinite where their signs differ."""
    p = (z * NODES + y) * NODES + x
    negative = values[p] < 0.0
    least = np.inf
    for c in range(8):
        v = values[p + (c & 1) + (c >> 1 & 1) * NODES + (c >> 2) * NODES * NODES]
        if (v < 0.0) != negative:
            return negative, np.inf
        least = min(least, abs(v) if v == v else 0.0)
    return negative, least


@inlined
def crossed(code, constants, parts, registers, points, x, y, z, step, nodes, negative):
    """Whether f has the other sign at one of ``nodes`` nodes along each axis from (x, y, z) on."""
    n = nodes * nodes * nodes
    for lane in range(n):
        points[0, lane] = x + lane % nodes * step
        points[1, lane] = y + lane // nodes % nodes * step
        points[2, lane] = z + lane // (nodes * nodes) * step
    evaluate(code, constants, parts, registers, points, n)
    last = code.shape[0] - 1
    for lane in range(n):
        if (registers[last, lane] < 0.0) != negative:
            return True
    return False


@lean(
    f"int64({TAPE}, int32[:, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[::1], float64[:, ::1], float64[::1], int32[:, ::1], int64, int64, int32[:, ::1], float64[::1],"
    " boolean[::1])"
)
def hidden(
    code, constants, parts, scratch, short, near, registers, points, values, stack, grid, blocks, deepest, finer,
    cells, rest, seen,
):  # fmt: skip
    """Find the cubes of some blocks with corners of one sign, but no proof for their inside; returns their number.

    Cubes are halved up to ``deepest`` times. Their places go into ``cells`` (n, 3), the volumes [m^3] without a proof
    into ``rest``, and into ``seen`` whether f has the other sign at a node of cells ``finer`` times as fine, at most 5.
    """
    h = grid[3]
    count = 0
    for b in range(blocks.shape[0]):
        i = blocks[b, 0] * BLOCK
        j = blocks[b, 1] * BLOCK
        k = blocks[b, 2] * BLOCK
        at = verdict(code, constants, parts, scratch, grid, i, j, k, BLOCK)
        if at == CLEAR:
            continue
        rows, used = simplify(code, parts, scratch, at == CUT, short[1], near[1])
        code2 = short[1][:rows]
        parts2 = near[1][:used]
        far = 1.0e300
        if verdict(code2, constants, parts2, scratch, grid, i, j, k, BLOCK) == CUT:
            gx, gy, gz = steepness(code2, constants, parts2, scratch)
            if gx + gy + gz < 1.0e300:
                far = 0.5 * h * turning(scratch, rows - 1) * (1.0 + 1.0e-9)
        sample(code2, constants, parts2, registers, short[2], points, grid, i, j, k, values)
        for part in range(SIDE**3):
            x0, y0, z0 = 2 * (part % SIDE), 2 * (part // SIDE % SIDE), 2 * (part // SIDE**2)
            some = False
            for n in range(8):
                negative, least = of_corners(values, x0 + (n & 1), y0 + (n >> 1 & 1), z0 + (n >> 2))
                some = some or least <= far
            if not some:
                continue
            # Of eight cubes at once: most are proved by what is known of all.
            x, y, z = grid[0] + (i + x0) * h, grid[1] + (j + y0) * h, grid[2] + (k + z0) * h
            low, high, status = box(code2, constants, parts2, scratch, x, x + 2.0 * h, y, y + 2.0 * h, z, z + 2.0 * h)
            bound = far
            if status == WHOLE:
                gx, gy, gz = steepness(code2, constants, parts2, scratch)
                if gx + gy + gz < 1.0e300:
                    bound = min(far, 0.5 * h * turning(scratch, rows - 1) * (1.0 + 1.0e-9))
            for n in range(8):
                x, y, z = x0 + (n & 1), y0 + (n >> 1 & 1), z0 + (n >> 2)
                negative, least = of_corners(values, x, y, z)
                if least > bound or (status == WHOLE and high < SHALLOW if negative else low >= -SHALLOW):
                    continue
                rest[count] = doubtful(
                    code2, constants, parts2, scratch,
                    grid[0] + (i + x + 0.5) * h, grid[1] + (j + y + 0.5) * h, grid[2] + (k + z + 0.5) * h,
                    0.5 * h * (1.0 + 1.0e-12), negative, least, deepest, stack,
                )  # fmt: skip
                if rest[count] > 0.0:
                    cells[count, 0] = i + x
                    cells[count, 1] = j + y
                    cells[count, 2] = k + z
                    seen[count] = finer > 1 and crossed(
                        code2, constants, parts2, registers, points,
                        grid[0] + (i + x) * h, grid[1] + (j + y) * h, grid[2] + (k + z) * h,
                        h / finer, finer + 1, negative,
                    )  # fmt: skip
                    count += 1
    return count
