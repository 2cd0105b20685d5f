"""Binding: names become what they mean, types are inferred, dimensions checked, constants folded."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from sceneql.quantities.diagnostic import Diagnostics, Note
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Link, Name, Number, Symbol, Type, Vector
from sceneql.quantities.quick_operations import CONSTANTS, OPERATIONS, TypeMismatch, common, fits_any
from sceneql.quantities.span import Span

Lookup = Callable[[tuple[str, ...], Span], Expr | None]
"""What a dotted name means (a component such as ``a.b.x`` included); None after having reported that it is unknown."""


def bind(expr: Expr, lookup: Lookup, found: Diagnostics) -> Expr | None:
    """The typed tree of a parsed one, or None after reporting what is wrong."""
    match expr:
        case Name(parts=parts, span=span):
            return _name(parts, span, lookup)
        case Vector(items=items):
            return _vector(expr, [bind(item, lookup, found) for item in items], found)
        case Call(args=args):
            return _call(expr, [bind(arg, lookup, found) for arg in args], found)
    return expr


def _name(parts: tuple[str, ...], span: Span | None, lookup: Lookup) -> Expr | None:
    assert span is not None
    if len(parts) == 1 and parts[0] in CONSTANTS:
        return Number(CONSTANTS[parts[0]], bare=False, span=span)
    expr = lookup(parts, span)
    # The place of a value is where it is used; a define's own place is in the define.
    return replace(expr, span=span) if isinstance(expr, Number | Symbol | Link) else expr


def _call(expr: Call, args: list[Expr | None], found: Diagnostics) -> Expr | None:
    known = tuple(arg for arg in args if arg is not None)
    if len(known) < len(args):
        return None
    try:
        type_ = OPERATIONS[expr.op].rule(known)
    except TypeMismatch as error:
        _report(expr, known, error, found)
        return None
    return fold(Call(expr.op, known, type_, expr.span))


def _vector(expr: Vector, items: list[Expr | None], found: Diagnostics) -> Expr | None:
    known = tuple(item for item in items if item is not None)
    if len(known) < len(items) or not known:
        if not items:
            found.error("syntax", "an empty list has no value", expr.span)
        return None
    try:
        dimension = common(known)
    except TypeMismatch as error:
        _report(expr, known, error, found)
        return None
    shapes = {item.type.shape for item in known}
    if len(shapes) > 1:
        found.error("wrong-shape", "the items of a list must be alike", expr.span)
        return None
    return Vector(known, Type((len(known), *shapes.pop()), dimension), expr.span)


def fold(expr: Call) -> Expr:
    """A scalar operation on numbers is a number."""
    operation = OPERATIONS[expr.op]
    if expr.type.shape or operation.series or not all(isinstance(arg, Number) for arg in expr.args):
        return expr
    bare = all(arg.bare for arg in expr.args if isinstance(arg, Number))
    return Number(float(evaluate(expr, {})), expr.type, bare, expr.span)


VERBS = {"add": "add", "sub": "subtract", "lt": "compare", "le": "compare", "gt": "compare", "ge": "compare"}


def _report(expr: Call | Vector, args: tuple[Expr, ...], error: TypeMismatch, found: Diagnostics) -> None:
    from sceneql.quantities.printing import describe

    first = args[error.first]
    name = expr.op if isinstance(expr, Call) else "a list"
    if error.second is None:
        found.error("dimension-mismatch", f"{name} {error}", first.span or expr.span)
        return
    second = args[error.second]
    if str(error):
        found.error("shape-mismatch", f"{name}: {error}", expr.span)
        return
    help_ = None
    for arg, other in ((first, second), (second, first)):
        if isinstance(arg, Number) and arg.bare and not fits_any(arg) and math.isfinite(arg.value) and arg.span:
            help_ = f"a bare number has no unit; write `{arg.span.text} {other.type.dimension}`"
    verb = VERBS.get(name, f"take {name} of" if isinstance(expr, Call) else "put in one list")
    found.error(
        "dimension-mismatch",
        f"cannot {verb} {describe(first.type.dimension)} and {describe(second.type.dimension)}",
        first.span or expr.span,
        help=help_,
        notes=[Note("the other is here", second.span)] if second.span else [],
    )


