"""Laws of warps: the field at a moved place is that of the place, boxes hold what is moved, volumes are exact."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from moment import IDENTITY, FakeMoment, const, drawn, fields_of
from sceneql import pipeline
from sceneql.field.enclose.interval_kernels import box as interval
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_ops import HIT, INSIDE
from sceneql.field.tape.tape_solid import cast, field_gradients, field_values, scratch
from sceneql.kinds import Ref
from sceneql.shapes.placement import affine, apply
from sceneql.shapes.warp import arc, steepest
from sceneql.words.objects.bend import Bend
from sceneql.words.objects.box import Box
from sceneql.words.objects.cylinder import Cylinder
from sceneql.words.objects.plane import Plane
from sceneql.words.objects.sphere import Sphere
from sceneql.words.objects.taper import Taper
from sceneql.words.objects.twist import Twist

SIZE = (0.5, 1.6, 0.3)
OFF = (0.1, 0.3, -0.05)
BAR = Box(size=const(SIZE), position=const(OFF))
MOMENT = FakeMoment(parts={"bar": BAR})
PLACED = {"position": const([0.3, -0.2, 0.1]), "rotation": const([0.9, 0.2, -0.3, 0.1])}
ORDER = {"x": (0, 1, 2), "y": (1, 2, 0), "z": (2, 0, 1)}


def twisted(angle, per, about="y"):
    """The word and its map of points, written from the definition."""
    along, a, b = ORDER[about]

    def forward(p):
        turn, q = angle * p[:, along] / per, p.copy()
        q[:, a] = np.cos(turn) * p[:, a] - np.sin(turn) * p[:, b]
        q[:, b] = np.sin(turn) * p[:, a] + np.cos(turn) * p[:, b]
        return q

    return Twist(of=Ref("bar"), angle=const(angle), per=const(per), about=about), forward


def bent(angle, per, along="y", towards="x"):
    x, y = "xyz".index(towards), "xyz".index(along)

    def forward(p):
        radius, q = per / angle, p.copy()
        q[:, x] = radius - (radius - p[:, x]) * np.cos(p[:, y] / radius)
        q[:, y] = (radius - p[:, x]) * np.sin(p[:, y] / radius)
        return q

    return Bend(of=Ref("bar"), angle=const(angle), per=const(per), along=along, towards=towards), forward


def tapered(factor, start, stop, along="y"):
    k, a, b = ORDER[along]

    def forward(p):
        scale = 1.0 + (factor - 1.0) * np.clip((p[:, k] - start) / (stop - start), 0.0, 1.0)
        q = p.copy()
        q[:, a], q[:, b] = scale * p[:, a], scale * p[:, b]
        return q

    ends = {"from_": const(start), "to": const(stop)}
    return Taper(of=Ref("bar"), factor=const(factor), along=along, **ends), forward


turns = st.floats(-4, 4).filter(lambda angle: abs(angle) > 1e-3)
WARPS = st.one_of(
    st.builds(twisted, turns, st.floats(0.5, 3), st.sampled_from("xyz")),
    st.builds(lambda angle, pair: bent(angle, 2.0, *pair), turns, st.sampled_from(["yx", "yz", "xy", "zx", "zy"])),
    st.builds(tapered, st.floats(0.1, 3), st.floats(-1, 0.4), st.floats(0.5, 2), st.sampled_from("xyz")),
)


def spread(count, seed, grown=1.0):
    """Points by chance in the bar's box, or in one that is larger."""
    return OFF + grown * np.random.default_rng(seed).uniform(-0.5, 0.5, (count, 3)) * SIZE


def fits(warp):
    """Whether the bar can be bent so: it ends before the center and before a full turn."""
    try:
        warp.reach(MOMENT)
    except ValueError:
        return False
    return True


@settings(max_examples=80, deadline=None)
@given(WARPS, st.integers(0, 999))
def test_the_field_at_a_moved_place_is_that_of_the_place(pair, seed):
    warp, forward = pair
    assume(fits(warp))
    points = spread(200, seed, 1.3)
    if isinstance(warp, Bend):  # beyond the center, and beyond half a turn from the middle, other places are moved here
        rate, middle = float(MOMENT.at(warp.angle)) / 2.0, OFF["xyz".index(warp.along)]
        near = np.abs(rate * (points[:, "xyz".index(warp.along)] - middle)) < pi - 1e-6
        points = points[near & (rate * points[:, "xyz".index(warp.towards)] < 1 - 1e-6)]
    before, after = fields_of(BAR, MOMENT, points), fields_of(warp, MOMENT, forward(points))
    clear = np.abs(before) > 1e-9
    np.testing.assert_array_equal((after < 0)[clear], (before < 0)[clear])


@settings(max_examples=80, deadline=None)
@given(WARPS, st.integers(0, 999))
def test_the_box_holds_what_is_moved_and_is_near_it(pair, seed):
    warp, forward = pair
    assume(fits(warp))
    place = affine((0.3, 0.1, -0.2), (0.5, -0.5, 0.2, 0.6), 1.3)
    inside = spread(400, seed)
    low, high = warp.extent(place, MOMENT)
    moved = apply(place, forward(inside))
    assert (moved > low - 1e-9).all()
    assert (moved < high + 1e-9).all()
    low, high = warp.extent(IDENTITY, MOMENT)
    edges = OFF + np.array(SIZE) * np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 33)] * 3), axis=-1).reshape(-1, 3)
    np.testing.assert_allclose([low, high], [forward(edges).min(axis=0), forward(edges).max(axis=0)], atol=0.02)


@settings(max_examples=40, deadline=None)
@given(WARPS, st.integers(0, 999))
def test_a_distance_is_nowhere_steeper_than_one_at_the_surface(pair, seed):
    warp, forward = pair
    assume(fits(warp))
    build = TapeBuilder()
    tape = build.finish(warp.implicit(build, build.x, build.y, build.z, MOMENT))
    faces = spread(60, seed)
    for k, sign in enumerate(np.random.default_rng(seed).choice((-1, 1), 60)):
        faces[k, k % 3] = OFF[k % 3] + sign * (0.5 * SIZE[k % 3] - 1e-9)
    slopes = np.linalg.norm(field_gradients(tape, forward(faces)), axis=1)
    assert (slopes < 1 + 1e-6).all()
    assert slopes.max() > 0.02  # nor is it divided by much more than its steepest place asks for


@pytest.mark.parametrize(
    "warp",
    [
        Twist(of=Ref("bar"), angle=const(0.0)),
        Bend(of=Ref("bar"), angle=const(0.0)),
        Taper(of=Ref("bar"), factor=const(1.0)),
    ],
)
def test_what_changes_nothing_gives_the_object_itself(warp):
    points = spread(500, 1, 2.0)
    np.testing.assert_array_equal(fields_of(warp, MOMENT, points), fields_of(BAR, MOMENT, points))
    np.testing.assert_array_equal(warp.extent(IDENTITY, MOMENT), BAR.extent(IDENTITY, MOMENT))


def test_a_round_column_twisted_about_its_axis_is_itself():
    column = Cylinder(radius=const(0.4), height=const(1.5))
    moment = FakeMoment(parts={"column": column})
    warp = Twist(of=Ref("column"), angle=const(5.0))
    points = np.random.default_rng(3).uniform(-1, 1, (4000, 3))
    before, after = fields_of(column, moment, points), fields_of(warp, moment, points)
    slope = steepest(1.0, 5.0 * sqrt(2) * 0.4, 1.0)
    np.testing.assert_allclose(after * slope, before, atol=1e-12)


def test_a_round_beam_bent_along_a_circle_is_a_piece_of_a_torus():
    moment = FakeMoment(parts={"beam": Cylinder(radius=const(0.2), height=const(5.0))})
    warp = Bend(of=Ref("beam"), angle=const(1.0), per=const(1.0))  # the circle's radius is 1 m, the arc 5 rad
    points = np.random.default_rng(4).uniform((-0.4, -1.4, -0.3), (2.4, 1.4, 0.3), (6000, 3))
    across = np.hypot(1.0 - points[:, 0], points[:, 1])
    torus = np.hypot(across - 1.0, points[:, 2]) < 0.2
    inside = torus & (np.abs(np.arctan2(points[:, 1], 1.0 - points[:, 0])) < 2.5)
    assert (torus & ~inside).sum() > 20
    np.testing.assert_array_equal(fields_of(warp, moment, points) < 0, inside)
    np.testing.assert_array_equal(drawn(warp.lower("ring", IDENTITY, moment), points), inside)


def test_small_bends_are_nearly_none():
    points = spread(500, 1, 1.5)
    straight = fields_of(BAR, MOMENT, points)
    for angle in (1e-3, 1e-6, -1e-6):
        bend = Bend(of=Ref("bar"), angle=const(angle))
        np.testing.assert_allclose(fields_of(bend, MOMENT, points), straight, atol=2 * abs(angle) + 1e-9)


@settings(max_examples=60, deadline=None)
@given(WARPS, st.integers(0, 999))
def test_intervals_of_warped_tapes_contain_their_values(pair, seed):
    warp, _ = pair
    assume(fits(warp))
    chance = np.random.default_rng(seed)
    build = TapeBuilder()
    tape = build.finish(warp.implicit(build, build.x, build.y, build.z, MOMENT))
    for size in (0.01, 0.3, 2.0):
        low = chance.uniform(-1.5, 1.5, 3)
        high = low + size * chance.uniform(0, 1, 3)
        ends = [float(c) for pair in zip(low, high, strict=True) for c in pair]
        least, most, _ = interval(tape.code, tape.constants, tape.parts, scratch(tape), *ends)
        values = field_values(tape, chance.uniform(low, high, (60, 3)))
        assert (values >= least).all()
        assert (values <= most).all()


@settings(max_examples=25, deadline=None)
@given(WARPS, st.integers(0, 999))
def test_rays_meet_a_warped_object_where_its_field_first_is_negative(pair, seed):
    warp, _ = pair
    assume(fits(warp))
    chance = np.random.default_rng(seed)
    build = TapeBuilder()
    tape = build.finish(warp.implicit(build, build.x, build.y, build.z, MOMENT))
    low, high = warp.extent(IDENTITY, MOMENT)
    target = chance.uniform(low, high, (20, 3))
    origins = (low + high) / 2 + 3.0 * chance.normal(size=(20, 3))
    direction = target - origins
    t = np.linspace(0, 2, 2001)
    status, hit = cast(tape, origins, direction, 0.0, 2.0)
    for i in range(20):
        values = field_values(tape, origins[i] + t[:, None] * direction[i])
        below = np.flatnonzero(values < -1e-9)
        if len(below):
            assert status[i] == (HIT if below[0] else INSIDE)
            assert hit[i] <= t[below[0]] + 1e-9
        if status[i] == HIT:
            assert abs(field_values(tape, (origins[i] + hit[i] * direction[i])[None])[0]) < 1e-6


SCENE = """
objects:
  bar: {{box: {{size: 0.4 1.5 0.3 m, position: {at}}}}}
  it: {{{word}: {{of: bar, {numbers}}}}}
outputs: {{still: {{image: {{size: 32 32}}}}}}
"""


@pytest.mark.parametrize(
    ("word", "numbers", "at", "volume"),
    [
        ("twist", "angle: 150 deg", "0.1 0 0 m", 0.4 * 1.5 * 0.3),
        ("bend", "angle: 120 deg", "0 0.2 0 m", 0.4 * 1.5 * 0.3),  # Pappus: the middles' arc is as long as the beam
        ("taper", "factor: 0.4", "0 0 0 m", 0.4 * 0.3 * 1.5 * (1 + 0.4 + 0.16) / 3),
        ("taper", "factor: 2, from: 0 m, to: 0.5 m", "0 0 0 m", 0.12 * (0.75 + 0.5 * (1 + 2 + 4) / 3 + 0.25 * 4)),
    ],
)
def test_volumes_are_those_of_the_integrals(tmp_path, word, numbers, at, volume):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.format(word=word, numbers=numbers, at=at))
    (moment,) = pipeline.simulate(pipeline.load(path), [0.0])
    assert moment.read("it", "volume") == pytest.approx(volume, rel=2e-3)
    assert moment.read("it", "pieces") == 1


def test_it_is_drawn_in_its_objects_color_unless_it_has_one():
    parts = {"bar": Box(color=const([0.1, 0.2, 0.3]))}
    for own, color in (({}, (0.1, 0.2, 0.3)), ({"color": const([1, 0, 0])}, (1.0, 0.0, 0.0))):
        (shape,) = Twist(of=Ref("bar"), **own).lower("it", IDENTITY, FakeMoment(parts=parts))
        assert shape.surface.color == color


def test_a_warped_thing_has_a_place():
    points = np.random.default_rng(5).uniform(-1.0, 1.0, (9000, 3))
    warp, _ = twisted(2.0, 1.0)
    placed = warp.model_copy(update=PLACED)
    moved = apply(affine((0.3, -0.2, 0.1), (0.9, 0.2, -0.3, 0.1)), points)
    np.testing.assert_allclose(fields_of(placed, MOMENT, moved), fields_of(warp, MOMENT, points), atol=1e-12)
    inside = fields_of(warp, MOMENT, points) < 0
    assert inside.sum() > 50
    np.testing.assert_array_equal(drawn(placed.lower("it", IDENTITY, MOMENT), moved), inside)


@pytest.mark.parametrize(
    ("warp", "why"),
    [
        (Twist(of=Ref("floor")), "'floor' is unbounded"),
        (Bend(of=Ref("floor")), "'floor' is unbounded"),
        (Taper(of=Ref("floor")), "needs `from` and `to`"),
        (Bend(of=Ref("ball"), angle=const(2.1)), "reaches the center"),
        (Bend(of=Ref("long"), angle=const(0.7)), "1.114 turns"),
        (Taper(of=Ref("ball"), from_=const(0.6)), "not above"),
    ],
)
def test_what_cannot_be_warped_is_refused(warp, why):
    parts = {"floor": Plane(), "ball": Sphere(), "long": Cylinder(radius=const(0.1), height=const(10.0))}
    with pytest.raises(ValueError, match=why):
        list(warp.lower("it", IDENTITY, FakeMoment(parts=parts)))


def test_what_is_nowhere_stays_so():
    from sceneql.words.objects.intersection import Intersection

    far = Sphere(position=const([5, 0, 0]))
    parts = {"a": Sphere(), "b": far, "none": Intersection(of=(Ref("a"), Ref("b")))}
    for word in (Twist, Bend, Taper):
        assert not list(word(of=Ref("none")).lower("it", IDENTITY, FakeMoment(parts=parts)))


@given(st.floats(0, 3), st.floats(-7, 7), st.floats(0, 7))
def test_arcs_have_their_extremes(radius, start, angle):
    (low, high), (down, up) = arc(radius, start, start + angle)
    along = start + np.linspace(0, angle, 4001)
    x, y = radius * np.cos(along), radius * np.sin(along)
    np.testing.assert_allclose([low, high, down, up], [x.min(), x.max(), y.min(), y.max()], atol=1e-5)
    assert low <= radius * cos(start) <= high
    assert down <= radius * sin(start) <= up


@given(st.floats(0, 5), st.floats(-5, 5), st.floats(0, 5))
def test_the_steepest_is_the_largest_singular_value(stretch, shear, along):
    known = np.linalg.norm([[stretch, shear], [0.0, along]], 2)
    assert steepest(stretch, shear, along) == pytest.approx(known, rel=1e-9, abs=1e-12)
