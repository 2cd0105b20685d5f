"""Laws of lines thinner than a pixel: in every place of the picture they are as bright as their true coverage."""

from __future__ import annotations

import numpy as np
import pytest

from renderers.trace import Trace
from renderers.tracing.solids.line_pieces import line_lengths
from sceneql.frame import Segments, Sky, Surface
from stage import GLOW, WHITE, box, floor, frame, sun, view

HEIGHT, LENGTH, WIDTH = 60, 1.4, 0.3
"""Of the picture [pixels], and of a line: length [m], width [pixels]."""
PIXEL = 2.0 / HEIGHT


def drawn(angle, shift, pieces=1, width=WIDTH, orthographic=True, more=()):
    """A picture 2 m high of a line turned by ``angle`` [rad] and moved across by ``shift`` [pixels]."""
    along, across = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
    places = np.linspace(-0.5, 0.5, pieces + 1)[:, None] * LENGTH * along + shift * PIXEL * across
    ends, radii = np.stack([places[:-1], places[1:]], axis=1), np.full(pieces, 0.5 * width * PIXEL)
    size = (80, HEIGHT)
    seen = view(size=size, half_height=1.0) if orthographic else view((0, 0, 5), (0, 0, 0), size, 0.2, False)
    return Trace().draw(frame(Segments("line", GLOW, ends, radii), *more, seen=seen)).linear[..., 0]


@pytest.mark.parametrize("orthographic", [True, False])
def test_a_line_that_moves_and_turns_keeps_its_brightness(orthographic):
    sums = [drawn(0.2 + 0.03 * k, 0.11 * k, orthographic=orthographic).sum(dtype=float) for k in range(30)]
    assert np.array(sums) == pytest.approx(LENGTH / PIXEL * WIDTH, rel=0.03)
    assert np.std(sums) < 2e-3 * np.mean(sums)


@pytest.mark.parametrize("angle", [0.0, 0.02, 0.3, np.pi / 4])
def test_a_line_has_no_gaps(angle):
    columns = drawn(angle, 0.37).sum(axis=0)[30:50]
    assert columns == pytest.approx(WIDTH / np.cos(angle), rel=0.05)


@pytest.mark.parametrize("pieces", [7, 200])
def test_a_line_in_pieces_is_as_bright_as_in_one(pieces):
    assert drawn(0.3, 0.2, pieces) == pytest.approx(drawn(0.3, 0.2), abs=0.03)


def test_a_line_is_as_wide_just_below_a_pixel_as_just_above():
    below, above = (drawn(0.3, 0.2, width=width) for width in (0.99, 1.01))
    assert below.sum() == pytest.approx(above.sum(), rel=0.04)
    assert np.abs(below - above).max() < 0.15


def test_what_stands_before_a_thin_line_hides_it():
    dark = box(GLOW, (0, 0, 0.5), (3, 2, 0.1))
    assert (drawn(0.3, 0.2, more=[dark])[10:50, 20:60] == 1.0).all()


def test_what_is_behind_a_thin_line_is_lit_as_without_it():
    seen = view((0, 3, 4), (0, 0, 0), (80, 60), 0.2, orthographic=False)
    line = Segments("line", GLOW, np.array([[[-0.5, 0.3, 0.0], [0.5, 0.3, 0.0]]]), np.array([1e-6]))
    lights = [sun((0.3, 1.0, 0.4), (2.0, 2.0, 2.0))]
    plain, crossed = (
        Trace().draw(frame(floor(WHITE), *more, lights=lights, seen=seen)).linear for more in ([], [line])
    )
    assert crossed == pytest.approx(plain, abs=2e-3)


def area(start, end, width=WIDTH):
    """Area [square pixels] that a line between two places [pixels] covers, in the mean over its places in a pixel."""
    seen, radii = view(size=(24, 24), half_height=1.0), np.array([0.5 * width / 12])
    sums = []
    for off in ((0.0, 0.0, 0.0), (0.25, 0.4, 0.0), (0.7, 0.1, 0.0), (0.45, 0.8, 0.0)):
        ends = (np.array([[start, end]], dtype=float) + off) / 12
        picture = Trace().draw(frame(Segments("line", GLOW, ends, radii), seen=seen)).linear[..., 0]
        sums.append(picture.sum(dtype=float))
    return np.mean(sums)


@pytest.mark.parametrize("length", [0.0, 0.1, 0.3, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("width", [0.05, WIDTH, 0.7])
def test_a_short_line_covers_its_own_area(length, width):
    exact = width * length + 0.25 * np.pi * width**2
    assert area((0, 0, 0), (0.8 * length, 0.6 * length, 0), width) == pytest.approx(exact, rel=0.04)


def test_a_line_towards_the_camera_covers_its_own_area():
    assert area((0, 0, -9), (0, 0, 9)) == pytest.approx(0.25 * np.pi * WIDTH**2, rel=0.04)


def test_dashes_apart_are_as_bright_as_they_are_long_and_joined_ones_as_their_line():
    ends = np.array([[[0.0, 0, 0], [1, 0, 0]], [[3, 0, 0], [4, 0, 0]], [[1, 0, 0], [1, 2, 0]]])
    assert line_lengths(ends, 1e-3) == pytest.approx([3, 1, 3])


def test_many_lines_one_behind_another_hide_each_other_by_chance():
    random = np.random.default_rng(4)
    seen, dark = view(size=(80, HEIGHT), half_height=1.0), Surface(color=(0.0,) * 3, specular=0.0)
    heights, depths = random.uniform(-10, 10, 200) * PIXEL, np.linspace(-20, 20, 200)
    ends = np.array([[[-0.7, y, z], [0.7, y, z]] for y, z in zip(heights, depths, strict=True)])
    lines = Segments("lines", GLOW, ends, np.full(200, 0.05 * PIXEL))
    wall = box(dark, (0, 0, -21), (9, 9, 0.1))
    band = Trace().draw(frame(lines, wall, seen=seen)).linear[22:38, 20:60, 0]
    tops = np.linspace(-8, 8, 160_001) * PIXEL
    covered = (np.abs(tops[:, None] - heights) < 0.05 * PIXEL).any(axis=1).mean()
    assert band.mean() == pytest.approx(covered, abs=0.03)


@pytest.mark.parametrize("tint", [(1.0, 1.0, 1.0), (0.2, 1.0, 1.0)])
def test_light_goes_through_a_thin_line_of_glass(tint):
    glass = Surface(color=tint, roughness=0.0, transmission=1.0)
    line = Segments("line", glass, np.array([[[-0.7, -0.3, 0.0], [0.7, 0.4, 0.0]]]), np.array([0.5 * WIDTH * PIXEL]))
    around = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3)
    loss = 1 - Trace().draw(frame(line, lights=[around], seen=view(size=(80, HEIGHT), half_height=1.0))).linear
    shares = loss.sum(axis=(0, 1)) / (np.hypot(1.4, 0.7) / PIXEL * WIDTH)
    assert shares == pytest.approx(0.96 * (1 - np.array(tint)), abs=0.01)  # the rest is mirrored
