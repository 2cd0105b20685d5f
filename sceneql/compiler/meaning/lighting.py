"""Warnings of lights that give none, or far too much, and of what is clear and so never seen."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.meaning.places import distance, opaque
from sceneql.graph import Task
from sceneql.kinds import Light, Picture
from sceneql.quantities.diagnostic import Diagnostics

FACTORS = ("strength", "power", "key", "fill")
"""Fields that are factors of a light."""
GLARE = 30.0
"""Brightness of what is white, over white, from which on a picture is white all over."""
STOPS = 9.0
"""Stops of an exposure at which what is lit as usual is black, or white."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of lights that are all out or that blind, exposures that leave nothing, and glass without refraction."""
    lights = [task for task in facts.of(Light) if task.span is not None]
    exposed = [task for task in facts.of(Picture) if getattr(task.kind, "exposure", 0.0)]
    shines = any(_shines(facts, name) for name in facts.seen)
    if lights and len(lights) == len([*facts.of(Light)]) and all(map(_out, lights)) and not shines:
        field = next(name for name, value in _factors(lights[0]) if value is not None)
        told = f"'{lights[0].name}' gives no light, and there is no other: the picture is black"
        found.warning("dim-light", told, lights[0].span, help=f"write a larger `{field}` or a lighter color")
    for task in lights if not exposed else ():
        bright, help = _brightness(task, facts)
        if bright > GLARE:
            told = f"'{task.name}' makes what is white {bright:.2g} times as bright as white: all is overexposed"
            found.warning("glare", told, task.span, help=help)
    for task in exposed if not lights else ():
        stops = float(task.kind.exposure)  # type: ignore[attr-defined]
        if abs(stops) >= STOPS:
            how = "black" if stops < 0 else "white"
            told = f"'{task.name}' is {how}: an exposure of {stops:g} stops is a factor of {2.0**stops:.2g}"
            found.warning("glare", told, task.span, help="write `exposure: 1` for twice as bright, -1 for half")
    for name, kind in facts.objects.items():
        material: Any = facts.material(kind) if name in facts.seen else None
        if material is None or getattr(material, "index_of_refraction", None) != 1.0 or kind.color is not None:
            continue
        color = constant(material.color)
        if color is not None and min(color) >= 1.0 and not material.roughness and facts.written(name):
            told = f"'{name}' is not seen: a glass of index 1 without a color changes no light"
            found.warning("never-seen", told, facts.tasks[name].span, help="write `index_of_refraction: 1.5`")


def _factors(task: Task) -> Iterator[tuple[str, Any]]:
    """Factors of a light that are constant, by field."""
    for field in FACTORS:
        if hasattr(task.kind, field):
            yield field, constant(getattr(task.kind, field))


def _out(task: Task) -> bool:
    """Whether a light gives none at any time."""
    color = constant(getattr(task.kind, "color", None))
    factors = [value for _, value in _factors(task)]
    black = color is not None and max(color) == 0.0
    return bool(factors) and None not in factors and (all(float(one) == 0.0 for one in factors) or black)


def _shines(facts: Facts, name: str) -> bool:
    """Whether a part may shine by itself."""
    kind = facts.tasks[name].kind
    material = facts.material(kind)
    glows = material is not None and "strength" in type(material).model_fields
    return glows or hasattr(kind, "blend") or hasattr(kind, "absorption")


def _brightness(task: Task, facts: Facts) -> tuple[float, str]:
    """How bright a light makes what is white and nearest to it, over white, and what to write."""
    kind: Any = task.kind
    strength, power, at = (constant(getattr(kind, field, None)) for field in ("strength", "power", "position"))
    if strength is not None:
        return float(strength), "1 is as bright as its color, `strength: 1`; W/m^2 it is not"
    if power is None or at is None:
        return 0.0, ""
    gaps = [distance(at, held.center) - held.inner for held in opaque(facts).values()]
    near = max(min((gap for gap in gaps if gap > 0.0), default=0.0), 0.5)
    if not gaps or min(gaps) <= 0.0:
        return 0.0, ""
    bright = float(power) / (2.0 * pi * near) ** 2
    return bright, f"write `power: {(2.0 * pi * near) ** 2:.2g} W`, which makes it as bright as white"
