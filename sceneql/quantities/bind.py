"""Binding of a parsed tree: names are resolved, types inferred, dimensions checked, constants folded."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, Note
from sceneql.quantities.dimension import PLAIN
from sceneql.quantities.expression import Call, Expr, Name, Number, Symbol, Type, Vector, each_once
from sceneql.quantities.instead import time_meant
from sceneql.quantities.literal import quantity
from sceneql.quantities.operations import CONSTANTS, FLOATS, OPERATIONS
from sceneql.quantities.rules import FEWEST_DEGREES, TURNS, MismatchError, listed, shape_text
from sceneql.quantities.scalars import apply
from sceneql.quantities.span import Span
from sceneql.quantities.units import parse_unit, stands_below

Lookup = Callable[[tuple[str, ...], Span], Expr | Diagnostic | None]
"""Resolves a dotted name: its typed tree, or the Diagnostic that says why it has no meaning.

The Diagnostic is reported only if the name is none of the constants `pi`, `tau`, `e`, nor a unit below the bar behind a
number (``1500 /s``). None: the name is one of these constants, or its error has been reported already."""

SECONDS = "the time is `t` here, a plain number of seconds, as all numbers here: write `sin(3*t)`, not `sin(3 /s*time)`"
"""The help of the error for `time` with a unit in a formula over plain numbers."""
_TIMED = re.compile(r"([-+]?\d[\d.]*(?:[eE][-+]?\d+)?\s*)([^\W\d]\w*)\s*\*\s*time")
"""A number with a unit times the time."""
ENDS = ("low", "high")
COMPONENTS = {3: "xyz", 2: "xy", 4: "wxyz"}
"""Names of a vector's components, by the number of components."""


def bind(expr: Expr, lookup: Lookup, found: Diagnostics) -> Expr | None:
    """The typed tree of a parsed tree; None after reporting all errors (`dimension-mismatch`, ...)."""
    if isinstance(expr, Number):
        return expr
    bound: dict[int, Expr | None] = {}
    for node in each_once(expr):
        bound[id(node)] = _bound(node, bound, lookup, found)
    return bound[id(expr)]


def _bound(node: Expr, bound: dict[int, Expr | None], lookup: Lookup, found: Diagnostics) -> Expr | None:
    match node:
        case Name(parts=parts, span=span) if span is not None:
            meaning = _meaning(parts, span, lookup)
            if isinstance(meaning, Diagnostic):
                found.add(meaning)
                return None
            return meaning
        case Vector(items=parts) | Call(args=parts):
            args = tuple(arg for part in parts if (arg := bound[id(part)]) is not None)
            if len(args) < len(parts):
                return None
            try:
                if isinstance(node, Vector):
                    return Vector(args, listed(args), node.span)
                if node.op == "hue":
                    _doubt_hue(node, found)
                if node.op == "random":
                    _doubt_range(node, lookup, found)
                if node.op in TURNS:
                    _doubt_degrees(node, found)
                return fold(Call(node.op, args, OPERATIONS[node.op].rule(args), node.span))
            except MismatchError as error:
                _report(node, parts, error, lookup, found)
                return None
    return node


def _meaning(parts: tuple[str, ...], span: Span, lookup: Lookup) -> Expr | Diagnostic | None:
    expr = lookup(parts, span)
    if (expr is None or isinstance(expr, Diagnostic)) and len(parts) == 1 and parts[0] in CONSTANTS:
        return Number(CONSTANTS[parts[0]], span=span)
    if isinstance(expr, Diagnostic) and stands_below(".".join(parts), span.source.text, span.start):
        return quantity("1", parse_unit(parts[0]), span)
    return expr


def component(whole: Expr, of: str, name: str, span: Span) -> Expr | Diagnostic:
    """A component of the vector named ``of``; a Diagnostic (`no-component`) if it has no component of this name."""
    shape = whole.type.shape
    names = COMPONENTS.get(shape[-1] or 0, "") if shape else ""
    if len(name) != 1 or name not in names:
        kinds = ", ".join(f".{name}" for name in names)
        help = f"its components are {kinds}" if names else f"it is {shape_text(shape)}"
        return Diagnostic("no-component", f"'{of}' has no component '.{name}'", span, help)
    index = Number(float(names.index(name)))
    return fold(Call("component", (whole, index), Type(shape[:-1], whole.type.dimension), span))


def fold(expr: Call) -> Expr:
    """The literal result of an operation on constants, where it is finite; else the call itself."""
    operation = OPERATIONS[expr.op]
    if operation.series or None in expr.type.shape or not all(_constant(arg) for arg in expr.args):
        return expr
    value = apply(FLOATS, expr, [_value(arg) for arg in expr.args])
    bare = not operation.angle and all(_bare(arg) for arg in expr.args)
    return _literal(value, expr, bare) if _finite(value) else expr


def _doubt_degrees(call: Call, found: Diagnostics) -> None:
    """Warn of a sine, cosine or tangent of a bare number that is most likely meant in degrees."""
    (angle,) = call.args
    if isinstance(angle, Number) and angle.bare and angle.span is not None:
        size = abs(angle.value)
        if size >= FEWEST_DEGREES and size % FEWEST_DEGREES == 0:
            text = f"{call.op}({angle.span.text}) is of {angle.value:g} radians"
            help = f"write `{call.op}({angle.span.text} deg)` for degrees"
            found.warning("radians", text, call.span, help=help)


def _doubt_hue(call: Call, found: Diagnostics) -> None:
    """Warn of the hue of a bare number that is most likely meant in degrees, for a hue is told in turns."""
    (turns,) = call.args
    if isinstance(turns, Number) and turns.bare and turns.span is not None and abs(turns.value) >= FEWEST_DEGREES:
        text = f"hue({turns.span.text}) is of {turns.value:g} whole turns: a hue goes from 0, red, to 1, red again"
        help = f"write `hue({turns.span.text}/360)` for degrees"
        found.warning("turns", text, call.span, help=help)


def _doubt_range(call: Call, lookup: Lookup, found: Diagnostics) -> None:
    """Warn of two numbers behind `random` that can only be meant as the ends of a range: they are whole ones else."""
    texts = ["" if arg.span is None else arg.span.text for arg in call.args]
    try:
        low, high = map(float, texts)
    except ValueError:
        return
    if low < high and (low < 0 or not (low.is_integer() and high.is_integer())):
        text = f"`random({texts[0]}, {texts[1]})` is a number from 0 to 1, of the whole numbers {low:g} and {high:g}"
        copy = call.span is not None and isinstance(lookup(("i",), call.span), Number)
        which = "random(i)" if copy else "random(1)"
        help = f"a number from {low:g} to {high:g} is `mix({low:g}, {high:g}, {which})`"
        help += ", another one for each copy; in another component `random(i, 1)`" if copy else ""
        found.warning("chance-range", text, call.span, help=help)


def _constant(expr: Expr) -> bool:
    if isinstance(expr, Vector):
        return bool(expr.items) and all(_constant(item) for item in expr.items)
    return isinstance(expr, Number)


def _value(constant: Expr) -> Any:
    """The float of a number, the nested tuples of a vector of numbers."""
    if isinstance(constant, Vector):
        return tuple(_value(item) for item in constant.items)
    assert isinstance(constant, Number)
    return constant.value


def _bare(constant: Expr) -> bool:
    """Whether no number has a unit."""
    if isinstance(constant, Vector):
        return all(_bare(item) for item in constant.items)
    return isinstance(constant, Number) and constant.bare


def _finite(value: Any) -> bool:
    return all(_finite(item) for item in value) if isinstance(value, tuple) else math.isfinite(value)


def _literal(value: Any, expr: Expr, bare: bool) -> Expr:
    dimension = expr.type.dimension
    if isinstance(value, tuple):
        items = tuple(_literal(item, expr, bare) for item in value)
        return Vector(items, Type((len(items), *items[0].type.shape), dimension), expr.span)
    return Number(value, Type((), PLAIN if dimension is None and value != 0.0 else dimension), bare, expr.span)


def _report(node: Expr, parts: tuple[Expr, ...], error: MismatchError, lookup: Lookup, found: Diagnostics) -> None:
    """Report a type error at the arguments as written in this expression, not at a define that they name."""
    second = None if error.second is None else parts[error.second].span
    notes = [] if second is None else [Note("the other is here", second)]
    written = "" if node.span is None else node.span.text
    time = time_meant(written)
    if time is not None and node.span is not None and isinstance(lookup(("t",), node.span), Symbol):
        time = SECONDS
    message = "`t` behind a unit is a tonne" if time is not None and time != SECONDS else error.message
    if isinstance(node, Call) and node.op == "random" and len(parts) == len(ENDS) and all(one.span for one in parts):
        low, high = ("" if one.span is None else one.span.text for one in parts)
        help = f"write `mix({low}, {high}, random(1))`, of copies with their number, `random(i)`"
        found.error(error.code, error.message, parts[error.first].span or node.span, help=help)
        return
    help = time or "; ".join(filter(None, (error.help, _better(node, parts, error) or _by_time(parts, error))))
    found.error(error.code, message, parts[error.first].span or node.span, help=help or None, notes=notes)


def _by_time(parts: tuple[Expr, ...], error: MismatchError) -> str | None:
    """The help where one of two terms is a value times the time, and should be a rate: ``1 m + 0.1 m*time``."""
    both = [] if error.second is None else [parts[error.first], parts[error.second]]
    for one, other in zip(both, reversed(both), strict=True):
        text = None if one.span is None else _TIMED.fullmatch(one.span.text.strip())
        if text is not None and other.span is not None and re.search(rf"\d\s*{text[2]}$", other.span.text):
            return f"it grows by time: write `{text[1]}{text[2]}/s*time`"
    return None


def _better(node: Expr, parts: tuple[Expr, ...], error: MismatchError) -> str | None:
    """The help text with the whole expression as it should be written, one argument corrected."""
    if error.better is None:
        return None
    index, text = error.better
    whole, part = node.span, parts[index].span
    if whole is None or part is None or part.source is not whole.source:
        return f"write `{text}`"
    written = part.text if re.fullmatch(r"[\w.]+", part.text) else f"({part.text})"
    before, behind = whole.source.text[whole.start : part.start], whole.source.text[part.end : whole.end]
    return f"write `{' '.join((before + text.format(written) + behind).split())}`"
