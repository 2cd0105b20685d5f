"""The observed order of convergence: the slope of log(error) against log(step) where the method is in its regime."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise
from math import isfinite, log

LARGEST_ERROR = 0.1
"""Relative errors above this are not small: the leading term of the error does not rule yet."""
LEAST_POINTS = 3


def observed_order(steps: Sequence[float], errors: Sequence[float], floor: float = 1e-12) -> float | None:
    """Least-squares slope of log(error) over log(step) in the asymptotic range; None where there is none.

    ``steps`` [s] and relative ``errors`` belong together; ``floor`` is the error below which rounding or the
    reference rules. The asymptotic range is the longest run of neighboring points, below LARGEST_ERROR and above the
    floor, whose slopes from point to point stay within a tenth (at least 0.1) of that run's own slope; of equally long
    runs the one at the smaller steps. (Cf. Roache 1998, section 5: a grid study must show that it is asymptotic.)
    """
    usable = sorted(
        (log(h), log(e))
        for h, e in zip(steps, errors, strict=True)
        if h > 0.0 and isfinite(e) and floor < e < LARGEST_ERROR
    )
    runs = sorted(combinations(range(len(usable) + 1), 2), key=lambda run: (run[0] - run[1], run[0]))
    for first, end in runs:
        if end - first < LEAST_POINTS:
            return None
        run = usable[first:end]
        slope = _slope(run)
        local = [_slope([a, b]) for a, b in pairwise(run)]
        if slope is not None and all(s is not None and abs(s - slope) <= max(0.1, 0.1 * slope) for s in local):
            return slope
    return None


def _slope(points: Sequence[tuple[float, float]]) -> float | None:
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    if spread == 0.0:
        return None
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread
