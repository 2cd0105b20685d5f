"""Laws of light that surfaces reflect onto one another."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from sceneql.frame import PointLight, Sky, Surface
from stage import GLOW, WHITE, frame, sun, view

RED = Surface(color=(1.0, 0.05, 0.05), roughness=1.0, specular=0.0)


def draw(*shapes, lights, seen=None):
    return Trace().draw(frame(*shapes, lights=lights, seen=seen or view())).linear


def sky(strength):
    return Sky((strength,) * 3, (strength,) * 3, (strength,) * 3)


@pytest.mark.parametrize(
    "lit",
    [sun((1.0, 0.3, 1.0), (2.0, 2.0, 2.0)), PointLight((1.5, 0.5, 2.0), (6.0, 6.0, 6.0), 0.1)],
    ids=["sun", "lamp"],
)
@pytest.mark.parametrize("metallic", [0.0, 1.0], ids=["matte", "rough metal"])
def test_a_red_wall_reddens_what_stands_beside_it_with_or_without_a_sky(lit, metallic):
    wall = stage.box(RED, (-1.3, 0.0, 0.0), (0.2, 4.0, 4.0))
    ball = stage.sphere(Surface(color=(0.8, 0.8, 0.8), roughness=1.0, specular=0.0, metallic=metallic), radius=0.7)
    dark, faint, dim = (
        draw(wall, ball, lights=(lit, *skies), seen=view((0.4, 0.0, 3.0))) for skies in ((), (sky(1e-4),), (sky(1e-2),))
    )
    beside = dark[40:56, 28:31]
    assert (beside[..., 0] > 1.5 * beside[..., 1]).all()
    assert np.abs(faint - dark).max() < 1e-3  # 1.1e-4 of the sky, seen where nothing is
    assert np.abs(dim - dark).max() < 2e-2


def test_what_glows_lights_its_neighbors_without_a_sky():
    panel = stage.box(GLOW, (-1.3, 0.0, 0.0), (0.2, 2.0, 2.0))
    picture = draw(panel, stage.sphere(WHITE, radius=0.7), lights=())[..., 0]
    assert picture[48, 28] > 0.2
    assert picture[48, 68] == 0.0


def test_the_ball_that_shows_a_lamp_adds_nothing_to_its_light():
    seen = view((0, 9, 0), (0, 0, 0), size=(32, 32), half_height=1.0, up=(0, 0, -1))
    lamp = PointLight((0.0, 1.0, 0.0), (2.0, 2.0, 2.0), 0.3)
    black = Surface(color=(0.0, 0.0, 0.0), specular=0.0)
    for skies in ((), (sky(0.2),)):
        lit, hidden = (
            draw(stage.floor(), stage.sphere(surface, lamp.position, 0.3), lights=(lamp, *skies), seen=seen)
            for surface in (GLOW, black)
        )
        beside = np.s_[:8]
        np.testing.assert_array_equal(lit[beside], hidden[beside])
