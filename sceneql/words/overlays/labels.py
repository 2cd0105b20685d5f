"""labels: the names of things beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

from sceneql.kinds import DrawnRef, FixedScalar, Moment, Object, Overlay, Ref, Value, WordsOverTime, field
from sceneql.pictures.anchors import projected
from sceneql.pictures.framing import corners, whereabouts

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View
    from sceneql.graph import Task

TEXT = 0.035
"""Height of the letters of objects' own labels in parts of the picture's."""


class Labels(Overlay):
    """Words over or under parts of the scene, which they follow."""

    of: dict[DrawnRef, WordsOverTime] = field("What each part is called: `{ball: a ball}`; values stand in braces.")
    place: Literal["above", "below"] = field("The side of the part.", "above")
    size: FixedScalar = field("Height of the letters in parts of the picture's.", "0.035", above=0, at_most=0.3)
    panel: FixedScalar = field("Opacity of the panels that they stand on.", "0.7", at_least=0, at_most=1)

    def courses(self) -> Iterable[Value]:
        """The values that look over the run."""
        return [value for text in self.of.values() for value in text.courses]

    def draw(
        self, pixels: NDArray[uint8], view: View, moment: Moment, develop: Callable[[Any], NDArray[uint8]]
    ) -> None:
        """Draw those that are before the camera."""
        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

        letters = Letterer(pixels, self.size, DARK if self.dark else LIGHT)
        for ref, text in self.of.items():
            seen = [place for point in _around(ref, moment) if (place := projected(point, view)) is not None]
            if seen:
                x = 0.5 * (min(x for x, _ in seen) + max(x for x, _ in seen))
                gap = 0.35 * letters.em
                if self.place == "above":
                    letters.over((x, min(y for _, y in seen) - gap), text.at(moment), self.panel)
                else:
                    letters.under((x, max(y for _, y in seen) + gap), text.at(moment), self.panel)
        letters.done()


def _around(ref: Ref, moment: Moment) -> Any:
    """Corners (n, 3) of a part's box now; its place alone where it has none."""
    import numpy as np

    part: Any = moment.object(ref)
    if isinstance(part, Object):
        try:
            low, high = part.extent(moment.place(ref.name), moment)
        except TypeError:
            low = high = np.full(3, np.inf)
        if np.isfinite([low, high]).all():
            return corners(low, high)
    return np.asarray(whereabouts(moment, ref))[None]


def draw_labels(
    pixels: NDArray[uint8], view: View, tasks: Mapping[str, Task], names: Iterable[str], moment: Moment
) -> None:
    """The labels that objects have of their own, and those of their members."""
    from sceneql.pictures.lettering import Letterer

    found = [label for name in names for label in _own(tasks, name, moment)]
    if found:
        letters = Letterer(pixels, TEXT)
        for point, text in found:
            seen = projected(point, view)
            if seen is not None:
                letters.edged(seen, text)
        letters.done()


def _own(tasks: Mapping[str, Task], name: str, moment: Moment) -> Iterable[tuple[Any, str]]:
    kind = tasks[name].kind
    if isinstance(kind, Object):
        yield from kind.labels(name, moment)
        for ref in kind.members():
            yield from _own(tasks, ref.name, moment)
