"""Colors: sRGB of scripts converted to linear RGB, which all other code uses, and the default palette."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import RGB


PALETTE = ("#e4572e", "#2978b5", "#f2a71b", "#3a9d6b", "#8c55a8", "#14a3a8", "#d6457f", "#7f9c2c")
"""sRGB colors of parts without a color of their own, in turn by the order in which the parts are drawn."""


def linear(color: Iterable[float]) -> RGB:
    """Linear RGB of an sRGB color, both with components from 0 to 1 (IEC 61966-2-1:1999).

    Components outside 0 to 1 are clamped: an albedo above 1 would gain energy at each reflection.
    """
    r, g, b = (_decode(min(max(float(c), 0.0), 1.0)) for c in color)
    return r, g, b


def _decode(c: float) -> float:
    if c <= 0.04045:
        return c / 12.92
    return float(((c + 0.055) / 1.055) ** 2.4)


def default_color(index: int) -> RGB:
    """Linear RGB of the default color of the part that is drawn as number ``index``."""
    return linear(level / 255 for level in eight_bits(PALETTE[index % len(PALETTE)]))


def eight_bits(color: str | Iterable[float]) -> tuple[int, int, int]:
    """Levels from 0 to 255 of a color written ``#rrggbb``, or of its sRGB components from 0 to 1."""
    if isinstance(color, str):
        return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
    r, g, b = (round(255 * min(max(float(c), 0.0), 1.0)) for c in color)
    return r, g, b
