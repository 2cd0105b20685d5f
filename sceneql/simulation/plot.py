"""A plot drawn into a picture: panel, axes, curves up to now with a dot at their end."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sceneql.kinds.texts import SUPERSCRIPTS, shown_unit
from sceneql.quantities.units import parse_unit
from sceneql.simulation.lettering import INK, PAPER, Letterer, font
from sceneql.simulation.plotting import Scale, scale_for, stroke, thousands

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import Floats

Color = tuple[int, int, int]

QUIET = (96, 96, 104)
"""Ink of numbers."""
SHARE = 0.3
"""A title below that is longer than this part of the panel has a line of its own."""
LINES, FINE_LINES = (0, 0, 0, 38), (0, 0, 0, 16)


@dataclass(frozen=True, slots=True)
class Curve:
    """A quantity over another (n,), SI, at times (n,) [s]; it is drawn up to ``now`` [s]."""

    name: str
    times: Floats
    across: Floats
    values: Floats
    color: Color
    now: float

    def drawn(self) -> tuple[Floats, Floats]:
        """The part up to now, whose last point lies between two that are known."""
        import numpy as np

        count = int(np.searchsorted(self.times, self.now, side="right"))
        x, y = self.across[:count], self.values[:count]
        if 0 < count < len(self.times):
            part = (self.now - self.times[count - 1]) / (self.times[count] - self.times[count - 1])
            x = np.append(x, x[-1] + part * (self.across[count] - x[-1]))
            y = np.append(y, y[-1] + part * (self.values[count] - y[-1]))
        return x, y


@dataclass(frozen=True, slots=True)
class Axis:
    """What stands along one side of a plot. ``unit``: empty for plain numbers; ``limits`` in SI."""

    title: str
    unit: str
    log: bool = False
    limits: tuple[float, float] | None = None

    def told(self, values: Any) -> Any:
        """Values in the unit."""
        unit = parse_unit(self.unit) if self.unit else None
        return values if unit is None else (values - unit.offset) / unit.scale

    def scale(self, values: Sequence[Any]) -> Scale:
        """Its scale, in the unit."""
        limits = None if self.limits is None else (self.told(self.limits[0]), self.told(self.limits[1]))
        return scale_for([self.told(value) for value in values], self.log, limits)

    def words(self, power: int) -> str:
        """Title, unit and power of ten of the numbers."""
        factor = "" if power == 0 else "10" + str(power).translate(SUPERSCRIPTS)
        unit = " ".join(part for part in (factor, shown_unit(self.unit) if self.unit else "") if part)
        return f"{self.title} [{unit}]" if unit and self.title else self.title or unit


def draw_plot(
    pixels: NDArray[uint8],
    box: tuple[int, int, int, int],
    curves: Iterable[Curve],
    up: Axis,
    across: Axis,
    opacity: float,
    text: float,
    named: bool,
) -> None:
    """Draw on a picture (h, w, 3) in a box (left, top, width, height) [pixels]; ``named``: with the curves' names.

    ``text``: height of letters in parts of the picture's.
    """
    from PIL import Image

    curves = list(curves)
    letters = Letterer(pixels, text)
    em, (left, top, wide, high) = letters.em, box
    small = font(max(9, round(0.82 * em)))
    pad = round(0.7 * em)
    letters.panel((left, top, left + wide - 1, top + high - 1), opacity)
    y_scale, x_scale = up.scale([c.values for c in curves]), across.scale([c.across for c in curves])
    y_power, x_power = thousands(y_scale), thousands(x_scale)
    y_told, x_told = _by(y_scale, y_power), _by(x_scale, x_power)

    head = _head(letters, box, pad, up.words(y_power), curves if named else [])
    title = across.words(x_power)
    apart = letters.draw.textlength(title, font=small) > SHARE * wide  # it has a line of its own
    y0, y1 = top + head, top + high - pad - round((2.35 if apart else 1.35) * em)
    if y1 - y0 < 2 * em or wide < 8 * em:
        raise ValueError("the graph has no room for its letters: a larger `size`, or a smaller `text`")
    marks = y_told.ticks(max(2, round((y1 - y0) / (2.2 * em))))
    widest = max((letters.draw.textlength(word, font=small) for _, word in marks), default=0.0)
    x0, x1 = left + pad + round(widest + 0.5 * em), left + wide - 1 - round(1.2 * em)
    thin = max(1, round(em / 22))

    def y_at(values: Any) -> Any:
        return y1 - y_scale.place(values) * (y1 - y0)

    def x_at(values: Any) -> Any:
        return x0 + x_scale.place(values) * (x1 - x0)

    for value in y_told.between():
        at = float(y_at(value * 10.0**y_power))
        letters.draw.line((x0, at, x1, at), FINE_LINES, thin)
    for value, word in marks:
        at = float(y_at(value * 10.0**y_power))
        letters.draw.line((x0, at, x1, at), LINES, thin)
        letters.draw.text((x0 - 0.45 * em, at), word, QUIET, font=small, anchor="rm")
    below, end = y1 + round(0.95 * em), x1 + 0.5 * em
    letters.draw.text((end, below + (round(1.05 * em) if apart else 0)), title, INK, font=small, anchor="rm")
    room = left + wide if apart else end - letters.draw.textlength(title, font=small) - 0.8 * em
    for value, word in x_told.ticks(max(2, round((x1 - x0) / (6 * em)))):
        at = float(x_at(value * 10.0**x_power))
        letters.draw.line((at, y0, at, y1), FINE_LINES, thin)
        if at + 0.5 * letters.draw.textlength(word, font=small) < room:
            letters.draw.text((at, below), word, QUIET, font=small, anchor="mm")
    letters.draw.line((x0, y1, x1, y1), QUIET, thin)

    reach = round(0.4 * em)  # dots and thick lines go a little over the ends
    area = (x0 - reach, y0 - reach, x1 + reach, y1 + reach)
    size = (area[2] - area[0], area[3] - area[1])
    for curve in curves:
        x, y = curve.drawn()
        points = _points(x_at(across.told(x)) - area[0], y_at(up.told(y)) - area[1])
        points[(points[:, 1] < -4 * size[1]) | (points[:, 1] > 5 * size[1])] = float("nan")
        letters.stamp(Image.new("RGB", size, curve.color), stroke(size, points, max(1.4, em / 9)), area[:2])
        if len(points) and 0 <= points[-1][0] <= size[0] and 0 <= points[-1][1] <= size[1]:
            for color, width in ((PAPER, 0.62 * em), (curve.color, 0.42 * em)):
                letters.stamp(Image.new("RGB", size, color), stroke(size, points[-1:], width), area[:2])
    letters.done()


def _points(x: Any, y: Any) -> Floats:
    import numpy as np

    return np.stack([np.asarray(x, dtype=float), np.asarray(y, dtype=float)], axis=1)


def _by(scale: Scale, power: int) -> Scale:
    """The scale in units of a power of ten."""
    return scale if power == 0 else Scale(scale.low / 10.0**power, scale.high / 10.0**power)


def _head(letters: Letterer, box: tuple[int, int, int, int], pad: int, title: str, curves: Sequence[Curve]) -> int:
    """Title, and curves with their colors and names; the height [pixels] of it all."""
    em, (left, top, wide, _) = letters.em, box
    at, row = left + pad, top + pad + 0.5 * em
    if title:
        letters.text((at, row), title)
        at += letters.extent(title)[0] + round(1.4 * em)
    for curve in curves:
        length = round(1.0 * em) + round(0.4 * em) + letters.extent(curve.name)[0]
        if at + length > left + wide - pad and at > left + pad:
            at, row = left + pad, row + 1.3 * em
        letters.draw.line((at, row, at + em, row), curve.color, max(2, round(em / 6)))
        letters.text((at + 1.4 * em, row), curve.name)
        at += length + round(1.2 * em)
    return int(row - top + (1.15 if title or curves else 0.2) * em)
