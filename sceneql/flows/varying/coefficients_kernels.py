# mypy: ignore-errors
"""The coefficients of a flow of several fluids, from what each of them fills of halves of cells.

The mass of a face's own cell is exact. Viscosity at centers is the mean, at edges that of 1/viscosity: so a velocity
along a plane between two fluids is exact, where the stress is the same on both sides, and so is one across it.
"""

import math

from sceneql.compiled.kernels import lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.advection_kernels import sides
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.halves_kernels import at_wall, halves, pairs, row_of

NEAR = 1e-11
"""What is filled up to so much is full, or empty: the rest is rounding."""


@lean_inlined
def begin(n, floats, ints):
    """The flow's own fluid everywhere."""
    density, viscosity = floats[ints[own.OWN]], floats[ints[own.OWN] + 1]
    one = ints[ints[own.FLOW] :]
    nx, ny, _ = halves(one)
    cells = one[flow.CELLS] * one[flow.CELLS + 1] * one[flow.CELLS + 2]
    for c in range(n):
        here = viscosity
        if ints[own.BASE] >= 0:
            i, j, k = c % nx, c // nx % ny, c // (nx * ny)
            block = i % 2 + 2 * (j % 2) + 4 * (k % 2)
            cell = i // 2 + one[flow.CELLS] * (j // 2 + one[flow.CELLS + 1] * (k // 2))
            here = max(floats[ints[own.BASE] + block * cells + cell], 0.0)
        floats[ints[own.DENSITY] + c] = density
        floats[ints[own.MEAN] + c] = here
        floats[ints[own.FLUIDITY] + c] = 1.0 / here if here > 0.0 else math.inf


@lean_inlined
def blend(n, density, viscosity, floats, ints):
    """Put a fluid where PART says."""
    for c in range(n):
        part = floats[ints[own.PART] + c]
        if part > 1.0 - NEAR:
            floats[ints[own.DENSITY] + c], floats[ints[own.MEAN] + c] = density, viscosity
            floats[ints[own.FLUIDITY] + c] = 1.0 / viscosity
        elif part > NEAR:
            floats[ints[own.DENSITY] + c] += part * (density - floats[ints[own.DENSITY] + c])
            floats[ints[own.MEAN] + c] += part * (viscosity - floats[ints[own.MEAN] + c])
            floats[ints[own.FLUIDITY] + c] = (1.0 - part) * floats[ints[own.FLUIDITY] + c] + part / viscosity


@lean_inlined
def close(sink, floats, one):
    """Mark the cells that solids leave nothing of: no pressure is solved for there."""
    nx, ny = one[flow.CELLS], one[flow.CELLS + 1]
    for c in range(sink.size):
        open_ = sink[c]
        for axis in range(one[flow.AXES]):
            stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
            last = one[flow.CELLS + axis] - 1
            at_end = c // stride % (last + 1) == last
            ties = one[flow.CONDUCTANCES + axis]
            open_ += floats[ties + c] + (floats[ties + c - last * stride] if at_end else floats[ties + c + stride])
        if open_ == 0.0:
            sink[c] = -1.0


@lean_inlined
def pressure(floats, ints):
    """The gradient's scales, and the equation of the pressure, by the masses of own cells."""
    one = ints[ints[own.FLOW] :]
    density = floats[ints[own.OWN]]
    for f in range(one[flow.FACES]):
        free = floats[one[flow.INVERSES] + f] > 0.0
        area = floats[one[flow.AREAS] + f]
        floats[one[flow.SCALES] + f] = area * density / floats[ints[own.MASSES] + f] if free else 0.0
    nx, ny, nz = one[flow.CELLS], one[flow.CELLS + 1], one[flow.CELLS + 2]
    sink = floats[one[flow.SINK] : one[flow.SINK] + nx * ny * nz]
    for c in range(sink.size):
        sink[c] = 0.0
    for axis in range(one[flow.AXES]):
        mx, my, mz = sides(axis, one)
        around = one[flow.PERIODIC + axis] == 1
        for k in range(mz):
            for j in range(my):
                for i in range(mx):
                    f = one[flow.STARTS + axis] + i + mx * (j + my * k)
                    tie = floats[one[flow.AREAS] + f] * floats[one[flow.SCALES] + f]
                    place = i if axis == 0 else (j if axis == 1 else k)
                    last = one[flow.CELLS + axis]
                    c = i + nx * (j + ny * k)
                    if place == last:
                        sink[c - (1 if axis == 0 else (nx if axis == 1 else nx * ny))] += tie
                    elif place == 0 and not around:
                        sink[c] += tie
                        floats[one[flow.CONDUCTANCES + axis] + c] = 0.0
                    else:
                        floats[one[flow.CONDUCTANCES + axis] + c] = tie
    if ints[own.LEFT] >= 0:
        close(sink, floats, one)
    if ints[own.HELD] >= 0:
        for c in range(sink.size):
            floats[ints[own.HELD] + c] = 1.0 if sink[c] < 0.0 else sink[c]


@lean_inlined
def known(y, floats, ints):
    """Whether the coefficients are those of the places of skins in y; else these places are written down. No weight
    yet: it is added up for every rate."""
    for axis in range(3):
        floats[ints[own.WEIGHT] + axis] = 0.0
    found = ints[own.ANEW] == 0
    for number in range(int(floats[ints[own.TABLE]])):
        row = int(floats[ints[own.TABLE] + 1]) + own.ROW * number
        at, kept = int(floats[row + own.POSITION_AT]), int(floats[row + own.KNOWN_AT])
        for k in range(3 * int(floats[row + own.COUNT])):
            found &= y[at + k] == floats[kept + k]
            floats[kept + k] = y[at + k]
    return found


@lean_inlined
def finish(floats, ints):
    """Masses by face, viscosities at centers and edges, the equation of the pressure."""
    one = ints[ints[own.FLOW] :]
    nx, ny, nz = one[flow.CELLS], one[flow.CELLS + 1], one[flow.CELLS + 2]
    box = ints[own.OWN] + 2
    axes, faces = one[flow.AXES], one[flow.FACES]
    whole = floats[box + 3] * floats[box + 4] * floats[box + 5]
    density, thick, fluid = floats[ints[own.DENSITY] :], floats[ints[own.MEAN] :], floats[ints[own.FLUIDITY] :]
    line, means = floats[ints[own.LINES] :], floats[ints[own.LINES] + 2 * nx :]
    for axis in range(axes):
        mx, my, mz = sides(axis, one)
        walled = one[flow.PERIODIC + axis] == 0
        for k in range(mz):
            for j in range(my):
                place, last = (j, my - 1) if axis == 1 else (k, mz - 1)
                volume = 0.5 * whole if walled and axis > 0 and (place == 0 or place == last) else whole
                row = one[flow.STARTS + axis] + mx * (j + my * k)
                masses = floats[ints[own.MASSES] + row : ints[own.MASSES] + row + mx]
                full = floats[ints[own.MASSES] + faces + row : ints[own.MASSES] + faces + row + mx]
                row_of(density, j, k, axis, -1, line, one)
                pairs(line, axis == 0, one, means)
                for i in range(mx):
                    masses[i] = volume * means[i]
                if axis == 0 and walled:
                    masses[0], masses[mx - 1] = 0.5 * masses[0], 0.5 * masses[mx - 1]
                for i in range(mx):
                    full[i] = masses[i]
                if ints[own.LEFT] >= 0:
                    row_of(fluid, j, k, axis, -1, line, one)
                    pairs(line, axis == 0, one, means)
                    for i in range(mx):
                        masses[i] *= floats[ints[own.LEFT] + row + i]
                        drag = max(floats[one[flow.FRICTION] + row + i], 0.0)
                        floats[ints[own.DRAGS] + row + i] = drag / means[i]
    for k in range(nz):
        for j in range(ny):
            row_of(thick, j, k, -1, -1, line, one)
            pairs(line, False, one, floats[ints[own.NORMAL] + nx * (j + ny * k) :])
    for pair in range(3 if axes == 3 else 1):
        a, b = (0 if pair < 2 else 1), (1 if pair == 0 else 2)
        ey = ny + (1 if (a == 1 or b == 1) and one[flow.PERIODIC + 1] == 0 else 0)
        ez = nz + (1 if b == 2 and one[flow.PERIODIC + 2] == 0 else 0)
        e = ints[own.SHEAR] + ints[own.SHEARS + pair]
        for k in range(ez):
            for j in range(ey):
                row_of(fluid, j, k, a, b, line, one)
                ex = pairs(line, a == 0, one, means)
                for i in range(ex):
                    floats[e + i] = 1.0 / means[i]
                e += ex
    for component in range(axes):
        mx, my, mz = sides(component, one)
        for axis in range(axes):
            for high in range(2):
                e = one[flow.EDGE_FIRST + 6 * component + 2 * axis + high]
                if e < 0:
                    continue
                side = 2 * one[flow.CELLS + axis] - 1 if high == 1 else 0
                place = one[flow.CELLS + axis] - 1 if high == 1 else 0
                e += ints[own.WALLS]
                for k in range(1 if axis == 2 else mz):
                    for j in range(1 if axis == 1 else my):
                        for i in range(1 if axis == 0 else mx):
                            x, y, z = (
                                (place if axis == 0 else i),
                                (place if axis == 1 else j),
                                (place if axis == 2 else k),
                            )
                            floats[e] = 1.0 / at_wall(fluid, x, y, z, component, axis, side, one)
                            e += 1
    if ints[own.UNEQUAL] == 1:
        pressure(floats, ints)
