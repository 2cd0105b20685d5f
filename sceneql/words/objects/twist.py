"""twist: an object rotated in proportion to the height along an axis."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, hypot
from typing import Any, ClassVar

from sceneql.kinds import Angle, FieldBuilder, Length, Moment, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.warp import AxisName, Registers, Warp, arc, axes, steepest


class Twist(Warp):
    """An object whose cross-sections are turned about an axis of the twist by an angle that grows along it (Barr 1984).

    The section at height y is turned by angle y / per, by the right-hand rule; that at 0 stays. Volume stays, since
    every section keeps its area. With the angle w per length and the distance r of its farthest point from the axis,
    its field is divided by (w r + sqrt(w^2 r^2 + 4)) / 2, the most that it becomes steeper. Any object with an inside
    can be twisted, so no mesh; it keeps the object's colors.
    """

    said_by: ClassVar[Mapping[str, str]] = {"axis": "it is one of the twist's own: write `about: y`, or `x` or `z`"}

    angle: Angle = field("By how much it turns on the length `per`.", "90 deg")
    per: Length = field("The length on which it turns by the angle.", "1 m", above=0)
    about: AxisName = field("The twist's own axis that it turns about.", "y")

    def _rate(self, moment: Moment) -> float:
        """Rotation per length along the axis [rad/m]."""
        return float(moment.at(self.angle)) / positive(moment, self.per, "per")

    def back(
        self, build: FieldBuilder, point: Registers, low: Any, high: Any, moment: Moment
    ) -> tuple[Registers, int | None]:
        """Turned back by the angle at its height."""
        rate = self._rate(moment)
        along, a, b = axes(self.about)
        if rate == 0.0:
            return point, None
        widest = hypot(max(-low[a], high[a]), max(-low[b], high[b]))
        self.bounded("and cannot be twisted", widest)
        angle = build.op("mul", point[along], build.constant(rate))
        cosine, sine = build.op("cos", angle), build.op("sin", angle)
        place = list(point)
        place[a] = build.op("add", build.op("mul", cosine, point[a]), build.op("mul", sine, point[b]))
        place[b] = build.op("sub", build.op("mul", cosine, point[b]), build.op("mul", sine, point[a]))
        return (place[0], place[1], place[2]), build.constant(1.0 / steepest(1.0, abs(rate) * widest, 1.0))

    def around(self, low: Any, high: Any, moment: Moment) -> tuple[Any, Any]:
        """The arcs of the box's edges along the axis."""
        rate = self._rate(moment)
        along, a, b = axes(self.about)
        least, most = list(low), list(high)
        if rate != 0.0:
            self.bounded("and cannot be twisted", low[a], high[a], low[b], high[b])
            turns = sorted((rate * low[along], rate * high[along]))
            arcs = []
            for u in (low[a], high[a]):
                for v in (low[b], high[b]):
                    start = atan2(v, u)
                    arcs.append(arc(hypot(u, v), start + turns[0], start + turns[1]))
            for k, axis in enumerate((a, b)):
                least[axis], most[axis] = min(one[k][0] for one in arcs), max(one[k][1] for one in arcs)
        return least, most
