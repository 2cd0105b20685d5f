# mypy: ignore-errors
"""The derivatives of the barrier between skins, positive: the turning of the normal is left out.

Blocks are the places of pairs of vertices that have been near so far, by positions, then by velocities.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.barrier_kernels import steepness
from sceneql.contacts.barrier.friction_slopes_kernels import direction, resistance
from sceneql.contacts.barrier.objects_slopes_kernels import add_block
from sceneql.contacts.barrier.pair_weights_kernels import listed, node, stencil
from sceneql.contacts.barrier.pairs_kernels import known, vertex
from sceneql.contacts.barrier.skin_forces_kernels import learn, sliding
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def place(ints, i, j):
    """The number of the block of two vertices; -1 where there is none yet."""
    rows = ints[layout.PLACES]
    columns = rows + ints[layout.VERTICES] + 1
    low, high = ints[rows + i], ints[rows + i + 1]
    while low < high:
        middle = (low + high) // 2
        if ints[columns + middle] < j:
            low = middle + 1
        else:
            high = middle
    return low if low < ints[rows + i + 1] and ints[columns + low] == j else -1


@lean_inlined
def rubbed(y, old, new, floats, ints, at, lagged, slip):
    """The derivative of a lagged pair's friction over its load (friction_slopes_kernels.resistance)."""
    u, v, w = sliding(y, floats, ints, at)
    if lagged:
        p, q, r = learn(old, new, floats, ints, at, slip)
    else:
        p, q, r = direction(u, v, w, slip)
    a, b, c = floats[at + layout.NORMAL], floats[at + layout.NORMAL + 1], floats[at + layout.NORMAL + 2]
    return resistance(a, b, c, u, v, w, p, q, r, slip)


@lean_inlined
def add(entries, floats, ints, first, i, j, weight, xx, xy, xz, yy, yz, zz):
    """Add a symmetric 3x3 to the block of two vertices; ask for it where there is none."""
    at = place(ints, i, j)
    if at < 0:
        floats[channels.GROWS] = 1.0
        return
    add_block(entries, 9 * (first + at), weight, xx, xy, xz, yy, yz, zz)


@lean_inlined
def ask_for_released(floats, ints):
    """Ask for unknowns of masses that pins have let go since the Jacobian was laid out."""
    for i in range(ints[layout.VERTICES]):
        at = vertex(ints, i)
        if ints[at + layout.HELD] == layout.PINNED and floats[ints[at + layout.INVERSE]] > 0.0:
            floats[channels.GROWS] = 1.0


@lean(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """The blocks; rows of held components are 0."""
    if not known(y, floats, ints):
        return
    count = ints[layout.VERTICES]
    rows = ints[layout.PLACES]
    blocks = ints[rows + count]
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            found = stencil(floats, ints, m, edges)
            if found[0] == math.inf:
                continue
            a, b, c = found[1], found[2], found[3]
            steep = -found[9] * found[10] / found[8] * steepness(found[0] / found[8])
            for k in range(4):
                for n in range(4):
                    i, j = node(floats, ints, m, edges, k), node(floats, ints, m, edges, n)
                    weight = steep * found[4 + k] * found[4 + n]
                    if weight != 0.0:
                        add(entries, floats, ints, 0, i, j, weight, a * a, a * b, a * c, b * b, b * c, c * c)
    friction, slip = floats[ints[layout.FRICTION]], floats[ints[layout.NUMBERS] + layout.SLIP]
    if friction > 0.0:
        lagged = floats[channels.STAGE] > 0.0
        before, after = floats.size - channels.BEFORE * y.size, floats.size - channels.AFTER * y.size
        if not lagged:
            before = after = 0
        old, new = floats[before : before + y.size], floats[after : after + y.size]
        for m in range(int(floats[ints[layout.MEMORY] + layout.LAGGED])):
            at = ints[layout.LAG_AT] + layout.LAG * m
            load = -friction * floats[at + layout.LOAD]
            xx, xy, xz, yy, yz, zz = rubbed(y, old, new, floats, ints, at, lagged, slip)
            for k in range(4):
                for n in range(4):
                    i, j = int(floats[at + k]), int(floats[at + n])
                    weight = floats[at + layout.WEIGHTS + k] * floats[at + layout.WEIGHTS + n]
                    if weight != 0.0:
                        add(entries, floats, ints, blocks, i, j, load * weight, xx, xy, xz, yy, yz, zz)
    ask_for_released(floats, ints)
    for i in range(count):
        for c in range(3):
            if ints[vertex(ints, i) + layout.HELD + c] == 1:
                for at in range(ints[rows + i], ints[rows + i + 1]):
                    for n in range(3):
                        entries[9 * at + 3 * c + n] = 0.0
                        entries[9 * (blocks + at) + 3 * c + n] = 0.0
