"""Keyframes: what a curve goes through, how it starts and ends, and that every evaluator agrees."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from sceneql.quantities.curves import CURVES
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Key, Keys, Number, Symbol, Type, Vector, each_once
from sceneql.quantities.key_tables import keys_table, value_at

TIME = Symbol("time")
AXIS = Vector((Number(1.0), Number(2.0), Number(-0.5)), Type((3,)))
numbers = st.floats(-10, 10)
gaps = st.floats(0.1, 3)
curves = st.sampled_from(CURVES)


def rotation(angle: float) -> Expr:
    return Call("about", (AXIS, Number(angle)), Type((4,)))


def vector(values: tuple[float, ...]) -> Expr:
    return Vector(tuple(Number(v) for v in values), Type((len(values),)))


def keys_of(spacing: list[float], values: list[Any], curve: str, cycle: float | None = None, slopes: Any = ()) -> Keys:
    times = np.cumsum(spacing) - 2.0
    kinds: dict[type, Any] = {float: ((), Number), tuple: ((3,), vector), int: ((4,), rotation)}
    shape, make = kinds[type(values[0])]
    keys = [Key(Number(float(t)), make(v)) for t, v in zip(times, values, strict=False)]
    for k, (before, after) in enumerate(slopes):
        keys[k] = Key(keys[k].time, keys[k].value, Number(before), Number(after))
    return Keys(TIME, tuple(keys), curve, None if cycle is None else Number(cycle), Type(shape))  # type: ignore[arg-type]


many = st.lists(gaps, min_size=1, max_size=5)
scalars = st.lists(numbers, min_size=5, max_size=5)
vectors = st.lists(st.tuples(numbers, numbers, numbers), min_size=5, max_size=5)
turns = st.lists(st.integers(-3, 3), min_size=5, max_size=5)
instants = st.lists(st.floats(-20, 20) | st.just(math.nan), min_size=1, max_size=8)


def test_the_curves_are_those_of_the_tree() -> None:
    assert get_args(get_type_hints(Keys)["curve"]) == CURVES


@given(many, scalars | vectors | turns, curves, instants, st.none() | st.floats(0.5, 9))
@settings(max_examples=examples(150))
def test_evaluators_agree(spacing: Any, values: Any, curve: str, times: list[float], cycle: float | None) -> None:
    keys = keys_of(spacing, values, curve, cycle)
    together = evaluate(keys, {TIME: np.array(times)}, arrays=True)
    parts = components(keys)
    for t, row in zip(times, together, strict=True):
        alone = evaluate(keys, {TIME: t})
        np.testing.assert_allclose(alone, row, rtol=1e-9, atol=1e-9)
        lowered = [evaluate(part, {TIME: t}) for part in parts]
        np.testing.assert_allclose(np.ravel(alone), lowered, rtol=1e-9, atol=1e-9)
        np.testing.assert_array_equal(np.ravel(alone), value_at(keys_table(keys), t))


@given(many, scalars, curves)
@settings(max_examples=100)
def test_it_goes_through_its_keys_and_holds_outside(spacing: list[float], values: list[float], curve: str) -> None:
    keys = keys_of(spacing, values, curve)
    for key in keys.keys:
        at = evaluate(key.time, {})
        assert evaluate(keys, {TIME: at}) == evaluate(key.value, {})
    for place, at in ((0, -1e6), (0, -math.inf), (-1, 1e6), (-1, math.inf)):
        assert evaluate(keys, {TIME: at}) == evaluate(keys.keys[place].value, {})


@given(many, scalars, st.lists(st.tuples(numbers, numbers), min_size=1, max_size=5))
@settings(max_examples=60)
def test_a_cubic_has_the_slopes_that_are_given(spacing: Any, values: Any, slopes: Any) -> None:
    count = min(len(spacing), len(slopes))
    keys = keys_of(spacing, values, "cubic", slopes=slopes[:count])
    slope = differentiate(keys, TIME)
    times = [evaluate(key.time, {}) for key in keys.keys]
    for k, (before, after) in enumerate(slopes[:count]):
        if k > 0:
            assert evaluate(slope, {TIME: times[k] - 1e-9}) == pytest.approx(before, rel=1e-4, abs=1e-4)
        if k < len(times) - 1:
            assert evaluate(slope, {TIME: times[k]}) == pytest.approx(after, rel=1e-6, abs=1e-6)


@given(st.lists(gaps, min_size=3, max_size=5), st.tuples(numbers, numbers))
@settings(max_examples=60)
def test_a_cubic_without_slopes_keeps_a_straight_line(spacing: list[float], line: tuple[float, float]) -> None:
    times = np.cumsum(spacing) - 2.0
    keys = keys_of(spacing, [float(line[0] + line[1] * t) for t in times], "cubic")
    for t in np.linspace(times[0], times[-1], 9):
        assert evaluate(keys, {TIME: float(t)}) == pytest.approx(line[0] + line[1] * t, abs=1e-9)


@given(many, scalars)
@settings(max_examples=40)
def test_smooth_rests_at_its_keys_and_never_overshoots(spacing: list[float], values: list[float]) -> None:
    keys = keys_of(spacing, values, "smooth")
    slope = differentiate(keys, TIME)
    for a, b in pairwise(keys.keys):
        ends = [evaluate(a.time, {}), evaluate(b.time, {})]
        assert evaluate(slope, {TIME: ends[0]}) == pytest.approx(0.0, abs=1e-9)
        low, high = sorted((evaluate(a.value, {}), evaluate(b.value, {})))
        for t in np.linspace(*ends, 7):
            assert low - 1e-12 <= evaluate(keys, {TIME: float(t)}) <= high + 1e-12


@given(many, scalars, curves, st.floats(0.5, 9), st.floats(0, 1), st.integers(-5, 5))
@settings(max_examples=60)
def test_a_cycle_repeats(spacing: Any, values: Any, curve: str, cycle: float, part: float, count: int) -> None:
    keys = keys_of(spacing, values, curve, cycle)
    first = evaluate(keys.keys[0].time, {})
    at = first + cycle * (0.01 + 0.98 * part)
    here, there = (evaluate(keys, {TIME: t}) for t in (at, at + count * cycle))
    assert here == pytest.approx(there, abs=1e-6) or curve == "step"


def test_a_joined_cycle_has_no_corner() -> None:
    keys = keys_of([2.0, 1.0, 0.5, 2.5], [1.0, 3.0, -2.0, 1.0], "cubic", cycle=4.0)
    slope = differentiate(keys, TIME)
    before, after = (evaluate(slope, {TIME: 4.0 + d}) for d in (-1e-9, 1e-9))
    assert before == pytest.approx(after, abs=1e-6)


def angle_between(p: tuple[float, ...], q: tuple[float, ...]) -> float:
    return 2 * math.acos(min(1.0, abs(sum(a * b for a, b in zip(p, q, strict=True)))))


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0, 1))
def test_rotations_go_the_shorter_way_at_constant_speed(start: float, end: float, part: float) -> None:
    keys = Keys(TIME, (Key(Number(0.0), rotation(start)), Key(Number(1.0), rotation(end))), "linear", None, Type((4,)))
    a, here, b = (evaluate(keys, {TIME: t}) for t in (0.0, part, 1.0))
    assert math.hypot(*here) == pytest.approx(1.0, abs=1e-12)
    whole = angle_between(a, b)
    assert whole == pytest.approx(min(abs(end - start), math.tau - abs(end - start)), abs=1e-6)
    assert angle_between(a, here) == pytest.approx(part * whole, abs=1e-6)


def test_values_may_depend_on_others() -> None:
    h = Symbol("h")
    keys = Keys(TIME, (Key(Number(0.0), h), Key(Number(2.0), Number(5.0))), "linear")
    assert evaluate(keys, {TIME: 1.0, h: 3.0}) == 4.0
    assert evaluate(keys, {TIME: np.array([0.0, 1.0]), h: np.array([3.0, 1.0])}, arrays=True).tolist() == [3.0, 3.0]
    with pytest.raises(KeyError):
        keys_table(keys)
    assert any(node is h for node in each_once(keys))
