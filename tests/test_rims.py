"""Rays across rims: places where a field's domain ends, against solids whose entries are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common_scenes import tape_of
from ray_bundles import cast_together
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.tape_solid import cast

X, Y, Z = np.eye(3)
RIM, NO_RIM = True, False
SIDES = [(Y, -0.6, NO_RIM, 0.6, NO_RIM), (Z, -0.4, NO_RIM, 0.4, NO_RIM)]
CUT = "abs(y) - 0.6, abs(z) - 0.4"
BLOCKS = {
    f"max(x^(y^2 + 1) - 0.5^(y^2 + 1), {CUT})": (X, 0.0, RIM, 0.5, NO_RIM),
    f"max(sqrt(x) - 3, sqrt(0.7 - x) - 3, {CUT})": (X, 0.0, RIM, 0.7, RIM),
    f"max(log(x) + log(0.7 - x), {CUT})": (X, 0.0, RIM, 0.7, RIM),
    f"max(asin(2*x - 1.9*z) - 2, {CUT})": (2.0 * X - 1.9 * Z, -1.0, RIM, 1.0, RIM),
    f"max(acos(x + y) - 4, {CUT})": (X + Y, -1.0, RIM, 1.0, RIM),
    f"max(-1/x, x - 0.5, {CUT})": (X, 0.0, RIM, 0.5, NO_RIM),
}
"""Formulas that are below zero in a block, and what it lies between besides SIDES: there they end, or are zero."""


def rays(seed, count=100):
    """(origins, directions), each (count, 3), towards places in the cube |x|, |y|, |z| < 1."""
    chance = np.random.default_rng(seed)
    target = chance.uniform(-1, 1, (count, 3))
    origins = 3.0 * chance.normal(size=(count, 3))
    return origins, 2.0 * (target - origins)


def crossed(slabs, origins, directions):
    """Of rays in slabs low < n . p < high: (begin, whether that is at a rim, end, whether so), each (n,)."""
    ends = []
    for normal, low, low_rim, high, high_rim in slabs:
        at, way = origins @ normal, directions @ normal
        ends.append(np.where(way > 0, [(low - at) / way, np.full(len(at), low_rim), (high - at) / way,
                                       np.full(len(at), high_rim)], [(high - at) / way, np.full(len(at), high_rim),
                                       (low - at) / way, np.full(len(at), low_rim)]))  # fmt: skip
    begins, at_begin, lasts, at_last = np.array(ends).transpose(1, 0, 2)
    first, last = begins.argmax(axis=0), lasts.argmin(axis=0)
    ray = np.arange(len(origins))
    return begins[first, ray], at_begin[first, ray] > 0, lasts[last, ray], at_last[last, ray] > 0


@pytest.mark.parametrize("text", BLOCKS)
@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_solids_end_where_their_field_does(text, seed):
    tape = tape_of(text)
    origins, directions = rays(seed)
    begin, _, end, _ = crossed([BLOCKS[text], *SIDES], origins, directions)
    met = np.maximum(begin, 0.0) < np.minimum(end, 1.0)
    status, t = cast(tape, origins, directions, 0.0, 1.0)
    assert (status == np.where(met, np.where(begin > 0.0, ops.HIT, ops.INSIDE), ops.MISS)).all()
    assert t[met] == pytest.approx(np.maximum(begin, 0.0)[met], abs=2e-9)
    outside = begin > 0.0
    ends = np.zeros(outside.sum()), np.ones(outside.sum())
    together, place = cast_together(tape, origins[outside], directions[outside], *ends)
    assert (together == status[outside]).all()
    assert place[met[outside]] == pytest.approx(begin[met & outside], abs=2e-9)
    shadowed, _ = cast_together(tape, origins[outside], directions[outside], *ends, anywhere=True)
    assert (shadowed == status[outside]).all()


@pytest.mark.parametrize("text", BLOCKS)
def test_rims_are_no_part_of_a_surface(text):
    tape = tape_of(text)
    origins, directions = rays(0, 2000)
    begin, at_begin, end, at_end = crossed([BLOCKS[text], *SIDES], origins, directions)
    enters = (begin < end) & (begin > 0.0) & (begin < 1.0) & ~at_begin
    leaves = (begin < end) & (end > 0.0) & (end < 1.0) & ~at_end
    status, t = cast(tape, origins, directions, 0.0, 1.0, surface=True)
    assert (status == np.where(enters | leaves, ops.HIT, ops.MISS)).all()
    assert t[status == ops.HIT] == pytest.approx(np.where(enters, begin, end)[status == ops.HIT], abs=2e-9)


def test_the_rim_of_a_cup_is_met():
    """Below the upper half of the unit sphere, within its cylinder, where alone the root is a number."""
    tape = tape_of("y - sqrt(1 - x^2 - z^2)")
    origins, directions = rays(1, 4000)
    o, d = origins[:, [0, 2]], directions[:, [0, 2]]
    a, b, c = (d * d).sum(axis=1), (o * d).sum(axis=1), (o * o).sum(axis=1) - 1.0
    ball_a, ball_b = (directions**2).sum(axis=1), (origins * directions).sum(axis=1)
    ball_c = (origins**2).sum(axis=1) - 1.0
    with np.errstate(invalid="ignore"):
        reach, ball_reach = np.sqrt(b * b - a * c), np.sqrt(ball_b**2 - ball_a * ball_c)
    level = -origins[:, 1] / directions[:, 1]
    low, high = np.where(directions[:, 1] < 0, [level, np.full(4000, np.inf)], [np.full(4000, -np.inf), level])
    low, high = np.fmax(low, (-b - reach) / a), np.fmin(high, (reach - b) / a)  # in the cylinder, below its middle
    low, high = np.where((low < high) & (reach > 0), [low, high], np.nan)
    first = np.fmin(low, (-ball_b - ball_reach) / ball_a)
    last = np.fmax(high, (ball_reach - ball_b) / ball_a)  # the two of them are convex together
    met = (last > 0.0) & (first < 1.0)
    status, t = cast(tape, origins, directions, 0.0, 1.0)
    assert (status != ops.UNDECIDED).all()
    assert (status == np.where(met, np.where(first > 0.0, ops.HIT, ops.INSIDE), ops.MISS)).all()
    assert t[met] == pytest.approx(np.maximum(first[met], 0.0), abs=2e-9)
