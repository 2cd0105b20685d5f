# mypy: ignore-errors
"""The last digits of contact with friction: a semismooth Newton method on Coulomb's law itself.

x = P(x - rho (A v + b + mu |u_T| n)) with P the projection to the cone and M (v - v_free) = A^T x are solved as one
system by steps of the proximal method of multipliers (Rockafellar 1976; Alart & Curnier 1991): redundant contacts
share impulses near those of the guess. Where contacts slide, the matrix is not symmetric, as the law is not.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.cones.cone_layout_kernels import (
    AT_ARM_A,
    AT_ARM_B,
    AT_B,
    AT_D,
    AT_DS,
    AT_DX,
    AT_FORCE,
    AT_FRAME,
    AT_FRICTION,
    AT_GIVEN,
    AT_H,
    AT_HEAVY,
    AT_IMPULSE,
    AT_LAMBDA,
    AT_LEFT,
    AT_S,
    AT_SIZE,
    AT_TORQUE,
    AT_V,
    AT_VELOCITY,
    AT_X,
    BALANCE,
    BODIES,
    BODIES_AT,
    BODY,
    CONTACT,
    CONTACTS,
    CONTACTS_AT,
    FINISHES,
    ITERATIONS,
    OVERLAP,
    PAIR_A,
    PAIR_B,
    RESIDUAL,
    RESULT_AT,
    ROWS,
    TRIES,
    move_rows,
    open_rows,
    project_rows,
    see_rows,
)
from sceneql.linear.cones.cone_points_kernels import determinant, prepare, tail
from sceneql.linear.cones.cone_rows_kernels import (
    factor,
    fetch,
    in_world,
    keep,
    momenta_left,
    pair_of,
    point_speed,
    put,
    sizes,
    step,
    to_contacts,
    turned,
)
from sceneql.system.signatures_kernels import A, I, N

STIFF = 1e8
"""Stiffness of the proximal steps, of the contacts' effective masses (and as much more as their impulses are)."""
FULL, LESS = range(2)
"""How stiff a finish begins, so that errors of velocity do not open contacts that have impulses; all end with STIFF."""
POOR = 2
"""Most steps that do not take what is left to 0.3 of its least."""
EXACT = 5e-15
"""What may be left at most, of the sizes of numbers, to need no further step."""
ENOUGH = 1e-12
"""What is taken for rounding where further steps make it no smaller."""
SOLVED, BALANCED, LOOSE = range(3)
"""What a solution comes to: to rounding; all velocities in their cones and all power balanced to GOOD, where slips or
forces next to nothing leave open which case of the law holds; or neither, as where contacts ask for what cannot be, or
the method finds no way to a solution that is there: then RESULT tells what is left."""

GOOD = 1e-9
"""What may be left with contacts' power in place of their law (`see`) in a solution: contacts whose
slip or force is next to nothing are at the edge of sticking, sliding or leaving, where the law itself is ill-posed."""
FAIR = 1e-7
"""The same where the last method, too, comes no nearer, as of what rests on more contacts than hold it."""
OTHERWISE = types.int64(A, I)
otherwise = lazy("sceneql.linear.cones.cone_kernels:otherwise", OTHERWISE)


@lean_inlined
def roughness(floats, c):
    """The coefficient of friction, 1 where there is none."""
    return floats[c + AT_FRICTION] if floats[c + AT_FRICTION] > 0.0 else 1.0


@lean_inlined
def see(floats, c):
    """Write the velocity s of a contact, corrected by its slip, from that in its frame; what is left of the law.

    Once of the case that holds best, and once of the cones and of the power alone, which it is the square of where a
    contact is at the edge of two cases.
    """
    x, s, mu = c + AT_X, c + AT_S, roughness(floats, c)
    for j in range(3):
        floats[s + j] += floats[c + AT_B + j]
    normal, slip, rubbed = floats[s], tail(floats, s), tail(floats, x)
    floats[s] = normal + slip
    size = floats[c + AT_SIZE]
    push = mu * floats[c + AT_HEAVY] * size
    full = max(floats[x], push)
    # Resting, open, sliding: the law holds by the best of the three.
    resting = max(mu * abs(normal), slip) / size
    opened = max(abs(floats[x]), rubbed) / push
    sliding = mu * abs(normal) / size
    if slip > 0.0:
        by = floats[x] / slip
        across = math.hypot(floats[x + 1] + by * floats[s + 1], floats[x + 2] + by * floats[s + 2])
        sliding = max(sliding, across / full)
    worst = min(resting, min(opened, sliding))
    out = max(-mu * normal / size, (rubbed - floats[x]) / full)
    power = floats[x] * floats[s] + floats[x + 1] * floats[s + 1] + floats[x + 2] * floats[s + 2]
    return max(worst, out), max(abs(power) / (full * size), out)


@lean_inlined
def project(floats, c, stiff):
    """Write P(x - rho s) to LAMBDA and rho times its derivative to H."""
    x, s, h, to, mu = c + AT_X, c + AT_S, c + AT_H, c + AT_LAMBDA, roughness(floats, c)
    push = mu * floats[c + AT_HEAVY]
    rho = stiff * push * max(1.0, max(abs(floats[x]), tail(floats, x)) / (push * floats[c + AT_SIZE]))
    slip = tail(floats, s)
    normal = floats[s] - slip
    p, q, r = floats[x] - rho * floats[s], floats[x + 1] - rho * floats[s + 1], floats[x + 2] - rho * floats[s + 2]
    length = math.sqrt(q * q + r * r)
    for j in range(9):
        floats[h + j] = 0.0
    if p >= length:
        # At rest, where the correction is nothing: the point is where no velocity is left.
        put(floats, to, floats[x] - rho * normal, q, r)
        floats[h] = floats[h + 4] = floats[h + 8] = rho
        return
    above = p + length
    if p < 0.0:
        # |p_T|^2 - p^2 of terms that do not cancel.
        cross = floats[x] * floats[s] - floats[x + 1] * floats[s + 1] - floats[x + 2] * floats[s + 2]
        above = (2.0 * rho * cross - determinant(floats, x) - rho * rho * normal * (normal + 2.0 * slip)) / (length - p)
    if above <= 0.0:
        put(floats, to, 0.0, 0.0, 0.0)
        return
    u, v = q / length, r / length
    put(floats, to, 0.5 * above, 0.5 * above * u, 0.5 * above * v)
    half, turn = 0.5 * rho, 0.5 * rho * above / length
    put(floats, h, half, half * u, half * v)
    put(floats, h + 3, half * u, half * u * u + turn * v * v, (half - turn) * u * v)
    put(floats, h + 6, half * v, (half - turn) * u * v, half * v * v + turn * u * u)
    if slip > 0.0:
        d, e = floats[s + 1] / slip, floats[s + 2] / slip
        for j in range(0, 9, 3):
            floats[h + j + 1] += d * floats[h + j]
            floats[h + j + 2] += e * floats[h + j]


@lean(types.float64(A, I))
def look(floats, ints):
    """Write LEFT and all s; what is left of all equations, the largest against the size of the numbers in it.

    Infinity where a number is none: `max` would pass over it. What is left with each contact's power in place of its
    case is among what is found.
    """
    momenta_left(floats, ints)
    sizes(floats, ints)
    worst = every = 0.0
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for j in range(6):
            size = floats[at + (AT_FORCE if j < 3 else AT_TORQUE)]
            worst = max(worst, abs(floats[at + AT_LEFT + j]) / max(size, 1e-300))
            every += floats[at + AT_LEFT + j]
    least = worst
    to_contacts(floats, ints, AT_V, AT_S)
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        case, power = see(floats, c)
        worst, least = max(worst, case), max(least, power)
        for j in range(3):
            every += floats[c + AT_X + j] + floats[c + AT_S + j]
    if ints[ROWS] > 0:
        case, power = see_rows(floats, ints)
        worst, least = max(worst, case), max(least, power)
    if not abs(every) < math.inf:
        worst = least = math.inf
    floats[ints[RESULT_AT] + RESIDUAL], floats[ints[RESULT_AT] + BALANCE] = worst, least
    return worst


@lean(types.boolean(A, I, N, N))
def finish(floats, ints, most, near):
    """Newton's steps from v and x to the solution, ``most`` at most, ``near``: how stiff; whether it is found."""
    before, best, poor = math.inf, math.inf, 0
    for number in range(most + 1):
        worst = look(floats, ints)
        if worst <= EXACT or (worst <= ENOUGH and worst > 0.5 * before):
            return True
        if worst > 0.3 * best:
            poor += 1
        if number == most or poor > POOR or not worst < math.inf:
            return worst <= ENOUGH
        before, best = worst, min(best, worst)
        stiff = STIFF
        if near == LESS:
            stiff = min(STIFF, max(1e-2 / worst, 1e2))
        for k in range(ints[CONTACTS]):
            project(floats, ints[CONTACTS_AT] + CONTACT * k, stiff)
        if ints[ROWS] > 0:
            project_rows(floats, ints, stiff)
        ints[FINISHES] += 1
        if not factor(floats, ints):
            return False
        for k in range(ints[CONTACTS]):
            c = ints[CONTACTS_AT] + CONTACT * k
            for j in range(3):
                floats[c + AT_DX + j] = floats[c + AT_LAMBDA + j] - floats[c + AT_X + j]
        step(floats, ints, AT_LEFT)
        for body in range(ints[BODIES]):
            at = ints[BODIES_AT] + BODY * body
            for j in range(6):
                floats[at + AT_V + j] += floats[at + AT_D + j]
        for k in range(ints[CONTACTS]):
            c = ints[CONTACTS_AT] + CONTACT * k
            ds = c + AT_DS
            x, y, z = turned(floats, c + AT_H, floats[ds], floats[ds + 1], floats[ds + 2])
            floats[c + AT_X] += floats[c + AT_DX] - x
            floats[c + AT_X + 1] += floats[c + AT_DX + 1] - y
            floats[c + AT_X + 2] += floats[c + AT_DX + 2] - z
        if ints[ROWS] > 0:
            move_rows(floats, ints)
    return False


@lean(types.void(A, I))
def tell(floats, ints):
    """Write impulses and velocities of the contacts in the world, and how fast one still closes."""
    look(floats, ints)
    closing = open_rows(floats, ints) if ints[ROWS] > 0 else 0.0
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        x, s = c + AT_X, c + AT_S
        pair, given = pair_of(ints, k), c + AT_GIVEN
        ax, ay, az = point_speed(floats, ints, ints[pair + PAIR_A], AT_V, c + AT_ARM_A)
        bx, by, bz = point_speed(floats, ints, ints[pair + PAIR_B], AT_V, c + AT_ARM_B)
        ax, ay, az = ax + floats[given], ay + floats[given + 1], az + floats[given + 2]
        put(floats, c + AT_VELOCITY, ax - bx, ay - by, az - bz)
        put(floats, c + AT_IMPULSE, *in_world(floats, c + AT_FRAME, floats[x], floats[x + 1], floats[x + 2]))
        closing = max(closing, roughness(floats, c) * (tail(floats, s) - floats[s]))
    floats[ints[RESULT_AT] + OVERLAP] = closing


@lean(types.boolean(A, I))
def accepted(floats, ints):
    """Whether v and x are the solution but for the least of slips."""
    look(floats, ints)
    return floats[ints[RESULT_AT] + BALANCE] <= GOOD


@lean(types.int64(A, I))
def solve(floats, ints):
    """Solve a program, whose given numbers are written, from the guesses of velocities and impulses in it."""
    ints[ITERATIONS], ints[FINISHES] = 0, 0
    prepare(floats, ints)
    keep(floats, ints)
    found = SOLVED
    if not finish(floats, ints, ints[TRIES], FULL):
        fetch(floats, ints)
        found = BALANCED if accepted(floats, ints) else otherwise(floats, ints)
    tell(floats, ints)
    if found == LOOSE and floats[ints[RESULT_AT] + BALANCE] <= FAIR:
        return BALANCED
    return found
