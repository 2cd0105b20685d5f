# mypy: ignore-errors
"""Velocities and impulses of rigid bodies in contact, by Coulomb's law, all contacts together.

With M the masses, J the contacts' rows, u = J v + given their velocities and r their impulses,

    M (v - v_free) = J^T r,   u + mu |u_T| n in K*,   r in K,   r . (u + mu |u_T| n) = 0,   K: |r_T| <= mu r_N

(Moreau 1988; mu |u_T| n is De Saxce & Feng's (1998) correction, without which the cones are those of Anitescu 2006).
First Newton's method of cone_finish_kernels is tried from the guess: what rests is there. Else, compiled at the first
need, Mehrotra's interior-point method with Nesterov and Todd's scaling goes near the solution, the correction renewed
at every iteration (as Acary, Armand, Nguyen & Shpakovych 2023) and its derivative in the matrix, which is then not
symmetric. Where that does not get there, convex programs are solved, with the slips of the one before as corrections,
or none. Ties, stops, motors and friction of joints are more rows of J (bounded_rows_kernels).
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.linear.cones.cone_finish_kernels import (
    BALANCED,
    GOOD,
    LESS,
    LOOSE,
    OTHERWISE,
    SOLVED,
    accepted,
    finish,
    roughness,
)
from sceneql.linear.cones.cone_layout_kernels import (
    AT_B,
    AT_D,
    AT_DS,
    AT_DX,
    AT_FORCE,
    AT_FREE,
    AT_H,
    AT_HEAVY,
    AT_LAMBDA,
    AT_LEFT,
    AT_Q,
    AT_R,
    AT_S,
    AT_SIZE,
    AT_SLIDE,
    AT_SLIP,
    AT_SLOPE,
    AT_TORQUE,
    AT_V,
    AT_X,
    BALANCE,
    BODIES,
    BODIES_AT,
    BODY,
    CONTACT,
    CONTACTS,
    CONTACTS_AT,
    ITERATIONS,
    RESULT_AT,
    ROWS,
    advance_rows,
    aim_rows,
    begin_rows,
    center_rows,
    fastest_row,
    left_rows,
    scale_rows,
    spring_rows,
    turn_rows,
)
from sceneql.linear.cones.cone_points_kernels import aim, inner, scale, scaled, scaled_step, tail
from sceneql.linear.cones.cone_rows_kernels import (
    factor,
    fetch,
    keep,
    momenta_left,
    put,
    sizes,
    step,
    to_contacts,
)
from sceneql.system.signatures_kernels import A, F, I, N

MOST = 60
"""Iterations of the interior-point method."""
PATIENT, SURE, FALLS = 12, 10, 0.3
"""Iterations within which what is left must have fallen to half of its least: many bodies have a path to the solution
that stands still for some iterations and goes on; those of the convex program, whose solution is sure, after which it
must have fallen to this part. Else the method has come to a stop."""
CLOSE, CLOSED = 1e-6, 1e-12
"""What may be left, of the size of the numbers, when the finish is first tried, and where the method ends."""
FAIR = 1e-2
"""The same, up to which a solution in which nothing closes is better than that of the program without correction."""
NEAR, NEARLY = 1e-4, 1e-2
"""What is left from which the method aims at less of the complementarity than CENTERED, and how much."""
BACK = 0.99
"""Part of the step to the boundary of the cones."""
ROUNDS = 6
"""Most convex programs with the slips of the one before."""
SHORTEST = 1e-10
"""Part of a step below which the method has come to a stop."""
CENTERED = 0.1
"""Least part of the complementarity that a step aims at: the law is not convex, and long steps end at a boundary."""
COLD = 16
"""Most factorizations of the finish from an interior point."""


@lean(types.void(A, I, N))
def begin(floats, ints, follow):
    """The first point: springs of the contacts' effective masses in place of the cones, then moved into these."""
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        heavy = floats[c + AT_HEAVY]
        for j in range(3):
            put(floats, c + AT_H + 3 * j, 0.0, 0.0, 0.0)
            floats[c + AT_H + 4 * j] = heavy
            floats[c + AT_X + j] = 0.0
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for j in range(6):
            floats[at + AT_V + j] = floats[at + AT_FREE + j]
    to_contacts(floats, ints, AT_V, AT_S)
    if ints[ROWS] > 0:
        spring_rows(floats, ints)
    factor(floats, ints)
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        for j in range(3):
            floats[c + AT_DX + j] = -floats[c + AT_HEAVY] * (floats[c + AT_S + j] + floats[c + AT_B + j])
    step(floats, ints, 0)
    fastest = fastest_row(floats, ints) if ints[ROWS] > 0 else 0.0
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        size = 0.0
        for j in range(3):
            size += abs(floats[c + AT_S + j]) + abs(floats[c + AT_B + j])
            floats[c + AT_S + j] += floats[c + AT_B + j] + floats[c + AT_DS + j]
        fastest = max(fastest, size)
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for j in range(6):
            floats[at + AT_V + j] += floats[at + AT_D + j]
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        heavy = floats[c + AT_HEAVY]
        slip = tail(floats, c + AT_S)
        if follow == 1:
            floats[c + AT_SLIP] = slip
        floats[c + AT_S] += floats[c + AT_SLIP]
        for j in range(3):
            floats[c + AT_X + j] = -heavy * floats[c + AT_S + j]
        floats[c + AT_S] = max(floats[c + AT_S], slip) + fastest
        floats[c + AT_X] = max(floats[c + AT_X], heavy * slip) + heavy * fastest
    if ints[ROWS] > 0:
        begin_rows(floats, ints, fastest)


@lean(types.float64(A, I, N))
def direct(floats, ints, symmetric):
    """The direction D, DX, DS for the right hand sides LEFT, R and Q; the longest step along it, 1 at most."""
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        q, r = c + AT_Q, c + AT_R
        x, y, z = scaled(floats, c, floats[r], floats[r + 1], floats[r + 2], -1.0)
        put(floats, c + AT_DX, *scaled(floats, c, floats[q] + x, floats[q + 1] + y, floats[q + 2] + z, -1.0))
    if ints[ROWS] > 0:
        aim_rows(floats, ints)
    step(floats, ints, AT_LEFT)
    found = min(1.0, BACK * turn_rows(floats, ints)) if ints[ROWS] > 0 else 1.0
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        q, ds, slide = c + AT_Q, c + AT_DS, c + AT_SLIDE
        floats[c + AT_SLOPE] = 0.0
        if symmetric == 0:
            floats[c + AT_SLOPE] = floats[slide] * floats[ds + 1] + floats[slide + 1] * floats[ds + 2]
            floats[ds] += floats[c + AT_SLOPE]
        for j in range(3):
            floats[ds + j] -= floats[c + AT_R + j]
        x, y, z = scaled(floats, c, floats[ds], floats[ds + 1], floats[ds + 2], -1.0)
        put(floats, c + AT_DX, *scaled(floats, c, floats[q] - x, floats[q + 1] - y, floats[q + 2] - z, -1.0))
        found = min(found, BACK * scaled_step(floats, c))
    return found


@lean(types.float64(A, I, N))
def left(floats, ints, follow):
    """Write R and LEFT; what is left of all equations, the largest against the size of the numbers in it.

    Infinity where a number is none: `max` would pass over it.
    """
    momenta_left(floats, ints)
    worst = every = 0.0
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for j in range(6):
            size = floats[at + (AT_FORCE if j < 3 else AT_TORQUE)]
            worst = max(worst, abs(floats[at + AT_LEFT + j]) / max(size, 1e-300))
            every += floats[at + AT_LEFT + j]
    to_contacts(floats, ints, AT_V, AT_R)
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        for j in range(3):
            floats[c + AT_R + j] += floats[c + AT_B + j]
        slip = tail(floats, c + AT_R)
        if follow == 1:
            # s moves with the correction, so far as it stays in its cone: what grows is the gap, and not what is left.
            room = 0.5 * (floats[c + AT_S] - tail(floats, c + AT_S))
            floats[c + AT_S] += max(slip - floats[c + AT_SLIP], -room)
            floats[c + AT_SLIP] = slip
        by = 1.0 / slip if slip > 0.0 else 0.0
        floats[c + AT_SLIDE], floats[c + AT_SLIDE + 1] = by * floats[c + AT_R + 1], by * floats[c + AT_R + 2]
        floats[c + AT_R] += floats[c + AT_SLIP]
        size = floats[c + AT_SIZE] / roughness(floats, c)
        for j in range(3):
            floats[c + AT_R + j] = floats[c + AT_S + j] - floats[c + AT_R + j]
            worst = max(worst, abs(floats[c + AT_R + j]) / size)
        full = max(floats[c + AT_HEAVY] * roughness(floats, c) * size, floats[c + AT_X])
        gap = inner(floats, c + AT_X, c + AT_S) / (full * size)
        worst = max(worst, gap)
        every += gap + floats[c + AT_R] + floats[c + AT_R + 1] + floats[c + AT_R + 2]
    of_rows = left_rows(floats, ints) if ints[ROWS] > 0 else 0.0
    every += of_rows
    worst = max(worst, of_rows)
    return worst if abs(every) < math.inf else math.inf


@lean(types.float64(A, I, N, F))
def iterate(floats, ints, symmetric, least):
    """One iteration of the interior-point method; the part of the step that is taken, 0 where it cannot go on."""
    total = count = 0.0
    if ints[ROWS] > 0:
        total, count = scale_rows(floats, ints)
    count += ints[CONTACTS]
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        if not scale(floats, c):
            return 0.0
        total += inner(floats, c + AT_X, c + AT_S)
        if symmetric == 0:
            for j in range(0, 9, 3):
                for i in range(2):
                    floats[c + AT_H + j + 1 + i] += floats[c + AT_SLIDE + i] * floats[c + AT_H + j]
    if not factor(floats, ints):
        return 0.0
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        point = c + AT_LAMBDA
        put(floats, c + AT_Q, -floats[point], -floats[point + 1], -floats[point + 2])
    rest = 1.0 - direct(floats, ints, symmetric)
    centered = max(least, rest * rest * rest) * total / max(1.0, count)
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        aim(floats, c, centered)
    if ints[ROWS] > 0:
        center_rows(floats, ints, centered)
    part = direct(floats, ints, symmetric)
    if ints[ROWS] > 0:
        advance_rows(floats, ints, part)
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for j in range(6):
            floats[at + AT_V + j] += part * floats[at + AT_D + j]
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        for j in range(3):
            floats[c + AT_X + j] += part * floats[c + AT_DX + j]
            floats[c + AT_S + j] += part * floats[c + AT_DS + j]
        floats[c + AT_SLIP] += part * floats[c + AT_SLOPE]
    return part


@lean(types.boolean(A, I))
def fair(floats, ints):
    """Whether v and x, that were looked at, are better than what the program without correction gives."""
    closing = 0.0
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        closing = max(closing, roughness(floats, c) * (tail(floats, c + AT_S) - floats[c + AT_S]) / floats[c + AT_SIZE])
    return floats[ints[RESULT_AT] + BALANCE] <= FAIR and closing <= GOOD


@lean(types.int64(A, I, N))
def inside(floats, ints, follow):
    """The interior-point method, from its own first point; what the solution from there comes to.

    The correction follows the slip; or (``follow`` 0) it is what stands there, and the program is convex. Without any
    what slides comes off by mu |u_T| (Anitescu's cones), and nothing closes.
    """
    begin(floats, ints, follow)
    sizes(floats, ints)
    peak, best, tried, half, since = 0.0, math.inf, False, math.inf, 0
    for number in range(MOST):
        worst = left(floats, ints, follow)
        if not worst < math.inf:
            break
        if worst < best:
            keep(floats, ints)
            best = worst
        if worst <= CLOSED:
            break
        if worst <= CLOSE and not tried:
            if follow == 1 and finish(floats, ints, COLD, LESS):
                return SOLVED
            fetch(floats, ints)
            left(floats, ints, follow)
            tried = True
        if worst <= 0.5 * half:
            half, since = worst, number
        peak = max(peak, worst)
        if follow == 1 and number - since >= PATIENT:
            break
        if follow == 0 and number % SURE == 0:
            if number > SURE and worst > FALLS * peak:
                break
            peak = worst
        if iterate(floats, ints, 1 - follow, CENTERED if worst > NEAR else NEARLY) < SHORTEST:
            break
        ints[ITERATIONS] += 1
    floats[ints[RESULT_AT] + BALANCE] = math.inf
    if not best < math.inf:
        return LOOSE
    fetch(floats, ints)
    if finish(floats, ints, COLD, LESS):
        return SOLVED
    fetch(floats, ints)
    return BALANCED if accepted(floats, ints) else LOOSE


@lean(types.void(A, I, N))
def correct(floats, ints, follow):
    """Write the corrections: the slips of the velocities that are there, or none."""
    to_contacts(floats, ints, AT_V, AT_R)
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        for j in range(3):
            floats[c + AT_R + j] += floats[c + AT_B + j]
        floats[c + AT_SLIP] = tail(floats, c + AT_R) if follow == 1 else 0.0


@lean(types.int64(A, I))
def by_rounds(floats, ints):
    """Convex programs with the slips of the one before (De Saxce & Feng 1998), where one that follows them cycles."""
    for number in range(ROUNDS):
        correct(floats, ints, min(number, 1))
        found = inside(floats, ints, 0)
        if found != LOOSE:
            return found
    return LOOSE


@lean(OTHERWISE, inner=True)
def otherwise(floats, ints):
    """The solution where the finish does not get there from the guess; what it comes to."""
    found = inside(floats, ints, 1)
    if found == LOOSE and not fair(floats, ints):
        found = by_rounds(floats, ints)
        if found == LOOSE:
            correct(floats, ints, 0)
            found = inside(floats, ints, 0)
    return found
