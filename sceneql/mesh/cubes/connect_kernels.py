# mypy: ignore-errors
"""Triangles of blocks: vertices on edges are found by the block that owns the edge; inner vertices are placed."""

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_ops import TAPE
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.cubes.triangle_kernels import turn

CENTERS = 12
BENT = 0.5
"""Cosine of 60 degrees: where normals in a cube turn by more, it is too coarse for its surface."""


@inlined
def owned(keys, low, high, key):
    """Index of a key among the ascending keys[low:high]."""
    while low < high:
        middle = (low + high) // 2
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low


@inlined
def vertex(edge, x, y, z, block, beyond, begin, keys, local):
    """The vertex on an edge of the cube (x, y, z) of a block; -1 if the block that owns the edge was not extracted."""
    axis = edge >> 2
    u = edge & 1
    v = edge >> 1 & 1
    i = x + (0 if axis == 0 else v if axis == 1 else u)
    j = y + (u if axis == 0 else 0 if axis == 1 else v)
    k = z + (v if axis == 0 else u if axis == 1 else 0)
    if i < BLOCK and j < BLOCK and k < BLOCK:
        return local[3 * ((k * BLOCK + j) * BLOCK + i) + axis]
    owner = beyond[block, i // BLOCK + 2 * (j // BLOCK) + 4 * (k // BLOCK)]
    if owner < 0:
        return -1
    key = 3 * ((k % BLOCK * BLOCK + j % BLOCK) * BLOCK + i % BLOCK) + axis
    return owned(keys, begin[owner], begin[owner + 1], key)


@inlined
def bends(normal, a, b, c):
    """Whether the normals of a triangle's vertices, zero ones apart, turn by more than BENT."""
    ab = normal[a, 0] * normal[b, 0] + normal[a, 1] * normal[b, 1] + normal[a, 2] * normal[b, 2]
    bc = normal[b, 0] * normal[c, 0] + normal[b, 1] * normal[c, 1] + normal[b, 2] * normal[c, 2]
    ca = normal[c, 0] * normal[a, 0] + normal[c, 1] * normal[a, 1] + normal[c, 2] * normal[a, 2]
    return min(min(ab, bc), ca) < BENT


@inlined
def settle(code, constants, parts, scratch, place, normal, v, low, h):
    """Move an inner vertex to the surface by Newton's method along the gradient, clamped to the cube."""
    for _ in range(8):
        f, gx, gy, gz = gradient(code, constants, parts, scratch, place[v, 0], place[v, 1], place[v, 2])
        square = gx * gx + gy * gy + gz * gz
        if not 0.0 < square < 1.0e300 or not abs(f) < 1.0e300:
            return
        scale = square**0.5
        normal[v, 0] = gx / scale
        normal[v, 1] = gy / scale
        normal[v, 2] = gz / scale
        for axis in range(3):
            slope = gx if axis == 0 else gy if axis == 1 else gz
            moved = place[v, axis] - f * slope / square
            place[v, axis] = min(max(moved, low[axis] + 0.01 * h), low[axis] + 0.99 * h)


@lean(
    f"void({TAPE}, float64[::1], int32[:, ::1], int64, int64, int32[:, ::1], int64[::1], int64[::1], int64[::1],"
    " int64[::1], int16[::1], int32[:, ::1], int32[::1], int32[:, ::1], int32[:, :, ::1], int32[::1], float64[::1],"
    " float64[:, ::1], float64[:, ::1], int32[:, ::1], boolean[::1], float64[::1])"
)
def connect(
    code, constants, parts, scratch, grid, blocks, first, last, beyond, begin, cube_at, triangle_at, own_at,
    keys, cubes, start, triangles, around, local, low, place, normal, out, bent, turns,
):  # fmt: skip
    """Triangles of blocks first..last-1 into ``out``, and their inner vertices into ``place`` and ``normal``.

    Vertices of block b begin at begin[b], its cubes at cube_at[b], its triangles at triangle_at[b] and its inner
    vertices at own_at[b]. ``beyond`` has the numbers of the neighboring blocks, as in grid_extraction.Found. ``bent``
    (cubes,) is whether a cube's triangles have ``bends``, ``turns`` (cubes,) the largest ``turn`` of a side [m].
    """
    h = grid[3]
    for b in range(first, last):
        for v in range(begin[b], begin[b + 1]):
            local[keys[v]] = v
        t = triangle_at[b]
        fresh = own_at[b]
        for n in range(cube_at[b], cube_at[b + 1]):
            cube = cubes[n, 0]
            variant = cubes[n, 1]
            x = cube % BLOCK
            y = cube // BLOCK % BLOCK
            z = cube // (BLOCK * BLOCK)
            at = t
            for row in range(start[variant], start[variant + 1]):
                for corner in range(3):
                    edge = triangles[row, corner]
                    if edge >= CENTERS:
                        out[t, corner] = fresh + edge - CENTERS
                    else:
                        out[t, corner] = vertex(edge, x, y, z, b, beyond, begin, keys, local)
                t += 1
            for center in range(2):
                if around[variant, center, 0] < 0:
                    break
                low[0] = grid[0] + (blocks[b, 0] * BLOCK + x) * h
                low[1] = grid[1] + (blocks[b, 1] * BLOCK + y) * h
                low[2] = grid[2] + (blocks[b, 2] * BLOCK + z) * h
                count = 0
                for k in range(12):
                    edge = around[variant, center, k]
                    if edge < 0:
                        break
                    v = vertex(edge, x, y, z, b, beyond, begin, keys, local)
                    count += 1
                    for axis in range(3):
                        place[fresh, axis] += place[v, axis]
                        normal[fresh, axis] += normal[v, axis]
                for axis in range(3):
                    place[fresh, axis] /= count
                settle(code, constants, parts, scratch, place, normal, fresh, low, h)
                fresh += 1
            bent[n] = False
            turns[n] = 0.0
            for row in range(at, t):
                p, q, r = out[row, 0], out[row, 1], out[row, 2]
                bent[n] |= bends(normal, p, q, r)
                turns[n] = max(
                    turns[n], turn(place, normal, p, q), turn(place, normal, q, r), turn(place, normal, r, p)
                )
