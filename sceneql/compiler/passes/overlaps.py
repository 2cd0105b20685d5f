"""What starts inside what it collides with, as far as the script alone tells it: refused before anything runs.

Places of a lattice are asked whether they lie deep in both, by the fields of both; what overlaps less than the run
allows, or where only a run knows shapes, is left to that.
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
"""Places along each axis of the box that two objects share."""
DEEP = 0.02
"""How deep a place lies in both, at least, in parts of the smaller one's size: what touches is apart."""
MOST_PAIRS = 100
"""Pairs of boxes from which on none is compared: the run does."""
UNKNOWN = (TypeError, ValueError, ArithmeticError, RunFailure, LimitRefused, ScriptError)


def report_overlaps(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Report each body that is sure to start inside an object or another body that it collides with."""
    start: Any = Beginning(tasks)
    pairs = [*islice((pair for island in groups for pair in _pairs(island, tasks)), MOST_PAIRS + 1)]
    for body, other, whole in pairs if len(pairs) <= MOST_PAIRS else ():
        try:
            inside = _overlap(body, other, whole, tasks, start)
        except UNKNOWN:
            continue
        if inside:
            text = f"'{body}' starts inside '{other}'"
            help = "move one of them away, or name under `between` what may touch, without one of them"
            found.error("starts-inside", text, tasks[body].span, help=help)


def _pairs(island: Island, tasks: Mapping[str, Task]) -> Iterator[tuple[str, str, bool]]:
    """The objects of bodies that start where they stand, each with an object that it collides with, and whether all of
    its shape does: of a mass the center. What ties hold is left out, and a default floor beside other objects: the
    run puts it under them."""
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
    """How deep [m] a place lies in both, at least; 0 where none was found, or it is less than is told."""
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
    sides = (np.linspace(a, b, SIDE if b > a else 1) for a, b in zip(low, high, strict=True))
    places = np.stack([side.ravel() for side in np.meshgrid(*sides, indexing="ij")])
    inside = -_field(shapes[0], places, start)
    places, inside = places[:, inside > least], inside[inside > least]
    if not len(inside):
        return 0.0
    deepest = float(np.minimum(inside, -_field(shapes[1], places, start)).max())
    return deepest if deepest > least else 0.0


def _field(shape: Object, places: Floats, start: Any) -> Floats:
    """An object's field at places (3, n): at most the distance from its surface, where it is negative; else 1."""
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.field.tape.plainly import values

    build = TapeBuilder()
    found = values(build.finish(shape.implicit(build, build.x, build.y, build.z, start)), places)
    return np.where(np.isfinite(found), found, 1.0)
