"""orthographic: a camera without perspective."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from sceneql.kinds import Camera, Direction, DrawnRef, FixedScalar, Length, Moment, Position, Problem, field
from sceneql.pictures import framing
from sceneql.shapes.checked_values import positive

if TYPE_CHECKING:
    from sceneql.frame import View

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


class Orthographic(Camera):
    """A camera with parallel rays: what is farther away looks as large, as in a plan.

    Without `height` it shows the parts of `fit` (without names: all that is drawn) over the whole film.
    """

    said_by: ClassVar[Mapping[str, str]] = {
        "position": "it has a direction alone, `look_along: 0 0 -1`, and sees as much as its `height`",
        "field_of_view": "write its `height`, of what it sees: `height: 4 m`",
        "fov": "write its `height`, of what it sees: `height: 4 m`",
    }

    look_along: Literal["x", "-x", "y", "-y", "z", "-z"] | Direction = field("The direction that it looks in.", "-z")
    height: Length | None = field("Height of what it shows; by default as much as `fit` needs.", None, above=0)
    look_at: Position | None = field("The point in the middle of the picture; by default what it shows.", None)
    follow: DrawnRef | None = field("A part that it keeps in the middle.", None)
    fit: tuple[DrawnRef, ...] | None = field("The parts that must be in the picture over the whole film.", None)
    margin: FixedScalar = field("With `fit`: part of half the picture that is left free.", "0.08", at_least=0, below=1)
    up: Direction = field("What is upwards in the picture; seen from above or below, -z is.", "0 1 0")

    def problems(self) -> Iterator[Problem]:
        """Two middles of the picture."""
        if self.follow is not None and self.look_at is not None:
            yield Problem("the middle of the picture is either `look_at` or what it follows", ("look_at",), at_key=True)

    def aims(self) -> Iterable[str]:
        """What it follows or looks at."""
        yield from () if self.follow is None else (self.follow.name,)
        yield from () if self.look_at is None else {link.task: None for link in self.look_at.links}

    def _back(self, moment: Moment) -> Any:
        import numpy as np

        along = self.look_along
        if isinstance(along, str):
            sign = 1.0 if along.startswith("-") else -1.0
            return sign * np.array(AXES[along[-1]])
        return -moment.at(along)

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of this instant; its window lies in front of all that is drawn."""
        import numpy as np

        axes = framing.axes_towards(self._back(moment), moment.at(self.up))
        aim: Any = None
        if self.look_at is not None:
            aim = moment.at(self.look_at)
        elif self.follow is not None:
            aim = framing.whereabouts(moment, self.follow)
        now = None if self.height is None or aim is None else moment.around()
        if now is not None:  # shapes at other instants do not move a window that the script places
            points = around = framing.corners(*now)
        else:
            points = framing.corners(*framing.bounds(moment, self.fit))
            around = framing.corners(*framing.bounds(moment, None))
        across = points @ axes[:2].T
        middle = (across.min(axis=0) + across.max(axis=0)) / 2
        if aim is not None:
            middle = axes[:2] @ aim
        if self.height is not None:
            half = 0.5 * positive(moment, self.height, "height")
        else:
            reach = np.abs(across - middle).max(axis=0) / framing.seen_slopes(1.0, size, self.margin)
            half = max(float(np.max(reach)), framing.NEAREST)
        depths = np.concatenate([points, around]) @ axes[2]
        room = max(float(np.ptp(depths)), 1.0)
        origin = middle @ axes[:2] + (float(depths.max()) + room) * axes[2]
        return framing.view(origin, axes, size, half, orthographic=True)
