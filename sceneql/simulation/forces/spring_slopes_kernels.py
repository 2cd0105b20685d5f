# mypy: ignore-errors
"""The derivatives of the force of a spring between masses of any models."""

import math

import numpy as np

from sceneql.kernels import kernel
from sceneql.system_kernels import TERM


@kernel(TERM, inner=True)
def spring(t, y, entries, floats, ints):
    """Blocks of 3x3: for each end that is a mass, its force by the places of both masses, then by their velocities.

    ints: those of spring_kernels.spring.
    """
    n, v = np.zeros(3), np.zeros(3)
    length, opening = 0.0, 0.0
    for c in range(3):
        for end in range(2):
            sign, at, velocity = 2.0 * end - 1.0, ints[3 * end], ints[3 * end + 1]
            n[c] += sign * (y[at + c] if at >= 0 else floats[velocity + c])
            v[c] += sign * (y[velocity + c] if at >= 0 else 0.0)
        length += n[c] * n[c]
    length = math.sqrt(length)
    if length == 0.0:
        return
    for c in range(3):
        n[c] /= length
        opening += n[c] * v[c]
    stiffness, damping = floats[ints[6]], floats[ints[7]]
    pull = stiffness * (length - floats[ints[8]]) + damping * opening
    block = 0
    for one in range(2):
        for by_velocity in range(2):
            for other in range(2):
                if ints[3 * one] < 0 or ints[3 * other] < 0:
                    continue
                sign = 1.0 if one != other else -1.0
                for i in range(3):
                    for j in range(3):
                        across = (1.0 if i == j else 0.0) - n[i] * n[j]
                        if by_velocity == 1:
                            slope = damping * n[i] * n[j]
                        else:
                            # The opening changes with the direction too: n' v = v across / length.
                            turned = v[j] - opening * n[j]
                            slope = stiffness * n[i] * n[j] + (pull * across + damping * n[i] * turned) / length
                        entries[block + 3 * i + j] += sign * slope
                block += 9
