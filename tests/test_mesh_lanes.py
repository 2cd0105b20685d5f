"""Evaluators of many points agree with those of one; bounds of slopes hold."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from meshes import tape_of
from random_tapes import tapes
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.batch_gradient_kernels import differentiate
from sceneql.field.tape.batch_kernels import LANES, evaluate
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.curvature_kernels import curvature
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.steepness_kernels import steepness
from sceneql.field.tape.tape_ops import WHOLE
from sceneql.field.tape.tape_solid import field_gradients, field_values, many_gradients, scratch
from sceneql.frame import Tape


def program(tape):
    return tape.code, tape.constants, tape.parts


@st.composite
def boxes(draw):
    low = np.array([draw(st.floats(-2.0, 2.0)) for _ in range(3)])
    return low, low + draw(st.sampled_from([1e-3, 0.1, 0.5, 2.0]))


@settings(max_examples=examples(150))
@given(tape=tapes(), place=boxes(), seed=st.integers(0, 9))
def test_evaluators_of_many_points_agree_to_the_bit_also_when_simplified(tape, place, seed):
    low, high = place
    points = np.zeros((3, LANES))
    points[:, :40] = np.random.default_rng(seed).uniform(low, high, (40, 3)).T
    room = scratch(tape)
    sides = [float(c) for pair in zip(low, high, strict=True) for c in pair]
    status = box(*program(tape), room, *sides)[2]
    short, near = np.empty_like(tape.code), np.empty_like(tape.parts)
    rows, used = simplify(tape.code, tape.parts, room, status == WHOLE, short, near)
    expected = field_values(tape, points[:, :40].T)
    slopes = field_gradients(tape, points[:, :40].T)
    with np.errstate(all="ignore"):
        assert np.array_equal(many_gradients(tape, points.T), field_gradients(tape, points.T), equal_nan=True)
    for shorter in (tape, Tape(short[:rows], tape.constants, near[:used])):
        registers, slope = np.zeros((len(shorter.code), LANES)), np.zeros((len(shorter.code), 3, LANES))
        evaluate(*program(shorter), registers, points, 40)
        assert np.array_equal(registers[len(shorter.code) - 1, :40], expected, equal_nan=True)
        with np.errstate(all="ignore"):
            differentiate(*program(shorter), registers, slope, 40)
        assert np.array_equal(slope[-1, :, :40].T, slopes, equal_nan=True)


@settings(max_examples=examples(300))
@given(tape=tapes(), place=boxes(), seed=st.integers(0, 9))
def test_steepness_bounds_how_fast_any_tape_changes(tape, place, seed):
    low, high = place
    room = scratch(tape)
    sides = [float(c) for pair in zip(low, high, strict=True) for c in pair]
    if box(*program(tape), room, *sides)[2] != WHOLE:
        return
    bounds = np.array(steepness(*program(tape), room))
    if not np.isfinite(bounds).all():
        return
    ends = np.random.default_rng(seed).uniform(low, high, (2, 40, 3))
    f = [field_values(tape, end) for end in ends]
    most = (np.abs(ends[1] - ends[0]) * bounds).sum(axis=1)
    assert (np.abs(f[1] - f[0]) <= most * (1 + 1e-9) + 1e-9 * (1 + np.abs(f[0]))).all()


def curvatures(tape, place):
    """Bounds (3, 2) of the second derivatives along the axes in a box; None where they are not known."""
    room, second = scratch(tape), np.zeros((len(tape.code), 6))
    sides = [float(c) for pair in zip(*place, strict=True) for c in pair]
    if box(*program(tape), room, *sides)[2] != WHOLE or not np.isfinite(steepness(*program(tape), room)).all():
        return None
    return second[-1].reshape(3, 2) if curvature(tape.code, tape.parts, room, second) else None


def no_slope_turns_faster(tape, place, seed, known):
    rng = np.random.default_rng(seed)
    for axis in range(3):
        first, last = rng.uniform(*place, (2, 40, 3))
        last[:, [k for k in range(3) if k != axis]] = first[:, [k for k in range(3) if k != axis]]
        turned = (field_gradients(tape, last) - field_gradients(tape, first))[:, axis]
        along = last[:, axis] - first[:, axis]
        bounds = np.sort(along[:, None] * known[axis], axis=1)
        slack = 1e-9 * (1 + np.abs(field_gradients(tape, first)[:, axis]) + np.abs(bounds).max(axis=1))
        assert (bounds[:, 0] - slack <= turned).all()
        assert (turned <= bounds[:, 1] + slack).all()


@settings(max_examples=examples(300))
@given(tape=tapes(), place=boxes(), seed=st.integers(0, 9))
def test_curvature_bounds_how_fast_the_slope_of_any_tape_changes(tape, place, seed):
    known = curvatures(tape, place)
    if known is not None:
        no_slope_turns_faster(tape, place, seed, known)


@settings(max_examples=examples(100))
@given(place=boxes(), seed=st.integers(0, 9))
def test_curvature_is_known_and_right_of_points_in_stretched_coordinates(place, seed):
    rng, build = np.random.default_rng(seed), TapeBuilder()
    points = np.column_stack([*[rng.uniform(-2, 2, (6, 3))] * 2, rng.uniform(0.3, 2, 6), rng.uniform(-1, 1, 6)])
    x, y, z = (build.op("mul", r, build.constant(c)) for r, c in ((build.x, 2.0), (build.y, 1.0), (build.z, -0.5)))
    tape = build.finish(build.density(points, x, y, z))
    no_slope_turns_faster(tape, place, seed, curvatures(tape, place))
    # third derivatives go up to some 1e3 here, so that the box has to be this small
    middle, near = place[0], (place[0] - 1e-7, place[0] + 1e-7)
    assert (np.diff(curvatures(tape, near)) < 1e-3).all()
    turned = [field_gradients(tape, middle[None] + s * 1e-5 * np.eye(3)).diagonal() for s in (1, -1)]
    assert np.allclose((turned[0] - turned[1]) / 2e-5, curvatures(tape, near).mean(axis=1), atol=1e-3)


def test_curvature_is_sharp_where_terms_are_of_one_variable():
    tape = tape_of("x^4 - 5*x^2 + exp(y)/(2 + z) + sqrt(1 + z) + log(x)*cos(y) + x^2.5")
    room, second = scratch(tape), np.zeros((len(tape.code), 6))
    x, y, z, h = 1.3, 0.4, 0.7, 1e-6
    assert box(*program(tape), room, x - h, x + h, y - h, y + h, z - h, z + h)[2] == WHOLE
    assert np.isfinite(steepness(*program(tape), room)).all()
    assert curvature(tape.code, tape.parts, room, second)
    exact = (
        12 * x**2 - 10 - np.cos(y) / x**2 + 3.75 * x**0.5,
        np.exp(y) / (2 + z) - np.log(x) * np.cos(y),
        2 * np.exp(y) / (2 + z) ** 3 - 0.25 * (1 + z) ** -1.5,
    )
    for axis, value in enumerate(exact):
        least, most = second[-1, 2 * axis : 2 * axis + 2]
        assert least <= value <= most < least + 1e-3
