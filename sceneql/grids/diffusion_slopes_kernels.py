# mypy: ignore-errors
"""The derivatives of the rate of a field on a grid."""

from sceneql.compiled.kernels import lean
from sceneql.grids import diffusion_kernels as term
from sceneql.system.signatures_kernels import TERM

BEND, TIES, REACTION = term.INFLOW + 1, term.INFLOW + 2, term.INFLOW + 5
"""Behind the integers of the term: dD/dc, and area/distance along x, y, z (all 0 where the coefficient does not depend
on the field); d(source)/dc times the volume (0: none)."""


@lean(TERM, inner=True)
def spread(t, y, entries, floats, ints):
    """Slopes of the term `spread`: n diagonal entries, then for every axis entries (cell, before), (before, cell)."""
    at, nx, ny, nz = ints[term.AT], ints[term.NX], ints[term.NY], ints[term.NZ]
    plane = nx * ny
    n = plane * nz
    volume, sink, bend = ints[term.VOLUMES], ints[term.SINK], ints[BEND]
    for c in range(n):
        entries[c] -= floats[sink + c] / floats[volume + c]
        if ints[REACTION] > 0:
            entries[c] += floats[ints[REACTION] + c] / floats[volume + c]
    first = n
    for axis in range(3 if nz > 1 else 2):
        g = ints[term.GX + axis]
        for c in range(n):
            i, j, k = c % nx, c // nx % ny, c // plane
            if axis == 0:
                before = c - 1 if i > 0 else c + nx - 1
            elif axis == 1:
                before = c - nx if j > 0 else c + plane - nx
            else:
                before = c - plane if k > 0 else c + n - plane
            own = other = floats[g + c]
            if bend > 0:
                half = 0.5 * floats[ints[TIES + axis] + c] * (y[at + c] - y[at + before])
                own += half * floats[bend + c]
                other -= half * floats[bend + before]
            entries[c] -= own / floats[volume + c]
            entries[before] -= other / floats[volume + before]
            entries[first + c] += other / floats[volume + c]
            entries[first + n + c] += own / floats[volume + before]
        first += 2 * n
