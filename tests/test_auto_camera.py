"""The default camera of what is flat and tilted: large in the picture, from above the ground, upright from the side."""

from __future__ import annotations

import math

import numpy as np
import pytest

from moment import FakeMoment
from sceneql.shapes.placement import rotation_matrix
from sceneql.words.cameras.auto import FULL, HEADROOM, HIGHEST, LOWEST, STEEP, THREE_QUARTER, Auto

SIZE = (640, 360)
LARGE = 0.44
"""Least part of the picture's width and height, after margins, that a flat ring takes: face on it takes 0.53."""


class Outlined(FakeMoment):
    """A moment of points that are drawn."""

    def __init__(self, points):
        super().__init__(box=(points.min(axis=0), points.max(axis=0)))
        self.points = points

    def outline(self):
        """The points."""
        return self.points


def turned(about, angle):
    half = math.radians(angle) / 2
    return rotation_matrix(np.array([math.cos(half), *(math.sin(half) * np.array(about))]))


def ring(*turns, thick=0.1):
    """Points of a flat ring about the y axis, turned about axes one after the other; and its normal."""
    around = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    points = np.column_stack([3 * np.cos(around), np.zeros(60), 3 * np.sin(around)])
    points = np.concatenate([points + thick * side for axis in np.eye(3) for side in (axis, -axis)])
    normal = np.array([0.0, 1.0, 0.0])
    for about, angle in turns:
        points, normal = points @ turned(about, angle).T, turned(about, angle) @ normal
    return points + 1.0, normal


def shares(view, points):
    p = (points - view.origin) @ view.axes.T
    half = np.array([view.half_height * view.size[0] / view.size[1], view.half_height])
    return np.ptp(p[:, :2] / half / -p[:, 2:], axis=0) / 2


@pytest.mark.parametrize("tilt", [-60, -35, -20, -12, 12, 20, 35, 60])
@pytest.mark.parametrize("turn", [0, 30, 45, 90, 135, 200])
def test_a_tilted_ring_is_large_and_seen_from_above_the_ground(tilt, turn):
    points, normal = ring(((1, 0, 0), tilt), ((0, 1, 0), turn))
    view = Auto().view(SIZE, Outlined(points))
    back = view.axes[2]
    assert LOWEST - 0.01 <= back[1] <= HIGHEST + 0.02
    assert abs(normal @ back) >= FULL - 0.02
    wide, high = shares(view, points)
    assert min(wide / 0.88, high / (0.88 * HEADROOM)) > LARGE
    assert max(wide / 0.88, high / (0.88 * HEADROOM)) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("turn", [20, 45, 70, 110, 160])
def test_what_stands_upright_is_seen_from_the_side(turn):
    """As a pendulum that swings in a plane between the axes."""
    points, normal = ring(((1, 0, 0), 90), ((0, 1, 0), turn))
    back = Auto().view(SIZE, Outlined(points)).axes[2]
    assert abs(normal @ back) > 0.9 or np.dot(normal, THREE_QUARTER) ** 2 > 0.5
    assert 0 < back[1] < STEEP


def test_what_is_thick_is_seen_as_ever():
    points, _ = ring(((1, 0, 0), 20), ((0, 1, 0), 45), thick=1.5)
    view = Auto().view(SIZE, Outlined(points))
    np.testing.assert_allclose(view.axes[2], np.array(THREE_QUARTER) / math.hypot(*THREE_QUARTER))


def test_the_view_of_a_tilted_ring_does_not_hang_on_rounding():
    points, _ = ring(((1, 0, 0), -20), ((0, 1, 0), 45))
    one = Auto().view(SIZE, Outlined(points)).axes[2]
    for seed in range(5):
        off = points + 1e-13 * np.random.default_rng(seed).normal(size=points.shape)
        np.testing.assert_allclose(Auto().view(SIZE, Outlined(off)).axes[2], one, atol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_few_points_are_seen_from_somewhere(count):
    points = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [0.5, 1.0, -1.0]])[:count]
    view = Auto().view(SIZE, Outlined(points))
    assert np.isfinite(view.origin).all()


@pytest.mark.parametrize("room", [(0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.4), (0.0, 0.3, 0.0, 0.0)])
def test_the_ground_under_what_is_flat_is_seen_from_above_whatever_overlays_leave(room):
    """Else shadows on it are seen along the ground, which fades there into the background."""
    points = np.array([[x, y, z] for x in (-9.0, 9.0) for y in (0.0, 2.0) for z in (-0.1, 0.1)])
    moment = Outlined(points)
    moment.room = room
    view = Auto().view(SIZE, moment)
    away = np.array(view.origin)
    assert away[1] / np.linalg.norm(away) > 0.09
    places = (points - view.origin) @ view.axes.T
    high = 0.5 - 0.5 * places[:, 1] / -places[:, 2] / view.half_height
    assert room[1] < high.min() < high.max() < 1.0 - room[3]
