"""A rigid body without torque turns exactly, whatever its moments, its motion and the time. SCENEQL_FUZZ says how many
motions are held against power series."""

import math
import os

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.special import ellipk

import free_rotation_series
from free_rotation_series import times
from sceneql.bodies.rigid.free_rotation_kernels import rotated as kernel

COUNT = min(int(os.environ.get("SCENEQL_FUZZ", "12")), 5000)
START = (1.0, 0.0, 0.0, 0.0)
CASES = {
    "A": ((0.8, 0.7, 0.6), 20, (-0.636295763417436, 0.515834806373842, 0.0142968800686671, -0.57344376638916), 1e-12),
    "B": (
        (0.01, 1, 0.01),
        100,
        (-0.0156462415148542, 0.965439574274269, -7.97160940397554e-5, -0.260156908801055),
        1e-11,
    ),
}
"""Spin at the start, time, q there and how near it has to be [rad]; moments 1, 2, 3; by series with 30 digits."""


def rotated(q, momentum, moments, h):
    return np.array(kernel(*map(float, q), *map(float, momentum), *map(float, moments), float(h)))


def apart(p, q):
    """The angle [rad] between two rotations, by continuous quaternions: 2 pi at opposite signs."""
    return 2.0 * math.dist(p, q)


def body_axes(q, vector):
    """A vector of the world in the body's axes."""
    q = np.asarray(q)
    return np.array(times(times(q * (1, -1, -1, -1), (0.0, *vector)), q)[1:])


def world(q, vector):
    return np.array(times(times(q, (0.0, *vector)), np.asarray(q) * (1, -1, -1, -1))[1:])


def bound(momentum, moments, h):
    """Error [rad] that rounding of what goes in makes: of the angle, times the growth beside the middle axis."""
    a, b, c = 1.0 / np.sort(moments)
    reach = np.linalg.norm(momentum) * abs(h)
    return 4e-15 * (1.0 + reach * a) * math.exp(reach * math.sqrt((a - b) * (b - c)))


@pytest.mark.parametrize("steps", [1, 7, 20, 1000, "ms"])
@pytest.mark.parametrize("case", CASES)
def test_references_are_met_at_any_step(case, steps):
    spin, time, there, near = CASES[case]
    count = 1000 * time if steps == "ms" else steps
    q = START
    numbers = (*np.multiply(spin, (1.0, 2.0, 3.0)), 1.0, 2.0, 3.0, time / count)
    for _ in range(count):
        q = kernel(*q, *numbers)
    assert apart(q, there) < near


@pytest.mark.parametrize(("spin", "period"), [((0.8, 0.7, 0.6), 11.6422022803), ((0.01, 1, 0.01), 39.1057341973)])
def test_the_spin_comes_back_after_a_period(spin, period):
    momentum = np.multiply(spin, (1, 2, 3))
    assert np.abs(body_axes(rotated(START, momentum, (1, 2, 3), period), momentum) - momentum).max() < 1e-9
    assert np.abs(body_axes(rotated(START, momentum, (1, 2, 3), period / 2), momentum) - momentum).max() > 0.01


@pytest.mark.parametrize("count", [3, 1000, -5000, 100_000])
def test_thousands_of_periods_are_as_many_times_one(count):
    p, r, m = 1 / 2, 1 / 6, (0.8, 1.4, 1.8)
    less, more = p * ((p + r) * m[0] ** 2 + r * m[1] ** 2), r * ((p + r) * m[2] ** 2 + p * m[1] ** 2)
    period = 4 * ellipk(less / more) / math.sqrt(more)
    once = rotated(START, m, (1, 2, 3), period)
    half = math.atan2(np.dot(once[1:], m) / np.linalg.norm(m), once[0])
    many = rotated(START, m, (1, 2, 3), count * period)
    there = (math.cos(count * half), *(math.sin(count * half) * np.array(m) / np.linalg.norm(m)))
    assert min(apart(many, there), apart(many, np.negative(there))) < 4e-15 * abs(count) * period * 3


COMPONENT = st.floats(-1.0, 1.0).map(lambda x: x if abs(x) > 1e-3 else 0.0)
VECTORS = st.tuples(COMPONENT, COMPONENT, COMPONENT)
QUATERNIONS = (
    st.tuples(COMPONENT, COMPONENT, COMPONENT, COMPONENT).filter(any).map(lambda q: np.array(q) / np.linalg.norm(q))
)
PARTS = st.sampled_from([0.0, 1e-12, 1e-6, 0.5, 1.0]) | st.floats(0.01, 1.0)
MOMENTS = (
    st.tuples(PARTS, PARTS, PARTS)
    .filter(lambda s: sum(x > 0.0 for x in s) > 1)
    .map(lambda s: (s[0] + s[1], s[1] + s[2], s[2] + s[0]))
)
"""Of three sums over masses, x^2, y^2 and z^2: solid, flat and thin bodies."""
ANGLES = st.floats(-8.0, 8.0) | st.sampled_from([0.0, 1e-12, -1e-6])


def time_of(angle, momentum, moments):
    """The time in which a body turns by at most an angle."""
    return angle * min(moments) / (np.linalg.norm(momentum) or 1.0)


@given(QUATERNIONS, VECTORS, MOMENTS, ANGLES)
@example((0.0, 0.0, 0.5**0.5, 0.5**0.5), (0.0, 1.0, 0.0), (0.5, 1.5, 1.0), 1.9375)  # next to the middle axis
def test_energy_and_length_stay(q, momentum, moments, angle):
    h = time_of(1000.0 * angle, momentum, moments)
    after = rotated(q, momentum, moments, h)
    assert abs(np.linalg.norm(after) - 1.0) < 5e-16
    before, then = (0.5 * np.sum(body_axes(x, momentum) ** 2 / moments) for x in (q, after))
    assert abs(then - before) <= 1e-14 * np.dot(momentum, momentum) / min(moments)


@given(QUATERNIONS, VECTORS, MOMENTS, ANGLES, st.floats(-0.5, 1.5))
def test_two_times_are_their_sum_and_back_is_the_start(q, momentum, moments, angle, share):
    h = time_of(angle, momentum, moments)
    between = rotated(q, momentum, moments, share * h)
    near = 4.0 * bound(momentum, moments, 2.0 * h)
    assert apart(rotated(between, momentum, moments, h - share * h), rotated(q, momentum, moments, h)) < near
    assert apart(rotated(between, momentum, moments, -share * h), q) < near


@given(QUATERNIONS, QUATERNIONS, VECTORS, MOMENTS, ANGLES)
def test_a_turned_world_sees_the_turned_motion(turn, q, momentum, moments, angle):
    h = time_of(angle, momentum, moments)
    seen = rotated(times(turn, q), world(turn, momentum), moments, h)
    assert apart(seen, times(turn, rotated(q, momentum, moments, h))) < 4.0 * bound(momentum, moments, h)


@given(QUATERNIONS, VECTORS, MOMENTS, ANGLES, st.sampled_from(["next", "half", "quarter"]))
def test_the_order_of_the_axes_does_not_matter(q, momentum, moments, angle, turn):
    """The axes of the body are named anew, by turns that map them to one another."""
    a, b, c = moments
    root = math.sqrt(0.5)
    by, named = {
        "next": ((0.5, 0.5, 0.5, 0.5), (b, c, a)),
        "half": ((0.0, 1.0, 0.0, 0.0), (a, b, c)),
        "quarter": ((root, 0.0, 0.0, root), (b, a, c)),
    }[turn]
    h = time_of(angle, momentum, moments)
    other = rotated(times(q, by), momentum, named, h)
    assert apart(other, times(rotated(q, momentum, moments, h), by)) < 4.0 * bound(momentum, moments, h)


SPLIT = (1.0, 2.0, 2.25)
"""Moments for which (1, y, 3) is on the separatrix in exact numbers."""
MOTIONS = {
    "below the separatrix": ((0.3, 0.2, 0.9), (1, 2, 3), 9.0),
    "above the separatrix": ((0.9, 0.2, -0.4), (1, 2, 3), -7.0),
    **{f"{e:g} from the separatrix": ((1, 0.01, 3 * (1 + e)), SPLIT, 12.0) for e in (3e-16, -1e-14, 1e-9, -1e-5, 1e-3)},
    "more than half a turn of L in half a period": ((0.9, -0.9, -1.6), (1.2, 2.8, 1.8), 4.1),
    "as much back": ((-1.9, 1.8, 0.5), (2.15, 2.0, 0.55), -2.4),
    "1e-161 from an axis, shortly": ((1.0, 0.4e-161, 0.3e-161), (1, 2, 2.5), -1.1),
    "on the separatrix": ((1.0, -1.5, 3.0), SPLIT, 15.0),
    **{f"nearly symmetric about axis {k}, {e:g}": ((0.3, 0.5, 0.7), tuple(np.roll((third, 1.0, 1.0 + e), k)), 20.0)
       for k, third in ((0, 0.5), (1, 1.9), (2, 0.9)) for e in (-2e-16, 1e-13, -1e-8, 1e-3)},
    **{f"nearly a sphere, {e:g}": ((0.3, 0.5, 0.7), (1, 1 + e, 1 - 2 * e), 20.0) for e in (3e-16, 1e-8, 1e-3)},
    **{f"{e:g} from axis {k}": (np.eye(3)[k] + e * np.array((0.4, 0.7, -0.6)), (1, 2, 2.5), 15.0)
       for k in range(3) for e in (1e-17, 1e-9, 1e-4)},
    "a disk": ((0.3, 0.5, 0.7), (1, 1 + 1e-6, 2 + 1e-6), 20.0),
    "a rod": ((1e-13, 0.8, 0.6), (1e-12, 1.0, 1.0 + 5e-13), 20.0),
    "a rod that spins": ((1e-6, 0.8, 0.6), (1e-6, 1.0, 1.0 + 5e-7), -20.0),
    "a blade": ((1e-8, 1e-3, 1.0), (1e-6, 1.0, 1.0 + 1e-6), 20.0),
    "1 ms": ((0.3, 0.5, 0.7), (1, 2, 3), 1e-3),
    "1e-12 s": ((0.3, 0.5, 0.7), (1, 2, 3), 1e-12),
}  # fmt: skip


@pytest.mark.parametrize("motion", MOTIONS)
def test_limits_are_met(motion):
    momentum, moments, h = MOTIONS[motion]
    there = free_rotation_series.rotated(START, momentum, moments, h)
    assert apart(rotated(START, momentum, moments, h), there) < bound(momentum, moments, h)


@pytest.mark.parametrize("seed", range(COUNT))
def test_random_motions_are_those_of_a_power_series(seed):
    rng = np.random.default_rng(seed)
    q, momentum, sums = rng.normal(size=4), rng.normal(size=3), 10.0 ** rng.uniform(-3, 0, 3)
    q, moments = q / np.linalg.norm(q), sums.sum() - sums
    h = time_of(rng.uniform(-30, 30), momentum, moments)
    there = free_rotation_series.rotated(q, momentum, moments, h)
    assert apart(rotated(q, momentum, moments, h), there) < bound(momentum, moments, h)


@pytest.mark.parametrize("moments", [(1, 1, 1.7), (1, 1, 1), (2, 2, 1e-6), (1, 1, 2)])
@pytest.mark.parametrize("h", [1e-3, 1.0, -100.0, 1e4])
def test_a_symmetric_body_precesses(moments, h):
    """About L at |L|/i1, beside the spin about its own axis (Euler)."""
    q, momentum = np.array((0.5, -0.5, 0.1, 0.7)), np.array((0.3, -0.5, 0.7))
    size, along = np.linalg.norm(momentum), body_axes(q, momentum)[2]
    about, own = 0.5 * size * h / moments[0], 0.5 * along * h * (1 / moments[2] - 1 / moments[0])
    there = times((math.cos(about), *(math.sin(about) * momentum / size)), q)
    there = times(there, (math.cos(own), 0.0, 0.0, math.sin(own)))
    assert apart(rotated(q, momentum, moments, h), there) < 4e-15 * (1.0 + abs(h) * size / min(moments))


def test_the_middle_axis_is_a_fixed_point():
    for h in (1.0, 1e3, -1e6):
        there = (math.cos(h / 4), 0.0, math.sin(h / 4), 0.0)
        assert apart(rotated(START, (0, 1, 0), (1, 2, 2.25), h), there) < 1e-15 * (1.0 + abs(h))


@pytest.mark.parametrize("h", [10.0, 100.0, 1e3, 1e5])
def test_a_body_on_the_separatrix_never_leaves_the_middle_axis(h):
    momentum = np.array((1.0, 0.0, 3.0))
    along = body_axes(rotated(START, momentum, SPLIT, h), momentum)
    speed = 10**0.5 * math.sqrt(0.5 / 18)  # at which it nears the axis
    assert abs(along[1]) == pytest.approx(10**0.5 * math.tanh(speed * h), rel=1e-14 * (1 + h**0.5))
    assert abs(along[0]) == pytest.approx(1 / math.cosh(min(speed * h, 700.0)), rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("momentum", [(0.9, 0.1, 0.3), (0.3, 0.1, -0.9), (-1, 0.001, 3), (-1.001, 0.001, 3)])
@pytest.mark.parametrize("moments", [SPLIT, (2.25, 2.0, 1.0), (1.1, 1.0, 2.0)])
def test_the_motion_is_continuous_in_time(momentum, moments):
    """In its sign too, over many turns."""
    times = np.linspace(-60.0, 60.0, 2401)
    q = np.array([rotated(START, momentum, moments, h) for h in times])
    fastest = np.linalg.norm(momentum) / min(moments)
    assert 2.0 * np.linalg.norm(np.diff(q, axis=0), axis=1).max() <= fastest * (times[1] - times[0])
    assert apart(q[1200], START) == 0.0


def test_without_momentum_nothing_turns():
    q = (0.5, -0.5, 0.1, 0.7)
    assert tuple(rotated(q, (0, 0, 0), (1, 2, 3), 1e9)) == q
    assert apart(rotated(q, (1e-200, 1e-180, 0), (1, 2, 3), 1e9), q) < 1e-15


def test_numbers_that_are_none_come_back_as_none():
    assert np.isnan(rotated(START, (math.nan, 1, 0), (1, 2, 3), 1.0)).all()
    assert np.isnan(rotated(START, (1, 1, 0), (1, 2, math.nan), 1.0)).any()
