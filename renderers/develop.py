"""From scene-referred light to display pixels: exposure, tone curve, sRGB, 8 bits."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import float32, uint8
    from numpy.typing import NDArray

BAND = 16
"""Rows of pixels that a thread takes at a time."""


def develop(linear: NDArray[float32], exposure: float = 0.0, *, data: bool = False) -> NDArray[uint8]:
    """Display pixels (h, w, 3) of a linear picture (h, w, 3); ``exposure`` in stops.

    ``data`` pictures (normals, depth) in 0..1 are only brought to 8 bits. Else the brightest channel m goes by a curve
    that is the identity up to a = 0.6 and then a + (1 - a) tanh((m - a)/(1 - a)), smooth in its slope; the others keep
    their ratio to it, so that hues stay, and what lies far over white fades to white, as on film. So the colors of a
    script come back as written, up to the sRGB tone 203. Then the sRGB transfer curve, and an ordered dither, the
    same in every frame, that keeps soft gradients free of bands. What is no number is black.
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
