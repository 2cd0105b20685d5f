"""labels: names beside things."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

from sceneql.kinds import DrawnRef, FixedScalar, Moment, Object, Overlay, Ref, Value, WordsOverTime, field
from sceneql.pictures.anchors import Box, outline
from sceneql.pictures.callouts import DOWN, UP, Thing, Way, lead, stand
from sceneql.pictures.framing import corners, whereabouts

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View
    from sceneql.graph import Task
    from sceneql.pictures.lettering import Letterer

GAP = 0.35
"""Gap between a label and the labelled thing, in heights of letters."""
TEXT = 0.035
"""Height of the letters of objects' own labels, relative to the picture's."""


class Labels(Overlay):
    """Words over or under parts of the scene, which they follow.

    For example `names: {labels: {of: {ball: a ball}}}`.
    """

    of: dict[DrawnRef, WordsOverTime] = field("What each part is called: `{ball: a ball}`; values stand in braces.")
    place: Literal["above", "below"] = field("The side of the part.", "above")
    size: FixedScalar = field("Height of the letters in parts of the picture's.", "0.035", above=0, at_most=0.3)
    panel: FixedScalar = field("Opacity of the panels that they stand on.", "0.7", at_least=0, at_most=1)

    def courses(self) -> Iterable[Value]:
        """The values that look over the run."""
        return [value for text in self.of.values() for value in text.courses]

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
        scale: float = 1.0,
    ) -> None:
        """Draw those that are before the camera."""
        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

        letters = Letterer(pixels, self.size, DARK if self.dark else LIGHT, scale)
        picture, gap, way = (letters.width, letters.height), GAP * letters.em, UP if self.place == "above" else DOWN
        things = {ref: outline(_around(ref, moment), view) for ref in self.of}
        seen = {ref: thing for ref, thing in things.items() if thing is not None}
        taken: dict[Ref, Box] = {}
        for ref, thing in seen.items():
            block, others = letters.block(self.of[ref].at(moment)), [one for it, one in seen.items() if it != ref]
            taken[ref] = stand(thing, way, block, picture, gap, letters.em, list(taken.values()), others)
            lead(letters, thing, taken[ref])
        for ref, box in taken.items():
            letters.line(box[:2], self.of[ref].at(moment), self.panel)
        letters.done()


def _around(ref: Ref, moment: Moment) -> Any:
    """Corners (8, 3) [m] of a part's box now; its place (1, 3) if the box is infinite or missing.

    The box is that of its surface: the `bounds` of an implicit object may be far larger.
    """
    import numpy as np

    from sceneql.frame import Implicit
    from sceneql.shapes.world_boxes import surface_box

    part: Any = moment.object(ref)
    if isinstance(part, Object):
        place = moment.place(ref.name)
        try:
            low, high = part.extent(place, moment)
            solids = [shape for shape in part.lower(ref.name, place, moment) if isinstance(shape, Implicit)]
            if solids:
                lows, highs = zip(*map(surface_box, solids), strict=True)
                low, high = np.maximum(low, np.min(lows, axis=0)), np.minimum(high, np.max(highs, axis=0))
        except TypeError:
            low = high = np.full(3, np.inf)
        if np.isfinite([low, high]).all():
            return corners(low, high)
    return np.asarray(whereabouts(moment, ref))[None]


def draw_labels(
    pixels: NDArray[uint8], view: View, tasks: Mapping[str, Task], names: Iterable[str], moment: Moment, scale: float
) -> None:
    """Draw the labels of named objects and of their members beside the labelled things."""
    from sceneql.pictures.lettering import Letterer

    found = [label for name in names for label in _own(tasks, name, moment)]
    if found:
        letters = Letterer(pixels, TEXT, scale=scale)
        placed = label_boxes(letters, view, found)
        for thing, box, text in placed:
            lead(letters, thing, box)
            letters.edged((0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])), text)
        letters.done()


def label_boxes(
    letters: Letterer, view: View, labels: Iterable[tuple[Any, Any, str]]
) -> list[tuple[tuple[float, float, float, float], Box, str]]:
    """For each visible label (Object.labels): box of the labelled thing [pixels], box of the label, and text."""
    seen: list[tuple[Thing, Way, str]] = []
    for points, direction, text in labels:
        thing, ahead = outline(points, view), outline(points + direction, view)
        if thing is not None and ahead is not None:
            way = (ahead[0] + ahead[2] - thing[0] - thing[2], ahead[1] + ahead[3] - thing[1] - thing[3])
            seen.append((thing, way if math.hypot(*way) > 1.0 else UP, text))
    placed: list[tuple[Thing, Box, str]] = []
    for thing, way, text in seen:
        wide, high = letters.letter_box(text)
        taken, others = [box for _, box, _ in placed], [other for other, *_ in seen if other is not thing]
        picture, gap = (letters.width, letters.height), letters.edge + 1.0
        placed.append((thing, stand(thing, way, (wide, high), picture, gap, letters.em, taken, others), text))
    return placed


def _own(tasks: Mapping[str, Task], name: str, moment: Moment) -> Iterable[tuple[Any, Any, str]]:
    kind = tasks[name].kind
    if isinstance(kind, Object):
        yield from kind.labels(name, moment)
        for ref in kind.members():
            yield from _own(tasks, ref.name, moment)
