"""Laws of what is seen through glass: it is as sharp as many rays a pixel would show it."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from sceneql.frame import Sky, Surface
from stage import frame, view

GLASS = Surface(color=(1.0,) * 3, roughness=0.0, transmission=1.0)
CHECKERED = Surface((0.9,) * 3, 1.0, specular=0.0, checker_size=0.5, checker_color=(0.05,) * 3)
SKY = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3)
WALL = stage.box(CHECKERED, (0.13, 0.17, -3.0), (40, 40, 0.2))
WIDTH, HEIGHT, FINER = 120, 90, 4
MIDDLE = slice(32, 58), slice(44, 76)
THINGS = {"slab": stage.box(GLASS, (0, 0, 0), (1.2, 1.2, 0.4)), "ball": stage.sphere(GLASS, (0, 0, 0), 0.8)}


def drawn(thing, times=1):
    """The middle of a picture of a checkered wall through glass, of ``times`` as many rows and columns averaged."""
    seen = view((0, 0, 4), (0, 0, 0), (times * WIDTH, times * HEIGHT), 0.22, orthographic=False)
    picture = Trace().draw(frame(WALL, THINGS[thing], lights=[SKY], seen=seen)).linear[..., 0]
    return picture.reshape(HEIGHT, times, WIDTH, times).mean(axis=(1, 3))[MIDDLE]


def edge_width(picture):
    """Width [pixels] of the sharpest edges: contrast over slope."""
    return np.ptp(np.percentile(picture, [5, 95])) / np.percentile(np.abs(np.diff(picture, axis=1)), 99)


@pytest.mark.parametrize("thing", THINGS)
def test_edges_seen_through_glass_are_a_pixel_wide(thing):
    picture, exact = drawn(thing), drawn(thing, FINER)
    assert edge_width(picture) < edge_width(exact) + 0.5
    assert np.sqrt(((picture - exact) ** 2).mean()) < 0.05


@pytest.mark.parametrize("on", ["floor", "table"])
def test_glass_that_stands_on_something_shows_its_face_without_specks(on):
    red = Surface(color=(0.8, 0.1, 0.1), roughness=1.0, specular=0.0)
    below = (
        [stage.floor(red)] if on == "floor" else [stage.floor(height=-0.8), stage.box(red, (0, -0.4, 0), (3, 0.8, 3))]
    )
    seen = view((1.2, 2.3, 3.1), (0, 0.3, 0), (64, 48), 1.0)
    stands, sunk = (
        Trace()
        .draw(frame(*below, stage.box(GLASS, (0.1, 0.3 - by, 0), (0.7, 0.6, 0.8)), lights=[SKY], seen=seen))
        .linear
        for by in (0.0, 1e-3)
    )
    assert np.abs(stands - sunk).max() < 0.08
