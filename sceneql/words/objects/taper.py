"""taper: an object that gets thinner or wider along an axis."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Any

from sceneql.kinds import FieldBuilder, Length, Moment, Problem, Scalar, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.solid import less
from sceneql.shapes.warp import AxisName, Registers, Warp, axes, steepest


class Taper(Warp):
    """An object whose cross-sections are scaled by a factor s that goes evenly from 1 to `factor` along an axis.

    (x, y, z) goes to (s x, y, s z) with s = 1 at the height `from` and below, `factor` at `to` and above (Barr 1984).
    So it holds the integral of s^2 times the area of its sections. Its field is s times the object's, divided by the
    most that this can be steeper. Any object with an inside can be tapered, so no mesh; it keeps the object's
    colors.
    """

    factor: Scalar = field("How much as wide it is at `to`.", "0.5", above=0)
    along: AxisName = field("The taper's own axis, about which it scales.", "y")
    from_: Length | None = field("The height at which it begins; by default where the object does.", None)
    to: Length | None = field("The height at which it ends; by default where the object does.", None)

    def problems(self) -> Iterator[Problem]:
        """An end that is not above the start."""
        ends = [end.number() for end in (self.from_, self.to) if end is not None and end.constant]
        if len(ends) == 2 and ends[0] >= ends[1]:
            yield Problem("a taper ends above its start", ("to",))

    def _ends(self, low: Any, high: Any, moment: Moment) -> tuple[float, float]:
        """Start and end along the axis [m]. Raises ValueError unless the end lies above the start."""
        along, _, _ = axes(self.along)
        start = float(low[along] if self.from_ is None else moment.at(self.from_))
        stop = float(high[along] if self.to is None else moment.at(self.to))
        self.bounded("along the axis of the taper, which so needs `from` and `to`", start, stop)
        if start >= stop:
            raise ValueError(f"it tapers from {start:.4g} m to {stop:.4g} m, which is not above")
        return start, stop

    def back(
        self, build: FieldBuilder, point: Registers, low: Any, high: Any, moment: Moment
    ) -> tuple[Registers, int | None]:
        """Scaled back by the factor at its height."""
        factor = positive(moment, self.factor, "factor")
        if factor == 1.0:
            return point, None
        along, a, b = axes(self.along)
        start, stop = self._ends(low, high, moment)
        widest = hypot(max(-low[a], high[a]), max(-low[b], high[b]))
        self.bounded("across the axis of the taper", widest)
        slope = (factor - 1.0) / (stop - start)
        line = build.op("mul", less(build, point[along], start), build.constant(slope))
        line = build.op("add", line, build.constant(1.0))
        ends = sorted((1.0, factor))
        scale = build.op("clamp", line, build.constant(ends[0]), build.constant(ends[1]))
        place = list(point)
        place[a], place[b] = build.op("div", point[a], scale), build.op("div", point[b], scale)
        steeper = steepest(1.0, widest * abs(slope), ends[1])
        return (place[0], place[1], place[2]), build.op("mul", scale, build.constant(1.0 / steeper))

    def around(self, low: Any, high: Any, moment: Moment) -> tuple[Any, Any]:
        """The box with its sides across the axis scaled by the least and the largest factor that it meets."""
        factor = positive(moment, self.factor, "factor")
        least, most = list(low), list(high)
        if factor != 1.0:
            along, a, b = axes(self.along)
            start, stop = self._ends(low, high, moment)
            shares = [min(max((end - start) / (stop - start), 0.0), 1.0) for end in (low[along], high[along])]
            scales = [1.0 + (factor - 1.0) * share for share in shares]
            for axis in (a, b):
                least[axis] = min(low[axis] * scale for scale in scales)
                most[axis] = max(high[axis] * scale for scale in scales)
        return least, most
