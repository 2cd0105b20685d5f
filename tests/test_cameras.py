"""Laws of cameras: what is fitted is in the picture and fills it; axes are right-handed; targets are in the middle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from moment import FakeMoment, const, link
from sceneql.kinds import Ref
from sceneql.pictures import framing
from sceneql.words.cameras.auto import HEADROOM, Auto
from sceneql.words.cameras.orthographic import Orthographic
from sceneql.words.cameras.perspective import Perspective
from sceneql.words.cameras.turntable import Turntable
from sceneql.words.objects.sphere import Sphere

SIZES = st.sampled_from([(640, 360), (300, 300), (360, 640)])
POINT = st.tuples(*[st.floats(-5, 5)] * 3)
SIDES = st.tuples(*[st.floats(0.1, 6)] * 3)


def seen(view, points):
    """Places (n, 2) in the picture, -1 to 1 from edge to edge, and distances (n,) in front of the camera."""
    p = (np.asarray(points, dtype=float) - view.origin) @ view.axes.T
    half = np.array([view.half_height * view.size[0] / view.size[1], view.half_height])
    return p[:, :2] / half / (1.0 if view.orthographic else -p[:, 2:]), -p[:, 2]


def check_axes(view):
    np.testing.assert_allclose(view.axes @ view.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(view.axes) == pytest.approx(1.0)
    assert view.axes.dtype == np.float64
    assert view.axes.flags.c_contiguous
    assert all(isinstance(c, float) for c in view.origin)


def check_framed(view, low, high, margin=0.08):
    places, depth = seen(view, framing.corners(low, high))
    assert (depth > 0).all()
    assert np.abs(places).max() <= 1 - margin + 1e-9
    assert np.abs(places).max() >= 1 - margin - 1e-9


def box_moment(center, sides, **more):
    low, high = np.subtract(center, np.divide(sides, 2)), np.add(center, np.divide(sides, 2))
    return FakeMoment(box=(low, high), **more), low, high


@settings(max_examples=100)
@given(POINT, SIDES, POINT, SIZES, st.floats(0.2, 1.4))  # wider, the nearest corner may touch the camera first
def test_perspective_fit_frames_the_box_and_touches_the_margin(center, sides, direction, size, angle):
    assume(np.linalg.norm(direction) > 0.1)
    moment, low, high = box_moment(center, sides)
    camera = Perspective(fit=(Ref("a"),), direction=const(direction), field_of_view=const(angle))
    view = camera.view(size, moment)
    check_axes(view)
    check_framed(view, low, high)
    np.testing.assert_allclose(view.axes[2], np.divide(direction, np.linalg.norm(direction)), atol=1e-9)


@settings(max_examples=100)
@given(POINT, SIDES, POINT, POINT, SIZES)
def test_perspective_fit_with_a_target_keeps_it_in_the_middle(center, sides, target, direction, size):
    assume(np.linalg.norm(direction) > 0.1)
    moment, low, high = box_moment(center, sides)
    camera = Perspective(fit=(Ref("a"),), direction=const(direction), look_at=const(target))
    view = camera.view(size, moment)
    check_framed(view, low, high)
    np.testing.assert_allclose(seen(view, [target])[0], 0, atol=1e-6)


@settings(max_examples=60)
@given(POINT, SIDES, SIZES)
def test_fit_is_the_nearest_place(center, sides, size):
    """Opposite edges of the picture are both touched, so nearer and sideways a corner is lost."""
    moment, low, high = box_moment(center, sides)
    view = Perspective(fit=(Ref("a"),), margin=0.0).view(size, moment)
    places, _ = seen(view, framing.corners(low, high))
    touched = np.isclose(places.max(axis=0), 1) & np.isclose(places.min(axis=0), -1)
    assert touched.any()


@settings(max_examples=60)
@given(POINT, POINT, POINT, SIZES)
def test_perspective_looks_from_its_position_at_its_target(position, target, up, size):
    assume(np.linalg.norm(np.subtract(position, target)) > 1e-3)
    assume(np.linalg.norm(np.cross(up, np.subtract(position, target))) > 1e-3)
    view = Perspective(position=const(position), look_at=const(target), up=const(up)).view(size, FakeMoment())
    check_axes(view)
    assert view.origin == pytest.approx(position)
    places, depth = seen(view, [target])
    np.testing.assert_allclose(places, 0, atol=1e-9)
    assert depth[0] == pytest.approx(np.linalg.norm(np.subtract(position, target)))
    assert view.axes[1] @ up > 0
    assert abs(view.axes[0] @ up) < 1e-9


def test_perspective_without_target_looks_at_the_middle_of_what_is_drawn():
    moment, low, high = box_moment((3, 1, -2), (1, 2, 1))
    view = Perspective(position=const([0, 0, 5])).view((640, 360), moment)
    np.testing.assert_allclose(seen(view, [(low + high) / 2])[0], 0, atol=1e-9)


def test_looking_straight_down_has_the_far_side_up():
    view = Perspective(position=const([0, 5, 0]), look_at=const([0, 0, 0])).view((64, 36), FakeMoment())
    check_axes(view)
    np.testing.assert_allclose(view.axes, [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-12)


def test_a_camera_at_its_own_target_is_refused():
    with pytest.raises(ValueError, match="own position"):
        Perspective(position=const([1, 1, 1]), look_at=const([1, 1, 1])).view((64, 36), FakeMoment())


def test_a_camera_too_far_away_for_numbers_is_told_so():
    camera = Perspective(position=const([1e300, 0, 0]), look_at=const([0, 0, 0]))
    with pytest.raises(ValueError, match=r"within 1e.100 m of what it looks at"):
        camera.view((16, 9), FakeMoment())


def test_perspective_follows_an_object_that_moves():
    ball = Sphere(position=link("fall", "position", (3,)))
    moment = FakeMoment(parts={"ball": ball}, given={("fall", "position"): np.array([1.0, 2.0, 3.0])})
    view = Perspective(follow=Ref("ball"), from_=const([0.6, 0.3, 3])).view((64, 36), moment)
    assert view.origin == pytest.approx((1.6, 2.3, 6.0))
    np.testing.assert_allclose(seen(view, [(1, 2, 3)])[0], 0, atol=1e-12)


def test_following_and_standing_exclude_each_other():
    with pytest.raises(ValueError, match="from"):
        Perspective(follow=Ref("ball"), position=const([0, 0, 5]))


@settings(max_examples=60)
@given(POINT, SIDES, SIZES, st.sampled_from(["x", "-x", "y", "-y", "z", "-z"]))
def test_orthographic_fit_frames_the_box_in_front_of_its_window(center, sides, size, along):
    moment, low, high = box_moment(center, sides)
    view = Orthographic(look_along=along, fit=(Ref("a"),)).view(size, moment)
    check_axes(view)
    check_framed(view, low, high)
    places, _ = seen(view, framing.corners(low, high))
    np.testing.assert_allclose(places.min(axis=0), -places.max(axis=0), atol=1e-9)
    axis = {"x": 0, "y": 1, "z": 2}[along[-1]]
    assert -view.axes[2][axis] == (-1.0 if along.startswith("-") else 1.0)


def test_orthographic_shows_the_height_asked_for_around_its_target():
    view = Orthographic(height=const(3.0), look_at=const([1, 2, 0])).view((640, 360), FakeMoment())
    places, _ = seen(view, [[1, 2, 0], [1, 3.5, 0], [1 + 1.5 * 16 / 9, 2, 0]])
    np.testing.assert_allclose(places, [[0, 0], [0, 1], [1, 0]], atol=1e-12)


def test_orthographic_looks_along_any_direction_and_follows():
    moment = FakeMoment(parts={"ball": Sphere(position=const([1, 1, 1]))})
    view = Orthographic(look_along=const([-1.0, -1.0, -1.0]), follow=Ref("ball")).view((64, 36), moment)
    check_axes(view)
    places, depth = seen(view, [[1, 1, 1]])
    np.testing.assert_allclose(places, 0, atol=1e-12)
    assert depth[0] > 0


@settings(max_examples=20)
@given(POINT, SIDES, SIZES, st.floats(-1, 1.2), st.floats(0, 20))
def test_turntable_keeps_its_distance_and_the_box_in_the_picture_all_the_way(center, sides, size, tilt, time):
    camera = Turntable(around=Ref("a"), tilt=const(tilt), seconds=5.0, start=const(0.4))
    moment, low, high = box_moment(center, sides)
    middle = (low + high) / 2
    first = camera.view(size, moment)
    moment.time = time
    view = camera.view(size, moment)
    check_axes(view)
    places, depth = seen(view, framing.corners(low, high))
    assert (depth > 0).all()
    assert np.abs(places).max() <= 0.93
    away = np.subtract(view.origin, middle)
    assert np.linalg.norm(away) == pytest.approx(np.linalg.norm(np.subtract(first.origin, middle)))
    assert away[1] == pytest.approx(np.linalg.norm(away) * np.sin(tilt))
    turned = np.arctan2(away[0], away[2]) - 0.4 - 2 * np.pi * time / 5.0
    assert np.cos(turned) == pytest.approx(1.0)


def test_turntable_at_a_given_distance():
    view = Turntable(distance=const(4.0), tilt=const(0.0), start=const(0.0)).view((64, 36), FakeMoment())
    assert view.origin == pytest.approx((0, 0, 4))


@settings(max_examples=20)
@given(POINT, SIDES, SIZES, st.floats(0, 8))
def test_turntable_follows_at_the_distance_that_its_box_asks_for(place, sides, size, time):
    ball = Sphere(position=link("fall", "position", (3,)))
    moment, low, high = box_moment((3, -2, 1), sides, parts={"ball": ball}, given={("fall", "position"): place})
    moment.time = time
    view = Turntable(follow=Ref("ball"), fit=(Ref("a"),)).view(size, moment)
    check_axes(view)
    away = np.subtract(view.origin, place)
    np.testing.assert_allclose(view.axes[2] * np.linalg.norm(away), away, atol=1e-9)
    standing = Turntable(fit=(Ref("a"),)).view(size, moment)
    assert np.linalg.norm(away) == pytest.approx(np.linalg.norm(standing.origin - (low + high) / 2))


def test_turntable_goes_around_one_part_with_others_in_the_picture():
    boxes = {"a": ((0, 0, 0), (1, 1, 1)), "b": ((-3, 0, -1), (2, 4, 1))}

    class Boxes(FakeMoment):
        def bounds(self, names):
            return np.min([boxes[n][0] for n in names], axis=0), np.max([boxes[n][1] for n in names], axis=0)

    view = Turntable(around=Ref("a"), fit=(Ref("a"), Ref("b"))).view((640, 360), Boxes())
    np.testing.assert_allclose(seen(view, [(0.5, 0.5, 0.5)])[0], 0, atol=1e-9)
    places, depth = seen(view, framing.corners(*boxes["b"]))
    assert (depth > 0).all()
    assert np.abs(places).max() <= 0.93


@pytest.mark.parametrize("other", [{"around": Ref("a")}, {"look_at": const([0, 0, 0])}])
def test_turntable_has_one_middle(other):
    with pytest.raises(ValueError, match="follows"):
        Turntable(follow=Ref("ball"), **other)


STILL = {"parts": {"ball": Sphere(position=const([1, 2, 3]))}}


@pytest.mark.parametrize(
    "camera",
    [
        Turntable(follow=Ref("ball"), distance=const(3.0)),
        Turntable(look_at=const([0, 0, 0]), distance=const(3.0)),
        Perspective(follow=Ref("ball")),
        Perspective(position=const([0, 0, 5]), look_at=const([0, 0, 0])),
    ],
)
def test_a_camera_that_needs_no_look_ahead_does_not_ask_for_bounds(camera):
    class Blind(FakeMoment):
        def bounds(self, names):
            raise AssertionError("asked for bounds")

    assert not camera.looks_ahead()
    check_axes(camera.view((64, 36), Blind(**STILL)))


@pytest.mark.parametrize("camera", [Perspective, Orthographic, Turntable])
def test_every_camera_can_look_at_follow_and_fit(camera):
    assert {"look_at", "follow", "fit"} <= set(camera.model_fields)


@pytest.mark.parametrize(("sides", "front"), [((2, 2, 0.2), True), ((2, 2, 2), False), ((0.4, 3, 0.4), False)])
def test_auto_frames_all_and_sees_what_is_flat_from_the_front(sides, front):
    moment, low, high = box_moment((0, 1, 0), sides)
    view = Auto().view((640, 360), moment)
    check_axes(view)
    places, depth = seen(view, framing.corners(low, high))
    assert (depth > 0).all()
    wide, tall = np.abs(places).max(axis=0) / (0.88, 0.88 * HEADROOM)
    assert max(wide, tall) == pytest.approx(1)
    assert (abs(view.axes[2][0]) < 1e-9) == front


@pytest.mark.parametrize("thin", [0, 1, 2])
def test_a_flat_map_keeps_its_right_angles(thin):
    moment, low, high = box_moment((0, 1, 0), tuple(0 if k == thin else 2 for k in range(3)))
    places, _ = seen(Auto().view((640, 360), moment), framing.corners(low, high))
    assert np.ptp(np.abs(places), axis=0) == pytest.approx(0, abs=1e-9)


def test_a_single_point_is_seen_from_outside():
    view = Auto().view((640, 360), FakeMoment(box=((1, 1, 1), (1, 1, 1))))
    _, depth = seen(view, [[1, 1, 1]])
    assert depth[0] > 0
