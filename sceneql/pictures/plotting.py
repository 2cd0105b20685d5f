"""Axes of plots in pictures: limits, ticks and their texts; antialiased strokes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from sceneql.kinds.texts import SUPERSCRIPTS
from sceneql.pictures.lettering import FEWEST, marked_numbers

if TYPE_CHECKING:
    from sceneql.frame import Floats

FINE = 4
"""Supersampling factor of strokes."""
SMALLEST = 1e-200
"""Smallest value that a logarithmic axis includes."""
FEW_DECADES = 3
"""Largest number of decades for which there are finer lines between powers of ten."""


@dataclass(frozen=True, slots=True)
class Scale:
    """Scale of an axis from low to high, linear or logarithmic."""

    low: float
    high: float
    log: bool = False

    def place(self, values: Any) -> Floats:
        """Positions of values, 0 at the low end and 1 at the high one; NaN for values without a logarithm."""
        import numpy as np

        values = np.asarray(values, dtype=float)
        if not self.log:
            return np.asarray((values - self.low) / (self.high - self.low))
        with np.errstate(all="ignore"):
            logs = np.where(values >= SMALLEST, np.log10(values), np.nan)
        low, high = math.log10(self.low), math.log10(self.high)
        return np.asarray((logs - low) / (high - low))

    def ticks(self, count: int) -> list[tuple[float, str]]:
        """About ``count`` round numbers with their texts; at least FEWEST, unless ``count`` is less."""
        if not self.log:
            values = marked_numbers(self.low, self.high, count)
            step = values[1] - values[0] if len(values) > 1 else abs(self.high - self.low)
            digits = max(0, -math.floor(math.log10(step) + 1e-9))
            return [(value, f"{value + 0.0:.{digits}f}".replace("-", "\u2212")) for value in values]
        first, last = math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9)
        if last - first < 2:  # too few powers of ten
            values = [m * 10.0**k for k in range(first - 1, last + 1) for m in (1, 2, 5)]
            values = [v for v in values if self.low * (1 - 1e-9) <= v <= self.high * (1 + 1e-9)]
            if len(values) < min(FEWEST, count):
                values = marked_numbers(self.low, self.high, count)
            nearest = min((b - a for a, b in pairwise(values)), default=self.high)
            digits = max(6, math.ceil(math.log10(self.high / nearest)) + 1)
            return [(v, f"{v:.{digits}g}") for v in values]
        every = min(math.ceil((last - first + 1) / count), (last - first) // 2)
        powers = range(last - (last - first) // every * every, last + 1, every)
        return [(10.0**k, "10" + str(k).translate(SUPERSCRIPTS) if k not in (0, 1) else str(10**k)) for k in powers]

    def between(self) -> list[float]:
        """Values of the finer lines of a logarithmic axis."""
        if not self.log or math.log10(self.high / self.low) > FEW_DECADES:
            return []
        powers = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)))
        return [m * 10.0**k for k in powers for m in range(2, 10) if self.low < m * 10.0**k < self.high]


def scale_for(values: Sequence[Any], log: bool, limits: tuple[float, float] | None) -> Scale:
    """Scale that contains all finite values with a margin, or that has the given limits."""
    import numpy as np

    if limits is not None:
        return Scale(*limits, log)
    known = np.concatenate([np.ravel(v) for v in values]) if len(values) else np.zeros(0)
    known = known[np.isfinite(known) & ((known >= SMALLEST) | (not log))]
    low, high = (float(known.min()), float(known.max())) if len(known) else (1.0, 1.0)
    if log:
        room = 10 ** max(0.06 * math.log10(high / low), 0.05)
        return Scale(low / room, high * room, log)
    room = 0.07 * (high - low) or 0.07 * abs(high) or 1.0
    room = max(room, 2.0 * math.ulp(max(abs(low), abs(high))))  # so that rounding does not remove it
    return Scale(low - room, high + room)


def thousands(scale: Scale) -> int:
    """Power of ten that the ticks of a linear axis are divided by, a multiple of 3; 0 for short numbers."""
    most = max(abs(scale.low), abs(scale.high))
    if scale.log or 1e-3 <= most < 1e5:
        return 0
    return 3 * math.floor(math.log10(most) / 3)


def stroke(size: tuple[int, int], points: Floats, width: float) -> tuple[Any, tuple[int, int]] | None:
    """Mask (Pillow, 8 bits) of a line through points (n, 2) [pixels], and its left and top.

    The line is broken at NaN and has round ends; ``size``: that of the area. None if no part of it lies inside.
    """
    import numpy as np
    from PIL import Image, ImageDraw

    known = np.isfinite(points).all(axis=1)
    if not known.any():
        return None
    reach = 0.5 * width + 1
    low = np.maximum(np.floor(points[known].min(axis=0) - reach), 0).astype(int)
    high = np.minimum(np.ceil(points[known].max(axis=0) + reach), size).astype(int)
    if (high <= low).any():
        return None
    left, top = (int(edge) for edge in low)
    mask = Image.new("L", (int(high[0] - low[0]) * FINE, int(high[1] - low[1]) * FINE))
    draw = ImageDraw.Draw(mask)
    thick = max(1, round(width * FINE))
    ends = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    for first, last in ends.reshape(-1, 2):
        # Points far outside are clipped: Pillow's integer coordinates would overflow.
        near = (np.clip(points[first:last], -4.0 * max(size), 5.0 * max(size)) - low) * FINE
        places = [(float(x), float(y)) for x, y in near]
        draw.line(places, fill=255, width=thick, joint="curve")
        for x, y in (places[0], places[-1]):
            half = 0.5 * thick
            draw.ellipse((x - half, y - half, x + half, y + half), fill=255)
    return mask.reduce(FINE), (left, top)
