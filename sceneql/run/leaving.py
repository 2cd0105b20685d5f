"""Detection of moving things that leave a scene for good, a few or by falling; the default camera frames the others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Points
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.shapes.world_boxes import surface_box

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.graph import Task

MOST = 4096
"""Largest number of moving things that are followed; where there are more, none is let go."""
FEW = 0.25
"""Largest fraction of the moving things that is let go: where more leave, they are what the film is about, except what
falls below all that stands, as balls that miss a bowl: it would make that a dot."""
NEAR = 1.0
"""Width of the margin around the scene, relative to the scene's diagonal, outside which a thing has left it."""
UNDER = 0.25
"""Part of this margin by which what falls below all that stands is followed."""
LAST = 0.25
"""Final fraction of the film during which the distance of a leaving thing must grow all the time."""


@dataclass
class Paths:
    """The boxes of moving things at instants of the film. A thing is one sphere of many, or a whole part."""

    times: list[float] = field(default_factory=list)
    boxes: dict[str, list[tuple[Floats, Floats]]] = field(default_factory=dict)
    """By part, for each instant, low and high corners (things, 3) [m]."""

    def see(self, time: float, shapes: Mapping[str, Sequence[Shape]]) -> None:
        """Record the shapes of the parts at an instant [s]."""
        self.times.append(time)
        for name, drawn in shapes.items():
            if len(drawn) == 1 and isinstance(drawn[0], Points) and len(drawn[0].radii) <= MOST:
                reach = drawn[0].radii[:, None]
                one = drawn[0].centers - reach, drawn[0].centers + reach
            else:
                corners = [surface_box(shape) for shape in drawn] or [(np.full(3, np.inf), np.full(3, -np.inf))]
                lows, highs = (np.array(side) for side in zip(*corners, strict=True))
                one = lows.min(axis=0)[None], highs.max(axis=0)[None]
            self.boxes.setdefault(name, []).append(one)


@dataclass(frozen=True, slots=True)
class Leaving:
    """The things of a part that leave."""

    part: str
    count: int
    of: int
    """All things of the part."""
    time: float
    """Time at which the first has left [s]."""


def warning(one: Leaving, tasks: Mapping[str, Task]) -> Diagnostic:
    """The warning for the things of a part that leave."""
    verb = "leaves" if one.count == 1 else "leave"
    what = f"'{one.part}' leaves" if one.of == 1 else f"{one.count} of the {one.of} masses of '{one.part}' {verb}"
    them = "it" if one.count == 1 else "them"
    text = f"{what} for good, from {one.time:.3g} s on; the default camera lets {them} go"
    help = f"give {them} something to land on, end the `clock` before, or write a camera that shows all"
    return Diagnostic("leaves", text, tasks[one.part].span, help, severity="warning")


def let_go(paths: Paths, still: Iterable[tuple[Floats, Floats]]) -> tuple[list[Leaving], tuple[Floats, Floats] | None]:
    """The things that leave, and the box (low, high) of everything else over the film.

    The box includes the leaving things while they are near; it is None where nothing leaves. ``still``: boxes of parts
    that do not move.
    """
    seen = {name: boxes for name, boxes in paths.boxes.items() if any(len(low) for low, _ in boxes)}  # at some instant
    steady = {
        name: boxes
        for name, boxes in seen.items()
        if len(boxes) == len(paths.times) and len({len(low) for low, _ in boxes}) == 1
    }
    loose = {name: boxes for name, boxes in seen.items() if name not in steady}
    unmoved = list(still)
    if len(paths.times) < 4 or not seen or (loose and not unmoved):
        return [], None
    level = min((float(low[1]) for low, _ in unmoved), default=-np.inf)
    found, whole = _fallen(paths.times, loose, level, [*unmoved, *(boxes[0] for boxes in steady.values())])
    if not steady:
        return (found, whole) if found else ([], None)
    lows = np.concatenate([np.stack([low for low, _ in boxes], axis=1) for boxes in steady.values()])
    highs = np.concatenate([np.stack([high for _, high in boxes], axis=1) for boxes in steady.values()])
    if len(lows) > MOST or not (np.isfinite(lows).all() and np.isfinite(highs).all()):
        return [], None
    low = np.min([lows[:, 0].min(axis=0), *(one for one, _ in unmoved)], axis=0)
    high = np.max([highs[:, 0].max(axis=0), *(one for _, one in unmoved)], axis=0)
    margin = NEAR * float(np.linalg.norm(high - low))
    outside = ((lows > high + margin) | (highs < low - margin)).any(axis=2)  # (things, instants)
    far = np.linalg.norm((lows + highs) / 2 - (low + high) / 2, axis=2)
    last = max(2, int(LAST * len(paths.times)))
    leaves = outside[:, -1] & (np.diff(far[:, -last:], axis=1) > 0).all(axis=1)
    falls = leaves & (highs[:, -1, 1] < level - margin)
    if (leaves & ~falls).any() and leaves.sum() > FEW * len(leaves):
        leaves[:] = falls[:] = False
    if not leaves.any() and not found:
        return [], None
    # A thing has left from the instant on after which it is outside, or below all, up to the end.
    beyond = outside | (falls[:, None] & (highs[:, :, 1] < level - UNDER * margin))
    since = beyond.shape[1] - np.argmin(beyond[:, ::-1], axis=1)
    kept = np.arange(beyond.shape[1])[None, :] < np.where(leaves, since, beyond.shape[1])[:, None]
    first = 0
    for name, boxes in steady.items():
        mine = slice(first, first + len(boxes[0][0]))
        first = mine.stop
        if leaves[mine].any():
            when = paths.times[int(since[mine][leaves[mine]].min())]
            found.append(Leaving(name, int(leaves[mine].sum()), len(boxes[0][0]), when))
    low, high = np.minimum(low, whole[0]), np.maximum(high, whole[1])
    return found, (np.minimum(lows[kept].min(axis=0), low), np.maximum(highs[kept].max(axis=0), high))


def _fallen(
    times: Sequence[float],
    loose: Mapping[str, Sequence[tuple[Floats, Floats]]],
    level: float,
    others: Iterable[tuple[Floats, Floats]],
) -> tuple[list[Leaving], tuple[Floats, Floats]]:
    """Of parts whose things come and go: those with things that fall below a ``level`` [m], and the box of all else.

    ``others``: boxes of what else is there at the start.
    """
    corners = [np.concatenate([np.atleast_2d(side) for side in sides]) for sides in zip(*others, strict=True)]
    low, high = corners[0].min(axis=0), corners[1].max(axis=0)
    every = [box for boxes in loose.values() for box in boxes]
    lows = np.concatenate([np.zeros((0, 3)), *(one for one, _ in every)])
    highs = np.concatenate([np.zeros((0, 3)), *(one for _, one in every)])
    above = np.isfinite(lows).all(axis=1) & (highs[:, 1] >= level)
    low = np.minimum(low, lows[above].min(axis=0, initial=np.inf))
    high = np.maximum(high, highs[above].max(axis=0, initial=-np.inf))
    margin = NEAR * float(np.linalg.norm(high - low))
    found = []
    for name, boxes in loose.items():
        under = [int((one[1][:, 1] < level - margin).sum()) for one in boxes]
        if under[-1] > 0:
            found.append(Leaving(name, under[-1], len(boxes[-1][0]), times[int(np.argmax(np.array(under) > 0))]))
    near = np.isfinite(lows).all(axis=1) & ((highs[:, 1] >= level - UNDER * margin) | (not found))
    low = np.minimum(low, lows[near].min(axis=0, initial=np.inf))
    return found, (low, np.maximum(high, highs[near].max(axis=0, initial=-np.inf)))
