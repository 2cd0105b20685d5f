"""Laws of lanes: float32 enclosures along ray segments contain what they claim."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from common_scenes import tape_of
from extremes_kernels import extremes
from lane_checks import check_enclosures
from plain_tapes import implicit
from random_tapes import NAMES, PARTS, of_one, rays, tapes
from sceneql.field.packets.packets import enclosures
from sceneql.field.tape.tape_ops import (
    DENSITY,
    WHOLE,
)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=40)
@given(ray=rays())
def test_enclosures_of_every_operation_contain_its_values(name, ray):
    check_enclosures(of_one(name), *ray)


@settings(max_examples=examples(500))
@given(tape=tapes(), ray=rays())
def test_enclosures_of_any_tape_contain_its_values(tape, ray):
    check_enclosures(tape, *ray)


@pytest.mark.parametrize("text", ["abs(x)^2.5 - 0.1", "(x^2)^0.7 - y", "exp(x)^1.5 - 3", "sqrt(x + 2)^0.3 - 1"])
def test_powers_of_what_is_never_negative_are_defined_all_over(text):
    """Also where the enclosure of the base goes below 0."""
    tape, origin, direction = tape_of(text), np.array([-1.0, 0.1, 0.2]), np.array([1.0, 0.1, -0.1])
    check_enclosures(tape, origin, direction, 0.0, 2.0)
    halves = np.array([0.0, 0.9]), np.array([2.0, 1.2])
    *_, status = enclosures(tape, np.tile(origin, (2, 1)), np.tile(direction, (2, 1)), *halves)
    assert (status == WHOLE).all()


@settings(max_examples=examples(150))
@given(tape=tapes(), ray=rays(), size=st.sampled_from([1e-20, 1e-6, 1e3, 1e8, 1e20, 1e30, 1e300]))
def test_enclosures_far_from_one_claim_nothing_wrong(tape, ray, size):
    origin, direction, t0, t1 = ray
    check_enclosures(tape, size * origin, size * direction, t0, t1)


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=70))
def test_least_and_largest_by_bits(numbers):
    assert extremes(np.array(numbers)) == (min(numbers), max(numbers))


def test_nothing_is_claimed_of_an_operation_without_lanes():
    def formula(b, op, c):
        return op("sub", c(0.3), b.density(PARTS, b.x, b.y, b.z))

    tape = implicit(formula)
    unknown = replace(tape, code=np.where(tape.code == DENSITY, 99, tape.code))
    origins, ends = np.zeros((2, 3)), np.ones(2)
    assert np.isnan(enclosures(unknown, origins, origins + 1.0, 0.0 * ends, ends)[0]).all()
