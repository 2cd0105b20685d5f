"""Laws of light of lamps without size, which nothing filters, and of how often surfaces reflect it onto others."""

from __future__ import annotations

from dataclasses import replace
from math import atan, hypot, pi

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing import draw as drawing
from renderers.tracing import waves
from renderers.tracing.filter.hard_kernels import is_hard
from renderers.tracing.pack import pack
from sceneql.frame import PointLight, Sky, Surface, View
from stage import GLOW, WHITE, frame, sun, view

ABOVE = view((0, 9, 0), size=(128, 128), half_height=3.0, up=(0, 0, -1))


def draw(*shapes, lights, seen, bounces=0, samples=8):
    picture = Trace(diffuse_bounces=bounces, samples=samples).draw(frame(*shapes, lights=lights, seen=seen))
    return picture.linear[..., 0]


@pytest.mark.parametrize(
    ("lights", "hard"),
    [
        ((sun((1, 1, 0)), PointLight((0.0, 3.0, 0.0), (1.0,) * 3, 0.0)), True),
        ((sun((1, 1, 0), angle=0.01),), False),
        ((PointLight((0.0, 3.0, 0.0), (1.0,) * 3, 0.1),), False),
        ((sun((1, 1, 0)), Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3)), False),
    ],
)
def test_light_is_hard_without_sizes_of_lamps_and_without_light_from_around(lights, hard):
    scene = frame(stage.floor(), lights=lights)
    assert is_hard(pack(scene, bounces=0)[0]) == hard
    assert not is_hard(pack(scene)[0])
    assert not is_hard(pack(replace(scene, shapes=(stage.floor(GLOW),)), bounces=0)[0])


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_a_hard_shadow_is_as_large_as_geometry_says_and_smooth_at_its_edges(turn):
    up = (np.sin(turn), 0.0, -np.cos(turn))
    seen = view((0, 9, 0), size=(128, 128), half_height=3.0, up=up)
    shapes = stage.floor(), stage.box(WHITE, (0.0, 1.0, 0.0), (2.0, 0.1, 2.0))
    lit = draw(*shapes, lights=[sun((1, 1, 0))], seen=seen) * pi * np.sqrt(2.0)
    # The floor's points under each of 16 x 16 places of each pixel: in the shadow, or hidden by the box (left out).
    at = (np.arange(16 * 128) + 0.5) / 16 / 128 * 6.0 - 3.0
    right, down = np.cross(up, (0, 1, 0)), -np.array(up)
    x, z = (at[None, :] * right[k] + at[:, None] * down[k] for k in (0, 2))
    shadow = (x > -2.05) & (x < 0.05) & (abs(z) < 1.0)
    share = 1.0 - shadow.reshape(128, 16, 128, 16).mean(axis=(1, 3))
    seen_floor = ~((abs(x) < 1.03) & (abs(z) < 1.03)).reshape(128, 16, 128, 16).any(axis=(1, 3))
    assert abs(lit - share)[seen_floor].max() < 0.3
    assert abs((lit - share)[seen_floor].sum()) < 2.0  # of 2.1 x 2 / 0.047^2 = 1,912 pixels
    partly = seen_floor & (share > 0.2) & (share < 0.8)
    assert partly.sum() > 20
    assert abs(lit - share)[partly].mean() < 0.12  # one sample a pixel: about 0.35
    dark = seen_floor[64:80] & (np.roll(share, 2, 1) + np.roll(share, -2, 1) == 0.0)[64:80]
    assert dark.sum() > 100
    assert not lit[64:80][dark].any()


def test_one_bounce_from_a_lit_wall_is_its_form_factor():
    """Of an element perpendicular to a rectangle (Hamilton and Morgan 1952, configuration 2)."""
    wall = stage.box(WHITE, (-0.5, 1.0, 0.0), (1.0, 2.0, 4.0))
    lights = [sun((1, 0, 0))]
    once, none = (draw(wall, stage.floor(), lights=lights, seen=ABOVE, bounces=n) for n in (1, 0))
    column = 100
    far = (column + 0.5) / 128 * 6.0 - 3.0
    high, distance = 2.0 / 2.0, far / 2.0  # by half of the width
    slant = hypot(high, distance)
    expected = 2.0 / (2.0 * pi) * (atan(1.0 / distance) - distance / slant * atan(1.0 / slant)) / pi
    assert once[60:68, column].mean() == pytest.approx(expected, rel=0.05)
    assert not none[:, 70:].any()


def test_what_glows_lights_its_neighbors_without_bounces_as_with_them():
    panel = stage.box(GLOW, (-1.3, 0.0, 0.0), (0.2, 2.0, 2.0))
    shapes = panel, stage.sphere(WHITE, radius=0.7)
    one, other = (draw(*shapes, lights=(), seen=view(), bounces=n) for n in (0, 256))
    assert one[48, 28] > 0.2
    np.testing.assert_array_equal(one, other)


def test_light_that_a_neighbor_reflects_is_missing_without_bounces_under_a_sky():
    sky = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3)
    none, one, all_of_it = (
        draw(stage.floor(), stage.sphere(WHITE, (0, 1, 0)), lights=[sky], seen=ABOVE, bounces=n) for n in (0, 1, 256)
    )
    beside = np.s_[64, 86:90]  # about the ball, of radius 21 pixels
    assert none[beside].mean() + 0.05 < one[beside].mean() < all_of_it[beside].mean()
    assert all_of_it[beside].mean() == pytest.approx(1.0, abs=0.03)  # a white furnace


def test_with_one_ray_a_pixel_is_what_the_ray_through_its_middle_sees():
    ball = stage.sphere(WHITE, (0.0, 1.0, 0.0))
    coarse = draw(stage.floor(), ball, lights=[sun((1, 2, 0))], seen=ABOVE, samples=1)
    fine = draw(
        stage.floor(), ball, lights=[sun((1, 2, 0))], samples=1,
        seen=View(ABOVE.origin, ABOVE.axes, (384, 384), ABOVE.half_height, True),
    )[1::3, 1::3]  # fmt: skip
    assert (abs(coarse - fine) > 1e-6).mean() < 0.02  # but at the shadow's edge


def test_a_picture_that_somebody_has_is_not_drawn_over():
    kept = draw(stage.floor(), lights=[sun((0, 1, 0))], seen=ABOVE)
    before = kept.copy()
    draw(stage.floor(), lights=[sun((1, 1, 0))], seen=ABOVE)
    np.testing.assert_array_equal(kept, before)


MIRROR = Surface(color=(0.9, 0.9, 0.9), roughness=0.0, metallic=1.0)


@pytest.mark.parametrize("samples", [1, 8])
def test_hard_shadows_are_those_of_the_filter_also_in_mirrors_and_with_any_number_of_threads(samples, monkeypatch):
    shapes = stage.floor(), stage.sphere(MIRROR, (0.5, 1.2, 0.0)), stage.blob(WHITE, (-1.2, 0.6, 0.3))
    lights = sun((1, 1, 0.4)), PointLight((-2.0, 4.0, 1.0), (3.0,) * 3, 0.0)
    seen = view((1, 3, 8), (0, 0.7, 0), size=(100, 70), half_height=2.0)
    pictures = []
    for threads in ("1", "3"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        pictures.append(draw(*shapes, lights=lights, seen=seen, samples=samples))
    np.testing.assert_array_equal(*pictures)
    assert (pictures[0] > 0).mean() > 0.5
    monkeypatch.setattr(drawing, "is_hard", lambda scene: False)
    filtered = draw(*shapes, lights=lights, seen=seen, samples=samples)
    assert (abs(filtered - pictures[0]) > 1e-5).mean() < 2e-3


@pytest.mark.parametrize("plane", [False, True])
@pytest.mark.parametrize("threads", ["1", "3"])
def test_bands_that_are_gathered_in_one_call_are_those_of_waves_led_from_python(plane, threads, monkeypatch):
    shapes = stage.blob(WHITE, (-0.2, 0.6, 0.3)), *([stage.floor()] if plane else ())
    lights = sun((1, 1, 0.4)), PointLight((-2.0, 4.0, 1.0), (3.0,) * 3, 0.0)
    seen = view((1, 3, 8), (0, 0.7, 0), size=(100, 70), half_height=2.0)
    monkeypatch.setenv("SCENEQL_THREADS", threads)
    calls = []
    gatherer = waves.bands_gatherer

    def counted(*own):
        inner = gatherer(*own)
        return lambda *band: calls.append(band[:2]) or inner(*band)

    monkeypatch.setattr(waves, "bands_gatherer", counted)
    whole = draw(*shapes, lights=lights, seen=seen, samples=1)
    assert {row for band in calls for row in range(*band)} == set(range(70))
    monkeypatch.setattr(waves, "bands_gatherer", lambda *own: None)
    np.testing.assert_array_equal(whole, draw(*shapes, lights=lights, seen=seen, samples=1))
    assert (whole > 0).mean() > 0.04
