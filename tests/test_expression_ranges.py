"""Ranges of expressions hold every value that their symbols give, and are narrow where nothing is said twice."""

import itertools
import math

import pytest

from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Symbol
from sceneql.quantities.intervals import range_of
from sceneql.quantities.parser import parse_value
from sceneql.quantities.span import Source, Span

BOX = {"x": (-0.5, 0.5), "y": (0.95, 1.05), "z": (-2.0, 0.0)}
CASES = {
    "x": (-0.5, 0.5),
    "3*x - y": (-2.55, 0.55),
    "x*z": (-1.0, 1.0),
    "1/y": (1 / 1.05, 1 / 0.95),
    "1/x": (-math.inf, math.inf),
    "x^2 + z^2": (0.0, 4.25),
    "abs(z - 1)": (1.0, 3.0),
    "sqrt(y)": (math.sqrt(0.95), math.sqrt(1.05)),
    "hypot(x, z)": (0.0, math.hypot(0.5, 2.0)),
    "max(x, z)": (-0.5, 0.5),
    "min(x, y, z)": (-2.0, 0.0),
    "x < -0.6": (0.0, 0.0),
    "x >= -0.5": (1.0, 1.0),
    "(x > 0)*(y > 2)": (0.0, 0.0),
    "x == 0.2": (0.0, 1.0),
    "y == 2": (0.0, 0.0),
    "-x > z": (0.0, 1.0),
    "sin(x)": (-math.inf, math.inf),
}


def parsed(text):
    found = Diagnostics()
    symbols = {name: Symbol(name) for name in BOX}
    span = Span(Source("text", text), 0, len(text))
    expr = bind(parse_value(text, span), lambda parts, place: symbols[".".join(parts)], found)
    found.raise_errors()
    return expr


@pytest.mark.parametrize("text", CASES)
def test_a_range_is_narrow_and_holds_all_values(text):
    expr = parsed(text)
    low, high = range_of(expr, BOX)
    assert (low, high) == pytest.approx(CASES[text])
    ends = [[a + k / 8 * (b - a) for k in range(9)] for a, b in BOX.values()]
    for place in itertools.product(*ends):
        value = evaluate(expr, dict(zip(map(Symbol, BOX), place, strict=True)))
        assert low - 1e-12 <= value <= high + 1e-12
