"""Linear light encoded as the bytes of pictures and meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import Floats


def levels(linear: Floats, *, curved: bool = True) -> NDArray[uint8]:
    """Levels 0..255 of linear light, by the sRGB curve (IEC 61966-2-1) if ``curved``, else linear; NaN becomes 0."""
    light = np.clip(np.nan_to_num(linear), 0.0, 1.0)
    if curved:
        light = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    found: NDArray[uint8] = np.rint(255 * light).astype(np.uint8)
    return found
