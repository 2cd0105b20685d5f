"""A camera of one direction that follows what moves, softly, and whether that pays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats

WINDOW = 0.25
"""Length of the window of a camera that follows by itself, relative to the film: it moves less than what it shows."""
LARGER, FILLED, PART = 1.2, 1 / 3, 0.25
"""Such a camera is better than a still one where it shows what is there now so many times larger, and at least so large
relative to the picture, in such a part of the film: what stays a dot had better be seen on its whole way."""
STEEP, MUCH_LARGER = 0.9, 1.3
"""Sine of the elevation of a camera from which on it must show that much larger: from above nothing tells that it moves
itself, as what lies under things does from the side."""
NEARER = 5.0
"""Largest ratio of the distance of a still camera to that of one that follows: what moves keeps its surroundings."""


@dataclass(frozen=True)
class Follower:
    """A camera that follows what moves, softly.

    Its position is a mean over the instants of half a window before and after, with weights that fade to none, each of
    the camera that sees what moves within half a window of its instant. So what moves now is in the picture: each of
    these sees it, and the places from which cameras of one direction see a point are convex.
    """

    rows: Floats
    """Instants and points (n, 1 + 3) of what moves, at least one."""
    standing: Floats
    """Points (n, 3) [m] that it sees at all times."""
    fit: Callable[[Floats, tuple[float, float]], tuple[Floats, float]]
    """Position (3,) [m] and distance [m] of a camera that holds still from one instant [s] to another and sees points
    (n, 3)."""
    back: Floats
    """(3,) The unit vector from the scene to the camera."""
    window: float
    """[s]"""
    least: float = 0.0
    """Least distance [m]."""

    @cached_property
    def times(self) -> Floats:
        """The instants (k,) [s]."""
        import numpy as np

        return np.unique(self.rows[:, 0])

    def at(self, time: float) -> Floats:
        """Its position (3,) [m] at a time [s]."""
        import numpy as np

        position: Floats = self.path(np.array([time]))[0]
        return position

    def path(self, at: Floats) -> Floats:
        """Its positions (k, 3) [m] at times (k,) [s]."""
        import numpy as np

        ages = (self.times - at[:, None]) / self._reach  # (k, instants)
        weights = np.where(np.abs(ages) < 1.0, (1.0 - ages**2) ** 2, 0.0)
        alone = ~(weights > 0.0).any(axis=1)  # the run ahead failed before
        weights[alone, np.abs(ages[alone]).argmin(axis=1)] = 1.0
        found: Floats = weights @ self._stands / weights.sum(axis=1)[:, None]
        return found

    @cached_property
    def _spacing(self) -> float:
        """Time between instants [s]."""
        import numpy as np

        return float(np.diff(self.times).max()) if len(self.times) > 1 else self.window

    @property
    def _reach(self) -> float:
        """Half of the window, at least one spacing [s]."""
        return max(0.5 * self.window, self._spacing)

    @cached_property
    def _stands(self) -> Floats:
        """Positions (k, 3) [m] of the cameras that see what moves near each of the instants."""
        import numpy as np

        reach = self._reach + self._spacing
        near = [np.abs(self.rows[:, 0] - time) <= reach for time in self.times]
        fitted = [self._fitted(some, (time - reach, time + reach)) for time, some in zip(self.times, near, strict=True)]
        return np.array([place + max(0.0, self.least - far) * self.back for place, far in fitted])

    def _fitted(self, some: Floats, span: tuple[float, float]) -> tuple[Floats, float]:
        """Position and distance of a camera that sees some rows and what stands, within a span of time [s]."""
        import numpy as np

        return self.fit(np.concatenate([self.standing, self.rows[some, 1:]]), span)

    def pays(self, still: Floats) -> bool:
        """Whether it is better than a camera that holds still at a position (3,) [m]."""
        import numpy as np

        now = [self.rows[:, 0] == time for time in self.times]
        points = [np.concatenate([self.standing, self.rows[some, 1:]]) @ self.back for some in now]
        middles = np.array([(one.min() + one.max()) / 2 for one in points])
        depths = self.path(self.times) @ self.back - middles
        spans = [(time, time) for time in self.times]
        alone = np.array([self._fitted(*each)[0] for each in zip(now, spans, strict=True)]) @ self.back - middles
        larger = MUCH_LARGER if self.back[1] > STEEP else LARGER
        better = ((still @ self.back - middles) >= larger * depths) & (alone >= FILLED * depths)
        return float(better.mean()) >= PART


def with_feet(rows: Floats, level: float) -> Floats:
    """Rows (n, 1 + 3) of what moves, and what lies under its middle at the lowest height [m] of the film.

    So a camera that follows shows how high things are, and what happens between two instants of a fall. It is one point
    an instant: the ground under all of a wide cloth, in front of that, would keep the camera away.
    """
    import numpy as np

    feet = []
    for time in np.unique(rows[:, 0]):
        points = rows[rows[:, 0] == time]
        feet.append((points.min(axis=0) + points.max(axis=0)) / 2)
        feet[-1][2] = level
    return np.concatenate([rows, feet])
