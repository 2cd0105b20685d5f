"""Soft boxes of the default light: metal and glass mirror them, matte surfaces and the backdrop do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from imageio.v3 import imread

import stage
from moment import IDENTITY, FakeMoment
from renderers.trace import Trace
from sceneql.frame import Sky, SoftBox, Surface
from sceneql.pipeline import load, render
from sceneql.report.unsaid import unsaid
from sceneql.words.lights.studio import BACKGROUND, BELOW, Studio
from sceneql.words.objects.plane import Plane
from stage import frame, view

GRAY = (0.2, 0.2, 0.2)
SKY = Sky(GRAY, GRAY, GRAY)
BOX = SoftBox((0.0, 0.0, 1.0), (0.6, 0.3), (2.0, 1.0, 0.5))
BALLS = """objects:
  metal: {{sphere: {{radius: 0.5 m, position: -0.6 0.5 0 m, material: mirror}}}}
  clay: {{sphere: {{radius: 0.5 m, position: 0.6 0.5 0 m, material: {{matte: {{}}}}}}}}
lights: {{light: {{studio: {{boxes: {boxes}}}}}}}
outputs: {{still: {{image: {{size: 96 54}}}}}}
"""


def drawn(surface, *boxes):
    scene = frame(stage.sphere(surface), lights=[replace(SKY, boxes=boxes)], seen=view(size=(49, 49)))
    return Trace().draw(scene).linear


def test_a_mirror_shows_a_box_as_bright_as_it_is_before_the_sky():
    """The ball's middle looks back at the camera, from where the box shines."""
    metal = Surface(color=(1.0, 1.0, 1.0), roughness=0.0, metallic=1.0)
    plain, boxed = drawn(metal), drawn(metal, BOX)
    np.testing.assert_allclose(boxed[24, 24] - plain[24, 24], BOX.radiance, rtol=1e-5)
    wide, high = ((boxed - plain)[24, :, 0] > 1).sum(), ((boxed - plain)[:, 24, 0] > 1).sum()
    assert wide > 1.5 * high > 0
    np.testing.assert_array_equal(boxed[0, 0], plain[0, 0])  # the camera looks past the ball


@pytest.mark.parametrize("roughness", [0.3, 0.5])
def test_rough_metal_shows_it_blurred(roughness):
    metal = Surface(color=(1.0, 1.0, 1.0), roughness=roughness, metallic=1.0)
    more = (drawn(metal, BOX) - drawn(metal))[..., 0]
    assert 0 < more.max() < 2
    assert more[24, 24] == pytest.approx(more.max(), rel=0.02)


def test_matte_surfaces_and_the_ground_are_as_without_boxes(tmp_path):
    pictures = []
    for boxes in (0, 1):
        (tmp_path / "scene.yaml").write_text(BALLS.format(boxes=boxes))
        render(load(tmp_path / "scene.yaml"), output=tmp_path / "still.png")
        pictures.append(imread(tmp_path / "still.png").astype(float))
    off = np.abs(pictures[1] - pictures[0]).max(axis=-1)
    assert off[:, :48].max() > 60
    assert off[:, 60:].max() <= 1


def test_the_background_is_that_of_a_floor_that_bends_up():
    """Whether there is a floor or not: as bright as the floor below, and gray ahead, without a step between them."""
    eye = view(eye=(0, 1, 0), target=(0, 0.7, -1), size=(8, 90), half_height=0.4, orthographic=False)
    lights = list(Studio().lower(FakeMoment()))
    (floor,) = Plane().lower("floor", IDENTITY, FakeMoment())
    bare, floored = (Trace().draw(frame(*shapes, lights=lights, seen=eye)).linear[:, 4] for shapes in ((), (floor,)))
    np.testing.assert_allclose(bare, floored, atol=0.015)
    np.testing.assert_allclose(bare[0], BACKGROUND, rtol=1e-5)
    assert bare[-1].min() > 0.9 * BELOW[0]
    assert np.abs(np.diff(bare, axis=0)).max() < 0.02


def test_they_are_told_as_words_to_paste(tmp_path):
    (tmp_path / "scene.yaml").write_text("objects: {a: sphere}\n")
    assert "studio: {key: 1, fill: 1, boxes: 1, backdrop: light}" in unsaid(load(tmp_path / "scene.yaml"))
