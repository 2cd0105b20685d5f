# mypy: ignore-errors
"""Edges of cubes that the surface meets which it passes twice unseen: sheets that are thinner than a cube, and gaps."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_ops import TAPE
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.cubes.sample_kernels import NODES

PLACES = 8
"""Equal parts of an edge at whose ends f is evaluated."""
SHALLOW = 0.05
"""Share of the spread of f over a cube's corners up to which f may pass zero along an edge unseen: a smooth bulge."""


@inlined
def reached(code, constants, parts, scratch, x, y, z, h, axis, negative):
    """Whether f has the other sign somewhere on the edge of length ``h`` from (x, y, z) on along an axis."""
    for n in range(PLACES, -1, -1):
        t = h * n / PLACES
        f = value(
            code, constants, parts, scratch,
            x + (t if axis == 0 else 0.0), y + (t if axis == 1 else 0.0), z + (t if axis == 2 else 0.0),
        )  # fmt: skip
        if (f < 0.0) != negative:
            return True
    return False


@inlined
def passes(code, constants, parts, scratch, x, y, z, h, axis, negative):
    """Whether what has the other sign on an edge belongs to a sheet that goes on beyond it, or to several parts.

    By the eight parallel edges around it: where those that reach the other sign are next to one another, and so are
    the others, the edge is at a rim, which loses a part of a cube and keeps its topology.
    """
    changes = 0
    first = last = False
    for n in range(8):
        u = h if n < 3 else -h if 4 <= n < 7 else 0.0
        v = h if 2 <= n < 5 else -h if n == 0 or n >= 6 else 0.0
        some = reached(
            code, constants, parts, scratch,
            x + (0.0 if axis == 0 else u), y + (u if axis == 0 else 0.0 if axis == 1 else v),
            z + (0.0 if axis == 2 else v), h, axis, negative,
        )  # fmt: skip
        if n == 0:
            first = some
        elif some != last:
            changes += 1
        last = some
    changes += 1 if first != last else 0
    return changes != 2


@inlined
def depth(falls, rises, a, b):
    """How far a function with |f| = a and b at an edge's ends passes zero if it falls and rises by so much along it."""
    if not (falls > 0.0 and rises > 0.0):
        return 0.0
    if not (falls < np.inf and rises < np.inf):
        return np.inf
    return (falls * rises - rises * a - falls * b) / (falls + rises)


@inlined
def beyond(code, constants, parts, scratch, values, q, x, y, z, h, axis, steps):
    """f at ``steps`` steps along an axis from node q of a block, which lies at (x, y, z)."""
    stride = 1 if axis == 0 else NODES if axis == 1 else NODES**2
    at = q // stride % NODES + steps
    if 0 <= at < NODES:
        return values[q + steps * stride]
    t = steps * h
    return value(
        code, constants, parts, scratch,
        x + (t if axis == 0 else 0.0), y + (t if axis == 1 else 0.0), z + (t if axis == 2 else 0.0),
    )  # fmt: skip


@inlined
def suspects(values, p, step, before, behind, n, bound, mark, marks):
    """Add ``mark`` to ``marks`` (n,) of the edges between nodes p and p + step that may be among ``slips``, and of the
    n - 1 after them; returns whether there are any.

    By f there and at two more nodes of each, ``before`` it and ``behind``; where these are nodes of the edge itself,
    nothing is asked for.
    """
    at, beside, first, last = values[p:], values[p + step :], values[p - before :], values[p + behind :]
    begins, ends = before == 0, behind == step
    some = False
    for i in range(n):
        f, g = at[i], beside[i]
        a, b = abs(f), abs(g)
        falls = (abs(first[i]) > 2.0 * a) | begins
        rises = (abs(last[i]) > 2.0 * b) | ends
        found = ((f < 0.0) == (g < 0.0)) & ((a < bound) | (b < bound)) & falls & rises
        marks[i] += mark if found else 0.0
        some |= found
    return some


@inlined
def suspected(values, slopes, bound):
    """Whether an edge of a block may be one of ``slips``; the sum of 1, 2 and 4 for those along x, y and z that begin
    at a node into values[NODES^3:].

    By f at nodes alone, many at a time: it tells of most edges that they are not. Of edges that leave the block nothing
    is told.
    """
    last = NODES**3
    marks = values[last:]
    for p in range(last):
        marks[p] = 0.0
    some = False
    if slopes[0] < 0.0 < slopes[1]:
        some |= suspects(values, 1, 1, 1, 2, last - 3, bound, 1.0, marks[1:])
        for p in range(0, last, NODES):  # where rows begin and end
            marks[p] = marks[p + BLOCK - 1] = 0.0
            some |= suspects(values, p, 1, 0, 2, 1, bound, 1.0, marks[p:])
            some |= suspects(values, p + BLOCK - 1, 1, 1, 1, 1, bound, 1.0, marks[p + BLOCK - 1 :])
    for axis in range(1, 3):
        if not slopes[2 * axis] < 0.0 < slopes[2 * axis + 1]:
            continue
        step, mark = NODES**axis, 2.0 * axis
        for row in range(last // (NODES * step) * BLOCK):
            at = row % BLOCK
            p = (row // BLOCK * NODES + at) * step
            before = step if at > 0 else 0
            behind = 2 * step if at + 2 < NODES else step
            some |= suspects(values, p, step, before, behind, step, bound, mark, marks[p:])
    return some


@inlined
def near_suspects(values, nearest, p, n):
    """Whether one of the n cubes from node p on along x meets the surface, and has an edge that begins at one of its
    corners and is marked by ``suspected``.
    """
    row, least = values[NODES**3 + p :], nearest[p:]
    some = False
    for i in range(n):
        marks = row[i] + row[i + 1] + row[i + NODES] + row[i + NODES + 1]
        marks += row[i + NODES**2] + row[i + NODES**2 + 1] + row[i + NODES**2 + NODES]
        some |= (marks > 0.0) & (least[i] == np.inf)
    return some


@inlined
def slips(code, constants, parts, scratch, code2, parts2, values, slopes, grid, outer, inner, i, j, k, p, need):
    """Whether the surface passes an edge of the cube from node p on twice, by more than ``need``, not at a rim."""
    h = grid[3]
    for axis in range(3):
        low, high = h * slopes[2 * axis], h * slopes[2 * axis + 1]
        if not low < 0.0 < high:
            continue
        step = 1 if axis == 0 else NODES if axis == 1 else NODES**2
        across = NODES if axis == 0 else 1
        upward = NODES if axis == 2 else NODES**2
        for edge in range(4):
            q = p + (edge & 1) * across + (edge >> 1) * upward
            if int(values[NODES**3 + q]) >> axis & 1 == 0:
                continue
            f, g = values[q], values[q + step]
            a, b = abs(f), abs(g)
            at = q // step % NODES
            # Only where f falls by more than what is left, and rises so, as it does beside the edge.
            if (f < 0.0) != (g < 0.0) or (at > 0 and not abs(values[q - step]) > 2.0 * a):
                continue
            if (at + 2 < NODES and not abs(values[q + 2 * step]) > 2.0 * b) or (
                not (inner if f < 0.0 else outer) - min(a, b) > need
            ):
                continue
            negative = f < 0.0
            falls, rises = (high, -low) if negative else (-low, high)
            if not depth(falls, rises, a, b) > need:
                continue
            x = grid[0] + (i + q % NODES) * h
            y = grid[1] + (j + q // NODES % NODES) * h
            z = grid[2] + (k + q // NODES**2) * h
            falls = abs(beyond(code, constants, parts, scratch, values, q, x, y, z, h, axis, -1)) - a
            rises = abs(beyond(code, constants, parts, scratch, values, q, x, y, z, h, axis, 2)) - b
            if (
                depth(falls, rises, a, b) > need
                and reached(code2, constants, parts2, scratch, x, y, z, h, axis, negative)
                and passes(code, constants, parts, scratch, x, y, z, h, axis, negative)
            ):
                return True
    return False


@lean(
    f"int64({TAPE}, int32[:, ::1], float64[:, ::1], float64[::1], float64[::1], float64[:], float64[::1], float64,"
    " float64, int64, int64, int64, int64, int32[:, ::1], float64[::1], boolean[::1], int64)"
)
def slipped(
    code, constants, parts, scratch, code2, parts2, values, nearest, slopes, grid, outer, inner, i, j, k, eighths,
    cells, rest, seen, count,
):  # fmt: skip
    """Write the cubes of a block that the surface meets, and along an edge of which it passes twice between two corners
    of one sign, from ``count`` on; returns the next place.

    Not where the edge is at a rim (``passes``). Of the eighths that are bits of ``eighths``. ``slopes`` (6,) bounds
    f's derivatives in the block; ``outer`` and ``inner`` how far f lies from what is linear between corners of a cube.
    """
    h = grid[3]
    half = BLOCK // 2
    most_bound = max(outer, inner)
    steady = 0.0  # how fast f changes at least along an axis: what it does over each cube
    turns = False
    for axis in range(3):
        steady = max(steady, max(slopes[2 * axis], -slopes[2 * axis + 1]))
        turns = turns or slopes[2 * axis] < 0.0 < slopes[2 * axis + 1]
    if most_bound <= SHALLOW * steady * h or not turns or not suspected(values, slopes, most_bound):
        return count
    for row in range(BLOCK * BLOCK):
        y, z = row % BLOCK, row // BLOCK
        if not near_suspects(values, nearest, (z * NODES + y) * NODES, BLOCK):
            continue
        for x in range(BLOCK):
            p = (z * NODES + y) * NODES + x
            if nearest[p] < np.inf or eighths >> (x // half + 2 * (y // half) + 4 * (z // half)) & 1 == 0:
                continue
            if not near_suspects(values, nearest, p, 1):
                continue
            least, most = np.inf, -np.inf
            for c in range(8):
                f = values[p + (c & 1) + (c >> 1 & 1) * NODES + (c >> 2) * NODES * NODES]
                least, most = min(least, f), max(most, f)
            need = SHALLOW * (most - least)
            if most_bound > need and slips(
                code, constants, parts, scratch, code2, parts2, values, slopes, grid, outer, inner, i, j, k, p, need
            ):
                cells[count, 0] = i + x
                cells[count, 1] = j + y
                cells[count, 2] = k + z
                rest[count] = h * h * h
                seen[count] = True
                count += 1
    return count
