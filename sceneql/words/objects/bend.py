"""bend: a beam bent along a circle."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin
from typing import Any

from sceneql.kinds import Angle, FieldBuilder, Length, Moment, Problem, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.warp import AxisName, Registers, Warp, arc

WHOLE = 2 * pi - 1e-9
"""Bending angle [rad] at which the ends of a beam meet."""


class Bend(Warp):
    """An object bent as a beam, whose axis becomes an arc of a circle and keeps its length (Barr 1984).

    The axis y becomes an arc through the origin, which turns from y towards x by the angle y / R, where R is
    per / angle; sections stay plane and square to it: (x, y) goes to (R - (R - x) cos(y / R), (R - x) sin(y / R)).
    A negative angle bends away from x. It is squeezed on the inner side, where its field is divided by the most that
    it becomes steeper, R / (R - x). The beam must end before the circle's center and before a full turn. Any object
    with an inside can be bent, so no mesh; it keeps the object's colors.
    """

    angle: Angle = field("By how much it turns on the length `per`.", "90 deg")
    per: Length = field("The length on which it turns by the angle.", "1 m", above=0)
    along: AxisName = field("The bend's own axis along which the beam lies.", "y")
    towards: AxisName = field("The axis that it is bent towards.", "x")

    def problems(self) -> Iterator[Problem]:
        """A beam that is to be bent towards itself."""
        if self.along == self.towards:
            yield Problem("a beam is bent towards another axis than its own", ("towards",))

    def _rate(self, moment: Moment) -> float:
        """Curvature of the circle [1/m], with its sign."""
        return float(moment.at(self.angle)) / positive(moment, self.per, "per")

    def _axes(self) -> tuple[int, int, int]:
        """Indices of the axes x, y, z of the class's docstring."""
        x, y = "xyz".index(self.towards), "xyz".index(self.along)
        return x, y, 3 - x - y

    def _sector(self, low: Any, high: Any, rate: float) -> tuple[float, float, float, float]:
        """Inner and outer radius, relative to the circle's, and first and last angle [rad] of the bent box.

        Raises ValueError for a box that reaches the circle's center, or is bent by a whole turn.
        """
        x, y, _ = self._axes()
        self.bounded("and cannot be bent", low[x], high[x], low[y], high[y])
        inner, outer = sorted((1.0 - rate * low[x], 1.0 - rate * high[x]))
        first, last = sorted((rate * low[y], rate * high[y]))
        if inner <= 0.0:
            raise ValueError(
                f"'{self.of.name}' reaches the center of the circle that it is bent along, {abs(1 / rate):.4g} m away:"
                " bend less, or a thinner beam"
            )
        if last - first >= WHOLE:
            raise ValueError(f"'{self.of.name}' would be bent by {(last - first) / (2 * pi):.4g} turns: less than one")
        return inner, outer, first, last

    def back(
        self, build: FieldBuilder, point: Registers, low: Any, high: Any, moment: Moment
    ) -> tuple[Registers, int | None]:
        """Unrolled: from the distance to the circle's center and the angle there, counted from the beam's middle."""
        import numpy as np

        rate = self._rate(moment)
        if rate == 0.0:
            return point, None
        x, y, z = self._axes()
        inner, _, first, last = self._sector(low, high, rate)
        middle = 0.5 * (first + last)
        c, s = cos(middle), sin(middle)
        seen = np.array([[-c * rate, s * rate, 0.0, c], [s * rate, c * rate, 0.0, -s], [0.0, 0.0, 1.0, 0.0]])
        u, v, _ = build.affine(seen, point[x], point[y], point[z])
        away = build.op("sqrt", build.op("add", build.op("square", u), build.op("square", v)))
        turned = build.op("add", build.op("atan2", v, u), build.constant(middle))
        place = list(point)
        per_rate = build.constant(1.0 / rate)
        place[x] = build.op("mul", build.op("sub", build.constant(1.0), away), per_rate)
        place[y] = build.op("mul", turned, per_rate)
        steeper = max(1.0, 1.0 / inner)
        return (place[0], place[1], place[2]), build.constant(1.0 / steeper) if steeper > 1.0 else None

    def around(self, low: Any, high: Any, moment: Moment) -> tuple[Any, Any]:
        """The box around its sector of a ring."""
        rate = self._rate(moment)
        least, most = list(low), list(high)
        if rate != 0.0:
            x, y, _ = self._axes()
            inner, outer, first, last = self._sector(low, high, rate)
            arcs = [arc(radius, first, last) for radius in (inner, outer)]
            xs = [(1.0 - cosine) / rate for one in arcs for cosine in one[0]]
            ys = [sine / rate for one in arcs for sine in one[1]]
            least[x], most[x], least[y], most[y] = min(xs), max(xs), min(ys), max(ys)
        return least, most
