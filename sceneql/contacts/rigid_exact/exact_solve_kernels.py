# mypy: ignore-errors
"""The dense system of exact contacts and ties, solved group by group of rows that share movers with mass."""

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_MASS, MOVER, POSITION
from sceneql.compiled.kernels import lean
from sceneql.contacts.rigid_exact.exact_law_kernels import MOMENT, VECTORS, solve_law
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    A_ROW,
    AT_FIRST,
    AT_ROW,
    AT_WEIGHED,
    DENSE_AT,
    KINDS_AT,
    MEMORY_AT,
    MOVERS,
    MOVERS_AT,
    TIE_ROWS,
    UNIT,
    UNITS_AT,
    WORK,
    bounds_at,
    diagonal_at,
    labels_at,
    left_at,
    mover_at,
    partners_at,
    right_at,
    rooms,
    sizes_at,
    solution_at,
)
from sceneql.system.signatures_kernels import A, F, I, N

BEYOND = 1e8
"""What a force does, in parts of what it answers, beyond which slip has no force (Painleve 1895)."""


@lean(types.boolean(A, I, N))
def moves(floats, ints, m):
    """Whether forces change the motion of a mover."""
    if ints[ints[MOVERS_AT] + MOVER * m + POSITION] < 0:
        return False
    mover = mover_at(ints, m)
    if floats[mover + AT_MASS] != 0.0:
        return True
    for c in range(9):
        if floats[mover + AT_INVERSE + c] != 0.0:
            return True
    return False


@lean(N(I, N))
def root(labels, m):
    """The first mover of a mover's group."""
    while labels[m] != m:
        labels[m] = labels[labels[m]]
        m = labels[m]
    return m


@lean(types.void(A, I, N))
def group(floats, ints, n):
    """Write of each mover the first one that rows join it with, directly or by others."""
    at = labels_at(ints)
    labels = ints[at : at + ints[MOVERS]]
    for m in range(ints[MOVERS]):
        labels[m] = m
    for i in range(n):
        unit = ints[UNITS_AT] + UNIT * i
        a, b = int(floats[unit + AT_FIRST]), int(floats[unit + AT_FIRST + 1])
        if moves(floats, ints, a) and moves(floats, ints, b):
            p, q = root(labels, a), root(labels, b)
            labels[max(p, q)] = min(p, q)


@lean(N(A, I, N))
def group_of(floats, ints, i):
    """The first mover of a row's group; -1 where nothing moves."""
    at = labels_at(ints)
    labels = ints[at : at + ints[MOVERS]]
    for side in range(2):
        m = int(floats[ints[UNITS_AT] + UNIT * i + AT_FIRST + side])
        if moves(floats, ints, m):
            return root(labels, m)
    return -1


@lean(types.boolean(A, I, N, F, types.boolean))
def solve_some(floats, ints, n, friction, thorough):
    """Solve for the rows that the integers after the pivots name; whether to rounding."""
    room, dense, kinds = rooms(ints), ints[DENSE_AT], ints[KINDS_AT]
    rows, own = kinds + 2 * room, kinds + 3 * room
    w = floats[dense : dense + n * n]
    own_at = dense + 2 * room * room + (5 + VECTORS) * room + 2
    b, x, s = (
        floats[own_at : own_at + n],
        floats[own_at + room : own_at + room + n],
        floats[own_at + 2 * room : own_at + 2 * room + n],
    )
    for i in range(n):
        row = ints[rows + i]
        p = ints[UNITS_AT] + UNIT * row
        b[i], x[i], ints[own + i] = floats[right_at(ints) + row], floats[solution_at(ints) + row], ints[kinds + row]
        for j in range(n):
            q = ints[UNITS_AT] + UNIT * ints[rows + j]
            total = 0.0
            for one in range(2):
                for other in range(2):
                    if floats[p + AT_FIRST + one] == floats[q + AT_FIRST + other]:
                        f, g = p + AT_ROW + 6 * one, q + AT_WEIGHED + 6 * other
                        for c in range(6):
                            total += floats[f + c] * floats[g + c]
            w[i * n + j] = total
    at = sizes_at(ints) + room
    work = floats[at : at + VECTORS * n + n * n + 2]
    work[VECTORS * n + n * n + 1] = A_ROW * n
    for i in range(n):
        row = ints[rows + i]
        work[6 * n + i] = floats[sizes_at(ints) + row]
        work[7 * n + i], work[8 * n + i] = floats[bounds_at(ints) + row], floats[bounds_at(ints) + room + row]
        ints[own + n + i] = i
        for j in range(i if ints[kinds + row] >= MOMENT else 0):
            if ints[rows + j] == ints[partners_at(ints) + row]:
                ints[own + n + i] = j
    solved = solve_law(
        n, w, b, ints[own : own + 2 * n], friction, x, s, work, ints[kinds + room : kinds + room + n], thorough
    )
    floats[ints[MEMORY_AT] + WORK] += work[VECTORS * n + n * n + 1]
    largest = 0.0
    for i in range(n):
        largest = max(largest, work[i])
    for i in range(n):
        row = ints[rows + i]
        floats[solution_at(ints) + row], floats[left_at(ints) + row] = x[i], s[i]
        floats[sizes_at(ints) + row], floats[diagonal_at(ints) + row] = largest, w[i * n + i]
    return solved


@lean(types.boolean(A, I, N, F, types.boolean))
def solve_rows(floats, ints, n, friction, thorough):
    """Solve for what the rows give: x, s and the size of the numbers stand in the dense system; whether to rounding."""
    group(floats, ints, n)
    rows, solved = ints[KINDS_AT] + 2 * rooms(ints), True
    for first in range(-1, ints[MOVERS]):
        count = 0
        for i in range(n):
            if group_of(floats, ints, i) == first:
                ints[rows + count] = i
                count += 1
        if count > 0 and not solve_some(floats, ints, count, friction, thorough):
            solved = False
    return solved


@lean(types.boolean(A, I, N))
def within_reason(floats, ints, n):
    """Whether no force of a solution is far beyond those that it answers."""
    answered = 0.0
    for i in range(n):
        answered = max(answered, abs(floats[right_at(ints) + i]))
    for i in range(ints[TIE_ROWS], n):
        force, effect = abs(floats[solution_at(ints) + i]), abs(floats[diagonal_at(ints) + i])
        if not force * effect <= BEYOND * answered:
            return False
    return True
