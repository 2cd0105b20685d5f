"""Outline of an object in the plane z = 0 as a closed line of equally spaced vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.grids.domain.domain import inside
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.skins.onto_level import onto

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Moment, Ref
    from sceneql.system import Assembly

SKINS = "a skin is that of a bounded object with an inside, as a `sphere`, an `implicit`, or a closed `mesh`"
LOOKED = 256
"""Cells along the longer side of an object's box, in which the contour is sampled."""
FINER = 8
"""Points of the contour per vertex."""
EVEN = 60
"""Largest number of iterations towards sides of equal length."""


def closed_line(ref: Ref, spacing: float, assembly: Assembly) -> Floats:
    """Vertices (n, 2) [m], counterclockwise, all sides equal and at most ``spacing`` [m] long.

    Raises ScriptError for an object without an inside, and for one without exactly one outline in the plane.
    """
    start = cast("Moment", Start(assembly))
    try:
        level, low, high, _ = inside(ref, True, start)
        rings = getattr(start.object(ref), "rings", None)
        if rings is not None:
            lines = list(rings().values())
            polish: Any = None
        else:
            lines, polish = _contour(level, low, high), _towards(level, float((high - low)[:2].max()))
    except (TypeError, ValueError) as error:
        text = f"'{ref.name}' cannot be a skin: {error}"
        raise ScriptError([Diagnostic("no-domain", text, ref.span, SKINS)]) from error
    if len(lines) != 1:
        what = f"has {len(lines)} outlines" if lines else "has no outline"
        text = f"'{ref.name}' {what} in the plane z = 0: a flat skin is one closed line"
        raise ScriptError([Diagnostic("no-domain", text, ref.span, "take an object without holes, in one piece")])
    return even(lines[0], spacing, polish)


def _contour(level: Any, low: Floats, high: Floats) -> list[Floats]:
    """Closed lines (k, 2) [m] on which a level is 0 in the plane z = 0."""
    from contourpy import contour_generator

    sides = (high - low)[:2]
    pitch = float(sides.max()) / LOOKED
    rows = [np.arange(a - 2.5 * pitch, b + 3.0 * pitch, pitch) for a, b in zip(low[:2], high[:2], strict=True)]
    x, y = np.meshgrid(*rows)
    values = level.values(np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])).reshape(x.shape)
    lines: Any = contour_generator(x, y, values).lines(0.0)
    return [line[:-1] for line in lines if len(line) > 3]


def _towards(level: Any, size: float) -> Any:
    """Function that moves points (k, 2) [m] onto the zero line of a level."""

    def polish(points: Floats) -> Floats:
        found: Floats = onto(level, size, np.column_stack([points, np.zeros(len(points))]), 2)[:, :2]
        return found

    return polish


def even(line: Floats, spacing: float, polish: Any = None) -> Floats:
    """Vertices (n, 2) on a closed line (k, 2), counterclockwise, sides equal; ``polish`` projects points onto it."""
    if signed_area(line) < 0.0:
        line = line[::-1]
    count = int(np.ceil(_chords(line).sum() / spacing))
    if polish is not None:
        line = polish(_at(line, np.arange(FINER * count) / (FINER * count)))
    count = max(3, int(np.ceil(_chords(line).sum() / spacing)))
    places = np.arange(count) / count
    for _ in range(EVEN):
        points = _at(line, places)
        points = points if polish is None else polish(points)
        sides = _chords(points)
        if np.ptp(sides) < 1e-12 * sides.mean():
            break
        ends = np.append(0.0, np.cumsum(sides)) / sides.sum()
        places = np.interp(np.arange(count) / count, ends, np.append(places, 1.0))
    found: Floats = points
    return found


def signed_area(line: Floats) -> float:
    """Area inside a closed line (k, 2), positive if it runs counterclockwise [m^2]."""
    x, y = (line - line[0]).T
    return float(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _chords(line: Floats) -> Floats:
    """Lengths (k,) [m] of the sides of a closed line, each from a point to the next."""
    found: Floats = np.hypot(*(np.roll(line, -1, axis=0) - line).T)
    return found


def _at(line: Floats, places: Floats) -> Floats:
    """Points (m, 2) of a closed line at fractions (m,) of its length."""
    ends = np.append(0.0, np.cumsum(_chords(line)))
    closed = np.vstack([line, line[:1]])
    return np.column_stack([np.interp(places * ends[-1], ends, closed[:, k]) for k in range(2)])
