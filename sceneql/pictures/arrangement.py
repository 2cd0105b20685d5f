"""Arrangement of a picture's overlays: each keeps one place over the film, off the subject if possible."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, cast

from sceneql.failure import RunFailure, failing_as
from sceneql.pictures.anchors import Box, projected
from sceneql.pictures.framing import corners

if TYPE_CHECKING:
    from sceneql.frame import Floats, View
    from sceneql.graph import Task
    from sceneql.kinds import Overlay
    from sceneql.run.instant import Instant

    Mask = Any
    """(h, w) bool: mask of the picture's cells."""

Room = tuple[float, float, float, float]
"""Space kept free at the left, top, right and bottom, relative to the picture's width and height."""
NO_ROOM: Room = (0.0, 0.0, 0.0, 0.0)

CELLS = 90
"""Number of cells along the picture's height, in masks of what the subject covers."""
INSTANTS = 8
"""Number of instants, besides the first, at which a moving camera's view is sampled."""
EDGE = 0.06
"""Part of the width and height at each edge that a camera leaves free of the subject in any case."""
MOST = 0.75
"""Largest fraction of the picture's width or height that overlays may keep free."""
MOMENTS, SETS = 240, 6
"""Number of instants at which overlays are asked whether they are shown; largest number of sets of them, of which one
after the other is gone for good, that a camera that moves leaves rooms of their own."""
WAYS = 64
"""Largest number of ways to keep overlays free that are tried."""
APART = 10.0
"""Weight of one overlay over another; a wholly covered subject has weight 1."""
ALIKE = 0.05
"""Difference of cost within which places that hide something count as equal: the first of them is taken."""


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Overlays of a picture, each with its place, and the room that they take of it."""

    overlays: Mapping[str, Overlay]
    room: Room = NO_ROOM
    rooms: tuple[tuple[float, Room], ...] = ()
    """Room at each of some instants [s], for a camera that moves, where some of the overlays go for good."""


@dataclass(frozen=True, slots=True)
class Sight:
    """Picture to be arranged."""

    size: tuple[int, int]
    """Width and height [pixels]."""
    scale: float
    """Height of the whole picture over that of this panel."""
    moment: Instant
    """Instant of the first picture."""
    look: Callable[[Instant], View]
    yields: bool
    """Whether the camera leaves room for overlays."""
    drawn: Sequence[str]
    """Names of the parts that it shows."""

    def parts(self) -> list[tuple[Floats, Floats]]:
        """Low and high corners (3,) [m] of each part over the film, in all variants shown side by side.

        Each box is clipped to what stays in the scene; parts that leave for good are left out.
        """
        import numpy as np

        stays = self.moment.bounds(())
        known = [run.boxes() for run in (self.moment.run, *self.moment.beside)]
        found = [boxes[name] for boxes in known for name in self.drawn if name in boxes]
        kept = [(np.maximum(low, stays[0]), np.minimum(high, stays[1])) for low, high in found]
        return [(low, high) for low, high in kept if (low <= high).all()]


def arranged(sight: Sight, tasks: Mapping[str, Task], fixed: Sequence[Box]) -> Arrangement:
    """Arrangement of overlays in a picture; ``fixed``: boxes taken by other letters.

    An overlay takes the first of its places (`Overlay.places`) that hides nothing, else one that hides little; large
    overlays choose first. A camera that yields leaves room for overlays that still lie on the subject.

    Raises RunFailure for an overlay whose box cannot be found.
    """
    overlays = {name: cast("Overlay", task.kind) for name, task in tasks.items()}
    seekers = [name for name, kind in overlays.items() if len(kind.places()) > 1]
    if not seekers and not (sight.yields and (fixed or overlays)):
        return Arrangement(overlays)
    parts = sight.parts()
    stand = {name: _boxes(sight, task) for name, task in tasks.items()}
    taken = [*fixed, *(box for name, boxes in stand.items() if name not in seekers for box in boxes.values())]
    owner = {box: name for name, boxes in stand.items() for box in boxes.values()}
    views = list(_views(sight))
    masks = covered(parts, views, sight.size)
    for name in sorted(seekers, key=lambda name: -max(map(_area, stand[name].values()), default=0)):
        costs = {place: _hidden(box, masks, sight.size) + _clash(box, taken) for place, box in stand[name].items()}
        if costs:
            least = min(costs.values())
            place = next(place for place, cost in costs.items() if cost <= (least and least + ALIKE))
            overlays[name] = overlays[name].model_copy(update={"place": place})
            taken.append(stand[name][place])
    if not sight.yields:
        return Arrangement(overlays)
    rooms = {tuple(taken): _room(sight, parts, taken, len(views) > 1)}
    if len(views) == 1:
        return Arrangement(overlays, rooms[*taken,])
    shown = {box: _shown(sight, overlays[owner[box]]) for box in taken if box in owner}
    there = [tuple(box for box in taken if box not in shown or any(shown[box][k:])) for k in range(MOMENTS + 1)]
    if 1 < len(set(there)) <= SETS:
        rooms |= {boxes: _room(sight, parts, boxes, moves=True) for boxes in set(there)}
        times = (sight.moment.end * k / MOMENTS for k in range(MOMENTS + 1))
        steps = tuple((time, rooms[boxes]) for time, boxes in zip(times, there, strict=True))
        return Arrangement(overlays, rooms[*taken,], steps)
    return Arrangement(overlays, rooms[*taken,])


def _shown(sight: Sight, overlay: Overlay) -> list[bool]:
    """Whether an overlay is shown at MOMENTS + 1 even instants of the film; of one that reads the run, always."""
    show, end = overlay.show, sight.moment.end
    if show is None or show.links:
        return [True] * (MOMENTS + 1)
    then = (replace(sight.moment, now=end * k / MOMENTS, _values={}) for k in range(MOMENTS + 1))
    return [bool(moment.at(show)) for moment in then]


def _boxes(sight: Sight, task: Task) -> dict[str, Box]:
    """Boxes of an overlay by place; empty for one that is not shown yet and whose box is unknown until then."""
    kind, moment = cast("Overlay", task.kind), sight.moment
    with failing_as(task.name, moment.now, task.span):
        hidden = kind.show is not None and moment.at(kind.show) == 0
    with suppress(*((RunFailure,) if hidden else ())), failing_as(task.name, moment.now, task.span):
        boxes = {place: kind.box(place, sight.size, moment, sight.scale) for place in kind.places()}
        return {place: box for place, box in boxes.items() if box is not None}
    return {}


def covered(parts: Iterable[tuple[Floats, Floats]], views: Sequence[View], size: tuple[int, int]) -> list[Mask]:
    """Mask of the cells that a part's box covers in any of the views, for each visible part.

    A box that reaches behind the camera is not counted: overlays may cover such surroundings.
    """
    import numpy as np
    from PIL import Image, ImageDraw

    wide, high = _cells(size)
    found: list[Mask] = []
    for low, high_corner in parts:
        canvas = Image.new("1", (wide, high))
        draw = ImageDraw.Draw(canvas)
        for view in views:
            seen = [projected(corner, view) for corner in corners(low, high_corner)]
            if all(place is not None for place in seen):
                across = np.clip(np.array(seen, dtype=float) * high / size[1], -2.0 * wide, 3.0 * wide)
                draw.polygon([(x, y) for x, y in _hull(across)], fill=1, outline=1)
        mask = np.asarray(canvas)
        if mask.any():
            found.append(mask)
    return found


def _cells(size: tuple[int, int]) -> tuple[int, int]:
    """Numbers of columns and rows of cells."""
    high = min(CELLS, size[1])
    return max(1, math.ceil(size[0] * high / size[1])), high


def _hull(points: Floats) -> list[tuple[float, float]]:
    """Convex hull of points (n, 2), in order (Andrew 1979)."""
    rows = sorted({(float(x), float(y)) for x, y in points})
    if len(rows) < 3:
        return [*rows, *rows][:2]

    def half(order: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for x, y in order:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return half(rows) + half(reversed(rows))


def _views(seen: Sight) -> Iterator[View]:
    """Views of the film that differ from the first, after it; of a camera that reads solved states the first alone."""
    first = replace(seen.moment, _states={}, _values={})
    view = seen.look(first)
    yield view
    if first._states or not first.end:
        return
    for k in range(INSTANTS + 1):
        with suppress(RunFailure, ValueError):
            other = seen.look(replace(seen.moment, now=first.end * k / INSTANTS, _states={}, _values={}))
            if other.origin != view.origin or (other.axes != view.axes).any() or other.half_height != view.half_height:
                yield other


def _hidden(box: Box, masks: Sequence[Mask], size: tuple[int, int]) -> float:
    """Fraction of the subject that a box hides: the mean over its parts."""
    return float(sum(mask[_slices(box, size)].sum() / mask.sum() for mask in masks)) / max(len(masks), 1)


def _slices(box: Box, size: tuple[int, int]) -> tuple[slice, slice]:
    """Slices of rows and columns of the cells that a box touches."""
    part = _cells(size)[1] / size[1]
    left, top, right, bottom = (edge * part for edge in box)
    rows, columns = (max(0, math.floor(top)), math.ceil(bottom)), (max(0, math.floor(left)), math.ceil(right))
    return slice(*rows), slice(*columns)


def _area(box: Box) -> int:
    return (box[2] - box[0]) * (box[3] - box[1])


def _clash(box: Box, taken: Iterable[Box]) -> float:
    """Fraction of a box that other boxes cover, times APART."""
    total = 0.0
    for other in taken:
        wide = min(box[2], other[2]) - max(box[0], other[0])
        high = min(box[3], other[3]) - max(box[1], other[1])
        total += max(wide, 0) * max(high, 0) / max(_area(box), 1)
    return APART * total


def _room(seen: Sight, parts: Sequence[tuple[Floats, Floats]], taken: Sequence[Box], moves: bool) -> Room:
    """Room at the edges with which no box lies on the subject and the subject is largest.

    A camera that ``moves`` may bring the subject anywhere between the rooms: then none of the boxes lies there.
    """
    room, kept = NO_ROOM, list[Box]()
    while True:
        masks = covered(parts, [seen.look(replace(seen.moment, room=room))], seen.size)
        free = [box for box in taken if box not in kept and _sides(box, seen.size)]
        met = [box for box in free if _hidden(box, masks, seen.size)]
        if moves and not met:
            met = [box for box in free if _within(box, room, seen.size)]
        if not met:
            return room
        kept += met
        ways = list(_ways(kept, seen.size))
        if not ways:
            return room
        room = max(ways, key=lambda way: (round(_largeness(seen, parts, way, moves)), -sum(way)))


def _within(box: Box, room: Room, size: tuple[int, int]) -> bool:
    """Whether a box reaches farther than EDGE between the rooms."""
    left, top, right, bottom = (max(part, EDGE) for part in room)
    (wide, high), (x, y, far_x, far_y) = size, box
    return x < wide * (1 - right) and far_x > wide * left and y < high * (1 - bottom) and far_y > high * top


def _sides(box: Box, size: tuple[int, int]) -> list[Room]:
    """Rooms at a single edge that keep a box free."""
    (wide, high), (left, top, right, bottom) = size, box
    sides = (right / wide, bottom / high, 1 - left / wide, 1 - top / high)
    return [
        (*NO_ROOM[:k], side, *NO_ROOM[k + 1 :])  # type: ignore[misc]
        for k, side in enumerate(sides)
        if side < 0.5
    ]


def _ways(kept: Sequence[Box], size: tuple[int, int]) -> Iterator[Room]:
    """Rooms that keep all boxes free, one for each choice of an edge per box."""
    options = [_sides(box, size) for box in kept]
    if math.prod(map(len, options)) > WAYS:
        options = [[min(sides, key=max)] for sides in options]
    for way in dict.fromkeys(product(*options)):
        left, top, right, bottom = (max(room[k] for room in way) for k in range(4))
        if left + right <= MOST and top + bottom <= MOST:
            yield left, top, right, bottom


def _largeness(seen: Sight, parts: Sequence[tuple[Floats, Floats]], room: Room, moves: bool) -> float:
    """Diagonal [pixels] of the subject in the picture with a room; the mean over the film if the camera ``moves``."""
    import numpy as np

    points = [corner for low, high in parts for corner in corners(low, high)]
    moments, found = [replace(seen.moment, room=room)], []
    if moves:
        film = (seen.moment.end * k / INSTANTS for k in range(INSTANTS + 1))
        moments = [replace(moments[0], now=time, _states={}, _values={}) for time in film]
    for moment in moments:
        view = seen.look(moment)
        places = np.array([place for point in points if (place := projected(point, view)) is not None])
        found.append(float(np.linalg.norm(np.ptp(places, axis=0))) if len(places) else 0.0)
    return float(np.mean(found))
