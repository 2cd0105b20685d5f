"""Formulas of x, y and z at an instant: subexpressions that do not depend on the point become constants."""

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
    """Whether an expression depends on a coordinate."""
    return any(map(_is_coordinate, walk(expr)))


def _is_coordinate(node: Expr) -> bool:
    return isinstance(node, Symbol) and node.name in COORDINATES


def in_coordinates(expr: Expr) -> None:
    """Check that a formula is one number at every point. Raises ValueError where it cannot be computed as a tape."""
    name = not_on_tapes(expr)
    if name:
        raise ValueError(
            f"an implicit surface's formula cannot have '{name}' of x, y or z: rays need its least and largest value in"
            " a box, which are not known; of t alone it can"
        )


def not_on_tapes(expr: Expr, count: int = 1) -> str:
    """The name of an operation on the coordinates that tapes do not compute; empty where there is none.

    Raises ValueError for a formula that is not ``count`` numbers at every point, or that no tape computes.
    """
    from sceneql.field.tape.builder import TapeBuilder, computes

    build = TapeBuilder()
    for formula in _scalars(expr, lambda part: Number(1.0, part.type), count):
        unbounded = next((n.op for n in each_once(formula) if isinstance(n, Call) and not computes(n.op)), None)
        if unbounded is not None:
            return OPERATIONS[unbounded].part_of or unbounded
        build.expression(formula, dict(zip(COORDINATES, (build.x, build.y, build.z), strict=True)))
    return ""


def written_out(expr: Expr, moment: Moment) -> Expr:
    """The formula with time, links and keyframes replaced by their present values."""
    (found,) = all_written_out(expr, moment, 1)
    return found


def all_written_out(expr: Expr, moment: Moment, count: int) -> list[Expr]:
    """`written_out` for each of the ``count`` components of a formula."""
    return _scalars(expr, lambda part: Number(float(moment.at(Value(part))), part.type), count)


def _scalars(expr: Expr, number: Callable[[Expr], Number], count: int) -> list[Expr]:
    """The scalar trees of the components, with numbers in place of subexpressions without coordinates."""
    try:
        whole = components(expr)
    except TypeError as error:
        raise ValueError(f"a formula cannot be computed: {error}") from error
    if len(whole) != count:
        wanted = "one number" if count == 1 else f"{count} numbers"
        raise ValueError(f"a formula is {wanted} at every point, not {len(whole)}")
    return [_scalar(one, number) for one in whole]


def _scalar(expr: Expr, number: Callable[[Expr], Number]) -> Expr:
    placed = holders(_is_coordinate, expr)

    def fixed(node: Expr) -> bool:
        return node.type.shape == () and id(node) not in placed and not isinstance(node, Number)

    def operands(node: Expr) -> tuple[Expr, ...]:
        return node.args if isinstance(node, Call) and not fixed(node) else ()

    return rebuilt(expr, lambda node, new: number(node) if fixed(node) else new, operands)
