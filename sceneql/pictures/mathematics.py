"""Formulas as pictures, and what is wrong with one before it is drawn; matplotlib's mathtext reads and sets them."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any
from unicodedata import category

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

DEEPEST = 15
"""Most groups within one another: mathtext's parser takes some 40 calls of Python for each."""
WIDEST = 400
LARGEST = 2_000
"""Most letters' heights of width, and squares of such of area: what is larger fills the memory, and no picture."""
SIGN = re.compile(r"\\[A-Za-z]+|\\.|.", re.DOTALL)
OPENED = re.compile(r"\{|\\left(?![A-Za-z])")
CLOSED = re.compile(r"\}|\\right(?![A-Za-z])")
ARGUMENTS = re.compile(r"expected (\\[A-Za-z]+)")
"""The message on a command whose groups are missing; its place is behind the command."""

Fault = tuple[str, int, int]
"""What is wrong, and the characters of the text where it is."""


class UnsetError(ValueError):
    """A formula that cannot be set. ``place``: number of the wrong character, None where that is not known."""

    def __init__(self, said: str, place: int | None) -> None:
        super().__init__(said)
        self.place = place


@lru_cache(maxsize=256)
def fault(tex: str) -> Fault | None:
    """What is wrong with a formula, found as its picture would be; None where there is nothing."""
    if not (text := plain(tex)).strip():
        return "a formula needs letters", 0, len(tex)
    depth = 0
    for sign in SIGN.finditer(text):
        depth += (OPENED.fullmatch(sign[0]) is not None) - (CLOSED.fullmatch(sign[0]) is not None)
        if depth > DEEPEST:
            return f"groups are nested more than {DEEPEST} deep", *sign.span()
        if depth < 0:
            return f"this {sign[0]} has no partner", *sign.span()
        if sign[0] in ("$", "%", "#"):
            help = "the formula stands without dollar signs" if sign[0] == "$" else "it has a meaning of its own in TeX"
            return f"{sign[0]} is written \\{sign[0]}: {help}", *sign.span()
    try:
        _box(text, 20)
    except UnsetError as error:
        found = None if error.place is None else SIGN.match(text, min(error.place, len(text) - 1))
        return (str(error), 0, len(text)) if found is None else (str(error), *found.span())
    return None


@cache
def printed(tex: str, em: int) -> NDArray[uint8]:
    """A formula (h, w) in ink 255 on 0, letters ``em`` pixels high. Raises ValueError for one that cannot be read."""
    import numpy as np
    from matplotlib.mathtext import MathTextParser

    text = plain(tex)
    _box(text, em)
    image = np.asarray(MathTextParser("agg").parse(f"${text}$", dpi=72, prop=_font(em)).image)
    return np.ascontiguousarray(image, dtype=np.uint8)


def plain(tex: str) -> str:
    """The text with a space, which TeX skips, for each character that is no sign: line breaks, marks of direction."""
    return "".join(" " if category(one) in ("Cc", "Cf", "Zl", "Zp") else one for one in tex)


def _box(text: str, em: int) -> None:
    """Set a formula without drawing it. Raises UnsetError."""
    from matplotlib.mathtext import MathTextParser

    try:
        wide, high, *_ = MathTextParser("path").parse(f"${text}$", dpi=72, prop=_font(em))
    except RecursionError:
        raise UnsetError(f"groups are nested more than {DEEPEST} deep", None) from None
    except (RuntimeError, OverflowError):  # of the fonts
        raise UnsetError("a length in it is too large or too small", None) from None
    except ValueError as error:
        raise _told(error.__context__, text) from None
    if not (wide <= WIDEST * em and wide * high <= LARGEST * em * em):
        size = f"{wide / em:.4g} letters wide and {high / em:.4g} high"
        raise UnsetError(f"a formula of {size} is too large", None)


def _told(error: Any, text: str) -> UnsetError:
    """An error of pyparsing, which mathtext reads by, in one line."""
    said, whole = str(error.msg), error.pstr != text  # whole: of the text with its dollar signs, which is none
    if said.startswith("Expected {") or whole:  # all of its grammar, or that the text should end where it begins
        said = "a group, a letter or a command is missing or wrong here"
    said, place = said[0].lower() + said[1:].replace("\\\\", "\\"), error.loc
    if (command := ARGUMENTS.match(said)) is not None:
        place = max(place - len(command[1]), text.rfind(command[1], 0, place + 1))
    return UnsetError(said, None if whole else place)


@cache
def _font(em: int) -> Any:
    from matplotlib.font_manager import FontProperties

    return FontProperties(size=1.15 * em, math_fontfamily="cm")
