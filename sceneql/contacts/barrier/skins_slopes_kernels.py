# mypy: ignore-errors
"""The derivatives of the barrier between skins, positive: the turning of the normal is left out.

Blocks are the places of pairs of vertices that have been near so far, by positions, then by velocities.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.barrier_kernels import mobilized, mobilized_rate, steepness
from sceneql.contacts.barrier.pair_weights_kernels import listed, node, stencil
from sceneql.contacts.barrier.pairs_kernels import known, vertex
from sceneql.contacts.barrier.skin_forces_kernels import sliding
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
def add(entries, floats, ints, first, i, j, weight, x, y, z):
    """Add weight * (x, y, z) (x, y, z) to the block of two vertices; ask for it where there is none."""
    at = place(ints, i, j)
    if at < 0:
        floats[channels.GROWS] = 1.0
        return
    e = 9 * (first + at)
    entries[e] += weight * x * x
    entries[e + 1] += weight * x * y
    entries[e + 2] += weight * x * z
    entries[e + 3] += weight * y * x
    entries[e + 4] += weight * y * y
    entries[e + 5] += weight * y * z
    entries[e + 6] += weight * z * x
    entries[e + 7] += weight * z * y
    entries[e + 8] += weight * z * z


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
            found = stencil(y, floats, ints, m, edges)
            if found[0] == math.inf:
                continue
            steep = -found[9] * found[10] / found[8] * steepness(found[0] / found[8])
            for k in range(4):
                for n in range(4):
                    i, j = node(floats, ints, m, edges, k), node(floats, ints, m, edges, n)
                    weight = steep * found[4 + k] * found[4 + n]
                    if weight != 0.0:
                        add(entries, floats, ints, 0, i, j, weight, found[1], found[2], found[3])
    friction, slip = floats[ints[layout.FRICTION]], floats[ints[layout.NUMBERS] + layout.SLIP]
    if friction > 0.0:
        for m in range(int(floats[ints[layout.MEMORY] + layout.LAGGED])):
            at = ints[layout.LAG_AT] + layout.LAG * m
            u, v, w = sliding(y, floats, ints, at)
            a, b, c = floats[at + layout.NORMAL], floats[at + layout.NORMAL + 1], floats[at + layout.NORMAL + 2]
            speed = math.sqrt(u * u + v * v + w * w)
            across = -friction * floats[at + layout.LOAD] * mobilized(speed, slip)
            along = across
            if speed > 0.0:
                if floats[channels.POSITIVE] == 0.0:
                    along = -friction * floats[at + layout.LOAD] * mobilized_rate(speed, slip)
                u, v, w = u / speed, v / speed, w / speed
            elif abs(a) < 0.8:
                size = math.sqrt(b * b + c * c)
                u, v, w = 0.0, c / size, -b / size
            else:
                size = math.sqrt(a * a + c * c)
                u, v, w = -c / size, 0.0, a / size
            p, q, r = b * w - c * v, c * u - a * w, a * v - b * u
            for k in range(4):
                for n in range(4):
                    i, j = int(floats[at + k]), int(floats[at + n])
                    weight = floats[at + layout.WEIGHTS + k] * floats[at + layout.WEIGHTS + n]
                    if weight != 0.0:
                        add(entries, floats, ints, blocks, i, j, weight * along, u, v, w)
                        add(entries, floats, ints, blocks, i, j, weight * across, p, q, r)
    for i in range(count):
        for c in range(3):
            if ints[vertex(ints, i) + layout.HELD + c] == 1:
                for at in range(ints[rows + i], ints[rows + i + 1]):
                    for n in range(3):
                        entries[9 * at + 3 * c + n] = 0.0
                        entries[9 * (blocks + at) + 3 * c + n] = 0.0
