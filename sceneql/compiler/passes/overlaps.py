"""Check of initial overlaps: bodies that start inside an object or body that they collide with.

The implicit fields of both are evaluated on a lattice in the intersection of their boxes. Smaller overlaps than the run
allows, and shapes that only a run knows, are left to the run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

from sceneql.compiler.passes.fillings import Beginning
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, Task
from sceneql.kinds import Model, Object, Tie
from sceneql.quantities.diagnostic import Diagnostics, ScriptError

if TYPE_CHECKING:
    from sceneql.frame import Floats

SIDE = 5
"""Number of lattice points along each axis of the box shared by two objects."""
DEEP = 0.02
"""Least depth of an overlap, relative to the smaller object's size: touching objects do not overlap."""
SUNK, NEAR = 0.3, 1e-3
"""Depth of a ball, relative to its radius, from which on there is a warning, and distance at which slopes are taken."""
MOST_PAIRS = 100
"""Number of pairs above which none is compared; the run does it."""
UNKNOWN = (TypeError, ValueError, ArithmeticError, RunFailure, LimitRefused, ScriptError)


def report_overlaps(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Report each body that certainly starts inside an object or another body that it collides with."""
    start: Any = Beginning(tasks)
    pairs = [*islice((pair for island in groups for pair in _pairs(island, tasks)), MOST_PAIRS + 1)]
    for body, other, whole in pairs if len(pairs) <= MOST_PAIRS else ():
        try:
            inside = _overlap(body, other, whole, tasks, start)
            sunk = "" if inside or whole else _sunk(body, other, tasks, start)
        except UNKNOWN:
            continue
        if sunk:
            text = f"'{body}' starts in part inside '{other}', and is pushed out"
            found.warning("starts-inside", text, tasks[body].span, help=sunk)
        if inside:
            text = f"'{body}' starts inside '{other}'"
            help = "move one of them away, or name under `between` what may touch, without one of them"
            if tasks[other].span is None:
                help = f"'{other}' is there by default: leave it out, `objects: {{{other}: none}}`, or move '{body}' up"
            found.error("starts-inside", text, tasks[body].span, help=help)


def _pairs(island: Island, tasks: Mapping[str, Task]) -> Iterator[tuple[str, str, bool]]:
    """Pairs (body's object, object that it collides with, whether its whole shape collides or only its center).

    Only bodies that start where their objects stand are included. Bodies held by ties are left out, and so is a default
    floor beside other objects, which the run puts under them.
    """
    tied = {ref.name for task in tasks.values() if isinstance(task.kind, Tie) for ref in task.kind.between}
    turning: dict[str, list[str]] = {}
    for contact, model, others in island.contacts:
        kind: Any = tasks[model].kind
        if not isinstance(kind, Model) or kind.has_skin or kind.carried:
            continue
        bodies = (kind, *(getattr(kind, "bodies", None) or {}).values())
        if any(getattr(body, "position", None) is not None for body in bodies):
            continue  # they start elsewhere
        others = tuple(other for other in others if tasks[other].span is not None) or others
        moved = [body for body in kind.drives() if body in tasks and tasks[body].original is not None]
        before = turning.setdefault(contact, [])
        for body in moved:
            yield from ((body, other, kind.turns) for other in others if other not in (body, *tied))
            if kind.turns and not tied:
                yield from ((other, body, True) for other in before)
                before.append(body)


def _overlap(body: str, other: str, whole: bool, tasks: Mapping[str, Task], start: Any) -> float:
    """Largest depth [m] of a lattice point in both objects.

    0 where none was found, or where it is below the threshold.
    """
    import numpy as np

    shapes: list[Any] = [tasks[body].original, tasks[other].original or tasks[other].kind]
    boxes = [shape.extent(np.eye(3, 4), start) for shape in shapes]
    if not whole:
        middle = (boxes[0][0] + boxes[0][1]) / 2
        boxes[0] = middle, middle
    low, high = np.max([box[0] for box in boxes], axis=0), np.min([box[1] for box in boxes], axis=0)
    if not (np.isfinite(high - low).all() and (high >= low).all()):
        return 0.0
    if any(type(shape).implicit is Object.implicit for shape in shapes):
        return 0.0
    sizes = [float((box[1] - box[0]).max()) for box in boxes[0 if whole else 1 :]]
    least = DEEP * min(size for size in [*sizes, 1.0] if np.isfinite(size))
    axes = [np.linspace(a, b, SIDE) for a, b in zip(low, high, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    depths = -np.maximum(*(field_at(shape, places, start) for shape in shapes))
    return float(depths[depths > least].max(initial=0.0))


def _sunk(body: str, other: str, tasks: Mapping[str, Task], start: Any) -> str:
    """The help for a ball whose center is outside of an object that it reaches far into; empty for others."""
    import numpy as np

    shapes: list[Any] = [tasks[body].original, tasks[other].original or tasks[other].kind]
    low, high = shapes[0].extent(np.eye(3, 4), start)
    center, sizes = (low + high) / 2, high - low
    radius = float(sizes.max()) / 2
    if not (np.isfinite(radius) and np.allclose(sizes, 2 * radius)) or type(shapes[1]).implicit is Object.implicit:
        return ""
    steps = NEAR * radius * np.eye(3)
    away, *around = field_at(shapes[1], np.stack([center, *(center + steps), *(center - steps)]), start)
    slope = (np.array(around[:3]) - around[3:]) / (2 * NEAR * radius)
    steepness = float(np.linalg.norm(slope))
    if not 0.5 < steepness < 2.0 or radius - away / steepness < SUNK * radius:
        return ""  # its field is no distance there
    place = center + (radius - away / steepness) * slope / steepness
    text = " ".join(f"{one:.4g}" for one in place + 0.0)
    return f"a ball's position is its center: it touches '{other}' at `position: {text} m`"


def field_at(shape: Object, places: Floats, start: Any) -> Floats:
    """(n,) implicit field of an object at places (n, 3); where it is negative, -field is at most the depth."""
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.field.tape.plain_values import plain_values

    build = TapeBuilder()
    tape = build.finish(shape.implicit(build, build.x, build.y, build.z, start))
    values = plain_values(tape, places)
    return np.ones(len(places)) if values is None else values
