"""Frame as a scene of pyrender, and the resulting picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.rastering.offscreen import canvas, library
from renderers.rastering.surfaces import primitive
from renderers.rastering.triangles import boundless, triangles
from renderers.tracing.picture import Picture
from sceneql.frame import PointLight, Sky, Sun
from sceneql.shapes.held_arrays import OfHeld

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy import bool_
    from numpy.typing import NDArray

    from renderers.rastering.triangles import Triangles
    from sceneql.frame import RGB, Floats, LightSource, SeenFrame, View

GAMMA = 2.2
"""Exponent that decodes pyrender's pictures: its shader stores radiance^(1/2.2), so that 8 bits resolve dark colors."""
NEAR, REACH = 1e-3, 50.0
"""Distance of the near plane, and extent of planes, relative to the distance of the far end of all bounded shapes."""
_meshes: OfHeld[Any] = OfHeld()


def draw(frame: SeenFrame, cells: int, sharp: bool, samples: int, shadows: bool, brightest: float) -> Picture:
    """Picture of a frame: linear (h, w, 3). Raises ValueError for unsupported shapes, or without OpenGL.

    ``samples``: number in a pixel, a square; ``brightest`` [W/(sr m^2)]: radiance at which pictures are clipped.
    """
    gl = library()
    made = [part for shape in frame.shapes if not boundless(shape) for part in triangles(shape, cells, sharp)]
    low, high = _bounds(made)
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    far = float(np.linalg.norm(np.array(frame.view.origin) - middle)) + size / 2
    made += [part for shape in frame.shapes if boundless(shape) for part in triangles(shape, cells, sharp, REACH * far)]
    scene = gl.Scene(bg_color=(0.0, 0.0, 0.0, 0.0), ambient_light=_ambient(frame.lights) / brightest)
    for part in made:
        scene.add(_mesh(gl, part, brightest))
    for light in frame.lights:
        _add_light(gl, scene, light, brightest)
    _add_camera(gl, scene, frame.view, far)
    # The shadow map covers the bounded shapes alone: one of a whole plane would be too coarse for them.
    scene._bounds = np.array([low, high])
    fine = math.isqrt(samples)
    width, height = (fine * side for side in frame.view.size)
    coded, depth = canvas(width, height).render(scene)
    suns = [light for light in frame.lights if isinstance(light, Sun)]
    if shadows and suns and size > 0:
        shaded, _ = canvas(width, height).render(scene, flags=gl.RenderFlags.SHADOWS_DIRECTIONAL)
        known = _mapped(_places(frame.view, depth, far), suns, middle, size)
        coded = np.where(known[..., None], shaded, coded)
    linear = brightest * (coded[..., :3].astype(np.float32) / 255) ** GAMMA
    linear = np.where(depth[..., None] > 0, linear, _backdrop(frame.view, frame.lights, width, height))
    folded = linear.reshape(height // fine, fine, width // fine, fine, 3).mean(axis=(1, 3))
    return Picture(np.ascontiguousarray(folded, dtype=np.float32))


def _mesh(gl: Any, part: Triangles, brightest: float) -> Any:
    """Mesh of pyrender for triangles; if they are unchanged since the last frame, the one that OpenGL already holds."""
    arrays = part.vertices, part.triangles, part.normals, part.colors
    key = part.surface, part.flat, brightest
    return _meshes.get(arrays, key, lambda: gl.Mesh([primitive(gl, part, brightest)]))


def _bounds(made: Iterable[Triangles]) -> tuple[Floats, Floats]:
    ends = [end for part in made for end in (part.vertices.min(axis=0), part.vertices.max(axis=0))]
    if not ends:
        return np.full(3, -0.5), np.full(3, 0.5)
    return np.min(ends, axis=0), np.max(ends, axis=0)


def _pose(axes: Floats, origin: Any) -> Floats:
    """Pose (4, 4) of an object that faces -z: columns right, up, back and origin."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes, origin
    return pose


def _add_camera(gl: Any, scene: Any, view: View, far: float) -> None:
    origin, aspect = np.array(view.origin), view.size[0] / view.size[1]
    if view.orthographic:  # its window lies in the plane of the origin; objects before that plane are seen as well
        camera = gl.OrthographicCamera(
            aspect * view.half_height, view.half_height, znear=NEAR * far, zfar=2 * REACH * far
        )
        origin = origin + REACH * far * view.axes[2]
    else:
        angle = 2 * math.atan(view.half_height)
        camera = gl.PerspectiveCamera(angle, znear=NEAR * far, zfar=2 * REACH * far, aspectRatio=aspect)
    scene.add(camera, pose=_pose(view.axes.T, origin))


def _add_light(gl: Any, scene: Any, light: LightSource, brightest: float) -> None:
    if isinstance(light, Sun):
        pose = _pose(_turned(light), np.zeros(3))
        scene.add(gl.DirectionalLight(*_parted(light.irradiance, brightest)), pose=pose)
    elif isinstance(light, PointLight):
        scene.add(gl.PointLight(*_parted(light.intensity, brightest)), pose=_pose(np.eye(3), light.position))


def _turned(sun: Sun) -> Floats:
    """Axes (3, 3), columns right, up, back, of a light that shines along its -z."""
    back = np.array(sun.direction)
    right = np.cross(np.eye(3)[int(np.argmin(np.abs(back)))], back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def _mapped(places: Floats, suns: Iterable[Sun], middle: Floats, size: float) -> NDArray[bool_]:
    """Mask (h, w) of places (h, w, 3) [m] in the shadow maps of all suns: squares of half side ``size`` [m]."""
    known = np.ones(places.shape[:2], dtype=bool)
    for sun in suns:
        known &= (np.abs((places - middle) @ _turned(sun)[:, :2]) < 0.99 * size).all(axis=-1)
    return known


def _parted(light: RGB, brightest: float) -> tuple[Floats, float]:
    """Color (3,) scaled to a largest component of 1, and the scale relative to ``brightest``."""
    most = max(*light, 1e-300)
    return np.array(light) / most, most / brightest


def _ambient(lights: Iterable[LightSource]) -> Floats:
    """Mean radiance (3,) of all skies; each is linear in a direction's height, above and below the horizon."""
    means = [np.mean([s.horizon, s.horizon, s.zenith, s.ground], axis=0) for s in lights if isinstance(s, Sky)]
    total: Floats = np.sum([np.zeros(3), *means], axis=0)
    return total


def _window(view: View, width: int, height: int) -> tuple[Floats, Floats]:
    """Coordinates (1, width) to the right and (height, 1) up of the pixels' centers in the view's window."""
    u = ((2 * np.arange(width) + 1 - width) / height * view.half_height)[None, :]
    v = ((height - 1 - 2 * np.arange(height)) / height * view.half_height)[:, None]
    return u, v


def _places(view: View, depth: Floats, far: float) -> Floats:
    """Visible points (h, w, 3) [m], from pyrender's depth (h, w), which is always that of a perspective camera."""
    u, v = _window(view, *depth.shape[::-1])
    right, up, back = view.axes
    origin: Floats = np.array(view.origin)
    if view.orthographic:
        first, last = NEAR * far, 2 * REACH * far
        share = (1 - first / np.maximum(depth, first)) / (1 - first / last)
        away = first + share * (last - first) - REACH * far
        origin = origin + u[..., None] * right + v[..., None] * up
        ways = -np.broadcast_to(back, (*depth.shape, 3))
    else:
        away, ways = depth, u[..., None] * right + v[..., None] * up - back
    places: Floats = origin + away[..., None] * ways
    return places


def _backdrop(view: View, lights: Iterable[LightSource], width: int, height: int) -> Floats:
    """Radiance (height, width, 3) of the backdrop, for pixels without a shape."""
    skies = [light for light in lights if isinstance(light, Sky)]
    seen = [sky.below or sky.visible for sky in skies if sky.visible is not None]
    if seen or not skies:
        return np.broadcast_to(np.array(seen[-1] if seen else (0.0, 0.0, 0.0)), (height, width, 3))
    right, up, back = view.axes
    if view.orthographic:
        level = np.full((height, width), -back[1])
    else:
        u, v = _window(view, width, height)
        level = (u * right[1] + v * up[1] - back[1]) / np.sqrt(1 + u**2 + v**2)
    horizon, zenith, ground = (
        np.sum([getattr(s, end) for s in skies], axis=0) for end in ("horizon", "zenith", "ground")
    )
    share = np.abs(level)[..., None]
    found: Floats = horizon + share * (np.where(level[..., None] >= 0, zenith, ground) - horizon)
    return found
