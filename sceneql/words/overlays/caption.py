"""caption: a line of text in a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Moment, Overlay, Position, Value, WordsOverTime, field
from sceneql.pictures.anchors import EDGES, Box, Place, box_at, corner, projected
from sceneql.pictures.callouts import UP, lead, stand

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View


DIGIT = "0"


class Caption(Overlay):
    """A line of text at an edge of the picture, or over a point of the scene, which it follows.

    Values stand in braces with how they are written and their unit: `t = {time:.2f s}`, `{count(dust.positions):.0f}
    grains`. Operations over time are given the run so far: `{max(abs(relative_drift(sky.energy))):.0e}`.

    For example `told: {caption: {text: "E = {swing.energy:.2f J}", place: top left}}`.
    """

    text: WordsOverTime = field("What it says.")
    place: Place | None = field("Where it stands in the picture; by default at an edge that is free.", None)
    at: Position | None = field("The point that it stands over, in place of that.", None)
    size: FixedScalar = field("Height of its letters in parts of the picture's.", "0.045", above=0, at_most=0.3)
    panel: FixedScalar = field("Opacity of the panel that it stands on.", "0.7", at_least=0, at_most=1)

    def courses(self) -> Iterable[Value]:
        """The values that look over the run."""
        return self.text.courses

    def places(self) -> tuple[str, ...]:
        """Edges and corners, for one that stands over no point."""
        return () if self.at is not None else EDGES if self.place is None else (self.place,)

    def box(self, place: str, size: tuple[int, int], moment: Moment, scale: float) -> Box | None:
        """The box of its panel, with room for one more digit in each value."""
        from sceneql.pictures.layout import page
        from sceneql.pictures.lettering import Letterer

        letters = Letterer(page(size), self.size, scale=scale)
        return box_at(place, letters.block(self.text.at(moment) + DIGIT * len(self.text.values)), size)

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
        scale: float = 1.0,
    ) -> None:
        """Draw the line; nothing where its point lies behind the camera."""
        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

        letters, text = Letterer(pixels, self.size, DARK if self.dark else LIGHT, scale), self.text.at(moment)
        block, picture = letters.block(text), (letters.width, letters.height)
        if self.at is None:
            letters.line(corner(self.place or EDGES[0], block, picture), text, self.panel)
        elif (seen := projected(moment.at(self.at), view)) is not None:
            thing = (*seen, *seen)
            box = stand(thing, UP, block, picture, 0.0, letters.em)
            lead(letters, thing, box)
            letters.line(box[:2], text, self.panel)
        letters.done()
