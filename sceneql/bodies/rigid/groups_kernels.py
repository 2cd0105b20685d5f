# mypy: ignore-errors
"""Rigid bodies by groups: those that touch one another, or that ties hold, through bodies that move: solved together.

What stands connects nothing. Every group is a cone program of its own (linear/cones), planned for its pairs.
"""

import numpy as np
from numba import types

import sceneql.bodies.rigid.point_list as points
import sceneql.linear.cones.cone_layout_kernels as rows
from sceneql.bodies.rigid.point_list import BODY_A, BODY_B, WHERE, WHO
from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.linear.cones.cone_finish_kernels import LOOSE, solve
from sceneql.linear.cones.cone_layout_kernels import ROW, ROW_HIGH, ROW_LOW, lay_out
from sceneql.system.signatures_kernels import A, F, I, N

MASS = 10
"""Floats of a body: its mass, its inertia in the world's axes (3, 3)."""


@lean_inlined
def root_of(leader, k):
    """The first body of the group of a body, by leaders."""
    while leader[k] != k:
        leader[k] = leader[leader[k]]
        k = leader[k]
    return k


@lean_inlined
def acts(bounded, k):
    """Whether a bounded row has an impulse that is to be found."""
    return bounded[ROW * k + ROW_HIGH] > bounded[ROW * k + ROW_LOW]


@lean(N(N, N, I, N, A, I, I, I, I, I, I), inner=True)
def grouped(n, every, who, contacts, bounded, sides, leader, of_group, bodies, first_body, order):
    """The number of groups of bodies; whose those of a group stand in a row, as its contacts do.

    Writes each body's group (-1: nothing acts on it), the bodies by group, where each group's begin (every + 1,), and
    the contacts by group, in order. ``leader`` is scratch.
    """
    for k in range(every):
        leader[k], of_group[k] = k, -1
    for k in range(sides.size // 2):
        a, b = sides[2 * k], sides[2 * k + 1]
        if a >= 0 and acts(bounded, k):
            of_group[a] = 0
            if b >= 0:
                of_group[b] = 0
                a, b = root_of(leader, a), root_of(leader, b)
                leader[max(a, b)] = min(a, b)
    for k in range(contacts):
        a, b = who[WHO * k + BODY_A], who[WHO * k + BODY_B]
        of_group[a] = 0
        if b < n:
            of_group[b] = 0
            a, b = root_of(leader, a), root_of(leader, b)
            leader[max(a, b)] = min(a, b)
    groups = 0
    for k in range(every):
        if of_group[k] >= 0:
            root = root_of(leader, k)
            if root == k:
                of_group[k], first_body[groups] = groups, 0
                groups += 1
            else:
                of_group[k] = of_group[root]
            first_body[of_group[k]] += 1
    at = 0
    for g in range(groups):
        first_body[g], at = at, at + first_body[g]
    first_body[groups] = at
    for k in range(every):
        if of_group[k] >= 0:
            bodies[first_body[of_group[k]]] = k
            first_body[of_group[k]] += 1
    # `leader`: now how many contacts each group has, then where the next one stands.
    for g in range(groups, 0, -1):
        first_body[g] = first_body[g - 1]
    first_body[0] = 0
    for g in range(groups):
        leader[g] = 0
    for k in range(contacts):
        leader[of_group[who[WHO * k + BODY_A]]] += 1
    at = 0
    for g in range(groups):
        leader[g], at = at, at + leader[g]
    for k in range(contacts):
        g = of_group[who[WHO * k + BODY_A]]
        order[leader[g]] = k
        leader[g] += 1
    return groups


@lean(types.void(A, N, A, N, F), inner=True)
def write_contact(where, at, program, c, friction):
    """Write a point as a contact of the program."""
    for j in range(3):
        program[c + rows.AT_NORMAL + j] = where[at + points.AT_NORMAL + j]
        program[c + rows.AT_ARM_A + j] = where[at + points.AT_ARM_A + j]
        program[c + rows.AT_ARM_B + j] = where[at + points.AT_ARM_B + j]
        program[c + rows.AT_GIVEN + j] = where[at + points.AT_GIVEN] * where[at + points.AT_NORMAL + j]
        program[c + rows.AT_GIVEN + j] -= where[at + points.AT_LED + j]
        program[c + rows.AT_IMPULSE + j] = where[at + points.AT_PUSH + j]
    program[c + rows.AT_FRICTION] = friction


@kernel(N(N, N, I, A, N, A, A, A, F, A, I), inner=True)
def solve_groups(n, every, who, where, contacts, masses, free, found, friction, bounded, sides):
    """Write the velocities with contacts of all bodies to ``found`` (every, 6), the impulses to ``where``, ``bounded``.

    These hold guesses before. The first n are those of the shapes that move, which contacts name. ``masses`` (every,
    MASS), ``free`` (every, 6): the velocities without impulses; ``bounded`` (rows, ROW): bounded_rows_kernels, and
    ``sides`` (rows, 2) the bodies of each row, -1 for one that is fixed or led (both: a row of none). The number of
    groups that were not solved.
    """
    leader, of_group, bodies, slot = filled(every, 0), filled(every, 0), filled(every, 0), filled(every, -1)
    first_body, order = filled(every + 1, 0), filled(contacts, 0)
    groups = grouped(n, every, who, contacts, bounded, sides, leader, of_group, bodies, first_body, order)
    count_rows = sides.size // 2
    for k in range(first_body[groups]):
        slot[bodies[k]] = k
    contacts_at = rows.BODY * first_body[groups]
    rows_at = contacts_at + rows.CONTACT * contacts
    scratch_at = rows_at + ROW * count_rows
    program = np.empty(scratch_at)
    for k in range(first_body[groups]):
        at, body = rows.BODY * k, bodies[k]
        for c in range(MASS):
            program[at + rows.AT_MASS + c] = masses[MASS * body + c]
        for c in range(6):
            program[at + rows.AT_FREE + c] = free[6 * body + c]
            program[at + rows.AT_V + c] = found[6 * body + c]
    for k in range(contacts):
        write_contact(where, WHERE * order[k], program, contacts_at + rows.CONTACT * k, friction)
    loose, begin = 0, 0
    pairs, of_contact, of_row = filled(2 * (contacts + count_rows), 0), filled(contacts, 0), filled(count_rows, 0)
    place_of_row, placed = filled(count_rows, -1), 0
    for g in range(groups):
        end, count, first, first_row = leader[g], 0, first_body[g], placed
        for k in range(begin, end):
            w = WHO * order[k]
            a, b = who[w + BODY_A], who[w + BODY_B]
            before = WHO * order[max(k - 1, begin)]
            if k == begin or who[before + BODY_A] != a or who[before + BODY_B] != b:
                pairs[2 * count] = slot[a] - first
                pairs[2 * count + 1] = slot[b] - first if b < n else -1
                count += 1
            of_contact[k] = count - 1
        before_a = before_b = -2
        for k in range(count_rows):
            a, b = sides[2 * k], sides[2 * k + 1]
            if a < 0 or of_group[a] != g or not acts(bounded, k):
                continue
            if a != before_a or b != before_b:
                pairs[2 * count] = slot[a] - first
                pairs[2 * count + 1] = slot[b] - first if b >= 0 else -1
                count += 1
                before_a, before_b = a, b
            of_row[placed], place_of_row[k] = count - 1, placed
            for c in range(ROW):
                program[rows_at + ROW * placed + c] = bounded[ROW * k + c]
            placed += 1
        own_at = contacts_at + rows.CONTACT * begin
        ints, needed = lay_out(
            first_body[g + 1] - first, end - begin, placed - first_row, pairs[: 2 * count],
            rows.BODY * first, own_at, rows_at + ROW * first_row, scratch_at,
        )  # fmt: skip
        if needed > program.size:
            wider = np.empty(needed + needed // 2)
            for k in range(scratch_at):
                wider[k] = program[k]
            program = wider
        ints[rows.CONTACTS] = end - begin
        for k in range(begin, end):
            ints[ints[rows.CONTACT_INTS_AT] + k - begin] = of_contact[k]
        for k in range(first_row, placed):
            ints[ints[rows.ROW_INTS_AT] + k - first_row] = of_row[k]
        if solve(program, ints) == LOOSE:
            loose += 1
        begin = end
    for k in range(every):
        for c in range(6):
            at = rows.BODY * slot[k] + rows.AT_V + c
            found[6 * k + c] = program[at] if slot[k] >= 0 else free[6 * k + c]
    for k in range(contacts):
        for c in range(3):
            push = program[contacts_at + rows.CONTACT * k + rows.AT_IMPULSE + c]
            where[WHERE * order[k] + points.AT_PUSH + c] = push
    for k in range(count_rows):
        if place_of_row[k] >= 0:
            for c in range(ROW):
                bounded[ROW * k + c] = program[rows_at + ROW * place_of_row[k] + c]
    return loose
