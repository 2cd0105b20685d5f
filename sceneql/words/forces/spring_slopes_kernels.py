# mypy: ignore-errors
"""The derivatives of the force of a spring between masses of any models."""

import math

import numpy as np

import sceneql.system.channels as channels
from sceneql.bodies.mass_spring_slopes_kernels import HOLDS
from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import spring_kernels as force

INVERSES_AT = force.SPEEDS_AT + 2
"""Behind the integers of the force, where each end has its inverse mass (-1: none)."""


@inlined
def between(y, floats, ints, d, v):
    """Write the second end's place [m] and velocity [m/s] relative to the first to d and v."""
    for c in range(3):
        d[c] = v[c] = 0.0
        for end in range(2):
            sign, own = 2.0 * end - 1.0, force.END * end
            at, velocity = ints[own + force.POSITION_AT], ints[own + force.VELOCITY_AT]
            d[c] += sign * (y[at + c] if at >= 0 else floats[velocity + c])
            v[c] += sign * (y[velocity + c] if at >= 0 else floats[ints[force.SPEEDS_AT + end] + c])


@inlined
def foreseen(old, d, w, stiffness, damping, rest):
    """The force [N] along ``old`` that the latest Newton update, to d with the velocity w, predicted."""
    before = math.sqrt(old[0] * old[0] + old[1] * old[1] + old[2] * old[2])
    if before == 0.0:
        return 0.0
    seen = old[0] * d[0] + old[1] * d[1] + old[2] * d[2]
    opening = old[0] * w[0] + old[1] * w[1] + old[2] * w[2]
    return stiffness * (seen / before - rest) + damping * opening / before


@inlined
def add(y, entries, floats, ints, kept):
    """Add the blocks of `spring`; ``kept``: the most negative stiffness across it, over the lighter mass."""
    n, v = np.zeros(3), np.zeros(3)
    between(y, floats, ints, n, v)
    length = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    if length == 0.0:
        return
    for c in range(3):
        n[c] /= length
    opening = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
    stiffness, damping = floats[ints[force.STIFFNESS_AT]], floats[ints[force.DAMPING_AT]]
    rest = floats[ints[force.REST_AT]]
    across, turning = (stiffness * (length - rest) + damping * opening) / length, damping / length
    if floats[channels.NEWTON] > 0.0:
        old, d, w = np.zeros(3), np.zeros(3), np.zeros(3)
        between(floats[floats.size - channels.BEFORE * y.size :], floats, ints, old, w)
        between(floats[floats.size - channels.AFTER * y.size :], floats, ints, d, w)
        across, turning = foreseen(old, d, w, stiffness, damping, rest) / length, 0.0
        inverse = 0.0
        for end in range(2):
            if ints[INVERSES_AT + end] >= 0:
                inverse = max(inverse, floats[ints[INVERSES_AT + end]])
        across = max(-kept / inverse if inverse > 0.0 else 0.0, across)
    block = 0
    for one in range(2):
        for by_velocity in range(2):
            for other in range(2):
                if ints[force.END * one] < 0 or ints[force.END * other] < 0:
                    continue
                sign = 1.0 if one != other else -1.0
                for i in range(3):
                    for j in range(3):
                        slope = damping * n[i] * n[j]
                        if by_velocity == 0:
                            # The opening changes with the direction too: n' v = v across / length.
                            turned = turning * n[i] * (v[j] - opening * n[j])
                            slope = (stiffness - across) * n[i] * n[j] + (across if i == j else 0.0) + turned
                        entries[block + 3 * i + j] += sign * slope
                block += 9


@kernel(TERM, inner=True)
def spring(t, y, entries, floats, ints):
    """Blocks of 3x3: for each end that is a mass, its force by the places of both masses, then by their velocities.

    For Newton's method as mass_spring_slopes_kernels: without the damping's rotation, with the predicted force.
    """
    add(y, entries, floats, ints, math.inf)


@kernel(TERM, inner=True)
def positive(t, y, entries, floats, ints):
    """As `spring`, with the negative stiffness across a compressed one bounded as in mass_spring_slopes_kernels."""
    add(y, entries, floats, ints, HOLDS / floats[channels.NEWTON])
