"""Soft discs: the light that they add, what they cover, what hides them."""

import math

import numpy as np
import pytest

from renderers.tracing.draw import draw
from sceneql.frame import Points, SeenFrame, Sky, Surface, View

BLACK = Sky(zenith=(0, 0, 0), horizon=(0, 0, 0), ground=(0, 0, 0))
SIDE = 96


def disc(*centers, radius=0.3, color=(1.0, 0.5, 0.25), soft="adds", opacity=1.0):
    surface = Surface(color=(0.0, 0.0, 0.0), emission=color)
    return Points("d", surface, np.array(centers, float), np.full(len(centers), radius), soft=soft, opacity=opacity)


def seen(*shapes, orthographic=False):
    """The picture from (0, 0, 4) towards the origin, where a pixel is 1/48 m of the plane z = 0."""
    half = 1.0 if orthographic else 0.25
    view = View((0.0, 0.0, 4.0), np.eye(3), (SIDE, SIDE), half, orthographic)
    return draw(SeenFrame(0, 0.0, tuple(shapes), (BLACK,), view), samples=1).linear


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("radius", [0.3, 0.11, 0.004])
def test_a_disc_adds_a_third_of_its_area_of_light(radius, orthographic):
    light = seen(disc((0.1, -0.2, 0), radius=radius), orthographic=orthographic).sum(axis=(0, 1))
    area = math.pi * (radius * SIDE / 2) ** 2
    rough = 0.12 if radius * SIDE < 1 else 0.01  # a disc of a pixel or so is sampled at few places
    np.testing.assert_allclose(light, area / 3 * np.array([1, 0.5, 0.25]), rtol=rough)


def test_light_adds_up_in_any_order_of_depth():
    a, b = (0, 0, 0.5), (0.05, 0, -0.5)
    np.testing.assert_allclose(seen(disc(a, b)), seen(disc(a)) + seen(disc(b)), rtol=1e-6, atol=1e-7)


def test_the_nearest_of_discs_that_cover_is_seen():
    red, blue = (disc((0, 0, z), color=c, soft="covers") for z, c in ((0.5, (1, 0, 0)), (-0.5, (0, 0, 1))))
    both = Points(
        "d", red.surface, np.concatenate([red.centers, blue.centers]), np.full(2, 0.3),
        colors=np.array([[1.0, 0, 0], [0, 0, 1.0]]), soft="covers",
    )  # fmt: skip
    middle = seen(both)[SIDE // 2, SIDE // 2]
    assert middle[0] > 0.98
    assert middle[2] < 0.02


def test_a_disc_is_hidden_by_what_stands_before_it_alone():
    ball = Points("b", Surface(color=(0.0, 0.0, 0.0), specular=0.0), np.zeros((1, 3)), np.full(1, 0.5))
    assert seen(ball, disc((0, 0, -2.0))).sum() == 0
    np.testing.assert_array_equal(seen(ball, disc((0, 0, 2.0))), seen(disc((0, 0, 2.0))))
    cut = seen(ball, disc((0, 0, 0.5)))[SIDE // 2, SIDE // 2, 0]
    assert cut == pytest.approx(0.5, abs=0.05)


def test_no_disc_behind_the_camera_is_drawn():
    assert seen(disc((0, 0, 5.0), (0, 0, 4.0))).sum() == 0
