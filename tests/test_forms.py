"""Affine enclosures of single operations hold in exact arithmetic: from the smallest to the largest numbers, and where
an argument just touches the end of what an operation is defined on."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import example, given, settings
from hypothesis import strategies as st

from campaigns import examples
from form_kernels import enclosed
from sceneql.field.tape import tape_ops as ops

PRECISE = 600
"""Bits; what is compared differs by far more."""


def exact(number):
    ratio = Fraction(number)
    return fmpq(ratio.numerator, ratio.denominator)


def scaled(lowest, highest):
    """Numbers of all sizes between powers of ten, of both signs, and 0."""
    digits = st.integers(-(10**6), 10**6)
    return st.builds(lambda m, k: m * 10.0**k, digits, st.integers(lowest - 6, highest - 6)) | st.just(0.0)


def forms(lowest, highest):
    """(c0, c1, e) with c1 and e of any size beside c0, or such that c0 - |c1| - e is next to nothing."""

    def form(c0, share, split, hair):
        reach = abs(c0) * share * (1.0 + hair * 2.0**-52)
        return c0, reach * split, reach * (1.0 - abs(split))

    share = st.sampled_from([0.0, 1e-14, 1e-7, 1e-3, 0.3, 0.6, 0.999, 1.0, 3.0])
    return st.builds(form, scaled(lowest, highest), share, st.floats(-1.0, 1.0), st.integers(-4, 4))


def at(form, tau, side):
    """A number that a form holds at tau, exactly."""
    c0, c1, e = map(exact, form)
    return c0 + c1 * exact(tau) + e * exact(side)


def check(op, value, a, b, tau, sides):
    """That the enclosure of an operation on two forms holds its value on numbers of theirs."""
    c0, c1, e = enclosed(op, np.array(a), np.array(b))
    if not math.isfinite(c0 + c1 + e):
        return
    found = value(at(a, tau, sides[0]), at(b, tau, sides[1]))
    if found is None:
        return
    off = abs(arb(found) - arb(exact(c0)) - arb(exact(c1)) * arb(exact(tau)))
    assert not off > arb(exact(e)), float((off - arb(exact(e))).mid())


PLACES = {
    "tau": st.floats(-1.0, 1.0) | st.sampled_from([-1.0, 1.0]),
    "sides": st.tuples(*[st.floats(-1.0, 1.0) | st.sampled_from([-1.0, 1.0])] * 2),
}
UNARY = {
    ops.ABS: (-300, 300, lambda a, b: abs(a)),
    ops.SQRT: (-300, 300, lambda a, b: arb(a).sqrt() if a >= 0 else None),
    ops.EXP: (-20, 3, lambda a, b: arb(a).exp()),
    ops.LOG: (-300, 300, lambda a, b: arb(a).log() if a > 0 else None),
    ops.FLOOR: (-5, 12, lambda a, b: a.floor()),
}
BINARY = {
    ops.MUL: (-170, 160, lambda a, b: a * b),
    ops.DIV: (-170, 170, lambda a, b: a / b if b != 0 else None),
    ops.MIN: (-300, 300, min),
    ops.MAX: (-300, 300, max),
    ops.ATAN2: (-170, 170, lambda a, b: None if a == 0 and b <= 0 else arb.atan2(arb(a), arb(b))),
    ops.POW: (-20, 2, lambda a, b: arb(a) ** arb(b) if a > 0 else None),
}


@pytest.fixture(autouse=True)
def precise():
    before, ctx.prec = ctx.prec, PRECISE
    yield
    ctx.prec = before


@pytest.mark.parametrize("op", UNARY)
def test_one_argument(op):
    lowest, highest, value = UNARY[op]

    @settings(max_examples=examples(400))
    @given(a=forms(lowest, highest), **PLACES)
    @example(a=(2e154, 0.0, 1e154), tau=0.0, sides=(-1.0, 0.0))
    def holds(a, tau, sides):
        check(op, value, a, a, tau, sides)

    holds()


@pytest.mark.parametrize("op", BINARY)
def test_two_arguments(op):
    lowest, highest, value = BINARY[op]

    @settings(max_examples=examples(400))
    @given(a=forms(lowest, highest), b=forms(lowest, highest), **PLACES)
    def holds(a, b, tau, sides):
        check(op, value, a, b, tau, sides)

    holds()
