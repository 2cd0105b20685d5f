"""Formulas of x, y and z at an instant: subexpressions that do not depend on the point become numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from sceneql.kinds import Value
from sceneql.quantities.derivative import components
from sceneql.quantities.expression import Call, Expr, Number, Symbol, each_once, holders, rebuilt, walk
from sceneql.quantities.operations import OPERATIONS

if TYPE_CHECKING:
    from sceneql.kinds import Moment

COORDINATES = ("x", "y", "z")


def depends_on_place(expr: Expr) -> bool:
    """Whether an expression has a coordinate in it."""
    return any(map(_is_coordinate, walk(expr)))


def _is_coordinate(node: Expr) -> bool:
    return isinstance(node, Symbol) and node.name in COORDINATES


def in_coordinates(expr: Expr) -> None:
    """Check that a formula is one number at every point. Raises ValueError where it cannot be computed as a tape."""
    from sceneql.field.tape.builder import TapeBuilder, computes

    formula = _scalars(expr, lambda part: Number(1.0, part.type))
    unbounded = next((n.op for n in each_once(formula) if isinstance(n, Call) and not computes(n.op)), None)
    if unbounded is not None:
        name = OPERATIONS[unbounded].part_of or unbounded
        raise ValueError(
            f"an implicit surface's formula cannot have '{name}' of x, y or z: rays need its least and largest value in"
            " a box, which are not known; of t alone it can"
        )
    build = TapeBuilder()
    build.expression(formula, dict(zip(COORDINATES, (build.x, build.y, build.z), strict=True)))


def written_out(expr: Expr, moment: Moment) -> Expr:
    """The formula with time, links and keyframes replaced by their numbers now."""
    return _scalars(expr, lambda part: Number(float(moment.at(Value(part))), part.type))


def _scalars(expr: Expr, number: Callable[[Expr], Number]) -> Expr:
    """The tree with vectors split into components, and numbers in place of subexpressions without coordinates."""
    try:
        whole = components(expr)
    except TypeError as error:
        raise ValueError(f"a formula cannot be computed: {error}") from error
    if len(whole) != 1:
        raise ValueError(f"a formula is one number at every point, not {len(whole)}")
    placed = holders(_is_coordinate, whole[0])

    def fixed(node: Expr) -> bool:
        return node.type.shape == () and id(node) not in placed and not isinstance(node, Number)

    def operands(node: Expr) -> tuple[Expr, ...]:
        return node.args if isinstance(node, Call) and not fixed(node) else ()

    return rebuilt(whole[0], lambda node, new: number(node) if fixed(node) else new, operands)
