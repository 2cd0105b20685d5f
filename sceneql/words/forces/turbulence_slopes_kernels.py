# mypy: ignore-errors
"""The derivatives of the drag of turbulent air."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import turbulence_kernels as force

APART = 1e-3
"""Half the distance of the points between which the air's velocity is differenced, in units of the smallest eddies:
the noise is smooth over that, and single precision leaves some 1e-4 of its slope."""


@kernel(TERM, inner=True)
def turbulence(t, y, entries, floats, ints):
    """Blocks of 3x3 of each mass, c du/dx by its position, and then -c by each component of its velocity."""
    position_at, count, inverse_at = ints[force.POSITION_AT], ints[force.COUNT], ints[force.INVERSE_AT]
    speed, linear = floats[ints[force.SPEED_AT]], floats[ints[force.LINEAR_AT]]
    air_at, numbers_at, octaves = ints[force.AIR_AT], ints[force.NUMBERS_AT], ints[force.OCTAVES]
    scale, omega = 1.0 / floats[numbers_at], floats[numbers_at + 1]
    drift = scale * t
    ax, ay, az = drift * floats[air_at], drift * floats[air_at + 1], drift * floats[air_at + 2]
    apart = APART * 2.0 ** (1 - octaves)
    places = np.zeros(3 * force.LANES)
    total = np.empty(3 * force.LANES, dtype=np.float32)
    work = np.empty(force.ROWS * force.LANES, dtype=np.float32)
    cells = np.empty(3 * force.LANES, dtype=np.uint32)
    for first in range(0, count, force.LANES):
        end = min(count, first + force.LANES)
        for c in range(3):
            for side in range(-1, 2, 2):
                force.split(y[position_at + 3 * first : position_at + 3 * end], scale, ax, ay, az, places)
                for k in range(force.LANES):
                    places[c * force.LANES + k] += side * apart
                factor = speed * force.curl(places, ints[force.SEED], omega * t, octaves, work, cells, total)
                slope = side * linear * factor * scale / (2.0 * apart)
                for k in range(end - first):
                    if floats[inverse_at + first + k] > 0.0:
                        for i in range(3):
                            entries[9 * (first + k) + 3 * i + c] += slope * np.float64(total[i * force.LANES + k])
    for k in range(count):
        for i in range(3):
            entries[9 * count + 3 * k + i] -= linear if floats[inverse_at + k] > 0.0 else 0.0
