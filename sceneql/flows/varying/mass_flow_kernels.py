# mypy: ignore-errors
"""Mass and momentum that cross the sides of own cells together, and what else moves several fluids, as terms.

Momentum goes with the mass that carries it, so a light cell gets no more of it than the heavy fluid brings (Raessi &
Pitsch 2012, Comput. Fluids 63, 70-81; Nangia, Griffith, Patankar & Bhalla 2019, J. Comput. Phys. 390, 548-594). What
crosses a side has the density of the half of its cell that it leaves: mass stays above 0 where no more than half a cell
is crossed in a step.
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.advection_kernels import across_row, along_row, sides
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.halves_kernels import layer_of, pairs, row_of
from sceneql.flows.varying.stress_kernels import WITH_WALLS, stress
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def beside(place, on_face, axis, one):
    """The halves below and above the low side along an axis of a cell; beyond an end of the box the last one."""
    middle, count = (2 * place - 1 if on_face else 2 * place), 2 * one[flow.CELLS + axis]
    if one[flow.PERIODIC + axis] == 1:
        return (middle - 1) % count, middle % count
    return min(max(middle - 1, 0), count - 1), min(max(middle, 0), count - 1)


@lean(TERM, inner=True)
def flow_in(t, y, rate, floats, ints):
    """Mass and momentum that come into own cells; where the whole rate is asked for what follows for velocities."""
    mode = floats[ints[own.MODE]]
    if mode == own.FORCES:
        return
    one = ints[ints[own.FLOW] :]
    faces = one[flow.FACES]
    u = y[one[flow.AT] : one[flow.AT] + faces]
    density = floats[ints[own.DENSITY] :]
    wide = 2 * one[flow.CELLS] + 1
    line, below, above = (
        floats[ints[own.LINES] :],
        floats[ints[own.LINES] + wide :],
        floats[ints[own.LINES] + 2 * wide :],
    )
    room = floats[one[flow.WORK] :]
    through = room[:faces]
    momentum = floats[ints[own.MOMENTUM] : ints[own.MOMENTUM] + faces]
    mass = floats[ints[own.MASS] : ints[own.MASS] + faces]
    for f in range(faces):
        through[f] = floats[one[flow.AREAS] + f] * u[f]
        momentum[f] = mass[f] = 0.0
    for component in range(one[flow.AXES]):
        nx, ny, nz = sides(component, one)
        wide = nx + 8
        rows, flux = room[faces : faces + 5 * wide], room[faces + 5 * wide : faces + 6 * wide]
        start, around = one[flow.STARTS + component], one[flow.PERIODIC] == 1
        for k in range(nz):
            for j in range(ny):
                row = start + nx * (j + ny * k)
                along_row(u, through, 1.0, component, j, k, rows, floats, one)
                row_of(density, j, k, component, -1, below, one)
                for i in range(nx + 1):
                    crossing = rows[wide + i]
                    if component == 0 and not around and (i == 0 or i == nx):
                        crossing = through[row] if i == 0 else through[row + nx - 1]
                    if around and i == nx:
                        crossing = rows[wide]
                    low, high = beside(i, component == 0, 0, one)
                    dense = below[low] if crossing > 0.0 else below[high]
                    if i < nx:
                        momentum[row + i] += dense * rows[i]
                        mass[row + i] += dense * crossing
                    if i > 0:
                        momentum[row + i - 1] -= dense * rows[i]
                        mass[row + i - 1] -= dense * crossing
        for axis in range(1, one[flow.AXES]):
            count, stride = (ny if axis == 1 else nz), (nx if axis == 1 else nx * ny)
            periodic = one[flow.PERIODIC + axis] == 1
            for other in range(nz if axis == 1 else ny):
                for place in range(count if periodic else count + 1):
                    j, k = (place, other) if axis == 1 else (other, place)
                    across_row(u, through, 1.0, component, axis, place, j, k, flux, rows, floats, one)
                    base = start + (nx * ny * other if axis == 1 else nx * other)
                    here, before = base + place * stride, base + (place - 1) * stride
                    if periodic and place == 0:
                        before = base + (count - 1) * stride
                    low, high = beside(place, component == axis, axis, one)
                    layer_of(density, j, k, component, axis, low, line, one)
                    pairs(line, component == 0, one, below)
                    layer_of(density, j, k, component, axis, high, line, one)
                    pairs(line, component == 0, one, above)
                    for i in range(nx):
                        crossing = rows[i]
                        if component == axis and not periodic and place == 0:
                            crossing = through[here + i]
                        elif component == axis and place == count:
                            crossing = through[before + i]
                        dense = below[i] if crossing > 0.0 else above[i]
                        if place < count:
                            momentum[here + i] += dense * flux[i]
                            mass[here + i] += dense * crossing
                        if place > 0 or periodic:
                            momentum[before + i] -= dense * flux[i]
                            mass[before + i] -= dense * crossing
    if mode == own.WHOLE:
        for f in range(faces):
            if floats[one[flow.INVERSES] + f] > 0.0:
                rate[one[flow.AT] + f] += (momentum[f] - u[f] * mass[f]) / floats[ints[own.MASSES] + f]


@lean(TERM, inner=True)
def drive(t, y, rate, floats, ints):
    """The pressure outside and given forces, weight beyond that of the flow's own fluid; viscosity in the whole rate.

    The weight of one fluid everywhere would be a pressure and no motion.
    """
    mode = floats[ints[own.MODE]]
    if mode == own.MOTION:
        return
    one = ints[ints[own.FLOW] :]
    at, faces = one[flow.AT], one[flow.FACES]
    density = floats[ints[own.OWN]]
    if mode == own.WHOLE:
        newtons = floats[one[flow.WORK] : one[flow.WORK] + faces]
        stress(y[at : at + faces], newtons, WITH_WALLS, floats, ints)
        for f in range(faces):
            if floats[one[flow.INVERSES] + f] > 0.0:
                rate[at + f] += newtons[f] / floats[ints[own.MASSES] + f]
    for axis in range(one[flow.AXES]):
        mx, my, mz = sides(axis, one)
        weight = floats[ints[own.WEIGHT] + axis]
        start = one[flow.STARTS + axis]
        for f in range(start, start + mx * my * mz):
            inverse = floats[one[flow.INVERSES] + f]
            if inverse > 0.0:
                mass = floats[ints[own.MASSES] + f]
                whole = density / inverse
                moved = floats[one[flow.FILLS] + f] * weight
                rate[at + f] += floats[one[flow.PUSHES] + f] * (whole / mass) + moved * (1.0 - whole / mass)
