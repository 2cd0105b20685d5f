# mypy: ignore-errors
"""The derivatives of the force of a spring that leads to a point of a rigid body."""

import math

import numpy as np

import sceneql.system.channels as channels
from sceneql.bodies.mass_spring_slopes_kernels import HOLDS
from sceneql.bodies.rigid.place_kernels import INVERSE_AT, PLACE, POSITION_AT, velocity, where
from sceneql.bodies.rigid.place_slopes_kernels import COLUMNS, ROWS, add_force_slopes, moved_by
from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces.spring_on_bodies_kernels import DAMPING_AT, REST_AT, SPEEDS_AT, STIFFNESS_AT
from sceneql.words.forces.spring_slopes_kernels import foreseen


@inlined
def between(y, floats, ints, d, v):
    """Write the second end's place [m] and velocity [m/s] relative to the first to d and v."""
    d[0] = d[1] = d[2] = v[0] = v[1] = v[2] = 0.0
    for end in range(2):
        sign, own = 2.0 * end - 1.0, PLACE * end
        px, py, pz = where(y, floats, ints, own)
        if ints[own + POSITION_AT] >= 0:
            vx, vy, vz = velocity(y, floats, ints, own)
        else:
            u = ints[SPEEDS_AT + end]
            vx, vy, vz = floats[u], floats[u + 1], floats[u + 2]
        d[0] += sign * px
        d[1] += sign * py
        d[2] += sign * pz
        v[0] += sign * vx
        v[1] += sign * vy
        v[2] += sign * vz


@inlined
def add(y, entries, floats, ints, kept):
    """Add the slopes of `spring`; ``kept``: the most negative stiffness across it, over the lighter mass."""
    n, v = np.zeros(3), np.zeros(3)
    between(y, floats, ints, n, v)
    length = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    if length == 0.0:
        return
    for c in range(3):
        n[c] /= length
    opening = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
    stiffness, damping, rest = floats[ints[STIFFNESS_AT]], floats[ints[DAMPING_AT]], floats[ints[REST_AT]]
    across, turning = (stiffness * (length - rest) + damping * opening) / length, damping / length
    if floats[channels.NEWTON] > 0.0:
        # As spring_slopes_kernels: without the damping's rotation, with the predicted force.
        old, d, w = np.zeros(3), np.zeros(3), np.zeros(3)
        between(floats[floats.size - channels.BEFORE * y.size :], floats, ints, old, w)
        between(floats[floats.size - channels.AFTER * y.size :], floats, ints, d, w)
        across, turning = foreseen(old, d, w, stiffness, damping, rest) / length, 0.0
        inverse = 0.0
        for end in range(2):
            if ints[PLACE * end + POSITION_AT] >= 0:
                inverse = max(inverse, floats[ints[PLACE * end + INVERSE_AT]])
        across = max(-kept / inverse if inverse > 0.0 else 0.0, across)
    by, moved = np.zeros((3, 6)), np.zeros((ROWS, COLUMNS))
    pull = across * length
    block = 0
    for one in range(2):
        if ints[PLACE * one + POSITION_AT] < 0:
            continue
        along = 1.0 - 2.0 * one
        for other in range(2):
            if ints[PLACE * other + POSITION_AT] < 0:
                continue
            sign = 1.0 if one != other else -1.0
            for i in range(3):
                for j in range(3):
                    # The opening changes with the direction too: n' v = v across / length.
                    turned = turning * n[i] * (v[j] - opening * n[j])
                    slope = (stiffness - across) * n[i] * n[j] + (across if i == j else 0.0) + turned
                    by[i, j] = sign * slope
                    by[i, 3 + j] = sign * damping * n[i] * n[j]
            moved_by(y, floats, ints, PLACE * other, moved)
            force = (along * pull * n[0], along * pull * n[1], along * pull * n[2])
            add_force_slopes(y, floats, ints, PLACE * one, by, moved, one == other, force, entries, block)
            block += ROWS * COLUMNS


@kernel(TERM, inner=True)
def spring(t, y, entries, floats, ints):
    """For each end that moves, its force and torque by the motion of both."""
    add(y, entries, floats, ints, math.inf)


@kernel(TERM, inner=True)
def positive(t, y, entries, floats, ints):
    """As `spring`, with the negative stiffness across a compressed one bounded as in mass_spring_slopes_kernels."""
    add(y, entries, floats, ints, HOLDS / floats[channels.NEWTON])
