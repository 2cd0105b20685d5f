"""Warnings of pictures that show nothing: all is hidden, or behind the camera; and of lamps under the ground."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from math import dist, pi, sqrt

from sceneql.graph import Task
from sceneql.kinds import Camera, Kind, Light, Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Link

DIM = 3.0
"""[W] power of all lamps together below which a scene of some meters is nearly dark."""

FAINT = 3e-3
"""Brightness of what is white and nearest to a lamp below which a picture is black."""
MASS = 1.0
"""[m] A bound of how far a mass of a model reaches from its place."""


def warn_of_unseen(
    tasks: Mapping[str, Task], drawn: Mapping[str, Collection[str]], cameras: Mapping[str, str], found: Diagnostics
) -> None:
    """Warn of each picture of nothing but a ground, and of each whose camera has all that stands still behind it.

    ``drawn``: by picture, the parts that it draws; ``cameras``: by picture, its camera.
    """
    for picture, names in drawn.items():
        parts = [tasks[name] for name in names if not getattr(tasks[name].kind, "grounds", False)]
        written = [task for task in tasks.values() if isinstance(task.kind, Object) and task.kind.hidden and task.span]
        if not parts and names and written and tasks[picture].kind.shown() is None:  # type: ignore[attr-defined]
            text = f"'{picture}' shows nothing but the ground: all objects are hidden"
            help = f"leave out `hidden: yes`, as of '{written[0].name}'"
            found.warning("nothing-drawn", text, tasks[picture].span or written[0].span, help=help)
        camera = tasks.get(cameras.get(picture, ""))
        mirrors = any(getattr(tasks[name].kind, "material", None) for name in names if tasks[name] not in parts)
        if camera is not None and parts and not mirrors and all(_behind(task, camera, tasks) for task in parts):
            start = any(_moves(task) for task in parts)
            text = f"'{camera.name}' sees nothing{' but the ground' if len(parts) < len(names) else ''}: all "
            text += f"{'else ' if len(parts) < len(names) else ''}that is drawn is behind it"
            middle = next((place for task in parts for place in _places(task, tasks)), None)
            at = "is the place in the middle" if middle is None else f"is the place in the middle, as `{_text(middle)}`"
            text += " at the start" if start else ""
            found.warning("not-seen", text, camera.span, help=f"turn it round: `look_at` {at}")


def warn_of_buried(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each lamp and camera that stands still under a level ground, which hides all above it."""
    level = ground_level(tasks)
    if level is None:
        return
    for task in tasks.values():
        at = _place(getattr(task.kind, "position", None)) if isinstance(task.kind, Light) else None
        if at is not None and at[1] < level:
            text = f"'{task.name}' stands under the ground, so that none of its light is seen"
            higher = _turned_up(at, level, 2.0)
            found.warning("buried-light", text, task.span, help=f"y is up: write `position: {higher}`")
        eye = _place(getattr(task.kind, "position", None)) if isinstance(task.kind, Camera) else None
        aim = _place(getattr(task.kind, "look_at", None))
        down = aim is not None and aim[1] < level  # what is below is meant
        if eye is not None and eye[1] < level and not down:
            text = f"'{task.name}' stands under the ground, which hides all above it"
            higher = _turned_up(eye, level, 1.0)
            found.warning("buried-camera", text, task.span, help=f"y is up: write `position: {higher}`")


def ground_level(tasks: Mapping[str, Task]) -> float | None:
    """The height [m] of a level ground that is drawn, hides what is behind it and stands still.

    None where there is none, or it is not known.
    """
    for task in tasks.values():
        kind = task.kind
        if not isinstance(kind, Object) or not kind.grounds or kind.hidden:
            continue
        if kind.material is not None and getattr(tasks[kind.material.name].kind, "clear", False):
            continue
        if (level := level_of(kind)) is not None:
            return level
    return None


def level_of(kind: Kind) -> float | None:
    """The height [m] of an endless level ground that stands still; None of other objects."""
    height, up = getattr(kind, "height", None), _place(getattr(kind, "normal", None)) or (0.0, 1.0, 0.0)
    base = _place(getattr(kind, "position", None)) or (0.0, 0.0, 0.0)
    if not isinstance(height, Value) or not height.constant or not getattr(kind, "grounds", False):
        return None
    return base[1] + float(height.number()) if up[0] == up[2] == 0 < up[1] else None


def _behind(task: Task, camera: Task, tasks: Mapping[str, Task]) -> bool:
    """Whether what stands still, or starts somewhere, certainly lies there behind a camera that stands still."""
    eye, aim = (_place(getattr(camera.kind, field, None)) for field in ("position", "look_at"))
    if eye is None or aim is None or (away := dist(eye, aim)) == 0:
        return False
    reach = MASS if isinstance(task.kind, Model) else _reach(task.original or task.kind)
    ahead = [sum((a - e) * (p - e) for e, a, p in zip(eye, aim, at, strict=True)) / away for at in _places(task, tasks)]
    return reach is not None and bool(ahead) and max(ahead) < -reach


def _moves(task: Task) -> bool:
    """Whether a part is a model, or stands where a model says."""
    at = getattr(task.kind, "position", None)
    return bool(task.original) or isinstance(task.kind, Model) or (isinstance(at, Value) and not at.constant)


def _places(task: Task, tasks: Mapping[str, Task]) -> list[tuple[float, ...]]:
    """Where an object stands or starts, or the masses of a model start [m]; empty where that is not known."""
    if isinstance(task.kind, Model):
        known = [mass.position for mass in task.kind.static_masses().values()]
        return [] if None in known else [place for place in known if place is not None]
    value = getattr(task.original or task.kind, "position", None)
    at = _place(value)
    if at is None and isinstance(value, Value) and isinstance(value.expr, Link):  # of a mass that it follows
        model, mass = tasks.get(value.expr.task), value.expr.output.rpartition(".")[0]
        masses = model.kind.static_masses() if model is not None and isinstance(model.kind, Model) else {}
        at = masses[mass].position if mass in masses else None
    return [] if at is None else [at]


def _turned_up(place: tuple[float, ...], level: float, above: float) -> str:
    """A place [m] under a ground as it is where z was taken for upwards, else so far [m] above the ground."""
    x, y, z = place
    meant = (x, z, -y) if level < z < -y else (x, level + above, z)
    return _text(meant)


def _text(place: tuple[float, ...]) -> str:
    return f"{' '.join(f'{one:g}' for one in place)} m"


def _place(value: object) -> tuple[float, ...] | None:
    return tuple(map(float, value.number())) if isinstance(value, Value) and value.constant else None


def _reach(kind: Kind) -> float | None:
    """A bound of how far an object reaches from its position [m]; None where its fields do not tell."""
    sizes = [value for field in ("radius", "size", "tube", "height") if (value := getattr(kind, field, None))]
    if not sizes or not all(isinstance(one, Value) and one.constant for one in sizes):
        return None
    numbers = [one.number() for one in sizes]
    return sum(sqrt(sum(c * c for c in one)) if isinstance(one, tuple) else float(one) for one in numbers)


def warn_of_dim(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of a script that has but lamps of a watt or so: they light what is a hand's breadth away."""
    lights = [task for task in tasks.values() if isinstance(task.kind, Light) and task.span is not None]
    powers = [getattr(task.kind, "power", None) for task in lights]
    if not powers or not all(isinstance(one, Value) and one.constant for one in powers):
        return
    power = sum(float(one.number()) for one in powers if isinstance(one, Value))
    lamps = [_place(getattr(task.kind, "position", None)) for task in lights]
    shown = [task for task in tasks.values() if isinstance(task.kind, Object) and not task.kind.grounds]
    near = [place for task in shown for place in _places(task, tasks)]
    away = [dist(lamp, place) for lamp in lamps if lamp is not None for place in near]
    lit = bool(away) and power >= DIM * min(away) ** 2  # a small scene: as bright there as a larger lamp makes others
    if 0.0 < power < DIM and not lit:
        bright = power / (4.0 * pi**2)
        text = f"'{lights[0].name}' is dim: what is white and 1 m away is {bright:.1g} as bright as white"
        found.warning("dim-light", text, lights[0].span, help="a lamp in a room has 60 W: write `power: 60 W`")
        return
    if power > 0.0 and None not in lamps and away and power < FAINT * (2.0 * pi * min(away)) ** 2:
        text = f"'{lights[0].name}' is {min(away):.3g} m away: what is white there is "
        text += f"{power / (2.0 * pi * min(away)) ** 2:.1g} as bright as white"
        help = "bring it nearer; a `sun` shines from any distance: `{sun: {direction: 1 1 1}}`"
        found.warning("dim-light", text, lights[0].span, help=help)
