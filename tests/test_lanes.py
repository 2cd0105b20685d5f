"""Lanes do to each number what is done to one, with the rounding of IEEE 754."""

from fractions import Fraction

import numpy as np
import pytest

from lanes_of_numbers_kernels import (
    doubles,
    doubles_compared,
    doubles_turned,
    first_of,
    singles,
    singles_compared,
    singles_turned,
)

KINDS = pytest.mark.parametrize(("kernel", "kind"), [(doubles, np.float64), (singles, np.float32)])


def given(kind, seed=3):
    rng = np.random.default_rng(seed)
    count = 64 // np.dtype(kind).itemsize
    a, b = (rng.lognormal(sigma=3, size=(2, count))).astype(kind)
    number = kind(rng.normal())
    out = np.zeros(10 * count, dtype=kind)
    return a, b, number, out


@KINDS
def test_operations_are_those_of_single_numbers(kernel, kind):
    a, b, number, out = given(kind)
    kernel(a, b, number, out)
    expected = [a + b, a - b, a * b, number - a, a * number, a / b, np.sqrt(a)]
    count = len(a)
    assert np.array_equal(out[: 7 * count], np.concatenate(expected))
    assert (out[8 * count : 9 * count] == number).all()


@KINDS
def test_fma_rounds_once(kernel, kind):
    a, b, number, out = given(kind)
    number = kind(-a[0] * b[0])  # what the first product rounds to: only one rounding leaves its error
    kernel(a, b, number, out)
    found = out[7 * len(a) : 8 * len(a)]
    exact = [Fraction(float(x)) * Fraction(float(y)) + Fraction(float(number)) for x, y in zip(a, b, strict=True)]
    ulp = [Fraction(float(np.spacing(abs(kind(float(one)))))) for one in exact]
    assert found[0] != 0.0
    assert all(abs(Fraction(float(x)) - y) <= u / 2 for x, y, u in zip(found, exact, ulp, strict=True))


@KINDS
def test_guess_is_near_the_inverse_root(kernel, kind):
    a, b, number, out = given(kind)
    kernel(a, b, number, out)
    assert np.abs(out[9 * len(a) :] * np.sqrt(a.astype(float)) - 1.0).max() < 0.04


@KINDS
def test_sum_goes_half_by_half(kernel, kind):
    a, b, number, out = given(kind)
    total = a.copy()
    while len(total) > 1:
        total = total[: len(total) // 2] + total[len(total) // 2 :]
    assert kernel(a, b, number, out) == total[0]


@pytest.mark.parametrize(("kernel", "kind"), [(doubles_compared, np.float64), (singles_compared, np.float32)])
def test_comparisons_are_those_of_single_numbers(kernel, kind):
    a, b, _, out = given(kind)
    a[1] = np.nan
    single = np.zeros(len(a), dtype=np.float32)
    bits, _, _ = kernel(a, b, out, single)
    assert [bool(bits >> i & 1) for i in range(len(a))] == (a < b).tolist()
    assert np.array_equal(out[: len(a)], np.where(a < b, a, kind(2.0)))
    assert np.array_equal(out[len(a) : 2 * len(a)], np.abs(a - b), equal_nan=True)
    assert np.array_equal(single, a.astype(np.float32), equal_nan=True)
    a[1] = -1.0
    _, low, high = kernel(a, b, out, single)
    assert (low, high) == (a.min(), a.max())


def test_the_first_bit():
    assert [first_of(n) for n in (1, 12, 1 << 40)] == [0, 2, 40]


@pytest.mark.parametrize(
    ("kernel", "kind", "step", "to_step"), [(doubles_turned, np.float64, 11, 9), (singles_turned, np.float32, 19, 17)]
)
def test_squares_are_turned_over(kernel, kind, step, to_step):
    count = 64 // np.dtype(kind).itemsize
    source, target = np.arange(1.0, 400.0, dtype=kind), np.zeros(400, dtype=kind)
    kernel(source, target)
    expected = np.zeros(400, dtype=kind)
    for row in range(count):
        for column in range(count):
            expected[5 + to_step * column + row] = source[3 + step * row + column]
    assert np.array_equal(target, expected)
