"""Laws of the light of many small spheres that glow."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing.light.swarms import swarms_of
from sceneql.frame import Points, Surface
from stage import WHITE, frame, view

SEEN = view((0, 3, 4), (0, 0.2, 0), (96, 72), 0.3, orthographic=False)
EMBERS = Surface(color=(0.0,) * 3, specular=0.0, roughness=1.0, emission=(4.0, 2.0, 1.0))
PLACES = np.random.default_rng(1).uniform((-1.5, 1.2, -1.5), (1.5, 1.6, 1.5), (400, 3))


def sparks(moved=0.0):
    return Points("sparks", EMBERS, PLACES + moved, np.full(len(PLACES), 4e-3))


def lit(moved=0.0):
    """A floor (n, 3) under sparks that are out of the picture."""
    return Trace().draw(frame(stage.floor(WHITE), sparks(moved), seen=SEEN)).linear[40:].reshape(-1, 3)


def test_a_floor_under_sparks_does_not_boil():
    before, after = lit(), lit(np.array([0.02, -0.015, 0.01]))
    assert np.abs(after - before).max() < 0.1 * before.mean()


def test_small_spheres_light_a_floor_as_points_of_their_intensity():
    here = np.zeros(3)
    away = PLACES - here
    exact = (away[:, 1] / np.linalg.norm(away, axis=1) ** 3).sum() * np.pi * 4e-3**2 * np.array(EMBERS.emission) / np.pi
    picture = Trace().draw(frame(stage.floor(WHITE), sparks(), seen=view((0, 0.6, 0.8), here, (33, 33), 0.05, False)))
    assert picture.linear[16, 16] == pytest.approx(exact, rel=0.1)


def test_a_sphere_as_large_as_samples_tell_lights_as_before():
    sphere = Points("ember", EMBERS, np.array([[0.0, 0.3, 0.0]]), np.array([0.2]))
    bright = Trace().draw(frame(stage.floor(WHITE), sphere, seen=SEEN)).linear[46:50, 40:56].max()
    assert bright > 0.5


def test_swarms_have_all_light_of_their_spheres():
    rows = swarms_of([sparks()])
    assert len(rows) < 100
    assert rows[:, 4:].sum(axis=0) == pytest.approx(len(PLACES) * np.pi * 4e-3**2 * np.array(EMBERS.emission))
