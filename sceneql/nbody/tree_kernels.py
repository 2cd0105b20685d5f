# mypy: ignore-errors
"""Gravity between very many bodies by a tree: far nodes act on groups by their moments, near ones body by body.

A node is far when its radius, over the distance from its center of mass to the box of the group, is below the opening
angle. Moments up to the second are those of the softened potential itself. Each group's lists have one order, so the
bytes do not depend on the threads.
"""

import math

import numpy as np

from sceneql.compiled.arithmetic_kernels import fma, inverse_root, widest
from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.nbody import layout
from sceneql.nbody import octree_kernels as octree
from sceneql.nbody.octree_kernels import GROUP
from sceneql.nbody.shared_masses_kernels import gather, velocity_of
from sceneql.nbody.weights_kernels import FLOOR, weights
from sceneql.system.signatures_kernels import TERM

OPENING, NODES, MOST, SORTED, MASSES, ORDER, STARTS, POTENTIALS = range(layout.OWN, layout.OWN + 8)
ENTRY, THREADS, TILE_AT, BODIES = range(POTENTIALS + 1, POTENTIALS + 5)
"""Places in ints: offsets of the opening angle and the nodes; room for nodes; offsets of the sorted places,
masses and numbers, of the groups' first bodies and of sum m/r; threads; the bodies."""
PX, PY, PZ, FX, FY, FZ, U, ROWS = range(8)
"""Rows of GROUP lanes."""


@inlined
def far(floats, node, lanes, count):
    """Add the pull of one node, by its moments, to all lanes."""
    widest()
    x, y, z, m = floats[node], floats[node + 1], floats[node + 2], floats[node + 3]
    xx, xy, xz, yy, yz, zz = (
        floats[node + 4],
        floats[node + 5],
        floats[node + 6],
        floats[node + 7],
        floats[node + 8],
        floats[node + 9],
    )
    trace, soft = floats[node + 10], lanes[ROWS * GROUP]
    for k in range(count):
        dx, dy, dz = x - lanes[PX * GROUP + k], y - lanes[PY * GROUP + k], z - lanes[PZ * GROUP + k]
        u = inverse_root(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))))
        square = u * u
        cube = square * u
        fifth = cube * square
        qx = fma(xx, dx, fma(xy, dy, xz * dz))
        qy = fma(xy, dx, fma(yy, dy, yz * dz))
        qz = fma(xz, dx, fma(yz, dy, zz * dz))
        bend = fma(qx, dx, fma(qy, dy, qz * dz)) * fifth
        along = fma(m, cube, fma(2.5 * bend, square, -trace * fifth))
        lanes[FX * GROUP + k] += fma(along, dx, -fifth * qx)
        lanes[FY * GROUP + k] += fma(along, dy, -fifth * qy)
        lanes[FZ * GROUP + k] += fma(along, dz, -fifth * qz)
        lanes[U * GROUP + k] += fma(m, u, fma(0.5, bend, -trace * cube * (1.0 / 3.0)))


@inlined
def near(floats, ints, first, last, lanes, count):
    """Add the pull of the bodies first..last - 1 to all lanes."""
    widest()
    room = ints[layout.ROOM]
    places, masses = ints[SORTED], ints[MASSES]
    soft = lanes[ROWS * GROUP]
    for j in range(first, last):
        x, y, z = floats[places + j], floats[places + room + j], floats[places + 2 * room + j]
        m = floats[masses + j]
        for k in range(count):
            dx, dy, dz = x - lanes[PX * GROUP + k], y - lanes[PY * GROUP + k], z - lanes[PZ * GROUP + k]
            square = fma(dx, dx, fma(dy, dy, dz * dz))
            u = inverse_root(square + soft)
            # The potential leaves out the body itself and bodies at the same place.
            pull = m * u if square > 0.0 else 0.0
            cube = pull * (u * u)
            lanes[FX * GROUP + k] = fma(cube, dx, lanes[FX * GROUP + k])
            lanes[FY * GROUP + k] = fma(cube, dy, lanes[FY * GROUP + k])
            lanes[FZ * GROUP + k] = fma(cube, dz, lanes[FZ * GROUP + k])
            lanes[U * GROUP + k] += pull


@inlined
def walk(floats, ints, lanes, count, box):
    """Add all forces on the lanes; ``box``: low and high corner of them."""
    root = ints[NODES]
    opening = floats[ints[OPENING]]
    stack = np.empty(200, dtype=np.int64)
    stack[0] = 0
    top = 1
    while top > 0:
        top -= 1
        node = root + octree.NODE * stack[top]
        square = 0.0
        for c in range(3):
            away = max(0.0, max(box[c] - floats[node + c], floats[node + c] - box[3 + c]))
            square += away * away
        radius = floats[node + octree.RADIUS]
        children = int(floats[node + octree.CHILDREN])
        if radius * radius < opening * opening * square:
            far(floats, node, lanes, count)
        elif children == 0:
            near(floats, ints, int(floats[node + octree.BEGIN]), int(floats[node + octree.END]), lanes, count)
        else:
            for child in range(children):
                stack[top] = int(floats[node + octree.CHILD]) + child
                top += 1


@kernel(TILE, inner=True)
def tree_tile(tile, t, y, rate, floats, ints):
    """The forces of all bodies on one group."""
    room = ints[layout.ROOM]
    first = int(floats[ints[STARTS] + tile])
    count = int(floats[ints[STARTS] + tile + 1]) - first
    padded = min(GROUP, (count + 7) & ~7)
    lanes = np.zeros(ROWS * GROUP + 1)
    lanes[ROWS * GROUP] = floats[ints[layout.SOFTENING]] * floats[ints[layout.SOFTENING]] + FLOOR
    box = np.empty(6)
    for c in range(3):
        box[c], box[3 + c] = np.inf, -np.inf
        for k in range(padded):
            x = floats[ints[SORTED] + c * room + first + min(k, count - 1)]
            lanes[(PX + c) * GROUP + k] = x
            box[c], box[3 + c] = min(box[c], x), max(box[3 + c], x)
    walk(floats, ints, lanes, padded, box)
    constant = ints[layout.SIGN] * floats[ints[layout.CONSTANT]]
    for k in range(count):
        number = int(floats[ints[ORDER] + first + k])
        floats[ints[POTENTIALS] + number] = lanes[U * GROUP + k]
        own = constant * floats[ints[MASSES] + first + k]
        at = velocity_of(number, ints, BODIES)
        for c in range(3):
            rate[at + c] += own * lanes[(FX + c) * GROUP + k]


@kernel(TERM)
def tree(t, y, rate, floats, ints):
    """Adds the forces between all bodies. ints: see above."""
    n, room = ints[BODIES], ints[layout.ROOM]
    gather(y, floats, ints, BODIES, ints[layout.POINTS])
    weights(floats, ints, BODIES, ints[layout.WEIGHTS])
    for k in range(3 * n):
        if not math.isfinite(floats[ints[layout.POINTS] + k]):
            return
    keys = np.empty(n, dtype=np.int64)
    order = np.empty(n, dtype=np.int64)
    octree.sort_by_key(floats, n, n, ints[layout.POINTS], keys, order)
    for k in range(n):
        floats[ints[ORDER] + k] = order[k]
        floats[ints[MASSES] + k] = floats[ints[layout.WEIGHTS] + order[k]]
        for c in range(3):
            floats[ints[SORTED] + c * room + k] = floats[ints[layout.POINTS] + c * n + order[k]]
    count = octree.build(floats, n, keys, ints[NODES], ints[MOST])
    octree.moments(floats, count, ints[NODES], ints[SORTED], room, ints[MASSES])
    tiles = octree.groups(floats, count, ints[NODES], ints[STARTS])
    over_threads(ints[ENTRY], ints[THREADS], ints[TILE_AT], tiles, t, y, rate, floats, ints)
