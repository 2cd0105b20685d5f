# mypy: ignore-errors
"""The forces of exact contacts that rest, roll or slide, with those of the ties, and what takes their errors away."""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_A,
    AT_FORCE,
    AT_V,
    AT_W,
    AT_X,
    MOMENTUM,
    MOVER,
    POSITION,
    ROTATION,
    VELOCITY,
    press,
    put,
    see,
)
from sceneql.bodies.rigid.ties.tie_settle_kernels import shift_mover
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.rigid_exact.contact_kernels import (
    AIMED,
    ALONG,
    FORCE,
    GAP,
    KIND,
    NORMAL,
    POINT,
    PUSHES,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SLIDE,
    SLIDES,
    SLIP,
    SLOW,
    SPEED,
    TURN_AIMED,
    dot,
    pace,
    three,
)
from sceneql.contacts.rigid_exact.energy_made_kernels import keep_losses
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    AGAIN,
    AT_CONTACT,
    AT_FIRST,
    AT_PUSH,
    AT_WEIGHED,
    BEGUN,
    COUNT_AT,
    COUNTED,
    DRIVES,
    FORCES,
    FORCES_AT,
    FRICTION_AT,
    GAPS,
    JAMMED,
    KEPT,
    LOOSE,
    MEMORY_AT,
    MOVERS,
    MOVERS_AT,
    NORMALS_AT,
    PATIENCE,
    POINTS_AT,
    RECORDS_AT,
    SINCE,
    SPARING,
    SPEEDS,
    TIE_ROWS,
    TIED_AT,
    UNDECIDED,
    UNIT,
    UNITS_AT,
    WORKS_AT,
    count_energy,
    follow_all,
    kick,
    left_at,
    look,
    look_at_motions,
    mover_at,
    pull_at,
    sizes_at,
    solution_at,
    write_rows,
)
from sceneql.contacts.rigid_exact.exact_solve_kernels import solve_rows, within_reason
from sceneql.contacts.rigid_exact.extra_rows_kernels import (
    aim_turning,
    decide_more,
    give,
    more_open,
    tell_efforts,
    tell_given,
    watch_more,
    write_more,
)
from sceneql.contacts.rigid_exact.rim_kernels import any_rim, exchange_all, save
from sceneql.contacts.rigid_exact.rim_pressure_kernels import enclose_pressure
from sceneql.contacts.rigid_exact.stop_kernels import STOP, SURE
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, I, N

STILL = 1e-10
"""Slip [m/s], and in parts of the speeds that it is a sum of, up to which a contact does not slide."""
CREEP = 1e-5
"""Slip [m/s] up to which friction is against the pull; what is left of it ends where the pull is below its bound."""
LEAVES = 1e-10
"""Acceleration, in parts of the numbers that it is a sum of, from which a contact leaves or slips."""
ROUNDING = 2e-11
"""Sum of forces, in parts of these, that is rounding."""
CLOSED = 4e-16
"""Gap or speed, against the numbers that it is the difference of, below which it is rounding."""
MOST_CLOSINGS = 4
MOST_TURNS = 50
"""Exchanges of points of circles that lie flat in one solution."""


@lean_inlined
def still(floats, ints, rec):
    """Slip up to which a contact sticks."""
    a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
    return STILL * (1.0 + pace(floats, rec, a, b))


@lean(types.void(A, I))
def aim(floats, ints):
    """Write the directions in which contacts slide; zero where they stick, or are so slow that the pull decides.

    In a step that goes beyond the end of a slip, where it is to be cut, friction goes on as before (watch_kernels.gap).
    """
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        sx, sy, sz = three(floats, rec + SLIDE)
        speed, slides, watched = math.sqrt(sx * sx + sy * sy + sz * sz), floats[rec + SLIDES], floats[rec + SLIP] > SURE
        if slides == 0.0 or speed <= (CREEP if slides == SLOW else 1e-3 * CREEP):
            by = 1.0 if slides > SLOW and watched else 0.0
            sx, sy, sz = three(floats, rec + ALONG)
        else:
            by = (-1.0 if watched and dot(sx, sy, sz, *three(floats, rec + ALONG)) < 0.0 else 1.0) / speed
        put(floats, rec + AIMED, by * sx, by * sy, by * sz)
        aim_turning(floats, rec, CREEP)


@lean(types.boolean(A, I))
def unaim(floats, ints):
    """Let no contact have a direction of slip; whether one had."""
    some = False
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        for which in (AIMED, TURN_AIMED):
            at = ints[RECORDS_AT] + RECORD * k + which
            some = some or floats[at] != 0.0 or floats[at + 1] != 0.0 or floats[at + 2] != 0.0
            put(floats, at, 0.0, 0.0, 0.0)
    return some


@lean(types.boolean(A, I, N))
def decide(floats, ints, n):
    """Drop the contacts that leave, let those slide that slip, and keep the forces as a guess; whether some do."""
    memory = ints[MEMORY_AT]
    kept, row, changes = 0, ints[TIE_ROWS], decide_more(floats, ints, n, LEAVES)
    found, left = solution_at(ints), left_at(ints)
    for k in range(int(floats[memory + KEPT])):
        rec, to = ints[RECORDS_AT] + RECORD * k, ints[RECORDS_AT] + RECORD * kept
        rows, largest = 0, floats[sizes_at(ints) + row]
        while row + rows < n and floats[ints[UNITS_AT] + UNIT * (row + rows) + AT_CONTACT] == k:
            floats[rec + FORCE + rows] = floats[found + row + rows]
            rows += 1
        pushes, leaves = floats[found + row] > 0.0, floats[left + row] > LEAVES * largest
        # (What pushes does not leave, where no solution was found to rounding.)
        leaves = leaves and not pushes and floats[memory + AGAIN] < PATIENCE
        floats[rec + PUSHES] = 1.0 if pushes else 0.0
        if rows == 3 and not leaves:
            p, q = floats[left + row + 1], floats[left + row + 2]
            size = math.sqrt(p * p + q * q)
            floats[rec + SLIDES] = SLOW if size > LEAVES * largest else 0.0
            changes = changes or floats[rec + SLIDES] > 0.0
        row += rows
        if leaves:
            changes = True
            continue
        if to != rec:
            for c in range(RECORD):
                floats[to + c] = floats[rec + c]
        kept += 1
    floats[memory + KEPT] = kept
    floats[memory + UNDECIDED] = 0.0
    return changes


@lean(types.void(A, I, N, types.float64))
def tell(floats, ints, n, friction):
    """Write points, normals and forces of the contacts for outputs, and the efforts of ties."""
    row, found, count = ints[TIE_ROWS], solution_at(ints), 0
    tell_efforts(floats, ints, n)
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        if floats[rec + KIND] == STOP:
            row += 1
            continue
        fx = fy = fz = 0.0
        while row < n and floats[ints[UNITS_AT] + UNIT * row + AT_CONTACT] == k:
            at = ints[UNITS_AT] + UNIT * row + AT_PUSH
            fx += floats[found + row] * floats[at]
            fy += floats[found + row] * floats[at + 1]
            fz += floats[found + row] * floats[at + 2]
            row += 1
        put(floats, ints[POINTS_AT] + 3 * count, *three(floats, rec + POINT))
        put(floats, ints[NORMALS_AT] + 3 * count, *three(floats, rec + NORMAL))
        put(floats, ints[FORCES_AT] + 3 * count, fx, fy, fz)
        count += 1
    floats[ints[COUNT_AT]] = count


@lean(types.void(A, A, I, N))
def balance(rate, floats, ints, n):
    """Set the forces on a mover to 0 that are rounding, so that what rests stays, whatever the solver's step."""
    found = solution_at(ints)
    for m in range(ints[MOVERS]):
        at = ints[MOVERS_AT] + MOVER * m
        if ints[at + POSITION] < 0:
            continue
        force = torque = 0.0
        for i in range(n):
            unit = ints[UNITS_AT] + UNIT * i
            for side in range(2):
                if floats[unit + AT_FIRST + side] == m:
                    push, size = unit + AT_PUSH + 6 * side, abs(floats[found + i])
                    if i < ints[TIE_ROWS]:
                        size += abs(floats[ints[ints[TIED_AT] + 3 * i + 2] + AT_FORCE])
                    for c in range(3):
                        force += size * abs(floats[push + c])
                        torque += size * abs(floats[push + 3 + c])
        total = turn = 0.0
        for c in range(3):
            total += abs(rate[ints[at + VELOCITY] + c])
            turn += abs(rate[ints[at + MOMENTUM] + c]) if ints[at + ROTATION] >= 0 else 0.0
        for c in range(3):
            if total <= ROUNDING * force:
                rate[ints[at + VELOCITY] + c] = 0.0
            if ints[at + ROTATION] >= 0 and turn <= ROUNDING * torque:
                rate[ints[at + MOMENTUM] + c] = 0.0


@lean(types.Tuple((N, types.boolean, types.boolean))(A, I, types.float64))
def forces(floats, ints, friction):
    """Solve for the forces: rows that were solved for, whether to rounding, and whether no force fitted the slip."""
    aim(floats, ints)
    n = write_more(floats, ints, write_rows(floats, ints, FORCES, friction), FORCES)
    solved = solve_rows(floats, ints, n, friction, True)
    if not (solved and within_reason(floats, ints, n)) and unaim(floats, ints):
        # No force fits the slip: friction against the pull does, and what sticks by it is stopped at once.
        n = write_more(floats, ints, write_rows(floats, ints, FORCES, friction), FORCES)
        return n, solve_rows(floats, ints, n, friction, True), True
    return n, solved, False


@lean(TERM, inner=True)
def hold(t, y, rate, floats, ints):
    """Adds the forces of all contacts, and what they change of the ties' forces, once those are there."""
    memory = ints[MEMORY_AT]
    for m in range(ints[MOVERS]):
        at, to = ints[MOVERS_AT] + MOVER * m, mover_at(ints, m)
        see(y, floats, to, ints, at)
        press(y, rate, floats, to, ints, at)
        for c in range(6):
            floats[pull_at(ints, m) + c] = floats[to + AT_A + c]
    keep_losses(rate, floats, ints)
    floats[ints[COUNT_AT]] = 0.0
    look_at_motions(y, floats, ints)
    if floats[memory + KEPT] == 0.0 and ints[DRIVES] == 0:
        floats[memory + UNDECIDED] = 0.0
        return
    friction = floats[ints[FRICTION_AT]]
    follow_all(floats, ints)
    if floats[memory + UNDECIDED] > 0.0 and any_rim(floats, ints):
        enclose_pressure(floats, ints)
    n, solved, jammed = forces(floats, ints, friction)
    turns = 0
    # With as few points of a circle as bear it; where no solution is found so, with more.
    for way in range(2):
        floats[memory + SPARING] = 1.0 - way
        while turns < MOST_TURNS * (1 + way) and any_rim(floats, ints):
            if turns == 0:
                save(floats, ints, False)
            if not exchange_all(floats, ints, n, True):
                break
            n, solved, jammed = forces(floats, ints, friction)
            turns += 1
        if solved or turns == 0 or way == 1:
            break
        save(floats, ints, True)
        n, solved, jammed = forces(floats, ints, friction)
    floats[memory + JAMMED] += floats[memory + UNDECIDED] if jammed else 0.0
    floats[memory + LOOSE] += 0.0 if solved else floats[memory + UNDECIDED]
    found = solution_at(ints)
    for i in range(n):
        unit, force = ints[UNITS_AT] + UNIT * i, floats[found + i]
        for side in range(2):
            m = int(floats[unit + AT_FIRST + side])
            at, mover, f = ints[MOVERS_AT] + MOVER * m, mover_at(ints, m), unit + AT_PUSH + 6 * side
            if ints[at + POSITION] < 0:
                continue
            power = 0.0
            for c in range(3):
                rate[ints[at + VELOCITY] + c] += force * floats[f + c]
                power += floats[f + c] * floats[mover + AT_V + c]
                if ints[at + ROTATION] >= 0:
                    rate[ints[at + MOMENTUM] + c] += force * floats[f + 3 + c]
                    power += floats[f + 3 + c] * floats[mover + AT_W + c]
            if i >= ints[TIE_ROWS] and ints[ints[WORKS_AT] + m] >= 0:
                rate[ints[ints[WORKS_AT] + m]] -= force * power
            give(rate, floats, ints, unit, force * power)
        if i < ints[TIE_ROWS]:
            floats[ints[ints[TIED_AT] + 3 * i + 2] + AT_FORCE] += force
    balance(rate, floats, ints, n)
    tell(floats, ints, n, friction)
    if floats[memory + UNDECIDED] > 0.0:
        if decide(floats, ints, n):
            floats[memory + SINCE] = max(t, floats[memory + SINCE])
    elif turns > 0:  # nothing that is asked at an instant may change what comes after
        save(floats, ints, True)
    if t > floats[memory + BEGUN]:
        watch_more(floats, ints, n, LEAVES)


@lean_inlined
def size_of(floats, ints, rec):
    """Size of the coordinates of a contact."""
    total = 0.0
    for side in range(2):
        mover = mover_at(ints, int(floats[rec + SHAPE_A + side]))
        for c in range(3):
            total += abs(floats[mover + AT_X + c]) + abs(floats[rec + POINT + c] - floats[mover + AT_X + c])
    return total


@lean(AFTER_STEP, inner=True)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Closes the gaps and the speeds of kept contacts, by the least change that ties leave."""
    memory = ints[MEMORY_AT]
    tell_given(y1, floats, ints)
    if (floats[memory + KEPT] == 0.0 and ints[DRIVES] == 0) or t1 < floats[memory + SINCE]:
        return False
    friction = floats[ints[FRICTION_AT]]
    changed = False
    for _ in range(MOST_CLOSINGS):
        look(t1, y1, floats, ints)
        follow_all(floats, ints)
        open = False
        for k in range(int(floats[memory + KEPT])):
            rec = ints[RECORDS_AT] + RECORD * k
            gap = floats[rec + GAP] if floats[rec + PUSHES] > 0.0 else min(0.0, floats[rec + GAP])
            if abs(gap) > CLOSED * size_of(floats, ints, rec):
                open = True
        if not open:
            break
        n = write_rows(floats, ints, GAPS, friction)
        solve_rows(floats, ints, n, 0.0, False)
        for m in range(ints[MOVERS]):
            for c in range(6):
                floats[mover_at(ints, m) + AT_A + c] = 0.0
        for i in range(n):
            unit, by = ints[UNITS_AT] + UNIT * i, floats[solution_at(ints) + i]
            for side in range(2):
                mover = mover_at(ints, int(floats[unit + AT_FIRST + side]))
                for c in range(3):
                    floats[mover + AT_A + c] += by * floats[unit + AT_WEIGHED + 6 * side + c]
                    floats[mover + AT_A + 3 + c] += by * floats[unit + AT_WEIGHED + 6 * side + 3 + c]
        for m in range(ints[MOVERS]):
            shift_mover(y1, floats, ints, ints[MOVERS_AT] + MOVER * m, mover_at(ints, m))
        changed = True
    open = False
    for k in range(int(floats[memory + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
        worst = abs(floats[rec + SPEED]) if floats[rec + PUSHES] > 0.0 else max(0.0, -floats[rec + SPEED])
        if floats[rec + PUSHES] > 0.0 and floats[rec + SLIDES] == 0.0 and friction > 0.0:
            for c in range(3):
                worst = max(worst, abs(floats[rec + SLIDE + c]))
        open = open or worst > CLOSED * pace(floats, rec, a, b)
    if open or more_open(floats, ints, CLOSED):
        n = write_more(floats, ints, write_rows(floats, ints, SPEEDS, friction), SPEEDS)
        # Tangents stand as ties here: what sticks has no speed.
        solve_rows(floats, ints, n, 0.0, False)
        jammed = floats[memory + JAMMED] > floats[memory + COUNTED]
        if jammed:  # an impulse without an impact, of which the energy is no error
            floats[memory + COUNTED] = floats[memory + JAMMED]
            count_energy(y1, floats, ints, 1.0)
        kick(y1, floats, ints, n)
        if jammed:
            look(t1, y1, floats, ints)
            count_energy(y1, floats, ints, -1.0)
        changed = True
    return changed
