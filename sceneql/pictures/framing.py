"""Camera positions and directions for which a box fills the picture."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Object, Ref, Value
from sceneql.shapes.placement import apply
from sceneql.shapes.solid import LARGEST, triple

if TYPE_CHECKING:
    from sceneql.frame import Floats, View
    from sceneql.kinds import Moment

NEAREST = 1e-3
"""Least distance [m] of a camera from the points that it is fitted to."""


GAP = 0.035
"""Free space between overlays and the subject, relative to the picture's height."""


def axes_towards(back: Any, up: Any = (0.0, 1.0, 0.0)) -> Floats:
    """Axes (3, 3), rows right, up, back, of a camera that looks along -back, with ``up`` upward in the picture.

    For a camera that looks along ``up`` another axis replaces it. Raises ValueError for a ``back`` that is zero or
    longer than LARGEST [m].
    """
    import numpy as np

    b, u = np.asarray(back, dtype=float), np.asarray(up, dtype=float)
    if np.abs([b, u]).max() > LARGEST:
        raise ValueError(f"a camera stands within {LARGEST:g} m of what it looks at")
    far = float(np.linalg.norm(b))
    if not far > 0:
        raise ValueError("a camera cannot look at its own position")
    b = b / far
    for candidate in (u, np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])):
        right = np.cross(candidate, b)
        if np.linalg.norm(right) > 1e-9 * np.linalg.norm(candidate):
            break
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(b, right), b])


LONGEST, FINE = 12.0, 16.0
"""Memory of a follower, in lags, and number of samples in one lag."""


def corners(low: Any, high: Any) -> Floats:
    """Corners (8, 3) of a box."""
    import numpy as np

    return np.array(list(product(*zip(low, high, strict=True))), dtype=float)


def bounds(moment: Moment, refs: Iterable[Ref] | None) -> tuple[Floats, Floats]:
    """Low and high corner (3,) [m] around the named parts, or around all that is drawn, over the whole film."""
    return moment.bounds([ref.name for ref in refs or ()])


def fitted(
    points: Floats, axes: Floats, slopes: tuple[float, float], aim: Any = None, middle: tuple[float, float] = (0.0, 0.0)
) -> tuple[Floats, float]:
    """Position (3,) [m] and distance [m] of the nearest camera that sees all points (n, 3) [m]; exact, not iterative.

    ``slopes``: half width and half height, at distance 1, of the picture's part that the points shall fill;
    ``middle``: that part's center, to the right and up. With ``aim`` (3,) the camera looks at that point, else it
    shifts sideways to fill the part best.

    Let p be a point's coordinate across, b its depth towards the camera, k the slope and m the middle. The point is
    visible from distance D and place s across if |p - s - m (D - b)| <= k (D - b). So
    D >= (max(p + (k + m) b) - min(p - (k - m) b))/(2 k), and s is the center of the remaining interval.
    """
    import numpy as np

    center = np.asarray(aim, dtype=float) if aim is not None else (points.min(axis=0) + points.max(axis=0)) / 2
    right, up, back = axes
    depth = (points - center) @ back
    distance, shift = float(depth.max()) + NEAREST, np.zeros(3)
    sides = []
    for axis, slope, off in ((right, slopes[0], middle[0]), (up, slopes[1], middle[1])):
        p = (points - center) @ axis + off * depth
        if aim is not None:
            distance = max(distance, float((depth + np.abs(p) / slope).max()))
        else:
            above, below = float((p + slope * depth).max()), float((p - slope * depth).min())
            distance = max(distance, (above - below) / (2 * slope))
            sides.append((axis, off, above, below))
    for axis, off, above, below in sides:
        shift += ((above + below) / 2 - off * distance) * axis
    return center + shift + distance * back, distance


def whereabouts(moment: Moment, ref: Ref) -> Any:
    """Place (3,) [m] of a part now: its position, the center of its box, or the center of its masses."""
    part: Any = moment.object(ref)
    if isinstance(part, Object):
        place = moment.place(ref.name)
        position = getattr(part, "position", None)
        if isinstance(position, Value):
            return apply(place, moment.at(position))
        low, high = part.extent(place, moment)
        return (low + high) / 2
    return moment.read(ref.name, "center" if "center" in part.gives else "position")


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Place of a part as a value whose past can be kept (kinds.moment.Seen)."""

    ref: Ref

    def at(self, moment: Moment) -> Any:
        """Place (3,) [m] now."""
        return whereabouts(moment, self.ref)


def behind(past: Sequence[tuple[float, Any]], now: float, place: Any, lag: float) -> Any:
    """Position (3,) [m] of a follower with the velocity (place - own position)/lag, which starts at the first place.

    The solution is the mean of past places with weight exp(-age/lag). It is exact for a place that moves on straight
    lines between the samples (time [s], place) of ``past``.
    """
    import numpy as np

    times = np.array([*(time for time, _ in past), now])
    places = np.array([*(where for _, where in past), place], dtype=float)
    ages = (now - times) / lag
    rest = np.exp(-ages)
    lengths = np.maximum(ages[:-1] - ages[1:], 1e-300)
    older = (rest[1:] - rest[:-1] * (1 + lengths)) / lengths
    weights = np.zeros(len(times))
    weights[:-1] += older
    weights[1:] += rest[1:] - rest[:-1] - older
    weights[0] += rest[0]
    return weights @ places


def seen_slopes(half_height: float, size: tuple[int, int], margin: float) -> tuple[float, float]:
    """Half width and half height, at distance 1, of the picture's part inside a margin."""
    inner = half_height * (1 - margin)
    return inner * size[0] / size[1], inner


def inner(
    half_height: float,
    size: tuple[int, int],
    margin: float,
    room: tuple[float, float, float, float],
    headroom: float = 1.0,
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Half width and height, at distance 1, of the picture's part for the subject, and that part's middle.

    ``room``: space of overlays at the left, top, right and bottom, relative to the picture's width and height.
    Between an overlay and the subject there is GAP of the height, at other edges half the ``margin``: the margin is
    not added to an overlay's room. ``headroom``: largest fraction of the height between the margins that is filled.
    """
    full, gap = half_height * size[0] / size[1], min(GAP * size[1] / size[0], GAP)
    wide, across = _free(margin, gap, room[0], room[2])
    high, below = _free(margin, GAP, room[1], room[3])
    return (full * wide, half_height * min(high, headroom * (1 - margin))), (full * across, -half_height * below)


def room_within(moment: Moment, span: tuple[float, float]) -> tuple[float, float, float, float]:
    """Margins (left, top, right, bottom) that overlays cover from one instant [s] to another, parts of the picture."""
    near = [room for time, room in moment.rooms if span[0] <= time <= span[1]]
    if not near:
        return moment.room
    left, top, right, bottom = map(max, zip(*near, strict=True))
    return left, top, right, bottom


def _free(margin: float, gap: float, before: float, after: float) -> tuple[float, float]:
    """Fraction of the picture's width or height that is filled beside overlays, and its middle in half widths."""
    first, last = (max(0.5 * margin, side + gap) if side else 0.5 * margin for side in (before, after))
    least = (1 - margin) * (1 - before - after)
    return (1 - first - last, first - last) if 1 - first - last > least else (least, before - after)


def view(origin: Any, axes: Floats, size: tuple[int, int], half_height: float, *, orthographic: bool = False) -> View:
    """View from a point (3,) [m]."""
    from sceneql.frame import View

    return View(triple(origin), axes, size, half_height, orthographic)
