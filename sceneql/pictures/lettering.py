"""Text and panels on developed pictures."""

from __future__ import annotations

import math
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
"""Color (sRGB); None: that of the look."""


@dataclass(frozen=True, slots=True)
class Look:
    """Colors (sRGB, some with opacity) of text, lines and panels."""

    paper: tuple[int, int, int]
    ink: tuple[int, int, int]
    quiet: tuple[int, int, int]
    """Color of numbers."""
    lines: tuple[int, int, int, int]
    fine: tuple[int, int, int, int]
    """Color of the finer lines."""


LIGHT = Look((250, 250, 250), (28, 28, 32), (96, 96, 104), (0, 0, 0, 38), (0, 0, 0, 16))
DARK = Look((24, 25, 32), (238, 238, 242), (164, 166, 178), (255, 255, 255, 50), (255, 255, 255, 20))


LEAST, SMALLEST = 11, 0.025
"""Least height of letters [pixels], and relative to the whole picture's height."""


def least_letters(height: int) -> int:
    """Least height of letters [pixels] in a picture of a height [pixels]."""
    return max(LEAST, math.ceil(SMALLEST * height))


class Letterer:
    """Drawing of text and panels on a picture (h, w, 3) uint8; `done` writes it into the picture."""

    def __init__(self, pixels: NDArray[uint8], text_height: float, look: Look = LIGHT, scale: float = 1.0) -> None:
        """``text_height``: relative to the height of ``pixels``.

        ``scale``: height of the whole picture, of which this may be a panel, over that of ``pixels``. Letters are
        never smaller than SMALLEST of the whole picture, nor than LEAST pixels.
        """
        from PIL import Image, ImageDraw

        self._pixels = pixels
        self.look = look
        self.height, self.width = pixels.shape[:2]
        self.least = least_letters(round(scale * self.height))
        self.em: int = max(self.least, round(text_height * self.height))
        self.font = font(self.em)
        self._image = Image.fromarray(pixels)
        self.draw: Any = ImageDraw.Draw(self._image, "RGBA")

    def extent(self, text: str) -> tuple[int, int]:
        """Width and height of a text [pixels]; the height is that of the font, for any text."""
        return int(self.draw.textlength(drawable(text), font=self.font) + 0.5), sum(self.font.getmetrics())

    def fitted(self, text: str, room: float) -> str:
        """Text shortened, with an ellipsis, to fit into ``room`` [pixels]."""
        short = text
        while len(short) > 1 and self.extent(short)[0] > room:
            short = short[:-2].rstrip() + "…"
        return short

    def wrapped(self, text: str, room: float, most: int) -> list[str]:
        """Lines of a text that fit into ``room`` [pixels], broken between words; the last of ``most`` lines is cut."""
        lines: list[str] = []
        words = text.split()
        while words:
            fit = 1
            while fit < len(words) and self.extent(" ".join(words[: fit + 1]))[0] <= room:
                fit += 1
            fit = len(words) if len(lines) == most - 1 else fit
            lines.append(self.fitted(" ".join(words[:fit]), room))
            words = words[fit:]
        return lines

    def panel(self, box: tuple[int, int, int, int], opacity: float) -> None:
        """Draw a panel with round corners; ``box``: left, top, right, bottom [pixels]."""
        self.draw.rounded_rectangle(box, self.em // 3, (*self.look.paper, round(255 * opacity)))

    def text(self, place: tuple[float, float], text: str, anchor: str = "lm", ink: Ink = None) -> None:
        """Draw a text at a place [pixels]; ``anchor`` as in Pillow: ``lm`` is the middle of its left end."""
        self.draw.text(place, drawable(text), ink or self.look.ink, font=self.font, anchor=anchor)

    def edged(self, seen: tuple[float, float], text: str) -> None:
        """Draw a text centered on a point [pixels], without a panel, with an outline in the paper's color."""
        ink, paper, edge = self.look.ink, self.look.paper, self.edge
        self.draw.text(seen, drawable(text), ink, font=self.font, anchor="mm", stroke_width=edge, stroke_fill=paper)

    @property
    def edge(self) -> int:
        """Width of the outline of letters without a panel [pixels]."""
        return max(1, round(self.em / 10))

    def letter_box(self, text: str) -> tuple[int, int]:
        """Width and height [pixels] of a text without a panel, with its outline."""
        left, top, right, bottom = self.draw.textbbox((0, 0), drawable(text), self.font, "mm", stroke_width=self.edge)
        return 2 * math.ceil(max(-left, right)), 2 * math.ceil(max(-top, bottom))

    def block(self, text: str) -> tuple[int, int]:
        """Width and height [pixels] of a text on its own panel."""
        (wide, high), room = self.extent(text), round(0.4 * self.em)
        return wide + 2 * room, high + 2 * room

    def line_box(self, corner: tuple[int, int], text: str) -> tuple[int, int, int, int]:
        """Left, top, right, bottom [pixels] of a text's panel: top left at ``corner``, moved into the picture."""
        wide, high = self.block(text)
        left, top = max(min(corner[0], self.width - wide - 1), 0), max(min(corner[1], self.height - high - 1), 0)
        return left, top, left + wide, top + high

    def line(self, corner: tuple[int, int], text: str, opacity: float, ink: Ink = None) -> None:
        """Draw a text on its own panel, with its top left at ``corner`` [pixels], moved into the picture."""
        box = self.line_box(corner, text)
        self.panel(box, opacity)
        self.text((box[0] + round(0.4 * self.em), 0.5 * (box[1] + box[3])), text, ink=ink)

    def paste(self, block: NDArray[uint8], left: int, top: int) -> None:
        """Draw pixels (h, w, 3) over the picture."""
        from PIL import Image

        self._image.paste(Image.fromarray(block), (left, top))

    def stamp(self, color: tuple[int, int, int], mask: Any, corner: tuple[int, int]) -> None:
        """Draw a color through a mask (Pillow, 8 bits), with its top left at ``corner`` [pixels]."""
        self._image.paste(color, (*corner, corner[0] + mask.width, corner[1] + mask.height), mask)

    def done(self) -> None:
        """Write the drawing into the picture."""
        import numpy as np

        self._pixels[:] = np.asarray(self._image)


def drawable(text: str) -> str:
    """Text as one line of characters: line breaks and controls become spaces, format characters are removed."""
    signs = "".join(" " if category(one) in ("Cc", "Cs", "Zl", "Zp") else one for one in text[:MOST_LETTERS])
    return "".join(one for one in signs if category(one) != "Cf")


@cache
def font(size: int) -> Any:
    """DejaVu Sans from matplotlib: the same letters on every machine, for most languages. Raises LookupError."""
    from importlib.util import find_spec

    from PIL import ImageFont

    found = find_spec("matplotlib")
    if found is None or found.origin is None:
        raise LookupError("the letters for pictures come with matplotlib, which is missing")
    path = Path(found.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(str(path), size, layout_engine=ImageFont.Layout.BASIC)


FEWEST, MORE = 3, 8
"""Least count of numbers at an axis, and the increase of the requested count with which every axis reaches it."""


def marked_numbers(low: float, high: float, count: int) -> list[float]:
    """Numbers as from `round_numbers`, but at least FEWEST of them, unless ``count`` is less."""
    rows = (round_numbers(low, high, more) for more in range(count, count + MORE))
    return next((row for row in rows if len(row) >= min(FEWEST, count)), round_numbers(low, high, count + MORE))


def round_numbers(low: float, high: float, count: int) -> list[float]:
    """Multiples from low to high, about ``count`` of them, of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / max(count, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= rough * (1.0 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]
