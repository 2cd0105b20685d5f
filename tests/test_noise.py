"""`noise`: what Perlin's gradient noise promises, in all evaluators, and who cannot have it."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from expressions import bound
from sceneql.compiled import noise_kernels
from sceneql.quantities import noise
from sceneql.quantities.derivative import differentiate
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Symbol, Type

X, Y, Z = (Symbol(name) for name in "xyz")
SYMBOLS: dict[str, Expr] = {"x": X, "y": Y, "z": Z}
KINDS = ("noise(x)", "noise([x, y])", "noise([x, y, z])")
PLACES = np.random.default_rng(7).uniform(-50.0, 50.0, (20_000, 3))


def at(expr: Expr, places: np.ndarray) -> np.ndarray:
    """Its values at places (n, 3), by numpy."""
    return np.asarray(evaluate(expr, dict(zip((X, Y, Z), places.T, strict=True)), arrays=True))


@pytest.mark.parametrize("text", KINDS)
def test_it_is_zero_at_whole_numbers_within_one_and_zero_on_the_mean(text: str) -> None:
    expr = bound(text, SYMBOLS)
    assert not at(expr, np.round(PLACES[:1000])).any()
    values = at(expr, PLACES)
    assert 0.75 < np.abs(values).max() <= 1.0
    # The standard error of means of cells of which there are some hundred along a line.
    assert abs(values.mean()) < (0.06 if text == "noise(x)" else 0.01)
    assert 0.2 < values.std() < 0.35


def test_in_a_plane_it_is_that_of_space_at_z_0() -> None:
    flat = PLACES[:1000] * (1.0, 1.0, 0.0)
    assert (at(bound(KINDS[1], SYMBOLS), flat) == at(bound(KINDS[2], SYMBOLS), flat)).all()


@pytest.mark.parametrize("text", KINDS)
@pytest.mark.parametrize("by", [X, Y, Z])
def test_its_derivatives_are_central_differences(text: str, by: Symbol) -> None:
    move = 1e-6 * np.array([by == X, by == Y, by == Z], dtype=float)
    value = bound(text, SYMBOLS)
    for expr in (value, differentiate(value, X)):
        slope = at(differentiate(expr, by), PLACES[:1000])
        differences = (at(expr, PLACES[:1000] + move) - at(expr, PLACES[:1000] - move)) / 2e-6
        np.testing.assert_allclose(slope, differences, atol=1e-6)


def test_its_derivatives_of_all_orders_are_those_of_the_ones_before() -> None:
    place = (0.3, 1.6, -2.7)
    for orders in product(range(4), repeat=3):
        order = orders[0] + 8 * orders[1] + 64 * orders[2]
        for axis in range(3):
            above, below = (
                noise.noise_space(*(p + d * (k == axis) for k, p in enumerate(place)), order) for d in (1e-5, -1e-5)
            )
            slope = noise.noise_space(*place, order + 8**axis)
            assert slope == pytest.approx((above - below) / 2e-5, rel=1e-5, abs=1e-4)


def test_of_a_list_of_places_it_is_a_list() -> None:
    places = Symbol("p", Type((None, 3)))
    call = bound("noise(p)", {"p": places})
    assert call.type.shape == (None,)
    wanted = [noise.noise_space(*place, 0.0) for place in PLACES[:5].tolist()]
    for arrays in (False, True):
        assert list(evaluate(call, {places: PLACES[:5]}, arrays)) == wanted


@pytest.mark.parametrize("text", KINDS)
def test_it_and_two_derivatives_go_on_across_cells(text: str) -> None:
    expr = bound(text, SYMBOLS)
    faces = PLACES[:500].copy()
    faces[:, 0] = np.round(faces[:, 0])
    step = np.array([1e-9, 0.0, 0.0])
    for order in range(3):
        assert np.abs(at(expr, faces + step) - at(expr, faces - step)).max() < (1e-8, 1e-7, 1e-5)[order]
        expr = differentiate(expr, X)


NUMBERS = st.floats(-1e3, 1e3) | st.sampled_from([-1e-20, -5e-324, 2.0**53 + 2.0, 1e300, -7.0, 0.5])


@given(NUMBERS, NUMBERS, NUMBERS, st.sampled_from([0, 1, 8, 64, 9, 2, 128]))
def test_plain_python_numpy_and_kernels_have_the_same_bits(x: float, y: float, z: float, order: int) -> None:
    places = dict(zip((X, Y, Z), (x, y, z), strict=True))
    space, line = bound(KINDS[2], SYMBOLS), bound(KINDS[0], SYMBOLS)
    for by, times in ((X, order % 8), (Y, order // 8 % 8), (Z, order // 64)):
        for _ in range(times):
            space, line = differentiate(space, by), differentiate(line, by)
    value = evaluate(space, places)
    assert value == evaluate(space, places, arrays=True) == noise_kernels.noise_space(x, y, z, float(order))
    if order < 8:
        value = evaluate(line, places)
        assert value == evaluate(line, places, arrays=True) == noise_kernels.noise_line(x, float(order))


def test_it_is_the_same_on_every_machine_and_in_every_version() -> None:
    assert noise.noise_line(0.3, 0.0) == 0.3330453538350559
    assert noise.noise_space(0.3, 4.6, -2.25, 0.0) == -0.18860722625625004


def test_it_is_undefined_where_its_place_is() -> None:
    for wrong in (math.nan, math.inf, -math.inf):
        for arrays in (False, True):
            assert math.isnan(evaluate(bound("noise(x)", SYMBOLS), {X: wrong}, arrays))
            assert math.isnan(evaluate(bound("noise([x, 1])", SYMBOLS), {X: wrong}, arrays))
        assert math.isnan(noise_kernels.noise_line(wrong, 0.0))
        assert math.isnan(noise_kernels.noise_space(0.5, wrong, 0.5, 0.0))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("noise(2 m)", "noise needs a plain number, not a length"),
        ("noise([1, 2, 3, 4])", "noise needs a plain number or a vector of 2 or 3, not a vector of 4"),
        ("noise(x, y)", "noise takes 1 argument, not 2"),
        ("noise_space(x, y, z, 0)", "there is no function 'noise_space'"),
    ],
)
def test_what_it_cannot_take_is_told(text: str, told: str) -> None:
    with pytest.raises(ScriptError, match=told.replace("(", r"\(")):
        bound(text, SYMBOLS)
