# mypy: ignore-errors
"""What a flow that is solved does to fields in its box, and they to it, as terms."""

from sceneql.compiled.kernels import lean
from sceneql.flows.layout import AT, AXES, CELLS, FILLS, INVERSES, PERIODIC, STARTS
from sceneql.system.signatures_kernels import TERM

FLOWS, AREAS, BROUGHT, LEAVING, BOUNDARY_AREAS, VALUES, FACES, HEAD = 0, 3, 6, 7, 8, 9, 10, 11
"""Of `through`: flows along x, y, z that are written and areas of the faces of each; what comes in and out a second by
cell, the areas of faces on the boundary, what comes in there has, and their number; then of each its cell, its entry in
y and 1 where it is on the high side, -1 on the low one; then cells along x, y, z, 1 where periodic, first entries in y,
axes."""
LEAKS, SHAPE = 3, 4
"""Of `even_out`, after flows along x, y, z: what leaves cells a second; cells along x, y, z."""
FIELD, INSIDES, EXPANSION, REFERENCE, GRAVITY, FLOW = range(6)
"""Of `lift`: the field's first entry in y, ..., and where the flow's integers begin."""


@lean(TERM, inner=True)
def through(t, y, rate, floats, ints):
    """Write the flows through faces [m^3/s] from the velocities, and what they bring in and take out."""
    m = ints[FACES]
    rest = ints[HEAD + 3 * m :]
    nx, ny, nz = rest[0], rest[1], rest[2]
    for axis in range(rest[9]):
        areas, to = ints[AREAS + axis] - rest[6 + axis], ints[FLOWS + axis]
        sx = nx + (1 if axis == 0 and rest[3] == 0 else 0)
        sy = ny + (1 if axis == 1 and rest[4] == 0 else 0)
        closed = rest[3 + axis] == 0
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    place = i if axis == 0 else (j if axis == 1 else k)
                    face = rest[6 + axis] + i + sx * (j + sy * k)
                    floats[to + i + nx * (j + ny * k)] = (
                        0.0 if closed and place == 0 else floats[areas + face] * y[face]
                    )
    for c in range(nx * ny * nz):
        floats[ints[BROUGHT] + c] = floats[ints[LEAVING] + c] = 0.0
    for b in range(m):
        cell, face, sign = ints[HEAD + b], ints[HEAD + m + b], ints[HEAD + 2 * m + b]
        out = sign * floats[ints[BOUNDARY_AREAS] + b] * y[face]
        if out > 0.0:
            floats[ints[LEAVING] + cell] += out
        else:
            floats[ints[BROUGHT] + cell] -= out * floats[ints[VALUES] + b]


@lean(TERM, inner=True)
def even_out(t, y, rate, floats, ints):
    """Have what flows into a cell at its own skin be what its faces lack, with what the cell has: as a field's skin and
    the flow's are cut each by its own planes, what its faces let through need not be 0 in sum."""
    nx, ny, nz = ints[SHAPE], ints[SHAPE + 1], ints[SHAPE + 2]
    leaving = floats[ints[LEAKS] : ints[LEAKS] + nx * ny * nz]
    for axis in range(3 if nz > 1 else 2):
        flows = floats[ints[axis] : ints[axis] + leaving.size]
        stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
        for c in range(leaving.size):
            if flows[c] != 0.0:
                leaving[c] += flows[c]
                leaving[c - stride] -= flows[c]


@lean(TERM, inner=True)
def lift(t, y, rate, floats, ints):
    """Adds -expansion (field - reference) gravity to the rates of velocities; a face has the mean of both cells."""
    one = ints[FLOW:]
    nx, ny, nz, at = one[CELLS], one[CELLS + 1], one[CELLS + 2], one[AT]
    expansion, reference = floats[ints[EXPANSION]], floats[ints[REFERENCE]]
    field = ints[FIELD]
    for axis in range(one[AXES]):
        factor = -expansion * floats[ints[GRAVITY] + axis]
        if factor == 0.0:
            continue
        periodic = one[PERIODIC + axis] == 1
        sx = nx + (1 if axis == 0 and not periodic else 0)
        sy = ny + (1 if axis == 1 and not periodic else 0)
        sz = nz + (1 if axis == 2 and not periodic else 0)
        count = nx if axis == 0 else (ny if axis == 1 else nz)
        stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
        for k in range(sz):
            for j in range(sy):
                for i in range(sx):
                    face = one[STARTS + axis] + i + sx * (j + sy * k)
                    if floats[one[INVERSES] + face] == 0.0:
                        continue
                    place = i if axis == 0 else (j if axis == 1 else k)
                    cell = field + i + nx * (j + ny * k)
                    if place == count:
                        value = y[cell - stride]
                    elif place > 0:
                        value = 0.5 * (y[cell] + y[cell - stride])
                    else:
                        value = 0.5 * (y[cell] + y[cell + (count - 1) * stride]) if periodic else y[cell]
                    rate[at + face] += factor * (value - reference) * floats[one[FILLS] + face]
