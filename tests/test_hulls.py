"""What packets are told of polynomials on segments: Bernstein's coefficients, against rational arithmetic."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from common_scenes import SCENES, tape_of
from hulls_kernels import hull
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.plans import degrees_of, places_of


def bernstein(c, m, h):
    """Coefficients on m - h..m + h of the polynomial with coefficients c, all rational."""
    d = len(c) - 1
    low, width = m - h, 2 * h
    moved = [sum(c[j] * comb(j, k) * low ** (j - k) for j in range(k, d + 1)) * width**k for k in range(d + 1)]
    return [sum(moved[j] * Fraction(comb(k, j), comb(d, j)) for j in range(k + 1)) for k in range(d + 1)]


@pytest.mark.parametrize("form", [4, 6, 8])
def test_hulls_are_those_of_bernsteins_coefficients(form):
    generator = np.random.default_rng(form)
    for _ in range(50):
        c = np.zeros(9)
        c[: form + 1] = generator.normal(size=form + 1)
        m, h, off = 0.5 * generator.uniform(-1, 1), 0.5 * generator.uniform(), 0.25
        b = bernstein([Fraction(x) for x in c[: form + 1]], Fraction(m), Fraction(h))
        steepest = max((b[0] - b[k]) * Fraction(form, k) for k in range(1, form + 1))
        rise = max(b[k + 1] - b[k] for k in range(form))
        exact = [float(x) for x in (b[0], b[-1], min(b), max(b), steepest, rise)]
        exact[:4] = [x - off for x in exact[:4]]
        assert hull(c, form, m, h, off) == pytest.approx(exact, abs=1e-14)


@pytest.mark.parametrize("name", ["steiner", "kummer", "barth_sextic"])
def test_what_is_still_needed_is_never_overwritten(name):
    tape = tape_of(SCENES[name]["f"], SCENES[name].get("where", {}))
    last = len(tape.code) - 1
    degrees = degrees_of(tape, last)
    assert degrees is not None
    places, most = places_of(tape, degrees)
    holder: dict[int, int] = {}
    for k, degree in enumerate(degrees[:-1]):
        if degree < 0:
            continue
        leaf = tape.code[k, 0] in (ops.CONSTANT, ops.X, ops.Y, ops.Z)
        operands = [] if leaf else [int(row) for row in tape.code[k, 1:3]]
        assert all(holder[places[row] + i] == row for row in operands for i in range(degrees[row] + 1))
        own = {places[k] + i: k for i in range(degree + 1)}
        assert not any(places[row] + i in own for row in operands for i in range(degrees[row] + 1))
        holder |= own
    assert max(holder) + 1 == most < sum(degree + 1 for degree in degrees if degree >= 0)
