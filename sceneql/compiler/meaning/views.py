"""Warnings of cameras that show nothing of what they should: beside it, from too far, too near, from below."""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, atan, degrees, hypot, pi, tan
from typing import Any, NamedTuple

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.meaning.places import Ball, ball, distance, text
from sceneql.compiler.passes.unseen import ground_level
from sceneql.graph import Task
from sceneql.quantities.diagnostic import Diagnostics

LEAST = 1.0 / 300.0
"""Part of a picture's height that the largest object has below which nothing is seen."""
CLOSE = 0.4
"""Part of an object that a picture shows, below which it shows nothing but its surface."""
STANDS = 2.0
"""[deg] Turn of a turntable over the film, below which it stands."""


class View(NamedTuple):
    """A view that stands still."""

    eye: tuple[float, ...]
    along: tuple[float, ...]
    """Unit vector."""
    half: float
    """Half of its height as an angle [rad]."""
    corner: float
    """The same of its diagonal."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each picture of which that is sure."""
    behind = [one.span for one in found.found if one.code == "not-seen"]
    told: set[str] = set()
    for picture, name in facts.cameras.items():
        if not name or facts.tasks[name].span is None or name in told:
            continue
        told.add(name)
        camera = facts.tasks[name]
        _turning(facts, camera, found)
        _below(facts, camera, found)
        view = _view(camera.kind, getattr(facts.tasks[picture].kind, "size", (960, 540)))
        parts = [one for one in facts.drawn.get(picture, ()) if not getattr(facts.tasks[one].kind, "grounds", False)]
        balls = {one: ball(facts, one) for one in parts}
        known = {one: held for one, held in balls.items() if held is not None}
        if len(known) == len(balls):
            _plan(camera, known, found)
        if view is None or not parts:
            continue
        _near(camera, view, known, found)
        if len(known) == len(balls) and camera.span not in behind:
            _beside(camera, view, known, found)


def _view(camera: Any, size: Any) -> View | None:
    """The view of a camera with a place, an aim and an angle; None of others."""
    eye, aim, angle = (constant(getattr(camera, field, None)) for field in ("position", "look_at", "field_of_view"))
    if None in (eye, aim, angle) or getattr(camera, "follow", None) is not None or getattr(camera, "fit", None):
        return None
    away = distance(eye, aim)
    width, height = size if isinstance(size, tuple) else (960, 540)
    along = tuple((a - e) / away for e, a in zip(eye, aim, strict=True)) if away > 0.0 else None
    if along is None:
        return None
    corner = atan(tan(0.5 * angle) * hypot(1.0, width / height))
    return View(eye, along, 0.5 * float(angle), corner)


def _angles(view: View, held: Ball) -> tuple[float, float, float]:
    """Distance [m] of an object's middle, its angle off the axis, and half of that under which it is seen [rad]."""
    away = distance(view.eye, held.center)
    if away <= held.reach:
        return away, 0.0, pi
    ahead = sum((c - e) * a for e, c, a in zip(view.eye, held.center, view.along, strict=True)) / away
    return away, pi / 2 - asin(max(-1.0, min(1.0, ahead))), asin(held.reach / away)


def _beside(camera: Task, view: View, known: Mapping[str, Ball], found: Diagnostics) -> None:
    """All that is drawn stands beside the picture, or is too small."""
    angles = {name: _angles(view, held) for name, held in known.items()}
    if all(off > view.corner + wide for _, off, wide in angles.values()):
        first = next(iter(known.values()))
        told = f"'{camera.name}' sees nothing of what is drawn: all stands beside its picture"
        help = f"turn it: `look_at: {text(first.center)}`"
        found.warning("not-seen", told, camera.span, help=help)
        return
    name, (away, _, wide) = max(angles.items(), key=lambda one: one[1][2])
    size = tan(min(wide, 1.5)) / tan(view.half)
    if size < LEAST:
        told = f"'{camera.name}' is {away:.3g} m away from '{name}', the largest that it sees: "
        told += f"{540 * size:.2g} of 540 pixels"
        near = known[name]
        place = [c - a * 3.0 * near.reach / tan(view.half) for c, a in zip(near.center, view.along, strict=True)]
        found.warning("not-seen", told, camera.span, help=f"bring it nearer, as `position: {text(place)}`")


def _near(camera: Task, view: View, known: Mapping[str, Ball], found: Diagnostics) -> None:
    """One object fills the whole picture with its surface."""
    for name, held in known.items():
        away, off, _ = _angles(view, held)
        if held.inner <= 0.0 or away <= held.reach:
            continue
        seen = asin(min(held.inner / away, 1.0))
        if off + view.corner < CLOSE * seen:
            told = (
                f"'{camera.name}' sees nothing but a part of '{name}': it shows {degrees(2 * view.half):.2g} degrees,"
            )
            told += f" and '{name}' is as wide as {degrees(2 * seen):.2g}"
            wide = min(3.0 * degrees(seen), 60.0)
            help = f"write `field_of_view: {wide:.2g} deg`" if seen < 0.5 else "move it away"
            found.warning("too-near", told, camera.span, help=help)
            return


def _turning(facts: Facts, camera: Task, found: Diagnostics) -> None:
    """A turntable that stands, or whose distance is inside of what it goes around; one that does not follow."""
    kind: Any = camera.kind
    seconds, lag, end = getattr(kind, "seconds", None), getattr(kind, "lag", 0.0), facts.clock.end
    if isinstance(seconds, float) and 360.0 * end / seconds < STANDS and "seconds" in kind.model_fields_set:
        told = f"'{camera.name}' turns by {360.0 * end / seconds:.2g} degrees until {end:g} s: it seems to stand"
        found.warning("nothing-moves", told, camera.span, help=f"a turn in the film is `seconds: {end:g} s`")
    if isinstance(lag, float) and lag > end and getattr(kind, "follow", None) is not None:
        told = f"'{camera.name}' stays behind by {lag:g} s, longer than the clock, {end:g} s: it hardly follows"
        found.warning("nothing-moves", told, camera.span, help="write a shorter time, as `lag: 0.3 s`")
    away = constant(getattr(kind, "distance", None))
    around = getattr(getattr(kind, "around", None), "name", "")
    held = ball(facts, around) if away is not None and around in facts.objects else None
    if held is not None and away < held.inner:
        told = f"'{camera.name}' goes round inside of '{around}', {away:g} m from its middle"
        found.warning("camera-inside", told, camera.span, help=f"write `distance: {6.0 * held.reach:.3g} m`")


def _plan(camera: Task, known: Mapping[str, Ball], found: Diagnostics) -> None:
    """A plan that shows nothing but the surface of an object in its middle, or in which all is too small."""
    kind: Any = camera.kind
    height, aim = constant(getattr(kind, "height", None)), constant(getattr(kind, "look_at", None))
    if height is None or not hasattr(kind, "look_along") or not known:
        return
    name, held = max(known.items(), key=lambda one: one[1].reach)
    over = len(known) == 1 if aim is None else distance(aim, held.center) < CLOSE * held.inner
    if (over and height < CLOSE * held.inner) or 2.0 * held.reach < LEAST * height:
        told = f"'{camera.name}' shows {height:.3g} m, and '{name}' is {2.0 * held.reach:.3g} m large"
        help = f"leave `height` out, or write `height: {4.0 * held.reach:.3g} m`"
        found.warning("too-near" if over else "not-seen", told, camera.span, help=help)


def _below(facts: Facts, camera: Task, found: Diagnostics) -> None:
    """A camera that sees a level ground from below."""
    kind: Any = camera.kind
    level = ground_level(facts.tasks)
    way = getattr(kind, "look_along", None)
    tilt, along = constant(getattr(kind, "tilt", None)), constant(way)
    if level is None:
        return
    if tilt is not None and tilt < 0.0 and constant(getattr(kind, "look_at", None)) is None:
        told = f"'{camera.name}' stands under the ground, which hides all above it: its `tilt` is below 0"
        help = f"write `tilt: {-degrees(tilt):.3g} deg`"
        found.warning("buried-camera", told, camera.span, help=help)
    if way == "y" or (isinstance(along, tuple) and along[1] > 0.9 * hypot(*along)):
        told = f"'{camera.name}' looks up from under the ground, which hides all above it"
        found.warning("buried-camera", told, camera.span, help="write `look_along: -y`, to look down")
