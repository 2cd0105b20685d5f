"""From scene-referred light to display pixels: exposure, tone curve, sRGB, 8 bits."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import float32, uint8
    from numpy.typing import NDArray

SHOULDER = 0.6
"""Where the tone curve leaves the straight line."""


def develop(linear: NDArray[float32], exposure: float = 0.0, *, data: bool = False) -> NDArray[uint8]:
    """Display pixels (h, w, 3) of a linear picture (h, w, 3); ``exposure`` in stops.

    ``data`` pictures (normals, depth) in 0..1 are only brought to 8 bits. Else: see ``tone`` and ``encode``; an
    ordered dither, the same in every frame, keeps soft gradients free of bands.
    """
    import numpy as np

    if data:
        return np.rint(np.clip(np.nan_to_num(linear), 0.0, 1.0) * 255.0).astype(np.uint8)
    light = np.maximum(np.nan_to_num(linear, posinf=65504.0), 0.0).astype(np.float32) * np.float32(2.0**exposure)
    levels = encode(tone(light)) * np.float32(255.0)
    height, width = levels.shape[:2]
    return np.floor(levels + _thresholds(height, width)).clip(0, 255).astype(np.uint8)


def tone(light: NDArray[float32]) -> NDArray[float32]:
    """Light (h, w, 3), 0 to any height, brought to 0..1.

    The brightest channel m goes by a curve that is the identity up to SHOULDER = a and then a + (1 - a) tanh((m - a) /
    (1 - a)), smooth in its slope; the others keep their ratio to it, so that hues stay, and what lies far over white
    fades to white, as on film.
    """
    import numpy as np

    a = np.float32(SHOULDER)
    peak = light.max(axis=-1, keepdims=True)
    over = np.maximum(peak - a, 0) / (1 - a)
    curve = np.where(peak <= a, peak, a + (1 - a) * np.tanh(over))
    kept = light * (curve / np.maximum(peak, np.float32(1e-6)))
    whiten = 1 - np.exp(-np.float32(0.15) * np.maximum(peak - 1, 0))
    return (kept + whiten * (curve - kept)).astype(np.float32)


def encode(linear: NDArray[float32]) -> NDArray[float32]:
    """The sRGB transfer curve (IEC 61966-2-1) of values 0..1."""
    import numpy as np

    low = linear * np.float32(12.92)
    high = np.float32(1.055) * np.maximum(linear, np.float32(0.0031308)) ** np.float32(1 / 2.4) - np.float32(0.055)
    return np.where(linear <= np.float32(0.0031308), low, high)


def _thresholds(height: int, width: int) -> NDArray[float32]:
    """(h, w, 1) Bayer's 8 x 8 ordered-dither thresholds in (0, 1) (Bayer 1973)."""
    import numpy as np

    square = np.zeros((1, 1))
    while len(square) < 8:
        square = np.block([[4 * square, 4 * square + 2], [4 * square + 3, 4 * square + 1]])
    repeated = np.tile((square + 0.5) / 64, (-(-height // 8), -(-width // 8)))
    return repeated[:height, :width, None].astype(np.float32)
