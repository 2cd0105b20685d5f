"""Laws of evaluation and differentiation: evaluators agree, and derivatives are limits of differences."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from campaigns import examples
from expressions import POINTS, H, bound, parsed, trees
from sceneql.quantities import chance
from sceneql.quantities.bind import bind
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Name, Number, Symbol, Type, Vector, each_once
from sceneql.quantities.operations import FLOATS, OPERATIONS
from sceneql.quantities.printing import show
from sceneql.quantities.simplify import simplify

# --- evaluators ------------------------------------------------------------------------------------------------------

SHAPES = {
    "dot": [(3,), (3,)], "cross": [(3,), (3,)], "length": [(3,)], "distance": [(3,), (3,)], "normalize": [(3,)],
    "about": [(3,), ()], "turn": [(4,), (4,)], "component": [(3,), ()], "item": [(None, 3), ()],
    "sum": [(4,)], "mean": [(4,)], "norm": [(4,)], "count": [(4,)],
}  # fmt: skip
SHAPES |= {name: [(3,)] for name in OPERATIONS if name.startswith("euler_")}
ORDINARY = [name for name, operation in OPERATIONS.items() if not (operation.series or operation.part_of)]
numbers = st.floats(-4, 4) | st.sampled_from([0.0, 1.0, -1.0, 0.5, 1e300, math.inf, -math.inf, math.nan])


def call_of(name: str, prefix: tuple[int | None, ...] = ()) -> tuple[Call, list[Symbol]]:
    shapes = SHAPES.get(name, [()] * OPERATIONS[name].least if name not in ("min", "max") else [(), ()])
    symbols = [Symbol(f"s{k}", Type((*prefix, *shape))) for k, shape in enumerate(shapes)]
    args: tuple[Expr, ...] = tuple(symbols)
    if name in ("component", "item"):
        symbols, args = symbols[:1], (symbols[0], Number(1.0))
    return Call(name, args, OPERATIONS[name].rule(args)), symbols


def value_of(shape: tuple[int | None, ...], draw: Any, size: int = 2) -> Any:
    if not shape:
        return draw(numbers)
    return tuple(value_of(shape[1:], draw, size) for _ in range(size if shape[0] is None else shape[0]))


def same(a: Any, b: Any) -> None:
    np.testing.assert_allclose(np.asarray(a, float), np.asarray(b, float), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ORDINARY)
@given(data=st.data())
@settings(max_examples=25)
def test_python_and_numpy_agree(name: str, data: st.DataObject) -> None:
    reduces = name in ("sum", "mean", "norm", "count")
    for prefix in ((),) if reduces or name == "noise" else ((), (None,)):
        call, symbols = call_of(name, prefix)
        env = {symbol: value_of(symbol.type.shape, data.draw) for symbol in symbols}
        plain = evaluate(call, env)
        if not (name == "random" and any(abs(v) > 1e6 for v in np.ravel(list(env.values())) if math.isfinite(v))):
            same(plain, evaluate(call, env, arrays=True))
        # Many samples at once are the same as one after another.
        rows = [env, {symbol: value_of(symbol.type.shape, data.draw) for symbol in symbols}]
        batch = {symbol: np.array([row[symbol] for row in rows]) for symbol in symbols}
        if not reduces:
            same(evaluate(call, batch, arrays=True), [evaluate(call, row) for row in rows])


@pytest.mark.parametrize("name", ["min", "max", "sum", "mean", "norm", "count"])
def test_reductions(name: str) -> None:
    values = np.array([[1.0, 5.0, -2.0], [4.0, 2.0, 0.5]])
    numpy = {"norm": np.linalg.norm, "count": len}.get(name, getattr(np, name, None))
    assert numpy is not None
    for arrays in (False, True):
        column = Symbol("c", Type((None,)))
        points = Symbol("p", Type((None, 3)))
        for symbol, value in ((column, values[:, 0]), (points, values)):
            call = Call(name, (symbol,), OPERATIONS[name].rule((symbol,)))
            wanted = numpy(value) if name in ("norm", "count") else numpy(value, axis=0)
            same(evaluate(call, {symbol: value}, arrays), wanted)
    # A series of single values is taken over the time.
    symbol = Symbol("energy")
    call = Call(name, (symbol,), OPERATIONS[name].rule((symbol,)))
    same(evaluate(call, {symbol: values[:, 0]}, arrays=True), numpy(values[:, 0]))


def test_empty_lists() -> None:
    points = Symbol("p", Type((None, 3)))
    for arrays in (False, True):
        env = {points: np.zeros((0, 3)) if arrays else ()}
        for name, wanted in (("sum", 0.0), ("mean", math.nan), ("max", math.nan)):
            same(evaluate(Call(name, (points,), OPERATIONS[name].rule((points,))), env, arrays), [wanted] * 3)


@given(st.sampled_from([n for n in ORDINARY if OPERATIONS[n].primitive]), st.lists(numbers, min_size=3, max_size=3))
@settings(max_examples=examples(500))
def test_floats_never_raise(name: str, args: list[float]) -> None:
    assert isinstance(
        getattr(FLOATS, name)(*args[: max(2 if name in ("min", "max") else 1, OPERATIONS[name].least)]), float
    )


def test_lists_of_different_lengths_are_an_error() -> None:
    a, b = Symbol("a", Type((None,))), Symbol("b", Type((None,)))
    for arrays in (False, True):
        with pytest.raises(ValueError, match=r"length|shape|broadcast"):
            evaluate(Call("add", (a, b), a.type), {a: (1.0, 2.0), b: (1.0, 2.0, 3.0)}, arrays)


def test_philox_known_answers() -> None:
    # The vectors of the authors' own library Random123, kat_vectors, philox2x32 10.
    assert chance.philox(0, 0, 0) == (0xFF1DAE59, 0x6CD10DF2)
    assert chance.philox(0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF) == (0x2C3F628B, 0xAB4FD7AD)
    assert chance.philox(0x243F6A88, 0x85A308D3, 0x13198A2E) == (0xDD7CE038, 0xF62A4C12)


def test_random_is_uniform_and_the_same_in_numpy() -> None:
    call, (i,) = call_of("random")
    counters = np.arange(-2000.0, 2000.0)
    drawn = evaluate(call, {i: counters}, arrays=True)
    np.testing.assert_array_equal(drawn, [chance.random(c) for c in counters])
    assert 0.0 <= drawn.min() < drawn.max() < 1.0
    assert abs(drawn.mean() - 0.5) < 4 * math.sqrt(1 / 12 / len(drawn))
    assert abs(np.corrcoef(drawn[1:], drawn[:-1])[0, 1]) < 0.07


A, Q, R = Symbol("a", Type((3,))), Symbol("q", Type((4,))), Symbol("r", Type((4,)))


AXES = {"x": "[2, 0, 0]", "y": "[0, 0.1, 0]", "z": "[0, 0, 3 m]"}


def turned(order: str, angles: tuple[float, ...]) -> np.ndarray:
    """The matrix of intrinsic rotations, from the three matrices of elementary turns."""
    result = np.eye(3)
    for axis, angle in zip(order, angles, strict=True):
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = math.cos(angle)
        turn[i, j], turn[j, i] = -math.sin(angle), math.sin(angle)
        result = result @ turn
    return result


def matrix(q: tuple[float, ...]) -> np.ndarray:
    """The matrix of a unit quaternion."""
    w, v = q[0], np.array(q[1:])
    across = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * across + 2 * across @ across


angles = st.floats(-7, 7)
triples = st.tuples(angles, angles, angles)


@given(st.sampled_from([n for n in OPERATIONS if n.startswith("euler_")]), triples)
def test_euler_angles_are_intrinsic_rotations(name: str, given: tuple[float, float, float]) -> None:
    same(matrix(evaluate(bound(f"{name}(a)", {"a": A}), {A: given})), turned(name[-3:], given))


@given(triples, triples)
def test_a_turn_is_the_second_then_the_first(first: tuple[float, ...], second: tuple[float, ...]) -> None:
    turns = [evaluate(bound("euler_xyz(a)", {"a": A}), {A: angles}) for angles in (first, second)]
    product = evaluate(bound("turn(a, b)", {"a": Q, "b": R}), {Q: turns[0], R: turns[1]})
    same(matrix(product), matrix(turns[0]) @ matrix(turns[1]))


@given(st.sampled_from("xyz"), angles)
def test_a_turn_about_an_axis_of_any_length(axis: str, angle: float) -> None:
    text = f"about({AXES[axis]}, angle)"
    same(matrix(evaluate(bound(text, {"angle": Symbol("angle")}), {Symbol("angle"): angle})), turned(axis, (angle,)))


def test_hue_is_red_green_blue_and_smooth() -> None:
    for h, color in ((0.0, (1, 0, 0)), (1 / 3, (0, 1, 0)), (2 / 3, (0, 0, 1)), (1.0, (1, 0, 0)), (-2 / 3, (0, 1, 0))):
        assert evaluate(bound(f"hue({h})"), {}) == pytest.approx(color, abs=1e-12) if h >= 0 else True
    call, (h,) = call_of("hue")
    colors = evaluate(call, {h: np.linspace(-1, 2, 3001)}, arrays=True)
    assert colors.min() >= 0.0
    assert colors.max() <= 1.0
    np.testing.assert_allclose(colors.max(axis=1), 1.0, atol=1e-12)
    assert np.abs(np.diff(colors, 2, axis=0)).max() < 5e-4


# --- derivatives -----------------------------------------------------------------------------------------------------

INSIDE = {
    "acos": (-0.9, 0.9),
    "asin": (-0.9, 0.9),
    "sqrt": (0.2, 3),
    "log": (0.2, 3),
    "log10": (0.2, 3),
    "pow": (0.3, 3),
}
DERIVED = [n for n in ORDINARY if OPERATIONS[n].partials is not None or OPERATIONS[n].formula is not None]
NOT_NEAR_ZERO = ("div", "mod", "normalize", "length", "about", "norm", "hypot", "atan2", "abs", "sign", "tan")


@pytest.mark.parametrize("name", [*DERIVED, "component"])
@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10)
def test_derivatives_are_central_differences(name: str, seed: int) -> None:
    call, symbols = call_of(name)
    low, high = INSIDE.get(name, (-2.0, 2.0))
    chosen = np.random.default_rng(seed)
    env: dict[Symbol, Any] = {}
    for symbol in symbols:
        drawn = chosen.uniform(low, high, symbol.type.shape or 1)
        if name in NOT_NEAR_ZERO:
            drawn += np.copysign(0.3, drawn)
        env[symbol] = tuple(drawn) if symbol.type.shape else float(drawn[0])
    step = 1e-5
    for symbol in symbols:
        for k in range(symbol.type.shape[0] or 0 if symbol.type.shape else 1):
            by = Call("component", (symbol, Number(float(k)))) if symbol.type.shape else symbol

            def moved(by_how_much: float, symbol: Symbol = symbol, k: int = k) -> Any:
                value = env[symbol]
                if isinstance(value, tuple):
                    changed: Any = (*value[:k], value[k] + by_how_much, *value[k + 1 :])
                else:
                    changed = value + by_how_much
                return np.asarray(evaluate(call, {**env, symbol: changed}), float)

            below, here, above = moved(-step), moved(0.0), moved(step)
            # Kinks, jumps and poles have no central difference.
            assume(np.all(np.abs((above - here) - (here - below)) < 1e-7) and np.all(np.abs(above - below) < 1e-2))
            slope = evaluate(differentiate(call, by), env)
            np.testing.assert_allclose(slope, (above - below) / (2 * step), rtol=1e-5, atol=1e-6)


# Most of the trees have no value at a place, or a kink near it: that many are passed over is no fault.
@given(trees, st.floats(0.3, 2))
@example(Call("sin", (Call("add", (Name(("x",)), Number(1e20))),)), 1.0)
@settings(max_examples=60, suppress_health_check=[HealthCheck.filter_too_much])
def test_derivatives_of_random_expressions(tree: Expr, at: float) -> None:
    x = Symbol("x")
    text = show(tree)
    found = Diagnostics()
    plain = bind(parsed(text), lambda parts, span: x, found) if len(text) < 10_000 else None
    assume(plain is not None and plain.type.shape == ())
    assert plain is not None
    try:
        slope = differentiate(plain, x)
        rows = [evaluate(plain, {x: at + d}) for d in (-1e-6, 0.0, 1e-6)]
    except TypeError:
        return  # a series, which has neither value nor derivative here
    assume(all(abs(row) < 1e6 for row in rows))
    # The moves of 1e-6 are lost in a number that is too large on the way, as in sin(x + 1e20).
    moved = [evaluate(part, {x: at}) for part in each_once(plain) if x in each_once(part)]
    assume(not any(np.any(np.abs(value) >= 1e6) for value in moved))
    value = evaluate(slope, {x: at})
    assume(math.isfinite(value) and abs(value) < 1e4 and abs(rows[2] - 2 * rows[1] + rows[0]) < 1e-8)
    assert value == pytest.approx((rows[2] - rows[0]) / 2e-6, rel=1e-3, abs=1e-3)


def test_derivatives_are_simple() -> None:
    x, y = Symbol("x"), Symbol("y")
    assert differentiate(bound("3*x + y", {"x": x, "y": y}), x) == Number(3.0)
    assert differentiate(bound("x*y", {"x": x, "y": y}), x) == y
    assert differentiate(bound("x*y", {"x": x, "y": y}), H) == Number(0.0)
    assert differentiate(bound("sin(x)", {"x": x}), x) == Call("cos", (x,))
    assert differentiate(bound("[x, 2*x, y]", {"x": x, "y": y}), x) == Vector(
        (Number(1.0), Number(2.0), Number(0.0)), Type((3,))
    )


def test_a_branch_that_is_not_taken_does_not_spoil_the_derivative() -> None:
    x = Symbol("x")
    slope = differentiate(bound("where(x > 0, sqrt(x), 0)", {"x": x}), x)
    assert evaluate(slope, {x: 0.0}) == 0.0


def test_what_has_no_derivative_says_so() -> None:
    points = Symbol("x", Type((None,)))
    with pytest.raises(TypeError, match="derivative"):
        differentiate(Call("sum", (Vector((Call("final", (Symbol("x"),)),), Type((1,))),)), Symbol("x"))
    assert differentiate(bound("max(length(cage.positions))", {"cage.positions": POINTS}), H) == Number(0.0)
    with pytest.raises(TypeError, match="list"):
        components(points)


@pytest.mark.parametrize("name", [n for n in ORDINARY if n not in ("random",)])
@given(data=st.data())
@settings(max_examples=10)
def test_components_have_the_values_of_the_whole(name: str, data: st.DataObject) -> None:
    call, symbols = call_of(name)
    env = {symbol: value_of(symbol.type.shape, data.draw) for symbol in symbols}
    parts = components(call)
    same([evaluate(part, env) for part in parts], np.ravel(evaluate(call, env)))
    for part in parts:
        for node in each_once(part):
            if isinstance(node, Call) and node.op not in ("component", "item"):  # of lists of unknown length
                assert OPERATIONS[node.op].primitive
        same(evaluate(simplify(part), env), evaluate(part, env))


def test_an_unbound_name_is_no_value() -> None:
    for arrays in (False, True):
        with pytest.raises(TypeError, match="not bound"):
            evaluate(Name(("a",)), {}, arrays)


@pytest.mark.parametrize("name", ORDINARY)
def test_the_form_of_components_does_not_depend_on_numbers(name: str) -> None:
    call, symbols = call_of(name)
    sizes = set()
    for number in (0.0, 1.0, -1.0, 7.25):
        known = {id(s): Number(number) if not s.type.shape else s for s in symbols}
        parts = components(Call(name, tuple(known.get(id(arg), arg) for arg in call.args), call.type))
        sizes.add(tuple(len(each_once(part)) for part in parts))
    assert len(sizes) == 1


def test_the_power_one_half_of_minus_infinity_is_not_its_root() -> None:
    call = Call("pow", (Symbol("a", Type()), Number(0.5)))
    for value in (-math.inf, 4.0, -1.0, math.inf, 0.0):
        env = {call.args[0]: value}
        same(evaluate(call, env, arrays=True), evaluate(call, env))
        same(evaluate(call, {call.args[0]: np.array([value, 1.0])}, arrays=True), [evaluate(call, env), 1.0])
