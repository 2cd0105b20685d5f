"""Names and control colors of the color maps, for the fields of words; maps.colors makes the maps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

CONTROLS: Mapping[str, str] = {
    "viridis": "440154 472d7b 3b528b 2c728e 21918c 28ae80 5ec962 addc30 fde725",
    "inferno": "000004 1b0c41 4a0c6b 781c6d a52c60 cf4446 ed6925 fb9b06 f7d13d fcffa4",
    "gray": "111111 f5f5f5",
    "coolwarm": "3b4cc0 6788ee 9abbff c9d7f0 dddddd edd1c2 f7a889 e26952 b40426",
}
"""sRGB colors at even steps: viridis and inferno as published by van der Walt & Smith (2015), blue and red of coolwarm
by Moreland (2009), Diverging Color Maps for Scientific Visualization; the curve between the colors is our own."""

if TYPE_CHECKING:
    ColorMap = str
else:
    ColorMap = Literal[tuple(CONTROLS)]
