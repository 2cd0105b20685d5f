# mypy: ignore-errors
"""Occupancy cells of an implicit object's box: proved empty, proved full, or neither; filled as rays come to them."""

from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import SCENE, SCRATCH, part
from renderers.tracing.solids.ranges_kernels import cells_at, is_sheet, tape_of
from sceneql.compiled.kernels import kernel
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.tape_ops import NOWHERE, WHOLE

PAD = 1e-7
"""Enlargement of a cell, relative to its side, against rounding in the walk."""
BLOCK = 4
"""Cells along a side of the coarse blocks that are tested before their cells."""


@part
def bounds(scene, scratch, k, first, i, j, l, side):
    """(low, high, status) of a tape of implicit object k in the cells (i..i+side, ...)."""
    b = scene.reals
    code, constants, parts = tape_of(scene, k, first)
    h = ((b[k + 3] - b[k]) / layout.CELLS, (b[k + 4] - b[k + 1]) / layout.CELLS, (b[k + 5] - b[k + 2]) / layout.CELLS)
    return box(
        code,
        constants,
        parts,
        scratch,
        b[k] + (i - PAD) * h[0],
        b[k] + (i + side + PAD) * h[0],
        b[k + 1] + (j - PAD) * h[1],
        b[k + 1] + (j + side + PAD) * h[1],
        b[k + 2] + (l - PAD) * h[2],
        b[k + 2] + (l + side + PAD) * h[2],
    )


@part
def region(scene, scratch, k, i, j, l, side):
    """EMPTY, FULL or MIXED for the cells (i..i+side, ...) of implicit object k."""
    low, high, status = bounds(scene, scratch, k, 0, i, j, l, side)
    if status == NOWHERE or low > 0.0:
        return layout.EMPTY
    if is_sheet(scene, k):
        apart = high < 0.0 or bounds(scene, scratch, k, layout.WITHIN, i, j, l, side)[0] > 0.0
        return layout.EMPTY if apart else layout.MIXED
    return layout.FULL if status == WHOLE and high < 0.0 else layout.MIXED


@kernel(types.int64(SCENE, SCRATCH, *(types.int64,) * 4), _nrt=False, inner=True)
def occupy(scene, scratch, k, i, j, l):
    """What cell (i, j, l) of implicit object k is; fills its block: a coarse one is tested first, then its cells.

    Threads may fill a block at once: they write the same.
    """
    base = cells_at(scene, k)
    bi, bj, bl = i // BLOCK * BLOCK, j // BLOCK * BLOCK, l // BLOCK * BLOCK
    coarse = region(scene, scratch, k, bi, bj, bl, BLOCK)
    for ci in range(bi, bi + BLOCK):
        for cj in range(bj, bj + BLOCK):
            for cl in range(bl, bl + BLOCK):
                found = coarse
                if coarse == layout.MIXED:
                    found = region(scene, scratch, k, ci, cj, cl, 1)
                scene.ints[base + (ci * layout.CELLS + cj) * layout.CELLS + cl] = found
    return int(scene.ints[base + (i * layout.CELLS + j) * layout.CELLS + l])
