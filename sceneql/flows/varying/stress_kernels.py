# mypy: ignore-errors
"""Viscous stress of a viscosity that varies, mu (grad u + grad u^T): the newtons on each face's own cell.

At centers along an axis, at edges across two (Harlow & Welch 1965); at walls by the distance to them. Of a velocity
free of divergence and one viscosity that is mu lap u, exactly, but in cells that solids cut: there ties to the wall
alone that draw are left (flows/obstacles/no_slip.py has those that make order 2 of one viscosity), order 1.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.advection_kernels import sides
from sceneql.flows.varying import fluid_layout as own
from sceneql.system.signatures_kernels import A, I, N

HELD, WITH_WALLS, DRAWS = range(3)


@lean_inlined
def spacing(axis, floats, ints):
    """The side of a cell along an axis [m]."""
    return floats[ints[own.OWN] + 5 + axis]


@lean_inlined
def volume(floats, ints):
    """Of a cell [m^3]."""
    return spacing(0, floats, ints) * spacing(1, floats, ints) * spacing(2, floats, ints)


@lean_inlined
def stride(component, axis, one):
    """From a face to the next one along an axis."""
    mx, my, _ = sides(component, one)
    return 1 if axis == 0 else (mx if axis == 1 else mx * my)


@lean_inlined
def before(place, axis, step, one):
    """From a face to the one before it along an axis, round the box from the first to the last."""
    return (one[flow.CELLS + axis] - 1) * step if place == 0 else -step


@lean_inlined
def between(u, out, ties, low, high, count, draws):
    """What a row of ties [kg/s] does to two rows of faces: pulls them together; or how many newtons it draws."""
    mine, other = out[low : low + count], out[high : high + count]
    if draws:
        for i in range(count):
            mine[i] += ties[i]
        for i in range(count):
            other[i] += ties[i]
    else:
        a, b = u[low : low + count], u[high : high + count]
        for i in range(count):
            ties[i] *= b[i] - a[i]
        for i in range(count):
            mine[i] += ties[i]
        for i in range(count):
            other[i] -= ties[i]


@lean_inlined
def along(axis, u, out, draws, floats, ints):
    """Adds what the stress along an axis does, at centers."""
    one = ints[ints[own.FLOW] :]
    nx, ny, nz = one[flow.CELLS], one[flow.CELLS + 1], one[flow.CELLS + 2]
    mx, my, _ = sides(axis, one)
    h = spacing(axis, floats, ints)
    step, around, last = stride(axis, axis, one), one[flow.PERIODIC + axis] == 1, one[flow.CELLS + axis] - 1
    factor = 2.0 * volume(floats, ints) / (h * h)
    ties = floats[ints[own.LINES] : ints[own.LINES] + nx]
    left = ints[own.LEFT] + (1 + axis) * one[flow.FACES]
    for k in range(nz):
        for j in range(ny):
            thick = floats[ints[own.NORMAL] + nx * (j + ny * k) :]
            low = one[flow.STARTS + axis] + mx * (j + my * k)
            place = j if axis == 1 else k
            high = low - last * step if around and axis > 0 and place == last else low + step
            for i in range(nx):
                ties[i] = factor * thick[i]
            if ints[own.LEFT] >= 0:
                for i in range(nx - 1 if axis == 0 else nx):
                    ties[i] *= floats[left + high + i]
                if axis == 0:
                    ties[last] *= floats[left + (low if around else high + last)]
            count = last if axis == 0 and around else nx
            between(u, out, ties, low, high, count, draws)
            if count < nx:
                between(u, out, ties[last:], low + last, low, 1, draws)


@lean_inlined
def sheared(u, out, f, f0, g, g0, e, count, ha, hb, a, b, draws, floats, ints):
    """What the stress at a row of edges ``e`` does to the faces f and f0 across the axis b, g and g0 across a."""
    nx, faces = ints[ints[own.FLOW] + flow.CELLS], ints[ints[own.FLOW] + flow.FACES]
    pull = floats[ints[own.LINES] : ints[own.LINES] + count]
    push = floats[ints[own.LINES] + nx : ints[own.LINES] + nx + count]
    whole, per_a, per_b = volume(floats, ints), 1.0 / ha, 1.0 / hb
    walled = ints[own.LEFT] >= 0
    thick, own_f, own_g = floats[e : e + count], floats[e : e + count], floats[e : e + count]
    if walled:
        own_f = floats[ints[own.LEFT] + (1 + b) * faces + f :]
        own_g = floats[ints[own.LEFT] + (1 + a) * faces + g :]
    u_f, u_f0, u_g, u_g0 = u[f : f + count], u[f0 : f0 + count], u[g : g + count], u[g0 : g0 + count]
    if draws:
        for i in range(count):
            pull[i] = push[i] = whole * thick[i]
        for i in range(count if walled else 0):
            pull[i] *= own_f[i]
            push[i] *= own_g[i]
    elif walled:
        for i in range(count):
            by_b, by_a = (u_f[i] - u_f0[i]) * per_b, (u_g[i] - u_g0[i]) * per_a
            both = min(own_f[i], own_g[i])  # so that what is dissipated stays above 0
            pull[i] = whole * thick[i] * (own_f[i] * by_b + both * by_a)
            push[i] = whole * thick[i] * (both * by_b + own_g[i] * by_a)
    else:
        for i in range(count):
            pull[i] = whole * thick[i] * ((u_f[i] - u_f0[i]) * per_b + (u_g[i] - u_g0[i]) * per_a)
        for i in range(count):
            push[i] = pull[i]
    more_f, more_g = (per_b * per_b, per_a * per_a) if draws else (-per_b, -per_a)
    less_f, less_g = abs(more_f), abs(more_g)
    add(out[f : f + count], more_f, pull)
    add(out[f0 : f0 + count], less_f, pull)
    add(out[g : g + count], more_g, push)
    add(out[g0 : g0 + count], less_g, push)


@lean_inlined
def add(out, factor, row):
    """Add a row so many times."""
    for i in range(out.size):
        out[i] += factor * row[i]


@lean_inlined
def across(a, b, shear, u, out, draws, floats, ints):
    """Adds what the stress in the plane of two axes does, at edges whose viscosities begin at ``shear``."""
    one = ints[ints[own.FLOW] :]
    nx, ny, nz = one[flow.CELLS], one[flow.CELLS + 1], one[flow.CELLS + 2]
    around_a, around_b = one[flow.PERIODIC + a] == 1, one[flow.PERIODIC + b] == 1
    ha, hb = spacing(a, floats, ints), spacing(b, floats, ints)
    ax, ay, _ = sides(a, one)
    bx, by, _ = sides(b, one)
    ex = nx + (1 if a == 0 and not around_a else 0)
    ey = ny + (1 if (a == 1 and not around_a) or (b == 1 and not around_b) else 0)
    along_b, along_a = stride(a, b, one), stride(b, a, one)
    for k in range(nz):
        for j in range(ny):
            place_b = j if b == 1 else k
            if (place_b == 0 and not around_b) or (a == 1 and j == 0 and not around_a):
                continue
            f = one[flow.STARTS + a] + ax * (j + ay * k)
            g = one[flow.STARTS + b] + bx * (j + by * k)
            f0, e = f + before(place_b, b, along_b, one), shear + ex * (j + ey * k)
            if a == 1:
                g0 = g + before(j, a, along_a, one)
                sheared(u, out, f, f0, g, g0, e, nx, ha, hb, a, b, draws, floats, ints)
                continue
            for part in range(2 if around_a else 1):  # the first one's neighbor is the last one
                i, count = (1, nx - 1) if part == 0 else (0, 1)
                g0 = g + (0 if part == 0 else nx - 1)
                sheared(u, out, f + i, f0 + i, g + i, g0, e + i, count, ha, hb, a, b, draws, floats, ints)


@lean(types.void(A, A, N, A, I))
def stress(u, out, what, floats, ints):
    """By face, from velocities u (WITH_WALLS: and those of walls, else as if they were 0); or DRAWS: how many newtons
    its own velocity takes of each [kg/s]."""
    one = ints[ints[own.FLOW] :]
    for f in range(out.size):
        out[f] = 0.0
    draws = what == DRAWS
    for axis in range(one[flow.AXES]):
        along(axis, u, out, draws, floats, ints)
    for pair in range(3 if one[flow.AXES] == 3 else 1):
        a, b = (0 if pair < 2 else 1), (1 if pair == 0 else 2)
        across(a, b, ints[own.SHEAR] + ints[own.SHEARS + pair], u, out, draws, floats, ints)
    for e in range(one[flow.EDGES]):
        f = one[flow.EDGE_FACES + e]
        tie = floats[ints[own.WALLS] + e] * floats[one[flow.EDGE_WEIGHTS] + e]
        given = floats[one[flow.EDGE_VALUES] + e] if what == WITH_WALLS else 0.0
        out[f] += tie if what == DRAWS else tie * (given - u[f])
    if ints[own.LEFT] >= 0:
        for f in range(out.size):
            drag = floats[ints[own.DRAGS] + f]
            out[f] += drag if what == DRAWS else -drag * u[f]
