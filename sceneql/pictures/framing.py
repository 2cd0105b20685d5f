"""Where a camera must stand so that a box fills its picture."""

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
"""Least distance [m] of a camera from what it is fitted to."""


GAP = 0.035
"""Free space between overlays and what is fitted, in parts of the picture's height."""


def axes_towards(back: Any, up: Any = (0.0, 1.0, 0.0)) -> Floats:
    """(3, 3) rows right, up, back of a camera that looks along -back, with ``up`` upwards in the picture.

    Where the camera looks along ``up``, another axis takes its place. Raises ValueError for a ``back`` of zero.
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
"""How far back a follower remembers, in lags, and samples in one lag."""


def corners(low: Any, high: Any) -> Floats:
    """(8, 3) corners of a box."""
    import numpy as np

    return np.array(list(product(*zip(low, high, strict=True))), dtype=float)


def bounds(moment: Moment, refs: Iterable[Ref] | None) -> tuple[Floats, Floats]:
    """Low and high corner (3,) around the named parts, or all that is drawn, over the whole film."""
    return moment.bounds([ref.name for ref in refs or ()])


def fitted(
    points: Floats, axes: Floats, slopes: tuple[float, float], aim: Any = None, middle: tuple[float, float] = (0.0, 0.0)
) -> tuple[Floats, float]:
    """Position (3,) and distance of the nearest camera that sees all points; exact, without iteration.

    ``slopes``: half the width and height, at the distance 1, of the picture's part where the points shall be, whose
    center stands at ``middle``, to the right and up. With ``aim`` (3,) the camera looks at that point; else it moves
    sideways until that part is filled best. For a coordinate p across, a depth b towards the camera, a slope k and a
    middle m, a point is seen from the distance D at the place s across if |p - s - m (D - b)| <= k (D - b): so
    D >= (max(p + (k + m) b) - min(p - (k - m) b))/(2 k), and s is the middle of what is left.
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
    """(3,) place of a part in the world now: its position, the middle of its box, or the center of its masses."""
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
    """The place of a part as a value that can be remembered (kinds.moment.Seen)."""

    ref: Ref

    def at(self, moment: Moment) -> Any:
        """(3,) [m] now."""
        return whereabouts(moment, self.ref)


def behind(past: Sequence[tuple[float, Any]], now: float, place: Any, lag: float) -> Any:
    """Position (3,) now of a follower with the velocity (place - own)/lag, which starts at the first place.

    Between the samples (time [s], place) of ``past`` the place moves on straight lines, for which the solution is
    exact: the mean of past places with the weight exp(-age/lag).
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
    """Half width and half height of the picture's inner part, at the distance 1."""
    inner = half_height * (1 - margin)
    return inner * size[0] / size[1], inner


def inner(
    half_height: float,
    size: tuple[int, int],
    margin: float,
    room: tuple[float, float, float, float],
    headroom: float = 1.0,
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Half width and height of the part of the picture that is filled, and its middle, at the distance 1.

    ``room``: what overlays take at the left, top, right and bottom, in parts of the picture's width and height. The
    margin is at the picture's edges; between an overlay and the subject there is GAP of the height, and at the other
    edges as much as ever: a subject between overlays is not made smaller twice. ``headroom``: the part of the height
    between the margins that is filled at most.
    """
    full, gap = half_height * size[0] / size[1], min(GAP * size[1] / size[0], GAP)
    wide, across = _free(margin, gap, room[0], room[2])
    high, below = _free(margin, GAP, room[1], room[3])
    return (full * wide, half_height * min(high, headroom * (1 - margin))), (full * across, -half_height * below)


def _free(margin: float, gap: float, before: float, after: float) -> tuple[float, float]:
    """The part of a side of the picture that is filled beside overlays, and how far its middle lies off, in halves."""
    first, last = (max(0.5 * margin, side + gap) if side else 0.5 * margin for side in (before, after))
    least = (1 - margin) * (1 - before - after)
    return (1 - first - last, first - last) if 1 - first - last > least else (least, before - after)


def view(origin: Any, axes: Floats, size: tuple[int, int], half_height: float, *, orthographic: bool = False) -> View:
    """The view from a point (3,) [m]."""
    from sceneql.frame import View

    return View(triple(origin), axes, size, half_height, orthographic)
