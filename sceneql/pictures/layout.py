"""Several pictures in one: boxes of panels in rows, and runs of variants side by side."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from sceneql.failure import RunFailure
from sceneql.kinds import EachVariant

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.graph import SimulationGraph
    from sceneql.kinds.outputs import Row
    from sceneql.pictures.anchors import Box as AnchorBox
    from sceneql.run.instant import Instant

GAP = 0.008
"""Gap between panels, relative to the picture's height."""

NAME, TOLD = 0.032, 0.024
"""Heights of letters of names and of failures, relative to the picture's height."""
WARNING = (176, 40, 24)
"""Color of a failure's message."""

Box = tuple[int, int, int, int]
"""Left, top, width, height [pixels]."""


def boxes(rows: Sequence[Row], variants: Sequence[str], size: tuple[int, int]) -> list[tuple[Any, Box]]:
    """Content of each panel (a variant's name, or the reference of a row) with its box."""
    lines: list[tuple[Sequence[Any], float, int, bool]] = []
    for row in rows:
        if isinstance(row, EachVariant):
            columns = row.columns or _columns(len(variants))
            for k in range(0, len(variants), columns):
                lines.append((variants[k : k + columns], row.share, columns, True))
        else:
            lines.append((row, 1.0, len(row), False))
    gap = max(2, round(GAP * size[1]))
    room = size[1] - gap * (len(lines) - 1)
    total = sum(share for _, share, *_ in lines)
    found: list[tuple[Any, Box]] = []
    done = 0.0
    for k, (line, share, columns, compared) in enumerate(lines):
        top, bottom = (round(room * part / total) + k * gap for part in (done, done + share))
        done += share
        across = size[0] - gap * (columns - 1)
        start = round((columns - len(line)) * (across / columns + gap) / 2)  # the last line of a grid is centered
        for j, item in enumerate(line):
            left, right = (round(across * part / columns) + j * gap for part in (j, j + 1))
            wide, high = right - left, bottom - top
            if compared:  # all of one size
                wide, high = int(across / columns), int(room * share / total)
            found.append((item, (start + left, top, wide, high)))
    return found


def _columns(count: int) -> int:
    """Number of columns: up to three, then that of a square."""
    return max(1, count if count <= 3 else math.ceil(math.sqrt(count)))


def page(size: tuple[int, int]) -> NDArray[uint8]:
    """Empty picture (h, w, 3) of a size (width, height) [pixels]."""
    import numpy as np

    from sceneql.pictures.lettering import LIGHT

    return np.full((size[1], size[0], 3), LIGHT.paper, dtype=np.uint8)


def label(pixels: NDArray[uint8], name: str, told: str, scale: float) -> None:
    """Write a variant's name and what is told of it on its panel (h, w, 3); the picture is ``scale`` times as high."""
    from sceneql.pictures.lettering import Letterer

    letters = Letterer(pixels, NAME * scale, scale=scale)
    room = letters.em // 2
    letters.line((room, room), name, 0.8)
    letters.done()
    if told:
        letters = Letterer(pixels, TOLD * scale, scale=scale)
        letters.line((room, letters.height), letters.fitted(told, letters.width - 3 * letters.em), 0.9, WARNING)
        letters.done()


def label_box(size: tuple[int, int], names: Iterable[str], scale: float) -> AnchorBox:
    """Left, top, right, bottom [pixels] of the longest of the variants' names on its panel."""
    from sceneql.pictures.lettering import Letterer

    letters = Letterer(page(size), NAME * scale, scale=scale)
    boxes = [letters.line_box((letters.em // 2, letters.em // 2), name) for name in names]
    return max(boxes, key=lambda box: box[2])


class Panel:
    """Run of a variant; after a failure that the script allows, the last moment before it stays."""

    def __init__(self, graph: SimulationGraph) -> None:
        from sceneql.run.run import Run

        self.graph = graph
        self.run = Run(graph)
        self.tools: Any = None
        """Tools that draw the panel."""
        self.picture: Any = None
        """Latest picture of the panel, (h, w, 3) uint8."""
        self.failure: RunFailure | None = None
        self._last: Instant | None = None
        self._whole = self.run

    def boxes(self) -> Mapping[str, tuple[Floats, Floats]]:
        """Low and high corner (3,) [m] of each part over the whole run; empty for an allowed failure at the start."""
        try:
            return self._whole.boxes()
        except RunFailure:
            if not self.graph.variants.may_fail:
                raise
            return {}

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats] | None:
        """Low and high corner (3,) [m] of what named parts draw over the whole run (run.Run); None without boxes."""
        return self._whole.bounds(names) if self.boxes() else None

    def outline(self) -> Floats:
        """Points (n, 3) [m] whose hull contains all that is drawn and stays, over the whole run."""
        import numpy as np

        return self._whole.outline() if self.boxes() else np.zeros((0, 3))

    def standing(self) -> Floats:
        """Points (n, 3) [m] whose hull contains all that does not change (run.Run)."""
        import numpy as np

        return self._whole.standing() if self.boxes() else np.zeros((0, 3))

    def moving(self, window: float | None) -> Floats:
        """Instants [s] and points [m], rows (n, 1 + 3), of what moves and stays (run.Run)."""
        import numpy as np

        return self._whole.moving(window) if self.boxes() else np.zeros((0, 4))

    def told(self, moment: Instant) -> str:
        """What is written on the panel: its failure, or that it has left the picture that the others share."""
        if self.failure is not None:
            return f"failed at {self.failure.time:.3g} s: {self.failure.message}"
        gone = [one for one in moment.run.diverged if one.graph is self.graph and moment.now >= one.time]
        return "".join(one.said() for one in gone[:1])

    def at(self, time: float) -> Instant:
        """Moment at ``time`` [s], or the last before a failure. Raises RunFailure unless the script allows failures."""
        if self.failure is None and (self._last is None or self._last.now < time):
            try:
                self._last = self.run.at(time)
            except RunFailure as failure:
                if not self.graph.variants.may_fail:
                    raise
                self.failure = failure
        if self._last is None:
            self._last = self._before_failure()
        return self._last

    def _before_failure(self) -> Instant:
        """Last frame of the film before the failure, by a new run. Raises RunFailure if there is none."""
        from sceneql.run.run import Run

        clock = self.graph.settings.clock
        first, *more = clock.frames(clock.fps)
        self.run = Run(self.graph)
        last = self.run.at(first)
        with suppress(RunFailure):
            for time in more:
                last = self.run.at(time)
        return last
