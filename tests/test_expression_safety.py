"""A script's text is data: nothing in it opens, runs or imports anything, and none of it takes long."""

from __future__ import annotations

import sys
import time
from typing import Any

import pytest

from expressions import span_of
from sceneql.quantities.bind import bind
from sceneql.quantities.derivative import differentiate
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Symbol, Type
from sceneql.quantities.parser import parse_value
from sceneql.quantities.printing import show
from sceneql.quantities.span import Span
from sceneql.quantities.units import parse_unit

ATTACKS = [
    "__import__('os').system('x')",
    "().__class__.__bases__[0].__subclasses__()",
    "x.__class__",
    "x.__class__.__mro__",
    "open('/etc/passwd')",
    "eval('1')",
    "exec(x)",
    "lambda: x",
    "[a for a in x]",
    "f'{x}'",
    "x if x else x",
    "import os",
    "x; y",
    "print(x)",
    "getattr(x, x)",
    "{x: x}",
    "x\n__import__('os')",
    "9^9^9^9",
    "9**9**9**9**9",
    "(1e308*1e308)^(1e308)",
    "1/0",
    "0^-1",
    "(-8)^(1/3)",
    "random(1e308, -1e308)",
    "(2 m)^(1/3)",
    "((((((2 m)^100)^100)^100)^100)^100)",
    "1e" + "9" * 2000,
    "9" * 9_000,
    "1e-" + "9" * 2000 + " m",
    "0." + "0" * 9_000 + "1 m",
    "2 m" + "^2" * 1000,
    "2 " + "*".join(["Mm^20"] * 1000),
    "(" * 5_000,
    "[" * 5_000 + "]" * 5_000,
    "-" * 9_999 + "x",
    "^".join("x" * 4_000),
    "+".join("x" * 4_000),
    "sin(" * 2_400 + "x",
    ", ".join("x" * 3_000),
    "max(" + ", ".join("x" * 3_000) + ")",
    "0 " * 4_900 + "m",
    "x" * 1_000_000,
    "x" + "'" * 9_000,
    ".".join("x" * 4_000),
]
X = Symbol("x", Type())
FORBIDDEN = (
    "open",
    "exec",
    "compile",
    "import",
    "socket",
    "subprocess",
    "os.",
    "shutil",
    "ctypes",
    "marshal",
    "pickle",
)

_seen: list[str] = []
_watching = False


def _watch(event: str, args: tuple[Any, ...]) -> None:
    if _watching and event.startswith(FORBIDDEN):
        _seen.append(event)


def lookup(parts: tuple[str, ...], span: Span) -> Expr | None:
    return X if parts == ("x",) else None


def whole_way(text: str) -> None:
    """Everything that is done with a text."""
    for work in (_as_expression, _as_unit):
        try:
            work(text)
        except ScriptError as error:
            str(error)


def _as_expression(text: str) -> None:
    found = Diagnostics()
    tree = parse_value(text, span_of(text))
    show(tree)
    expr = bind(tree, lookup, found)
    if expr is not None:
        evaluate(expr, {X: 2.0})
        if len(expr.type.shape) < 2:
            differentiate(expr, X)


def _as_unit(text: str) -> None:
    parse_unit(text, span_of(text))


@pytest.fixture(scope="module")
def hook() -> None:
    sys.addaudithook(_watch)
    whole_way("max(x, 2 kN/m)")  # the first call may import; the rest may not
    whole_way("sqrt(x)*hue(x)")


@pytest.mark.parametrize("text", ATTACKS, ids=[text[:30] for text in ATTACKS])
def test_nothing_is_opened_run_or_imported(hook: None, text: str) -> None:
    global _watching
    _seen.clear()
    start = time.process_time()
    _watching = True
    try:
        whole_way(text)
    finally:
        _watching = False
    assert not _seen
    assert time.process_time() - start < 5.0


def test_the_hook_would_see_it(hook: None) -> None:
    global _watching
    _seen.clear()
    _watching = True
    try:
        compile("1", "x", "eval")
    finally:
        _watching = False
    assert _seen


def test_a_deep_chain_of_defines_is_no_deep_recursion() -> None:
    expr: Expr = X
    for _ in range(4_000):
        expr = Call("sin", (Call("add", (expr, X)),))
    assert abs(evaluate(expr, {X: 0.1})) <= 1.0
    assert isinstance(evaluate(differentiate(expr, X), {X: 0.1}), float)
    assert len(show(Call("add", (X, X)))) > 0
