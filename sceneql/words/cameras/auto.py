"""auto: the default camera."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Angle, Camera, FixedScalar, FixedTime, Moment, field
from sceneql.pictures import framing
from sceneql.pictures.following import NEARER, WINDOW, Follower, with_feet

if TYPE_CHECKING:
    from sceneql.frame import Floats, View

NO_ROOM = (0.0, 0.0, 0.0, 0.0)
Toward = tuple[float, float, float]
"""From the scene towards the camera, of any length."""
THREE_QUARTER = (0.55, 0.38, 1.0)
ALONG = ((1.0, 0.1, 0.0), (0.0, 1.0, 0.12), (0.0, 0.1, 1.0))
"""Directions towards the camera for scenes that are flat in x, y or z."""
FLAT, EVEN = 0.2, 0.005
"""Largest depth along an axis, relative to the smaller of both other sizes, for a view along that axis. A FLAT scene is
viewed nearly along it, so that bodies stand out from their ground; an EVEN one exactly, so that right angles stay."""
LONG, ACROSS = 0.12, {0: ALONG[2], 2: ALONG[0]}
"""Larger one of both other sides, relative to the length, below which a scene long in x or z is viewed across; and
directions towards the camera by the long axis."""
MAP, NEARLY = 0.25, {0: (1.0, 0.25, 0.35), 2: (0.35, 0.25, 1.0)}
"""Least area of an EVEN upright part, such as a map, relative to that of the whole scene along its normal, with which
what is not flat is seen from nearer to this; and directions towards the camera by the normal."""
HALFWAY = 0.6
"""How far towards the camera such a part may stand, in parts of the scene."""
FULL, AROUND, UNUSUAL = 0.6, 36, 0.4
"""Least cosine between the view and the normal of what is flat and tilted: a circle is then seen as an ellipse that
fills a wide picture; number of views at this angle that are compared; by how much what is seen from a quarter turn away
from the usual view counts as smaller."""
LOWEST, HIGHEST, STEEP = 0.1, 0.95, 0.35
"""Least and largest sine of the elevation of such a view, above the ground; largest height of the unit normal of what
is seen along it, since it stands upright."""
HEADROOM = 0.9
"""Largest fraction of the height between the margins that is filled: under 80 % of the picture, of round things too."""


class Auto(Camera):
    """A three-quarter view of all that is drawn, from the right front and above, that holds still over the whole film.

    A scene that is flat along an axis is seen along it, one that is flat and tilted, or has a large map, from
    nearer to the normal of that, one that is long and lies across. The few of many things that leave for good are
    let go, and all that falls below what stands. Panels of variants share one view; from one that grows three times as
    large as another by its solver alone the camera goes back. Overlays are left room.

    It holds still, so that what moves in the picture moves in the scene, as fast and as far. Where most of the picture
    would be empty for long, as around a ball that has come to rest, it goes along slowly, within a quarter of the film,
    at the least with all that stands. What stays small on a long way has a warning: with a `window` the camera goes
    along closely; to one that holds still, `window: 0 s`, a `trail` shows the way.
    """

    yields: ClassVar[bool] = True

    field_of_view: Angle = field("Vertical field of view.", "30 deg", above=0, below=math.pi)
    margin: FixedScalar = field("Part of half the picture that is left free.", "0.12", at_least=0, below=1)
    window: FixedTime | None = field(
        "It moves softly and frames, at each instant, what moves within half of this time before and after; 0: it "
        "holds still; by default it does, or goes along within a quarter of the film, with what stands, where it pays.",
        None,
        at_least=0,
    )

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view now, of the whole film, or of what is near in time."""
        half = math.tan(0.5 * float(moment.at(self.field_of_view)))
        points = moment.outline()
        slopes, middle = framing.inner(half, size, self.margin, moment.room, HEADROOM)
        axes = framing.axes_towards(_raised(_towards(points, slopes, moment.boxes()), middle[1]))
        origin, distance = framing.fitted(points, axes, slopes, middle=middle)

        def fit(points: Floats, span: tuple[float, float]) -> tuple[Floats, float]:
            slopes, middle = framing.inner(half, size, self.margin, framing.room_within(moment, span), HEADROOM)
            return framing.fitted(points, axes, slopes, middle=middle)

        lost = moment.left_out()
        if len(lost) > 0:  # it goes back as far as it must, and shows what the others show
            back = moment.kept(
                "a camera that goes back",
                (size, moment.room, moment.rooms, points.tobytes(), lost.tobytes()),
                lambda: Follower(lost, points, fit, axes[2], WINDOW * moment.end),
            )
            return framing.view(back.at(moment.time), axes, size, half)
        alone, window = self.window is not None, WINDOW * moment.end if self.window is None else self.window
        rows = moment.moving(None if alone else window) if window > 0.0 else points[:0]
        if len(rows) == 0:
            return framing.view(origin, axes, size, half)
        standing = points[:0]
        if not alone:
            rows, standing = with_feet(rows, float(points[:, 1].min())), moment.standing()

        def following() -> tuple[Follower | None]:
            if not alone:
                plain, _ = framing.inner(half, size, self.margin, NO_ROOM, HEADROOM)  # overlays ask whether it pays
                bare = partial(framing.fitted, axes=axes, slopes=plain)
                still, far = bare(points)
                free = Follower(rows, standing, lambda seen, span: bare(seen), axes[2], window, far / NEARER)
                if not free.pays(still):
                    return (None,)
            return (Follower(rows, standing, fit, axes[2], window, 0.0 if alone else distance / NEARER),)

        key = size, half, self.margin, moment.room, moment.rooms, window, alone, points.tobytes(), rows.tobytes()
        found = moment.kept("a camera that follows", key, following)[0]
        if found is not None:
            origin = found.at(moment.time)
        return framing.view(origin, axes, size, half)


def _towards(points: Floats, slopes: tuple[float, float], boxes: Floats) -> Toward:
    """Direction from the scene to its camera, by the proportions of the box around points (n, 3).

    ``slopes``: half width and height, at distance 1, of the part of the picture that they fill; ``boxes`` (n, 2, 3):
    around each part.
    """
    sides = points.max(axis=0) - points.min(axis=0)
    thin = int(sides.argmin())
    others = [float(side) for k, side in enumerate(sides) if k != thin]
    if sides[thin] < EVEN * min(others):
        x, y, z = (float(k == thin) for k in range(3))
        return x, y, z
    if sides[thin] < FLAT * min(others):
        return ALONG[thin]
    upright = _largest_map(boxes, sides, points.min(axis=0) + HALFWAY * sides)
    if upright is not None:
        return NEARLY[upright]
    long = int(sides.argmax())
    return ACROSS.get(long, THREE_QUARTER) if min(others) < LONG * sides[long] else _onto_tilted(points, slopes)


def _raised(toward: Toward, middle: float) -> Toward:
    """A direction so high that what stands above the picture's middle is seen from above as that along ALONG is.

    Else the ground under it, with its shadow, is seen along itself and fades. ``middle``: how far above, at distance 1.
    What is looked at along an axis stays so.
    """
    x, y, z = toward
    far = math.hypot(x, z)
    if 0.0 in (y, far):
        return toward
    least = math.tan(math.atan(ALONG[0][1]) + math.atan(max(0.0, middle)))
    return x, max(y, least * far), z


def _largest_map(boxes: Floats, sides: Floats, most: Floats) -> int | None:
    """Axis of the normal of the largest EVEN upright part, of boxes (n, 2, 3), that is a MAP of a scene.

    One beyond ``most`` (3,) [m] along its normal is none: it would hide what is behind it, as a wall does.
    """
    found: dict[int, float] = {}
    for low, high in boxes:
        one = high - low
        thin = int(one.argmin())
        if low[thin] > most[thin]:
            continue
        across = [k for k in range(3) if k != thin]
        if thin in NEARLY and one[thin] < EVEN * one[across].min():
            found[thin] = max(found.get(thin, 0.0), float(one[across].prod() / sides[across].prod()))
    axis = max(found, key=found.__getitem__, default=None)
    return axis if axis is not None and found[axis] >= MAP else None


def _onto_tilted(points: Floats, slopes: tuple[float, float]) -> Toward:
    """The three-quarter view; of points (n, 3) that are flat along no axis of the box one nearer to their normal.

    Of AROUND views at an angle to the normal whose cosine is FULL, above the ground, it is that in which they are
    largest, and near the usual one. ``slopes``: half width and height, at distance 1, of the part that they fill.
    """
    import numpy as np

    away = points - points.mean(axis=0)
    principal = np.linalg.eigh(away.T @ away)[1]
    thin, high, wide = np.ptp(away @ principal, axis=0)
    normal, usual = np.round(principal[:, 0], 9), np.array(THREE_QUARTER) / math.hypot(*THREE_QUARTER)
    if not thin < FLAT * min(wide, high) or abs(float(normal @ usual)) >= FULL:
        return THREE_QUARTER
    if abs(normal[1]) < STEEP:
        x, _, z = normal if normal @ usual > 0.0 else -normal
        return float(x), LOWEST, float(z)
    right, up, _ = framing.axes_towards(normal)
    turns = 2.0 * np.pi * np.arange(AROUND) / AROUND
    tilted = math.sqrt(1.0 - FULL * FULL) * (np.cos(turns)[:, None] * right + np.sin(turns)[:, None] * up)
    ways = [way for side in (FULL, -FULL) for way in side * normal + tilted if LOWEST <= way[1] <= HIGHEST]

    def size(way: Floats) -> float:
        axes = framing.axes_towards(way)
        distance = framing.fitted(points, axes, slopes)[1]
        across, along = np.ptp(points @ axes[:2].T, axis=0) / distance / slopes
        return round(float(across * along) * (1.0 - UNUSUAL * (1.0 - float(way @ usual))), 9)

    x, y, z = max(ways, key=size, default=usual)
    return float(x), float(y), float(z)
