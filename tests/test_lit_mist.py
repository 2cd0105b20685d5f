"""Mist in light: its shadow on things and on itself, seen straight on, in mirrors and through glass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import exp1

from renderers.tracing.draw import draw
from sceneql.frame import Mist, PointLight, Points, Quadric, SeenFrame, Sky, Sun, Surface, View

DARK = Sky(zenith=(0, 0, 0), horizon=(0, 0, 0), ground=(0, 0, 0))
WHITE = Sky(zenith=(1, 1, 1), horizon=(1, 1, 1), ground=(1, 1, 1))
MATTE = Surface(color=(0.7, 0.7, 0.7), specular=0.0)
DEPTH = 1.3
DOWN = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
"""Axes of a camera that looks down."""


def slab(low, high, depth, color=0.0, cells=4, lit=True):
    """An even mist in a box, of such a depth along y."""
    low, high = np.array(low, float), np.array(high, float)
    to_cells = np.column_stack([np.diag(cells / (high - low)), -cells * low / (high - low)])
    absorption = np.full((cells + 1,) * 3, depth / (high - low)[1])
    return Mist("m", Surface(color=(color,) * 3), to_cells, absorption, (0.0,) * 3, (float(cells),) * 3, lit)


def face(normal, height, surface=MATTE):
    """A half-space below a plane."""
    far = (9.0,) * 3
    return Quadric("w", surface, np.eye(3, 4), (0.0,) * 3, normal, -height, (-9.0,) * 3, far)


def picture(shapes, lights, at=(0.0, 1.0, 0.0), axes=DOWN, half=0.1, orthographic=False, side=16):
    view = View(at, axes, (side, side), half, orthographic)
    return draw(SeenFrame(0, 0.0, tuple(shapes), tuple(lights), view), samples=1).linear


@pytest.mark.parametrize("cosine", [1.0, 0.8])
def test_a_slab_throws_the_shadow_of_its_depth_along_the_way_of_the_light(cosine):
    sun = Sun((np.sqrt(1 - cosine**2), cosine, 0.0), (2.0, 2.0, 2.0), 0.0)
    floor, above = face((0.0, 1.0, 0.0), 0.0), slab((-20, 2, -20), (20, 3, 20), DEPTH)
    plain, dimmed = picture([floor], [sun, DARK]), picture([floor, above], [sun, DARK])
    np.testing.assert_allclose(plain, 0.7 / np.pi * 2 * cosine, rtol=1e-5)
    np.testing.assert_allclose(dimmed, np.exp(-DEPTH / cosine) * plain, rtol=1e-5)


def test_a_wide_lamp_is_dimmed_as_far_as_its_light_goes_through():
    lamp = PointLight((0.0, 6.0, 0.0), (5.0, 5.0, 5.0), 0.5)
    floor, above = face((0.0, 1.0, 0.0), 0.0), slab((-20, 2, -20), (20, 3, 20), DEPTH)
    plain, dimmed = picture([floor], [lamp, DARK]), picture([floor, above], [lamp, DARK])
    np.testing.assert_allclose(dimmed / plain, np.exp(-DEPTH), rtol=5e-3)  # ways to its rim are up to 0.35 % longer
    beyond = slab((-20, 7, -20), (20, 8, 20), DEPTH)
    np.testing.assert_array_equal(picture([floor, beyond], [lamp, DARK]), plain)


def test_mist_that_is_not_lit_throws_no_shadow():
    sun = Sun((0.0, 1.0, 0.0), (2.0, 2.0, 2.0), 0.01)
    floor, above = face((0.0, 1.0, 0.0), 0.0), slab((-20, 2, -20), (20, 3, 20), DEPTH, lit=False)
    np.testing.assert_array_equal(picture([floor, above], [sun, WHITE]), picture([floor], [sun, WHITE]))


def test_the_light_of_the_sky_is_dimmed_by_the_mean_over_its_directions():
    """Under an even sky and a wide black slab: twice the exponential integral of third order of its depth."""
    floor, above = face((0.0, 1.0, 0.0), 0.0), slab((-200, 2, -200), (200, 2.5, 200), 0.5)
    exact = 2 * quad(lambda cosine: cosine * np.exp(-0.5 / cosine), 0, 1)[0]
    found = picture([floor, above], [WHITE], side=32)[12:20, 12:20].mean()
    assert found == pytest.approx(0.7 * exact, rel=1e-2)


GLOW = Surface(color=(0.0,) * 3, specular=0.0, emission=(0.8,) * 3)


def test_mist_is_seen_in_a_mirror():
    """By a mirror at 45 degrees the camera looks along x to a wall that glows."""
    silver = Surface(color=(1.0,) * 3, roughness=0.0, metallic=1.0)
    wall, mirror = face((-1.0, 0.0, 0.0), -5.0, GLOW), face((0.6**0.5, 0.4**0.5, 0.0), 0.0, silver)
    mist = slab((2, -9, -9), (3, 9, 9), 18 * DEPTH)
    scenes = (wall, mirror), (wall, mirror, mist)
    plain, dimmed = (picture(one, [DARK], (0.0, 1.0, 0.0), half=0.01) for one in scenes)
    way = -DOWN[2]  # of the camera, mirrored
    normal = np.array([0.6**0.5, 0.4**0.5, 0.0])
    mirrored = way - 2 * (way @ normal) * normal
    assert plain.min() > 0.5
    np.testing.assert_allclose((dimmed / plain)[8, 8], np.exp(-DEPTH / mirrored[0]), rtol=1e-2)


def test_mist_is_seen_through_glass():
    wall, mist = face((0.0, 1.0, 0.0), -5.0, GLOW), slab((-9, -3, -9), (9, -2, 9), DEPTH)
    glass = Surface(color=(1.0,) * 3, roughness=0.0, transmission=1.0, index_of_refraction=1.5)
    pane = Quadric("p", glass, np.eye(3, 4), (0.0,) * 3, (0.0,) * 3, -1.0, (-5.0, -0.1, -5.0), (5.0, 0.0, 5.0))
    plain, dimmed = (picture(one, [DARK], half=0.01) for one in ((wall, pane), (wall, pane, mist)))
    assert 0.5 < plain.min() < 0.8
    np.testing.assert_allclose(dimmed / plain, np.exp(-DEPTH), rtol=1e-3)


def thrown_back(depth, cells, color=1e-6):
    """What a slab under a sun sends up, by its light and color."""
    sun = Sun((0.8, 0.6, 0.0), (1 / color,) * 3, 0.0)
    shape = slab((-5, -1, -1), (5, 0, 1), depth, color, cells)
    return picture([shape], [sun, DARK], orthographic=True, side=4)[1, 1, 0]


def test_the_shadow_of_a_slab_on_itself_comes_as_the_square_of_the_cells_to_the_exact_integral():
    """Scattered once: E/(4 pi) times the integral of exp(-t - t/0.6) over the depth t."""
    exact = (1 - np.exp(-DEPTH * (1 + 1 / 0.6))) / (1 + 1 / 0.6) / (4 * np.pi)
    errors = [abs(thrown_back(DEPTH, cells) / exact - 1) for cells in (4, 8, 16)]
    assert errors[2] < 1e-3
    assert errors[0] / errors[1] > 3.5
    assert errors[1] / errors[2] > 3.5


def plane_parallel(depth, albedo, nodes=400):
    """Radiance straight up of a slab under a beam of irradiance 1 straight down, by Schwarzschild and Milne's equation.

    J(t) = exp(-t)/(4 pi) + albedo/2 integral of E1(|t - s|) J(s) ds, of cells of even J.
    """
    edges = np.linspace(0, depth, nodes + 1)
    t = 0.5 * (edges[1:] + edges[:-1])

    def second(x):  # the integral of E1 from 0 to x
        x = np.maximum(x, 1e-300)
        return 1 - np.exp(-x) + x * exp1(x)

    a, b = edges[None, 1:] - t[:, None], edges[None, :-1] - t[:, None]
    kernel = np.sign(a) * second(np.abs(a)) - np.sign(b) * second(np.abs(b))
    mean = np.linalg.solve(np.eye(nodes) - 0.5 * albedo * kernel, np.exp(-t) / (4 * np.pi))
    return albedo * (mean * np.exp(-t)).sum() * depth / nodes


def test_light_scattered_again_and_again_is_that_of_radiative_transfer():
    sun = Sun((0.0, 1.0, 0.0), (1.0,) * 3, 0.0)
    wide = slab((-6, -1, -6), (6, 0, 6), 1.0, 0.9, 24)
    found = picture([wide], [sun, DARK], orthographic=True, side=4)[1, 1, 0]
    assert found == pytest.approx(plane_parallel(1.0, 0.9), rel=0.05)
    assert found > 1.4 * (1 - np.exp(-2.0)) / (8 * np.pi)  # more than once


def test_even_light_stays_even_in_white_mist_and_around_a_white_ball_in_it():
    mist = slab((-1, -1, -1), (1, 1, 1), 5.0, 1.0, 12)
    ball = Points("b", Surface(color=(1.0,) * 3, specular=0.0), np.zeros((1, 3)), np.full(1, 0.6))
    np.testing.assert_allclose(picture([mist], [WHITE], (0.0, 4.0, 0.0), half=0.4), 1.0, rtol=1e-5)
    found = picture([mist, ball], [WHITE], (0.0, 4.0, 0.0), half=0.4)
    np.testing.assert_allclose(found, 1.0, atol=0.02)


def test_a_ball_throws_its_shadow_into_mist():
    sun = Sun((1.0, 0.0, 0.0), (1.0,) * 3, 0.0)
    mist = slab((-1, -1, -1), (1, 1, 1), 0.1, 1.0, 24)
    ball = Points("b", Surface(color=(0.0,) * 3, specular=0.0), np.array([[0.5, 0.0, 0.0]]), np.full(1, 0.3))
    found = picture([mist, ball], [sun, DARK], (0.0, 4.0, 0.0), half=0.25, side=32)[..., 0]
    dark, light = found[16, 8], found[27, 8]  # left of the ball, and beside its shadow
    assert dark < 0.75 * light


def test_any_number_of_threads_makes_the_same_bytes(monkeypatch):
    sun = Sun((0.6, 0.8, 0.0), (1.0,) * 3, 0.05)
    shapes = [face((0.0, 1.0, 0.0), -1.5), slab((-1, -1, -1), (1, 1, 1), 2.0, 0.8, 12)]
    made = []
    for threads in ("1", "3"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        made.append(picture(shapes, [sun, WHITE], (0.0, 4.0, 0.0), half=0.4, side=48).tobytes())
    assert made[0] == made[1]


def test_mists_apart_dim_each_other_and_follow_by_their_distance():
    near, far = slab((-1, 1, -1), (1, 2, 1), 1.0, 0.3, lit=False), slab((-1, -2, -1), (1, -1, 1), 2.0, 0.9, lit=False)
    exact = (1 - np.exp(-1.0)) * 0.3 + np.exp(-1.0) * (1 - np.exp(-2.0)) * 0.9
    for shapes in ([near, far], [far, near]):
        found = picture(shapes, [DARK], (0.0, 4.0, 0.0), half=0.05, orthographic=True)
        np.testing.assert_allclose(found, exact, rtol=1e-5)
    sun = Sun((0.0, 1.0, 0.0), (1.0,) * 3, 0.0)
    shadowed, alone = (
        picture(shapes, [sun, DARK], (0.0, 0.0, 0.0), half=0.05)
        for shapes in ([replace(near, lit=True), replace(far, lit=True)], [replace(far, lit=True)])
    )
    np.testing.assert_allclose(shadowed / alone, np.exp(-1.0), rtol=0.3)
