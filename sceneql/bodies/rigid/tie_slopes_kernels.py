# mypy: ignore-errors
"""The derivatives of ties, that border the linear systems of implicit stages with their rows (system.Slopes.border).

With a the rates of velocities and momenta, forces f of rows and g(y, a) = J a' + bias = 0 their equations, a' being the
accelerations, a change of y changes a by that of all other forces, by d(J^T f)/dy and by J^T df, so that dg = 0. In the
system (1 - s F) d = r of a stage s, F being all of da/dy, the unknowns s df border the rest: their rows are
(G + s dg/dy) d = G r, with G = dg/da. So what is dense in F, as every force of a tie follows all the others, is never
written.

J, d(J^T f)/dy and dg/dy are those of two bodies alone, by central differences of the rows by the numbers of each:
exact in velocities and momenta, in which they are quadratic.
"""

import math

from sceneql.bodies.rigid.tie_matrix_kernels import (
    EASE_AT,
    MOVED_AT,
    MOVERS_AT,
    ROWS,
    ROWS_AT,
)
from sceneql.bodies.rigid.tie_rows_kernels import (
    AT_A,
    AT_BIAS,
    AT_FORCE,
    AT_INVERSE,
    AT_J,
    AT_MASS,
    AT_TWIST,
    AT_W,
    CARRIED,
    DISTANCE,
    FIRST,
    GEAR,
    KIND,
    LENGTH,
    MOMENTUM,
    MOVED,
    MOVER,
    NUMBERS,
    OF_LINE,
    POSITION,
    ROTATION,
    ROW_INTS,
    SCRATCH,
    SECOND,
    VELOCITY,
    cross,
    put,
    see,
    turned,
    turning,
    weighed,
    write_row,
)
from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.system.signatures_kernels import TERM

X, Q, V, L, OWN = 0, 3, 7, 10, 13
"""Numbers of a body: position, quaternion, velocity, angular momentum."""
PLACES = 2 * V
"""Columns of d(J^T f)/dy: position and quaternion of both bodies; its 12 rows are velocity and momentum of both."""
FORCES, ASKED, GIVEN, DIAGONAL = 12 * PLACES, 12 * PLACES + 12, 12 * PLACES + 12 + 2 * OWN, 12 * PLACES + 24 + 2 * OWN
ENTRIES = DIAGONAL + 1
"""Entries of a row of ties: d(J^T f)/dy; J^T, in the column of its force; - dg/dy; G; less than 0 on the diagonal."""
TURN = 1e-5
"""Change of a quaternion, as a part of its length: differences are exact to its square."""
PART = 1e-5
"""Change of a position, as a part of the length of a rod or a line of axles; other rows are linear in it."""


@lean_inlined
def difference(y, floats, ints, at, body, c):
    """The change of one number of the mover of ints[at:] for differences of what is linear in positions."""
    if c < Q or V <= c < L:
        return 1.0
    if c < V:
        q = ints[at + ROTATION]
        return TURN * (abs(y[q]) + abs(y[q + 1]) + abs(y[q + 2]) + abs(y[q + 3]))
    g = body + AT_INVERSE
    return 1.0 / (floats[g] + floats[g + 4] + floats[g + 8])


@lean_inlined
def left(floats, to, a, b):
    """J a' + bias of a row, at the accelerations of two movers."""
    total = floats[to + AT_BIAS]
    for c in range(6):
        total += floats[to + AT_J + c] * floats[a + AT_A + c] + floats[to + AT_J + 6 + c] * floats[b + AT_A + c]
    return total


@lean_inlined
def moves(floats, ints, at, body):
    """Whether forces move the mover of ints[at:]."""
    return ints[at + POSITION] >= 0 and floats[body + AT_MASS] > 0.0


@lean_inlined
def entry_of(ints, at, c):
    """The entry of y that is number c of a body; -1: a mass has none."""
    if c < Q:
        return ints[at + POSITION] + c
    if c < V:
        return ints[at + ROTATION] + c - Q if ints[at + ROTATION] >= 0 else -1
    if c < L:
        return ints[at + VELOCITY] + c - V
    return ints[at + MOMENTUM] + c - L if ints[at + ROTATION] >= 0 else -1


@lean_inlined
def look(y, floats, ints, at, body, spare, px, py, pz):
    """Write a mover anew, at the accelerations of `body` and the rate (px, py, pz) of its angular momentum."""
    see(y, floats, spare, ints, at)
    put(floats, spare + AT_A, floats[body + AT_A], floats[body + AT_A + 1], floats[body + AT_A + 2])
    if ints[at + ROTATION] >= 0:
        k, w = ints[at + MOMENTUM], spare + AT_W
        gx, gy, gz = cross(floats[w], floats[w + 1], floats[w + 2], y[k], y[k + 1], y[k + 2])
        put(floats, spare + AT_TWIST, *turned(floats, spare + AT_INVERSE, px - gx, py - gy, pz - gz))


@lean_inlined
def add_constant(entries, floats, ints, k, first, second):
    """Add what row k has of its last evaluation; whether its movers, given by their floats, are moved."""
    row = ints[ROWS_AT] + ROW_INTS * k
    to, own = ints[row + SCRATCH], ENTRIES * k
    weight = 0.0
    for side in range(2):
        at, mover = ints[MOVERS_AT] + MOVER * ints[row + FIRST + side], first if side == 0 else second
        if not moves(floats, ints, at, mover):
            continue
        push = weighed(floats, mover, to + AT_J + 6 * side)
        for c in range(6):
            if c < 3 or ints[at + ROTATION] >= 0:
                j = floats[to + AT_J + 6 * side + c]
                entries[own + FORCES + 6 * side + c] += j
                entries[own + GIVEN + 6 * side + c] += j if c < 3 else push[c]
                weight += j * push[c]
    # A little, as where forces are found, so that rows that others imply have a force.
    entries[own + DIAGONAL] -= floats[ints[EASE_AT]] * weight if weight > 0.0 else 1.0


@kernel(TERM, inner=True)
def hold(t, y, entries, floats, ints):
    """Of each row ENTRIES, at the forces and accelerations that tie_kernels.hold has just found."""
    spare = ints[ints.size - 1]
    begin = 0
    while begin < ints[ROWS]:
        row, end, rod = ints[ROWS_AT] + ROW_INTS * begin, begin, math.inf
        while end < ints[ROWS]:
            other = ints[ROWS_AT] + ROW_INTS * end
            if ints[other + FIRST] != ints[row + FIRST] or ints[other + SECOND] != ints[row + SECOND]:
                break
            if ints[other + KIND] == DISTANCE:
                rod = min(rod, floats[ints[other + NUMBERS] + 6])
            if ints[other + KIND] == GEAR and floats[ints[other + NUMBERS] + LENGTH] > 0.0:
                rod = min(rod, floats[ints[other + NUMBERS] + LENGTH])
            if ints[other + KIND] == CARRIED and floats[ints[other + NUMBERS] + OF_LINE] > 0.0:
                rod = min(rod, floats[ints[other + NUMBERS] + OF_LINE])
            end += 1
        one, two = ints[MOVED_AT] + MOVED * ints[row + FIRST], ints[MOVED_AT] + MOVED * ints[row + SECOND]
        for k in range(begin, end):
            add_constant(entries, floats, ints, k, one, two)
        first = moves(floats, ints, ints[MOVERS_AT] + MOVER * ints[row + FIRST], one)
        second = moves(floats, ints, ints[MOVERS_AT] + MOVER * ints[row + SECOND], two)
        acted, acting = 0 if first else 6, 12 if second else 6
        for side in range(2):
            at, body = ints[MOVERS_AT] + MOVER * ints[row + FIRST + side], two if side == 1 else one
            if not (second if side == 1 else first):
                continue
            px = py = pz = 0.0
            if ints[at + ROTATION] >= 0:
                px, py, pz = turning(y, floats, body, ints[at + MOMENTUM])
            a, b = one if side == 1 else spare, spare if side == 1 else two
            for c in range(OWN):
                i = entry_of(ints, at, c)
                if i < 0:
                    continue
                kept, step = y[i], difference(y, floats, ints, at, body, c)
                if c < Q and rod < math.inf:
                    step = PART * rod
                step = (kept + step) - kept
                for way in (0.5 / step, -0.5 / step):
                    y[i] = kept + (step if way > 0.0 else -step)
                    look(y, floats, ints, at, body, spare, px, py, pz)
                    for k in range(begin, end):
                        own = ints[ROWS_AT] + ROW_INTS * k
                        to = ints[own + SCRATCH]
                        write_row(floats, ints, own, a, b)
                        entries[ENTRIES * k + ASKED + OWN * side + c] -= way * left(floats, to, a, b)
                        if c < V:
                            force, into = way * floats[to + AT_FORCE], ENTRIES * k + V * side + c
                            for j in range(acted, acting):
                                entries[into + PLACES * j] += force * floats[to + AT_J + j]
                y[i] = kept
            for k in range(begin, end):
                write_row(floats, ints, ints[ROWS_AT] + ROW_INTS * k, one, two)
        begin = end
