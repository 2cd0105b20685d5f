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
def left(axis, face, floats, ints):
    """What solids leave of a face's viscous tie along an axis to the one before."""
    if ints[own.LEFT] < 0:
        return 1.0
    faces = ints[ints[own.FLOW] + flow.FACES]
    return floats[ints[own.LEFT] + (1 + axis) * faces + face]


@lean(types.void(A, A, N, A, I))
def stress(u, out, what, floats, ints):
    """By face, from velocities u (WITH_WALLS: and those of walls, else as if they were 0); or DRAWS: how many newtons
    its own velocity takes of each [kg/s]."""
    one = ints[ints[own.FLOW] :]
    nx, ny, nz = one[flow.CELLS], one[flow.CELLS + 1], one[flow.CELLS + 2]
    whole = volume(floats, ints)
    for f in range(out.size):
        out[f] = 0.0
    for axis in range(one[flow.AXES]):
        h = spacing(axis, floats, ints)
        mx, my, _ = sides(axis, one)
        step, around, last = stride(axis, axis, one), one[flow.PERIODIC + axis] == 1, one[flow.CELLS + axis] - 1
        factor = 2.0 * whole / (h * h)
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    place = i if axis == 0 else (j if axis == 1 else k)
                    low = one[flow.STARTS + axis] + i + mx * (j + my * k)
                    high = low - last * step if around and place == last else low + step
                    pull = factor * floats[ints[own.NORMAL] + i + nx * (j + ny * k)] * left(axis, high, floats, ints)
                    if what == DRAWS:
                        out[low] += pull
                        out[high] += pull
                    else:
                        out[low] += pull * (u[high] - u[low])
                        out[high] -= pull * (u[high] - u[low])
    for pair in range(3 if one[flow.AXES] == 3 else 1):
        a, b = (0 if pair < 2 else 1), (1 if pair == 0 else 2)
        around_a, around_b = one[flow.PERIODIC + a] == 1, one[flow.PERIODIC + b] == 1
        ha, hb = spacing(a, floats, ints), spacing(b, floats, ints)
        ax, ay, _ = sides(a, one)
        bx, by, _ = sides(b, one)
        ex = nx + (1 if a == 0 and not around_a else 0)
        ey = ny + (1 if (a == 1 and not around_a) or (b == 1 and not around_b) else 0)
        along_b, along_a = stride(a, b, one), stride(b, a, one)
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    place_a, place_b = (i if a == 0 else j), (j if b == 1 else k)
                    if (place_a == 0 and not around_a) or (place_b == 0 and not around_b):
                        continue
                    f = one[flow.STARTS + a] + i + ax * (j + ay * k)
                    g = one[flow.STARTS + b] + i + bx * (j + by * k)
                    f0, g0 = f + before(place_b, b, along_b, one), g + before(place_a, a, along_a, one)
                    e = ints[own.SHEAR] + ints[own.SHEARS + pair] + i + ex * (j + ey * k)
                    thick = whole * floats[e]
                    own_f, own_g = left(b, f, floats, ints), left(a, g, floats, ints)
                    both = min(own_f, own_g)  # so that what is dissipated stays above 0
                    if what == DRAWS:
                        out[f] += thick * own_f / (hb * hb)
                        out[f0] += thick * own_f / (hb * hb)
                        out[g] += thick * own_g / (ha * ha)
                        out[g0] += thick * own_g / (ha * ha)
                    else:
                        by_b, by_a = (u[f] - u[f0]) / hb, (u[g] - u[g0]) / ha
                        pull, push = thick * (own_f * by_b + both * by_a), thick * (both * by_b + own_g * by_a)
                        out[f] -= pull / hb
                        out[f0] += pull / hb
                        out[g] -= push / ha
                        out[g0] += push / ha
    for e in range(one[flow.EDGES]):
        f = one[flow.EDGE_FACES + e]
        tie = floats[ints[own.WALLS] + e] * floats[one[flow.EDGE_WEIGHTS] + e]
        given = floats[one[flow.EDGE_VALUES] + e] if what == WITH_WALLS else 0.0
        out[f] += tie if what == DRAWS else tie * (given - u[f])
    if ints[own.LEFT] >= 0:
        for f in range(out.size):
            drag = floats[ints[own.DRAGS] + f]
            out[f] += drag if what == DRAWS else -drag * u[f]
