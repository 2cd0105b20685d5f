# mypy: ignore-errors
"""The derivatives of the barrier between skins of which some are rigid bodies', by the chain rule.

A carrier is a vertex of an elastic solid, or a rigid body with all its vertices. A pair of carriers has entries row by
row: 3 rows of a vertex, by its position and velocity (6 columns); ROWS of a body by COLUMNS (place_slopes_kernels).
Positive as in skins_slopes_kernels: the turning of normals, and of forces' arms, is left out.

At PLACES, in the integers: as there, but of carriers; behind the columns where the entries of each pair begin, and the
carrier of each vertex.
"""

import numpy as np

import sceneql.system.channels as channels
from sceneql.bodies.rigid.place_kernels import arm
from sceneql.bodies.rigid.place_slopes_kernels import COLUMNS, ROWS, moved_by
from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.barrier_kernels import steepness
from sceneql.contacts.barrier.pair_weights_kernels import listed, node, stencil
from sceneql.contacts.barrier.pairs_kernels import known, vertex
from sceneql.contacts.barrier.skins_slopes_kernels import ask_for_released, rubbed
from sceneql.system.signatures_kernels import TERM

ALONE = 6
"""Columns of a vertex: its position and velocity."""


@lean_inlined
def first_entry(ints, i, j):
    """Where the entries of two carriers begin; -1 where they have none yet."""
    rows = ints[layout.PLACES]
    carriers = ints[rows]
    columns = rows + carriers + 2
    low, high = ints[rows + 1 + i], ints[rows + 2 + i]
    end = high
    while low < high:
        middle = (low + high) // 2
        if ints[columns + middle] < j:
            low = middle + 1
        else:
            high = middle
    if low == end or ints[columns + low] != j:
        return -1
    return ints[columns + ints[rows + 1 + carriers] + low]


@lean_inlined
def carrier(ints, k):
    """That of a vertex."""
    rows = ints[layout.PLACES]
    return ints[rows + ints[rows] + 2 + 2 * ints[rows + 1 + ints[rows]] + k]


@lean_inlined
def add_column(entries, y, floats, ints, i, first, columns, column, fx, fy, fz):
    """Add the derivative of a force at vertex i by one number; components that are held feel none."""
    at = vertex(ints, i)
    e = first + column
    fixed = ints[at + layout.HELD] + ints[at + layout.HELD + 1] + ints[at + layout.HELD + 2] == 3
    if ints[at + layout.HELD] != 1:
        entries[e] += fx
    if ints[at + layout.HELD + 1] == 0:
        entries[e + columns] += fy
    if ints[at + layout.HELD + 2] == 0:
        entries[e + 2 * columns] += fz
    if ints[at + layout.ARM] >= 0 and not fixed:
        rx, ry, rz = arm(y, floats, ints, at)
        entries[e + 3 * columns] += ry * fz - rz * fy
        entries[e + 4 * columns] += rz * fx - rx * fz
        entries[e + 5 * columns] += rx * fy - ry * fx


@lean_inlined
def add(entries, y, floats, ints, vertices, weights, moved, by_speed, load, xx, xy, xz, yy, yz, zz):
    """Add the derivatives of the forces of a pair: ``load`` times a symmetric 3x3, by where it is, or by its slip."""
    for n in range(4):
        j = vertices[n]
        if weights[n] == 0.0:
            continue
        turns = ints[vertex(ints, j) + layout.ARM] >= 0
        columns = COLUMNS if turns else ALONE
        if turns:
            moved_by(y, floats, ints, vertex(ints, j), moved)
        for k in range(4):
            weight = load * weights[k] * weights[n]
            if weight == 0.0:
                continue
            first = first_entry(ints, carrier(ints, vertices[k]), carrier(ints, j))
            if first < 0:
                floats[channels.GROWS] = 1.0
                continue
            if turns:
                for c in range(COLUMNS):
                    row = 3 * by_speed
                    a, b, d = weight * moved[row, c], weight * moved[row + 1, c], weight * moved[row + 2, c]
                    fx, fy, fz = xx * a + xy * b + xz * d, xy * a + yy * b + yz * d, xz * a + yz * b + zz * d
                    add_column(entries, y, floats, ints, vertices[k], first, columns, c, fx, fy, fz)
                continue
            c = 3 * by_speed
            add_column(entries, y, floats, ints, vertices[k], first, columns, c, weight * xx, weight * xy, weight * xz)
            c += 1
            add_column(entries, y, floats, ints, vertices[k], first, columns, c, weight * xy, weight * yy, weight * yz)
            c += 1
            add_column(entries, y, floats, ints, vertices[k], first, columns, c, weight * xz, weight * yz, weight * zz)


@kernel(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """The entries of all pairs of carriers that have been near so far."""
    if not known(y, floats, ints):
        return
    ask_for_released(floats, ints)
    moved, vertices, weights = np.zeros((ROWS, COLUMNS)), np.zeros(4, dtype=np.int64), np.zeros(4)
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            found = stencil(floats, ints, m, edges)
            if not found[0] < found[8]:
                continue
            a, b, c = found[1], found[2], found[3]
            weights[0], weights[1], weights[2], weights[3] = found[4], found[5], found[6], found[7]
            for k in range(4):
                vertices[k] = node(floats, ints, m, edges, k)
            steep = -found[9] * found[10] / found[8] * steepness(found[0] / found[8])
            normal = (a * a, a * b, a * c, b * b, b * c, c * c)
            add(entries, y, floats, ints, vertices, weights, moved, 0, steep, *normal)
    friction, slip = floats[ints[layout.FRICTION]], floats[ints[layout.NUMBERS] + layout.SLIP]
    if friction == 0.0:
        return
    lagged = floats[channels.STAGE] > 0.0
    before, after = floats.size - channels.BEFORE * y.size, floats.size - channels.AFTER * y.size
    if not lagged:
        before = after = 0
    old, new = floats[before : before + y.size], floats[after : after + y.size]
    for m in range(int(floats[ints[layout.MEMORY] + layout.LAGGED])):
        at = ints[layout.LAG_AT] + layout.LAG * m
        for k in range(4):
            vertices[k], weights[k] = int(floats[at + k]), floats[at + layout.WEIGHTS + k]
        load = -friction * floats[at + layout.LOAD]
        resisted = rubbed(y, old, new, floats, ints, at, lagged, slip)
        add(entries, y, floats, ints, vertices, weights, moved, 1, load, *resisted)
