# mypy: ignore-errors
"""Plans for systems_kernels made in compiled code: of matrices of 6x6 blocks whose pattern changes as they run.

As planning.plan makes them for good, but on one thread and without single precision. Value k is a block of 36: the
diagonal's first, then of every edge (a, b) the block in row a and column b, and the one in row b and column a.
"""

from numba import types

from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.block_order_kernels import elimination
from sceneql.system.signatures_kernels import I, N

UNIT, BLOCK = layout.BODY_UNKNOWNS, layout.BODY_BLOCK
MERGED = 4
"""Vertices up to which a front is merged into its parent, though more zeros are computed."""


@lean_inlined
def place_in(front, first, beyond, vertices, place):
    """Where a place of the order stands among those of a front: its own, then those that its structure reaches."""
    if place < first[front + 1]:
        return place - first[front]
    low, high = beyond[front], beyond[front + 1]
    while low < high:
        middle = (low + high) // 2
        if vertices[middle] < place:
            low = middle + 1
        else:
            high = middle
    return first[front + 1] - first[front] + low - beyond[front]


@kernel(types.Tuple((I, N, N))(N, I), inner=True)
def plan_blocks(n, edges):
    """The integers of the plan of n unknown blocks with these edges (m 2,); floats of factors and work."""
    order, parents, bounds, members = elimination(n, edges)
    place = filled(n, 0)
    for k in range(n):
        place[order[k]] = k
    # Fronts are runs of places; with each the places that its last one reaches.
    first, fronts = filled(n + 1, 0), 0
    owner = filled(n, 0)
    for k in range(n):
        v = order[k]
        joins = False
        if k > 0 and parents[order[k - 1]] == v:
            before = bounds[2 * order[k - 1] + 1] - bounds[2 * order[k - 1]]
            here = bounds[2 * v + 1] - bounds[2 * v]
            joins = before == here + 1 or k - first[fronts - 1] < MERGED
        if not joins:
            first[fronts] = k
            fronts += 1
        owner[k] = fronts - 1
    first[fronts] = n
    beyond = filled(fronts + 1, 0)
    for s in range(fronts):
        v = order[first[s + 1] - 1]
        beyond[s + 1] = beyond[s] + bounds[2 * v + 1] - bounds[2 * v]
    vertices = filled(beyond[fronts], 0)
    above = filled(fronts, -1)
    runs = filled(fronts + 1, 0)
    for s in range(fronts):
        v = order[first[s + 1] - 1]
        for k in range(beyond[s + 1] - beyond[s]):
            to, at = place[members[bounds[2 * v] + k]], beyond[s] + k
            while at > beyond[s] and vertices[at - 1] > to:
                vertices[at] = vertices[at - 1]
                at -= 1
            vertices[at] = to
        if parents[v] >= 0:
            above[s] = owner[place[parents[v]]]
    for s in range(fronts):
        count, last = 0, -2
        for k in range(beyond[s], beyond[s + 1]):
            to = place_in(above[s], first, beyond, vertices, vertices[k])
            count += to != last + 1
            last = to
        runs[s + 1] = runs[s] + 2 * count
    # Updates wait in two stacks by turns, so that a front's own never lies over its children's.
    updates, waiting, depth = filled(fronts, 0), filled(fronts, 0), filled(fronts, 0)
    tops, most = filled(2, 0), filled(2, 0)
    for s in range(fronts - 1, -1, -1):
        depth[s] = depth[above[s]] + 1 if above[s] >= 0 else 0
    rows = largest = factors = 0
    for s in range(fronts):
        stack, width, rest = depth[s] % 2, UNIT * (first[s + 1] - first[s]), UNIT * (beyond[s + 1] - beyond[s])
        updates[s] = tops[stack]
        tops[stack] += rest * rest
        most[stack] = max(most[stack], tops[stack])
        tops[1 - stack] -= waiting[s]
        if above[s] >= 0:
            waiting[above[s]] += rest * rest
        rows += width + rest
        largest = max(largest, width + rest)
        factors += width * (width + 2 * rest) + layout.PAD
    for s in range(fronts):
        updates[s] += most[0] * (depth[s] % 2)
    room = most[0] + most[1]

    unknowns, values = UNIT * n, n + edges.size
    table_at = layout.HEAD
    order_at = table_at + layout.FIELDS * (fronts + 1)
    rows_at = order_at + unknowns
    maps_at = rows_at + rows
    entries_at = maps_at + runs[fronts]
    pivots_at = entries_at + 2 * values
    plan = filled(pivots_at + unknowns, 0)
    plan[0], plan[1], plan[2], plan[3], plan[4], plan[5], plan[6], plan[7] = (
        unknowns, fronts, order_at, rows_at, maps_at, entries_at, pivots_at, room,
    )  # fmt: skip
    plan[layout.PIECES_AT], plan[layout.UNIT], plan[layout.EXACT] = plan.size, UNIT, 1
    for k in range(layout.SINGLE_FACTOR, layout.SINGLE_BACKWARD + 1):
        plan[k] = -1
    for k in range(n):
        for c in range(UNIT):
            plan[order_at + UNIT * k + c] = UNIT * order[k] + c
    # Entries by front, those of the upper triangle first.
    starts = filled(2 * fronts + 1, 0)
    for turn in range(2):
        for value in range(values):
            i = j = place[value] if value < n else 0
            if value >= n:
                edge, side = (value - n) // 2 * 2, (value - n) % 2
                i, j = place[edges[edge + side]], place[edges[edge + 1 - side]]
            s = owner[min(i, j)]
            kind = 2 * s + (i > j)
            if turn == 0:
                starts[kind + 1] += 1
            else:
                height = UNIT * (first[s + 1] - first[s] + beyond[s + 1] - beyond[s])
                at = entries_at + 2 * starts[kind]
                row, column = place_in(s, first, beyond, vertices, i), place_in(s, first, beyond, vertices, j)
                plan[at], plan[at + 1] = BLOCK * value, UNIT * (row * height + column)
                starts[kind] += 1
        if turn == 0:
            for k in range(2 * fronts):
                starts[k + 1] += starts[k]
    row = panel = 0
    for s in range(fronts):
        t, width, rest = table_at + layout.FIELDS * s, first[s + 1] - first[s], beyond[s + 1] - beyond[s]
        plan[t], plan[t + 1], plan[t + 2] = UNIT * first[s], UNIT * width, UNIT * (width + rest)
        plan[t + 3], plan[t + 4], plan[t + 5] = row, runs[s], panel
        plan[t + 6], plan[t + 10] = starts[2 * s - 1] if s > 0 else 0, starts[2 * s]
        plan[t + 7] = plan[t + 8] = -1
        plan[t + 9] = updates[s]
        panel += UNIT * UNIT * width * (width + 2 * rest) + layout.PAD
        for k in range(width + rest):
            to = first[s] + k if k < width else vertices[beyond[s] + k - width]
            for c in range(UNIT):
                plan[rows_at + row] = UNIT * to + c
                row += 1
        run, last = maps_at + runs[s], -2
        for k in range(rest):
            to = place_in(above[s], first, beyond, vertices, vertices[beyond[s] + k])
            if to != last + 1:
                plan[run + 1] = UNIT * to
                run += 2
            plan[run - 2] = UNIT * (k + 1)
            last = to
    end = table_at + layout.FIELDS * fronts
    plan[end], plan[end + 3], plan[end + 4], plan[end + 5] = unknowns, row, runs[fronts], panel
    plan[end + 6], plan[end + 7], plan[end + 8] = starts[2 * fronts - 1], -1, -1
    for s in range(fronts):
        if above[s] >= 0:
            t, up = table_at + layout.FIELDS * s, table_at + layout.FIELDS * above[s]
            plan[t + 8], plan[up + 7] = plan[up + 7], s
    work = max(room + largest * largest, rows + layout.PAD * fronts) + 2 * unknowns
    return plan, factors, work
