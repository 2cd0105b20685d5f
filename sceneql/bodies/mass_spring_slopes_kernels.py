# mypy: ignore-errors
"""The derivatives of the forces of springs."""

import math

import sceneql.system.channels as channels
from sceneql.bodies.mass_spring_kernels import BLOCK
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.system.signatures_kernels import TERM

ENTRIES = 9
"""Entries of a spring's 3x3 block."""
POSITION_AT, VELOCITY_AT, INVERSE_AT, COUNT, DAMPED, TILES, ENTRY, THREADS, TILE_AT = range(9)
BLOCKS_AT, STIFFNESS_AT, DAMPING_AT, PAIRS_AT = range(9, 13)
"""From PAIRS_AT on the two masses of each spring."""


HOLDS = 0.02
"""Negative stiffness that positive slopes keep for each spring, relative to the inertia: two dozen springs of a mass
stay within it. Without it buckled cloth converges only linearly; with more, updates grow without bound."""


@lean(TILE)
def tile(number, kept, y, entries, floats, ints):
    """Derivatives of the springs of one tile, see `springs`; ``kept``: the most negative stiffness, over the mass."""
    position_at, velocity_at, inverse_at = ints[POSITION_AT], ints[VELOCITY_AT], ints[INVERSE_AT]
    model_stiffness, model_damping = floats[ints[STIFFNESS_AT]], floats[ints[DAMPING_AT]]
    count, tiles, damped = ints[COUNT], ints[TILES], ints[DAMPED] == 1
    foreseen = floats[channels.NEWTON] > 0.0
    old, new = floats.size - channels.BEFORE * y.size, floats.size - channels.AFTER * y.size
    for s in range(count * number // tiles, count * (number + 1) // tiles):
        first, second = ints[PAIRS_AT + 2 * s], ints[PAIRS_AT + 2 * s + 1]
        a, b = 3 * first, 3 * second
        block = ints[BLOCKS_AT] + BLOCK * s
        k = floats[block + 1] + floats[block + 2] * model_stiffness
        c = floats[block + 3] + floats[block + 4] * model_damping
        ux = y[position_at + b] - y[position_at + a]
        uy = y[position_at + b + 1] - y[position_at + a + 1]
        uz = y[position_at + b + 2] - y[position_at + a + 2]
        length = math.sqrt(ux * ux + uy * uy + uz * uz)
        if length == 0.0:
            continue
        u = (ux / length, uy / length, uz / length)
        w = (
            y[velocity_at + b] - y[velocity_at + a],
            y[velocity_at + b + 1] - y[velocity_at + a + 1],
            y[velocity_at + b + 2] - y[velocity_at + a + 2],
        )
        speed = w[0] * u[0] + w[1] * u[1] + w[2] * u[2]
        across = (k * (length - floats[block]) + c * speed) / length
        turning = c / length
        if foreseen:
            inverse = max(floats[inverse_at + first], floats[inverse_at + second])
            seen, seen_length, seen_speed = 0.0, 0.0, 0.0
            for i in range(3):
                before = floats[old + position_at + b + i] - floats[old + position_at + a + i]
                seen_length += before * before
                seen += before * (floats[new + position_at + b + i] - floats[new + position_at + a + i])
                seen_speed += before * (floats[new + velocity_at + b + i] - floats[new + velocity_at + a + i])
            pull = 0.0
            if seen_length > 0.0:
                seen_length = math.sqrt(seen_length)
                pull = (k * (seen / seen_length - floats[block]) + c * seen_speed / seen_length) / length
            across, turning = max(-kept / inverse if inverse > 0.0 else 0.0, pull), 0.0
        for i in range(3):
            for j in range(3):
                along = u[i] * u[j]
                slope = (k - across) * along + turning * u[i] * (w[j] - speed * u[j])
                if i == j:
                    slope += across
                entries[ENTRIES * s + 3 * i + j] = slope
                if damped:
                    entries[ENTRIES * (count + s) + 3 * i + j] = c * along


@lean_inlined
def over_tiles(kept, y, entries, floats, ints):
    """The derivatives of all springs."""
    if ints[TILES] == 1:
        tile(0, kept, y, entries, floats, ints)
    else:
        over_threads(ints[ENTRY], ints[THREADS], ints[TILE_AT], ints[TILES], kept, y, entries, floats, ints)


@lean(TERM, inner=True)
def springs(t, y, entries, floats, ints):
    """Derivatives of the force on each spring's first mass by the position, then the velocity, of its second mass.

    For spring s the 3x3 entries by position from 9 s on, if damped by velocity from 9 (count + s) on. Derivatives by
    the first mass, and of the force on the second mass, are their negatives.
    With u along the spring, w the relative velocity and p = w . u: d(force)/dx = k u u + (k (L - L0) + c p)/L (1 - u u)
    + c u (w - p u)/L, d(force)/dv = c u u.
    For Newton's method without the third term (Choi & Ko 2002), and with the force of the length and speed predicted by
    the latest iteration, along the spring's direction before it.
    """
    over_tiles(math.inf, y, entries, floats, ints)


@lean(TERM, inner=True)
def positive(t, y, entries, floats, ints):
    """As `springs`, but the negative transverse stiffness of a compressed spring is bounded by the lighter mass.

    So springs that buckle slowly keep exact derivatives.
    """
    over_tiles(HOLDS / floats[channels.NEWTON], y, entries, floats, ints)
