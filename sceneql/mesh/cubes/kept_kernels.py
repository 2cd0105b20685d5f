# mypy: ignore-errors
"""What was found in some blocks, block by block."""

from sceneql.compiled.kernels import lean


@lean(
    "void(int64[::1], int64[::1], int64[::1], int16[::1], int32[:, ::1], float64[:, ::1], float64[:, ::1], int64[::1],"
    " int64[::1], int16[::1], int32[:, ::1], float64[:, ::1], float64[:, ::1])"
)
def take(
    rows, begin, cube_at, keys, cubes, place, normal, new_begin, new_cube_at, new_keys, new_cubes, new_place, new_normal
):  # fmt: skip
    """Copy the vertices and the cubes of blocks ``rows`` (n,) to where these begin anew, in their order.

    As in grid_extraction.Found; the arrays ``new_...`` are those of the blocks that are taken.
    """
    for n in range(rows.shape[0]):
        off = begin[rows[n]] - new_begin[n]
        for v in range(new_begin[n], new_begin[n + 1]):
            new_keys[v] = keys[v + off]
            for axis in range(3):
                new_place[v, axis] = place[v + off, axis]
                new_normal[v, axis] = normal[v + off, axis]
        off = cube_at[rows[n]] - new_cube_at[n]
        for c in range(new_cube_at[n], new_cube_at[n + 1]):
            new_cubes[c, 0] = cubes[c + off, 0]
            new_cubes[c, 1] = cubes[c + off, 1]
