"""A field as a word sees it at a moment: from a script's value to numbers at any place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, cast

from sceneql.kinds import Problem, Quantity, Ref, Value
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Symbol
from sceneql.quantities.units import describe
from sceneql.simulation.maps.kept import Kept

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Moment
    from sceneql.simulation.grids.medium import FieldLayout
    from sceneql.simulation.maps.interpolation import Interpolation

Field = Annotated[Value, Quantity(None, (None,))]
"""An expression of a field's values: ``lake.concentration``, ``dish.u - dish.v``."""
Levels = Annotated[Value, Quantity(None, None)]
"""A value or several."""
Bounds = Annotated[Value, Quantity(None, (2,))]


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A field at a moment."""

    model: Any
    layout: FieldLayout
    interpolation: Interpolation
    filled: Floats
    least: float
    largest: float

    def at(self, points: Floats) -> Floats:
        """The field at points (k, 3) [m] in its model's own coordinates: (k,)."""
        return self.interpolation.at(self.filled, points)


def seen(of: Value, moment: Moment) -> Seen:
    """The field that a value tells now. Raises ValueError where it is of no field."""
    import numpy as np

    from sceneql.simulation.maps.interpolation import interpolation

    task, output = of.links[0].task, of.links[0].output
    model: Any = moment.object(Ref(task, of.span))
    if not hasattr(model, "layout"):
        raise ValueError(f"'{task}' is no field on a grid")
    state = moment.state(task)
    layout = model.layout(state, output)
    inside = state.floats[layout.volumes_at : layout.volumes_at + layout.count] > 0.0
    values = np.asarray(moment.at(of), dtype=float)
    if values.shape != (int(inside.sum()),):
        raise ValueError(f"this has {values.size} values, but '{task}' has {inside.sum()} cells")
    between = interpolation(layout, inside)
    return Seen(model, layout, between, between.filled(values), float(values.min()), float(values.max()))


class AtStart:
    """What an object's field and extent may ask of a moment (part of kinds.Moment), as of the start of the run.

    Fields spread where an object is at the start. What it reads of other parts is taken as it is now.
    """

    time = 0.0

    def __init__(self, moment: Moment) -> None:
        self._moment = moment

    def at(self, value: Value) -> Any:
        """A value at the start."""
        return evaluate(value.expr, self._look_up, arrays=True)

    def _look_up(self, node: Symbol | Link) -> Any:
        return self.time if isinstance(node, Symbol) else self._moment.read(node.task, node.output)

    def object(self, ref: Ref) -> Any:
        """The kind of an object."""
        return self._moment.object(ref)


def level_of(field: Seen, moment: Moment) -> Any:
    """The level set of a field's domain (grids.cut.Level); None for a box by its sides."""
    if field.model.size is not None:
        return None
    from sceneql.simulation.grids.domain import inside

    def make() -> Any:
        level, *_ = inside(field.model.domain, field.model.flat, cast("Moment", AtStart(moment)))
        return level

    return _levels.get(field.model, None, make)


_levels: Kept[Any] = Kept()


def unfit(of: Value, others: dict[str, Value | None]) -> Iterator[Problem]:
    """What is wrong with the field that a word draws, and with what must be of its dimension."""
    parts = {link.task for link in of.links}
    if len(parts) != 1:
        told = f"of {len(parts)} parts" if parts else "of no part"
        yield Problem(f"this is {told}; a field is one part's: `lake.concentration`", ("of",))
    own = of.expr.type.dimension
    for name, value in others.items():
        has = None if value is None else value.expr.type.dimension
        if own is not None and has is not None and has != own and not has.plain:
            text = f"{name} is {describe(own)} as the field is, but this is {describe(has)}"
            yield Problem(text, (name,), code="dimension-mismatch")
