"""Letters and panels on developed pictures."""

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


LEAST, SMALLEST = 11, 0.025
"""Least height of letters: pixels, and part of the whole picture's height."""


def least_letters(height: int) -> int:
    """The least height of letters in a picture of some height [pixels]."""
    return max(LEAST, math.ceil(SMALLEST * height))


class Letterer:
    """Draws on a picture (h, w, 3) uint8, in place once it is done."""

    def __init__(self, pixels: NDArray[uint8], text_height: float, look: Look = LIGHT, scale: float = 1.0) -> None:
        """``text_height`` in parts of the height of ``pixels``.

        The whole picture, of which this may be a panel, is ``scale`` times as high: letters are never smaller than
        SMALLEST of it, nor than LEAST pixels.
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
        """Width and height of a text [pixels]; all texts of one line are of one height."""
        return int(self.draw.textlength(drawable(text), font=self.font) + 0.5), sum(self.font.getmetrics())

    def fitted(self, text: str, room: float) -> str:
        """The start of a text that fits into ``room`` [pixels]."""
        short = text
        while len(short) > 1 and self.extent(short)[0] > room:
            short = short[:-2].rstrip() + "…"
        return short

    def wrapped(self, text: str, room: float, most: int) -> list[str]:
        """A text in lines that fit into ``room`` [pixels], broken between words, the last of ``most`` lines cut."""
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
        """A panel with round corners: left, top, right, bottom."""
        self.draw.rounded_rectangle(box, self.em // 3, (*self.look.paper, round(255 * opacity)))

    def text(self, place: tuple[float, float], text: str, anchor: str = "lm", ink: Ink = None) -> None:
        """A text at a place [pixels], anchored as Pillow names it: ``lm`` is the middle of its left end."""
        self.draw.text(place, drawable(text), ink or self.look.ink, font=self.font, anchor=anchor)

    def edged(self, seen: tuple[float, float], text: str) -> None:
        """A text centered on a point, without a panel: an outline in the paper's color keeps it legible."""
        ink, paper, edge = self.look.ink, self.look.paper, self.edge
        self.draw.text(seen, drawable(text), ink, font=self.font, anchor="mm", stroke_width=edge, stroke_fill=paper)

    @property
    def edge(self) -> int:
        """Width of the outline of letters without a panel [pixels]."""
        return max(1, round(self.em / 10))

    def letter_box(self, text: str) -> tuple[int, int]:
        """Width and height [pixels] of what a text without a panel covers, outline included."""
        left, top, right, bottom = self.draw.textbbox((0, 0), drawable(text), self.font, "mm", stroke_width=self.edge)
        return 2 * math.ceil(max(-left, right)), 2 * math.ceil(max(-top, bottom))

    def block(self, text: str) -> tuple[int, int]:
        """Width and height [pixels] of a text on a panel of its own."""
        (wide, high), room = self.extent(text), round(0.4 * self.em)
        return wide + 2 * room, high + 2 * room

    def line_box(self, corner: tuple[int, int], text: str) -> tuple[int, int, int, int]:
        """Left, top, right, bottom of a text's panel with its left and top at the corner, or as near as there is room.

        [pixels]
        """
        wide, high = self.block(text)
        left, top = max(min(corner[0], self.width - wide - 1), 0), max(min(corner[1], self.height - high - 1), 0)
        return left, top, left + wide, top + high

    def line(self, corner: tuple[int, int], text: str, opacity: float, ink: Ink = None) -> None:
        """A text on a panel of its own, its left and top at the corner [pixels] or as near as the picture holds it."""
        box = self.line_box(corner, text)
        self.panel(box, opacity)
        self.text((box[0] + round(0.4 * self.em), 0.5 * (box[1] + box[3])), text, ink=ink)

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


FEWEST, MORE = 3, 8
"""Numbers that an axis has at least; asked for so many more, every axis has them."""


def marked_numbers(low: float, high: float, count: int) -> list[float]:
    """As `round_numbers`, but at least FEWEST, where fewer are not asked for."""
    rows = (round_numbers(low, high, more) for more in range(count, count + MORE))
    return next((row for row in rows if len(row) >= min(FEWEST, count)), round_numbers(low, high, count + MORE))


def round_numbers(low: float, high: float, count: int) -> list[float]:
    """About ``count`` numbers from low to high in steps of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / max(count, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= rough * (1.0 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]
