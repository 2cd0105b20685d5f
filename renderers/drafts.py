"""Drafts: pictures with fewer pixels, enlarged after development."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View

COARSER = 3
"""Width of a draft's pixel in pixels of the picture. A tracer's time grows with the number of pixels and the length of
edges, so that 3 leaves about a sixth of it."""


def coarser(view: View) -> View:
    """View with pixels COARSER times as large, extended beyond its edges to a whole number of pixels."""
    width, height = (-(-pixels // COARSER) for pixels in view.size)
    return replace(view, size=(width, height), half_height=view.half_height * COARSER * height / view.size[1])


def enlarged(pixels: NDArray[uint8], size: tuple[int, int]) -> NDArray[uint8]:
    """Picture of the original view's ``size``, enlarged bilinearly from pixels (h, w, 3) of its `coarser` view."""
    import numpy as np
    from PIL import Image

    over = [(have - wanted / COARSER) / 2 for have, wanted in zip(pixels.shape[1::-1], size, strict=True)]
    box = (over[0], over[1], over[0] + size[0] / COARSER, over[1] + size[1] / COARSER)
    return np.array(Image.fromarray(pixels).resize(size, Image.Resampling.BILINEAR, box))
