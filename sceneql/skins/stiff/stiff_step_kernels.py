# mypy: ignore-errors
"""A step of an additive Runge-Kutta pair (flows/schemes/additive_kernels) in which skins are implicit, too.

Where closed lines are stiff, the tensions T of their sides are unknowns of each stage i, a = h d_ii: X = X* + a J u, u
- a P L u = P (u* + a S E (T, X)), T by the law of lengths l(X), with X*, u* what is known, E the pulls of sides at
their ends, also by bending, and S and J what spreads and reads at the latest X. Newton's updates solve (1 - a^2 R' B' J
G S B R) z = R' w for changes R z of tensions and couples (stiff_roots_kernels), w how far sides are longer than their
tensions say and turned from where they pulled, B the pulls by a unit of them, G one solve of viscosity; where tensions
and bending bear the step couples are left out, and directions follow by themselves. By conjugate gradients; their
preconditioner is Cholesky's factor of that matrix as it was (stiff_matrix_kernels), found anew for each step and where
they have become slow. No residual is a stiffness times a length, and what is held is what pulled, so that errors of
places do not become forces; between steps it goes on, and vertices that are moved to keep an area do not change them.
Source: Ceniceros, Fisher & Roma (2009), J. Comput. Phys. 228, 7137-7158, for implicit skins.

``numbers``: as there, then the integers of lines (stiff_lines_kernels), and where these begin.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.compiled.vectors_kernels import same
from sceneql.flows.layout import AT, CHANGE, FACES, RATE, SKIP, VELOCITY, WORK
from sceneql.flows.projection_kernels import project
from sceneql.flows.schemes.additive_kernels import (
    AXES,
    BLOCKS,
    EXACT,
    FINE,
    FLOW_AT,
    HEAD,
    OPERATORS,
    ROUNDING,
    SHARE,
    STAGES,
    TABLES_AT,
    implicit,
    product,
    quiet,
    worst_error,
)
from sceneql.flows.schemes.operators_kernels import OPERATOR, solve, spread, tally
from sceneql.grids.multigrid.stencil_kernels import dot
from sceneql.skins.stiff.stiff_lines_kernels import (
    SIDES,
    apart,
    by_law,
    directions,
    hand_over,
    hold,
    missing,
    move,
    places,
    pull,
    pulls,
    read,
    shortest,
    steep,
    strained,
)
from sceneql.skins.stiff.stiff_matrix_kernels import (
    MATRIX_ROOM,
    PAIRS,
    by_one_answer,
    factor,
    poke,
    substitute,
)
from sceneql.skins.stiff.stiff_mixing_kernels import GRAM, PAST, mix, remember
from sceneql.skins.stiff.stiff_roots_kernels import between_roots, by_roots, by_roots_across, find_roots, in_parts
from sceneql.system.signatures_kernels import STEP, A, F, I, N

MOST, CLOSE, FAR = 30, 1e-5, 10.0
"""Newton's updates of a stage; what may be left, in parts of sides, and what is left of those that lead nowhere."""
FINEST, SLOW, PART = 1e-9, 0.3, 0.1
"""What is as good as nothing, in parts of sides; what is left of what was before, from which on updates are mixed; part
of the tolerance that velocities may be off by places that are."""
SEARCHES, ENOUGH, FEW = 40, 0.03, 3
"""Iterations for an update, and what they leave; more than so many wear the preconditioner out."""
BAD, QUICK = 12, 0.02
"""Iterations with a factor just found by the answer to one force, beyond which that is poor; the time it takes, in
parts of that by the answer to each tension."""
HAS, WORN, BEGIN, BEGUN, POOR, ANEW, ACROSS, ROOM = range(8)
STATE = ROOM + 2 * PAIRS
"""Of what goes on between steps: 1 where there is a factor; iterations beyond FEW since it was found; the start of the
latest step [s]; 1 after a step has begun; 1 where the answer to one force makes a poor factor; 1 where
tensions begin by the law, whatever they were; 1 where couples are unknowns, too."""
TENSIONS, ALONG, SIZES, SPEEDS, MOVED, AT_START, AT_END, LEFT, FOUND, P, Z, Q, ROOTS, CHANGES, PULLS, HERE, BESIDE = (
    0, 1, 3, 4, 6, 8, 11, 14, 16, 18, 20, 22, 24, 28, 30, 32, 34,
)  # fmt: skip
ROWS = BESIDE + MATRIX_ROOM + PAST
"""Places of what belongs to sides, in numbers a side; numbers a side besides the matrix."""
STEEP = 0.1
"""Of a stage's time squared how fast tension and bending turn a line in cells, squared, from which on couples are
unknowns."""


@lean(types.boolean(F, A, A, A, A, A, I), inner=True)
def give_way(a, source, answer, room, floats, tables, numbers):
    """answer: the velocities that a fluid has after a time a, by the change of velocities ``source``."""
    one = numbers[numbers[FLOW_AT] :]
    solved = project(source, CHANGE, floats, one)
    for k in range(one[AT], one[AT] + one[FACES]):
        answer[k] = source[k]
    for number in range(numbers[AXES]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        solved &= solve(op, a, source, answer, FINE, floats, tables, floats[one[WORK] :], room)
    return solved and project(answer, CHANGE, floats, one)


@lean(types.boolean(F, N, N, A, A, A, A, A, A, A, A, A, I, I), inner=True)
def reply(a, alongs, acrosses, x, out, y, source, answer, skins, room, floats, tables, numbers, lines):
    """out: x + a R' w, w how fast vertices at places in y, which move at SPEEDS then, have sides become shorter and
    turn back by R x that acts for a time a."""
    one, sides = numbers[numbers[FLOW_AT] :], lines[SIDES]
    roots, along, sizes = skins[ROOTS * sides :], skins[ALONG * sides :], skins[SIZES * sides :]
    changes, parts, speeds = skins[CHANGES * sides :], skins[PULLS * sides :], skins[SPEEDS * sides :]
    for k in range(one[AT], one[AT] + one[FACES]):
        source[k] = 0.0
    by_roots(x, alongs, acrosses, roots, changes, lines)
    in_parts(changes, along, sizes, parts, floats, lines)
    pull(parts, a, y, source, floats, lines, one)
    solved = give_way(a, source, answer, room, floats, tables, numbers)
    read(answer, y, speeds, floats, lines, one)
    strained(speeds, along, sizes, changes, lines)
    by_roots_across(changes, alongs, acrosses, roots, out, lines)
    for k in range(alongs + acrosses):
        out[k] = x[k] - a * out[k]
    return solved


@lean(types.boolean(F, N, N, A, A, A, A, A, A, A, A, A, A, I, I), inner=True)
def precondition(
    a, alongs, acrosses, y, source, answer, skins, matrix, room, more, state, floats, tables, numbers, lines
):  # fmt: skip
    """Cholesky's factor of the matrix of a stage, by the answer to one force, or where that is poor to each unknown."""
    one, sides, n, unknowns = numbers[numbers[FLOW_AT] :], lines[SIDES], y.size, alongs + acrosses
    along, sizes, roots = skins[ALONG * sides :], skins[SIZES * sides :], skins[ROOTS * sides :]
    unit, found = skins[FOUND * sides :], skins[Q * sides :]
    solved = True
    if state[POOR] == 0.0:
        for component in range(2):
            poke(component, a, source, floats, lines, one)
            poked = more[component * n : (component + 1) * n]
            solved &= give_way(a, source, poked, room, floats, tables, numbers)
        solved &= by_one_answer(
            a, along, sizes, y, alongs, acrosses, more[:n], more[n : 2 * n], skins[BESIDE * sides :], state[ROOM:],
            matrix, floats, lines, one,
        )  # fmt: skip
        between_roots(matrix, alongs, acrosses, unknowns, roots, lines)
        if solved and factor(matrix, unknowns):
            state[HAS], state[WORN] = 1.0, 0.0
            return True
        state[POOR] = 1.0
    for s in range(unknowns):
        for r in range(unknowns):
            unit[r] = 1.0 if r == s else 0.0
        solved &= reply(
            a, alongs, acrosses, unit, found, y, source, answer, skins, room, floats, tables, numbers, lines
        )
        for r in range(unknowns):
            matrix[unknowns * s + r] = found[r]
    state[HAS], state[WORN] = 1.0, 0.0
    return solved and factor(matrix, unknowns)


@lean(types.boolean(F, F, F, F, A, A, A, A, A, A, A, A, I, I), inner=True)
def by_tensions(a, exact, rounded, fine, wanted, y, room, more, skins, state, floats, tables, numbers, lines):
    """Solve a stage in y, from the vertices there and the tensions that ``skins`` begins with. Whether it was.

    ``fine``: how far places may be off, in parts of sides; 0 where that is not known yet.
    """
    n, sides = y.size, lines[SIDES]
    tensions, along, sizes = skins[:sides], skins[ALONG * sides :], skins[SIZES * sides : (SIZES + 1) * sides]
    speeds, moved, strains = skins[SPEEDS * sides :], skins[MOVED * sides :], skins[LEFT * sides :]
    roots, changes, parts = skins[ROOTS * sides :], skins[CHANGES * sides :], skins[PULLS * sides :]
    past = skins[(BESIDE + MATRIX_ROOM) * sides :]
    matrix, beyond = skins[ROWS * sides + GRAM :], skins[(ROWS + 4 * sides) * sides + GRAM :]
    source, answer = beyond[:n], beyond[n : 2 * n]
    one = numbers[numbers[FLOW_AT] :]
    first, last = one[AT], one[AT] + one[FACES]
    before = math.inf
    for turn in range(MOST):
        directions(y, along, sizes, lines)
        pulls(y, tensions, along, parts, floats, lines)
        for k in range(n):
            source[k] = wanted[k]
        pull(parts, a, y, source, floats, lines, one)
        solved = project(source, VELOCITY, floats, one)
        for k in range(first, last):
            y[k] = source[k]
        solved &= implicit(a, exact, rounded, source, y, room, more, floats, tables, numbers)
        if not solved:
            return False
        read(y, y, speeds, floats, lines, one)
        move(speeds, a, wanted, answer, lines)
        most = max(missing(answer, tensions, along, strains, floats, lines), apart(y, answer, floats, lines))
        slow, before = most > SLOW * before, most
        if not most < FAR:
            return False
        if turn > 0 and most < (CLOSE if fine == 0.0 or turn == MOST - 1 else max(min(fine, CLOSE), FINEST)):
            move(speeds, a, wanted, y, lines)
            return True
        if state[ACROSS] == 0.0 and a * a * steep(tensions, floats, lines) > STEEP:
            state[ACROSS], state[HAS] = 1.0, 0.0
        find_roots(y, tensions, sizes, roots, floats, lines)
        alongs, acrosses = sides, (sides if state[ACROSS] == 1.0 else 0)
        unknowns = alongs + acrosses
        left, change = skins[LEFT * sides : LEFT * sides + unknowns], skins[FOUND * sides : FOUND * sides + unknowns]
        p, q = skins[P * sides : P * sides + unknowns], skins[Q * sides : Q * sides + unknowns]
        z = skins[Z * sides : Z * sides + unknowns]
        fresh = state[HAS] == 0.0
        if fresh:
            solved = precondition(
                a, alongs, acrosses, y, source, answer, skins, matrix, room, more, state, floats, tables, numbers, lines
            )
            if not solved:
                return False
        by_roots_across(strains, alongs, acrosses, roots, left, lines)
        for s in range(2 * sides):
            moved[s] = 0.0
        substitute(matrix, unknowns, left, z)
        for s in range(unknowns):
            change[s], p[s] = 0.0, z[s]
        now, target = dot(left, z), ENOUGH * ENOUGH * dot(left, left)
        count = 0
        while dot(left, left) > target and count < SEARCHES:
            if not reply(a, alongs, acrosses, p, q, y, source, answer, skins, room, floats, tables, numbers, lines):
                return False
            length = now / dot(p, q)
            for s in range(unknowns):
                change[s] += length * p[s]
                left[s] -= length * q[s]
            for s in range(2 * sides):
                moved[s] += length * speeds[s]
            substitute(matrix, unknowns, left, z)
            earlier, now, count = now, dot(left, z), count + 1
            for s in range(unknowns):
                p[s] = z[s] + now / earlier * p[s]
        state[WORN] += max(count - FEW, 0)
        if fresh and count > BAD and state[POOR] == 0.0:
            state[POOR], state[HAS] = 1.0, 0.0
        if state[WORN] > (sides if state[POOR] == 1.0 else QUICK * sides) or count == SEARCHES:
            state[HAS] = 0.0
        by_roots(change, alongs, acrosses, roots, changes, lines)
        for s in range(sides):
            tensions[s] += changes[s]
        here = skins[HERE * sides :]
        places(y, here, lines)
        move(moved, a, answer, y, lines)
        remember(turn, here, y, tensions, past, lines)
        if slow and turn > 0:
            mix(turn, y, tensions, past, lines)
    return False


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; its error by the embedded method."""
    n, s = y0.size, numbers[STAGES]
    lines = numbers[numbers[numbers.size - 1] :]
    sides, state = lines[SIDES], work[(13 + 2 * s) * n : (13 + 2 * s) * n + STATE]
    skins = work[(13 + 2 * s) * n + STATE :]
    tensions, along, parts = skins[:sides], skins[ALONG * sides :], skins[PULLS * sides :]
    at_start, at_end, sizes_of = skins[AT_START * sides :], skins[AT_END * sides :], skins[SIZES * sides :]
    rate1, end, end_rate = work[:n], work[n : 2 * n], work[2 * n : 3 * n]
    wanted, spreading, room, more = work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 9 * n], work[9 * n : 13 * n]
    explicit, damped = work[13 * n : (13 + s) * n], work[(13 + s) * n : (13 + 2 * s) * n]
    e, d = settings[: s * s], settings[s * s : 2 * s * s]
    b, wrong, nodes = settings[2 * s * s :], settings[2 * s * s + s :], settings[2 * s * s + 2 * s :]
    latest, tables, velocities = numbers[TABLES_AT] - 1, settings[numbers[TABLES_AT] :], numbers[AXES]
    tolerance, sizes = settings[2 * s * s + 3 * s], settings[2 * s * s + 3 * s + 1 :]
    one = numbers[numbers[FLOW_AT] :]
    rate = rate_at(functions[AT_RATE])
    first, last = one[AT], one[AT] + one[FACES]
    floats[one[SKIP]] = 1.0
    solved, goes_on = True, settings[latest] == t and same(y0, end)
    settings[latest - 1] = 1.0 if goes_on else 0.0
    if state[ANEW] == 0.0 and settings[latest] == t and (goes_on or floats[channels.SETTLED] != 0.0):
        for k in range(3 * sides):
            at_start[k] = at_end[k]
    elif not (state[BEGUN] == 1.0 and state[BEGIN] == t):
        by_law(y0, at_start, floats, lines)
        directions(y0, along, sizes_of, lines)
        pulls(y0, at_start, along, at_start[sides:], floats, lines)
    state[BEGUN], state[BEGIN], state[ANEW] = 1.0, t, 0.0
    across = state[ACROSS]
    longest = h * d[s * s - 1]
    state[ACROSS] = 1.0 if longest * longest * steep(at_start, floats, lines) > STEEP else 0.0
    if across != state[ACROSS]:
        state[HAS] = 0.0
    for k in range(sides):
        tensions[k] = at_start[k]
    for k in range(2 * sides):
        parts[k] = at_start[sides + k]
    hold(parts, floats, lines)
    fine = 0.0
    for block in range(numbers[BLOCKS]):
        if numbers[numbers[FLOW_AT] - 2 * numbers[BLOCKS] + 2 * block] == first:
            fine = PART * tolerance * sizes[block] / shortest(floats, lines)
    if state[POOR] == 0.0:  # vertices have moved on: the factor takes less time than iterations with the one before
        state[HAS] = 0.0
    for i in range(s):
        own, mine = explicit[i * n : (i + 1) * n], damped[i * n : (i + 1) * n]
        if i == 0:
            for k in range(n):
                y1[k] = y0[k]
        else:
            for k in range(n):
                total = 0.0
                for j in range(i):
                    total += e[i * s + j] * explicit[j * n + k] + d[i * s + j] * damped[j * n + k]
                wanted[k] = y0[k] + h * total
            rounded = ROUNDING**2 * product(velocities, wanted, wanted, floats, numbers)
            solved &= project(wanted, VELOCITY, floats, one)
            for k in range(n):
                y1[k] = wanted[k]
            a, exact = h * d[i * s + i], max(EXACT, SHARE * tolerance)
            for k in range(n):  # vertices go on from where they were as they went
                y1[k] += a * damped[(i - 1) * n + k] if not first <= k < last else 0.0
            solved = solved and by_tensions(
                a, exact, rounded, a * fine, wanted, y1, room, more, skins, state, floats, tables, numbers, lines
            )
            hold(parts, floats, lines)
        rate(t + nodes[i] * h, y1, own, floats, ints)
        for k in range(n):
            mine[k] = 0.0
        spread(y1, mine, velocities, numbers[OPERATORS], floats, numbers)
        for k in range(n):
            own[k] -= mine[k]
        for k in range(n):
            wanted[k] = 0.0
        pull(parts, 1.0, y1, wanted, floats, lines, one)
        for k in range(first, last):
            own[k] -= wanted[k]
        spread(y1, mine, 0, velocities, floats, numbers)
        for k in range(first, last):
            mine[k] += wanted[k]
        hand_over(own, mine, lines)
    for k in range(sides):
        at_end[k] = tensions[k]
    for k in range(2 * sides):
        at_end[sides + k] = parts[k]
    for k in range(n):
        end[k] = y1[k]
        total = error = beyond = 0.0
        for j in range(s):
            both = explicit[j * n + k] + damped[j * n + k]
            total += b[j] * both
            error += wrong[j] * both
            beyond += (b[j] - e[(s - 1) * s + j]) * explicit[j * n + k]
        y1[k] = y1[k] + h * beyond if first <= k < last else y0[k] + h * total
        wanted[k] = h * error
    solved &= project(y1, VELOCITY, floats, one) and project(wanted, CHANGE, floats, one)
    solved &= quiet(h * d[s * s - 1], max(EXACT, SHARE * tolerance), end, y1, room, more, floats, tables, numbers)
    solved &= project(y1, VELOCITY, floats, one)
    for number in range(numbers[OPERATORS]):
        tally(numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)], y0, y1, floats)
    rate(t + h, y1, end_rate, floats, ints)
    floats[one[SKIP]] = 0.0
    for k in range(n):
        end[k], spreading[k] = y1[k], 0.0
    spread(y1, spreading, 0, velocities, floats, numbers)
    for k in range(n):
        rate1[k] = end_rate[k] + spreading[k]
    settings[latest] = t + h
    if not (project(rate1, RATE, floats, one) and solved):
        y1[one[AT]] = math.nan
    return worst_error(wanted, y0, y1, tolerance, sizes, numbers)
