"""Mist: what a volume absorbs on the way to the camera, by the law of Beer and Lambert."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from renderers.tracing import layout
from renderers.tracing.draw import draw
from renderers.tracing.mist_kernels import mists_along
from renderers.tracing.pack import pack
from runs import complaint
from sceneql.frame import Mist, Points, Quadric, SeenFrame, Sky, Surface, View
from sceneql.pipeline import frame_of, load
from sceneql.run.run import Run
from sceneql.shapes.world_boxes import box_of

SIDE = 24
WHITE = Sky(zenith=(1, 1, 1), horizon=(1, 1, 1), ground=(1, 1, 1))


VIEW = View((0.0, 0.0, 6.0), np.eye(3), (SIDE, SIDE), 0.9, True)


def depth(field, start, way, end=np.inf):
    """What lies on one ray through a field (nz, ny, nx) of unit cells."""
    mist = Mist("m", Surface(), np.eye(3, 4), field, (0.0, 0.0, 0.0), tuple(np.array(field.shape[::-1]) - 1.0), False)
    scene, _ = pack(SeenFrame(0, 0.0, (mist,), (WHITE,), VIEW))
    kept = mists_along(scene, *map(float, start), *map(float, way), 0.0, float(end), layout.SEEN)[0]
    return -np.log(kept)


def chord(start, way, low, high):
    """Where a ray enters and leaves a box, from 0 on."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (np.array(low) - start) / way, (np.array(high) - start) / way
    return max(0.0, np.nanmax(np.minimum(a, b))), np.nanmin(np.maximum(a, b))


def ray(rng):
    start, aim = 12.0 * rng.standard_normal(3), rng.random(3) * [5.0, 4.0, 3.0]
    return start, (aim - start) / np.linalg.norm(aim - start)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=100)
def test_an_even_field_absorbs_by_the_length_of_the_way(seed):
    start, way = ray(np.random.default_rng(seed))
    first, last = chord(start, way, np.zeros(3), [5.0, 4.0, 3.0])
    assert depth(np.full((4, 5, 6), 0.7), start, way) == pytest.approx(0.7 * max(last - first, 0.0), abs=1e-12)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=100)
def test_the_integral_of_a_product_of_places_is_exact(seed):
    k, j, i = np.meshgrid(np.arange(4.0), np.arange(5.0), np.arange(6.0), indexing="ij")
    start, way = ray(np.random.default_rng(seed))
    first, last = chord(start, way, np.zeros(3), [5.0, 4.0, 3.0])
    cubic = np.polynomial.Polynomial([1.0])
    for axis in range(3):
        cubic *= np.polynomial.Polynomial([start[axis], way[axis]])
    whole = cubic.integ()
    assert depth(0.01 * i * j * k, start, way) == pytest.approx(0.01 * (whole(last) - whole(first)), rel=1e-9, abs=1e-9)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0))
@settings(max_examples=60)
def test_parts_of_a_way_add_up_and_the_way_back_is_as_deep(seed, share):
    rng = np.random.default_rng(seed)
    field = rng.random((4, 5, 6))
    start, way = ray(rng)
    far = 40.0
    middle = share * far
    first, second = depth(field, start, way, middle), depth(field, start + middle * way, way, far - middle)
    assert first + second == pytest.approx(depth(field, start, way, far), abs=1e-11)
    assert depth(field, start + far * way, -way, far) == pytest.approx(depth(field, start, way, far), abs=1e-11)


@pytest.mark.parametrize("way", np.concatenate([np.eye(3), -np.eye(3)]))
def test_rays_along_axes_and_through_nodes_are_as_deep_as_they_should_be(way):
    field = np.random.default_rng(3).random((4, 5, 6))
    middle = np.array([2.0, 2.0, 1.0])
    axis = int(np.argmax(np.abs(way)))
    line = field[tuple(slice(None) if 2 - axis == k else int(middle[2 - k]) for k in range(3))]
    assert depth(field, middle - 9.0 * way, way) == pytest.approx(np.trapezoid(line), abs=1e-12)
    assert depth(field, middle + 9.0 * way, way) == 0.0


# --- pictures ---


def block(strength, color=(0.0, 0.0, 0.0), lit=False):
    """A mist of 2 m x 2 m x 2 m around the origin."""
    to_cells = np.column_stack([np.eye(3) * 4.0, np.full(3, 4.0)])
    field = np.full((9, 9, 9), strength)
    return Mist("m", Surface(color=color), to_cells, field, (0.0, 0.0, 0.0), (8.0, 8.0, 8.0), lit)


def seen(*shapes, orthographic=True):
    view = View((0.0, 0.0, 6.0), np.eye(3), (SIDE, SIDE), 0.9 if orthographic else 0.3, orthographic)
    return draw(SeenFrame(0, 0.0, tuple(shapes), (WHITE,), view), samples=1).linear


def test_what_is_left_of_the_light_is_an_exponential_of_the_depth():
    kept = np.exp(-0.35 * 2.0)
    np.testing.assert_allclose(seen(block(0.35)), kept, rtol=1e-6)
    color = np.array([0.2, 0.5, 0.9])
    np.testing.assert_allclose(seen(block(0.35, tuple(color)))[5, 7], kept + (1 - kept) * color, rtol=1e-6)


def test_rays_that_spread_have_longer_ways():
    picture = seen(block(0.35), orthographic=False)
    place = (2 * (np.arange(SIDE) + 0.5) / SIDE - 1) * 0.3
    x, y = np.meshgrid(place, -place)
    reach = np.maximum(np.abs(x), np.abs(y))
    first, last = 5.0, np.minimum(7.0, 1.0 / np.maximum(reach, 1e-9))
    length = np.maximum(last - first, 0.0) * np.sqrt(1 + x * x + y * y)
    np.testing.assert_allclose(picture[..., 0], np.exp(-0.35 * length), rtol=1e-5)


def test_mist_covers_what_stands_in_it_as_far_as_it_stands():
    wall = Quadric("w", Surface(color=(0, 0, 0), specular=0.0, emission=(0.8, 0.8, 0.8)), np.eye(3, 4),
                   (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0, (-9.0, -9.0, -9.0), (9.0, 9.0, 9.0))  # fmt: skip
    np.testing.assert_allclose(seen(wall, block(0.35)), 0.8 * np.exp(-0.35), rtol=1e-5)


def test_edges_in_mist_are_as_smooth_as_without():
    """A slanted edge of a white thing in black mist: what a pixel has is the same share of both as without mist."""
    shape = {"squares": (0.0, 0.0, 0.0), "linear": (0.0, 0.0, 1.0), "constant": 0.0}
    turn = np.array([[np.cos(0.3), np.sin(0.3), 0, 0.031], [-np.sin(0.3), np.cos(0.3), 0, 0], [0, 0, 1, 0]])
    thing = Quadric("w", Surface(color=(0, 0, 0), specular=0.0, emission=(0.2, 0.2, 0.2)), turn,
                    low=(-3.0, -3.0, -3.0), high=(0.0, 3.0, 3.0), **shape)  # fmt: skip
    view = View((0.0, 0.0, 6.0), np.eye(3), (SIDE, SIDE), 0.9, True)
    scenes = (thing,), (thing, block(1.0)), (thing, block(0.4), block(0.6))
    plain, dimmed, twice = (draw(SeenFrame(0, 0.0, one, (WHITE,), view), samples=64).linear[..., 0] for one in scenes)
    share = (plain - 0.2) / 0.8  # of the sky behind
    edge = (share > 0.02) & (share < 0.98)
    assert edge.sum() > 15
    wanted = share * np.exp(-2.0) + (1 - share) * 0.2 * np.exp(-1.0)
    np.testing.assert_allclose(dimmed, wanted, atol=1e-5)
    np.testing.assert_allclose(twice, wanted, atol=1e-5)


def test_mists_that_only_absorb_take_turns_in_any_order():
    np.testing.assert_allclose(seen(block(0.2), block(0.5)), seen(block(0.7)), rtol=1e-6)


def test_a_mist_has_its_box_and_hides_no_disc():
    low, high = box_of(block(1.0))
    np.testing.assert_allclose([low, high], [[-1, -1, -1], [1, 1, 1]], atol=1e-12)
    black = Surface(color=(0, 0, 0), emission=(5.0, 5.0, 5.0))
    disc = Points("d", black, np.zeros((1, 3)), np.full(1, 0.3), soft="adds")
    assert seen(block(0.35), disc).max() > 2.0


SCENE = """
clock: {{end: 1 s, fps: 1}}
models:
  room: {{diffusion: {{size: 2 2 1 m, corner: -1 -1 -0.5 m, cell: 0.25 m, coefficient: "0.001", initial: "{initial}"}}}}
objects:
  fog: {{mist: {{of: room.concentration, absorption: 0.3 {unit}, color: black}}}}
solvers: {{main: {{ftcs: {{step: 0.5 s}}}}}}
lights: {{even: {{sky: {{color: white}}}}}}
cameras: {{front: {{orthographic: {{height: 1.8 m, look_at: 0 0 0 m}}}}}}
outputs: {{film: {{image: {{size: 24 24}}}}}}
"""


def test_a_field_as_mist_absorbs_by_its_values_between_the_walls(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.format(initial="2 + x + z", unit="m^2/kg"), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.0])
    picture = draw(frame_of(graph, "film", (24, 24), moment, 0), samples=1).linear
    x = 0.9 * (2 * (np.arange(24) + 0.5) / 24 - 1)
    np.testing.assert_allclose(picture[11, :, 1], np.exp(-0.3 * (2 + x)), rtol=1e-5)


def test_an_absorption_of_something_else_is_refused(tmp_path):
    told = complaint(tmp_path, SCENE.format(initial="1", unit="kg"))
    assert "absorption is told for a meter of a unit of the field" in told
