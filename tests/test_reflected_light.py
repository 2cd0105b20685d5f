"""Laws of light that surfaces reflect onto one another."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing import buffers, layout, waves
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


AROUND = view((0, 6, 14), (0, 0, 0.5), (320, 180), 0.07, orthographic=False)
PLACES = np.array([[d * np.cos(a), 0.0, d * np.sin(a)] for d in (0.6, 0.8, 1.2) for a in np.radians([60, 90, 120])])


def on_contact(sphere, floor):
    """Light of a floor at PLACES under a uniform sky, around where a sphere of radius 1 touches it."""
    shapes = stage.floor(gray(floor)), stage.sphere(gray(sphere), (0, 1, 0))
    picture = draw(*shapes, lights=(sky(1.0),), seen=AROUND)[..., 0]
    away = (PLACES - AROUND.origin) @ AROUND.axes.T
    scale = 90 / AROUND.half_height / -away[:, 2]
    return picture[(90 - scale * away[:, 1]).astype(int), (160 + scale * away[:, 0]).astype(int)]


def gray(tone):
    return Surface(color=(tone,) * 3, roughness=1.0, specular=0.0)


def followed(start, sphere, floor, rays=8000, turns=30):
    """Light of the floor at ``start`` by paths that go on until the sky is met (Kajiya 1986)."""
    random = np.random.default_rng(5)
    at, normal, weight = np.tile(start, (rays, 1)), np.tile([0.0, 1.0, 0.0], (rays, 1)), np.full(rays, floor)
    total = 0.0
    for _ in range(turns):
        ray = random.normal(size=at.shape)
        ray = normal + ray / np.linalg.norm(ray, axis=1)[:, None]  # distributed as the cosine to the normal
        ray /= np.linalg.norm(ray, axis=1)[:, None]
        from_floor = at[:, 1] < 1e-9
        off = at - [0.0, 1.0, 0.0]
        half = (off * ray).sum(axis=1)
        rest = half**2 - (off**2).sum(axis=1) + 1.0
        to_ball = np.where(from_floor & (rest > 0) & (half < 0), -half - np.sqrt(np.maximum(rest, 0.0)), np.inf)
        to_floor = np.where(~from_floor & (ray[:, 1] < 0), at[:, 1] / np.maximum(-ray[:, 1], 1e-12), np.inf)
        way = np.minimum(to_ball, to_floor)
        met = np.isfinite(way)
        total += weight[~met].sum()
        ball = (to_ball < to_floor)[met, None]
        at = at[met] + way[met, None] * ray[met]
        at[:, 1] = np.where(ball[:, 0], at[:, 1], 0.0)
        normal = np.where(ball, at - [0.0, 1.0, 0.0], [0.0, 1.0, 0.0])
        weight = weight[met] * np.where(ball[:, 0], sphere, floor)
    return total / rays


def test_a_black_ball_takes_the_sky_that_it_covers_from_the_floor():
    covered = (1 + (PLACES**2).sum(axis=1)) ** -1.5  # the form factor of a sphere above the plane of a small patch
    assert on_contact(0.0, 0.8) == pytest.approx(0.8 * (1 - covered), abs=0.015)


@pytest.mark.parametrize("tone", [0.2, 0.5, 0.8])
def test_contacts_get_the_light_that_goes_back_and_forth_between_them(tone):
    exact = [followed(place, tone, tone) for place in PLACES]
    assert on_contact(tone, tone) == pytest.approx(exact, abs=0.025)


def test_white_contacts_in_a_furnace_are_not_to_be_seen():
    shapes = stage.floor(gray(1.0)), stage.sphere(gray(1.0), (0, 1, 0)), stage.box(gray(1.0), (1.3, 0.5, 0), (1, 1, 1))
    picture = draw(*shapes, lights=(sky(1.0),), seen=AROUND)
    assert np.abs(picture - 1).max() < 0.01


@pytest.mark.parametrize(("tone", "most"), [(0.5, 0.0), (0.8, 0.0), (0.95, 0.0), (0.98, 0.0), (0.99, 0.005)])
def test_no_sky_comes_into_a_closed_room(tone, most):
    walls = [
        stage.box(gray(tone), tuple(1.1 * side * np.eye(3)[axis]), tuple(2.4 - 2.2 * np.eye(3)[axis]))
        for axis in range(3)
        for side in (-1, 1)
    ]
    seen = view((0, 0, 0.9), (0, -0.3, 0), (48, 36), 0.8, orthographic=False)
    assert draw(*walls, lights=(sky(1.0),), seen=seen).max() < 1e-6 + most


@pytest.mark.parametrize("tone", [0.3, 0.6, 0.8, 0.9])
def test_a_lamp_in_a_hollow_ball_lights_it_by_all_that_goes_back_and_forth(tone):
    seen = view((0, 0, 0.5), (0, -0.3, 0), (48, 36), 0.8, orthographic=False)
    picture = draw(stage.sphere(gray(tone)), lights=(PointLight((0.0,) * 3, (1.0,) * 3, 0.02),), seen=seen)
    assert picture == pytest.approx(tone / (1 - tone) / np.pi, rel=0.015)  # as in an integrating sphere


@pytest.mark.parametrize("tone", [0.95, 0.98, 0.99, 0.995])
def test_light_goes_back_and_forth_between_bright_walls_until_it_is_gone(tone):
    seen = view((0, 0, 0.5), (0, -0.3, 0), (48, 36), 0.8, orthographic=False)
    lamp = PointLight((0.0,) * 3, ((1 - tone) / tone,) * 3, 0.02)
    picture = draw(stage.sphere(gray(tone)), lights=(lamp,), seen=seen)
    assert picture == pytest.approx(1 / np.pi, rel=0.025)


@pytest.mark.parametrize("tone", [0.9, 0.98])
def test_no_light_comes_into_a_hollow_mirror(tone):
    mirror = Surface(color=(tone,) * 3, roughness=0.0, metallic=1.0)
    seen = view((0.3, 0.2, 0.2), (0.2, 0.1, 0.0), (48, 36), 0.8, orthographic=False)
    lights = sky(1.0), sun((0.5, 1.0, 0.3), (3.0,) * 3, 0.2)
    assert draw(stage.sphere(mirror, radius=0.5), lights=lights, seen=seen).max() < 0.02


def heap(surface, along=0.0, above=0.22):
    """A picture of balls of a surface over a floor, lit by a wide sun and a sky."""
    places = [(along + 0.4 * i - 0.6, 0.35 * (i % 2) - 0.42 + above, 0.3 * (i % 3)) for i in range(4)]
    balls = [stage.sphere(surface, place, 0.22) for place in places]
    return draw(*balls, stage.floor(), lights=(sun((1.0, 1.0, 0.5), (2.0, 2.0, 2.0), 0.05), sky(0.5)))


def test_a_faint_reflection_takes_few_rays_beside_those_of_the_surface_that_it_is_seen_in(monkeypatch):
    listed = []
    meet = waves.Waves._meet

    def counted(own):
        listed[-1] += int(own.asked[0, layout.NEXT]) - 1
        meet(own)

    monkeypatch.setattr(waves.Waves, "_meet", counted)
    for gloss in ({"roughness": 1.0, "specular": 0.0}, {"roughness": 0.1}):
        listed.append(0)
        heap(Surface(color=(0.8, 0.8, 0.8), **gloss))
    matte, glossy = listed
    assert matte < glossy < 1.2 * matte  # 1.14; 1.25 by as many samples as surfaces seen directly


def test_reflections_are_the_same_whatever_was_drawn_before():
    glossy = Surface(color=(0.8, 0.8, 0.8), roughness=0.1)
    buffers._kept.clear()
    first = heap(glossy).copy()
    for along in (-0.5, 0.3):
        heap(glossy, along, 0.5)
        np.testing.assert_array_equal(heap(glossy), first)
