# mypy: ignore-errors
"""The derivatives of a barrier between a skin and objects, positive: the curvature of the surface is left out.

Blocks by positions: one for each node, then two for each edge, of its first node by its second and back; behind them
the same by velocities.
"""

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.barrier_kernels import steepness
from sceneql.contacts.barrier.friction_slopes_kernels import direction, resistance
from sceneql.contacts.barrier.objects_kernels import distance, ends, learn, load, place, sliding
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def add_block(entries, at, weight, xx, xy, xz, yy, yz, zz):
    """Add a symmetric 3x3 to a block."""
    entries[at] += weight * xx
    entries[at + 1] += weight * xy
    entries[at + 2] += weight * xz
    entries[at + 3] += weight * xy
    entries[at + 4] += weight * yy
    entries[at + 5] += weight * yz
    entries[at + 6] += weight * xz
    entries[at + 7] += weight * yz
    entries[at + 8] += weight * zz


@lean_inlined
def spread(entries, ints, first, p, weight, xx, xy, xz, yy, yz, zz):
    """Add such a 3x3 to all blocks of a point's nodes."""
    nodes = ints[layout.NODES]
    i, j = ends(ints, p)
    if i == j:
        add_block(entries, 9 * (first + i), weight, xx, xy, xz, yy, yz, zz)
        return
    across = first + nodes + 2 * (p - nodes)
    for block in (first + i, first + j, across, across + 1):
        add_block(entries, 9 * block, 0.25 * weight, xx, xy, xz, yy, yz, zz)


@lean_inlined
def pressing(y, floats, ints, p, j, lagged):
    """(load [N] and normal (3) of friction on object j; minus the stiffness [N/m], and its normal (3)) of a point."""
    numbers = ints[layout.NUMBERS]
    gap = floats[numbers + layout.GAP]
    px, py, pz = place(y, floats, ints, p)
    d, a, b, c = distance(floats, ints, p, j, px, py, pz, gap)
    pressed = steep = 0.0
    if d < gap:
        pressed = load(floats, ints, p, d)
        steep = -floats[ints[layout.AREAS] + p] * floats[numbers + layout.STIFFNESS] / gap * steepness(d / gap)
    if lagged:
        at = ints[layout.LAGGED] + layout.LOADS + layout.LAG * (ints[layout.OBJECTS] * p + j)
        return floats[at], floats[at + 1], floats[at + 2], floats[at + 3], steep, a, b, c
    return pressed, a, b, c, steep, a, b, c


@lean_inlined
def rubbed(y, old, new, floats, ints, p, j, a, b, c, lagged, slip):
    """The derivative of a point's friction over its load (friction_slopes_kernels.resistance)."""
    u, v, w = sliding(y, floats, ints, p, j, a, b, c)
    if lagged:
        at = ints[layout.LAGGED] + layout.LOADS + layout.LAG * (ints[layout.OBJECTS] * p + j)
        q, r, s = learn(old, new, floats, ints, p, j, at, slip)
    else:
        q, r, s = direction(u, v, w, slip)
    return resistance(a, b, c, u, v, w, q, r, s, slip)


@lean(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """The blocks; rows of held components are 0."""
    numbers, objects, nodes = ints[layout.NUMBERS], ints[layout.OBJECTS], ints[layout.NODES]
    friction, slip = floats[ints[layout.FRICTION]], floats[numbers + layout.SLIP]
    lagged = friction > 0.0 and floats[channels.STAGE] > 0.0
    blocks = nodes + 2 * ints[layout.EDGES]
    before, after = floats.size - channels.BEFORE * y.size, floats.size - channels.AFTER * y.size
    if not lagged:
        before = after = 0
    old, new = floats[before : before + y.size], floats[after : after + y.size]
    for p in range(nodes + ints[layout.EDGES]):
        for j in range(objects):
            pressed, a, b, c, steep, x, y_, z = pressing(y, floats, ints, p, j, lagged)
            if steep != 0.0:
                spread(entries, ints, 0, p, steep, x * x, x * y_, x * z, y_ * y_, y_ * z, z * z)
            if friction > 0.0 and pressed > 0.0:
                xx, xy, xz, yy, yz, zz = rubbed(y, old, new, floats, ints, p, j, a, b, c, lagged, slip)
                spread(entries, ints, blocks, p, -friction * pressed, xx, xy, xz, yy, yz, zz)
    held = ints[layout.LIST] + blocks
    for k in range(2 * blocks):
        row = k % blocks
        if row >= nodes:
            row = ints[ints[layout.LIST] + row]
        for m in range(3):
            if ints[held + 3 * row + m] == 1:
                for n in range(3):
                    entries[9 * k + 3 * m + n] = 0.0
