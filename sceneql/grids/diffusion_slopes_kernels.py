# mypy: ignore-errors
"""The derivatives of the rate of a field on a grid."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def spread(t, y, entries, floats, ints):
    """Of diffusion_kernels.spread: n diagonal entries, then of every axis the entries (cell, before), (before, cell).

    ints: those of the term, then the offset of dD/dc and of area/distance along x, y, z (all 0 where the coefficient
    does not depend on the field), and the offset of d(source)/dc times the volume (0: none).
    """
    at, nx, ny, nz = ints[0], ints[1], ints[2], ints[3]
    plane = nx * ny
    n = plane * nz
    volume, sink, bend = ints[4], ints[5], ints[11]
    for c in range(n):
        entries[c] -= floats[sink + c] / floats[volume + c]
        if ints[15] > 0:
            entries[c] += floats[ints[15] + c] / floats[volume + c]
    first = n
    for axis in range(3 if nz > 1 else 2):
        g = ints[7 + axis]
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
                half = 0.5 * floats[ints[12 + axis] + c] * (y[at + c] - y[at + before])
                own += half * floats[bend + c]
                other -= half * floats[bend + before]
            entries[c] -= own / floats[volume + c]
            entries[before] -= other / floats[volume + before]
            entries[first + c] += other / floats[volume + c]
            entries[first + n + c] += own / floats[volume + before]
        first += 2 * n
