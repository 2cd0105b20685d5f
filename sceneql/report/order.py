"""Observed order of convergence: the slope of log(error) against log(step) in the asymptotic range."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite, log, nan

LARGEST_ERROR = 0.1
"""Relative errors above this are outside of the asymptotic range."""
LEAST_POINTS = 4
SPREADS = (0.1, 0.2, 0.4)
"""Allowed spreads of the slopes between neighbors about a range's own slope; the first one that some range meets is
used."""


def observed_order(steps: Sequence[float], errors: Sequence[float], floor: float = 1e-12) -> float | None:
    """Least-squares slope of log(error) over log(step) in the asymptotic range; None where there is none.

    ``steps`` [s] and relative ``errors`` belong together; ``floor``: the error below which rounding or the reference
    dominates. The asymptotic range is the longest run of neighboring points, below LARGEST_ERROR and above the floor,
    whose slopes from point to point all lie close to the run's own (SPREADS). It must include the smallest step or the
    one next to it: a straight piece that bends below is no order.
    """
    usable = sorted(
        (log(h), log(e))
        for h, e in zip(steps, errors, strict=True)
        if h > 0.0 and isfinite(e) and floor < e < LARGEST_ERROR
    )
    ranges = [(first, end) for first in (0, 1) for end in range(first + LEAST_POINTS, len(usable) + 1)]
    for spread in SPREADS:
        for first, end in sorted(ranges, key=lambda pair: pair[0] - pair[1]):
            slope = _slope(usable[first:end])
            if all(abs(_slope(two) - slope) <= spread for two in pairwise(usable[first:end])):
                return slope
    return None


def _slope(points: Sequence[tuple[float, float]]) -> float:
    """Least-squares slope of points (x, y); NaN where all have the same x."""
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread if spread > 0.0 else nan
