"""Random expressions for the tests of the quantities."""

from __future__ import annotations

from collections.abc import Mapping

from hypothesis import strategies as st

from sceneql.quantities import dimension as dim
from sceneql.quantities.bind import bind, component
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics
from sceneql.quantities.expression import Call, Expr, Link, Name, Number, Symbol, Type, Vector
from sceneql.quantities.operations import FUNCTIONS, OPERATIONS
from sceneql.quantities.parser import parse_expression, parse_value
from sceneql.quantities.span import Source, Span


def span_of(text: str) -> Span:
    return Span(Source("test.yaml", text), 0, len(text))


def parsed(text: str) -> Expr:
    return parse_expression(text, span_of(text))


def valued(text: str) -> Expr:
    return parse_value(text, span_of(text))


def bound(text: str, symbols: Mapping[str, Expr] | None = None) -> Expr:
    """Parsed and bound; raises ScriptError."""
    found = Diagnostics()
    known = symbols or {}

    def lookup(parts: tuple[str, ...], span: Span) -> Expr | Diagnostic:
        name, first = ".".join(parts), ".".join(parts[:-1])
        if name not in known and first in known:
            return component(known[first], first, parts[-1], span)
        return known.get(name) or Diagnostic("unknown-name", f"nothing is called '{name}'", span)

    expr = bind(valued(text), lookup, found)
    found.raise_errors()
    assert expr is not None
    return expr


H = Symbol("h", Type((), dim.LENGTH))
T = Symbol("time", Type((), dim.TIME))
P = Symbol("p", Type((3,), dim.LENGTH))
POINTS = Link("cage", "positions", Type((None, 3), dim.LENGTH))
Q = Symbol("q", Type((4,)))

DIMENSIONS = (dim.PLAIN, dim.LENGTH, dim.TIME, dim.FORCE, dim.STIFFNESS, dim.DAMPING, dim.LENGTH**5 / dim.TIME)


def _literal(value: float, dimension: dim.Dimension | None) -> Number:
    if dimension is None:
        return Number(value, Type((), None) if value == 0 else Type())
    return Number(value, Type((), dimension), bare=False)


finite = st.floats(allow_nan=False, allow_infinity=False)
literals = st.builds(_literal, finite, st.sampled_from((None, *DIMENSIONS)))
words = st.sampled_from(["a", "m", "s", "h", "time", "a'", "b''", "x", "N", "min", "e", "ψ"])
names = st.builds(lambda parts: Name(tuple(parts)), st.lists(words, min_size=1, max_size=3))


def _call(op: str, args: list[Expr]) -> Expr:
    expr = Call(op, tuple(args[: len(args) if op in ("min", "max") else OPERATIONS[op].least]))
    if op == "neg" and isinstance(args[0], Number):
        return Number(-args[0].value, args[0].type, args[0].bare)
    return expr


def _deeper(inner: st.SearchStrategy[Expr]) -> st.SearchStrategy[Expr]:
    many = st.lists(inner, min_size=3, max_size=4)
    signs = st.sampled_from([name for name, operation in OPERATIONS.items() if operation.infix])
    return (
        st.builds(_call, signs, many)
        | st.builds(_call, st.sampled_from(FUNCTIONS), many)
        | st.builds(lambda items: Vector(tuple(items)), st.lists(inner, min_size=1, max_size=3))
    )


trees = st.recursive(literals | names, _deeper, max_leaves=20)
"""Trees as the parser makes them."""
