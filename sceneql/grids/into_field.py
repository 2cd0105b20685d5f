"""Coupling of masses to a field on a grid."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sceneql.kinds import Problem, Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Link

if TYPE_CHECKING:
    from sceneql.quantities.dimension import Dimension
    from sceneql.system import Assembly


def unfit(of: Value, name: str) -> Iterator[Problem]:
    """Problems of a value that must be a model's field itself; ``name``: the word's field with this value."""
    if not isinstance(of.expr, Link):
        yield Problem("this is the field of a model itself: `lake.concentration`", (name,))


def dimension(of: Value) -> Dimension | None:
    """The dimension of the field's values."""
    return of.expr.type.dimension


def numbers(of: Value, assembly: Assembly) -> tuple[int, ...]:
    """The integers of cell_weights_kernels for a field. Raises ScriptError for a value that is no field on a grid."""
    assert isinstance(of.expr, Link)
    grid = assembly.field_of(of.expr)
    if grid is None:
        text = f"'{of.expr.task}.{of.expr.output}' is no field on a grid"
        help = "name one of a `diffusion` or `reaction_diffusion` on cells"
        raise ScriptError([Diagnostic("no-field", text, of.span, help)])
    return (grid.at, *grid.cells.shape, grid.cells.insides_at, grid.cells.box_at, *map(int, grid.cells.periodic))
