"""Formulas of x, y and z at an instant: subexpressions that do not depend on the point become numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from sceneql.kinds import Value
from sceneql.quantities.derivative import components
from sceneql.quantities.expression import Call, Expr, Number, Symbol, walk

if TYPE_CHECKING:
    from sceneql.kinds import Moment

COORDINATES = ("x", "y", "z")


def depends_on_place(expr: Expr) -> bool:
    """Whether an expression has a coordinate in it."""
    return any(isinstance(node, Symbol) and node.name in COORDINATES for node in walk(expr))


def in_coordinates(expr: Expr) -> None:
    """Check that a formula is one number at every point. Raises ValueError where it cannot be computed as a tape."""
    from sceneql.field.tape.builder import TapeBuilder

    build = TapeBuilder()
    registers = dict(zip(COORDINATES, (build.x, build.y, build.z), strict=True))
    build.expression(_scalars(expr, lambda part: Number(1.0, part.type)), registers)


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
    return _replaced(whole[0], number)


def _replaced(expr: Expr, number: Callable[[Expr], Number]) -> Expr:
    if isinstance(expr, Number):
        return expr
    if expr.type.shape == () and not depends_on_place(expr):
        return number(expr)
    if isinstance(expr, Call):
        return replace(expr, args=tuple(_replaced(arg, number) for arg in expr.args))
    return expr
