"""Script colors are sRGB; everything behind the script is linear. The default palette."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import RGB


PALETTE = ("#e4572e", "#2978b5", "#f2a71b", "#3a9d6b", "#8c55a8", "#14a3a8", "#d6457f", "#7f9c2c")
"""sRGB colors of parts that have none of their own, by their order."""


def linear(color: Iterable[float]) -> RGB:
    """Linear RGB of an sRGB color, components from 0 to 1 (IEC 61966-2-1:1999); what is negative becomes 0."""
    r, g, b = (_decode(float(c)) for c in color)
    return r, g, b


def _decode(c: float) -> float:
    if c <= 0.04045:
        return max(c, 0.0) / 12.92
    return float(((c + 0.055) / 1.055) ** 2.4)


def default_color(index: int) -> RGB:
    """Linear RGB of the part that is drawn at this place in the order."""
    digits = PALETTE[index % len(PALETTE)].removeprefix("#")
    return linear(int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4))
