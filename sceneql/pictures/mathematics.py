"""Formulas as pictures, typeset by matplotlib's mathtext, and a check of formulas before they are drawn."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any
from unicodedata import category

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

DEEPEST = 15
"""Largest depth of nested groups: mathtext's parser takes some 40 Python calls for each level."""
WIDEST = 400
LARGEST = 2_000
"""Largest width [heights of letters] and area [their squares]: larger formulas exhaust the memory."""
SIGN = re.compile(r"\\[A-Za-z]+|\\.|.", re.DOTALL)
OPENED = re.compile(r"\{|\\left(?![A-Za-z])")
CLOSED = re.compile(r"\}|\\right(?![A-Za-z])")
ARGUMENTS = re.compile(r"expected (\\[A-Za-z]+)")
"""Pattern of pyparsing's message about a command with missing groups; the error's place is after the command."""

Fault = tuple[str, int, int]
"""Message, and first and last (exclusive) character of the faulty part of the text."""


class UnsetError(ValueError):
    """Error for a formula that cannot be typeset. ``place``: index of the wrong character, None if unknown."""

    def __init__(self, said: str, place: int | None) -> None:
        super().__init__(said)
        self.place = place


@lru_cache(maxsize=256)
def fault(tex: str) -> Fault | None:
    """Fault of a formula, found by typesetting it; None for a valid one."""
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
    """Picture (h, w) uint8 of a formula, 255 for ink, letters ``em`` pixels high. Raises UnsetError for a fault."""
    import numpy as np
    from matplotlib.mathtext import MathTextParser

    text = plain(tex)
    _box(text, em)
    image = np.asarray(MathTextParser("agg").parse(f"${text}$", dpi=72, prop=_font(em)).image)
    return np.ascontiguousarray(image, dtype=np.uint8)


def plain(tex: str) -> str:
    """Text with control and format characters replaced by spaces, which TeX skips, so that indices stay the same."""
    return "".join(" " if category(one) in ("Cc", "Cf", "Zl", "Zp") else one for one in tex)


def _box(text: str, em: int) -> None:
    """Typeset a formula without drawing it. Raises UnsetError for a faulty or too large one."""
    from matplotlib.mathtext import MathTextParser

    try:
        wide, high, *_ = MathTextParser("path").parse(f"${text}$", dpi=72, prop=_font(em))
    except RecursionError:
        raise UnsetError(f"groups are nested more than {DEEPEST} deep", None) from None
    except (RuntimeError, OverflowError):  # from the fonts
        raise UnsetError("a length in it is too large or too small", None) from None
    except ValueError as error:
        raise _told(error.__context__, text) from None
    if not (wide <= WIDEST * em and wide * high <= LARGEST * em * em):
        size = f"{wide / em:.4g} letters wide and {high / em:.4g} high"
        raise UnsetError(f"a formula of {size} is too large", None)


def _told(error: Any, text: str) -> UnsetError:
    """One-line error from an error of pyparsing, mathtext's parser."""
    said, whole = str(error.msg), error.pstr != text  # whole: the error is about the text with its dollar signs
    if said.startswith("Expected {") or whole:  # pyparsing lists its whole grammar, or expects the end of the text
        said = "a group, a letter or a command is missing or wrong here"
    said, place = said[0].lower() + said[1:].replace("\\\\", "\\"), error.loc
    if (command := ARGUMENTS.match(said)) is not None:
        place = max(place - len(command[1]), text.rfind(command[1], 0, place + 1))
    return UnsetError(said, None if whole else place)


@cache
def _font(em: int) -> Any:
    from matplotlib.font_manager import FontProperties

    return FontProperties(size=1.15 * em, math_fontfamily="cm")
