"""Plot drawn into a picture: panel, axes, and curves up to now with dots at their ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sceneql.kinds.texts import SUPERSCRIPTS, shown_unit
from sceneql.pictures.lettering import FEWEST, Letterer, Look, font
from sceneql.pictures.plotting import Scale, scale_for, stroke, thousands
from sceneql.quantities.units import parse_unit

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import Floats

Color = tuple[int, int, int]

FEW = 12
"""Largest number of curves with dots at their ends."""
MOST_TICKS = 5
"""Approximate largest number of ticks on an axis."""
SHARE = 0.3
"""Length of the title below, relative to the panel, above which it gets its own line."""
TITLE_LINES = 2
"""Largest number of lines of the title above; longer titles are cut."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Quantity ``values`` over another, ``across``, (n,) each, SI, at times (n,) [s]; drawn up to ``now`` [s]."""

    name: str
    times: Floats
    across: Floats
    values: Floats
    color: Color
    now: float

    def drawn(self) -> tuple[Floats, Floats]:
        """Abscissas and ordinates of the curve up to now, with the last point interpolated."""
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
    """Axis of a plot. ``unit``: empty for plain numbers; ``limits`` in SI."""

    title: str
    unit: str
    log: bool = False
    limits: tuple[float, float] | None = None

    def told(self, values: Any) -> Any:
        """Values in SI converted to the axis's unit."""
        unit = parse_unit(self.unit) if self.unit else None
        return values if unit is None else (values - unit.offset) / unit.scale

    def scale(self, values: Sequence[Any]) -> Scale:
        """Scale for values in SI, in the axis's unit."""
        limits = None if self.limits is None else (self.told(self.limits[0]), self.told(self.limits[1]))
        return scale_for([self.told(value) for value in values], self.log, limits)

    def words(self, power: int) -> str:
        """Title with unit and the power of ten that the ticks leave out."""
        factor = "" if power == 0 else "10" + str(power).translate(SUPERSCRIPTS)
        unit = " ".join(part for part in (factor, shown_unit(self.unit) if self.unit else "") if part)
        return f"{self.title} [{unit}]" if unit and self.title else self.title or unit


def draw_plot(
    pixels: NDArray[uint8],
    curves: Sequence[Curve],
    up: Axis,
    across: Axis,
    opacity: float,
    text: float,
    scale: float,
    look: Look,
    named: bool,
) -> None:
    """Draw a plot over a whole panel (h, w, 3) of a picture; ``named``: with the curves' names.

    ``text``: height of letters relative to the panel's height; ``scale``: height of the whole picture over that of
    the panel. A panel too small for letters shows the curves alone.
    """
    letters = Letterer(pixels, text, look, scale)
    em, wide, high = letters.em, letters.width, letters.height
    small = font(max(letters.least, round(0.82 * em)))
    pad = round(0.7 * em)
    letters.panel((0, 0, wide - 1, high - 1), opacity)
    y_scale, x_scale = up.scale([c.values for c in curves]), across.scale([c.across for c in curves])
    y_power, x_power = thousands(y_scale), thousands(x_scale)
    shown = [curve for curve in curves if _within(up, y_scale, curve)] if named else []
    head, words = _head(letters, wide - 2 * pad, up.words(y_power), shown, TITLE_LINES)
    if high - 2 * pad - round(head) < round(4.35 * em):  # a title of one line leaves more room for the curves
        head, words = _head(letters, wide - 2 * pad, up.words(y_power), shown, 1)
    title = across.words(x_power)
    length = letters.draw.textlength(title, font=small)
    x1, low = wide - 1 - round(1.2 * em), high - pad
    tries: list[tuple[_Area, list[tuple[float, str]], list[tuple[float, str]], bool]] = []
    for apart in (length > SHARE * wide, True):  # whether the title below has its own line
        y0, y1 = pad + round(head), low - round((2.35 if apart else 1.35) * em)
        if y1 - y0 < 2 * em or wide < 8 * em:
            break
        marks = _scaled(y_scale, y_power).ticks(min(max(FEWEST, round((y1 - y0) / (2.2 * em))), MOST_TICKS))
        widest = max((letters.draw.textlength(word, font=small) for _, word in marks), default=0.0)
        x0 = pad + round(widest + 0.5 * em)
        area = _Area(x0, y0, max(x1, x0 + 1), y1, x_scale, y_scale)
        columns = _columns(letters, small, area, x_power, wide if apart else x1 - length - 0.3 * em)
        tries.append((area, marks, columns, apart))
        if sum(word != "" for _, word in columns) >= FEWEST:
            break
    bare = not tries
    area, marks, columns, apart = (
        tries[-1] if tries else (_Area(pad, pad, max(x1, pad + 1), max(low, pad + 1), x_scale, y_scale), [], [], False)
    )
    x0, y0, x1, y1 = area.x0, area.y0, area.x1, area.y1

    thin = max(1, round(em / 22))
    if not bare:
        for x, row, curve, word in words:
            at = (pad + x, pad + row)
            if curve is not None:
                letters.draw.line(
                    (at[0] - 1.4 * em, at[1], at[0] - 0.4 * em, at[1]), curve.color, max(2, round(em / 6))
                )
            letters.text(at, word)
        for value in y_scale.between():
            letters.draw.line((x0, area.y(value), x1, area.y(value)), look.fine, thin)
        for value, word in marks:
            y = float(area.y(value * 10.0**y_power))
            letters.draw.line((x0, y, x1, y), look.lines, thin)
            letters.draw.text((x0 - 0.45 * em, y), word, look.quiet, font=small, anchor="rm")
        below, end = y1 + round(0.95 * em), x1 + 0.5 * em
        letters.draw.text((end, below + (round(1.05 * em) if apart else 0)), title, look.ink, font=small, anchor="rm")
        for x, word in columns:
            letters.draw.line((x, y0, x, y1), look.fine, thin)
            letters.draw.text((x, below), word, look.quiet, font=small, anchor="mm")
    letters.draw.line((x0, y1, x1, y1), look.quiet, thin)
    for curve in curves:
        along, values = curve.drawn()
        _draw_curve(letters, area, across.told(along), up.told(values), curve.color, dot=len(curves) <= FEW)
    letters.done()


@dataclass(frozen=True, slots=True)
class _Area:
    """Rectangle between the axes [pixels], and their scales."""

    x0: int
    y0: int
    x1: int
    y1: int
    across: Scale
    up: Scale

    def x(self, values: Any) -> Any:
        """Columns [pixels] of values."""
        return self.x0 + self.across.place(values) * (self.x1 - self.x0)

    def y(self, values: Any) -> Any:
        """Rows [pixels] of values."""
        return self.y1 - self.up.place(values) * (self.y1 - self.y0)


def _draw_curve(letters: Letterer, area: _Area, x: Floats, y: Floats, color: Color, *, dot: bool) -> None:
    """Draw a curve; ``dot``: with a dot at its end."""
    import numpy as np

    reach = round(0.4 * letters.em)  # margin for dots and thick lines at the area's edges
    corner = (area.x0 - reach, area.y0 - reach)
    size = (area.x1 + reach - corner[0], area.y1 + reach - corner[1])
    points = np.stack([area.x(x) - corner[0], area.y(y) - corner[1]], axis=1)
    points[(points[:, 1] < -4 * size[1]) | (points[:, 1] > 5 * size[1])] = float("nan")
    lines = [(points, max(1.4, letters.em / 9), color)]
    if dot and len(points) and 0 <= points[-1][0] <= size[0] and 0 <= points[-1][1] <= size[1]:
        lines += [(points[-1:], 0.62 * letters.em, letters.look.paper), (points[-1:], 0.42 * letters.em, color)]
    for line, width, ink in lines:
        drawn = stroke(size, line, width)
        if drawn is not None:
            mask, (left, top) = drawn
            letters.stamp(ink, mask, (corner[0] + left, corner[1] + top))


def _scaled(scale: Scale, power: int) -> Scale:
    """Scale in units of a power of ten."""
    return scale if power == 0 else Scale(scale.low / 10.0**power, scale.high / 10.0**power)


def _columns(letters: Letterer, small: Any, area: _Area, power: int, room: float) -> list[tuple[float, str]]:
    """Columns [pixels] of ticks and their texts; a text without room is empty.

    If possible at least FEWEST texts end left of ``room`` [pixels].
    """
    scale = _scaled(area.across, power)
    wanted = min(max(FEWEST, round((area.x1 - area.x0) / (6 * letters.em))), MOST_TICKS)
    found: list[list[tuple[float, str]]] = []
    for count in range(wanted, wanted + FEWEST + 1):
        ticks: list[tuple[float, str]] = []
        end = -math.inf
        for value, word in scale.ticks(count):
            x, half = float(area.x(value * 10.0**power)), 0.5 * letters.draw.textlength(word, font=small)
            fits = x - half > end + 0.4 * letters.em and x + half < room
            ticks.append((x, word if fits else ""))
            end = x + half if fits else end
        found.append(ticks)
        if sum(word != "" for _, word in ticks) >= FEWEST:
            return ticks
    return found[0]


def _within(up: Axis, scale: Scale, curve: Curve) -> bool:
    """Whether any point of a curve, at any time of the run, lies within the vertical axis."""
    import numpy as np

    values = np.asarray(up.told(curve.values), dtype=float)
    return bool(((values >= scale.low) & (values <= scale.high)).any())


def _head(
    letters: Letterer, wide: int, title: str, curves: Sequence[Curve], rows: int = TITLE_LINES
) -> tuple[float, list[tuple[float, float, Curve | None, str]]]:
    """Height of title and names [pixels], and column, row, curve and text of each.

    Names that need several lines are spread evenly over them. ``rows``: largest number of lines of the title.
    """
    told = letters.wrapped(title, letters.width - 1.4 * letters.em, rows)
    lines = len(_lines(letters, wide, told, curves))
    while wide > 0 and len(_lines(letters, wide - letters.em, told, curves)) == lines:
        wide -= letters.em
    em = letters.em
    found = [
        (at, (0.5 + 1.3 * k) * em, curve, text)
        for k, line in enumerate(_lines(letters, wide, told, curves))
        for at, curve, text in line
    ]
    return (found[-1][1] + 1.15 * em if found else 0.7 * em), found


def _lines(
    letters: Letterer, wide: int, title: Sequence[str], curves: Sequence[Curve]
) -> list[list[tuple[float, Curve | None, str]]]:
    """Title and names in lines of a width [pixels]; each text with the column of its left end and its curve."""
    em, at = letters.em, 0.0
    lines: list[list[tuple[float, Curve | None, str]]] = [[(0.0, None, line)] for line in title] or [[]]
    if title:
        at = letters.extent(title[-1])[0] + 1.4 * em
    for curve in curves:
        length = 1.4 * em + letters.extent(curve.name)[0]
        if at + length > wide and at > 0:
            at = 0.0
            lines.append([])
        lines[-1].append((at + 1.4 * em, curve, curve.name))
        at += length + 1.2 * em
    return lines
