# mypy: ignore-errors
"""What the surface does in a block: cubes it passes through with their variants, and its vertices on grid edges."""

from sceneql.field.batch_kernels import LANES, evaluate
from sceneql.field.simplify_kernels import simplify
from sceneql.field.tape_kernels import TAPE
from sceneql.kernels import inlined, lean
from sceneql.mesh.cull_kernels import CLEAR, CUT, verdict
from sceneql.mesh.decide_kernels import CASES, decide
from sceneql.mesh.grid import BLOCK
from sceneql.mesh.polish_kernels import DX, DY, DZ, FA, FB, SIDE, UNDEFINED, A, B, T, normals, polish

NODES = BLOCK + 1
"""Nodes along a block; those on its high sides are its neighbors' too."""
EDGES = 3 * BLOCK**3
"""Edges that a block owns: the three that go up from each node but those on its high sides."""
VERTICES, CUBES, TRIANGLES, OWN = range(4)
"""Columns of a block's tally: vertices on edges, cubes, triangles, and vertices of the cubes' own."""


@inlined
def sample(code, constants, parts, registers, points, grid, i, j, k, values):
    """f at the nodes of the block whose first node is (i, j, k), x fastest."""
    h = grid[3]
    last = code.shape[0] - 1
    n = 0
    done = 0
    for z in range(NODES):
        pz = grid[2] + (k + z) * h
        for y in range(NODES):
            py = grid[1] + (j + y) * h
            for x in range(NODES):
                points[0, n + x] = grid[0] + (i + x) * h
                points[1, n + x] = py
                points[2, n + x] = pz
            n += NODES
            if n + NODES > LANES or (z == BLOCK and y == BLOCK):
                evaluate(code, constants, parts, registers, points, n)
                for lane in range(n):
                    values[done + lane] = registers[last, lane]
                done += n
                n = 0


@inlined
def cubes_of(values, signs, corners, first, faces, tunnel, start, own, cubes, at, tally):
    """Note the cubes with a change of sign as (place in the block, variant) from ``at`` on; count what they make."""
    n = at
    for z in range(BLOCK):
        for y in range(BLOCK):
            row = (z * NODES + y) * NODES
            before = 0
            for x in range(NODES):
                p = row + x
                here = signs[p] | signs[p + NODES] << 2 | signs[p + NODES * NODES] << 4
                here |= signs[p + NODES * NODES + NODES] << 6
                config = before | here << 1
                before = here
                if x == 0 or config == 0 or config == 255:
                    continue
                variant = first[config]
                if faces[config, 0, 0] != -1:
                    for c in range(8):
                        corners[c] = values[p - 1 + (c & 1) + (c >> 1 & 1) * NODES + (c >> 2) * NODES * NODES]
                    variant = decide(corners, config, first, faces, tunnel)
                cubes[n, 0] = (z * BLOCK + y) * BLOCK + x - 1
                cubes[n, 1] = variant
                n += 1
                tally[TRIANGLES] += start[variant + 1] - start[variant]
                tally[OWN] += own[variant]
    tally[CUBES] = n - at
    return n


@inlined
def settled(code, constants, parts, registers, slope, points, starts, search, place, normal, at, n):
    """Bring n vertices to the surface and store them from ``at`` on; where they end."""
    polish(code, constants, parts, registers, points, search, starts, n)
    normals(code, constants, parts, registers, slope, points, normal, at, n)
    for i in range(n):
        for axis in range(3):
            place[at + i, axis] = points[axis, i]
    return at + n


@inlined
def vertices_of(
    code,
    constants,
    parts,
    registers,
    slope,
    points,
    starts,
    search,
    grid,
    i,
    j,
    k,
    values,
    signs,
    keys,
    at,
    place,
    normal,
):
    """Find the vertices on the edges that the block owns, in the order of the edges, from ``at`` on."""
    h = grid[3]
    n = 0
    done = at
    for z in range(BLOCK):
        for y in range(BLOCK):
            for x in range(BLOCK):
                p = (z * NODES + y) * NODES + x
                here = signs[p]
                if here == signs[p + 1] and here == signs[p + NODES] and here == signs[p + NODES * NODES]:
                    continue
                step = 1
                for axis in range(3):
                    q = p + step
                    step *= NODES
                    if here == signs[q]:
                        continue
                    keys[done + n] = 3 * ((z * BLOCK + y) * BLOCK + x) + axis
                    up = here == 1
                    outer = values[q] if up else values[p]
                    search[A, n] = 0.0 if up else 1.0
                    search[B, n] = 1.0 if up else 0.0
                    search[FA, n] = values[p] if up else values[q]
                    search[FB, n] = outer if outer == outer else UNDEFINED
                    search[T, n] = -1.0
                    search[SIDE, n] = 0.0
                    search[DX, n] = h if axis == 0 else 0.0
                    search[DY, n] = h if axis == 1 else 0.0
                    search[DZ, n] = h if axis == 2 else 0.0
                    starts[0, n] = points[0, n] = grid[0] + (i + x) * h
                    starts[1, n] = points[1, n] = grid[1] + (j + y) * h
                    starts[2, n] = points[2, n] = grid[2] + (k + z) * h
                    n += 1
                if n > LANES - 3:
                    done = settled(
                        code, constants, parts, registers, slope, points, starts, search, place, normal, done, n
                    )
                    n = 0
    if n > 0:
        done = settled(code, constants, parts, registers, slope, points, starts, search, place, normal, done, n)
    return done


@lean(
    f"UniTuple(int64, 2)({TAPE}, int32[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, :, ::1],"
    " float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1], int8[::1], float64[::1],"
    f" float64[::1], int32[:, ::1], {CASES}, int32[::1], int32[::1],"
    " int16[::1], float64[:, ::1], float64[:, ::1], int32[:, ::1], int64[:, ::1])"
)
def extract(
    code, constants, parts, scratch, short, near, registers, slope,
    points, starts, search, values, signs, corners,
    grid, blocks, first, faces, tunnel, start, own,
    keys, place, normal, cubes, tally,
):  # fmt: skip
    """Vertices, normals, edge keys and cubes of some blocks, one after the other; their (vertices, cubes).

    ``tally`` (blocks, 4) counts by block. ``short``, ``near``, ``registers``, ``slope``, ``points``, ``starts``,
    ``search``, ``values``, ``signs`` and ``corners`` are room to work in.
    """
    vertices = 0
    found = 0
    for b in range(blocks.shape[0]):
        i = blocks[b, 0] * BLOCK
        j = blocks[b, 1] * BLOCK
        k = blocks[b, 2] * BLOCK
        for column in range(4):
            tally[b, column] = 0
        at = verdict(code, constants, parts, scratch, grid, i, j, k, BLOCK)
        if at == CLEAR:
            continue
        rows, used = simplify(code, parts, scratch, at == CUT, short, near)
        code2 = short[:rows]
        parts2 = near[:used]
        sample(code2, constants, parts2, registers, points, grid, i, j, k, values)
        negative = 0
        for node in range(NODES * NODES * NODES):
            signs[node] = 1 if values[node] < 0.0 else 0
            negative += signs[node]
        if negative == 0 or negative == NODES * NODES * NODES:
            continue
        found = cubes_of(values, signs, corners, first, faces, tunnel, start, own, cubes, found, tally[b])
        before = vertices
        vertices = vertices_of(
            code2, constants, parts2, registers, slope, points, starts, search,
            grid, i, j, k, values, signs, keys, vertices, place, normal,
        )  # fmt: skip
        tally[b, VERTICES] = vertices - before
    return vertices, found
