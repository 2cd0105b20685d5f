"""Tiles of a picture that no ray need enter: all others are marked, and those show what rays would see."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing import buffers, waves
from renderers.tracing import draw as drawing
from renderers.tracing.light import look_lanes_kernels
from renderers.tracing.pack import pack
from renderers.tracing.probe import probe
from renderers.tracing.tiles_kernels import reach
from sceneql.field.tape.builder import TapeBuilder
from sceneql.frame import Implicit, PointLight, Sky
from stage import GLOW, WHITE, frame, sun, view

SKY = Sky((0.9, 1.0, 1.2), (0.8, 0.6, 0.4), (0.3, 0.3, 0.3))
SIZE = (150, 90)
MIRROR = replace(WHITE, roughness=0.0, metallic=1.0)
TILE = 16


def reached(scene):
    """(rows, columns) of the tiles that are marked."""
    width, height = scene.view.size
    marks = np.full((-(-height // TILE), -(-width // TILE)), 7, dtype=np.int8)
    reach(pack(scene)[0], marks)
    return marks


def in_tiles(pixels):
    """Whether any pixel (h, w) of each tile is set."""
    height, width = pixels.shape
    whole = np.zeros((-(-height // TILE) * TILE, -(-width // TILE) * TILE), dtype=bool)
    whole[:height, :width] = pixels
    return whole.reshape(len(whole) // TILE, TILE, -1, TILE).any(axis=(1, 3))


def crowd(random, count):
    """Balls of many sizes: some around the camera, some behind it."""
    centers = random.uniform(-3.0, 3.0, (count, 3))
    return stage.points(GLOW, centers, 10.0 ** random.uniform(-2.5, -0.3, count))


@pytest.mark.parametrize("orthographic", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_every_tile_in_which_something_is_met_is_marked(seed, orthographic):
    random = np.random.default_rng(seed)
    eye, target = random.uniform(-2.0, 2.0, (2, 3))
    seen = view(eye, target, SIZE, random.uniform(0.3, 1.5), orthographic)
    lattice = stage.torus(WHITE, 0.5, 0.1)
    for shapes in ((crowd(random, 3),), (crowd(random, 40), lattice), (stage.round_mesh(WHITE, 0.4, 8),)):
        scene = frame(*shapes, seen=seen)
        marks = reached(scene)
        assert set(np.unique(marks)) <= {0, 1}
        assert (marks[in_tiles(np.isfinite(probe(scene).depth))] == 1).all()


def in_a_ball(random, stretch):
    """A formula's solid in a ball or, with ``stretch``, in an ellipsoid; in a box far larger, turned and moved."""
    b = TapeBuilder()
    matrix = np.linalg.qr(random.normal(size=(3, 3)))[0] * random.uniform(0.7, 1.4, (3, 1) if stretch else 1)
    x, y, z = b.affine(np.column_stack([matrix, random.uniform(-0.6, 0.6, 3)]), b.x, b.y, b.z)
    squares = [b.op("square", axis) for axis in (x, y, z)]
    ball = b.op("sub", b.op("add", b.op("add", squares[0], squares[1]), squares[2]), b.constant(0.36))
    wave = b.op("sub", b.op("mul", b.op("sin", b.op("mul", x, b.constant(9.0))), y), b.constant(0.1))
    return Implicit("cut", WHITE, b.finish(b.op("max", wave, ball)), (-3.0,) * 3, (3.0,) * 3)


@pytest.mark.parametrize("orthographic", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_tiles_beside_the_ball_that_an_implicit_solid_is_in_are_left_out(seed, orthographic):
    """Whether a formula says so, the points that it is made of, or both, and the camera is in the ball or behind it."""
    random = np.random.default_rng(seed)
    points = replace(stage.blob(WHITE, (0.2, 0.1, 0.0), seed), low=(-2.0,) * 3, high=(2.0,) * 3)
    for shapes in (
        (in_a_ball(random, False),),
        (in_a_ball(random, True),),
        (points,),
        (points, in_a_ball(random, False)),
    ):
        for eye, half in (((0.5, 1.0, 4.0), 0.4), ((0.3, 0.2, 0.4), 1.5), ((1.0, 0.0, -3.0), 0.2)):
            scene = frame(*shapes, seen=view(eye, random.uniform(-0.5, 0.5, 3), SIZE, half, orthographic))
            marks = reached(scene)
            assert (marks[in_tiles(np.isfinite(probe(scene).depth))] == 1).all()
    seen = view((0.5, 1.0, 4.0), (0, 0, 0), (640, 360), 1.5 if orthographic else 0.4, orthographic)
    assert 0.0 < reached(frame(in_a_ball(random, False), seen=seen)).mean() < 0.5
    assert 0.0 < reached(frame(points, seen=seen)).mean() < 0.5


def test_tiles_about_one_small_thing_are_few_and_with_a_floor_all_are():
    ball = stage.sphere(WHITE, (0.3, 0.2, 0.0), 0.05)
    seen = view((0.0, 1.0, 5.0), (0, 0, 0), (640, 360), 0.3, False)
    assert 1 <= reached(frame(ball, seen=seen)).sum() <= 4
    assert reached(frame(ball, stage.floor(), seen=seen)).all()
    behind = view((0.0, 0.0, -5.0), (0, 0, -9), SIZE, 0.3, False)
    assert not reached(frame(ball, seen=behind)).any()


@pytest.mark.parametrize("visible", [None, (0.1, 0.2, 0.3)])
@pytest.mark.parametrize("orthographic", [True, False])
def test_what_is_drawn_at_once_is_what_rays_see(monkeypatch, orthographic, visible):
    """To the bit: edges at the rim of a tile, lines thinner than a pixel, mirrors and glass among nothing."""
    glass = replace(WHITE, roughness=0.0, transmission=1.0)
    shapes = (
        stage.sphere(MIRROR, (-1.2, 0.3, 0.0), 0.2),
        stage.sphere(glass, (0.9, -0.4, 0.0), 0.22),
        stage.blob(WHITE, (0.1, 0.6, -0.4)),
        stage.segment(WHITE, (-1.5, -0.8, 0.0), (0.4, -0.1, 0.3), 0.002),
    )
    seen = view((0.3, 0.5, 4.0), (0, 0, 0), SIZE, 1.2 if orthographic else 0.35, orthographic)
    lights = replace(SKY, visible=visible), sun((0.5, 0.8, 0.4)), PointLight((-1.0, 3.0, 2.0), (3.0,) * 3, 0.2)
    scene = frame(*shapes, lights=lights, seen=seen)
    assert 0.1 < reached(scene).mean() < 0.6
    once = Trace(samples=4).draw(scene).linear
    monkeypatch.setattr(drawing, "reach", lambda scene, marks: marks.fill(1))
    assert np.array_equal(once, Trace(samples=4).draw(scene).linear)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_thing_that_moves_leaves_nothing_behind(mirrored):
    """Nor does a mirror, of whose pixels two records are kept, on a floor, whose pixels have one."""

    def at(x):
        shapes = (stage.sphere(MIRROR, (x, 0.1, 0.0), 0.3), stage.floor()) if mirrored else ()
        ball = stage.blob(WHITE, (x, 0.1, 0.0))
        seen = view((0.0, 0.5, 4.0), (0, 0, 0), SIZE, 1.5)
        return frame(*(shapes or (ball,)), lights=(SKY, sun((0.5, 0.8, 0.4), angle=0.1)), seen=seen)

    fresh = []
    for x in (-1.2, 1.0, 9.0):
        buffers._kept.clear()
        fresh.append(Trace(samples=4).draw(at(x)).linear)
    for x, picture in zip((-1.2, 1.0, 9.0, 1.0, -1.2), [*fresh, fresh[1], fresh[0]], strict=True):
        assert np.array_equal(Trace(samples=4).draw(at(x)).linear, picture)


def test_rays_to_suns_that_boxes_show_to_meet_nothing_are_left_out_to_the_bit(monkeypatch):
    """Two soft suns and a lamp above a floor: one sun from behind it, one low, whose light a box far away takes."""
    shapes = (
        stage.sphere(MIRROR, (0.2, 0.4, 0.0), 0.4),
        stage.floor(),
        stage.box(WHITE, (9.0, 2.0, 0.0), (0.5, 4.0, 1.0)),
    )
    suns = sun((0.5, 0.8, 0.4), angle=0.05), sun((1.0, 0.2, 0.0), angle=0.02), sun((0.0, -1.0, 0.1), angle=0.1)
    lights = SKY, *suns, PointLight((-1.0, 3.0, 2.0), (3.0,) * 3, 0.2)
    for orthographic in (True, False):
        seen = view((0.3, 1.5, 4.0), (0, 0, 0), SIZE, 1.2 if orthographic else 0.35, orthographic)
        scene = frame(*shapes, lights=lights, seen=seen)
        listed = Trace(samples=4).draw(scene).linear
        with monkeypatch.context() as patch:
            patch.setattr(look_lanes_kernels, "MOST_LIGHTS", -1)  # all look around one by one
            assert np.array_equal(listed, Trace(samples=4).draw(scene).linear)


def test_paths_of_light_followed_by_one_call_end_as_wave_by_wave(monkeypatch):
    for shapes in ((stage.torus(WHITE, 0.5, 0.2),), (stage.sphere(WHITE, (0.0, 0.5, 0.0), 0.5),)):
        seen = view((0.3, 1.5, 4.0), (0, 0, 0), (64, 48), 1.2)
        scene = frame(*shapes, stage.floor(), lights=(SKY, sun((0.5, 0.8, 0.4), angle=0.05)), seen=seen)
        at_once = Trace(samples=4).draw(scene).linear
        with monkeypatch.context() as patch:
            patch.setattr(waves, "ways_follower", lambda *_: None)
            assert np.array_equal(at_once, Trace(samples=4).draw(scene).linear)
