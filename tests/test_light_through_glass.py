"""Laws of the light and shadow that glass throws on what is around it."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from sceneql.frame import Sky, Surface
from stage import frame, sun, view

SKY = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3)
SEEN = view((0, 1.2, 4), (0, 0.2, 0.8), (80, 60), 0.3, orthographic=False)
BEFORE = slice(34, 46), slice(30, 50)


def glass(*color):
    return Surface(color=color, roughness=0.0, transmission=1.0)


def before(ball, gray=0.5, light=SKY):
    """Mean color (3,) of a floor before a ball, or alone."""
    matte = Surface(color=(gray,) * 3, specular=0.0, roughness=1.0)
    shapes = [stage.floor(matte), *([stage.sphere(ball, (0, 0.5, 0), 0.5)] if ball else [])]
    return Trace().draw(frame(*shapes, lights=[light], seen=SEEN)).linear[BEFORE].mean(axis=(0, 1))


@pytest.mark.parametrize("gray", [0.5, 1.0])
def test_clear_glass_hides_nothing_of_a_sky(gray):
    assert before(glass(1.0, 1.0, 1.0), gray) == pytest.approx(before(None, gray), rel=0.01)


def test_tinted_glass_tints_the_light_of_the_sky():
    red, black = before(glass(1.0, 0.1, 0.1)), before(Surface(color=(0.0,) * 3, specular=0.0))
    alone = before(None)
    assert red[0] == pytest.approx(alone[0], rel=0.01)
    assert red[1] == pytest.approx(red[2])
    assert black[1] < red[1] < 0.9 * red[0] + 0.1 * black[1]


def test_the_shadow_of_dark_glass_is_darker_than_that_of_clear_glass():
    low = sun((0.0, 0.5, -1.0))
    alone, clear, dark = (before(ball, light=low) for ball in (None, glass(1.0, 1.0, 1.0), glass(0.2, 0.2, 0.2)))
    assert 0.9 * alone.mean() < clear.mean() < alone.mean()
    assert dark.mean() == pytest.approx(0.2 * clear.mean(), rel=0.01)


def test_what_stands_behind_glass_hides_the_sky_as_without_it():
    wall = stage.box(Surface(color=(0.0,) * 3, specular=0.0), (0, 1, -0.8), (4, 2, 0.2))
    matte = Surface(color=(0.5,) * 3, specular=0.0, roughness=1.0)
    pane = stage.box(glass(1.0, 1.0, 1.0), (0, 1, -0.4), (4, 2, 0.02))
    walled, both = (
        Trace().draw(frame(stage.floor(matte), wall, *more, lights=[SKY], seen=SEEN)).linear[BEFORE]
        for more in ([], [pane])
    )
    assert both.mean() == pytest.approx(np.mean(walled), rel=0.04)
