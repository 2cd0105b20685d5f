# mypy: ignore-errors
"""The stress that the latest update of Newton's method predicted, in a solid of finite elements.

Where a thin part turns, an update first stretches it, by the square of the angle, and the next one repairs that. The
stress S = F^-1 P of that stretch would hide the way (the stiffness S 1 of turning), so slopes have in its place the one
that the update predicted from the state before it, S + dS/dE : sym(F^T dF): points of integration as in a method whose
stresses are unknowns of their own (Magisano, Leonetti & Garcea 2017, Int. J. Numer. Meth. Engng. 109, 1237-1262).
The stiffness itself has the predicted pressure, too: where volumes hardly change, that of the state is the square of
the strain times a modulus far above all others.
"""

from sceneql.bodies.elements.laws.law_kernels import SCRATCH, stiffness_at
from sceneql.bodies.elements.strain_kernels import (
    LAW,
    MEAN,
    MOST_POINTS,
    NODES,
    NODES_AT,
    NUMBERS,
    NUMBERS_AT,
    POINT,
    POINTS,
    POSITION_AT,
    RATE,
    STIFFNESS,
    WEIGHTS_AT,
    D,
    M,
    P,
    deformation,
    look,
)
from sceneql.compiled.kernels import lean_inlined

LEAST = 0.1
"""The least J at which stresses are predicted."""
PRESSURES, SEEN = 9 * MOST_POINTS, 10 * MOST_POINTS
"""In a tile's scratch behind the stresses of an element's points: their pressures; TURN more are scratch."""
TURN = 9


@lean_inlined
def inverted(f, out):
    """Write the inverse of a 3x3 (9,), and return its determinant; below LEAST nothing is written."""
    a, b, c = f[4] * f[8] - f[5] * f[7], f[5] * f[6] - f[3] * f[8], f[3] * f[7] - f[4] * f[6]
    j = f[0] * a + f[1] * b + f[2] * c
    if j >= LEAST:
        out[0], out[3], out[6] = a / j, b / j, c / j
        out[1], out[4], out[7] = (
            (f[2] * f[7] - f[1] * f[8]) / j,
            (f[0] * f[8] - f[2] * f[6]) / j,
            (f[1] * f[6] - f[0] * f[7]) / j,
        )
        out[2], out[5], out[8] = (
            (f[1] * f[5] - f[2] * f[4]) / j,
            (f[2] * f[3] - f[0] * f[5]) / j,
            (f[0] * f[4] - f[1] * f[3]) / j,
        )
    return j


@lean_inlined
def has_moved(old, y, ints, e):
    """Whether the latest update moved nodes of an element against one another."""
    first, at = NODES_AT + ints[NODES] * e, ints[POSITION_AT]
    o = at + 3 * ints[first]
    for n in range(1, ints[NODES]):
        k = at + 3 * ints[first + n]
        for i in range(3):
            if y[k + i] - old[k + i] != y[o + i] - old[o + i]:
                return True
    return False


@lean_inlined
def foreseen(old, y, floats, ints, e, room, c, to):
    """Write the predicted S (9,) and pressures of the points of an element from floats[to] on; False if there is none.

    ``old``: the state before the update; ``c``: scratch for a stiffness.
    """
    if not has_moved(old, y, ints, e):
        return False
    points, numbers, mean = ints[POINTS], ints[NUMBERS], ints[MEAN] == 1
    stiffness, inverse = stiffness_at(ints[STIFFNESS]), floats[to + SEEN : to + SEEN + TURN]
    dilatation, _ = look(old, floats, ints, e, room)
    volume = growth = 0.0
    for q in range(points):
        at, weight = room + POINT * q, floats[ints[WEIGHTS_AT] + points * e + q]
        change = floats[at + RATE : at + RATE + 9]
        deformation(y, ints, floats, e, q, change)
        if inverted(change, inverse) < LEAST or inverted(floats[at : at + 9], inverse) < LEAST:
            return False
        volume += weight
        for k in range(9):
            change[k] -= floats[at + k]
            growth += weight * floats[at + M + k] * change[k]
    for q in range(points):
        at, law = room + POINT * q, ints[NUMBERS_AT] + numbers * (points * e + q)
        f, p = floats[at : at + 9], floats[at + P : at + P + 9]
        m, change = floats[at + M : at + M + 9], floats[at + RATE : at + RATE + 9]
        bulk, out = floats[law], floats[to + 9 * q : to + 9 * q + 9]
        pressure = bulk * (dilatation if mean else floats[at + D])
        own = floats[law : law + numbers]
        stiffness(f, own, pressure, 0.0 if mean else bulk, 0, c, floats[room + LAW : room + LAW + SCRATCH])
        inverted(f, inverse)
        for k in range(9):
            p[k] += pressure * m[k]
        for i in range(3):  # S before the update
            for k in range(3):
                out[3 * i + k] = inverse[3 * i] * p[k] + inverse[3 * i + 1] * p[3 + k] + inverse[3 * i + 2] * p[6 + k]
        swelling = bulk * growth / volume if mean else 0.0
        grown = swelling
        for k in range(0 if mean else 9):
            grown += bulk * m[k] * change[k]
        floats[to + PRESSURES + q] = pressure + grown
        for k in range(9):  # P after it, by slopes, but for the stress that turns along
            i, j = 3 * (k // 3), k % 3
            total = p[k] + swelling * m[k]
            total -= change[i] * out[j] + change[i + 1] * out[3 + j] + change[i + 2] * out[6 + j]
            for l in range(9):
                total += c[9 * k + l] * change[l]
            f[k] = total
        for i in range(3):
            for k in range(3):
                out[3 * i + k] = inverse[3 * i] * f[k] + inverse[3 * i + 1] * f[3 + k] + inverse[3 * i + 2] * f[6 + k]
        for i, k in ((1, 3), (2, 6), (5, 7)):
            out[i] = out[k] = 0.5 * (out[i] + out[k])
    return True


@lean_inlined
def put_foreseen(f, p, m, pressure, seen, inverse, c):
    """Put the predicted S in the place of that of F in the stiffness c; ``inverse``: scratch."""
    inverted(f, inverse)
    for j in range(3):
        for l in range(3):
            less = 0.0
            for k in range(3):
                less += 0.5 * inverse[3 * j + k] * (p[3 * k + l] + pressure * m[3 * k + l])
                less += 0.5 * inverse[3 * l + k] * (p[3 * k + j] + pressure * m[3 * k + j])
            for i in range(3):
                c[9 * (3 * i + j) + 3 * i + l] += seen[3 * j + l] - less
