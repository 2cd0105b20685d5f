"""Laws of expressions: text and tree, types, dimensions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pint
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from campaigns import examples
from expressions import POINTS, H, P, Q, T, bound, parsed, span_of, trees, valued
from sceneql.quantities import dimension as dim
from sceneql.quantities.derivative import differentiate
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Number, Symbol, Type, each_once
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.printing import show
from sceneql.quantities.rules import MismatchError

SYMBOLS: dict[str, Expr] = {"h": H, "time": T, "p": P, "cage.positions": POINTS, "q": Q, "dt": Symbol("dt", T.type)}
SYMBOLS |= {name: Symbol(name) for name in ("x", "y", "z")}


def code_of(text: str) -> str:
    with pytest.raises(ScriptError) as caught:
        bound(text, SYMBOLS)
    return caught.value.diagnostics[0].code


# --- text and tree ---------------------------------------------------------------------------------------------------


@given(trees)
@settings(max_examples=examples(400))
def test_what_is_shown_parses_to_the_same_tree(tree: Expr) -> None:
    text = show(tree)
    assume(len(text) <= 10_000)
    assert parsed(text) == tree


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("a + b*c", "a + (b*c)"),
        ("a - b - c", "(a - b) - c"),
        ("a/b/c", "(a/b)/c"),
        ("a^b^c", "a^(b^c)"),
        ("a**b", "a^b"),
        ("-a^2", "-(a^2)"),
        ("-2^2", "-(2^2)"),
        ("2^-a", "2^(-a)"),
        ("-a*b", "(-a)*b"),
        ("a*-b", "a*(-b)"),
        ("a < b + c", "a < (b + c)"),
        ("+a", "a"),
        ("1 m/dt", "(1 m)/dt"),
        ("2 m*h", "2 m*h"),
        ("2 m * h", "(2 m)*h"),
        ("1 m*min(a, b)", "(1 m)*min(a, b)"),
        ("1 N*m*x", "(1 N*m)*x"),
        ("k/2 m", "k/(2 m)"),
        ("5%", "5 %"),
        ("2m", "2 m"),
    ],
)
def test_precedence(text: str, same: str) -> None:
    assert parsed(text) == parsed(same)


def test_powers_of_literals() -> None:
    assert bound("-2^2") == Number(-4.0)
    assert bound("(-2)^2") == Number(4.0)
    assert bound("2^3^2") == Number(512.0)
    assert bound("2^-1") == Number(0.5)


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("2 kN/m", "2000 kg/s^2"),
        ("0 1.2 0 m", "[0 m, 1.2 m, 0 m]"),
        ("-4 0.15 0", "[-4, 0.15, 0]"),
        ("4 -3 1 m", "[4 m, -3 m, 1 m]"),
        ("0 1 2 1/s", "[0 1/s, 1 1/s, 2 1/s]"),
        ("30 -10 deg", "[30 deg, -10 deg]"),
        ("4 - 3", "(4) - (3)"),
        ("-20 degC", "253.15 K"),
        ("68 degF", "20 degC"),
        ("1.7 mm", "0.0017 m"),
        ("1e3 m", "1 km"),
        (".5 m", "50 cm"),
    ],
)
def test_whole_values(text: str, same: str) -> None:
    assert valued(text) == parsed(same)


def test_a_fraction_has_its_unit_as_a_whole_value_only() -> None:
    assert valued("1/60 s") == Number(1 / 60, Type((), dim.TIME), bare=False)
    assert bound("1/60 s + 0").type.dimension == dim.FREQUENCY


@pytest.mark.parametrize(
    ("text", "code", "caret", "help"),
    [
        ("", "syntax", "", None),
        ("(a", "syntax", "(", None),
        ("a b", "syntax", "b", "a*b"),
        ("2 (a)", "syntax", "(", "2*("),
        ("2 sin(a)", "syntax", "sin", "sin(...)"),
        ("1 2 + 3", "syntax", "2", "[a, b, c]"),
        ("a + ", "syntax", "", None),
        ("a = 2", "syntax", "=", "=="),
        ("a < b < c", "syntax", "<", "(a < b)*(b < c)"),
        ("[]", "syntax", "[]", None),
        ("cross(a, b).x", "syntax", ".", "component(..., 0)"),
        ("1e999", "syntax", "1e999", None),
        ("2 kn", "unknown-unit", "kn", "kN"),
        ("2 pi", "unknown-unit", "pi", "*pi"),
        ("1_000", "unknown-unit", "_000", None),
        ("2 m^x", "syntax", "^", "(2 m)^n"),
        ("5 degC*x", "offset-unit", "5 degC", "`5 K`"),
        ("5 degC/s", "offset-unit", "degC", "K"),
        ("[0, 1, 0] m", "unit-after-bracket", "m", "`0 1 0 m`"),
        ("[0, 1, h] kN/m", "unit-after-bracket", "kN/m", "`[0, 1, h]*(1 kN/m)`"),
        ("(1 + 2) m", "unit-after-bracket", "m", "`(1 + 2)*(1 m)`"),
        ("sinn(a)", "unknown-function", "sinn", "'sin'"),
        ("add(a, b)", "unknown-function", "add", None),
        ("clamp(a)", "wrong-arity", "clamp(a)", None),
        ("sin()", "wrong-arity", "sin()", None),
        ("(" * 101 + "a" + ")" * 101, "expression-too-deep", "(", "define"),
        ("-" * 200 + "a", "expression-too-deep", "-", None),
        ("+".join("a" * 102), "expression-too-deep", "+".join("a" * 102), "sum("),
        ("a" * 10_001, "expression-too-long", "a" * 10_001, None),
    ],
)
def test_errors_point_at_the_characters(text: str, code: str, caret: str, help: str | None) -> None:
    with pytest.raises(ScriptError) as caught:
        valued(text)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == code
    assert diagnostic.span is not None
    assert diagnostic.span.text == caret
    if help is not None:
        assert help in (diagnostic.help or "")


# --- types -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("h + time", "dimension-mismatch"),
        ("h + 0.1", "dimension-mismatch"),
        ("sin(h)", "dimension-mismatch"),
        ("h < time", "dimension-mismatch"),
        ("h^x", "dimension-mismatch"),
        ("2^h", "dimension-mismatch"),
        ("where(h, 1, 2)", "dimension-mismatch"),
        ("[h, time]", "dimension-mismatch"),
        ("clamp(h, 0, 1)", "dimension-mismatch"),
        ("about(p, h)", "dimension-mismatch"),
        ("p + [1 m, 2 m]", "shape-mismatch"),
        ("cross(p, [1, 2])", "shape-mismatch"),
        ("dot(p, h)", "shape-mismatch"),
        ("component(p, 3)", "shape-mismatch"),
        ("component(p, x)", "shape-mismatch"),
        ("[p, h]", "shape-mismatch"),
        ("h.x", "no-component"),
        ("p.w", "no-component"),
        ("nothing", "unknown-name"),
        ("nothing.x", "unknown-name"),
    ],
)
def test_mismatches(text: str, code: str) -> None:
    assert code_of(text) == code


def test_a_mismatch_shows_both_places_and_the_cure() -> None:
    with pytest.raises(ScriptError) as caught:
        bound("2*h + 0.1", SYMBOLS)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.message == "cannot add a length (m) and a plain number"
    assert diagnostic.span is not None
    assert diagnostic.span.text == "2*h"
    assert [note.span.text for note in diagnostic.notes] == ["0.1"]
    assert diagnostic.help == "write `2*h + 0.1 m`"


def test_all_mismatches_are_reported_at_once() -> None:
    with pytest.raises(ScriptError) as caught:
        bound("(h + time)*(h - x) + nothing", SYMBOLS)
    assert len(caught.value.diagnostics) == 3


@pytest.mark.parametrize(
    ("text", "shape", "dimension"),
    [
        ("h + 0", (), dim.LENGTH),
        ("p.y", (), dim.LENGTH),
        ("p*2 + [0, 0, 1 m]", (3,), dim.LENGTH),
        ("cage.positions - p", (None, 3), dim.LENGTH),
        ("cage.positions.x", (None,), dim.LENGTH),
        ("length(cage.positions)", (None,), dim.LENGTH),
        ("max(length(cage.positions))", (), dim.LENGTH),
        ("mean(cage.positions)", (3,), dim.LENGTH),
        ("dot(p, p)", (), dim.AREA),
        ("cross(p, [0, 0, 1])", (3,), dim.LENGTH),
        ("h^(3/2)", (), dim.LENGTH ** dim.Fraction(3, 2)),
        ("sqrt(h/(9.81 m/s^2))", (), dim.TIME),
        ("h < 1 m", (), dim.PLAIN),
        ("atan2(p.y, p.x)", (), dim.PLAIN),
        ("[p, p]", (2, 3), dim.LENGTH),
        ("turn(about(p, 30 deg), q)", (4,), dim.PLAIN),
        ("relative_drift(h)", (), dim.PLAIN),
        ("at(h, 2 s)", (), dim.LENGTH),
        ("q.w", (), dim.PLAIN),
        ("pi*h", (), dim.LENGTH),
    ],
)
def test_types(text: str, shape: Any, dimension: dim.Dimension) -> None:
    assert bound(text, SYMBOLS).type == Type(shape, dimension)


def test_a_define_goes_before_a_constant() -> None:
    assert bound("e") == Number(math.e)
    assert bound("e", {"e": Number(0.8)}) == Number(0.8)


def test_what_is_shared_stays_shared_and_is_no_work_twice() -> None:
    expr: Expr = Symbol("x")
    for _ in range(200):
        expr = bound("a + a", {"a": expr})
        assert isinstance(expr, Call)
        assert expr.args[0] is expr.args[1]
    # As a tree these would be 2^200 nodes.
    assert len(each_once(expr)) == 201
    assert evaluate(expr, {Symbol("x"): 1.0}) == 2.0**200
    assert evaluate(differentiate(expr, Symbol("x")), {}) == 2.0**200


PINT = pint.UnitRegistry()
SAMPLES = {"x": (1.5, "1"), "h": (2.0, "meter"), "time": (3.0, "second"), "k": (4.0, "newton/meter"), "m": (0.5, "kg")}
TYPED = {
    "x": Symbol("x"),
    "h": H,
    "time": T,
    "k": Symbol("k", Type((), dim.STIFFNESS)),
    "m": Symbol("m", Type((), dim.MASS)),
}
OURS_AND_THEIRS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "abs": abs,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "exp": np.exp,
    "hypot": np.hypot,
    "max": np.maximum,
    "lt": lambda a, b: PINT.Quantity(float(a < b)),
    "atan2": np.arctan2,
}
leaves = st.sampled_from(sorted(TYPED))
nested = st.recursive(
    leaves, lambda inner: st.tuples(st.sampled_from(sorted(OURS_AND_THEIRS)), inner, inner), max_leaves=6
)


def both(tree: Any) -> tuple[Expr, pint.Quantity]:
    if isinstance(tree, str):
        value, unit = SAMPLES[tree]
        return TYPED[tree], PINT.Quantity(value, unit)
    op, left, right = tree
    pairs = [both(left)] if OPERATIONS[op].most == 1 else [both(left), both(right)]
    args = tuple(pair[0] for pair in pairs)
    error: Exception | None = None
    try:
        with np.errstate(all="ignore"):
            theirs = OURS_AND_THEIRS[op](*(pair[1] for pair in pairs))
    except pint.DimensionalityError as found:
        error = found
    except ZeroDivisionError:
        assume(False)
    try:
        type_ = OPERATIONS[op].rule(args)
    except MismatchError:
        assert error is not None, "pint allows it"
        raise
    assert error is None, "pint does not allow it"
    return Call(op, args, type_), theirs


@given(nested)
@settings(max_examples=examples(300))
def test_dimensions_and_values_are_what_pint_says(tree: Any) -> None:
    try:
        ours, theirs = both(tree)
    except MismatchError:
        return
    found = theirs.to_base_units()
    powers = dict(found.unit_items())
    base = ("meter", "kilogram", "second")
    assert ours.type.dimension is not None
    assert [float(e) for e in ours.type.dimension.exponents[:3]] == pytest.approx(
        [float(powers.get(b, 0)) for b in base]
    )
    env = {TYPED[name]: value for name, (value, _) in SAMPLES.items()}
    wanted = float(found.magnitude)
    assert evaluate(ours, env) == pytest.approx(wanted, rel=1e-9, nan_ok=True) or not math.isfinite(wanted)


def test_spans_stand_at_the_characters() -> None:
    expr = parsed("a + sin(b.x)")
    assert isinstance(expr, Call)
    assert [part.span.text for part in (expr, *expr.args) if part.span] == ["a + sin(b.x)", "a", "sin(b.x)"]
    assert span_of("a").text == "a"


@pytest.mark.parametrize("arrays", [False, True])
def test_an_item_that_a_list_has_not_is_refused(arrays):
    call = Call("item", (POINTS, Number(2.0)))
    points = ((0.0, 1.0, 2.0), (3.0, 4.0, 5.0))
    with pytest.raises(ValueError, match=r"there is no item 2 in a list of 2: they count from 0"):
        evaluate(call, {POINTS: np.array(points) if arrays else points}, arrays=arrays)
