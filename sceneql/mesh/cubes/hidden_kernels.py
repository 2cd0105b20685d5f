# mypy: ignore-errors
"""Cubes with corners of one sign that may yet contain surface: proved empty or full, or counted."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_ops import NOWHERE, TAPE, WHOLE
from sceneql.mesh.cubes.corner_kernels import in_doubt, least_at_corners, of_corners
from sceneql.mesh.cubes.cull_kernels import CLEAR, CUT, verdict
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.cubes.sample_kernels import NODES, sample
from sceneql.mesh.cubes.sign_kernels import UNKNOWN, WIDER, deciding, enough, steep_and_bent
from sceneql.mesh.cubes.slipped_kernels import slipped

SIDE = BLOCK // 2
"""Cubes along an eighth of a block, and pairs of cubes along a block."""
DEEPEST = 2
"""How often a cube may be halved before it is left unresolved."""
SHALLOW = 1.0e-12
"""Depth to which f may go to the other side of zero by rounding, where it touches zero."""
CAP = 0.125
"""Greatest thickness, in cubes, of a bulge through a face that counts as a part of the sheet beyond the face."""


@inlined
def proved(code, constants, parts, scratch, second, x, y, z, half, negative, least):
    """(whether f is proved to keep its sign within ``half`` of a point along each axis, way, thickness, steep, bent).

    By its range, by the mean value form, or, as in ``enough``, by ``least``, the least |f| at the box's corners.
    Without a proof, f may have the other sign only up to a ``thickness`` [m] from a face, ``way`` as ``bulged`` has it;
    ``steep`` and ``bent`` are for ``enough``, of cubes in the box.
    """
    low, high, status = box(
        code, constants, parts, scratch, x - half, x + half, y - half, y + half, z - half, z + half
    )  # fmt: skip
    if status == NOWHERE:
        return not negative, 0, np.inf, np.inf, np.inf
    if negative:
        if status != WHOLE:
            return False, 0, np.inf, np.inf, np.inf
        if high < SHALLOW:
            return True, 0, 0.0, np.inf, np.inf
    elif low >= -SHALLOW:
        return True, 0, 0.0, np.inf, np.inf
    if status != WHOLE:
        return False, 0, np.inf, np.inf, np.inf
    steep, upward, downward = steep_and_bent(code, constants, parts, scratch, second)
    bent = downward if negative else upward
    deep = enough(steep, bent, 2.0 * half) - least
    if deep < 0.0:
        return True, 0, 0.0, steep, bent
    if not steep < UNKNOWN:
        return False, 0, np.inf, steep, bent
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
        steep,
        bent,
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
    code, constants, parts, scratch, second, registers, points, x, y, z, h, negative, steep, bent, deepest, stack,
):  # fmt: skip
    """Volume [m^3] of the parts of the cube of side ``h`` from (x, y, z) on that are not proved to have its corners'
    sign, halved up to ``deepest`` times; ``steep`` and ``bent`` are for ``enough``, of cubes in it.
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
        if some[0] == negative and enough(steep, bent, side * WIDER) < some[1] < np.inf:
            continue
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
def told_by_nodes(values, nodes, h, negative, steep, bent):
    """(whether f has the other sign at one of the ``nodes`` nodes along each axis of a cube, whether it is proved not
    to have it anywhere), by ``enough`` for the cubes of side ``h`` between the nodes.
    """
    for lane in range(nodes * nodes * nodes):
        if (values[lane] < 0.0) != negative:
            return True, False
    need, between = enough(steep, bent, h * WIDER), nodes - 1
    for n in range(between * between * between):
        x, y, z = n % between, n // between % between, n // (between * between)
        if not of_corners(values, nodes, x, y, z, 1)[1] > need:
            return False, False
    return False, True


@lean(
    f"int64({TAPE}, int32[:, ::1], float64[:, ::1], int32[:, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[::1], float64[::1], int64[:, ::1], float64[:, ::1], float64[::1], int64, int64, int64, int64, int64,"
    " int64, int32[:, ::1], float64[::1], boolean[::1], int64)"
)
def look_into(
    code, constants, parts, scratch, code2, parts2, short, registers, points, values, nearest, stack, second, grid,
    i, j, k, eighths, deepest, finer, cells, rest, seen, count,
):  # fmt: skip
    """Find the cubes of a block as ``hidden`` does, and write them from ``count`` on; returns the next place.

    ``code2`` and ``parts2`` are the tape simplified for the block, ``values`` what ``sample`` made of them; ``short``
    (rows, 4) is room for a tape.
    """
    h = grid[3]
    outer = inner = UNKNOWN
    slopes = second[0]
    for column in range(6):
        slopes[column] = np.inf if column & 1 else -np.inf
    if verdict(code2, constants, parts2, scratch, grid, i, j, k, BLOCK) == CUT:
        decides = deciding(code2, scratch) + 1
        if decides < code2.shape[0]:
            code2 = code2[:decides]
            sample(code2, constants, parts2, registers, short, points, grid, i, j, k, values)
        steep, upward, downward = steep_and_bent(code2, constants, parts2, scratch, second)
        outer, inner = enough(steep, upward, h), enough(steep, downward, h)
        if steep < UNKNOWN:
            for column in range(6):
                slopes[column] = scratch[code2.shape[0] - 1, 2 + column]
    least_at_corners(values, nearest)
    count = slipped(
        code, constants, parts, scratch, code2, parts2, values, nearest, slopes, grid, outer, inner, i, j, k, eighths,
        cells, rest, seen, count,
    )  # fmt: skip
    if not in_doubt(nearest, 0, 0, 0, BLOCK, outer, inner):
        return count
    far, deep, code3 = outer, inner, code2
    for part in range(SIDE**3):
        eighth = part >> 3
        if eighths >> eighth & 1 == 0:
            continue
        x0 = (eighth & 1) * SIDE + (part & 1) * 2
        y0 = (eighth >> 1 & 1) * SIDE + (part >> 1 & 1) * 2
        z0 = (eighth >> 2) * SIDE + (part >> 2 & 1) * 2
        if part & 7 == 0:  # what is known of an eighth, and then of eight cubes, proves most of them
            far, deep, code3 = outer, inner, code2
            if in_doubt(nearest, x0, y0, z0, SIDE, far, deep):
                x, y, z, wide = grid[0] + (i + x0) * h, grid[1] + (j + y0) * h, grid[2] + (k + z0) * h, SIDE * h
                status = box(code2, constants, parts2, scratch, x, x + wide, y, y + wide, z, z + wide)[2]
                if status == WHOLE:
                    code3 = code2[: deciding(code2, scratch) + 1]
                    steep, upward, downward = steep_and_bent(code3, constants, parts2, scratch, second)
                    far, deep = min(far, enough(steep, upward, h)), min(deep, enough(steep, downward, h))
        if not in_doubt(nearest, x0, y0, z0, 2, far, deep):
            continue
        x, y, z = grid[0] + (i + x0) * h, grid[1] + (j + y0) * h, grid[2] + (k + z0) * h
        low, high, status = box(code3, constants, parts2, scratch, x, x + 2.0 * h, y, y + 2.0 * h, z, z + 2.0 * h)
        outside, inside, code4 = far, deep, code3
        if status == WHOLE:
            code4 = code3[: deciding(code3, scratch) + 1]
            steep, upward, downward = steep_and_bent(code4, constants, parts2, scratch, second)
            outside, inside = min(far, enough(steep, upward, h)), min(deep, enough(steep, downward, h))
        for n in range(8):
            x, y, z = x0 + (n & 1), y0 + (n >> 1 & 1), z0 + (n >> 2)
            signed = nearest[(z * NODES + y) * NODES + x]
            negative, least = signed < 0.0, abs(signed)
            if not -inside <= signed <= outside or (
                status == WHOLE and high < SHALLOW if negative else low >= -SHALLOW
            ):
                continue
            u, v, w = grid[0] + (i + x) * h, grid[1] + (j + y) * h, grid[2] + (k + z) * h
            sure, way, thick, steep, bent = proved(
                code4, constants, parts2, scratch, second,
                u + 0.5 * h, v + 0.5 * h, w + 0.5 * h, 0.5 * h * WIDER, negative, least,
            )  # fmt: skip
            if sure or (thick <= CAP * h and bulged(code, constants, parts, scratch, u, v, w, h, negative, way)):
                continue
            other = False
            if finer > 1:
                nodes_of(code4, constants, parts2, registers, points, u, v, w, h / finer, finer + 1)
                found = registers[code4.shape[0] - 1]
                other, sure = told_by_nodes(found, finer + 1, h / finer, negative, steep, bent)
                if sure:
                    continue
            seen[count] = other
            rest[count] = doubtful(
                code4, constants, parts2, scratch, second, registers, points,
                u, v, w, h, negative, steep, bent, 0 if other else deepest, stack,
            )  # fmt: skip
            if rest[count] > 0.0:
                cells[count, 0] = i + x
                cells[count, 1] = j + y
                cells[count, 2] = k + z
                count += 1
    return count


@lean(
    f"int64({TAPE}, int32[:, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[::1], float64[::1], int64[:, ::1], float64[:, ::1], float64[::1], int32[:, ::1], uint8[::1], int64,"
    " int64, int32[:, ::1], float64[::1], boolean[::1])"
)
def hidden(
    code, constants, parts, scratch, short, near, registers, points, values, nearest, stack, second, grid, blocks,
    eighths, deepest, finer, cells, rest, seen,
):  # fmt: skip
    """Find the cubes of some blocks with corners of one sign, but no proof for their inside, and those ``slipped``;
    returns their number.

    Of block b those are looked at whose eighth, from 0 along x, y and z to 7, is a bit of ``eighths[b]``.
    A thin bulge of what a neighbor shows needs none. Cubes are halved up to ``deepest`` times. Their places go into
    ``cells`` (n, 3), the volumes [m^3] without a proof into ``rest``, and into ``seen`` whether f has the other sign at
    a node of cells ``finer`` times as fine, at most 5: such cubes are not halved.
    """
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
        sample(code2, constants, parts2, registers, short[2], points, grid, i, j, k, values)
        count = look_into(
            code, constants, parts, scratch, code2, parts2, short[2], registers, points, values, nearest,
            stack, second, grid, i, j, k, eighths[b], deepest, finer, cells, rest, seen, count,
        )  # fmt: skip
    return count
