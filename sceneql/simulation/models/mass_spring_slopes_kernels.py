# mypy: ignore-errors
"""The derivatives of the forces of springs."""

import math

from sceneql.kernels import lean, lean_inlined
from sceneql.system_kernels import TERM

BLOCK = 5
"""Floats of a spring (mass_spring_kernels.py)."""
ENTRIES = 36
"""Of a spring: four blocks of 3x3."""
DEFINITE_AT = 2
"""floats[2]: whether slopes are to be definite, and how far (system.Slopes)."""


@lean_inlined
def add_blocks(entries, at, slope):
    """A slope of the force that pulls a towards b, by b's coordinate, in all four blocks."""
    entries[at] -= slope
    entries[at + 9] += slope
    entries[at + 18] += slope
    entries[at + 27] -= slope


@lean(TERM, inner=True)
def springs(t, y, entries, floats, ints):
    """Of the force on each end by both positions, then (where there is room for them) by both velocities.

    ints: those of mass_spring_kernels.springs, the last one where inverse masses start. For spring s the four blocks of
    3x3 entries (a by a, a by b, b by a, b by b) by positions from 36 s on, by velocities from 36 (count + s) on. With u
    along the spring, w the relative velocity and p = w . u: d(force)/dx = k u u + (k (L - L0) + c p)/L (1 - u u)
    + c u (w - p u)/L, d(force)/dv = c u u.
    Definite slopes: without the third part (Choi & Ko 2002), and of what pushes across a pressed spring only so much as
    the lighter mass holds at the rate of floats[2]: springs that buckle slowly keep their true slopes.
    """
    position_at, velocity_at, blocks_at, count = ints[0], ints[1], ints[3], ints[6]
    model_stiffness, model_damping = floats[ints[4]], floats[ints[5]]
    damped = entries.size > ENTRIES * count
    inverse_at = ints[7 + 2 * count]
    definite = floats[DEFINITE_AT] > 0.0
    for s in range(count):
        a, b = 3 * ints[7 + 2 * s], 3 * ints[8 + 2 * s]
        block = blocks_at + BLOCK * s
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
        if definite:
            inverse = max(floats[inverse_at + ints[7 + 2 * s]], floats[inverse_at + ints[8 + 2 * s]])
            across, turning = max(-floats[DEFINITE_AT] / inverse if inverse > 0.0 else 0.0, across), 0.0
        for i in range(3):
            for j in range(3):
                along = u[i] * u[j]
                slope = (k - across) * along + turning * u[i] * (w[j] - speed * u[j])
                if i == j:
                    slope += across
                add_blocks(entries, ENTRIES * s + 3 * i + j, slope)
                if damped:
                    add_blocks(entries, ENTRIES * (count + s) + 3 * i + j, c * along)
