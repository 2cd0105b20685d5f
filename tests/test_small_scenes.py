"""Scenes of millimetres look like those of metres, take as much work, and rounding of far rays is no part of them."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal, localcontext

import numpy as np
import pytest

from renderers.trace import Trace
from renderers.tracing import waves
from renderers.tracing.pack import pack
from renderers.tracing.scratch import scratch
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.window import FARTHEST
from sceneql.frame import Mesh, Points, Quadric, Segments, Sky, Surface
from stage import GLOW, WHITE, cylinder, floor, frame, implicit_sphere, points, round_mesh, sphere, view

SKY = Sky((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (0.2, 0.2, 0.2))
ROUGH = Surface(color=(0.8, 0.8, 0.8), roughness=1.0, specular=0.0)
TURN = np.array([[0.8, 0.0, 0.6], [0.36, 0.8, -0.48], [-0.48, 0.6, 0.64]])


def ring(radius=0.1, count=100, surface=WHITE):
    """A closed line of pieces shorter than it is thick."""
    angles = np.linspace(0.0, 2 * np.pi, count + 1)
    places = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
    return Segments("ring", surface, np.stack([places[:-1], places[1:]], axis=1), np.full(count, radius))


def turned(solid):
    return replace(solid, to_local=np.column_stack([solid.to_local[:, :3] @ TURN, solid.to_local[:, 3]]))


def scaled(shape, scale):
    """A shape, ``scale`` times as large about the origin."""
    if isinstance(shape, Quadric):
        return replace(shape, to_local=shape.to_local / [scale, scale, scale, 1.0])
    if isinstance(shape, Segments):
        return replace(shape, ends=scale * shape.ends, radii=scale * shape.radii)
    if isinstance(shape, Points):
        return replace(shape, centers=scale * shape.centers, radii=scale * shape.radii)
    assert isinstance(shape, Mesh)
    return replace(shape, vertices=scale * shape.vertices)


def seen_at(scale, *shapes, size=(96, 72)):
    """Shapes and the view of them, all ``scale`` times as large."""
    seen = replace(view(size=size), origin=(0.0, 0.0, 5.0 * scale), half_height=1.5 * scale)
    return frame(*(scaled(shape, scale) for shape in shapes), lights=(SKY,), seen=seen)


KINDS = {
    "line": (ring(),),
    "line thinner than a pixel": (ring(0.005),),
    "mesh": (round_mesh(WHITE, steps=8),),
    "balls": (points(WHITE, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [0.7, 0.3]),),
    "sphere": (sphere(WHITE),),
    "cylinder": (turned(cylinder(WHITE, 0.5, 1.2)),),
    "on a floor": (sphere(ROUGH), turned(floor(WHITE, -1.0))),
}


@pytest.mark.parametrize("scale", [1e-3, 1e-5])
@pytest.mark.parametrize("kind", KINDS)
def test_a_small_scene_looks_like_a_large_one(kind, scale):
    """Of rays from 10 km away spheres were rough, and pieces of lines lay inside of others: dark, and slow to light."""
    large, small = (Trace().draw(seen_at(each, *KINDS[kind])).linear for each in (1.0, scale))
    assert small == pytest.approx(large, abs=2e-6)


def test_light_takes_as_many_steps_around_small_lines_as_around_large_ones(monkeypatch):
    steps = []

    def counted(scene, scratch, asked, ways, live, first, last):
        end = waves_step(scene, scratch, asked, ways, live, first, last)
        steps[-1] += end - first
        return end

    waves_step = waves.step_all
    monkeypatch.setattr(waves, "step_all", counted)
    # Packets count steps, of frames with two solids: with one all steps of a wave are one call.
    aside = [implicit_sphere(GLOW, 1e-6, 2e-6), implicit_sphere(GLOW, 2e-6, 3e-6)]
    for scale in (1.0, 1e-3):
        steps.append(0)
        small = seen_at(scale, ring(surface=ROUGH))
        Trace().draw(replace(small, shapes=(*small.shapes, *aside)))
    assert steps[0] > 300
    assert steps[1] == pytest.approx(steps[0], rel=0.02)


def first_root(start, towards, center, squares):
    """Where a ray first meets {sum squares (p - center)^2 = 1}, by 60 digits."""
    with localcontext() as context:
        context.prec = 60
        o, d, c, s = ([Decimal(float(x)) for x in row] for row in (start, towards, center, squares))
        p = [a - b for a, b in zip(o, c, strict=True)]
        a = sum(w * x * x for w, x in zip(s, d, strict=True))
        b = sum(w * x * y for w, x, y in zip(s, d, p, strict=True))
        rest = sum(w * y * y for w, y in zip(s, p, strict=True)) - 1
        return float((-b - (b * b - a * rest).sqrt()) / a)


@pytest.mark.parametrize("away", [10.0, 1e4, 1e8])
@pytest.mark.parametrize("kind", ["line", "tube", "sphere"])
def test_a_ray_meets_a_round_solid_where_exact_arithmetic_says_from_any_distance(kind, away):
    scale = 2.0**-10  # a power of two: squares are 1/scale^2 exactly
    line = Segments("line", GLOW, np.array([[(-32.0 * scale, 0.0, 0.0), (32.0 * scale, 0.0, 0.0)]]), np.array([scale]))
    tube = Quadric("tube", GLOW, np.eye(3, 4) / scale, (0, 1, 1), (0, 0, 0), -1, (-32.0,) * 3, (32.0,) * 3)
    ball = scaled(sphere(), scale)
    shape = {"line": line, "tube": tube, "sphere": ball}[kind]
    squares = np.array([kind == "sphere", 1.0, 1.0]) / scale**2
    scene, rows = pack(frame(shape))
    random = np.random.default_rng(3)
    for _ in range(40):
        aim = scale * random.uniform(-0.5, 0.5, 3)
        towards = random.normal(size=3) * (0.2, 1.0, 1.0)
        towards /= np.linalg.norm(towards)
        start = aim - away * scale * towards
        t, item, _ = walk(scene, scratch(rows), *start, *towards, 0.0, math.inf, False)
        assert item >= 0
        assert abs(t - first_root(start, towards, np.zeros(3), squares)) < 4e-15 * (away + 10.0) * scale


def bright(*shapes, origin=(0.0, 0.0, 0.0), **how):
    """Which pixels of a view along -z from a window at ``origin`` show something that glows."""
    seen = replace(view(size=(32, 24), half_height=1.2, **how), origin=origin)
    return Trace(samples=1).draw(frame(*shapes, seen=seen)).linear[..., 0] == 1.0


def test_what_lies_before_the_plane_of_an_orthographic_window_is_seen():
    behind = bright(sphere(), origin=(0.0, 0.0, 3.0))
    assert 0 < behind.sum() < behind.size
    assert np.array_equal(bright(sphere()), behind)
    assert np.array_equal(bright(sphere(), origin=(0.0, 0.0, -4000.0)), behind)


@pytest.mark.parametrize("origin", [(0.0, 0.0, 5.0), (0.0, 0.0, 0.0), (0.0, 0.0, -5.0)])
def test_a_floor_is_seen_from_its_outer_side_wherever_the_window_is(origin):
    """The face of a half-space, slanted: on all of the picture, at the depth that its plane has there."""
    slanted = replace(floor(GLOW), to_local=np.eye(3, 4), linear=(0.0, 0.6, 0.8))
    assert bright(slanted, origin=origin).all()


def test_an_endless_solid_is_seen_as_from_very_far():
    endless = replace(cylinder(GLOW, 0.5, math.inf), low=(-math.inf,) * 3, high=(math.inf,) * 3)
    found = bright(endless)
    assert np.array_equal(found, bright(endless, origin=(0.0, 0.0, 0.5 * FARTHEST)))
    assert (found == (np.abs((np.arange(32) + 0.5) / 32 * 3.2 - 1.6) < 0.5)).all()
