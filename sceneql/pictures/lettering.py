"""Letters and panels on developed pictures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unicodedata import category

from sceneql.kinds.texts import MOST_LETTERS

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

Ink = tuple[int, int, int] | None
"""None: the ink of the look."""


@dataclass(frozen=True, slots=True)
class Look:
    """Colors (sRGB, some with opacity) of letters and lines, and of the panels under them."""

    paper: tuple[int, int, int]
    ink: tuple[int, int, int]
    quiet: tuple[int, int, int]
    """Ink of numbers."""
    lines: tuple[int, int, int, int]
    fine: tuple[int, int, int, int]
    """Color of the finer lines."""


LIGHT = Look((250, 250, 250), (28, 28, 32), (96, 96, 104), (0, 0, 0, 38), (0, 0, 0, 16))
DARK = Look((24, 25, 32), (238, 238, 242), (164, 166, 178), (255, 255, 255, 50), (255, 255, 255, 20))


class Letterer:
    """Draws on a picture (h, w, 3) uint8, in place once it is done."""

    def __init__(self, pixels: NDArray[uint8], text_height: float, look: Look = LIGHT) -> None:
        """``text_height`` in parts of the picture's height; letters are never smaller than 9 pixels."""
        from PIL import Image, ImageDraw

        self._pixels = pixels
        self.look = look
        self.height, self.width = pixels.shape[:2]
        self.em = max(9, round(text_height * self.height))
        self.font = font(self.em)
        self._image = Image.fromarray(pixels)
        self.draw: Any = ImageDraw.Draw(self._image, "RGBA")

    def extent(self, text: str) -> tuple[int, int]:
        """Width and height of a text [pixels]; all texts of one line are of one height."""
        return int(self.draw.textlength(drawable(text), font=self.font) + 0.5), sum(self.font.getmetrics())

    def panel(self, box: tuple[int, int, int, int], opacity: float) -> None:
        """A panel with round corners: left, top, right, bottom."""
        self.draw.rounded_rectangle(box, self.em // 3, (*self.look.paper, round(255 * opacity)))

    def text(self, place: tuple[float, float], text: str, anchor: str = "lm", ink: Ink = None) -> None:
        """A text at a place [pixels], anchored as Pillow names it: ``lm`` is the middle of its left end."""
        self.draw.text(place, drawable(text), ink or self.look.ink, font=self.font, anchor=anchor)

    def edged(self, seen: tuple[float, float], text: str) -> None:
        """A text centered on a point, without a panel: an outline in the paper's color keeps it legible."""
        ink, paper, edge = self.look.ink, self.look.paper, max(1, round(self.em / 10))
        self.draw.text(seen, drawable(text), ink, font=self.font, anchor="mm", stroke_width=edge, stroke_fill=paper)

    def line(self, corner: tuple[int, int], text: str, opacity: float, ink: Ink = None) -> None:
        """A text on a panel of its own, its left and top at the corner [pixels] or as near as the picture holds it."""
        (wide, high), room = self.extent(text), round(0.4 * self.em)
        left = max(min(corner[0], self.width - wide - 2 * room - 1), 0)
        top = max(min(corner[1], self.height - high - 2 * room - 1), 0)
        self.panel((left, top, left + wide + 2 * room, top + high + 2 * room), opacity)
        self.text((left + room, top + room + 0.5 * high), text, ink=ink)

    def over(self, seen: tuple[float, float], text: str, opacity: float) -> None:
        """A text on a panel over a point [pixels]."""
        (wide, high), room = self.extent(text), round(0.4 * self.em)
        self.line((round(seen[0] - 0.5 * wide) - room, round(seen[1] - high) - 2 * room), text, opacity)

    def under(self, seen: tuple[float, float], text: str, opacity: float) -> None:
        """A text on a panel under a point [pixels]."""
        wide, _ = self.extent(text)
        self.line((round(seen[0] - 0.5 * wide) - round(0.4 * self.em), round(seen[1])), text, opacity)

    def paste(self, block: NDArray[uint8], left: int, top: int) -> None:
        """Pixels (h, w, 3) over the picture."""
        from PIL import Image

        self._image.paste(Image.fromarray(block), (left, top))

    def stamp(self, color: tuple[int, int, int], mask: Any, corner: tuple[int, int]) -> None:
        """A color through a mask (Pillow, 8 bits), its left and top at a corner [pixels]."""
        self._image.paste(color, (*corner, corner[0] + mask.width, corner[1] + mask.height), mask)

    def done(self) -> None:
        """Write all of it into the picture."""
        import numpy as np

        self._pixels[:] = np.asarray(self._image)


def drawable(text: str) -> str:
    """A text as one line of signs: line breaks and controls are spaces, marks without a shape of their own left out."""
    signs = "".join(" " if category(one) in ("Cc", "Cs", "Zl", "Zp") else one for one in text[:MOST_LETTERS])
    return "".join(one for one in signs if category(one) != "Cf")


@cache
def font(size: int) -> Any:
    """DejaVu Sans, which comes with matplotlib: the same letters on every machine, of most languages."""
    from importlib.util import find_spec

    from PIL import ImageFont

    found = find_spec("matplotlib")
    if found is None or found.origin is None:
        raise LookupError("the letters for pictures come with matplotlib, which is missing")
    path = Path(found.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(str(path), size, layout_engine=ImageFont.Layout.BASIC)


def round_numbers(low: float, high: float, count: int) -> list[float]:
    """About ``count`` numbers from low to high in steps of 1, 2 or 5 times a power of ten."""
    import math

    rough = (high - low) / max(count, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= rough * (1.0 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]
