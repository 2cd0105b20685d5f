"""Drafts: pictures of fewer pixels, enlarged once they are developed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View

COARSER = 3
"""Pixels of the picture along a pixel of its draft. A tracer's time goes with the number of pixels and the length of
edges, so that 3 leaves a sixth of it."""


def coarser(view: View) -> View:
    """The same view in pixels COARSER times as large, which reach over its edges where they do not fill it."""
    width, height = (-(-pixels // COARSER) for pixels in view.size)
    return replace(view, size=(width, height), half_height=view.half_height * COARSER * height / view.size[1])


def enlarged(pixels: NDArray[uint8], size: tuple[int, int]) -> NDArray[uint8]:
    """Pixels (h, w, 3) of a `coarser` view as a picture of the view's own size (bicubic)."""
    import numpy as np
    from PIL import Image

    over = [(have - wanted / COARSER) / 2 for have, wanted in zip(pixels.shape[1::-1], size, strict=True)]
    box = (over[0], over[1], over[0] + size[0] / COARSER, over[1] + size[1] / COARSER)
    return np.array(Image.fromarray(pixels).resize(size, Image.Resampling.BICUBIC, box))
