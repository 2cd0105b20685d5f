"""Laws of the tracer: areas, shadows, energy, mirrors, and pictures that repeat to the bit."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stage
from renderers.normals import Normals
from renderers.trace import Trace
from renderers.tracing import scratch as made_of
from renderers.tracing import waves
from renderers.tracing.buffers import _kept
from renderers.tracing.filter.edges_kernels import BEYOND
from renderers.tracing.pack import pack
from renderers.tracing.scratch import scratch
from renderers.tracing.solids.intersect_kernels import walk
from sceneql.frame import Mesh, PointLight, Points, Segments, Sky, Surface
from stage import GLOW, WHITE, frame, sun, view

UNIFORM = Sky((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
BLACK = Surface(color=(0.0, 0.0, 0.0), specular=0.0)
MIRROR = Surface(color=(1.0, 1.0, 1.0), roughness=0.0, metallic=1.0)


def draw(*shapes, **more):
    samples = more.pop("samples", 8)
    return Trace(samples=samples).draw(frame(*shapes, **more)).linear


def area(picture, seen):
    """Area of what glows in an orthographic picture."""
    return picture[..., 0].sum(dtype=float) * (2 * seen.half_height / seen.size[1]) ** 2


@pytest.mark.parametrize(
    ("shape", "exact"),
    [
        (stage.sphere(), math.pi),
        (stage.points(GLOW, [(0, 0, 0)], [1.0]), math.pi),
        (stage.implicit_sphere(GLOW), math.pi),
        (stage.round_mesh(GLOW), math.pi),
        (stage.torus(GLOW, 1.0, 0.4), 5.0265482457),
        (stage.cylinder(GLOW, 0.5, 2.0), 2.0),
        (stage.box(GLOW, (0.1, 0, 0), (1.3, 0.7, 1)), 0.91),
        (stage.segment(GLOW, (-0.5, 0, 0), (0.5, 0, 0), 0.4), 0.8 + math.pi * 0.16),
    ],
    ids=["quadric", "point", "implicit", "mesh", "torus", "cylinder", "box", "capsule"],
)
def test_silhouettes_have_their_exact_area(shape, exact):
    seen = view(size=(120, 120))
    assert area(draw(shape, seen=seen, samples=16), seen) == pytest.approx(exact, rel=4e-3)


def test_a_sphere_looks_the_same_whatever_it_is_made_of():
    lights = (sun((0.4, 0.8, 0.6), (2.0, 2.0, 2.0)), UNIFORM)
    clay = Surface(color=(0.7, 0.5, 0.3), roughness=0.6)
    quadric = draw(stage.sphere(clay), lights=lights)
    for other in (stage.points(clay, [(0, 0, 0)], [1.0]), stage.implicit_sphere(clay), stage.round_mesh(clay)):
        assert np.abs(draw(other, lights=lights) - quadric).mean() < 3e-3


@pytest.mark.parametrize("side", [1, -1], ids=["front", "back"])
def test_facets_of_a_coarse_mesh_throw_no_shadows_on_it(side):
    ball = stage.round_mesh(WHITE, steps=8)  # 256 triangles, of a smooth ball, seen from their front or their back
    ball = replace(ball, triangles=ball.triangles[:, ::side].copy(), normals=side * ball.normals)
    light = sun((1.0, 0.25, 0.0), (math.pi,) * 3)
    for row in draw(ball, lights=[light])[24:72, 24:66, 0]:
        lit = row[row > 0.0]
        assert np.diff(lit).min() > -1e-3
        assert lit[0] < 0.05  # it fades out, where a facet's shadow cut it off
        assert np.diff(lit).max() < 0.06


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_edges_of_what_is_brighter_than_white_are_smooth(quarters):
    # Seen by 1/4, 2/4 or 3/4 of a pixel's rays. Plain means would make 7.5 of 30 and black, which is as white as 30.
    seen = view(size=(8, 8), half_height=4.0)
    for brightness, tamed in ((0.8, 0.8), (30.0, 1 + BEYOND * (1 - 1 / 30))):
        lamp = Surface(color=(0.0, 0.0, 0.0), specular=0.0, emission=(brightness, 0.5 * brightness, 0.0))
        picture = draw(stage.box(lamp, (quarters / 8, 0, 0), (2 + quarters / 4, 9, 1)), seen=seen)
        mean = quarters / 4 * tamed
        exact = mean
        assert picture[4, 5] == pytest.approx([exact, exact / 2, 0.0], rel=1e-5)
        assert picture[4, 4] == pytest.approx([brightness, brightness / 2, 0.0], rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 0.05, 0.15])
def test_a_sphere_throws_a_shadow_of_the_right_size_to_the_right_place(angle):
    # From above; the sun stands 45 degrees high, so the shadow lies 3 m off and is an ellipse of area pi r^2 sqrt(2).
    seen = view((3, 9, 0), (3, 0, 0), size=(96, 96), half_height=1.5, up=(0, 0, -1))
    light = sun((-1, 1, 0), (math.pi * math.sqrt(2),) * 3, angle)
    picture = draw(stage.floor(), stage.sphere(BLACK, (0, 3, 0), 0.5), lights=[light], seen=seen)[..., 0]
    assert picture[:8].min() > 0.999
    dark = 1 - picture
    assert dark.sum() * (3 / 96) ** 2 == pytest.approx(math.pi * 0.25 * math.sqrt(2), rel=0.015)
    x = (np.arange(96) + 0.5) * 3 / 96 - 1.5
    assert (dark.sum(axis=0) * x).sum() / dark.sum() == pytest.approx(0.0, abs=0.02)
    assert (dark.sum(axis=1) * x).sum() / dark.sum() == pytest.approx(0.0, abs=0.01)


def test_what_shows_a_lamp_throws_no_shadow_in_its_light():
    seen = view((0, 9, 0), (0, 0, 0), size=(16, 16), half_height=1.0, up=(0, 0, -1))
    lamp = PointLight((3.0, 2.0, 0.0), (10.0, 10.0, 10.0), 0.3)
    bare, shown, hidden = (
        draw(stage.floor(), *more, lights=[lamp], seen=seen)
        for more in ([], [stage.sphere(GLOW, lamp.position, 0.3)], [stage.sphere(BLACK, lamp.position, 0.31)])
    )
    assert bare.min() > 0.05
    np.testing.assert_array_equal(shown, bare)
    assert hidden.max() == 0.0


def test_a_point_light_falls_with_the_square_of_the_distance():
    seen = view((0, 9, 0), (0, 0, 0), size=(32, 32), half_height=0.1, up=(0, 0, -1))
    near, far = (
        draw(stage.floor(), lights=[PointLight((0, h, 0), (math.pi,) * 3, 0.01)], seen=seen)[16, 16, 0] for h in (1, 3)
    )
    assert near == pytest.approx(1.0, rel=0.01)
    assert far == pytest.approx(1 / 9, rel=0.01)


@pytest.mark.parametrize(
    "shape",
    [stage.sphere(WHITE), stage.round_mesh(WHITE), stage.blob(WHITE), stage.torus(WHITE, 0.8, 0.3)],
    ids=["sphere", "mesh", "blob", "torus"],
)
def test_in_a_furnace_white_things_are_hardly_to_be_seen(shape):
    picture = draw(shape, lights=[UNIFORM])
    assert picture.max() < 1.002
    assert picture.mean() > (0.999 if shape.name in ("sphere", "mesh") else 0.93)


def test_in_a_furnace_glass_and_mirrors_give_all_light_back():
    for surface in (Surface(color=(1, 1, 1), roughness=0.0, transmission=1.0), MIRROR):
        picture = draw(stage.sphere(surface), lights=[UNIFORM])
        assert picture.min() > 0.97
        assert picture.max() < 1.03


def test_a_mirror_shows_what_stands_before_it():
    wall = stage.box(MIRROR, (0, 0, -0.5), (8, 8, 1))
    lamp = stage.sphere(GLOW, (0.7, 0.2, 1.0), 0.2)
    picture = draw(wall, lamp, seen=view((-1.0, 0, 4.0), (0, 0, 0), (200, 100), 0.5, orthographic=False))
    camera = view((-1.0, 0, 4.0), (0, 0, 0), (200, 100), 0.5, orthographic=False)
    for place in ((0.7, 0.2, 1.0), (0.7, 0.2, -1.0)):
        x, y, z = camera.axes @ (np.array(place) - np.array(camera.origin))
        column, row = 100 + x / -z / 0.5 * 50, 50 - y / -z / 0.5 * 50
        assert picture[int(row), int(column)] == pytest.approx((1.0, 1.0, 1.0), abs=0.02)


def test_a_checkered_floor_fades_into_its_mean_and_the_horizon_has_no_edge():
    surface = replace(WHITE, checker_size=0.5, checker_color=(0.2, 0.2, 0.2))
    seen = view((0, 1.5, 0), (0, 1.3, -5), (128, 128), 0.4, orthographic=False)
    picture = draw(stage.floor(surface), lights=[UNIFORM], seen=seen)[..., 0]
    horizon = int(np.flatnonzero(picture[:, 64] < 0.999)[0])
    strip = picture[horizon : horizon + 7]
    assert strip.std(axis=1).max() < 0.02  # no pattern where the squares are smaller than a pixel
    assert np.abs(np.diff(picture[horizon - 2 : horizon + 8], axis=0)).max() < 0.2
    assert picture[-20:].min() < 0.25 < 0.9 < picture[-20:].max()


@pytest.mark.parametrize("off", [0.0, 0.05, 0.1])
def test_wide_penumbras_behind_a_row_of_bars_are_nearly_those_of_finer_pictures(off):
    ends = [((off - 0.5, 1.2, 0.12 * k - 0.5), (off + 0.5, 1.2, 0.12 * k - 0.3)) for k in range(9)]
    shapes = stage.floor(), *(stage.segment(WHITE, *pair, 0.025) for pair in ends)

    def shadow(times):  # on the floor, from right above
        seen = view((0.0, 3.0, -0.8), (0.0, 0.0, -0.8001), (80 * times, 60 * times), 1.0)
        return draw(*shapes, lights=[sun((0.2, 0.9, 0.6), (2.2,) * 3, 0.2)], seen=seen)[..., 0]

    fine = shadow(4).reshape(60, 4, 80, 4).mean(axis=(1, 3))
    error = shadow(1) - fine
    assert fine.max() - fine.min() > 0.3
    assert np.sqrt((error[12:36, 16:52] ** 2).mean()) < 0.028


def test_soft_shadow_and_sky_light_have_no_grain():
    lights = [sun((-0.5, 0.9, 0.6), (2.2,) * 3, 0.12), Sky((0.8,) * 3, (0.9,) * 3, (0.3,) * 3)]
    seen = view((2.2, 1.7, 3.2), (0, 0.3, 0), (240, 135), 0.32, orthographic=False)
    clay = replace(WHITE, color=(0.6,) * 3)
    shapes = stage.floor(clay), stage.blob(clay, (0, 0.85, 0))
    picture = draw(*shapes, lights=lights, seen=seen)[..., 0]
    normals = Normals().draw(frame(*shapes, seen=seen)).linear
    on_floor = (normals == normals[-1, 0]).all(axis=-1)
    bumps = sum(np.roll(picture, shift, axis) for shift, axis in ((1, 0), (-1, 0), (1, 1), (-1, 1))) / 4 - picture
    inner = on_floor & np.all([np.roll(on_floor, s, a) for s in (-1, 1) for a in (0, 1)], axis=0)
    inner[[0, -1]] = inner[:, [0, -1]] = False
    assert picture[inner].min() < 0.4 < 0.7 < picture[inner].max()  # there is a shadow
    assert np.quantile(np.abs(bumps[inner]), 0.9) < 0.0015
    assert np.sqrt((bumps[inner] ** 2).mean()) < 0.004


def test_a_spark_that_few_samples_meet_leaves_no_blotches():
    spark = Surface(color=(0.0, 0.0, 0.0), specular=0.0, emission=(400.0, 400.0, 400.0))
    seen = view((0, 9, 0), (0, 0, 0), up=(0, 0, -1))
    dusk = Sky((0.1,) * 3, (0.1,) * 3, (0.1,) * 3)
    picture = draw(stage.floor(), stage.sphere(spark, (0, 0.6, 0), 0.03), lights=[dusk], seen=seen)[..., 0]
    beside = picture[:40]
    assert picture[48, 48] > 1
    assert np.abs(np.diff(beside, axis=0)).max() < 0.02
    assert np.abs(np.diff(beside, axis=1)).max() < 0.02


def scene_of_all_kinds():
    clay = Surface(color=(0.7, 0.5, 0.3), roughness=0.2)
    glass = Surface(color=(1, 1, 1), roughness=0.0, transmission=1.0)
    return frame(
        stage.floor(replace(WHITE, checker_size=0.3), -1.0),
        stage.blob(clay),
        stage.sphere(MIRROR, (1.2, -0.5, 0.3), 0.5),
        stage.sphere(glass, (-1.1, -0.6, 0.8), 0.4),
        stage.points(clay, [(0.2 * k - 1, -0.9, 1.2) for k in range(9)], [0.08] * 9),
        stage.segment(clay, (-1.5, -0.5, 0), (-1.4, 0.8, 0.2), 0.05),
        lights=[sun((-0.5, 0.9, 0.6), (2.0,) * 3, 0.1), PointLight((1, 2, 1), (1,) * 3), UNIFORM],
        seen=view((1, 1, 5), (0, -0.1, 0), (99, 61), 0.3, orthographic=False),
    )


def test_the_bytes_are_the_same_again_and_for_any_number_of_threads(monkeypatch):
    pictures = []
    for threads in ("1", "2", "2", "5"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        pictures.append(Trace().draw(scene_of_all_kinds()).linear.tobytes())
    assert len(set(pictures)) == 1


@pytest.mark.parametrize("junk", [1.0, -5.0])
def test_a_picture_shows_nothing_of_the_one_before(junk, monkeypatch):
    thin = stage.segment(MIRROR, (-0.9, -0.31, 0), (0.8, 0.23, 0), 0.004)
    black = Sky((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    draws = [
        lambda: Trace().draw(scene_of_all_kinds()).linear,
        lambda: draw(thin, lights=(sun((0, 1, 1), (3.0, 3.0, 3.0)), black)),
    ]
    for again in draws:
        first = again().copy()  # its memory is that of the next picture
        for kept in _kept:
            for array in vars(kept).values():
                if isinstance(array, np.ndarray):
                    array[...] = junk
        with monkeypatch.context() as patched:
            for module in (waves, made_of):
                full = SimpleNamespace(**vars(np) | {"empty": lambda shape, dtype=float: np.full(shape, junk, dtype)})
                patched.setattr(module, "np", full)
            assert np.array_equal(again(), first)


def test_all_kinds_in_one_picture_give_light_of_finite_brightness():
    picture = Trace().draw(scene_of_all_kinds())
    assert np.isfinite(picture.linear).all()
    assert picture.linear.min() >= 0
    assert picture.undecided == 0


def rays(count, seed):
    random = np.random.default_rng(seed)
    origins = random.uniform(-3, 3, (count, 3))
    directions = random.normal(size=(count, 3))
    return np.hstack([origins, directions / np.linalg.norm(directions, axis=1)[:, None]])


def met(shapes, ray, anywhere=False):
    scene, rows = shapes if isinstance(shapes, tuple) else pack(frame(shapes))
    return walk(scene, scratch(rows), *ray, 0.0, math.inf, anywhere)


def test_the_hierarchy_finds_what_trying_all_finds():
    random = np.random.default_rng(7)
    corners = random.uniform(-2, 2, (40, 1, 3)) + random.normal(size=(40, 3, 3)) * 0.4
    singles = [Mesh("m", GLOW, c, np.array([[0, 1, 2]], dtype=np.int32)) for c in corners]
    singles += [stage.points(GLOW, [random.uniform(-2, 2, 3)], [random.uniform(0.05, 0.4)]) for _ in range(30)]
    singles += [stage.segment(GLOW, *random.uniform(-2, 2, (2, 3)), random.uniform(0.02, 0.2)) for _ in range(30)]
    triangles = np.arange(120, dtype=np.int32).reshape(40, 3)
    whole = (
        Mesh("m", GLOW, corners.reshape(-1, 3), triangles),
        Points("p", GLOW, np.vstack([s.centers for s in singles[40:70]]), np.hstack([s.radii for s in singles[40:70]])),
        Segments("s", GLOW, np.vstack([s.ends for s in singles[70:]]), np.hstack([s.radii for s in singles[70:]])),
    )
    all_of_them, apart = pack(frame(*whole)), [pack(frame(single)) for single in singles]
    hits = 0
    for ray in rays(120, 1):
        t = met(all_of_them, ray)[0]
        assert t == pytest.approx(min(met(one, ray)[0] for one in apart), rel=1e-12)
        dark = met(all_of_them, ray, anywhere=True)[2] == 0.0
        assert dark == (t < math.inf)
        hits += dark
    assert 20 < hits < 110


def test_no_shadow_ray_slips_through_an_implicit_object():
    scene = pack(frame(stage.blob(GLOW)))
    hits = 0
    for ray in rays(4000, 2):
        ray[:3] = 2.0 * ray[:3] / np.linalg.norm(ray[:3])
        ray[3:] = -ray[:3] / 2.0 + 0.3 * ray[3:]
        t, _, _ = met(scene, ray)
        assert (met(scene, ray, anywhere=True)[2] == 0.0) == (t < math.inf)
        hits += t < math.inf
    assert 1000 < hits < 3900


def test_an_implicit_object_is_cut_and_capped_at_its_box():
    whole = stage.implicit_sphere(GLOW, 1.0)
    cut = replace(whole, high=(1.2, 1.2, 0.5))
    t, _, _ = met(cut, (0.1, 0.2, 5.0, 0.0, 0.0, -1.0))
    assert t == pytest.approx(4.5, rel=1e-12)
    normal = Normals().draw(frame(cut)).linear[48, 48]
    assert normal == pytest.approx((0.5, 0.5, 1.0), abs=1e-6)


def test_rays_find_the_way_out_of_solids():
    for shape in (stage.sphere(), stage.implicit_sphere(GLOW), stage.points(GLOW, [(0, 0, 0)], [1.0])):
        t, _, _ = met(shape, (0.2, 0.0, 0.0, 1.0, 0.0, 0.0))
        assert t == pytest.approx(0.8, rel=1e-9)
    inside = view((0.2, 0.1, 0.0), (0, 0, -1), (32, 32), 0.5, orthographic=False)
    for shape in (stage.sphere(WHITE), stage.implicit_sphere(WHITE), stage.round_mesh(WHITE)):
        assert np.isfinite(draw(shape, lights=[UNIFORM], seen=inside)).all()


def test_an_empty_scene_is_all_sky_or_the_backdrop():
    assert draw().max() == 0.0
    assert draw(lights=[replace(UNIFORM, visible=(0.1, 0.2, 0.3))]) == pytest.approx(
        np.broadcast_to((0.1, 0.2, 0.3), (96, 96, 3)), rel=1e-6
    )


def test_normals_are_those_of_the_sphere():
    seen = view(size=(64, 64))
    place = (np.arange(64) + 0.5) * 3 / 64 - 1.5
    x, y = np.meshgrid(place, -place)
    for shape in (stage.sphere(), stage.implicit_sphere(GLOW), stage.points(GLOW, [(0, 0, 0)], [1.0])):
        picture = Normals().draw(frame(shape, seen=seen)).linear
        inside = x**2 + y**2 < 0.98
        n = 2 * picture[inside].astype(float) - 1
        exact = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)[inside]
        assert np.abs(n - exact).max() < 1e-5
        assert (picture[x**2 + y**2 > 1.02] == 0).all()


def small_scene():
    clay = Surface(color=(0.7, 0.5, 0.3), roughness=0.2)
    glass = Surface(color=(1, 1, 1), roughness=0.0, transmission=1.0)
    return frame(
        stage.floor(replace(WHITE, checker_size=0.3), -1.0),
        stage.implicit_sphere(clay, 0.5, 0.6),
        stage.sphere(glass, (-1.0, -0.5, 0.5), 0.4),
        stage.segment(MIRROR, (0.8, -0.5, 0), (0.9, 0.5, 0.2), 0.3),
        stage.round_mesh(clay, 0.7, 3),
        lights=[sun((-0.5, 0.9, 0.6), (2.0,) * 3, 0.1), PointLight((1, 2, 1), (1,) * 3), UNIFORM],
        seen=view((1, 1, 5), (0, -0.1, 0), (6, 4), 0.3, orthographic=False),
    )


def test_compiled_or_not_the_picture_is_the_same():
    """In plain Python an index out of bounds is an error; compiled it would go unseen."""
    code = (
        "import sys, test_trace as t; "
        "sys.stdout.buffer.write(t.Trace(samples=2).draw(t.small_scene()).linear.tobytes())"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join([*sys.path])}
    plain = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, env=environment).stdout
    compiled = Trace(samples=2).draw(small_scene()).linear
    assert np.frombuffer(plain, dtype=np.float32) == pytest.approx(compiled.ravel(), abs=1e-5)


@pytest.mark.parametrize("away", [3.0, 1e3, 1e5])
def test_no_ray_slips_through_a_mesh_where_triangles_have_a_common_edge(away):
    """A flat sheet, whose diagonals the pixels of a camera before it hit exactly, had specks of what is behind it."""
    random = np.random.default_rng(5)
    side = np.linspace(-1, 1, 12)
    x, y = (one.ravel() for one in np.meshgrid(side, side))
    points = np.stack([x, y, 0.2 * np.sin(3 * x) * np.cos(2 * y)], axis=1)
    first = (np.arange(11)[:, None] * 12 + np.arange(11)).ravel()
    triangles = np.concatenate([first[:, None] + (0, 1, 13), first[:, None] + (0, 13, 12)]).astype(np.int32)
    inner = first.reshape(11, 11)[1:, 1:].ravel()
    ends = np.concatenate([inner[:, None] + other for other in ((0, 13), (0, 1), (0, 12))])
    sheet = pack(frame(Mesh("sheet", WHITE, points, triangles)))
    for a, b in points[np.tile(ends, (3, 1))]:
        origin = away * np.append(random.uniform(-0.5, 0.5, 2), 1.0)
        towards = a + random.uniform(0.0, 1.0) * (b - a) - origin
        t, _, _ = met(sheet, [*origin, *towards / np.linalg.norm(towards)])
        assert t < math.inf
