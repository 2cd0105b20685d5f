"""The magnitude of a field's gradient at its surface, by which the field is scaled to vary like a distance.

Imports numpy, and numba unless samples by numpy show that no scaling is needed: to be imported by the function that
needs it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.tape.plain_values import plain_values

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

SAMPLES = 7
"""Lattice points along each axis of the box."""
ORDINARY = 20
"""Largest |log2 |grad f|| of a field that is not scaled; a distance has |grad f| = 1."""
MOST = 1000
"""Largest |log2| of the factor."""
PLACES = 64
"""Surface points at which gradients are evaluated, about."""
TURNS = 50
"""Bisections that find such a point."""

Corner = tuple[float, ...]


def lattice(low: Corner, high: Corner) -> Floats:
    """(SAMPLES^3, 3) points evenly spaced inside the box low..high, x slowest."""
    ticks = [np.linspace(a, b, SAMPLES + 2)[1:-1] for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)


def leveling(tape: Tape, low: Corner, high: Corner) -> float:
    """The power of two by which f is multiplied to have |grad f| near 1 on its surface in the box low..high.

    1 where the slope of f is within ORDINARY. |grad f| is the median at surface points, found by bisection between
    lattice points of opposite sign; without any, it is estimated by the median of |f| over half the size of the box.
    """
    return _leveling(tape.code.tobytes(), tape.constants.tobytes(), tape.parts.tobytes(), low, high)


@lru_cache(maxsize=256)
def _leveling(code: bytes, constants: bytes, parts: bytes, low: Corner, high: Corner) -> float:
    from sceneql.frame import Tape

    rows = np.frombuffer(code, np.int32).reshape(-1, 4).copy()
    tape = Tape(rows, np.frombuffer(constants).copy(), np.frombuffer(parts).reshape(-1, 8).copy())
    points = lattice(low, high)
    size = 0.5 * max(b - a for a, b in zip(low, high, strict=True))
    with np.errstate(all="ignore"):
        first = plain_values(tape, points)
        # Stricter by one power than below: the last bits of plain values differ between machines.
        if first is not None and _ordinary(_slopes(first, size), ORDINARY - 1):
            return 1.0
        from sceneql.field.tape.tape_solid import field_values

        values = field_values(tape, points)
        slopes = _slopes(values, size)
        if not len(slopes) or _ordinary(slopes, ORDINARY):
            return 1.0
        typical = float(np.median(slopes))
        typical = _steepness(tape, points, values) or typical
    power = -round(float(np.log2(typical)))
    return 1.0 if abs(power) <= ORDINARY else 2.0 ** max(-MOST, min(MOST, power))


def _slopes(values: Floats, size: float) -> Floats:
    """Estimates |values| / size of the slope, without those that are 0 or not finite."""
    slopes = np.abs(values[np.isfinite(values)]) / size
    return slopes[np.isfinite(slopes) & (slopes > 0.0)]


def _ordinary(slopes: Floats, powers: int) -> bool:
    """Whether the median slope is above 2^-powers and the largest below 2^powers; False without slopes."""
    return len(slopes) > 0 and bool(np.median(slopes) > 2.0**-powers and slopes.max() < 2.0**powers)


def _steepness(tape: Tape, points: Floats, values: Floats) -> float:
    """The median of |grad f| at surface points between lattice points of opposite sign; 0 where there is none."""
    from sceneql.field.tape.tape_solid import field_gradients, field_values

    places = np.arange(len(points)).reshape(SAMPLES, SAMPLES, SAMPLES)
    pairs = np.concatenate(
        [
            np.stack([places.take(range(SAMPLES - 1), axis), places.take(range(1, SAMPLES), axis)], -1).reshape(-1, 2)
            for axis in range(3)
        ]
    )
    crossed = pairs[(values[pairs] < 0.0).sum(axis=1) == 1]
    inner = np.where(values[crossed[:, :1]] < 0.0, crossed, crossed[:, ::-1])[:: max(1, len(crossed) // PLACES)]
    a, b = points[inner[:, 0]], points[inner[:, 1]]
    for _ in range(TURNS):
        middle = 0.5 * (a + b)
        inside = (field_values(tape, middle) < 0.0)[:, None]
        a, b = np.where(inside, middle, a), np.where(inside, b, middle)
    steep = np.linalg.norm(field_gradients(tape, b), axis=1)
    steep = steep[np.isfinite(steep) & (steep > 0.0)]
    return float(np.median(steep)) if len(steep) else 0.0
