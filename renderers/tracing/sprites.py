"""Soft discs facing the camera, drawn over a finished picture with depth tests."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from renderers.tracing.picture import over_rows
from renderers.tracing.scratch import begun, scratch
from renderers.tracing.solids.packet_choice import lender
from sceneql.compiled.kernels import over_tiles
from sceneql.frame import Points

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

    from renderers.tracing.light.discs import Shadows
    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats, SeenFrame

AT_ONCE = 1024
"""Places whose shadows one piece of work finds."""
SMALLEST = 1.25
"""Radius [pixels] below which a disc is drawn larger and correspondingly fainter, so that none is missed."""


def over(
    frame: SeenFrame,
    records: NDArray[float32],
    linear: NDArray[float32],
    scene: Scene | None = None,
    rows: int = 1,
) -> None:
    """Draw the frame's soft discs over ``linear`` (pixels, 3), shapes in their order.

    ``records``: records of the pixels' centers. ``scene``: whose solids throw shadows on discs that cover, with
    ``rows`` of scratch. Covering discs of one shape are drawn from the farthest to the nearest.
    """
    for shape in frame.shapes:
        if isinstance(shape, Points) and shape.soft is not None and len(shape.centers):
            _draw(shape, frame, records, linear, scene and shadows_of(scene, rows))


def shadows_of(scene: Scene, rows: int) -> Shadows | None:
    """Shares that solids of a scene leave of light (light.discs.lit); None without solids."""
    from renderers.tracing.light.disc_shadows_kernels import leave

    if not scene.ints[layout.NODE_COUNT]:
        return None
    with_scratch = lender(lambda: scratch(rows))

    def shadows(places: Floats, ways: Floats) -> Floats:
        shares = np.ones(len(places))
        given = np.ascontiguousarray(places, dtype=np.float64), np.ascontiguousarray(ways), shares

        def piece(k: int) -> None:
            stop = min((k + 1) * AT_ONCE, len(places))
            with_scratch(lambda own: leave(scene, begun(own), *given, k * AT_ONCE, stop))

        over_tiles(-(-len(places) // AT_ONCE), piece)
        return shares

    return shadows


def _draw(
    shape: Points,
    frame: SeenFrame,
    records: NDArray[float32],
    linear: NDArray[float32],
    shadows: Shadows | None,
) -> None:
    from renderers.tracing.sprites_kernels import cover_rows

    view = frame.view
    width, height = view.size
    discs = _discs(shape, frame, shadows)
    if shape.soft == "covers":
        discs = discs[np.argsort(-discs[:, 2], kind="stable")]
    camera = np.array([*view.origin, *view.axes[2]], dtype=np.float64)
    covers = shape.soft == "covers"
    over_rows(height, lambda start, stop: cover_rows(start, stop, width, camera, discs, covers, records, linear))


def _radiances(shape: Points, frame: SeenFrame, shadows: Shadows | None) -> Floats:
    """Radiance (n, 3, 3) of discs in their middle, and its change by a radius to the right and up.

    Covering discs that do not glow have the light that they get.
    """
    surface = shape.surface
    glows = any(surface.emission)
    own = np.array(surface.emission if glows else surface.color) if shape.colors is None else shape.colors
    found = np.zeros((len(shape.centers), 3, 3))
    if glows or shape.soft == "adds":
        found[:, 0] = own
        return found
    from renderers.tracing.light.discs import lit

    sound = np.isfinite(shape.centers).all(axis=1) & np.isfinite(shape.radii)
    discs = replace(shape, centers=shape.centers[sound], radii=shape.radii[sound], colors=None)
    for k, given in enumerate(lit(discs, frame.lights, frame.view.axes, shadows)):
        found[sound, k] = given
    found *= own.reshape(-1, 1, 3)
    return found


def _discs(shape: Points, frame: SeenFrame, shadows: Shadows | None) -> Floats:
    """Discs (n, 15) in front of the camera.

    x, y [pixels], depth [m], radius [pixels], radius [m], opacity, radiance (3), its change to the right (3), up (3).
    """
    view = frame.view
    height = view.size[1]
    away = (shape.centers - np.array(view.origin)) @ view.axes.T
    depth = -away[:, 2]
    seen = np.isfinite(depth) & (shape.radii > 0)
    if not view.orthographic:
        seen &= depth > 0
    radiances = _radiances(shape, frame, shadows)[seen]
    away, depth, radii = away[seen], depth[seen], shape.radii[seen]
    scale = 0.5 * height / view.half_height / (1.0 if view.orthographic else depth)
    discs = np.empty((len(depth), 15))
    discs[:, 0] = 0.5 * view.size[0] + scale * away[:, 0]
    discs[:, 1] = 0.5 * height - scale * away[:, 1]
    discs[:, 2] = depth
    discs[:, 3] = np.maximum(scale * radii, SMALLEST)
    discs[:, 4] = radii
    discs[:, 5] = shape.opacity * np.minimum(scale * radii / SMALLEST, 1.0) ** 2
    discs[:, 6:] = radiances.reshape(-1, 9)
    return discs
