# mypy: ignore-errors
"""Cubes with corners of one sign that may yet contain surface: proved empty or full, or counted."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.curvature_kernels import bulge, curvature
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.steepness_kernels import steepness, turning
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_ops import MAX, MIN, NOWHERE, TAPE, WHOLE
from sceneql.mesh.cubes.cull_kernels import CLEAR, CUT, verdict
from sceneql.mesh.cubes.extract_kernels import NODES, sample
from sceneql.mesh.cubes.grid import BLOCK

SIDE = BLOCK // 2
"""Pairs of cubes along a block."""
DEEPEST = 2
"""How often a cube may be halved before it is left unresolved."""
WIDER = 1.0 + 1.0e-12
"""Factor of a cube's side for its rounding."""
SHALLOW = 1.0e-12
"""Depth to which f may go to the other side of zero by rounding, where it touches zero."""
CAP = 0.125
"""Greatest thickness, in cubes, of a bulge through a face that counts as a part of the sheet beyond the face."""


@inlined
def deciding(code, scratch):
    """The row whose sign is that of the last in the box for which ``box`` left WHOLE in scratch, and no nearer to zero.

    As where the faces that cut a solid are far away: max(f, g) has the sign of f where g < 0.
    """
    row = code.shape[0] - 1
    while code[row, 0] == MAX or code[row, 0] == MIN:
        left, right = code[row, 1], code[row, 2]
        if scratch[right, 1] < 0.0 if code[row, 0] == MAX else scratch[right, 0] > 0.0:
            row = left
        elif scratch[left, 1] < 0.0 if code[row, 0] == MAX else scratch[left, 0] > 0.0:
            row = right
        else:
            break
    return row


@inlined
def enough(code, constants, parts, scratch, second, h):
    """The least f, and the least -f, at the corners of a cube of side ``h`` that prove its inside to have their sign.

    For all such cubes in the box for which ``box`` left WHOLE: by the axes along which f is monotone, or by its second
    derivatives, which bound how far it lies from what is linear along each axis between the corners.
    """
    gx, gy, gz = steepness(code, constants, parts, scratch)
    if not gx + gy + gz < 1.0e300:
        return 1.0e300, 1.0e300
    last = code.shape[0] - 1
    turn = 0.5 * h * turning(scratch, last) * (1.0 + 1.0e-9)
    if turn == 0.0 or not curvature(code, scratch, second):
        return turn, turn
    below, above = bulge(second, last)
    return min(turn, h * h * below * (1.0 + 1.0e-9)), min(turn, h * h * above * (1.0 + 1.0e-9))


@inlined
def proved(code, constants, parts, scratch, second, x, y, z, half, negative, least):
    """(whether f is proved to keep its sign in the box of half side ``half`` about a point, way, thickness).

    By its range, by the mean value form, or, as in ``enough``, by ``least``, the least |f| at the box's corners.
    Without a proof, f may have the other sign only up to a ``thickness`` [m] from a face, ``way`` as ``bulged`` has it.
    """
    low, high, status = box(
        code, constants, parts, scratch, x - half, x + half, y - half, y + half, z - half, z + half
    )  # fmt: skip
    if status == NOWHERE:
        return not negative, 0, np.inf
    if negative:
        if status != WHOLE:
            return False, 0, np.inf
        if high < SHALLOW:
            return True, 0, 0.0
    elif low >= -SHALLOW:
        return True, 0, 0.0
    if status != WHOLE:
        return False, 0, np.inf
    outer, inner = enough(code, constants, parts, scratch, second, 2.0 * half)
    deep = (inner if negative else outer) - least
    if deep < 0.0:
        return True, 0, 0.0
    if not outer < 1.0e300:
        return False, 0, np.inf
    last = code.shape[0] - 1
    slope, steepest, way = 0.0, 0.0, 0
    for axis in range(3):
        falls, rises = scratch[last, 2 + 2 * axis], scratch[last, 3 + 2 * axis]
        slope += max(-falls, rises)
        if max(falls, -rises) > steepest:
            steepest = max(falls, -rises)
            way = -1 - axis if (falls > 0.0) != negative else 1 + axis
    f = value(code, constants, parts, scratch, x, y, z)
    return (
        abs(f) > half * slope * (1.0 + 1.0e-9) and (f < 0.0) == negative,
        way,
        deep / steepest if steepest > 0.0 else np.inf,
    )


@inlined
def bulged(code, constants, parts, scratch, x, y, z, h, negative, way):
    """Whether a neighbor of the cube of side ``h`` from (x, y, z) on has a corner where f has the other sign.

    The neighbor is the one along axis |way| - 1, upward if ``way`` > 0; f has one sign at all corners of the cube.
    Where f is monotone along the axis, what has the other sign in the cube is the neighbor's, through their face.
    """
    axis = abs(way) - 1
    for n in range(4):
        along = 2.0 * h if way > 0 else -h
        u, v = (n & 1) * h, (n >> 1) * h
        f = value(
            code, constants, parts, scratch,
            x + (along if axis == 0 else u), y + (along if axis == 1 else u if axis == 0 else v),
            z + (along if axis == 2 else v),
        )  # fmt: skip
        if (f < 0.0) != negative:
            return True
    return False


@inlined
def nodes_of(code, constants, parts, registers, points, x, y, z, step, nodes):
    """Values of f at ``nodes`` nodes along each axis from (x, y, z) on, x fastest, into the last of ``registers``."""
    n = nodes * nodes * nodes
    for lane in range(n):
        points[0, lane] = x + lane % nodes * step
        points[1, lane] = y + lane // nodes % nodes * step
        points[2, lane] = z + lane // (nodes * nodes) * step
    evaluate(code, constants, parts, registers, points, n)


@inlined
def doubtful(
    code, constants, parts, scratch, second, registers, points, x, y, z, h, negative, deepest, stack,
):  # fmt: skip
    """Volume [m^3] of the parts of the cube of side ``h`` from (x, y, z) on that are not proved to have its corners'
    sign, halved up to ``deepest`` times.
    """
    if deepest == 0:
        return h * h * h
    volume = 0.0
    nodes = (1 << deepest) + 1
    step = h / (nodes - 1)
    nodes_of(code, constants, parts, registers, points, x, y, z, step, nodes)
    values = registers[code.shape[0] - 1]
    for n in range(8):
        half = 1 << (deepest - 1)
        stack[n, 0] = half if n & 1 else 0
        stack[n, 1] = half if n & 2 else 0
        stack[n, 2] = half if n & 4 else 0
        stack[n, 3] = 1
    top = 8
    while top > 0:
        top -= 1
        i, j, k, depth = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
        wide = 1 << (deepest - depth)
        side = step * wide
        some = of_corners(values, nodes, i, j, k, wide)
        if proved(
            code, constants, parts, scratch, second,
            x + (i + 0.5 * wide) * step, y + (j + 0.5 * wide) * step, z + (k + 0.5 * wide) * step,
            0.5 * side * WIDER, negative, some[1] if some[0] == negative and some[1] < np.inf else 0.0,
        )[0]:  # fmt: skip
            continue
        if depth == deepest:
            volume += side * side * side
            continue
        wide //= 2
        for n in range(8):
            stack[top, 0] = i + (wide if n & 1 else 0)
            stack[top, 1] = j + (wide if n & 2 else 0)
            stack[top, 2] = k + (wide if n & 4 else 0)
            stack[top, 3] = depth + 1
            top += 1
    return volume


@inlined
def of_corners(values, nodes, x, y, z, wide):
    """(whether f < 0 at a cube's first corner, least |f| at its corners); infinite where their signs differ.

    Of the cube of ``wide`` steps from node (x, y, z) on, among ``nodes`` along each axis.
    """
    p = (z * nodes + y) * nodes + x
    negative = values[p] < 0.0
    least = np.inf
    for c in range(8):
        v = values[p + ((c & 1) + (c >> 1 & 1) * nodes + (c >> 2) * nodes * nodes) * wide]
        if (v < 0.0) != negative:
            return negative, np.inf
        least = min(least, abs(v) if v == v else 0.0)
    return negative, least


@inlined
def crossed(code, constants, parts, registers, points, x, y, z, step, nodes, negative):
    """Whether f has the other sign at one of ``nodes`` nodes along each axis from (x, y, z) on."""
    nodes_of(code, constants, parts, registers, points, x, y, z, step, nodes)
    values = registers[code.shape[0] - 1]
    for lane in range(nodes * nodes * nodes):
        if (values[lane] < 0.0) != negative:
            return True
    return False


@lean(
    f"int64({TAPE}, int32[:, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[::1], int64[:, ::1], float64[:, ::1], float64[::1], int32[:, ::1], uint8[::1], int64, int64,"
    " int32[:, ::1], float64[::1], boolean[::1])"
)
def hidden(
    code, constants, parts, scratch, short, near, registers, points, values, stack, second, grid, blocks,
    eighths, deepest, finer, cells, rest, seen,
):  # fmt: skip
    """Find the cubes of some blocks with corners of one sign, but no proof for their inside; returns their number.

    Of block b those are looked at whose eighth, from 0 along x, y and z to 7, is a bit of ``eighths[b]``.
    A thin bulge of what a neighbor shows needs none. Cubes are halved up to ``deepest`` times. Their places go into
    ``cells`` (n, 3), the volumes [m^3] without a proof into ``rest``, and into ``seen`` whether f has the other sign at
    a node of cells ``finer`` times as fine, at most 5: such cubes are not halved.
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
        outer = inner = 1.0e300
        if verdict(code2, constants, parts2, scratch, grid, i, j, k, BLOCK) == CUT:
            code2 = code2[: deciding(code2, scratch) + 1]
            outer, inner = enough(code2, constants, parts2, scratch, second, h)
        sample(code2, constants, parts2, registers, short[2], points, grid, i, j, k, values)
        for part in range(SIDE**3):
            x0, y0, z0 = 2 * (part % SIDE), 2 * (part // SIDE % SIDE), 2 * (part // SIDE**2)
            if eighths[b] >> (x0 // SIDE + y0 // SIDE * 2 + z0 // SIDE * 4) & 1 == 0:
                continue
            some = False
            for n in range(8):
                negative, least = of_corners(values, NODES, x0 + (n & 1), y0 + (n >> 1 & 1), z0 + (n >> 2), 1)
                some = some or least <= (inner if negative else outer)
            if not some:
                continue
            # Of eight cubes at once: most are proved by what is known of all.
            x, y, z = grid[0] + (i + x0) * h, grid[1] + (j + y0) * h, grid[2] + (k + z0) * h
            low, high, status = box(code2, constants, parts2, scratch, x, x + 2.0 * h, y, y + 2.0 * h, z, z + 2.0 * h)
            outside, inside = outer, inner
            if status == WHOLE:
                outside, inside = enough(code2, constants, parts2, scratch, second, h)
                outside, inside = min(outside, outer), min(inside, inner)
            for n in range(8):
                x, y, z = x0 + (n & 1), y0 + (n >> 1 & 1), z0 + (n >> 2)
                negative, least = of_corners(values, NODES, x, y, z, 1)
                if least > (inside if negative else outside) or (
                    status == WHOLE and high < SHALLOW if negative else low >= -SHALLOW
                ):
                    continue
                u, v, w = grid[0] + (i + x) * h, grid[1] + (j + y) * h, grid[2] + (k + z) * h
                sure, way, thick = proved(
                    code2, constants, parts2, scratch, second,
                    u + 0.5 * h, v + 0.5 * h, w + 0.5 * h, 0.5 * h * WIDER, negative, least,
                )  # fmt: skip
                if sure or (thick <= CAP * h and bulged(code, constants, parts, scratch, u, v, w, h, negative, way)):
                    continue
                seen[count] = finer > 1 and crossed(
                    code2, constants, parts2, registers, points, u, v, w, h / finer, finer + 1, negative
                )
                rest[count] = doubtful(
                    code2, constants, parts2, scratch, second, registers, points,
                    u, v, w, h, negative, 0 if seen[count] else deepest, stack,
                )  # fmt: skip
                if rest[count] > 0.0:
                    cells[count, 0] = i + x
                    cells[count, 1] = j + y
                    cells[count, 2] = k + z
                    count += 1
    return count
