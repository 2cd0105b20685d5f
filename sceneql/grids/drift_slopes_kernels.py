# mypy: ignore-errors
"""The derivatives of advection by a flow."""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.grids import drift_kernels as term
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def bends(kind, behind, ahead):
    """The derivatives of drift_kernels.half_slope by its two differences."""
    if behind * ahead <= 0.0 or kind == term.UPWIND:
        return 0.0, 0.0
    if kind == term.VAN_LEER:
        share = behind / (behind + ahead)
        return (1.0 - share) * (1.0 - share), share * share
    a, b = abs(behind), abs(ahead)
    size = min(a, (2.0 * b + a) / 6.0, b)
    if size == a:
        return 1.0, 0.0
    return (0.0, 1.0) if size == b else (1.0 / 6.0, 1.0 / 3.0)


@lean_inlined
def add(y, entries, floats, ints, limited):
    """Add the slopes of `carry`; not ``limited``: of the scheme without a limiter."""
    at, nx, ny, nz = ints[term.AT], ints[term.NX], ints[term.NY], ints[term.NZ]
    divisors, volumes, kind = ints[term.DIVISORS], ints[term.VOLUMES], ints[term.LIMITER]
    strength = floats[ints[term.STRENGTH]]
    n = nx * ny * nz
    c = y[at : at + n]
    leaving = ints[term.LEAVING] if strength >= 0.0 else ints[term.LEAVING_BACK]
    for cell in range(n):
        entries[cell] -= abs(strength) * floats[leaving + cell] / floats[divisors + cell]
    first = n
    for axis in range(3 if nz > 1 else 2):
        flows, periodic = ints[term.FLOWS + axis], ints[term.PERIODIC + axis] == 1
        count = nx if axis == 0 else (ny if axis == 1 else nz)
        stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
        for cell in range(n):
            flow = strength * floats[flows + cell]
            if flow == 0.0:
                continue
            i, j, k = cell % nx, cell // nx % ny, cell // (nx * ny)
            place = i if axis == 0 else (j if axis == 1 else k)
            before = cell - stride if place > 0 else cell + (count - 1) * stride
            if flow > 0.0:
                up, down, up_column, down_column, behind_column = before, cell, 1, 2, 0
                behind = term.beyond(before, place - 1 if place > 0 else count - 1, count, stride, -1, periodic,
                                     floats, volumes)  # fmt: skip
            else:
                up, down, up_column, down_column, behind_column = cell, before, 2, 1, 3
                behind = term.beyond(cell, place, count, stride, 1, periodic, floats, volumes)
            by_behind = by_ahead = 0.0
            if limited and behind >= 0:
                by_behind, by_ahead = bends(kind, c[up] - c[behind], c[down] - c[up])
            for row in range(2):
                weight = -flow / floats[divisors + before] if row == 0 else flow / floats[divisors + cell]
                place = first + 4 * row * n + cell
                entries[place + up_column * n] += weight * (1.0 + by_behind - by_ahead)
                entries[place + down_column * n] += weight * by_ahead
                entries[place + behind_column * n] -= weight * by_behind
        first += 8 * n


@lean(TERM, inner=True)
def carry(t, y, entries, floats, ints):
    """Slopes of drift_kernels.carry: a cell's own entries, then for every axis eight for each face.

    These are the rows of the cell before the face and the one behind it, each with the columns from one cell before
    those two to one after.
    """
    add(y, entries, floats, ints, True)
