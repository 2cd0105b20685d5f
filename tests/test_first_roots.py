"""First roots along rays, proved one ray at a time: exact where an exact value is known, none missed, none invented."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

from campaigns import examples
from plain_tapes import fan, implicit, kernels, sphere
from random_tapes import SMOOTH, arguments, rays, tapes
from sceneql.field.roots.isolation_kernels import any_root, exit_root, first_root
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.tape_solid import cast, field_values, scratch
from search_kernels import searched


@settings(max_examples=examples(300))
@given(tape=tapes(), ray=rays())
def test_no_crossing_is_missed_and_none_invented(tape, ray):
    origin, direction, t0, t1 = ray
    status, t = first_root(*arguments(tape), *origin, *direction, t0, t1, 1e-9)
    blocked = any_root(*arguments(tape), *origin, *direction, t0, t1, 1e-9)
    places = np.linspace(t0, t1, 801)
    inside = field_values(tape, origin + places[:, None] * direction) < 0.0
    near = 1e-9 * (t1 - t0) + 1e-14
    if inside.any():
        assert status != ops.MISS
        assert blocked != ops.MISS
        assert t <= places[np.argmax(inside)] + near
    if status == ops.INSIDE:
        assert t == t0
        assert inside[0]
    if status == ops.HIT:
        around = np.clip(t + near * np.array([0.0, 1e-3, 0.1, 1.0, 2.0]), t0, t1)
        assert (field_values(tape, origin + around[:, None] * direction) < 0.0).any()
    if status == ops.MISS:
        assert blocked == ops.MISS
    if status in (ops.HIT, ops.INSIDE):
        assert blocked != ops.MISS


@settings(max_examples=examples(200))
@given(tape=tapes(names=SMOOTH), ray=rays())
def test_the_way_out_is_the_way_into_the_negated_field(tape, ray):
    origin, direction, t0, t1 = ray
    status, t = exit_root(*arguments(tape), *origin, *direction, t0, t1, 1e-9)
    places = np.linspace(t0, t1, 401)
    outside = field_values(tape, origin + places[:, None] * direction) > 0.0
    assert not (status == ops.MISS and outside.any())
    if outside.any():
        assert t <= places[np.argmax(outside)] + 1e-9 * (t1 - t0) + 1e-14


def test_sphere_roots_are_exact():
    origins, directions = fan()
    status, t = cast(sphere(0.8), origins, directions, 0.0, 12.0)
    along = -np.einsum("ij,ij->i", origins, directions)
    left = 0.64 - (np.einsum("ij,ij->i", origins, origins) - along**2)
    assert ((status == ops.HIT) == (left > 0)).all()
    assert (status != ops.UNDECIDED).all()
    hit = status == ops.HIT
    assert t[hit] == pytest.approx(along[hit] - np.sqrt(left[hit]), rel=1e-12)


def test_torus_roots_are_exact():
    def formula(b, op, c):
        ring = op("sub", op("sqrt", op("add", op("square", b.x), op("square", b.z))), c(1.0))
        return op("sub", op("add", op("square", ring), op("square", b.y)), c(0.16))

    origins, directions = fan(spread=1.6)
    status, t = cast(implicit(formula), origins, directions, 0.0, 12.0)
    # (p^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2) along a ray is a quartic.
    for o, d, s, found in zip(origins, directions, status, t, strict=True):
        whole = np.polynomial.Polynomial([o @ o + 1.0 - 0.16, 2 * o @ d, 1.0])
        flat = np.polynomial.Polynomial([o[0] ** 2 + o[2] ** 2, 2 * (o[0] * d[0] + o[2] * d[2]), d[0] ** 2 + d[2] ** 2])
        roots = (whole * whole - 4.0 * flat).roots()
        real = sorted(root.real for root in roots if abs(root.imag) < 1e-9)
        assert (s == ops.HIT) == bool(real)
        if real:
            assert found == pytest.approx(real[0], rel=1e-9)


def test_radius_of_one_kernel():
    status, t = cast(kernels([(0, 0, 0)], 0.3), [[0, 0, 5]], [[0, 0, -1]], 0.0, 10.0)
    assert status[0] == ops.HIT
    assert 5.0 - t[0] == pytest.approx(math.sqrt(1.0 - 0.3 ** (1 / 3)), abs=1e-12)
    assert 5.0 - t[0] == pytest.approx(0.5749496064, abs=1e-10)


@pytest.mark.parametrize(("gap", "merged"), [(-1e-8, True), (1e-8, False)])
def test_two_kernels_merge_at_their_exact_distance(gap, merged):
    radius = 0.7
    apart = radius * 2.0 * math.sqrt(1.0 - 0.15 ** (1 / 3))
    assert apart / radius == pytest.approx(1.3691905863, abs=1e-10)
    apart *= 1.0 + gap
    tape = kernels([(-apart / 2, 0, 0), (apart / 2, 0, 0)], 0.3, radius)
    status, _ = cast(tape, [[0, 0, 4]], [[0, 0, -1]], 0.0, 8.0)
    assert status[0] == (ops.HIT if merged else ops.MISS)


def test_thin_shell_is_whole_and_its_four_roots_are_exact():
    radius, thickness = 0.7, 1e-3

    def formula(b, op, c):
        squares = [op("square", register) for register in (b.x, b.y, b.z)]
        r = op("sqrt", op("add", op("add", squares[0], squares[1]), squares[2]))
        return op("sub", op("abs", op("sub", r, c(radius))), c(thickness / 2))

    tape = implicit(formula)
    for b in np.linspace(0.0, 0.7, 101):
        outer = math.sqrt((radius + thickness / 2) ** 2 - b * b)
        expected = [2.0 - outer]
        if b < radius - thickness / 2:
            inner = math.sqrt((radius - thickness / 2) ** 2 - b * b)
            expected += [2.0 - inner, 2.0 + inner]
        expected += [2.0 + outer]
        found, start = [], 0.0
        for function in [first_root, exit_root] * (len(expected) // 2):
            status, t = function(*arguments(tape), b, 0.0, 2.0, 0.0, 0.0, -1.0, start, 4.0, 1e-9)
            assert status == ops.HIT
            found.append(t)
            start = t + 1e-6
        assert found == pytest.approx(expected, abs=1e-11)


def test_a_double_root_is_no_way_in():
    def squared(b, op):
        squares = [op("square", register) for register in (b.x, b.y, b.z)]
        return op("add", op("add", squares[0], squares[1]), squares[2])

    ray = [[0.1, 0.2, 3]], [[0, 0, -1]], 0.0, 6.0
    factored = implicit(lambda b, op, c: op("square", op("sub", squared(b, op), c(0.49))))
    assert cast(factored, *ray)[0][0] == ops.MISS
    # Where rounding makes values below zero of r^4 - 0.98 r^2 + 0.2401 there, that is not known.
    expanded = implicit(
        lambda b, op, c: op("add", op("mul", squared(b, op), op("sub", squared(b, op), c(0.98))), c(0.2401))
    )
    status, t = cast(expanded, *ray)
    assert status[0] == ops.UNDECIDED
    assert t[0] == pytest.approx(3.0 - math.sqrt(0.49 - 0.05), abs=1e-6)


@pytest.mark.parametrize("length", [1e-9, 1.0, 1e3])
def test_a_touch_at_the_start_is_no_hit(length):
    tape = implicit(lambda b, op, c: op("square", b.z))
    assert cast(tape, [[0, 0, 0]], [[0, 0, 1]], 0.0, length)[0][0] in (ops.MISS, ops.UNDECIDED)


def test_what_is_undefined_stays_so():
    tape = implicit(lambda b, op, c: op("pow", op("sqrt", b.x), b.y))
    assert np.isnan(field_values(tape, [[-1.0, 0.0, 0.0]])[0])


def test_a_capsule_of_the_field_is_round_and_straight():
    parts = np.array([[-0.5, 0, 0, 0.5, 0, 0, 0.6, 1.0]])
    tape = implicit(lambda b, op, c: op("sub", c(0.3), b.density(parts, b.x, b.y, b.z)))
    reach = 0.6 * 0.57494960639
    x = np.array([-0.5 - 0.9 * reach, -0.4, 0.0, 0.3, 0.5 + 0.5 * reach, 0.5 + 1.01 * reach])
    origins = np.column_stack([x, np.zeros(6), np.full(6, 3.0)])
    status, t = cast(tape, origins, np.array([[0, 0, -1.0]]), 0.0, 6.0)
    beyond = np.maximum(np.abs(x) - 0.5, 0.0)
    assert status.tolist() == [ops.HIT] * 5 + [ops.MISS]
    assert 3.0 - t[:5] == pytest.approx(np.sqrt(reach**2 - beyond[:5] ** 2), abs=1e-10)


def test_where_a_field_is_undefined_is_outside():
    tape = implicit(lambda b, op, c: op("sub", op("sqrt", b.z), c(2.0)))
    status, t = cast(tape, [[0, 0, 1]], [[0, 0, 1]], -4.0, 1.0)
    assert status[0] == ops.HIT
    assert t[0] == pytest.approx(-1.0, abs=1e-8)
    logarithm = implicit(lambda b, op, c: op("log", op("sub", b.x, c(10.0))))
    assert cast(logarithm, [[0, 0, 1]], [[1, 0, 0]], 0.0, 9.0)[0][0] == ops.MISS


@pytest.mark.parametrize("noise", [0.0, 1e3, 1e4, 1e5])
def test_a_bracket_within_the_tolerance_is_a_hit_though_rounding_leaves_none_narrower(noise):
    # x + noise - noise is known to noise 1e-16 alone: enclosures end there, and needed the certified intervals.
    def plane(build, op, c):
        return op("sub", op("add", op("sub", c(0.3), build.x), c(noise)), c(noise))

    tape = implicit(plane)
    where = np.array([-1.0, 0.1, 0.2]), np.array([1.0, 0.3, -0.2])
    for tolerance in (1e-9, 1e-8, 1e-6):
        program = tape.code, tape.constants, tape.parts, scratch(tape), *where
        status, t = searched(*program, 0.0, 2.0, tolerance, False)
        assert status == ops.HIT
        assert t == pytest.approx(1.3, abs=2.0 * tolerance)
        assert searched(*program, 0.0, 1.3 - 2.0 * tolerance, tolerance, False)[0] == ops.MISS


def test_what_rounding_hides_beyond_the_tolerance_is_left_to_the_certified_intervals():
    tape = implicit(lambda build, op, c: op("sub", op("add", op("sub", c(0.3), build.x), c(1e9)), c(1e9)))
    ray = np.array([-1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]), 0.0, 2.0, 1e-9
    status, t = searched(tape.code, tape.constants, tape.parts, scratch(tape), *ray, False)
    assert status == ops.UNDECIDED
    assert t < 1.3
