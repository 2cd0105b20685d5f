"""Pictures by OpenGL, where there is one that draws without a screen."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stage
from renderers.rastering.draw import draw
from renderers.rastering.offscreen import canvas
from renderers.tracing.draw import draw as traced
from renderers.tracing.normals import draw_normals
from sceneql import pipeline
from sceneql.failure import RunFailure
from sceneql.frame import Mist, Points, SeenFrame, Sky, Sun, Surface, View
from stage import GLOW, WHITE


def opengl() -> str | None:
    """Why there are no pictures by OpenGL here; None where there are."""
    try:
        canvas(16, 16)
    except ValueError as error:
        return str(error)
    return None


@pytest.fixture(autouse=True)
def _opengl():
    if (why := opengl()) is not None:
        pytest.skip(f"this machine has no OpenGL that draws off-screen: {why}")


def framed(*shapes, lights=(), seen=None):
    return SeenFrame(0, 0.0, shapes, tuple(lights), seen or window())


def window(origin=(0.0, 0.0, 3.0), half=1.5, size=(120, 120), toward=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), flat=True):
    back = np.subtract(origin, toward)
    back = back / np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return View(tuple(origin), np.array([right, np.cross(back, right), back]), size, half, orthographic=flat)


def linear(*shapes, sharp=False, samples=4, shadows=True, **options):
    return draw(framed(*shapes, **options), 64, sharp, samples, shadows, 2.0).linear


@pytest.mark.parametrize(
    ("shape", "exact"),
    [
        (stage.sphere(), math.pi),
        (stage.sphere(GLOW, (0.3, -0.2, 0.1), 0.8), math.pi * 0.64),
        (stage.points(GLOW, [(0, 0, 0)], [1.0]), math.pi),
        (stage.implicit_sphere(GLOW), math.pi),
        (stage.round_mesh(GLOW), math.pi),
        (stage.torus(GLOW, 1.0, 0.4), 5.0265482457),
        (stage.cylinder(GLOW, 0.5, 2.0), 2.0),
        (stage.box(GLOW, (0.1, 0, 0), (1.3, 0.7, 1)), 0.91),
        (stage.segment(GLOW, (-0.5, 0, 0), (0.5, 0, 0), 0.4), 0.8 + math.pi * 0.16),
    ],
    ids=["quadric", "aside", "point", "implicit", "mesh", "torus", "cylinder", "box", "capsule"],
)
def test_silhouettes_have_their_exact_area(shape, exact):
    picture = linear(shape, samples=16)
    # Its triangles are inscribed, and 8 bits tell light within 0.3 %.
    assert picture[..., 0].sum(dtype=float) * (3.0 / 120) ** 2 == pytest.approx(exact, rel=1e-2)


def test_what_is_thinner_than_a_cell_is_there():
    picture = linear(stage.torus(GLOW, 1.0, 0.012), samples=16)
    exact = math.pi * (1.012**2 - 0.988**2)
    assert picture[..., 0].sum(dtype=float) * (3.0 / 120) ** 2 == pytest.approx(
        exact, rel=0.15
    )  # of a polygon with few sides


def test_edges_are_kept_where_that_is_asked_for():
    # A block that is the greatest of three slabs, seen from aside: two of its faces meet at an edge upright.
    b = stage.TapeBuilder()
    slabs = [b.op("sub", b.op("abs", axis), b.constant(0.52)) for axis in (b.x, b.y, b.z)]
    tape = b.finish(b.op("max", b.op("max", *slabs[:2]), slabs[2]))
    block = stage.Implicit("block", WHITE, tape, (-0.7,) * 3, (0.7,) * 3)
    seen = window((2.0, 0.0, 3.0), 0.9)
    lights = [Sun((1.0, 0.0, 0.0), (math.pi,) * 3)]
    exact = linear(stage.box(WHITE, (0, 0, 0), (1.04,) * 3), lights=lights, seen=seen, shadows=False)
    picture = linear(block, sharp=True, lights=lights, seen=seen, shadows=False)
    assert exact.mean() > 0.1
    assert np.abs(picture - exact).mean() < 0.01 * exact.mean()


@pytest.mark.parametrize("flat", [True, False])
def test_it_sees_what_the_ray_tracer_sees(flat):
    shapes = (
        stage.sphere(GLOW, (-0.8, 0.4, 0.2), 0.5),
        stage.box(GLOW, (0.7, 0.2, -0.5), (0.6, 1.0, 0.4)),
        stage.implicit_sphere(GLOW, 0.4),
        stage.segment(GLOW, (-1.0, -0.6, 0.3), (0.9, -0.8, -0.9), 0.1),
    )
    seen = window((1.5, 2.0, 4.0), 1.5 if flat else 0.4, (160, 100), flat=flat)
    ours = linear(*shapes, seen=seen, samples=1)[..., 0] > 0.5
    theirs = draw_normals(framed(*shapes, seen=seen)).linear.any(axis=-1)
    assert 0.05 < theirs.mean() < 0.6
    assert (ours != theirs).mean() < 6e-3


def test_light_on_a_matte_ball_is_that_of_the_ray_tracer():
    lights = (Sun((0.48, 0.64, 0.6), (2.0, 1.6, 1.0)),)
    clay = Surface(color=(0.7, 0.5, 0.3), roughness=1.0, specular=0.04)
    ours, theirs = linear(stage.sphere(clay), lights=lights), traced(framed(stage.sphere(clay), lights=lights)).linear
    assert theirs.mean() > 0.03
    assert np.abs(ours - theirs).mean() < 0.1 * theirs.mean()


def test_a_ball_throws_a_shadow_of_the_right_size_to_the_right_place():
    # From above; the sun stands 45 degrees high, so the shadow lies 3 m off and is an ellipse of area pi r^2 sqrt(2).
    seen = window((3, 9, 0), 1.5, (96, 96), (3, 0, 0), (0, 0, -1))
    light = Sun((-math.sqrt(0.5), math.sqrt(0.5), 0), (math.pi,) * 3, 0.0)
    shapes = (stage.floor(), stage.sphere(WHITE, (0, 3, 0), 0.5))
    lit, picture = (linear(*shapes, lights=[light], seen=seen, shadows=on)[..., 0] for on in (False, True))
    dark = (1 - picture / lit)[..., None]
    assert lit.min() > 0.5
    assert dark.sum() * (3.0 / 96) ** 2 == pytest.approx(math.pi * 0.25 * math.sqrt(2), rel=0.05)
    places = np.stack(np.meshgrid(np.arange(96), np.arange(96)), axis=-1)
    assert (dark * places).sum(axis=(0, 1)) / dark.sum() == pytest.approx([47.5, 47.5], abs=1.0)


def test_shadows_end_where_their_map_does():
    light = Sun((-math.sqrt(0.5), math.sqrt(0.5), 0), (math.pi,) * 3, 0.0)
    seen = window((0, 1.5, 8), 0.5, (120, 80), flat=False)
    shapes = (stage.floor(), stage.sphere(WHITE, (0, 0.5, 0), 0.5))
    lit, picture = (linear(*shapes, lights=[light], seen=seen, shadows=on)[..., 0] for on in (False, True))
    assert (picture[:30] == lit[:30]).all()
    assert (picture < 0.5 * lit).any()


def test_squares_of_a_checker_are_where_the_ray_tracer_has_them():
    board = Surface((0.8, 0.8, 0.8), 1.0, checker_size=0.4, checker_color=(0.1, 0.1, 0.1))
    sky = Sky((1, 1, 1), (1, 1, 1), (1, 1, 1))
    shapes = (stage.floor(board), stage.box(board, (0.3, 0.61, -0.2), (0.9, 1.1, 0.7)))
    seen = window((2.0, 3.0, 4.0), 1.5)
    ours, theirs = linear(*shapes, lights=[sky], seen=seen), traced(framed(*shapes, lights=[sky], seen=seen)).linear
    assert ((ours > 0.35) != (theirs / theirs.max() > 0.35)).mean() < 0.05


def test_what_nothing_covers_shows_the_sky():
    sky = Sky((0.1, 0.3, 0.9), (0.8, 0.8, 0.8), (0.2, 0.1, 0.0))
    seen = window((0, 0, 4), 0.6, (60, 40), flat=False)
    assert np.allclose(linear(lights=[sky], seen=seen), traced(framed(lights=[sky], seen=seen)).linear, atol=2e-3)


def test_what_it_cannot_draw_is_told():
    discs = Points("spray", GLOW, np.zeros((1, 3)), np.ones(1), soft="adds")
    mist = Mist("fog", GLOW, np.eye(3, 4), np.ones((2, 2, 2)), (0, 0, 0), (1, 1, 1))
    many = stage.points(GLOW, np.zeros((500_001, 3)), np.ones(500_001))
    for shape, message in ((discs, "'spray' .soft discs"), (mist, "'fog' .mist"), (many, "at most 500,000 balls")):
        with pytest.raises(ValueError, match=message):
            linear(shape)


def test_a_run_that_it_refuses_names_its_line(tmp_path):
    script = tmp_path / "s.yaml"
    script.write_text(
        "models: {dust: {particles: {list: {a: {position: 0 0 0 m}}}}}\n"
        "objects: {spray: {sprites: {at: dust.positions}}}\n"
        "outputs: {p: {image: {size: 32 32, renderer: quick}}}\n"
        "renderers: {quick: {raster: {samples: 1}}}\n"
    )
    with pytest.raises(RunFailure, match="soft discs") as caught:
        pipeline.render(pipeline.load(script), folder=tmp_path)
    assert "s.yaml:" in str(caught.value)
