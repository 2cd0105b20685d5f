"""formula: mathematics in a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Moment, Overlay, Position, Problem, field
from sceneql.kinds.texts import overlong
from sceneql.pictures.anchors import Place, corner, projected

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View


class Formula(Overlay):
    """A formula as books print it, at an edge of the picture or over a point of the scene.

    It is written in TeX's language as far as matplotlib's mathtext has it: `a = \\frac{g\\,m_1}{r^2}`.
    """

    tex: str = field("The formula, without dollar signs.")
    place: Place = field("Where it stands in the picture.", "top left")
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

    def draw(
        self, pixels: NDArray[uint8], view: View, moment: Moment, develop: Callable[[Any], NDArray[uint8]]
    ) -> None:
        """Draw it. Raises ValueError for what is too large to draw."""
        from PIL import Image

        from sceneql.pictures.lettering import DARK, LIGHT, Letterer
        from sceneql.pictures.mathematics import printed

        letters = Letterer(pixels, self.size, DARK if self.dark else LIGHT)
        mask = Image.fromarray(printed(self.tex, letters.em))
        room = round(0.45 * letters.em)
        block = (mask.width + 2 * room, mask.height + 2 * room)
        if self.at is None:
            left, top = corner(self.place, block, (letters.width, letters.height))
        else:
            seen = projected(moment.at(self.at), view)
            if seen is None:
                return
            left, top = round(seen[0] - 0.5 * block[0]), round(seen[1] - block[1])
        letters.panel((left, top, left + block[0], top + block[1]), self.panel)
        letters.stamp(letters.look.ink, mask, (left + room, top + room))
        letters.done()
