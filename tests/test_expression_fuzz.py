"""Units and expressions made of anything: only located errors may come out. SCENEQL_FUZZ says how many."""

from __future__ import annotations

import math
import os
import random
from collections.abc import Callable

import pytest

from expressions import POINTS, H, P, Q, T, span_of
from sceneql.quantities.bind import bind
from sceneql.quantities.derivative import differentiate
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Link, Symbol, Type
from sceneql.quantities.operations import FUNCTIONS
from sceneql.quantities.parser import parse_expression, parse_value
from sceneql.quantities.printing import show
from sceneql.quantities.span import Span
from sceneql.quantities.unit_table import KNOWN_UNITS
from sceneql.quantities.units import parse_unit

COUNT = int(os.environ.get("SCENEQL_FUZZ", "5000"))
X = Symbol("x", Type())
MEANINGS = {"h": H, "time": T, "p": P, "q": Q, "x": X, "cage.positions": POINTS}
SIGNS = [
    "+",
    "-",
    "*",
    "/",
    "^",
    "**",
    "(",
    ")",
    "[",
    "]",
    ",",
    "<",
    "<=",
    "==",
    "=",
    ".",
    "'",
    '"',
    "%",
    "·",
    " ",
    "  ",
    "\n",
]
ODD = [
    "\0",
    "\ud800",
    "é",
    "ψ",
    "²",
    "½",
    "٣",
    "￿",
    "\u202e",
    "∞",
    "__",
    "\\",
    "#",
    "{",
    "}",
    "!",
    "|",
    "&",
    "@",
    "`",
    "~",
]
NUMBERS = [
    "0",
    "1",
    "2",
    "-1",
    ".5",
    "1e3",
    "1e308",
    "1e-320",
    "9" * 30,
    "1e999",
    "0x10",
    "1_000",
    "1.2.3",
    "1e",
    "007",
]


def made(chosen: random.Random, words: list[str]) -> str:
    kind = chosen.random()
    if kind < 0.1:
        return "".join(chr(chosen.randrange(0x110000)) for _ in range(chosen.randrange(12)))
    if kind < 0.2:
        return chosen.choice(["(", "[", "-", "x^", "sin(", "x*(", "m^"]) * chosen.randrange(300)
    pieces = (
        chosen.choice(chosen.choice([words, words, NUMBERS, SIGNS, SIGNS, ODD])) for _ in range(chosen.randrange(1, 14))
    )
    return chosen.choice(["", " "]).join(pieces)


def sensible(chosen: random.Random, depth: int) -> str:
    """A text that mostly parses and often binds."""
    if depth == 0 or chosen.random() < 0.2:
        return chosen.choice(
            ["x", "h", "time", "p", "p.x", "cage.positions", "q", "2", "0", "0.5", "3 m", "1 s", "[1, 2, 3]", "pi"]
        )
    inner = [sensible(chosen, depth - 1) for _ in range(3)]
    if chosen.random() < 0.5:
        return f"({inner[0]}) {chosen.choice(['+', '-', '*', '/', '^', '<'])} ({inner[1]})"
    return f"{chosen.choice(FUNCTIONS)}({', '.join(inner[: chosen.choice([1, 1, 2, 2, 3])])})"


def located(text: str, work: Callable[[str], object]) -> None:
    diagnostics = []
    try:
        work(text)
    except ScriptError as error:
        diagnostics = list(error.diagnostics) or [Diagnostic("", "nothing is said", None)]
    for diagnostic in diagnostics:
        assert diagnostic.code
        assert diagnostic.span is not None
        assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(text) + 1
        assert str(diagnostic)


def test_units() -> None:
    chosen = random.Random(1)
    words = [*KNOWN_UNITS, "^2", "^-3", "^(1/2)", "^99", "1/", "^", "degC"]
    for _ in range(COUNT):
        text = made(chosen, words)
        located(text, lambda text: math.isfinite(parse_unit(text, span_of(text)).scale))


def lookup(parts: tuple[str, ...], span: Span) -> Expr | None:
    return MEANINGS.get(".".join(parts))


def depth(value: object) -> int:
    return 1 + depth(value[0]) if isinstance(value, tuple) else 0


def whole_way(text: str) -> None:
    """Parse, bind, evaluate and differentiate."""
    span = span_of(text)
    found = Diagnostics()
    tree = parse_value(text, span)
    shown = show(tree)
    if len(shown) < 10_000:
        assert parse_expression(shown, span_of(shown)) == tree
    expr = bind(tree, lookup, found)
    found.raise_errors()
    if expr is None:
        return
    try:
        value = evaluate(expr, VALUES)
        derived = differentiate(expr, X) if len(expr.type.shape) < 2 and None not in expr.type.shape else None
    except TypeError as error:
        # What has a meaning only in time, or no derivative, says so.
        if "over time" in str(error) or "derivative" in str(error):
            return
        raise
    except ValueError as error:
        if "there is no item" in str(error):  # how long a list is is known in a run alone
            return
        raise
    assert depth(value) == len(expr.type.shape)
    if derived is not None:
        evaluate(derived, VALUES)


VALUES: dict[Symbol | Link, object] = {H: 2.0, T: 0.5, P: (1.0, -2.0, 0.0), Q: (1.0, 0.0, 0.0, 0.0), X: 0.7}
VALUES[POINTS] = ((0.0, 1.0, 2.0), (3.0, 4.0, 5.0))


@pytest.mark.parametrize("maker", ["anything", "sensible"])
def test_expressions(maker: str) -> None:
    chosen = random.Random(2)
    words = [*FUNCTIONS, *MEANINGS, *KNOWN_UNITS[:40], "p.x", "a'", "clamp(", "[1, 2]", "1/60 s", "0 1 0 m", "2 kN/m"]
    for _ in range(COUNT // 2):
        text = made(chosen, words) if maker == "anything" else sensible(chosen, 4)
        located(text, whole_way)
