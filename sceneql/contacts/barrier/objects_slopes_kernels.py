# mypy: ignore-errors
"""The derivatives of a barrier between a skin and objects, positive: the curvature of the surface is left out.

Blocks by positions: one for each node, then two for each edge, of its first node by its second and back; behind them
the same by velocities.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.barrier_kernels import mobilized, mobilized_rate, steepness
from sceneql.contacts.barrier.objects_kernels import distance, ends, load, place, sliding
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def add_product(entries, at, weight, x, y, z):
    """Add weight * (x, y, z) (x, y, z) to a block."""
    entries[at] += weight * x * x
    entries[at + 1] += weight * x * y
    entries[at + 2] += weight * x * z
    entries[at + 3] += weight * y * x
    entries[at + 4] += weight * y * y
    entries[at + 5] += weight * y * z
    entries[at + 6] += weight * z * x
    entries[at + 7] += weight * z * y
    entries[at + 8] += weight * z * z


@lean_inlined
def spread(entries, ints, first, p, weight, x, y, z):
    """Add such a product to all blocks of a point's nodes."""
    nodes = ints[layout.NODES]
    i, j = ends(ints, p)
    if i == j:
        add_product(entries, 9 * (first + i), weight, x, y, z)
        return
    across = first + nodes + 2 * (p - nodes)
    for block in (first + i, first + j, across, across + 1):
        add_product(entries, 9 * block, 0.25 * weight, x, y, z)


@lean(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """The blocks; rows of held components are 0."""
    numbers, objects, nodes = ints[layout.NUMBERS], ints[layout.OBJECTS], ints[layout.NODES]
    stiffness, gap = floats[numbers + layout.STIFFNESS], floats[numbers + layout.GAP]
    friction, slip = floats[ints[layout.FRICTION]], floats[numbers + layout.SLIP]
    lagged = friction > 0.0 and floats[channels.STAGE] > 0.0
    blocks = nodes + 2 * ints[layout.EDGES]
    for p in range(nodes + ints[layout.EDGES]):
        px, py, pz = place(y, ints, ints[layout.POSITION], p)
        for j in range(objects):
            d, a, b, c = distance(floats, ints, p, j, px, py, pz, gap)
            pressed = 0.0
            if d < gap:
                pressed = load(floats, ints, p, d)
                steep = floats[ints[layout.AREAS] + p] * stiffness / gap * steepness(d / gap)
                spread(entries, ints, 0, p, -steep, a, b, c)
            if friction == 0.0:
                continue
            if lagged:
                at = ints[layout.LAGGED] + layout.LOADS + layout.LAG * (objects * p + j)
                pressed, a, b, c = floats[at], floats[at + 1], floats[at + 2], floats[at + 3]
            if not pressed > 0.0:
                continue
            u, v, w = sliding(y, floats, ints, p, j, a, b, c)
            speed = math.sqrt(u * u + v * v + w * w)
            across = -friction * pressed * mobilized(speed, slip)
            along = across
            if speed > 0.0:
                if floats[channels.POSITIVE] == 0.0:
                    along = -friction * pressed * mobilized_rate(speed, slip)
                u, v, w = u / speed, v / speed, w / speed
            elif abs(a) < 0.8:
                size = math.sqrt(b * b + c * c)
                u, v, w = 0.0, c / size, -b / size
            else:
                size = math.sqrt(a * a + c * c)
                u, v, w = -c / size, 0.0, a / size
            spread(entries, ints, blocks, p, along, u, v, w)
            spread(entries, ints, blocks, p, across, b * w - c * v, c * u - a * w, a * v - b * u)
    held = ints[layout.LIST] + blocks
    for k in range(2 * blocks):
        row = k % blocks
        if row >= nodes:
            row = ints[ints[layout.LIST] + row]
        for m in range(3):
            if ints[held + 3 * row + m] == 1:
                for n in range(3):
                    entries[9 * k + 3 * m + n] = 0.0
