# mypy: ignore-errors
"""Blocks of cells that the surface may meet: boxes are halved until they are proved inside or outside."""

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.tape_ops import NOWHERE, TAPE, WHOLE
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.cubes.sign_kernels import one_sign

REACH = 4
"""Blocks along a side of the boxes that are tested first."""
CLEAR, CUT, BROKEN = range(3)
"""Of a box: proved without surface; perhaps with surface; the same, with the tape perhaps undefined in it."""


@inlined
def verdict(code, constants, parts, scratch, grid, i, j, k, cells):
    """CLEAR, CUT or BROKEN for the box of ``cells`` cells a side from node (i, j, k) on."""
    h = grid[3]
    low, high, status = box(
        code,
        constants,
        parts,
        scratch,
        grid[0] + i * h,
        grid[0] + (i + cells) * h,
        grid[1] + j * h,
        grid[1] + (j + cells) * h,
        grid[2] + k * h,
        grid[2] + (k + cells) * h,
    )
    if status == NOWHERE or low >= 0.0 or (status == WHOLE and high < 0.0):
        return CLEAR
    return CUT if status == WHOLE else BROKEN


@lean(
    f"int64({TAPE}, int32[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1],"
    " int64[::1], int64, int32[:, ::1])"
)
def cull(
    code, constants, parts, scratch, short, near, second, registers, points, grid, counts, layer, found
):  # fmt: skip
    """Write the blocks (x, y, z) of a layer of REACH blocks that the surface may meet to ``found``; how many.

    ``grid`` holds the first node and the cell [m], ``counts`` the blocks along each axis; ``short`` and ``near`` are
    room for a simplified tape, ``second`` to ``points`` working memory.
    """
    n = 0
    z = layer * REACH
    for y in range(0, counts[1], REACH):
        for x in range(0, counts[0], REACH):
            at = verdict(code, constants, parts, scratch, grid, x * BLOCK, y * BLOCK, z * BLOCK, REACH * BLOCK)
            if at == CLEAR:
                continue
            rows, used = simplify(code, parts, scratch, at == CUT, short, near)
            code2 = short[:rows]
            parts2 = near[:used]
            for half in range(8):
                hx = x + 2 * (half & 1)
                hy = y + 2 * (half >> 1 & 1)
                hz = z + 2 * (half >> 2)
                if hx >= counts[0] or hy >= counts[1] or hz >= counts[2]:
                    continue
                if (
                    verdict(code2, constants, parts2, scratch, grid, hx * BLOCK, hy * BLOCK, hz * BLOCK, 2 * BLOCK)
                    == CLEAR
                ):
                    continue
                for one in range(8):
                    bx = hx + (one & 1)
                    by = hy + (one >> 1 & 1)
                    bz = hz + (one >> 2)
                    if bx >= counts[0] or by >= counts[1] or bz >= counts[2]:
                        continue
                    i, j, k = bx * BLOCK, by * BLOCK, bz * BLOCK
                    at = verdict(code2, constants, parts2, scratch, grid, i, j, k, BLOCK)
                    clear = at == CLEAR
                    if at == CUT:
                        u, v, w = grid[0] + i * grid[3], grid[1] + j * grid[3], grid[2] + k * grid[3]
                        clear = one_sign(
                            code2, constants, parts2, scratch, second, registers, points, u, v, w, BLOCK * grid[3]
                        )
                    if clear:
                        continue
                    found[n, 0] = bx
                    found[n, 1] = by
                    found[n, 2] = bz
                    n += 1
    return n
