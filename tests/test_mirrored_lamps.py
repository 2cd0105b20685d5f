"""Laws of the images of lamps in mirrors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from sceneql.frame import PointLight, Surface
from stage import GLOW, frame, sun, view

MIRROR = Surface(color=(1.0, 1.0, 1.0), roughness=0.0, metallic=1.0)
SEEN = view((0, 0, 4), (0, 0, 0), (200, 160), 0.3, orthographic=False)
LAMP = PointLight((1.0, 0.3, 4.0), (3.0, 3.0, 3.0), 0.2)


def draw(*more, light, surface=MIRROR):
    return (
        Trace()
        .draw(frame(stage.box(surface, (0, 0, -0.5), (8, 8, 1)), *more, lights=[light], seen=SEEN))
        .linear[..., 0]
    )


@pytest.mark.parametrize(
    ("light", "radiance", "tangent"),
    [
        (LAMP, 3.0 / (math.pi * 0.2**2), 0.2 / 8),  # its image stands at (1, 0.3, -4)
        (sun((0.15, 0.1, 1.0), (3.0,) * 3, 0.2), 3.0 / (math.pi * math.tan(0.1) ** 2), math.tan(0.1)),
    ],
    ids=["lamp", "sun"],
)
def test_a_lamp_in_a_mirror_has_its_size_and_radiance(light, radiance, tangent):
    picture = draw(light=light)
    assert picture.max() == pytest.approx(radiance, rel=1e-4)
    assert picture.min() == 0.0
    radius = tangent / 0.3 * 80
    assert math.sqrt((picture > 0.5 * radiance).sum() / math.pi) == pytest.approx(radius, rel=0.05)


@pytest.mark.parametrize("size", [0.0, 1e-4, 2e-3, 1e-2])
def test_an_image_smaller_than_a_pixel_gives_all_of_its_light(size):
    image = draw(light=sun((0.15, 0.1, 1.0), (1e-5,) * 3, size))  # so faint that no mean over a pixel is tamed
    pixel = 0.3 / 80
    assert image.sum() * pixel**2 == pytest.approx(1e-5, rel=0.15)


@pytest.mark.parametrize("normal", [(0, 0, 1), (0.3, 0.2, 1), (1, 0, 1), (0.1, 0.7, 0.6)])
def test_parallel_rays_from_a_flat_mirror_meet_a_sun_of_any_size_or_pass_it(normal):
    normal, eye = (np.array(v) / np.linalg.norm(v) for v in (normal, (0.2, 0.1, 1.0)))
    wall = replace(stage.floor(MIRROR), linear=tuple(normal))
    for size in (0.0, 1e-9, 1e-3):
        for off, met in ((0.0, True), (2e-3, False)):
            toward = 2 * (normal @ eye) * normal - eye + off * np.cross(normal, (0.0, 1.0, 0.0))
            seen = view(tuple(5 * eye), size=(8, 8))
            picture = Trace().draw(frame(wall, lights=[sun(toward, (3.0,) * 3, size)], seen=seen)).linear
            assert (picture > 1e4).all() if met else (picture == 0.0).all()


def test_what_stands_before_a_lamp_hides_its_image():
    black = Surface(color=(0.0, 0.0, 0.0), specular=0.0)
    half = stage.box(black, (1.9375, 0.3, 3.5), (2.0, 2.0, 0.1))
    whole, cut = draw(light=LAMP), draw(half, light=LAMP)
    assert cut.sum() == pytest.approx(0.5 * whole.sum(), rel=0.1)


def test_the_ball_that_shows_a_lamp_is_its_image():
    assert draw(stage.sphere(GLOW, LAMP.position, 0.2), light=LAMP).max() == pytest.approx(1.0, abs=0.01)
    assert np.abs(draw(stage.sphere(GLOW, LAMP.position, 0.2), light=LAMP)[60:100, 90:110]).max() == 0.0


@pytest.mark.parametrize("light", [LAMP, sun((0.15, 0.1, 1.0), (3.0,) * 3, 0.2)], ids=["lamp", "sun"])
def test_clear_glass_before_a_mirror_hides_no_image(light):
    clear = Surface(color=(1.0, 1.0, 1.0), roughness=0.0, transmission=1.0)
    bare, behind = (draw(*more, light=light) for more in ([], [stage.box(clear, (0, 0, 1), (9, 9, 0.1))]))
    # the pane is passed twice, and adds an image of its own
    assert 0.96**2 * bare.max() < behind.max() < (0.96**2 + 0.045) * bare.max()
    assert behind.sum() == pytest.approx((0.96**2 + 0.04) * bare.sum(), rel=0.2)


@pytest.mark.parametrize("count", [2, 3])
def test_several_panes_before_a_mirror_hide_no_image(count):
    clear = Surface(color=(1.0, 1.0, 1.0), roughness=0.0, transmission=1.0)
    panes = [stage.box(clear, (0, 0, 0.5 + 0.5 * k), (9, 9, 0.1)) for k in range(count)]
    through = 0.96 ** (2 * count)
    assert through < draw(*panes, light=LAMP).max() / draw(light=LAMP).max() < through + 0.08


def test_what_stands_before_a_lamp_hides_its_image_through_glass_as_well():
    pane = stage.box(Surface(color=(1.0,) * 3, roughness=0.0, transmission=1.0), (0, 0, 1), (9, 9, 0.1))
    around = stage.sphere(Surface((0.0,) * 3, specular=0.0), LAMP.position, 0.4)
    assert draw(pane, around, light=LAMP).max() < 0.01 * draw(pane, light=LAMP).max()
