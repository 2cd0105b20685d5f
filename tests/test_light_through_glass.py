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


def room(color=0.0, inner=2.0, thick=0.2):
    """Six walls around a room with its floor at y = 0."""
    walls = Surface(color=(color,) * 3, specular=0.0, roughness=1.0)
    half, wide = 0.5 * (inner + thick), inner + 2 * thick
    for axis in range(3):
        for side in (-half, half):
            center, size = [0.0, 0.5 * inner, 0.0], [wide] * 3
            center[axis] += side
            size[axis] = thick
            yield stage.box(walls, tuple(center), tuple(size))


INSIDE = view((0, 1, 0.95), (0, 0.5, 0), (80, 60), 0.5, orthographic=False)


def test_no_sky_comes_into_a_closed_room_by_glass():
    ball = stage.sphere(glass(1.0, 1.0, 1.0), (0, 1.0, 0), 0.3)
    matte = stage.box(Surface(color=(0.5,) * 3, specular=0.0, roughness=1.0), (0, 0.05, 0), (1.8, 0.1, 1.8))
    picture = Trace().draw(frame(*room(), matte, ball, lights=[SKY], seen=INSIDE)).linear
    assert picture[45:].max() < 1e-6


@pytest.mark.parametrize("gap", [0.001, 0.2])
def test_what_stands_just_behind_glass_hides_the_sky(gap):
    black = Surface(color=(0.0,) * 3, specular=0.0)
    wall, end = stage.box(black, (0, 2, -gap - 0.001), (40, 4, 0.002)), stage.box(black, (0, 2, 9), (40, 4, 0.1))
    pane = stage.box(glass(1.0, 1.0, 1.0), (0, 2, 0.01), (40, 4, 0.02))
    matte = stage.floor(Surface(color=(0.5,) * 3, specular=0.0, roughness=1.0))
    seen = view((0, 6, 3), (0, 0, 3), (20, 15), 0.1, orthographic=False, up=(0, 0, -1))
    walled, both = (
        Trace().draw(frame(matte, wall, end, *more, lights=[SKY], seen=seen)).linear.mean() for more in ([], [pane])
    )
    assert both == pytest.approx(walled, rel=0.02)


def test_the_same_glass_lets_the_same_light_through_in_each_form():
    clear, matte = glass(1.0, 0.4, 0.4), Surface(color=(0.5,) * 3, specular=0.0, roughness=1.0)
    seen = view((0, 1, 4), (0, -1, 1), (40, 30), 0.3, orthographic=False)
    balls = stage.sphere(clear), stage.implicit_sphere(clear), stage.round_mesh(clear)
    light = [
        Trace()
        .draw(frame(stage.floor(matte, -1.0), ball, lights=[SKY], seen=seen))
        .linear[20:, 10:30]
        .mean(axis=(0, 1))
        for ball in balls
    ]
    assert light[1] == pytest.approx(light[0], rel=1e-3)
    assert light[2] == pytest.approx(light[0], rel=0.01)
