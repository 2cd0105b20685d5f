# mypy: ignore-errors
"""Solids that move through a flow: its cells are cut anew at each instant at which its rate is asked for.

What walls push through the open faces of each cell is the sum of the solid's velocities over these (by Gauss's theorem,
as that of a rigid motion over whole cells is 0), so all of it together is 0 in a closed box. Its rate is that of the
walls' acceleration, less what faces that open let through besides, so that the pressure is that of walls on their way.
After each step faces that fluid has come to have a velocity, and all lose the divergence that is left.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout as surfaces
from sceneql.contacts.shape_kernels import acceleration
from sceneql.flows import layout
from sceneql.flows.advection_kernels import sides
from sceneql.flows.obstacles import moving_layout as own
from sceneql.flows.obstacles.cut_kernels import cut, nearest, place, reach, side, wall_velocity
from sceneql.flows.obstacles.moving_skin_kernels import opened_wall, scales, tie
from sceneql.flows.obstacles.no_slip_numbers import BESIDE, LEAST, UNEVEN
from sceneql.flows.obstacles.open_faces_kernels import open_faces, passed_over
from sceneql.flows.projection_kernels import first_face, project
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, I, N


@lean(types.void(A, A, I, N), inner=True)
def fill(y, floats, ints, component):
    """Velocities where solids have come, theirs, and where fluid has: that of the wall and the part of the next face's
    beyond it that its distance from the wall is of that face's."""
    flow = ints[ints[own.FLOW] :]
    axes, start, at = flow[layout.AXES], flow[layout.STARTS + component], flow[layout.AT]
    nx, ny, nz = sides(component, flow)
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                f = start + i + nx * (j + ny * k)
                if floats[ints[own.PARTS] + f] == 0.0:
                    number = int(floats[flow[layout.OWNERS] + f])
                    x, y_, z = place(floats, ints, axes, component, i, j, k)
                    u, v, w = wall_velocity(floats, ints, number, x, y_, z)
                    y[at + f] = side(u, v, w, component)
                if floats[ints[own.PARTS] + f] == 0.0 or floats[ints[own.SHUT] + f] == 0.0:
                    continue
                wall = opened_wall(f, floats, ints, component)
                y[at + f] = wall
                best = 0.0
                for axis in range(axes):
                    slope = floats[ints[own.NORMALS + axis] + f]
                    stride, count = (1 if axis == 0 else (nx if axis == 1 else nx * ny)), side(nx, ny, nz, axis)
                    here = side(i, j, k, axis)
                    if here == (0 if slope < 0.0 else count - 1) and flow[layout.PERIODIC + axis] == 0:
                        continue  # the box ends there
                    if slope < 0.0:
                        other = f - stride if here > 0 else f + (count - 1) * stride
                    else:
                        other = f + stride if here < count - 1 else f - (count - 1) * stride
                    known = floats[ints[own.PARTS] + other] > 0.0 and floats[ints[own.SHUT] + other] == 0.0
                    if known and abs(slope) > best:
                        best = abs(slope)
                        ratio = min(floats[ints[own.DEPTHS] + f] / floats[ints[own.DEPTHS] + other], 1.0)
                        y[at + f] = wall + ratio * (y[at + other] - opened_wall(other, floats, ints, component))


@lean(types.void(A, I), inner=True)
def open_cells(floats, ints):
    """What is open of cells, and their nearest solids."""
    flow = ints[ints[own.FLOW] :]
    axes = flow[layout.AXES]
    nx, ny, nz = flow[layout.CELLS], flow[layout.CELLS + 1], flow[layout.CELLS + 2]
    dx = floats[ints[own.NUMBERS] + own.SPACING]
    d, a, b, c, number = 0.0, 0.0, 0.0, 0.0, 0
    for k in range(nz):
        for j in range(ny):
            last = -1
            for i in range(nx):
                cell = i + nx * (j + ny * k)
                x, y, z = place(floats, ints, axes, 3, i, j, k)
                if i > last:
                    d, a, b, c, number = nearest(floats, ints, axes, x, y, z)
                    last = i + passed_over(floats, ints, axes, d, x, y, z)
                else:
                    d -= dx
                part = 1.0 if d > 0.0 else 0.0
                if abs(d) <= reach(floats, ints, axes, 3, a, b, c):
                    part = cut(floats, ints, axes, 3, x, y, z)[0]
                floats[ints[own.CELL_PARTS] + cell] = part
                floats[flow[layout.OWNERS] + flow[layout.FACES] + cell] = number


@lean_inlined
def pushing(floats, ints, number, x, y, z):
    """Velocity of a solid's motion, drawn on to a point, and its rate there [m/s^2]: of one place, not of one point of
    the solid."""
    u, v, w = wall_velocity(floats, ints, number, x, y, z)
    at = own.HEAD + surfaces.OBJECT * number
    a, b, c = acceleration(floats, ints, at, x, y, z)
    p, q, r = wall_velocity(floats, ints, number, x + u, y + v, z + w)  # it is linear in the place
    return u, v, w, a - (p - u), b - (q - v), c - (r - w)


@lean(types.boolean(A, I), inner=True)
def push(floats, ints):
    """Write what walls push through the open faces of cells, and its rate; whether a closed box has room for it."""
    flow = ints[ints[own.FLOW] :]
    nx, ny, nz, axes = flow[layout.CELLS], flow[layout.CELLS + 1], flow[layout.CELLS + 2], flow[layout.AXES]
    n = nx * ny * nz
    out, rate = floats[flow[layout.SEEPING] :], floats[ints[own.RATES] :]
    areas, parts = floats[flow[layout.AREAS] :], floats[ints[own.PARTS] :]
    total = size = change = changes = 0.0
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                cell = i + nx * (j + ny * k)
                out[cell] = rate[cell] = floats[ints[own.WHOLE] + cell] = 0.0
                number = int(floats[flow[layout.OWNERS] + flow[layout.FACES] + cell])
                uncut, alive = True, False
                for axis in range(axes):
                    low, up = first_face(axis, j, k, flow)
                    if axis == 0 and flow[layout.PERIODIC] == 1 and i == nx - 1:
                        up = 1 - nx
                    uncut = uncut and parts[low + i] == 1.0 and parts[low + i + up] == 1.0
                    alive = alive or areas[low + i] > 0.0 or areas[low + i + up] > 0.0
                if not alive:
                    continue
                floats[ints[own.WHOLE] + cell] = max(floats[ints[own.CELL_PARTS] + cell], LEAST)
                if uncut:
                    continue
                for axis in range(axes):
                    low, up = first_face(axis, j, k, flow)
                    if axis == 0 and flow[layout.PERIODIC] == 1 and i == nx - 1:
                        up = 1 - nx
                    for high in range(2):
                        f = low + i + (up if high == 1 else 0)
                        x, y, z = (
                            floats[ints[own.CENTERS] + f],
                            floats[ints[own.CENTERS + 1] + f],
                            floats[ints[own.CENTERS + 2] + f],
                        )
                        if high == 1 and f < low + i:  # the face of the other side, one box on
                            whole = floats[ints[own.NUMBERS] + own.SPACING + axis] * flow[layout.CELLS + axis]
                            x, y, z = (
                                x + (whole if axis == 0 else 0.0),
                                y + (whole if axis == 1 else 0.0),
                                z + (whole if axis == 2 else 0.0),
                            )
                        u, v, w, a, b, c = pushing(floats, ints, number, x, y, z)
                        area = areas[f] if high == 1 else -areas[f]
                        out[cell] += area * side(u, v, w, axis)
                        rate[cell] += area * side(a, b, c, axis)
                total, size = total + out[cell], size + abs(out[cell])
                change, changes = change + rate[cell], changes + abs(rate[cell])
    if flow[layout.SINGULAR] == 0:
        return True
    out[2 * n] = total / size if size > 0.0 else 0.0
    for cell in range(n):
        out[cell] -= abs(out[cell]) * total / size if size > 0.0 else 0.0
        rate[cell] -= abs(rate[cell]) * change / changes if changes > 0.0 else 0.0
    return abs(total) <= UNEVEN * size


@lean(types.void(A, I, N), inner=True)
def weigh(floats, ints, component):
    """Write inertia, friction and what pushes of a component's faces, whose ties are known."""
    flow = ints[ints[own.FLOW] :]
    axes, start = flow[layout.AXES], flow[layout.STARTS + component]
    nx, ny, nz = sides(component, flow)
    count, periodic = flow[layout.CELLS + component], flow[layout.PERIODIC + component] == 1
    fastest = floats[ints[own.NUMBERS] + own.FASTEST]
    out = floats[flow[layout.SEEPING] :]
    mx, my = flow[layout.CELLS], flow[layout.CELLS + 1]
    step = 1 if component == 0 else (mx if component == 1 else mx * my)
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                f = start + i + nx * (j + ny * k)
                part, whole = floats[ints[own.PARTS] + f], floats[ints[own.VOLUMES] + f]
                given = floats[ints[own.GIVEN] + f] != 0.0 or floats[flow[layout.AREAS] + f] == 0.0
                row = floats[flow[layout.FRICTION] + f]
                if row != 0.0 or floats[ints[own.SCALES] + f] != 1.0:
                    for axis in range(axes):
                        stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
                        at, most = side(i, j, k, axis), side(nx, ny, nz, axis)
                        other = f + stride if at < most - 1 else f - (most - 1) * stride
                        ties = floats[flow[layout.VISCOUS + axis] :]
                        row += 2.0 * (ties[f] + ties[other])
                else:
                    row = 0.0
                full = whole * part
                volume = max(full, LEAST * whole, row / fastest if fastest > 0.0 else 0.0)
                fill = full / volume
                here = side(i, j, k, component)
                cell = i + mx * (j + my * k)
                pushed = 0.5 * out[cell] if here < count else 0.0
                if here > 0 or periodic:
                    pushed += 0.5 * out[cell - step if here > 0 else cell + (count - 1) * step]
                gain = floats[flow[layout.GAINS] + f] / volume
                if pushed != 0.0 and not given:
                    gain += pushed * opened_wall(f, floats, ints, component) / volume
                base = floats[ints[own.OUTSIDE] + f] * fill + gain
                floats[flow[layout.PUSHES] + f] = base
                if ints[own.BASE] >= 0:
                    floats[ints[own.BASE] + f] = base
                    floats[ints[own.WEIGHTS] + f] = fill / floats[ints[own.NUMBERS] + own.DENSITY]
                floats[flow[layout.FILLS] + f] = fill
                if given:
                    floats[flow[layout.FRICTION] + f] = 0.0
                inverse = 0.0 if given else 1.0 / volume
                floats[flow[layout.INVERSES] + f] = inverse
                floats[flow[layout.SCALES] + f] = floats[flow[layout.AREAS] + f] * inverse
                floats[ints[own.SOLVED] + f] = 0.0 if given else volume
                floats[ints[own.SINKS] + f] = floats[flow[layout.FRICTION] + f]


@lean(types.void(A, I), inner=True)
def beside_sides(floats, ints):
    """Write the ties to the edges of the box."""
    flow = ints[ints[own.FLOW] :]
    spacing = ints[own.NUMBERS] + own.SPACING
    axes = flow[layout.AXES]
    least = BESIDE * min(floats[spacing], floats[spacing + 1], floats[spacing + 2] if axes == 3 else floats[spacing])
    for e in range(flow[layout.EDGES]):
        f = flow[layout.EDGE_FACES + e]
        beside = floats[ints[own.PARTS] + f] > 0.0 and floats[ints[own.LEVELS] + f] <= least
        scale = 0.0 if beside else floats[ints[own.SCALES] + f]
        weight = floats[ints[own.EDGE_WEIGHTS] + e] * scale * scale
        floats[flow[layout.EDGE_WEIGHTS] + e] = weight
        floats[ints[own.SINKS] + f] += weight


@lean(types.void(A, I), inner=True)
def tie_pressure(floats, ints):
    """Write the coefficients of the pressure's equation."""
    flow = ints[ints[own.FLOW] :]
    nx, ny, nz, axes = flow[layout.CELLS], flow[layout.CELLS + 1], flow[layout.CELLS + 2], flow[layout.AXES]
    n = nx * ny * nz
    areas, factors = floats[flow[layout.AREAS] :], floats[flow[layout.SCALES] :]
    sink, cuts = floats[flow[layout.SINK] :], floats[flow[layout.CUT] :]
    usual = floats[ints[own.NUMBERS] + own.ENTRY]
    for cell in range(n):
        sink[cell] = 0.0
        cuts[cell] = 0.0
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                cell = i + nx * (j + ny * k)
                alive = False
                for axis in range(axes):
                    low, up = first_face(axis, j, k, flow)
                    if axis == 0 and flow[layout.PERIODIC] == 1 and i == nx - 1:
                        up = 1 - nx
                    ends = flow[layout.PERIODIC + axis] == 0
                    at, most = side(i, j, k, axis), flow[layout.CELLS + axis]
                    f, g = low + i, low + i + up
                    one, two = areas[f] * factors[f], areas[g] * factors[g]
                    alive = alive or areas[f] > 0.0 or areas[g] > 0.0
                    if ends and at == 0:
                        sink[cell] += one
                    if ends and at == most - 1:
                        sink[cell] += two
                    floats[flow[layout.CONDUCTANCES + axis] + cell] = 0.0 if ends and at == 0 else one
                    cuts[cell] += one + two
                if not alive:
                    sink[cell] = -1.0
    most = 0.0
    for cell in range(n):
        most = max(most, cuts[cell])
    for cell in range(n):
        entry = cuts[cell]
        cut_ = sink[cell] >= 0.0 and entry > 0.0 and abs(entry - usual) > 1e-9 * most
        cuts[cell] = 0.5 / entry if cut_ else 0.0
        if ints[own.HELD] >= 0:
            floats[ints[own.HELD] + cell] = 1.0 if sink[cell] < 0.0 else sink[cell]


@lean(types.boolean(A, I))
def cut_anew(floats, ints):
    """Cut all cells and faces by the solids where they are; whether a closed box has room for what they push."""
    flow = ints[ints[own.FLOW] :]
    for component in range(flow[layout.AXES]):
        open_faces(floats, ints, component)
    open_cells(floats, ints)
    room = push(floats, ints)
    for component in range(flow[layout.AXES]):
        scales(floats, ints, component)
        tie(floats, ints, component)
        weigh(floats, ints, component)
    beside_sides(floats, ints)
    tie_pressure(floats, ints)
    return room


@lean(types.void(A, A, I))
def settle(y, floats, ints):
    """Give velocities to faces that solids or fluid have come to since this was last called."""
    flow = ints[ints[own.FLOW] :]
    for component in range(flow[layout.AXES]):
        fill(y, floats, ints, component)
    for f in range(flow[layout.FACES]):
        floats[ints[own.SHUT] + f] = 1.0 if floats[ints[own.PARTS] + f] == 0.0 else 0.0


@lean(TERM, inner=True)
def go(t, y, rate, floats, ints):
    """Solids are where they are now; and write what faces that open let through, beside what walls push."""
    cut_anew(floats, ints)
    flow = ints[ints[own.FLOW] :]
    nx, ny, nz, axes = flow[layout.CELLS], flow[layout.CELLS + 1], flow[layout.CELLS + 2], flow[layout.AXES]
    at = flow[layout.AT]
    moved = floats[flow[layout.SEEPING] + nx * ny * nz :]
    for cell in range(nx * ny * nz):
        moved[cell] = floats[ints[own.RATES] + cell]
    for axis in range(axes):
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    cell = i + nx * (j + ny * k)
                    low, up = first_face(axis, j, k, flow)
                    if axis == 0 and flow[layout.PERIODIC] == 1 and i == nx - 1:
                        up = 1 - nx
                    f, g = low + i, low + i + up
                    one, two = floats[ints[own.OPENING] + f], floats[ints[own.OPENING] + g]
                    if one != 0.0:
                        moved[cell] += one * (y[at + f] - opened_wall(f, floats, ints, axis))
                    if two != 0.0:
                        moved[cell] -= two * (y[at + g] - opened_wall(g, floats, ints, axis))


@lean(AFTER_STEP, inner=True)
def go_on(t0, t1, y0, rate0, y1, floats, ints):
    """Faces that solids or fluid have come to have a velocity, and no divergence is left."""
    flow = ints[ints[own.FLOW] :]
    room = cut_anew(floats, ints)
    settle(y1, floats, ints)
    if not (room and project(y1, layout.VELOCITY, floats, flow)):
        y1[flow[layout.AT]] = math.nan
    return True
