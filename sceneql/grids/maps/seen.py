"""A field at a moment, as words that draw it see it: a script's value, evaluated at any point."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, cast

from sceneql.grids.maps.kept import Kept
from sceneql.kinds import Problem, Quantity, Ref, Value
from sceneql.quantities.dimension import comparable
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Symbol
from sceneql.quantities.units import describe, in_words
from sceneql.shapes.placement import compose, inverse
from sceneql.shapes.solid import triple

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import Between, FieldLayout
    from sceneql.kinds import Moment
    from sceneql.system import ModelState

Field = Annotated[Value, Quantity(None, (None,))]
"""An expression of a field's values: ``lake.concentration``, ``dish.u - dish.v``."""
Levels = Annotated[Value, Quantity(None, None)]
"""One value, or a list of values."""
Bounds = Annotated[Value, Quantity(None, (2,))]
Corner = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A field at a moment."""

    model: Any
    layout: FieldLayout
    interpolation: Between
    held: Floats
    """The field's values in the form that ``interpolation`` reads (`filled`)."""
    least: float
    largest: float

    def at(self, points: Floats) -> Floats:
        """Values (k,) of the field at points (k, 3) [m] in the model's coordinates."""
        return self.interpolation.at(self.held, points)

    @property
    def filled(self) -> Floats:
        """Values (nz, ny, nx) at the centers of its cells, with one more layer of cells around."""
        return self.interpolation.gridded(self.held)

    def nodes(self, place: Floats) -> tuple[Floats, Corner, Corner]:
        """Map (3, 4) from the world to node coordinates of ``filled``, and the corners of the grid's box in these.

        For a 3D field. ``place`` (3, 4): map from the model's coordinates to the world.
        """
        import numpy as np

        spacing = np.array(self.layout.spacing)
        grid = np.column_stack([np.diag(spacing), np.array(self.layout.low) - 0.5 * spacing])
        high = triple(np.array(self.layout.shape) + 0.5)
        return inverse(compose(place, grid)), (0.5, 0.5, 0.5), high

    def bounds(self, moment: Moment) -> Floats | None:
        """Level set (nz, ny, nx) of the domain at the nodes of ``filled``, negative inside; None for a box domain."""
        level = level_of(self, moment)
        return None if level is None else _bounds.get(self.model, self.layout.shape, lambda: self._at_nodes(level))

    def _at_nodes(self, level: Any) -> Floats:
        import numpy as np

        shape = self.filled.shape
        k, j, i = (index.ravel() for index in np.indices(shape))
        places = np.array(self.layout.low) + (np.stack([i, j, k], axis=1) - 0.5) * self.layout.spacing
        found: Floats = level.values(places).reshape(shape)
        return found


def seen(of: Value, moment: Moment) -> Seen:
    """The field that a value reads, at a moment. Raises ValueError where it reads no field."""
    import numpy as np

    task, output = of.links[0].task, of.links[0].output
    model: Any = moment.object(Ref(task, of.span))
    if not hasattr(model, "layout"):
        raise ValueError(f"'{task}' is no field on a grid")
    state = moment.state(task)
    layout = model.layout(state, output)
    own = getattr(model, "between", between_cells)
    between = own(layout, state)
    values = np.asarray(moment.at(of), dtype=float)
    if values.shape != (between.count,):
        raise ValueError(f"this has {values.size} values, but '{task}' has {between.count} {between.what}")
    return Seen(model, layout, between, between.filled(values), float(values.min()), float(values.max()))


def between_cells(layout: FieldLayout, state: ModelState) -> Between:
    """The interpolation of a field on a grid between the centers of its cells."""
    from sceneql.grids.maps.interpolation import interpolation

    return interpolation(layout, state.floats[layout.volumes_at : layout.volumes_at + layout.count] > 0.0)


def swings(of: Value, moment: Moment) -> bool:
    """Whether a value is an output that its model lists as oscillating about 0 (``swinging``)."""
    if not isinstance(of.expr, Link):
        return False
    model: Any = moment.object(Ref(of.expr.task, of.span))
    return of.expr.output in getattr(model, "swinging", ())


def called(of: Value, moment: Moment) -> str:
    """The name of a part's output in a legend, as `von mises`; empty for a formula."""
    if not isinstance(of.expr, Link):
        return ""
    model: Any = moment.object(Ref(of.expr.task, of.span))
    return cast(str, model.called(of.expr.output)).replace("_", " ")


class AtStart:
    """A stand-in for kinds.Moment at the start of the run, with all that an object's field and extent read.

    A field's domain is its object as at the start. Outputs of other parts are those of the current moment.
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
        """The object that a reference names."""
        return self._moment.object(ref)

    def kept(self, name: str, key: Hashable, make: Callable[[], Any]) -> Any:
        """The result of ``make``, not cached."""
        return make()


def level_of(field: Seen, moment: Moment) -> Any:
    """The level set of a field's domain (domain.cut.Level), cached; None for a box given by its sides."""
    if field.model.size is not None:
        return None
    from sceneql.grids.domain.domain import inside

    def make() -> Any:
        level, *_ = inside(field.model.domain, field.model.flat, cast("Moment", AtStart(moment)))
        return level

    return _levels.get(field.model, None, make)


_levels: Kept[Any] = Kept()
_bounds: Kept[Any] = Kept()


def unfit(of: Value, others: dict[str, Value | None]) -> Iterator[Problem]:
    """Problems: a value that is not a field of one part; other values whose dimension differs from the field's."""
    parts = {link.task for link in of.links}
    if len(parts) != 1:
        told = f"of {len(parts)} parts" if parts else "of no part"
        yield Problem(f"this is {told}; a field is one part's: `lake.concentration`", ("of",))
    own = of.expr.type.dimension
    for name, value in others.items():
        has = None if value is None else value.expr.type.dimension
        if not comparable(has, own):
            text = f"{name} is {describe(own)} as the field is, but this is {in_words(has)}"
            yield Problem(text, (name,), code="dimension-mismatch")
