# mypy: ignore-errors
"""The forces of strain in a solid of finite elements.

Two passes: each element writes the forces on its own nodes, then each node adds up its own, so that the bytes are the
same for any number of threads. The law is called by its address (law_kernels.py). A retardation adds the stress of
Kelvin and Voigt's solid, F S with S = tau (2 mu E' + lambda tr E'), E' = sym(F^T F'): a rotation has no such rate.
"""

from sceneql.bodies.elements.laws.law_kernels import SCRATCH, stress_at
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, WORK_AT, COUNT, ELEMENTS, NODES, POINTS, MEAN = range(8)
GRADIENTS_AT, WEIGHTS_AT, NUMBERS_AT, NUMBERS, RETARDATION_AT = range(8, 13)
"""Offsets of the gradients of the functions (element, point, node, 3) [1/m], of the points' volumes (element, point)
[m^3], of the law's numbers (element, point, NUMBERS), whose last two are Lame's, of the retardation [s], or -1."""
STRESS, STIFFNESS, ENERGY, FORCES_AT, ROOM_AT, TILES, NODE_TILES, TILE_AT, NODE_TILE_AT, ENTRY, THREADS = range(13, 24)
"""Addresses of the law's kernels; offsets of the forces of elements on nodes (element, node, 3), followed by the power
lost (element,), and of ROOM numbers of scratch for each tile; tiles, their addresses, threads."""
GATHER_AT, PLACES_AT, NODES_AT = 24, 25, 26
"""ints[GATHER_AT]: where the table begins of which forces act on each node: COUNT + 1 starts, then indices of forces.
PLACES_AT: offset of the places of nodes without strain (COUNT, 3) [m]. From NODES_AT on the nodes (element, NODES)."""
MOST_POINTS = 4
F, RATE, P, M, STRAIN, D, POINT = 0, 9, 18, 27, 36, 42, 43
"""In a tile's scratch of each point: F and its rate, the stress, the derivative of d, the rate of strain E', d."""
LAW = POINT * MOST_POINTS
ROOM = LAW + SCRATCH


@lean_inlined
def deformation(y, ints, floats, e, q, out):
    """Write F (9,) = 1 + sum of displacement (gradient of the node's function): without displacements 1 exactly."""
    nodes, at, rest = ints[NODES], ints[POSITION_AT], ints[PLACES_AT]
    first, slopes = NODES_AT + nodes * e, ints[GRADIENTS_AT] + 3 * nodes * (ints[POINTS] * e + q)
    for k in range(9):
        out[k] = 1.0 if k % 4 == 0 else 0.0
    o = 3 * ints[first]
    for n in range(1, nodes):
        here, g = 3 * ints[first + n], slopes + 3 * n
        for i in range(3):
            part = (y[at + here + i] - floats[rest + here + i]) - (y[at + o + i] - floats[rest + o + i])
            out[3 * i] += part * floats[g]
            out[3 * i + 1] += part * floats[g + 1]
            out[3 * i + 2] += part * floats[g + 2]


@lean_inlined
def deformation_rate(y, ints, floats, e, q, out):
    """Write F' (9,), from the velocities."""
    nodes, at = ints[NODES], ints[VELOCITY_AT]
    first, slopes = NODES_AT + nodes * e, ints[GRADIENTS_AT] + 3 * nodes * (ints[POINTS] * e + q)
    for k in range(9):
        out[k] = 0.0
    o = at + 3 * ints[first]
    for n in range(1, nodes):
        here, g = at + 3 * ints[first + n], slopes + 3 * n
        for i in range(3):
            part = y[here + i] - y[o + i]
            out[3 * i] += part * floats[g]
            out[3 * i + 1] += part * floats[g + 1]
            out[3 * i + 2] += part * floats[g + 2]


@lean_inlined
def strain_rate(f, rate, out):
    """Write E' = sym(F^T F'): xx, yy, zz, yz, xz, xy; returns its trace."""
    for k in range(6):
        out[k] = 0.0
    for k in range(0, 9, 3):
        out[0] += f[k] * rate[k]
        out[1] += f[k + 1] * rate[k + 1]
        out[2] += f[k + 2] * rate[k + 2]
        out[3] += 0.5 * (f[k + 1] * rate[k + 2] + f[k + 2] * rate[k + 1])
        out[4] += 0.5 * (f[k] * rate[k + 2] + f[k + 2] * rate[k])
        out[5] += 0.5 * (f[k] * rate[k + 1] + f[k + 1] * rate[k])
    return out[0] + out[1] + out[2]


@lean_inlined
def look(y, floats, ints, e, room):
    """Write F, the law's stress and, where damped, the rates at the points of an element.

    Returns the means of d and of tr E' over it.
    """
    points, numbers = ints[POINTS], ints[NUMBERS]
    stress = stress_at(ints[STRESS])
    volume = dilatation = swelling = 0.0
    for q in range(points):
        at, law = room + POINT * q, ints[NUMBERS_AT] + numbers * (points * e + q)
        f, weight = floats[at : at + 9], floats[ints[WEIGHTS_AT] + points * e + q]
        deformation(y, ints, floats, e, q, f)
        floats[at + D] = stress(
            f,
            floats[law : law + numbers],
            floats[at + P : at + P + 9],
            floats[at + M : at + M + 9],
            floats[room + LAW : room + LAW + SCRATCH],
        )
        volume += weight
        dilatation += weight * floats[at + D]
        if ints[RETARDATION_AT] >= 0:
            rate = floats[at + RATE : at + RATE + 9]
            deformation_rate(y, ints, floats, e, q, rate)
            swelling += weight * strain_rate(f, rate, floats[at + STRAIN : at + STRAIN + 6])
    return dilatation / volume, swelling / volume


@lean_inlined
def add_viscous(f, strain, trace, first, shear, p):
    """Add F S, S = 2 shear E' + first trace, to p (9,); returns the power lost, S : E'."""
    pressure = first * trace
    xx, yy, zz = (
        pressure + 2.0 * shear * strain[0],
        pressure + 2.0 * shear * strain[1],
        pressure + 2.0 * shear * strain[2],
    )
    yz, xz, xy = 2.0 * shear * strain[3], 2.0 * shear * strain[4], 2.0 * shear * strain[5]
    for k in range(0, 9, 3):
        a, b, c = f[k], f[k + 1], f[k + 2]
        p[k] += a * xx + b * xy + c * xz
        p[k + 1] += a * xy + b * yy + c * yz
        p[k + 2] += a * xz + b * yz + c * zz
    direct = xx * strain[0] + yy * strain[1] + zz * strain[2]
    return direct + 2.0 * (yz * strain[3] + xz * strain[4] + xy * strain[5])


@lean(TILE)
def element_tile(number, t, y, rate, floats, ints):
    """The forces of the elements of one tile on their nodes, and the power that each loses."""
    nodes, points, numbers, tiles = ints[NODES], ints[POINTS], ints[NUMBERS], ints[TILES]
    room, damped, mean = ints[ROOM_AT] + ROOM * number, ints[RETARDATION_AT] >= 0, ints[MEAN] == 1
    tau = floats[ints[RETARDATION_AT]] if damped else 0.0
    powers_at = ints[FORCES_AT] + 3 * nodes * ints[ELEMENTS]
    for e in range(ints[ELEMENTS] * number // tiles, ints[ELEMENTS] * (number + 1) // tiles):
        to = ints[FORCES_AT] + 3 * nodes * e
        for k in range(3 * nodes):
            floats[to + k] = 0.0
        dilatation, swelling = look(y, floats, ints, e, room)
        power = 0.0
        for q in range(points):
            at, law = room + POINT * q, ints[NUMBERS_AT] + numbers * (points * e + q)
            weight = floats[ints[WEIGHTS_AT] + points * e + q]
            p = floats[at + P : at + P + 9]
            pressure = floats[law] * (dilatation if mean else floats[at + D])
            for k in range(9):
                p[k] += pressure * floats[at + M + k]
            if damped:
                strain = floats[at + STRAIN : at + STRAIN + 6]
                trace = swelling if mean else strain[0] + strain[1] + strain[2]
                first, shear = tau * floats[law + numbers - 2], tau * floats[law + numbers - 1]
                power += weight * add_viscous(floats[at : at + 9], strain, trace, first, shear, p)
            g = ints[GRADIENTS_AT] + 3 * nodes * (points * e + q)
            for n in range(nodes):
                x, y_, z = weight * floats[g + 3 * n], weight * floats[g + 3 * n + 1], weight * floats[g + 3 * n + 2]
                floats[to + 3 * n] -= p[0] * x + p[1] * y_ + p[2] * z
                floats[to + 3 * n + 1] -= p[3] * x + p[4] * y_ + p[5] * z
                floats[to + 3 * n + 2] -= p[6] * x + p[7] * y_ + p[8] * z
        floats[powers_at + e] = power


@lean(TILE)
def node_tile(number, t, y, rate, floats, ints):
    """Each node of a tile adds up the forces on it."""
    tiles, at, forces = ints[NODE_TILES], ints[GATHER_AT], ints[FORCES_AT]
    parts, to = at + ints[COUNT] + 1, ints[VELOCITY_AT]
    for n in range(ints[COUNT] * number // tiles, ints[COUNT] * (number + 1) // tiles):
        x = y_ = z = 0.0
        for k in range(parts + ints[at + n], parts + ints[at + n + 1]):
            f = forces + 3 * ints[k]
            x += floats[f]
            y_ += floats[f + 1]
            z += floats[f + 2]
        rate[to + 3 * n] += x
        rate[to + 3 * n + 1] += y_
        rate[to + 3 * n + 2] += z


@lean(TERM, inner=True)
def strain(t, y, rate, floats, ints):
    """Adds the forces of strain, and the power lost to the work."""
    entry, threads = ints[ENTRY], ints[THREADS]
    if ints[TILES] == 1:
        element_tile(0, t, y, rate, floats, ints)
    else:
        over_threads(entry, threads, ints[TILE_AT], ints[TILES], t, y, rate, floats, ints)
    if ints[NODE_TILES] == 1:
        node_tile(0, t, y, rate, floats, ints)
    else:
        over_threads(entry, threads, ints[NODE_TILE_AT], ints[NODE_TILES], t, y, rate, floats, ints)
    if ints[RETARDATION_AT] >= 0:
        powers = ints[FORCES_AT] + 3 * ints[NODES] * ints[ELEMENTS]
        for e in range(ints[ELEMENTS]):
            rate[ints[WORK_AT]] += floats[powers + e]
