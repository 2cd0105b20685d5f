"""formula: mathematics in a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any

from sceneql.kinds import FixedScalar, Moment, Overlay, Position, Problem, field
from sceneql.kinds.texts import overlong
from sceneql.kinds.values import Verbatim
from sceneql.pictures.anchors import EDGES, Box, Place, box_at, projected
from sceneql.pictures.callouts import UP, lead, stand

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View


class Formula(Overlay):
    """A formula as books print it, at an edge of the picture or over a point of the scene.

    It is written in TeX's language as far as matplotlib's mathtext has it: `a = \\frac{g\\,m_1}{r^2}`.
    """

    tex: Annotated[str, Verbatim()] = field("The formula, without dollar signs.")
    place: Place | None = field("Where it stands in the picture; by default at an edge that is free.", None)
    at: Position | None = field("The point that it stands over, in place of that.", None)
    size: FixedScalar = field("Height of its letters in parts of the picture's.", "0.05", above=0, at_most=0.3)
    panel: FixedScalar = field("Opacity of the panel that it stands on.", "0.7", at_least=0, at_most=1)

    def problems(self) -> Iterator[Problem]:
        """What mathtext cannot set. It is imported here, and numpy with it, for a script with a formula alone."""
        if said := overlong(self.tex):
            yield Problem(said, ("tex",), code="limit-refused")
            return
        from sceneql.pictures.mathematics import fault

        if (found := fault(self.tex)) is not None:
            said, start, end = found
            yield Problem(said, ("tex",), code="not-tex", part=(self.tex, start, end))

    def places(self) -> tuple[str, ...]:
        """Edges and corners, for one that stands over no point."""
        return () if self.at is not None else EDGES if self.place is None else (self.place,)

    def box(self, place: str, size: tuple[int, int], moment: Moment, scale: float) -> Box | None:
        """The box of its panel."""
        from sceneql.pictures.layout import page
        from sceneql.pictures.lettering import Letterer

        return box_at(place, self._printed(Letterer(page(size), self.size, scale=scale).em)[1], size)

    def _printed(self, em: int) -> tuple[Any, tuple[int, int]]:
        """Picture of the formula, and width and height [pixels] of its panel. Raises ValueError if it is too large."""
        from sceneql.pictures.mathematics import printed

        mask, room = printed(self.tex, em), round(0.45 * em)
        return mask, (mask.shape[1] + 2 * room, mask.shape[0] + 2 * room)

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
        scale: float = 1.0,
    ) -> None:
        """Draw it. Raises ValueError for what is too large to draw."""
        from PIL import Image

        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

        letters = Letterer(pixels, self.size, DARK if self.dark else LIGHT, scale)
        mask, block = self._printed(letters.em)
        room, picture = round(0.45 * letters.em), (letters.width, letters.height)
        if self.at is None:
            box = box_at(self.place or EDGES[0], block, picture)
        else:
            seen = projected(moment.at(self.at), view)
            if seen is None:
                return
            thing = (*seen, *seen)
            box = stand(thing, UP, block, picture, 0.0, letters.em)
            lead(letters, thing, box)
        letters.panel(box, self.panel)
        letters.stamp(letters.look.ink, Image.fromarray(mask), (box[0] + room, box[1] + room))
        letters.done()
