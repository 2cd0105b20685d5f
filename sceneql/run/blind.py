"""Warnings of cameras that stand inside a solid, where they see its inside and nothing of the scene."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Implicit, Mesh, Points, Quadric, Segments
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.shapes.placement import apply
from sceneql.shapes.world_boxes import box_of

if TYPE_CHECKING:
    from sceneql.frame import Floats, SeenFrame, Shape
    from sceneql.graph import Task

WOUND = 0.99
"""Fraction of the full solid angle from which on a mesh encloses a point: open sheets enclose none."""

Within = dict[tuple[str, str], tuple[float, float]]
"""By camera and part, the first and the last instant [s] of a picture at which the camera stood inside the part."""


def look(frame: SeenFrame, camera: str, within: Within) -> None:
    """Record in ``within`` the solids of a frame in which its camera stands; transparent ones may be looked through."""
    if frame.view.orthographic:
        return
    eye = np.array(frame.view.origin)
    for shape in frame.shapes:
        if shape.surface.transmission == 0.0 and around(shape, eye):
            first, last = within.get((camera, shape.name), (frame.time, frame.time))
            within[camera, shape.name] = min(first, frame.time), max(last, frame.time)


@np.errstate(over="ignore", invalid="ignore")
def around(shape: Shape, eye: Floats) -> bool:
    """Whether a bounded solid encloses a point (3,) [m]."""
    match shape:
        case Points(centers=centers, radii=radii, soft=None):
            return bool((((centers - eye) ** 2).sum(axis=1) < radii**2).any())
        case Segments(ends=ends, radii=radii):
            along = ends[:, 1] - ends[:, 0]
            lengths = np.maximum((along**2).sum(axis=1), 1e-300)
            part = np.clip(((eye - ends[:, 0]) * along).sum(axis=1) / lengths, 0.0, 1.0)
            return bool((((ends[:, 0] + part[:, None] * along - eye) ** 2).sum(axis=1) < radii**2).any())
        case Quadric() if _boxed(shape, eye):
            at = apply(shape.to_local, eye)
            value = (np.array(shape.squares) * at * at + np.array(shape.linear) * at).sum() + shape.constant
            return bool(value < 0.0 and (at > shape.low).all() and (at < shape.high).all())
        case Implicit(within=None) if _boxed(shape, eye):
            from sceneql.field.tape.tape_solid import field_values

            return bool(field_values(shape.tape, eye[None])[0] < 0.0)
        case Mesh() if _boxed(shape, eye):
            return _turns(shape.vertices[shape.triangles] - eye) > WOUND
    return False


def _boxed(shape: Shape, eye: Floats) -> bool:
    """Whether the finite bounding box of a shape contains a point."""
    low, high = box_of(shape)
    return bool(np.isfinite([low, high]).all() and (low < eye).all() and (eye < high).all())


def _turns(corners: Floats) -> float:
    """|Winding number| of triangles (m, 3, 3) about the origin, by solid angles (Van Oosterom & Strackee 1983)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
    up = (a * np.cross(b, c)).sum(axis=1)
    down = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return abs(float(np.arctan2(up, down).sum())) / (2.0 * np.pi)


def warnings(within: Within, tasks: Mapping[str, Task], told: Collection[Diagnostic] = ()) -> Iterator[Diagnostic]:
    """A warning for each camera and each part that it stood in, unless it is ``told`` of already."""
    known = [one.span for one in told if one.code == "camera-inside"]
    for (camera, part), (first, last) in within.items():
        if tasks[camera].span in known:
            continue
        when = f"at {first:.3g} s" if first == last else f"from {first:.3g} s to {last:.3g} s"
        text = f"the camera '{camera}' stands inside '{part}' {when}: it sees nothing else"
        help = f"lead it around '{part}', or move the part out of its way"
        yield Diagnostic("camera-inside", text, tasks[camera].span, help, severity="warning")
