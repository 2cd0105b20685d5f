# mypy: ignore-errors
"""Contacts of rigid bodies by groups: bodies that touch one another through bodies that move are solved together.

What stands connects nothing. Every group is a cone program of its own (linear/cone_kernels), planned for its pairs.
"""

import numpy as np
from numba import types

import sceneql.contacts.distance.rigid_rows_kernels as points
import sceneql.linear.cone_rows_kernels as rows
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts.distance.rigid_rows_kernels import BODY_A, BODY_B, WHERE, WHO
from sceneql.linear.block_order_kernels import filled
from sceneql.linear.cone_kernels import LOOSE, solve
from sceneql.linear.cone_layout_kernels import lay_out
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


@lean(N(N, I, N, I, I, I, I, I), inner=True)
def grouped(n, who, contacts, leader, of_group, bodies, first_body, order):
    """The number of groups of n bodies; whose those of a group stand in a row, as its contacts do.

    Writes each body's group (-1: it has no contact), the bodies by group, where each group's begin (n + 1,), and the
    contacts by group, in order. ``leader`` (n,) is scratch.
    """
    for k in range(n):
        leader[k], of_group[k] = k, -1
    for k in range(contacts):
        a, b = who[WHO * k + BODY_A], who[WHO * k + BODY_B]
        of_group[a] = 0
        if b < n:
            of_group[b] = 0
            a, b = root_of(leader, a), root_of(leader, b)
            leader[max(a, b)] = min(a, b)
    groups = 0
    for k in range(n):
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
    for k in range(n):
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


@kernel(N(N, I, A, N, A, A, A, F), inner=True)
def solve_groups(n, who, where, contacts, masses, free, found, friction):
    """Write the velocities with contacts of the n bodies to ``found`` (n, 6), and the impulses to ``where``.

    Both hold guesses before. ``masses`` (n, MASS), ``free`` (n, 6) or more: the velocities without contacts. The number
    of groups that were not solved.
    """
    leader, of_group, bodies = filled(n, 0), filled(n, 0), filled(n, 0)
    first_body, order = filled(n + 1, 0), filled(contacts, 0)
    groups = grouped(n, who, contacts, leader, of_group, bodies, first_body, order)
    slot = filled(n, -1)
    for k in range(first_body[groups]):
        slot[bodies[k]] = k
    contacts_at = rows.BODY * first_body[groups]
    scratch_at = contacts_at + rows.CONTACT * contacts
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
    pairs, of_contact = filled(2 * contacts, 0), filled(contacts, 0)
    for g in range(groups):
        end, count, first = leader[g], 0, first_body[g]
        for k in range(begin, end):
            w = WHO * order[k]
            a, b = who[w + BODY_A], who[w + BODY_B]
            before = WHO * order[max(k - 1, begin)]
            if k == begin or who[before + BODY_A] != a or who[before + BODY_B] != b:
                pairs[2 * count] = slot[a] - first
                pairs[2 * count + 1] = slot[b] - first if b < n else -1
                count += 1
            of_contact[k] = count - 1
        own_at = contacts_at + rows.CONTACT * begin
        ints, needed = lay_out(
            first_body[g + 1] - first, end - begin, pairs[: 2 * count], rows.BODY * first, own_at, scratch_at
        )
        if needed > program.size:
            wider = np.empty(needed + needed // 2)
            for k in range(scratch_at):
                wider[k] = program[k]
            program = wider
        ints[rows.CONTACTS] = end - begin
        for k in range(begin, end):
            ints[ints[rows.CONTACT_INTS_AT] + k - begin] = of_contact[k]
        if solve(program, ints) == LOOSE:
            loose += 1
        begin = end
    for k in range(first_body[groups]):
        for c in range(6):
            found[6 * bodies[k] + c] = program[rows.BODY * k + rows.AT_V + c]
    for k in range(contacts):
        for c in range(3):
            push = program[contacts_at + rows.CONTACT * k + rows.AT_IMPULSE + c]
            where[WHERE * order[k] + points.AT_PUSH + c] = push
    return loose
