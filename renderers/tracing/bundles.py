"""Camera rays against implicit objects in bundles: what the stage of gathering then need not look for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.bundles_kernels import meet_tiles
from sceneql.field.packets import Memory, in_lanes
from sceneql.frame import Implicit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats, Shape, View

RAYS = 256
"""Of a bundle."""


def camera_roots(
    shapes: tuple[Shape, ...], view: View, scene: Scene, start: int, stop: int
) -> tuple[NDArray[np.int64], Floats]:
    """(indices (k,), answers (k, n)): where rays through the pixels of rows start..stop-1 first meet implicit solids.

    inf: nowhere; NaN: not told. The indices are of ``shapes``; what packets know nothing of is none of them.
    """
    solid = [
        i
        for i, shape in enumerate(shapes)
        if isinstance(shape, Implicit) and shape.within is None and in_lanes(shape.tape)
    ]
    answers = np.full((len(solid), (stop - start) * view.size[0]), np.inf)
    for row, index in zip(answers, solid, strict=True):
        shape = shapes[index]
        assert isinstance(shape, Implicit)
        box = np.array([shape.low, shape.high], dtype=np.float64)
        seen = window(view, box)
        if seen[2] < stop and seen[3] >= start and seen[0] <= seen[1]:
            memory = Memory(shape.tape, RAYS)
            meet_tiles(scene, *memory.bundle, memory.found, *memory.rest, box, seen, start, row)
    return np.array(solid, dtype=np.int64), answers


def window(view: View, box: Floats) -> NDArray[np.int64]:
    """(x0, x1, y0, y1): pixels that may see a box (2, 3), all where a corner is not before the camera."""
    width, height = view.size
    corners = np.array([[box[i, 0], box[j, 1], box[k, 2]] for i in range(2) for j in range(2) for k in range(2)])
    right, up, back = ((corners - np.asarray(view.origin)) @ np.asarray(view.axes).T).T
    if view.orthographic:
        x, y = right, up
    elif (back > -1e-9).any():
        return np.array([0, width - 1, 0, height - 1])
    else:
        x, y = right / -back, up / -back
    x = (x / view.half_height * height + width) / 2
    y = (1 - y / view.half_height) * height / 2
    found = [x.min() - 1, x.max() + 1, y.min() - 1, y.max() + 1]
    pixels: NDArray[np.int64] = np.clip(found, 0, [width - 1, width - 1, height - 1, height - 1]).astype(np.int64)
    return pixels
