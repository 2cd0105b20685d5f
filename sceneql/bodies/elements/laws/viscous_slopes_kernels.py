# mypy: ignore-errors
"""What a retardation adds to the derivatives of the forces of strain: compiled for solids alone that have one."""

from sceneql.bodies.elements.strain_kernels import (
    ELEMENTS,
    MEAN,
    NODES,
    NUMBERS,
    NUMBERS_AT,
    POINT,
    POINTS,
    RATE,
    RETARDATION_AT,
    STRAIN,
    WEIGHTS_AT,
)
from sceneql.bodies.elements.strain_slopes_kernels import (
    HELD_AT,
    OTHER,
    OWN,
    OWN_INTS,
    VISCOUS,
    C,
    add_blocks,
    add_means,
    add_products,
    hold_rows,
    mirror,
)
from sceneql.compiled.kernels import lean, lean_inlined


@lean_inlined
def damped_by_velocity(f, first, shear, own, c):
    """Write the derivative of F S by F': shear (F F^T 1 + F F) + first F F, the last where ``own``."""
    for i in range(3):
        for k in range(3):
            square = f[3 * i] * f[3 * k] + f[3 * i + 1] * f[3 * k + 1] + f[3 * i + 2] * f[3 * k + 2]
            for j in range(3):
                for l in range(3):
                    value = shear * f[3 * i + l] * f[3 * k + j]
                    if j == l:
                        value += shear * square
                    if own:
                        value += first * f[3 * i + j] * f[3 * k + l]
                    c[9 * (3 * i + j) + 3 * k + l] = value


@lean_inlined
def damped_by_place(f, rate, strain, trace, first, shear, own, c):
    """Write the derivative of F S by F: S 1 + shear (F F' + F F'^T 1) + first F F', the last where ``own``."""
    for i in range(3):
        for k in range(3):
            square = f[3 * i] * rate[3 * k] + f[3 * i + 1] * rate[3 * k + 1] + f[3 * i + 2] * rate[3 * k + 2]
            for j in range(3):
                for l in range(3):
                    value = shear * f[3 * i + l] * rate[3 * k + j]
                    if j == l:
                        value += shear * square
                    if own:
                        value += first * f[3 * i + j] * rate[3 * k + l]
                    if i == k:  # the place of the component in strain: xx, yy, zz, yz, xz, xy
                        value += 2.0 * shear * strain[j if j == l else 6 - j - l] + (first * trace if j == l else 0.0)
                    c[9 * (3 * i + j) + 3 * k + l] = value


@lean(VISCOUS, inner=True)
def viscous(e, swelling, definite, room, entries, floats, ints):
    """The blocks of an element by velocities, and what it adds to those by places. ``swelling``: the mean of tr E'."""
    nodes, points, numbers, mean = ints[NODES], ints[POINTS], ints[NUMBERS], ints[MEAN] == 1
    tau, size = floats[ints[RETARDATION_AT]], 9 * nodes * nodes
    to, moving = size * e, size * (ints[ELEMENTS] + e)
    c = floats[room + C : room + C + 81]
    left, right = floats[room + OWN : room + OWN + 3 * nodes], floats[room + OTHER : room + OTHER + 3 * nodes]
    volume = 0.0
    for q in range(points):
        at, law = room + POINT * q, ints[NUMBERS_AT] + numbers * (points * e + q)
        weight, f = floats[ints[WEIGHTS_AT] + points * e + q], floats[at : at + 9]
        first, shear = tau * floats[law + numbers - 2], tau * floats[law + numbers - 1]
        volume += weight
        damped_by_velocity(f, first, shear, not mean, c)
        add_blocks(floats, ints, e, q, weight, room, entries, moving, True)
        if definite == 0:
            strain = floats[at + STRAIN : at + STRAIN + 6]
            trace = swelling if mean else strain[0] + strain[1] + strain[2]
            damped_by_place(f, floats[at + RATE : at + RATE + 9], strain, trace, first, shear, not mean, c)
            add_blocks(floats, ints, e, q, weight, room, entries, to, False)
    mirror(entries, moving, nodes)
    if mean:
        first = tau * floats[ints[NUMBERS_AT] + numbers * points * e + numbers - 2]
        add_means(floats, ints, e, room, left)
        add_products(entries, moving, nodes, first / volume, left, left)
        if definite == 0:
            add_means(floats, ints, e, room + RATE, right)
            add_products(entries, to, nodes, first / volume, left, right)
    hold_rows(ints, ints[ints.size - OWN_INTS + HELD_AT], e, entries, moving)
