"""Warnings of objects less than a pixel large, and of cameras too near or far, by mm or km in place of m."""

from __future__ import annotations

import re
from math import radians, tan
from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.meaning.places import SIZES, distance
from sceneql.graph import Task
from sceneql.kinds import Value
from sceneql.quantities.diagnostic import Diagnostics

SMALL = re.compile(r"(.*\d) ?(mm|um|µm|nm)")
"""Numbers in a unit far below the meter, and the unit."""
LARGE = re.compile(r"(.*\d) ?(km)")
"""The same, far above it."""
PIXELS = 540.0
"""Height of the picture by which pixels are told."""
HALF = tan(radians(20.0))
"""Half of the height that a usual camera sees, over the distance."""
LINES = {"of", "through", "to", "at", "points"}
"""Fields of objects whose size is told elsewhere."""
ALIKE = 3.0
"""How much larger than all others an object may be that is a thousand times as large as it is written."""
INSIDE, AWAY = 0.1, 3000.0
"""Distance of a camera over the size of the largest object, below and above which it was told in another unit."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such object beside others, and of each such camera."""
    known = {name: _size(facts, name) for name in sorted(facts.seen) if name in facts.objects}
    sizes = {name: one for name, one in known.items() if one is not None}
    largest = max((size for size, _, _ in sizes.values()), default=0.0)
    cameras = sorted({name for name in facts.cameras.values() if name})
    own = [facts.tasks[name] for name in cameras if facts.tasks[name].span is not None]
    for name, (size, field, value) in sizes.items():
        unit = SMALL.fullmatch(_written(value))
        if unit is None or 1000.0 * size > ALIKE * largest or not _unseen(facts, name, size, largest, own):
            continue
        text = f"'{name}' is {size:.2g} m large, less than a pixel beside what is {largest:.3g} m large"
        found.warning("not-seen", text, value.span, help=f"write `{field}: {unit[1]} m`, or `hidden: yes`")
    for camera in own if largest > 0.0 else ():
        _camera(facts, camera, largest, found)


def _written(value: Value | None) -> str:
    return "" if value is None or value.span is None else value.span.text.strip("\"' ")


def _size(facts: Facts, name: str) -> tuple[float, str, Any] | None:
    """How large an object is [m], the field that says so, and its value; None of grounds and of what is not known."""
    kind: Any = facts.objects[name]
    fields = type(kind).model_fields.keys()
    if kind.grounds or kind.hidden or kind.decorates or fields & LINES:
        return None
    given = {field: value for field in SIZES if isinstance(value := getattr(kind, field, None), Value)}
    numbers = [constant(value) for value in given.values()]
    if not given or None in numbers:
        return None
    each = [max(one) if isinstance(one, tuple) else 2.0 * float(one) for one in numbers]
    k = max(range(len(each)), key=each.__getitem__)
    return each[k], [*given][k], [*given.values()][k]


def _unseen(facts: Facts, name: str, size: float, largest: float, own: list[Task]) -> bool:
    """Whether an object is less than a pixel in the pictures of all cameras."""
    if not own:
        return size * PIXELS < largest
    place = constant(getattr(facts.objects[name], "position", None))
    for camera in own:
        eye, angle = (constant(getattr(camera.kind, field, None)) for field in ("position", "field_of_view"))
        if eye is None or angle is None or place is None or getattr(camera.kind, "follow", None) is not None:
            return False
        if size * PIXELS > 2.0 * tan(0.5 * float(angle)) * distance(eye, place):
            return False
    return True


def _camera(facts: Facts, camera: Task, largest: float, found: Diagnostics) -> None:
    """A camera whose place is told in millimeters or kilometers, and what it looks at in meters."""
    kind: Any = camera.kind
    eye, aim = getattr(kind, "position", None), getattr(kind, "look_at", None)
    place = constant(eye)
    if eye is None or place is None or constant(aim) is None or constant(getattr(kind, "field_of_view", None)) is None:
        return
    reach = max(map(abs, place))
    small, large = SMALL.fullmatch(_written(eye)), LARGE.fullmatch(_written(eye))
    aimed = SMALL.fullmatch(_written(aim)) or LARGE.fullmatch(_written(aim))
    unit = small if reach < INSIDE * largest else large if reach > AWAY * largest else None
    if unit is not None and aimed is None:
        text = f"'{camera.name}' stands {reach:g} m away from the origin, and what it should see is "
        text += f"{largest:.3g} m large"
        found.warning("not-seen", text, eye.span, help=f"write `position: {unit[1]} m`")
