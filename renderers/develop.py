"""Development of linear pictures into display pixels: exposure, tone curve, sRGB, 8 bits."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import float32, uint8
    from numpy.typing import NDArray

BAND = 64
"""Number of pixel rows that a thread develops at a time."""


def develop(linear: NDArray[float32], exposure: float = 0.0, *, data: bool = False) -> NDArray[uint8]:
    """Display pixels (h, w, 3) of a linear picture (h, w, 3); ``exposure`` in stops.

    ``data`` pictures (normals, depth) in 0..1 are only rounded to 8 bits. Others go through three steps. First, a tone
    curve maps the brightest channel m: the identity up to a = 0.6, then a + (1 - a) tanh((m - a)/(1 - a)), with a
    continuous slope. The other channels keep their ratio to it, which preserves hue; colors far brighter than white
    fade to white. Colors of a script thus come out as written, up to the sRGB value 203. Second, the sRGB transfer
    curve. Third, an ordered dither, the same in every frame, against bands in soft gradients. NaN becomes black.
    """
    import numpy as np

    if data:
        levels: NDArray[uint8] = np.rint(np.clip(np.nan_to_num(linear), 0.0, 1.0) * 255.0).astype(np.uint8)
        return levels
    from renderers.develop_kernels import develop_rows
    from sceneql.compiled.kernels import over_tiles

    light = np.ascontiguousarray(linear, dtype=np.float32)
    height = len(light)
    pixels = np.empty(light.shape, dtype=np.uint8)
    gain = 2.0**exposure
    over_tiles(
        -(-height // BAND), lambda band: develop_rows(light, gain, pixels, band * BAND, min(band * BAND + BAND, height))
    )
    return pixels
