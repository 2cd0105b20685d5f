# mypy: ignore-errors
"""The derivatives of the force of air that rotates about an axis."""

import math

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import vortex_kernels as force


@kernel(TERM, inner=True)
def vortex(t, y, entries, floats, ints):
    """Blocks of 3x3 of each mass, first all by the position, then all by the velocity.

    With d the place across the axis a and q = d^2: u = s(q) a x d + up(q) a.
    """
    position_at, count = ints[force.POSITION_AT], ints[force.COUNT]
    axis = np.empty(3)
    length = 0.0
    for i in range(3):
        length += floats[ints[force.AXIS_AT] + i] * floats[ints[force.AXIS_AT] + i]
    for i in range(3):
        axis[i] = floats[ints[force.AXIS_AT] + i] / math.sqrt(length)
    turning, updraft = floats[ints[force.CIRCULATION_AT]] / force.TAU, floats[ints[force.UPDRAFT_AT]]
    c = floats[ints[force.LINEAR_AT]]
    core = floats[ints[force.CORE_AT]] * floats[ints[force.CORE_AT]]
    d, round_ = np.empty(3), np.empty(3)
    for k in range(count):
        along = 0.0
        for i in range(3):
            d[i] = y[position_at + 3 * k + i] - floats[ints[force.POINT_AT] + i]
            along += d[i] * axis[i]
        q = 0.0
        for i in range(3):
            d[i] -= along * axis[i]
            q += d[i] * d[i]
        part = math.exp(-q / core)
        if q > 1e-6 * core:
            swirl = -turning * math.expm1(-q / core) / q
            bend = (turning * part / core - swirl) / q
        else:
            swirl = turning / core
            bend = -0.5 * turning / (core * core)
        rise = -updraft * part / core
        for i in range(3):
            round_[i] = axis[(i + 1) % 3] * d[(i + 2) % 3] - axis[(i + 2) % 3] * d[(i + 1) % 3]
        for i in range(3):
            entries[9 * count + 9 * k + 4 * i] -= c
            # a x e_j has the entries a_(i+1) for j = i + 2 and -a_(i+2) for j = i + 1.
            entries[9 * k + 3 * i + (i + 2) % 3] += c * swirl * axis[(i + 1) % 3]
            entries[9 * k + 3 * i + (i + 1) % 3] -= c * swirl * axis[(i + 2) % 3]
            for j in range(3):
                entries[9 * k + 3 * i + j] += 2.0 * c * d[j] * (bend * round_[i] + rise * axis[i])
