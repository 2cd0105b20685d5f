# mypy: ignore-errors
"""Dual contouring: a vertex for each curve that the surface draws on a cube, at the best intersection of planes.

The planes are those of the surface where it crosses the cube's edges; the vertex is held in its cube or close to it
(Ju, Losasso, Schaefer & Warren 2002). A curve has one vertex, not a cube (Nielson 2004), so that sheets stay apart.
"""

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_ops import TAPE
from sceneql.mesh.cubes.connect_kernels import vertex
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.dual.fit_kernels import held

TURNS = 3
NEARER = 0.05
"""Factor by which planes move towards the vertex in each further turn: on curved faces the vertex converges."""


@inlined
def add_plane(normal, right, nx, ny, nz, away):
    """Add the plane n . step = away to normal equations."""
    normal[0, 0] += nx * nx
    normal[0, 1] += nx * ny
    normal[0, 2] += nx * nz
    normal[1, 0] += ny * nx
    normal[1, 1] += ny * ny
    normal[1, 2] += ny * nz
    normal[2, 0] += nz * nx
    normal[2, 1] += nz * ny
    normal[2, 2] += nz * nz
    right[0] += nx * away
    right[1] += ny * away
    right[2] += nz * away


@inlined
def settle(code, constants, parts, scratch, place, slope, ring, count, low, h, at, room):
    """Place a vertex in the cube at ``low`` by the planes at the ring's crossings; returns the rank of the planes.

    ``at`` (3,) starts in the ring's middle and ends at the vertex.
    """
    normal = room[0:3]
    a = room[3:6]
    v = room[6:9]
    right = room[9]
    step = room[10]
    best = room[11]
    box = room[12:14]
    rank = 0
    near = 1.0
    for turn in range(TURNS):
        for i in range(3):
            right[i] = 0.0
            box[0, i] = low[i] - at[i]
            box[1, i] = low[i] + h - at[i]
            for j in range(3):
                normal[i, j] = 0.0
        planes = 0
        square = 0.0
        near *= NEARER if turn > 0 else 1.0
        for k in range(count):
            p = ring[k]
            if turn == 0:
                nx = slope[p, 0]
                ny = slope[p, 1]
                nz = slope[p, 2]
                away = nx * (place[p, 0] - at[0]) + ny * (place[p, 1] - at[1]) + nz * (place[p, 2] - at[2])
                length = nx * nx + ny * ny + nz * nz
            else:
                dx = near * (place[p, 0] - at[0])
                dy = near * (place[p, 1] - at[1])
                dz = near * (place[p, 2] - at[2])
                f, nx, ny, nz = gradient(code, constants, parts, scratch, at[0] + dx, at[1] + dy, at[2] + dz)
                length = (nx * nx + ny * ny + nz * nz) ** 0.5
                if not 0.0 < length < 1.0e300 or not abs(f) < 1.0e300:
                    continue
                nx /= length
                ny /= length
                nz /= length
                away = nx * dx + ny * dy + nz * dz - f / length
            if length > 0.0:
                add_plane(normal, right, nx, ny, nz, away)
                planes += 1
                square += away * away
        if planes == 0:
            return rank
        rank = held(normal, right, square, box, h, a, v, step, best)
        for i in range(3):
            at[i] += best[i]
    return rank


@lean(
    f"void({TAPE}, float64[::1], int32[:, ::1], int64, int64, int32[:, ::1], int64[::1], int64[::1], int64[::1],"
    " int16[::1], int32[:, ::1], int32[::1], int32[:, :, ::1], int32[::1], float64[:, ::1], float64[:, ::1],"
    " float64[:, ::1], float64[:, ::1], float64[:, ::1], int32[:, ::1], int32[:, ::1], int8[::1])"
)
def dual(
    code, constants, parts, scratch, grid, blocks, first, last, beyond, begin, cube_at, dual_at,
    keys, cubes, config, curves, local, room, place, normal, out, unit, rings, corners, outward,
):  # fmt: skip
    """Vertices ``out`` of the curves of blocks first..last-1, and their normals ``unit`` where the surface is smooth.

    Those of block b begin at dual_at[b]. ``rings`` (n, 12) are the crossed edges along each curve, -1 after the last;
    ``corners`` (edges, 4) the vertices around each crossed edge, and ``outward`` whether the surface there faces along
    its axis.
    """
    h = grid[3]
    low = room[14]
    for b in range(first, last):
        for v in range(begin[b], begin[b + 1]):
            local[keys[v]] = v
        fresh = dual_at[b]
        for n in range(cube_at[b], cube_at[b + 1]):
            cube = cubes[n, 0]
            variant = cubes[n, 1]
            x = cube % BLOCK
            y = cube // BLOCK % BLOCK
            z = cube // (BLOCK * BLOCK)
            low[0] = grid[0] + (blocks[b, 0] * BLOCK + x) * h
            low[1] = grid[1] + (blocks[b, 1] * BLOCK + y) * h
            low[2] = grid[2] + (blocks[b, 2] * BLOCK + z) * h
            for curve in range(4):
                if curves[variant, curve, 0] < 0:
                    break
                at = out[fresh]
                at[0] = at[1] = at[2] = 0.0
                count = 0
                for k in range(12):
                    edge = curves[variant, curve, k]
                    rings[fresh, k] = -1
                    if edge < 0:
                        continue
                    v = vertex(edge, x, y, z, b, beyond, begin, keys, local)
                    rings[fresh, k] = v
                    corners[v, edge & 3] = fresh
                    if edge & 3 == 0:
                        # Corner 0 is the edge's lower end, which lies at 0 of both other axes.
                        outward[v] = config[variant] & 1
                    count += 1
                    for axis in range(3):
                        at[axis] += place[v, axis]
                for axis in range(3):
                    at[axis] /= count
                rank = settle(code, constants, parts, scratch, place, normal, rings[fresh], count, low, h, at, room)
                length = 0.0
                if rank == 1:
                    _, gx, gy, gz = gradient(code, constants, parts, scratch, at[0], at[1], at[2])
                    length = (gx * gx + gy * gy + gz * gz) ** 0.5
                smooth = 0.0 < length and length < 1.0e300
                unit[fresh, 0] = gx / length if smooth else 0.0
                unit[fresh, 1] = gy / length if smooth else 0.0
                unit[fresh, 2] = gz / length if smooth else 0.0
                fresh += 1
