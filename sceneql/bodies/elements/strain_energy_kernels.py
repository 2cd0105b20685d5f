# mypy: ignore-errors
"""The energy of strain, and what else of it is told, in a module of its own, since most runs need not compile it."""

from numba import types

from sceneql.bodies.elements.laws.law_kernels import SCRATCH, energy_at
from sceneql.bodies.elements.strain_kernels import (
    ELEMENTS,
    ENERGY,
    LAW,
    MEAN,
    NUMBERS,
    NUMBERS_AT,
    POINT,
    POINTS,
    ROOM_AT,
    WEIGHTS_AT,
    D,
    M,
    P,
    deformation,
    look,
)
from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import ENERGY as ENERGY_OF_TERM
from sceneql.system.signatures_kernels import A, I


@kernel(ENERGY_OF_TERM)
def energy(t, y, floats, ints):
    """Sum over the points of volume (shape energy + bulk d^2 / 2) [J]; of elements with one d of that."""
    points, numbers, room = ints[POINTS], ints[NUMBERS], ints[ROOM_AT]
    law_energy = energy_at(ints[ENERGY])
    total = 0.0
    out = floats[room + P : room + P + 2]
    for e in range(ints[ELEMENTS]):
        volume = dilatation = squared = 0.0
        for q in range(points):
            law, weight = ints[NUMBERS_AT] + numbers * (points * e + q), floats[ints[WEIGHTS_AT] + points * e + q]
            f = floats[room : room + 9]
            deformation(y, ints, floats, e, q, f)
            law_energy(f, floats[law : law + numbers], out, floats[room + LAW : room + LAW + SCRATCH])
            total += weight * out[0]
            volume += weight
            dilatation += weight * out[1]
            squared += weight * floats[law] * out[1] * out[1]
        bulk = floats[ints[NUMBERS_AT] + numbers * points * e]
        if ints[MEAN] == 1:
            total += 0.5 * bulk * dilatation * dilatation / volume
        else:
            total += 0.5 * squared
    return total


@kernel(types.void(A, A, I, types.float64[:, :, ::1]))
def stresses(y, floats, ints, out):
    """Write F and the first Piola stress of strain at the points of the elements: (element, point, 18)."""
    points, numbers, room = ints[POINTS], ints[NUMBERS], ints[ROOM_AT]
    for e in range(ints[ELEMENTS]):
        dilatation, _ = look(y, floats, ints, e, room)
        for q in range(points):
            at, law = room + POINT * q, ints[NUMBERS_AT] + numbers * (points * e + q)
            pressure = floats[law] * (dilatation if ints[MEAN] == 1 else floats[at + D])
            for k in range(9):
                out[e, q, k] = floats[at + k]
                out[e, q, 9 + k] = floats[at + P + k] + pressure * floats[at + M + k]
