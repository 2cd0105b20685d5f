# mypy: ignore-errors
"""The surface in a block: the cubes that it crosses, with their variants, and its vertices on grid edges."""

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.tape.batch_kernels import LANES
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.tape_ops import TAPE
from sceneql.mesh.cubes.cull_kernels import CLEAR, CUT, REACH, verdict
from sceneql.mesh.cubes.decide_kernels import CASES, decide_by_field
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.cubes.hidden_kernels import look_into
from sceneql.mesh.cubes.polish_kernels import DX, DY, DZ, FA, FB, SIDE, UNDEFINED, A, B, T, normals, polish
from sceneql.mesh.cubes.sample_kernels import NODES, sample

EDGES = 3 * BLOCK**3
"""Edges that a block owns: the three from each node upward, for nodes not on its high sides."""
VERTICES, CUBES, TRIANGLES, OWN = range(4)
"""Columns of a block's tally: vertices on edges, cubes, triangles, inner vertices."""


@inlined
def insides(values, masks):
    """Write masks (NODES^2,), one a row along x, with a bit set where f < 0; returns whether both signs occur."""
    some = 0
    every = (1 << NODES) - 1
    for row in range(NODES * NODES):
        mask = 0
        for x in range(NODES):
            mask |= (1 if values[NODES * row + x] < 0.0 else 0) << x
        masks[row] = mask
        some |= mask
        every &= mask
    return some != 0 and every != (1 << NODES) - 1


@inlined
def cubes_of(
    code, constants, parts, scratch, grid, i, j, k, values, masks, corners, first, faces, tunnel, start, own,
    cubes, begun, tally,
):  # fmt: skip
    """Write the cubes with a change of sign as (place in the block, variant) from ``begun`` on; count what is made."""
    n = begun
    for z in range(BLOCK):
        for y in range(BLOCK):
            row = z * NODES + y
            a = masks[row]
            b = masks[row + 1]
            c = masks[row + NODES]
            d = masks[row + NODES + 1]
            some = a | b | c | d
            every = a & b & c & d
            mixed = (some | some >> 1) & ~(every & every >> 1) & ((1 << BLOCK) - 1)
            x = -1
            while mixed >> (x + 1) != 0:
                x += 1
                if mixed >> x & 1 == 0:
                    continue
                config = a >> x & 3 | (b >> x & 3) << 2 | (c >> x & 3) << 4 | (d >> x & 3) << 6
                variant = first[config]
                if faces[config, 0, 0] != -1:
                    p = row * NODES + x
                    for at in range(8):
                        corners[at] = values[p + (at & 1) + (at >> 1 & 1) * NODES + (at >> 2) * NODES * NODES]
                    variant = decide_by_field(
                        code, constants, parts, scratch, grid, i + x, j + y, k + z, corners, config, first, faces,
                        tunnel,
                    )  # fmt: skip
                cubes[n, 0] = (z * BLOCK + y) * BLOCK + x
                cubes[n, 1] = variant
                n += 1
                tally[TRIANGLES] += start[variant + 1] - start[variant]
                tally[OWN] += own[variant]
    tally[CUBES] = n - begun
    return n


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
    masks,
    keys,
    at,
    place,
    normal,
):
    """Find the vertices on the edges that the block owns, in the order of the edges, and write them from ``at`` on."""
    h = grid[3]
    n = 0
    done = at
    for z in range(BLOCK):
        for y in range(BLOCK):
            row = z * NODES + y
            mask = masks[row]
            crossed_x = (mask ^ mask >> 1) & ((1 << BLOCK) - 1)
            crossed_y = (mask ^ masks[row + 1]) & ((1 << BLOCK) - 1)
            crossed_z = (mask ^ masks[row + NODES]) & ((1 << BLOCK) - 1)
            crossed = crossed_x | crossed_y | crossed_z
            x = -1
            while crossed >> (x + 1) != 0:
                x += 1
                if crossed >> x & 1 == 0:
                    continue
                p = row * NODES + x
                up = mask >> x & 1 == 1
                step = 1
                for axis in range(3):
                    q = p + step
                    step *= NODES
                    if (crossed_x if axis == 0 else crossed_y if axis == 1 else crossed_z) >> x & 1 == 0:
                        continue
                    keys[done + n] = 3 * ((z * BLOCK + y) * BLOCK + x) + axis
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
                    starts[0, n] = grid[0] + (i + x) * h
                    starts[1, n] = grid[1] + (j + y) * h
                    starts[2, n] = grid[2] + (k + z) * h
                    n += 1
            if n > LANES - 3 * BLOCK or (n > 0 and z == BLOCK - 1 and y == BLOCK - 1):
                polish(code, constants, parts, registers, points, search, starts, place, done, n)
                normals(code, constants, parts, registers, slope, points, place, normal, done, n)
                done += n
                n = 0
    return done


@lean(
    f"UniTuple(int64, 3)({TAPE}, int32[:, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1],"
    " float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1], float64[::1], int64[::1], float64[::1],"
    " int64[:, ::1], float64[:, ::1],"
    f" float64[::1], int32[:, ::1], {CASES}, int32[::1], int32[::1],"
    " int16[::1], float64[:, ::1], float64[:, ::1], int32[:, ::1], int64[:, ::1],"
    " int64, int64, int32[:, ::1], float64[::1], boolean[::1])"
)
def extract(
    code, constants, parts, scratch, short, near, registers, slope,
    points, starts, search, values, nearest, masks, corners, stack, second,
    grid, blocks, first, faces, tunnel, start, own,
    keys, place, normal, cubes, tally, deepest, finer, cells, rest, seen,
):  # fmt: skip
    """Vertices, normals, edge keys and cubes of some blocks, in order; returns (vertices, cubes, hidden cubes).

    ``tally`` (blocks, 4) counts by block. Consecutive blocks in one box of REACH a side share the tape simplified for
    the box. ``short`` (3, rows, 4), ``near`` (2, parts, 8), ``registers``, ``slope``, ``points``, ``starts``,
    ``search``, ``values`` to ``second`` are working memory. Cubes without a change of sign are looked into as in
    ``hidden``, unless ``deepest`` < 0.
    """
    wide = REACH * BLOCK
    x = y = z = -1
    rows1 = used1 = 0
    vertices = 0
    found = 0
    doubts = 0
    for b in range(blocks.shape[0]):
        i = blocks[b, 0] * BLOCK
        j = blocks[b, 1] * BLOCK
        k = blocks[b, 2] * BLOCK
        for column in range(4):
            tally[b, column] = 0
        if i // wide != x or j // wide != y or k // wide != z:
            x, y, z = i // wide, j // wide, k // wide
            at = verdict(code, constants, parts, scratch, grid, x * wide, y * wide, z * wide, wide)
            rows1, used1 = simplify(code, parts, scratch, at == CUT, short[0], near[0])
        code1 = short[0][:rows1]
        parts1 = near[0][:used1]
        at = verdict(code1, constants, parts1, scratch, grid, i, j, k, BLOCK)
        if at == CLEAR:
            continue
        rows, used = simplify(code1, parts1, scratch, at == CUT, short[1], near[1])
        code2 = short[1][:rows]
        parts2 = near[1][:used]
        sample(code2, constants, parts2, registers, short[2], points, grid, i, j, k, values)
        if insides(values, masks):
            found = cubes_of(
                code2, constants, parts2, scratch, grid, i, j, k, values, masks, corners, first, faces, tunnel, start,
                own, cubes, found, tally[b],
            )  # fmt: skip
            before = vertices
            vertices = vertices_of(
                code2, constants, parts2, registers, slope, points, starts, search,
                grid, i, j, k, values, masks, keys, vertices, place, normal,
            )  # fmt: skip
            tally[b, VERTICES] = vertices - before
        if deepest >= 0:
            doubts = look_into(
                code, constants, parts, scratch, code2, parts2, short[2], registers, points, values, nearest,
                stack, second, grid, i, j, k, 255, deepest, finer, cells, rest, seen, doubts,
            )  # fmt: skip
    return vertices, found, doubts
