"""Warnings of cameras whose subject is hidden behind something else for most of the film."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.frame import Implicit, Mesh, Points, Quadric, Segments
from sceneql.kinds import Camera, Model
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.shapes.outlines import outline
from sceneql.shapes.placement import apply

if TYPE_CHECKING:
    from sceneql.frame import Floats, SeenFrame, Shape
    from sceneql.graph import Task

COUNT = 24
"""Number of points of the subject that are looked at."""
HIDDEN = 0.8
"""Fraction of these, of those in the picture, from which on the subject counts as hidden."""
MOSTLY = 0.5
"""Fraction of the frames, of those with the subject in the picture, beyond which a warning is told."""
MOST = 2_000
"""Largest number of triangles, spheres or segments of a shape that is looked at: more cost time in every frame."""
STEPS = 64
"""Places along a line of sight at which an implicit field is looked at."""
NEARLY = 1.0 - 1e-6
"""Part of the way to a point of the subject that is looked along: what touches it there does not hide it."""


@dataclass
class Sights:
    """What a camera saw of a part that it is aimed at."""

    frames: int = 0
    """Those with the part in the picture."""
    hidden: list[float] = field(default_factory=list)
    """Instants [s] of those in which it is hidden."""
    behind: Counter[str] = field(default_factory=Counter)
    """How many points were hidden by each part."""


Covered = dict[tuple[str, str], Sights]
"""By camera and part that it is aimed at."""


def look(frame: SeenFrame, camera: str, tasks: Mapping[str, Task], covered: Covered) -> None:
    """Record in ``covered`` whether the parts that a camera is aimed at are hidden; transparent shapes hide nothing."""
    for aim in cast(Camera, tasks[camera].kind).aims():
        kind = tasks[aim].kind if aim in tasks else None
        names = {aim, *(kind.drives() if isinstance(kind, Model) else ())}
        seen = _of_subject(frame, names)
        if not len(seen):
            continue
        sights = covered.setdefault((camera, aim), Sights())
        sights.frames += 1
        eyes = _eyes(frame, seen)
        hidden = np.zeros(len(seen), dtype=bool)
        for shape in frame.shapes:
            if shape.name not in names and shape.surface.transmission == 0.0:
                between = _between(shape, eyes, seen)
                sights.behind[shape.name] += int(between.sum())
                hidden |= between
        if hidden.mean() >= HIDDEN:
            sights.hidden.append(frame.time)


def warnings(covered: Covered, tasks: Mapping[str, Task]) -> Iterator[Diagnostic]:
    """A warning for each camera and part that it hardly sees."""
    for (camera, part), sights in covered.items():
        if len(sights.hidden) > MOSTLY * sights.frames:
            first, last = min(sights.hidden), max(sights.hidden)
            when = f"at {first:.3g} s" if first == last else f"most of the time from {first:.3g} s to {last:.3g} s"
            (other, _), *_ = sights.behind.most_common(1)
            text = f"'{part}', at which the camera '{camera}' looks, is hidden behind '{other}' {when}"
            help = f"lead the camera where it sees '{part}', or move '{other}' out of its way"
            yield Diagnostic("hidden-subject", text, tasks[camera].span, help, severity="warning")


def _of_subject(frame: SeenFrame, names: set[str]) -> Floats:
    """At most COUNT points (n, 3) [m] around the shapes of these names, of those in the picture."""
    view = frame.view
    found = [outline(shape) for shape in frame.shapes if shape.name in names and _size(shape) <= MOST]
    points = np.concatenate([np.zeros((0, 3)), *found])
    x, y, z = ((points - view.origin) @ view.axes.T).T
    far = np.ones_like(z) if view.orthographic else -z
    high = view.half_height * far
    seen = points[(z < 0.0) & (np.abs(y) <= high) & (np.abs(x) <= high * view.size[0] / view.size[1])]
    some: Floats = seen[np.linspace(0, len(seen) - 1, min(COUNT, len(seen))).astype(int)]
    return some


def _eyes(frame: SeenFrame, points: Floats) -> Floats:
    """From where points (n, 3) [m] are seen, (n, 3): the camera, or their places in an orthographic window."""
    view = frame.view
    if not view.orthographic:
        return np.broadcast_to(np.array(view.origin), points.shape)
    back = view.axes[2]
    found: Floats = points + ((np.array(view.origin) - points) @ back)[:, None] * back
    return found


def _size(shape: Shape) -> int:
    """Number of its triangles, spheres or segments."""
    match shape:
        case Mesh():
            return len(shape.triangles)
        case Points() | Segments():
            return len(shape.radii)
    return 1


@np.errstate(all="ignore")
def _between(shape: Shape, eyes: Floats, ends: Floats) -> Floats:
    """(n,) Whether a shape meets each of the lines of sight from ``eyes`` to ``ends``, (n, 3) [m], before its end."""
    none: Floats = np.zeros(len(ends), dtype=bool)
    if _size(shape) > MOST:
        return none
    match shape:
        case Points(centers=centers, radii=radii, soft=None):
            return _within(eyes, ends, centers, radii)
        case Segments(ends=two, radii=radii):
            parts = np.linspace(0.0, 1.0, 9)[:, None, None]
            along = (two[:, 0] + parts * (two[:, 1] - two[:, 0])).reshape(-1, 3)
            return _within(eyes, ends, along, np.tile(radii, len(parts)))
        case Quadric():
            return _through_quadric(shape, eyes, ends)
        case Implicit(within=None):
            from sceneql.field.tape.tape_solid import field_values

            parts = np.linspace(0.0, NEARLY, STEPS)[:, None, None]
            along = (eyes + parts * (ends - eyes)).reshape(-1, 3)
            boxed: Any = ((along > shape.low) & (along < shape.high)).all(axis=1)
            boxed[boxed] = field_values(shape.tape, along[boxed]) < 0.0
            found: Floats = boxed.reshape(STEPS, -1).any(axis=0)
            return found
        case Mesh(vertices=vertices, triangles=triangles):
            return _through_triangles(vertices[triangles], eyes, ends)
    return none


def _within(eyes: Floats, ends: Floats, centers: Floats, radii: Floats) -> Floats:
    """(n,) Whether lines of sight pass within radii (m,) of centers (m, 3) [m]."""
    found = np.zeros(len(ends), dtype=bool)
    for k, (eye, way) in enumerate(zip(eyes, ends - eyes, strict=True)):
        part = np.clip((centers - eye) @ way / (way @ way), 0.0, NEARLY)
        found[k] = (((eye + part[:, None] * way - centers) ** 2).sum(axis=1) < radii**2).any()
    return found


def _through_quadric(shape: Quadric, eyes: Floats, ends: Floats) -> Floats:
    """(n,) Whether lines of sight meet a quadric: the parts of the way in its box and in its convex surface overlap."""
    eye, end = apply(shape.to_local, eyes), apply(shape.to_local, ends)
    way, squares, linear = end - eye, np.array(shape.squares), np.array(shape.linear)
    enter, leave = _through_box(eye, way, np.array(shape.low), np.array(shape.high))
    a, b = (squares * way * way).sum(axis=1), ((2.0 * squares * eye + linear) * way).sum(axis=1)
    c = (squares * eye * eye + linear * eye).sum(axis=1) + shape.constant
    root, at = np.sqrt(b * b - 4.0 * a * c), -c / b  # NaN where it passes by: no comparison holds then
    first = np.where(a > 0.0, (-b - root) / (2.0 * a), np.where(b < 0.0, at, -np.inf))
    last = np.where(a > 0.0, (-b + root) / (2.0 * a), np.where(b > 0.0, at, np.inf))
    met: Floats = np.maximum(np.maximum(enter, first), 0.0) < np.minimum(np.minimum(leave, last), NEARLY)
    flat_out = (a == 0.0) & (b == 0.0) & (c > 0.0)
    met[flat_out] = False
    return met


def _through_box(eyes: Floats, ways: Floats, low: Floats, high: Floats) -> tuple[Any, Any]:
    """(n,) Parts of lines of sight at which they enter a box and leave it; the first is larger where they miss it."""
    sides = np.stack([(side - eyes) / ways for side in (low, high)])
    flat = ways == 0.0
    out = flat & ((eyes < low) | (eyes > high))
    enter = np.where(flat, -np.inf, sides.min(axis=0)).max(axis=1)
    return enter, np.where(out, -np.inf, np.where(flat, np.inf, sides.max(axis=0))).min(axis=1)


def _through_triangles(corners: Floats, eyes: Floats, ends: Floats) -> Floats:
    """(n,) Whether lines of sight pass through any of the triangles (m, 3, 3) [m] (Moeller & Trumbore 1997)."""
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    ways, found = ends - eyes, np.zeros(len(ends), dtype=bool)
    enter, leave = _through_box(eyes, ways, corners.min(axis=(0, 1)), corners.max(axis=(0, 1)))
    for k in np.flatnonzero(np.maximum(enter, 0.0) <= np.minimum(leave, NEARLY)):
        eye, way = eyes[k], ways[k]
        across = np.cross(way, two)
        scale, away = 1.0 / (one * across).sum(axis=1), eye - corners[:, 0]
        u, other = (away * across).sum(axis=1) * scale, np.cross(away, one)
        v, t = (way * other).sum(axis=1) * scale, (two * other).sum(axis=1) * scale
        found[k] = ((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0) & (t < NEARLY)).any()
    return found
