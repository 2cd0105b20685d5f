# mypy: ignore-errors
"""The derivatives of the forces of strain, in 3x3 blocks of two nodes of an element.

Newton's method gets them with the stress that its latest update predicted (foreseen_kernels).
"""

from numba import types

import sceneql.system.channels as channels
from sceneql.bodies.elements.foreseen_kernels import PRESSURES, SEEN, TURN, foreseen, put_foreseen
from sceneql.bodies.elements.laws.law_kernels import SCRATCH, stiffness_at
from sceneql.bodies.elements.strain_kernels import (
    ELEMENTS,
    ENTRY,
    GRADIENTS_AT,
    LAW,
    MEAN,
    NODES,
    NODES_AT,
    NUMBERS,
    NUMBERS_AT,
    POINT,
    POINTS,
    RETARDATION_AT,
    STIFFNESS,
    THREADS,
    WEIGHTS_AT,
    D,
    M,
    P,
    look,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.system.signatures_kernels import TERM, A, F, I, N

SLOPES_ROOM_AT, SLOPES_TILES, SLOPES_TILE_AT, FORESEES, HELD_AT, OWN_INTS = range(6)
"""From the end of the integers, OWN_INTS: offset of ROOM numbers a tile; tiles, their address; 1 where stresses are
predicted; ints[HELD_AT + 3 node + k] says whether a component is held, whose rows are 0."""
MOST_NODES = 10
C = LAW + SCRATCH
T = C + 81
OWN = T + 27
OTHER = OWN + 3 * MOST_NODES
SEEN_AT = OTHER + 3 * MOST_NODES
ROOM = SEEN_AT + SEEN + TURN
"""In a tile's scratch behind that of forces: the stiffness c, a third of it by one gradient, and the derivatives of
the mean of d and of tr E' by the nodes' places and velocities, the predicted stresses."""

VISCOUS = types.void(N, F, N, N, A, A, I)

viscous = lazy("sceneql.bodies.elements.laws.viscous_slopes_kernels:viscous", VISCOUS)


@lean_inlined
def add_blocks(floats, ints, e, q, weight, room, entries, to, symmetric):
    """Subtract weight G c G from the blocks of an element; where c is symmetric half of them is enough."""
    nodes = ints[NODES]
    g = ints[GRADIENTS_AT] + 3 * nodes * (ints[POINTS] * e + q)
    c, t = floats[room + C : room + C + 81], floats[room + T : room + T + 27]
    for b in range(nodes):
        x, y, z = weight * floats[g + 3 * b], weight * floats[g + 3 * b + 1], weight * floats[g + 3 * b + 2]
        for k in range(27):
            t[k] = c[3 * k] * x + c[3 * k + 1] * y + c[3 * k + 2] * z
        for a in range(b + 1 if symmetric else nodes):
            x, y, z = floats[g + 3 * a], floats[g + 3 * a + 1], floats[g + 3 * a + 2]
            at = to + 9 * (nodes * a + b)
            for i in range(3):
                for k in range(3):
                    entries[at + 3 * i + k] -= x * t[9 * i + k] + y * t[9 * i + 3 + k] + z * t[9 * i + 6 + k]


@lean_inlined
def mirror(entries, to, nodes):
    """Write the blocks below the diagonal from those above."""
    for a in range(nodes):
        for b in range(a):
            at, other = to + 9 * (nodes * a + b), to + 9 * (nodes * b + a)
            for i in range(3):
                for k in range(3):
                    entries[at + 3 * i + k] = entries[other + 3 * k + i]


@lean_inlined
def add_means(floats, ints, e, first, out):
    """Write the sum over the points of volume (the 3x3 from floats[first + POINT q] on) gradient: (node, 3)."""
    nodes, points = ints[NODES], ints[POINTS]
    for k in range(3 * nodes):
        out[k] = 0.0
    for q in range(points):
        weight, at = floats[ints[WEIGHTS_AT] + points * e + q], first + POINT * q
        g = ints[GRADIENTS_AT] + 3 * nodes * (points * e + q)
        for n in range(nodes):
            x, y, z = weight * floats[g + 3 * n], weight * floats[g + 3 * n + 1], weight * floats[g + 3 * n + 2]
            for i in range(3):
                out[3 * n + i] += floats[at + 3 * i] * x + floats[at + 3 * i + 1] * y + floats[at + 3 * i + 2] * z


@lean_inlined
def add_products(entries, to, nodes, factor, left, right):
    """Subtract factor left right from the blocks of an element."""
    for a in range(nodes):
        for b in range(nodes):
            at = to + 9 * (nodes * a + b)
            for i in range(3):
                for k in range(3):
                    entries[at + 3 * i + k] -= factor * left[3 * a + i] * right[3 * b + k]


@lean_inlined
def hold_rows(ints, held, e, entries, to):
    """Rows of held components are 0."""
    nodes = ints[NODES]
    for a in range(nodes):
        node = ints[NODES_AT + nodes * e + a]
        for i in range(3):
            if ints[held + 3 * node + i] == 1:
                for b in range(nodes):
                    for k in range(3):
                        entries[to + 9 * (nodes * a + b) + 3 * i + k] = 0.0


@lean(TILE)
def slopes_tile(number, positive, y, entries, floats, ints):
    """The blocks of the elements of one tile; ``positive``: not 0 where what is negative is left out."""
    own = ints.size - OWN_INTS
    nodes, points, numbers = ints[NODES], ints[POINTS], ints[NUMBERS]
    tiles, room = ints[own + SLOPES_TILES], ints[own + SLOPES_ROOM_AT] + ROOM * number
    damped, mean = ints[RETARDATION_AT] >= 0, ints[MEAN] == 1
    definite = 1 if positive > 0.0 else 0
    stiffness = stiffness_at(ints[STIFFNESS])
    size, elements = 9 * nodes * nodes, ints[ELEMENTS]
    c = floats[room + C : room + C + 81]
    left = floats[room + OWN : room + OWN + 3 * nodes]
    predicts = definite == 0 and ints[own + FORESEES] == 1 and floats[channels.NEWTON] > 0.0
    before = floats.size - channels.BEFORE * y.size
    old, turned = floats[before : before + y.size], floats[room + SEEN_AT + SEEN : room + SEEN_AT + SEEN + TURN]
    for e in range(elements * number // tiles, elements * (number + 1) // tiles):
        to, moving = size * e, size * (elements + e)
        seen = predicts and foreseen(old, y, floats, ints, e, room, c, room + SEEN_AT)
        dilatation, swelling = look(y, floats, ints, e, room)
        volume = 0.0
        for q in range(points):
            volume += floats[ints[WEIGHTS_AT] + points * e + q]
            for k in range(size if q == 0 else 0):
                entries[to + k] = 0.0
                if damped:
                    entries[moving + k] = 0.0
        for q in range(points):
            at, law = room + POINT * q, ints[NUMBERS_AT] + numbers * (points * e + q)
            weight, f = floats[ints[WEIGHTS_AT] + points * e + q], floats[at : at + 9]
            pressure = floats[law] * (dilatation if mean else floats[at + D])
            if seen:
                pressure = floats[room + SEEN_AT + PRESSURES + q]
            stiffness(
                f,
                floats[law : law + numbers],
                pressure,
                0.0 if mean else floats[law],
                definite,
                c,
                floats[room + LAW : room + LAW + SCRATCH],
            )
            if seen:
                p, m = floats[at + P : at + P + 9], floats[at + M : at + M + 9]
                stress = floats[room + SEEN_AT + 9 * q : room + SEEN_AT + 9 * q + 9]
                put_foreseen(f, p, m, pressure, stress, turned, c)
            add_blocks(floats, ints, e, q, weight, room, entries, to, True)
        mirror(entries, to, nodes)
        bulk = floats[ints[NUMBERS_AT] + numbers * points * e]
        if mean:
            add_means(floats, ints, e, room + M, left)
            add_products(entries, to, nodes, (max(bulk, 0.0) if definite == 1 else bulk) / volume, left, left)
        if damped:
            viscous(e, swelling, definite, room, entries, floats, ints)
        hold_rows(ints, ints[own + HELD_AT], e, entries, to)


@lean_inlined
def over_tiles(positive, y, entries, floats, ints):
    """The blocks of all elements."""
    own = ints.size - OWN_INTS
    if ints[own + SLOPES_TILES] == 1:
        slopes_tile(0, positive, y, entries, floats, ints)
    else:
        tiles, address = ints[own + SLOPES_TILES], ints[own + SLOPES_TILE_AT]
        over_threads(ints[ENTRY], ints[THREADS], address, tiles, positive, y, entries, floats, ints)


@lean(TERM, inner=True)
def strain(t, y, entries, floats, ints):
    """Of each element the blocks of pairs of its nodes (nodes, nodes, 3, 3): derivatives of forces by places and, where
    damped, behind those of all elements, by velocities."""
    over_tiles(0.0, y, entries, floats, ints)


@lean(TERM, inner=True)
def positive(t, y, entries, floats, ints):
    """As `strain`, but by the law's positive stiffness, and as if viscous forces did not depend on places."""
    over_tiles(1.0, y, entries, floats, ints)
