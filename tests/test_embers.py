"""Laws of the light of small spheres that glow."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing.light.embers import embers_of
from sceneql.frame import PointLight, Surface
from stage import WHITE, frame, view

SEEN = view((0, 3, 4), (0, 0.2, 0), (96, 72), 0.3, orthographic=False)
SHINE = np.array([4.0, 2.0, 1.0])
GLOWING = Surface(color=(0.0,) * 3, specular=0.0, roughness=1.0, emission=tuple(SHINE))
BLACK = Surface(color=(0.0,) * 3, specular=0.0, roughness=1.0)
RADIUS = 4e-3
PLACES = np.random.default_rng(1).uniform((-1.5, 1.2, -1.5), (1.5, 1.6, 1.5), (400, 3))
SPOTS = np.array([[0.0, 0.0, 0.0], [-0.4, 0.0, 0.3], [0.6, 0.0, -0.2]])
HIDING = np.array([0.3, 0.5, 0.0]), 0.3


def embers(moved=0.0):
    return stage.points(GLOWING, PLACES + moved, np.full(len(PLACES), RADIUS))


def at(place, *shapes):
    """Light (3) of a white floor at a place, seen from near by."""
    seen = view(tuple(place + np.array([0.0, 0.4, 0.6])), tuple(place), (33, 33), 0.02, orthographic=False)
    return Trace().draw(frame(stage.floor(WHITE), *shapes, seen=seen)).linear[16, 16]


def exact(place, hidden=None):
    """The same, summed over all spheres that a ball (center, radius) does not hide."""
    away = PLACES - place
    distance = np.linalg.norm(away, axis=1)
    shown = np.ones(len(away), dtype=bool)
    if hidden is not None:
        along = away @ (hidden[0] - place) / distance
        shown = np.linalg.norm(hidden[0] - place) ** 2 - along**2 > hidden[1] ** 2
    return (shown * away[:, 1] * RADIUS**2 / distance**3).sum() * SHINE


def test_a_floor_under_small_lights_does_not_boil():
    def lit(moved):
        return Trace().draw(frame(stage.floor(WHITE), embers(moved), seen=SEEN)).linear[40:]

    before, after = lit(0.0), lit(np.array([0.02, -0.015, 0.01]))
    assert np.abs(after - before).max() < 0.1 * before.mean()


@pytest.mark.parametrize("place", SPOTS)
def test_small_lights_light_a_floor_by_their_intensity(place):
    assert at(place, embers()) == pytest.approx(exact(place), rel=0.01)


@pytest.mark.parametrize("place", SPOTS)
def test_small_lights_throw_shadows(place):
    hidden = exact(place, HIDING)
    assert hidden.sum() < 0.99 * exact(place).sum()
    assert at(place, embers(), stage.sphere(BLACK, *HIDING)) == pytest.approx(hidden, rel=0.04)


def test_small_lights_light_solids_of_formulas_as_others():
    shapes = stage.sphere(WHITE), stage.implicit_sphere(WHITE)
    lit, also = (Trace().draw(frame(stage.floor(WHITE), embers(), shape, seen=SEEN)).linear for shape in shapes)
    assert also == pytest.approx(lit, abs=1e-4)


@pytest.mark.parametrize("size", [0.01, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.5])
def test_a_light_counts_once_whether_samples_meet_it_or_not(size):
    ball = stage.points(GLOWING, [[0.0, 1.0, 0.0]], [size])
    assert at(np.zeros(3), ball) == pytest.approx(size**2 * SHINE, rel=0.06)


def test_walls_hide_small_lights_and_give_their_light_back():
    wall = stage.box(Surface(color=(1.0, 0.5, 0.0), specular=0.0), (0.0, 1.5, -0.7), (9.0, 3.0, 0.1))
    followed = 0.00776, 0.00625 / 2, 0.00489 / 4  # by 6000 random paths of eight surfaces
    assert at(np.zeros(3), embers(), wall) == pytest.approx(followed, rel=0.03)


def test_a_tree_of_lights_has_the_light_of_all_but_what_shows_a_lamp():
    rows = embers_of([embers()], [PointLight(tuple(PLACES[7]), (1.0,) * 3, RADIUS)])
    assert len(rows) == 2 * 399 - 1
    assert rows[0, 5:8] == pytest.approx(399 * np.pi * RADIUS**2 * SHINE)
    assert (rows[:, 8] == 1).sum() == 399
