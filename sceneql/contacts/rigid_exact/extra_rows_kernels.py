# mypy: ignore-errors
"""Rows behind those of contacts: moments that resist rolling and spinning, motors and dry friction of ties.

The moment of a contact is at most a length times its normal force, against the spin of the one body in the other
(Coulomb 1785). Where they turn it is known by that force (exact_rows_kernels); else these rows find it.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_FORCE, AT_W, MOVER, POSITION, ROTATION, put
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.rigid_exact.contact_kernels import (
    KIND,
    OWN_A,
    PUSHES,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    SLOW,
    TORQUE,
    TURN,
    TURN_AIMED,
    TURN_ALONG,
    TURN_SLIP,
    TURNS,
    dot,
    three,
)
from sceneql.contacts.rigid_exact.exact_law_kernels import BILATERAL, BOUNDED, MOMENT
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    AT_CONTACT,
    AT_FIRST,
    AT_PUSH,
    AT_ROW,
    AT_WEIGHED,
    DRIVES,
    FORCES,
    IMPACTS,
    KEPT,
    KINDS_AT,
    MEMORY_AT,
    MOVERS_AT,
    RECORDS_AT,
    ROLLING_AT,
    SPEEDS,
    TIE_ROWS,
    TIED_AT,
    UNIT,
    UNITS_AT,
    bounds_at,
    driven_at,
    left_at,
    mover_at,
    partners_at,
    pressed,
    right_at,
    rooms,
    sizes_at,
    solution_at,
    weigh,
)
from sceneql.contacts.rigid_exact.stop_kernels import (
    BROKEN,
    DRIFT,
    EFFORT_AT,
    FAST,
    FIRST_MOVER,
    GIVEN_AT,
    MOSTS,
    ROW_AT,
    SECOND_MOVER,
    SIGNS,
    STOP,
    SURE,
    TARGET_RATES,
    slip,
)
from sceneql.contacts.rigid_exact.stop_kernels import FORCES as HELD
from sceneql.system.signatures_kernels import A, F, I, N

OF_DRIVE = -2
"""The contact of a row of a tie's motor or friction, less twice the number of the tie, less 1 for friction; behind
those of all ties that of a moment, less the number of its contact."""


@lean(types.boolean(A, I, N))
def turns(floats, ints, rec):
    """Whether a moment may resist the turning of a contact: not of a stop, nor of a mass."""
    if floats[rec + KIND] == STOP:
        return False
    for side in range(2):
        at = ints[MOVERS_AT] + MOVER * int(floats[rec + SHAPE_A + side])
        if ints[at + POSITION] >= 0 and ints[at + ROTATION] < 0:
            return False
    return True


@lean_inlined
def turn_pace(floats, ints, rec):
    """Size of the angular speeds that the turning of a contact is the difference of."""
    total = 0.0
    for side in range(2):
        mover = mover_at(ints, int(floats[rec + SHAPE_A + side]))
        for c in range(3):
            total += abs(floats[mover + AT_W + c])
    return total


@lean(types.boolean(A, I, N, F, F))
def begin_turning(floats, ints, rec, least, creep):
    """Keep whether a contact turns: faster than ``least`` in parts of its speeds, or no faster than ``creep`` [rad/s];
    whether that is as before."""
    if floats[ints[ROLLING_AT]] <= 0.0:
        return True
    x, y, z = three(floats, rec + TURN)
    speed = math.sqrt(x * x + y * y + z * z)
    if not turns(floats, ints, rec) or speed <= least * (1.0 + turn_pace(floats, ints, rec)):
        same = floats[rec + TURNS] == 0.0
        floats[rec + TURNS] = floats[rec + TURN_SLIP] = 0.0
        return same
    way = 2.0 * SLOW if speed > creep else SLOW
    same = floats[rec + TURNS] == way
    floats[rec + TURNS], floats[rec + TURN_SLIP] = way, speed
    put(floats, rec + TURN_ALONG, x / speed, y / speed, z / speed)
    return same


@lean(types.void(A, N, F))
def aim_turning(floats, rec, creep):
    """Write the direction in which a contact turns; zero where it does not, or so slowly that the pull decides.

    In a step that goes beyond the end of a turn the moment goes on as before, as friction does (exact_hold_kernels).
    """
    x, y, z = three(floats, rec + TURN)
    speed, turns, watched = math.sqrt(x * x + y * y + z * z), floats[rec + TURNS], floats[rec + TURN_SLIP] > SURE
    if turns == 0.0 or speed <= (creep if turns == SLOW else 1e-3 * creep):
        by = 1.0 if turns > SLOW and watched else 0.0
        x, y, z = three(floats, rec + TURN_ALONG)
    else:
        by = (-1.0 if watched and dot(x, y, z, *three(floats, rec + TURN_ALONG)) < 0.0 else 1.0) / speed
    put(floats, rec + TURN_AIMED, by * x, by * y, by * z)


@lean(N(A, I, N, N, N))
def write_moment(floats, ints, n, i, what):
    """Write the three rows of the moment of the contact whose normal force is row i, from row n on; the next row."""
    k = int(floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT])
    rec = ints[RECORDS_AT] + RECORD * k
    a, b = int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B])
    for axis in range(3):
        at, row = ints[UNITS_AT] + UNIT * (n + axis), n + axis
        for c in range(12):
            floats[at + AT_ROW + c] = floats[at + AT_PUSH + c] = 0.0
        floats[at + AT_ROW + 3 + axis] = floats[at + AT_PUSH + 3 + axis] = 1.0
        floats[at + AT_ROW + 9 + axis] = floats[at + AT_PUSH + 9 + axis] = -1.0
        weigh(floats, ints, row, a, b, AT_PUSH, OF_DRIVE - 2 * ints[DRIVES] - k)
        ints[ints[KINDS_AT] + row] = BILATERAL if what == SPEEDS else MOMENT + axis
        ints[partners_at(ints) + row] = i
        floats[bounds_at(ints) + row] = floats[ints[ROLLING_AT]]
        right = pressed(floats, ints, row) if what == FORCES else floats[rec + TURN + axis]
        floats[right_at(ints) + row] = right
        floats[solution_at(ints) + row] = floats[rec + TORQUE + axis] if what == FORCES else 0.0
        floats[sizes_at(ints) + row] = 0.0 if what == FORCES else turn_pace(floats, ints, rec)
    return n + 3


@lean(F(A, I, N))
def borne(floats, ints, row):
    """Size of what a row's speeds gain by the ties' own forces, each by itself: together they may cancel all others,
    and what is left is rounding of these."""
    at, total = ints[UNITS_AT] + UNIT * row, 0.0
    for i in range(ints[TIE_ROWS]):
        unit, force = ints[UNITS_AT] + UNIT * i, abs(floats[ints[ints[TIED_AT] + 3 * i + 2] + AT_FORCE])
        for side in range(2):
            for other in range(2):
                if floats[at + AT_FIRST + side] == floats[unit + AT_FIRST + other]:
                    for c in range(6):
                        gain = floats[at + AT_ROW + 6 * side + c] * floats[unit + AT_WEIGHED + 6 * other + c]
                        total += force * abs(gain)
    return total


@lean(N(A, I, N, N))
def write_more(floats, ints, n, what):
    """Write the rows behind those of contacts, of which there are n, for FORCES, SPEEDS or IMPACTS; how many there are
    then."""
    contacts, k = n, -1
    rolling = floats[ints[ROLLING_AT]] > 0.0
    for i in range(ints[TIE_ROWS], contacts if rolling else 0):
        before, k = k, int(floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT])
        rec = ints[RECORDS_AT] + RECORD * k
        aimed = floats[rec + TURN_AIMED] != 0.0 or floats[rec + TURN_AIMED + 1] != 0.0
        aimed = aimed or floats[rec + TURN_AIMED + 2] != 0.0
        rests = floats[rec + PUSHES] > 0.0 and floats[rec + TURNS] == 0.0
        wanted = what == IMPACTS or (what == FORCES and not aimed) or (what == SPEEDS and rests)
        if k != before and wanted and turns(floats, ints, rec):
            n = write_moment(floats, ints, n, i, what)
    for d in range(ints[DRIVES] if what == FORCES or what == SPEEDS else 0):
        own = driven_at(ints, d)
        for j in range(2):
            most, sign = floats[own + MOSTS + j], floats[own + SIGNS + j]
            if most <= 0.0 or (what == SPEEDS and (sign != 0.0 or floats[own + BROKEN + j] != 0.0)):
                continue
            at, row = ints[UNITS_AT] + UNIT * n, int(floats[own + ROW_AT])
            for c in range(12):
                floats[at + AT_ROW + c] = floats[at + AT_PUSH + c] = floats[row + c]
            first, second = int(floats[own + FIRST_MOVER]), int(floats[own + SECOND_MOVER])
            weigh(floats, ints, n, first, second, AT_PUSH, OF_DRIVE - 2 * d - j)
            if what == SPEEDS:
                ints[ints[KINDS_AT] + n] = BILATERAL
                floats[right_at(ints) + n], floats[solution_at(ints) + n] = slip(floats, own, j), 0.0
            else:
                ints[ints[KINDS_AT] + n] = BOUNDED
                drift = floats[own + DRIFT] - floats[own + TARGET_RATES + j]
                floats[right_at(ints) + n] = pressed(floats, ints, n) + drift
                floats[solution_at(ints) + n] = floats[own + HELD + j]
                floats[bounds_at(ints) + n] = -most if sign >= 0.0 else most
                floats[bounds_at(ints) + rooms(ints) + n] = most if sign <= 0.0 else -most
            floats[sizes_at(ints) + n] = 0.0
            n += 1
    for i in range(n if what == FORCES else 0):
        floats[sizes_at(ints) + i] = borne(floats, ints, i)
    return n


@lean_inlined
def first_more(floats, ints, n):
    """The first of n rows that is behind those of contacts."""
    i = ints[TIE_ROWS]
    while i < n and floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT] >= 0.0:
        i += 1
    return i


@lean(types.boolean(A, I, N, F))
def decide_more(floats, ints, n, leaves):
    """Let contacts turn, and motors and friction slip, that the solution of n rows has do so; keep the forces; whether
    some do. ``leaves``: acceleration, in parts of the numbers that it is a sum of, that counts."""
    changes, i = False, first_more(floats, ints, n)
    found, left = solution_at(ints), left_at(ints)
    while i < n:
        of, largest = int(floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT]), floats[sizes_at(ints) + i]
        if OF_DRIVE - of >= 2 * ints[DRIVES]:
            rec = ints[RECORDS_AT] + RECORD * (OF_DRIVE - of - 2 * ints[DRIVES])
            x, y, z = three(floats, left + i)
            put(floats, rec + TORQUE, *three(floats, found + i))
            floats[rec + TURNS] = SLOW if math.sqrt(x * x + y * y + z * z) > leaves * largest else 0.0
            changes = changes or floats[rec + TURNS] > 0.0
            i += 3
            continue
        d, j = (OF_DRIVE - of) // 2, (OF_DRIVE - of) % 2
        own = driven_at(ints, d)
        floats[own + HELD + j] = floats[found + i]
        if floats[own + SIGNS + j] == 0.0 and abs(floats[left + i]) > leaves * largest:
            floats[own + SIGNS + j] = math.copysign(1.0, floats[left + i])
            changes = True
        i += 1
    return changes


@lean(types.void(A, I, N, F))
def watch_more(floats, ints, n, leaves):
    """Keep of motors and friction that hold whether they have begun to slip within the step."""
    for i in range(first_more(floats, ints, n), n):
        of = int(floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT])
        if OF_DRIVE - of < 2 * ints[DRIVES]:
            own, j = driven_at(ints, (OF_DRIVE - of) // 2), (OF_DRIVE - of) % 2
            slips = abs(floats[left_at(ints) + i]) > leaves * floats[sizes_at(ints) + i]
            if floats[own + SIGNS + j] == 0.0 and slips:
                floats[own + BROKEN + j] = 1.0


@lean(types.void(A, I, N))
def tell_efforts(floats, ints, n):
    """Write what stops, motor and friction of each tie do along its motion, by a solution of n rows."""
    for d in range(ints[DRIVES]):
        floats[int(floats[driven_at(ints, d) + EFFORT_AT])] = 0.0
    for i in range(ints[TIE_ROWS], n):
        of, own, sign = int(floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT]), -1, 1.0
        if of < 0 and OF_DRIVE - of < 2 * ints[DRIVES]:
            own = driven_at(ints, (OF_DRIVE - of) // 2)
        elif of >= 0:
            rec = ints[RECORDS_AT] + RECORD * of
            if floats[rec + KIND] == STOP:
                own, sign = int(floats[rec + OWN_A]), floats[rec + SIGN]
        if own >= 0:
            floats[int(floats[own + EFFORT_AT])] += sign * floats[solution_at(ints) + i]


@lean(types.void(A, A, I, N, F))
def give(rate, floats, ints, unit, power):
    """Count the power of a row, if it is a motor's, as energy that this gives."""
    of = int(floats[unit + AT_CONTACT])
    if of > OF_DRIVE or OF_DRIVE - of >= 2 * ints[DRIVES] or (OF_DRIVE - of) % 2 != 0:
        return
    rate[int(floats[driven_at(ints, (OF_DRIVE - of) // 2) + GIVEN_AT])] += power


@lean(types.void(A, A, I))
def tell_given(y, floats, ints):
    """Write the energies that motors gave up to a state behind their efforts."""
    for d in range(ints[DRIVES]):
        own = driven_at(ints, d)
        floats[int(floats[own + EFFORT_AT]) + 2] = y[int(floats[own + GIVEN_AT])]


@lean(types.boolean(A, I, F))
def more_open(floats, ints, closed):
    """Whether a contact that rests turns, or a motor or friction that holds slips: by more than rounding."""
    if floats[ints[ROLLING_AT]] > 0.0:
        for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
            rec = ints[RECORDS_AT] + RECORD * k
            x, y, z = three(floats, rec + TURN)
            rests = floats[rec + PUSHES] > 0.0 and floats[rec + TURNS] == 0.0 and turns(floats, ints, rec)
            if rests and max(abs(x), abs(y), abs(z)) > closed * turn_pace(floats, ints, rec):
                return True
    for d in range(ints[DRIVES]):
        own = driven_at(ints, d)
        for j in range(2):
            holds = floats[own + MOSTS + j] > 0.0 and floats[own + SIGNS + j] == 0.0 and floats[own + BROKEN + j] == 0.0
            if holds and abs(slip(floats, own, j)) > closed * (abs(floats[own + FAST]) + 1e-300):
                return True
    return False
