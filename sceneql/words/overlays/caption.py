"""caption: words in a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Moment, Overlay, Position, Value, WordsOverTime, field
from sceneql.pictures.anchors import Place, corner, projected

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View


class Caption(Overlay):
    """A line of text at an edge of the picture, or over a point of the scene, which it follows.

    Values stand in braces with how they are written and their unit: `t = {time:.2f s}`, `{count(dust.positions):.0f}
    grains`. Operations over time are given the run so far: `{max(abs(relative_drift(sky.energy))):.0e}`.
    """

    text: WordsOverTime = field("What it says.")
    place: Place = field("Where it stands in the picture.", "top left")
    at: Position | None = field("The point that it stands over, in place of that.", None)
    size: FixedScalar = field("Height of its letters in parts of the picture's.", "0.045", above=0, at_most=0.3)
    panel: FixedScalar = field("Opacity of the panel that it stands on.", "0.7", at_least=0, at_most=1)

    def courses(self) -> Iterable[Value]:
        """The values that look over the run."""
        return self.text.courses

    def draw(
        self, pixels: NDArray[uint8], view: View, moment: Moment, develop: Callable[[Any], NDArray[uint8]]
    ) -> None:
        """Draw the line; nothing where its point lies behind the camera."""
        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

        letters, text = Letterer(pixels, self.size, DARK if self.dark else LIGHT), self.text.at(moment)
        room = round(0.4 * letters.em)
        if self.at is None:
            wide, high = letters.extent(text)
            picture = (letters.width, letters.height)
            letters.line(corner(self.place, (wide + 2 * room, high + 2 * room), picture), text, self.panel)
        else:
            seen = projected(moment.at(self.at), view)
            if seen is None:
                return
            letters.over(seen, text, self.panel)
        letters.done()
