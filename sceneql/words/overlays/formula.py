"""formula: mathematics in a picture."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Moment, Overlay, Position, field
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

    def draw(
        self, pixels: NDArray[uint8], view: View, moment: Moment, develop: Callable[[Any], NDArray[uint8]]
    ) -> None:
        """Draw it. Raises ValueError for what mathtext cannot read."""
        from PIL import Image

        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

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


@cache
def printed(tex: str, em: int) -> NDArray[uint8]:
    """A formula (h, w) in ink 255 on 0, letters ``em`` pixels high. Raises ValueError for one that cannot be read."""
    import numpy as np
    from matplotlib.font_manager import FontProperties
    from matplotlib.mathtext import MathTextParser

    font = FontProperties(size=1.15 * em, math_fontfamily="cm")
    image = np.asarray(MathTextParser("agg").parse(f"${tex}$", dpi=72, prop=font).image)
    return np.ascontiguousarray(image, dtype=np.uint8)
