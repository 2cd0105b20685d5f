# mypy: ignore-errors
"""What solids that move through a flow do to a field that it carries: volumes of cells and what crosses their faces.

V dc/dt = what flows bring, less c times what leaves beside what comes: c stays 1 where it is 1. As V falls by what the
wall pushes out, what there is stays; what volumes and this differ by in a step all cells share by what they have.
"""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, I

FIELD, INSIDES, VOLUMES, UNCUT, FRACTIONS, PUSHED, LAST, LAST_PUSHED = range(8)
"""The field's first entry in y; by cell: its volumes, 0 and then 1 where nothing is left of it, those of the uncut box,
the open part of each, what walls push through it; volumes, and what walls pushed, when the last step ended."""
TIES, WHOLE, AREAS, AREA = 8, 11, 14, 17
"""Along x, y, z: conductances by cell, those of the uncut box, open areas by face, and the place of an uncut one's."""
CELLS, PERIODIC, AXES = 20, 23, 26


@lean(types.void(A, I), inner=True)
def fit(floats, ints):
    """Volumes and conductances as solids leave them now."""
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    for c in range(nx * ny * nz):
        volume = floats[ints[UNCUT] + c] * floats[ints[FRACTIONS] + c]
        floats[ints[INSIDES] + c] = volume
        floats[ints[VOLUMES] + c] = volume if volume > 0.0 else 1.0
    for axis in range(ints[AXES]):
        sx = nx + (1 if axis == 0 and ints[PERIODIC] == 0 else 0)
        sy = ny + (1 if axis == 1 and ints[PERIODIC + 1] == 0 else 0)
        whole = floats[ints[AREA + axis]]
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    c, f = i + nx * (j + ny * k), i + sx * (j + sy * k)
                    part = floats[ints[AREAS + axis] + f] / whole
                    floats[ints[TIES + axis] + c] = floats[ints[WHOLE + axis] + c] * part


@lean(TERM, inner=True)
def past(t, y, rate, floats, ints):
    """`fit`, at this instant."""
    fit(floats, ints)


@lean(TERM, inner=True)
def keep(t, y, rate, floats, ints):
    """Adds to cells what they would lose by the outflow alone that walls push through them."""
    for c in range(ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2]):
        pushed = floats[ints[PUSHED] + c]
        if pushed != 0.0 and floats[ints[INSIDES] + c] > 0.0:
            rate[ints[FIELD] + c] += pushed * y[ints[FIELD] + c] / floats[ints[INSIDES] + c]


@lean(AFTER_STEP, inner=True)
def go_past(t0, t1, y0, rate0, y1, floats, ints):
    """Cells that come up have the mean of those beside them; what volumes that change have added is taken back. All
    else that there is more of has come in."""
    fit(floats, ints)
    shape, n = ints[CELLS : CELLS + 3], ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2]
    x, volumes, last = y1[ints[FIELD] :], floats[ints[INSIDES] :], floats[ints[LAST] :]
    for c in range(n):
        if volumes[c] == 0.0 or last[c] != 0.0:
            continue
        total = weight = 0.0
        stride = 1
        for axis in range(ints[AXES]):
            place = c // stride % shape[axis]
            for way in range(-1, 2, 2):
                if 0 <= place + way < shape[axis] and last[c + way * stride] > 0.0:
                    total += volumes[c + way * stride] * x[c + way * stride]
                    weight += volumes[c + way * stride]
            stride *= shape[axis]
        x[c] = total / weight if weight > 0.0 else 0.0
    added = whole = more = 0.0
    for c in range(n):
        more += volumes[c] * x[c] - last[c] * y0[ints[FIELD] + c]
        pushed = floats[ints[PUSHED] + c] + floats[ints[LAST_PUSHED] + c]
        added += (volumes[c] - last[c] + 0.5 * (t1 - t0) * pushed) * x[c]
        whole += volumes[c] * abs(x[c])
    y1[ints[FIELD] + n] = y0[ints[FIELD] + n] + more - added  # what has come in
    part = added / whole if whole > 0.0 else 0.0
    for c in range(n):
        x[c] -= part * abs(x[c])
    for c in range(n):
        last[c], floats[ints[LAST_PUSHED] + c] = volumes[c], floats[ints[PUSHED] + c]
    return True
