"""Laws of blends: fillets of exact shape and volume, no order of members, nothing changed where nothing meets."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moment import IDENTITY, FakeMoment, const, fields_of, link
from sceneql import pipeline
from sceneql.failure import RunFailure
from sceneql.field.enclose.interval_kernels import box as interval
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_solid import field_gradients, field_values, scratch
from sceneql.kinds import Ref
from sceneql.shapes.blend import bulge, comparators, largest, least
from sceneql.shapes.placement import affine, apply
from sceneql.words.objects.blobby import Blobby
from sceneql.words.objects.box import Box
from sceneql.words.objects.difference import Difference
from sceneql.words.objects.intersection import Intersection
from sceneql.words.objects.plane import Plane
from sceneql.words.objects.sphere import Sphere
from sceneql.words.objects.union import Union

WIDTHS = st.floats(0.05, 2)


def planes_tape(count, width, chosen=least, seed=0):
    """The blend of so many affine fields."""
    build = TapeBuilder()
    maps = np.random.default_rng(seed).normal(size=(count, 3, 4))
    values = [build.affine(rows, build.x, build.y, build.z)[0] for rows in maps]
    return build.finish(chosen(build, values, width)), maps[:, 0]


def by_the_simplex(values, width):
    """The least of sum w f - k/2 (1 - sum w^2) by bisection for the level of its weights: values (n, p)."""
    low, high = values.min(axis=0), values.min(axis=0) + width
    for _ in range(100):
        level = (low + high) / 2
        short = np.maximum(level - values, 0).sum(axis=0) < width
        low, high = np.where(short, level, low), np.where(short, high, level)
    weights = np.maximum(level - values, 0) / width
    return (weights * values).sum(axis=0) - width / 2 * (1 - (weights**2).sum(axis=0))


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 9), WIDTHS, st.integers(0, 999))
def test_it_is_the_least_mean_over_the_simplex(count, width, seed):
    points = np.random.default_rng(seed).uniform(-1, 1, (200, 3))
    tape, maps = planes_tape(count, width, seed=seed)
    values = maps[:, :3] @ points.T + maps[:, 3:]
    found = field_values(tape, points)
    np.testing.assert_allclose(found, by_the_simplex(values, width), atol=1e-11)
    first, second = np.sort(values, axis=0)[:2]
    alone = second - first >= width
    np.testing.assert_allclose(found[alone], first[alone], atol=1e-13)
    assert (found <= first + 1e-13).all()
    assert (found >= first - bulge(count, width) - 1e-13).all()
    tape, _ = planes_tape(count, width, largest, seed=seed)
    np.testing.assert_allclose(field_values(tape, points), -by_the_simplex(-values, width), atol=1e-11)


@pytest.mark.parametrize("count", [2, 3, 6])
def test_its_slope_has_no_steps(count):
    tape, _ = planes_tape(count, 0.5)
    start, step = np.array([-1.3, 0.4, 0.2]), np.array([2.6, -0.7, 0.1]) / 20000
    points = start + np.arange(20001)[:, None] * step
    jumps = np.abs(np.diff(field_gradients(tape, points), axis=0)).max()
    crease, _ = planes_tape(count, 0.0)
    assert jumps < 5e-3 < 0.5 < np.abs(np.diff(field_gradients(crease, points), axis=0)).max()


def test_equal_values_bulge_most():
    build = TapeBuilder()
    values = [build.op("add", build.x, build.constant(0.0))] * 2
    tape = build.finish(least(build, values, 0.4))
    assert field_values(tape, np.array([[0.3, 0, 0]]))[0] == pytest.approx(0.3 - bulge(2, 0.4))
    assert bulge(2, 0.4) == pytest.approx(0.1)


@given(st.permutations(range(13)))
def test_comparators_sort(numbers):
    for count in range(1, 14):
        row = [n for n in numbers if n < count]
        for a, b in comparators(count):
            assert a < b
            row[a], row[b] = min(row[a], row[b]), max(row[a], row[b])
        assert row == sorted(row)


PARTS = {
    "a": Sphere(radius=const(0.5), position=const([0.2, 0, 0])),
    "b": Box(size=const([1, 0.6, 0.4]), position=const([-0.3, 0.3, 0.1]), rotation=const([0.8, 0.3, -0.4, 0.33])),
    "c": Sphere(radius=const(0.4), position=const([0.1, 0.5, -0.2])),
    "d": Blobby(points=const([[0, 0, 0], [0.3, 0.2, 0.5]]), segments=((0, 1),), radius=const(0.5)),
}


@pytest.mark.parametrize("kind", [Union, Intersection, Difference])
def test_no_order_of_members_and_no_blend_of_nothing(kind):
    moment, points = FakeMoment(parts=PARTS), np.random.default_rng(2).uniform(-1.5, 1.5, (3000, 3))

    def values(names, **given):
        return fields_of(kind(of=tuple(map(Ref, names)), **given), moment, points)

    np.testing.assert_allclose(
        values("abcd", blend=const(0.3)), values("acdb" if kind is Difference else "dbca", blend=const(0.3)), atol=1e-14
    )
    np.testing.assert_array_equal(values("abcd", blend=const(0.0)), values("abcd"))
    if kind is Union:
        assert (values("abcd", blend=const(0.3)) < 0).sum() > (values("abcd") < 0).sum()
    else:
        assert (values("abcd", blend=const(0.3)) >= values("abcd") - 1e-14).all()


def test_the_edge_of_two_faces_becomes_a_parabola():
    parts = {"a": Box(size=const([2, 9, 9])), "b": Box(size=const([9, 9, 1]))}
    rounded = Intersection(of=(Ref("a"), Ref("b")), blend=const(0.3))
    away = np.linspace(0, 0.3, 31)
    other = (sqrt(0.3) - np.sqrt(away)) ** 2
    points = np.column_stack([1 - away, 0 * away, 0.5 - other])
    np.testing.assert_allclose(fields_of(rounded, FakeMoment(parts=parts), points), 0.0, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.01, 3), st.sampled_from(["ab", "bc", "bd", "abc", "abcd"]), st.integers(0, 999))
def test_the_box_of_a_blended_union_holds_it(width, names, seed):
    moment = FakeMoment(parts=PARTS)
    place = affine((0.1, 0.4, 0), (1, 0.5, 0.2, 0), 0.7)
    union = Union(of=tuple(map(Ref, names)), blend=const(width), rotation=const([0.9, 0.1, 0.5, -0.2]))
    low, high = union.extent(place, moment)
    points = np.random.default_rng(seed).uniform(-4, 4, (4000, 3))
    inside = apply(place, points[fields_of(union, moment, points) < 0])
    assert (inside >= low).all()
    assert (inside <= high).all()


def test_two_spheres_are_one_where_their_blend_reaches():
    def middle(apart, width):
        parts = {"a": Sphere(position=const([-apart / 2, 0, 0])), "b": Sphere(position=const([apart / 2, 0, 0]))}
        return fields_of(Union(of=(Ref("a"), Ref("b")), blend=const(width)), FakeMoment(parts=parts), [[0.0, 0, 0]])[0]

    # Both fields are apart / 2 - 0.5 there, and the bulge is width / 4.
    assert middle(1.0 + 0.2 - 1e-9, 0.4) < 0 < middle(1.0 + 0.2 + 1e-9, 0.4)


def test_a_blend_with_the_ground_is_cut_at_no_box():
    parts = {"a": Plane(), "b": Sphere(position=const([0, 0.6, 0]))}
    union = Union(of=(Ref("a"), Ref("b")), blend=const(0.5))
    points = np.array([[0.0, 0.05, 0], [3, 0.01, 0], [3, -0.01, 0]])
    assert (fields_of(union, FakeMoment(parts=parts), points) < 0).tolist() == [True, False, True]


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 5), WIDTHS, st.integers(0, 999))
def test_intervals_of_blends_contain_their_values(count, width, seed):
    chance = np.random.default_rng(seed)
    tape, _ = planes_tape(count, width, seed=seed)
    for size in (0.01, 0.3, 2.0):
        low = chance.uniform(-1.5, 1.5, 3)
        high = low + size * chance.uniform(0, 1, 3)
        ends = [float(c) for pair in zip(low, high, strict=True) for c in pair]
        first, last, _ = interval(tape.code, tape.constants, tape.parts, scratch(tape), *ends)
        values = field_values(tape, chance.uniform(low, high, (60, 3)))
        assert (values >= first).all()
        assert (values <= last).all()


SCENE = """
objects:
  bar:
    intersection:
      of:
        - {intersection: {of: [{box: {size: 1 8 8 m}}, {box: {size: 8 8 1 m}}], blend: 0.3 m}}
        - {box: {size: 8 2 8 m}}
outputs: {still: {image: {size: 32 32}}}
"""


def test_volume_of_rounded_edges(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    (moment,) = pipeline.simulate(pipeline.load(path), [0.0])
    # Each edge loses the area k^2 / 6 outside of sqrt(x) + sqrt(z) = sqrt(k).
    assert moment.read("bar", "volume") == pytest.approx(2 * (1 - 4 * 0.3**2 / 6), rel=2e-4)


def test_a_blend_that_varies_below_zero_fails_at_its_time():
    union = Union(of=(Ref("a"), Ref("c")), blend=link("m", "r"))
    with pytest.raises(RunFailure, match=r"at 2 s, blend: must be at least 0"):
        list(union.lower("it", IDENTITY, FakeMoment(time=2.0, parts=PARTS, given={("m", "r"): -0.1})))
