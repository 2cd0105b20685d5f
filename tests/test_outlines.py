"""Outlines: the hull of a few points holds a shape, and little more; the default camera fills the picture by them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sceneql.frame import Points, Quadric, Surface
from sceneql.pipeline import Report, Tools, load, simulate
from sceneql.report.mesh import mesh
from sceneql.shapes.outlines import COUNT, DIRECTIONS, outermost, outline
from sceneql.words.cameras.auto import ACROSS, NEARLY, THREE_QUARTER

SHAPES = {
    "sphere: {radius: 0.5 m, position: 1 2 0 m}": 0.5,
    "box: {size: 1 0.5 2 m, rotation: {about: x, angle: 30 deg}}": 1.0,
    "cylinder: {radius: 0.2 m, height: 2 m, rotation: {about: x, angle: 50 deg}}": 1.0,
    "tube: {through: [0 0 0 m, 0 2 0 m], radius: 10 cm}": 1.0,
    "torus: {radius: 0.6 m, tube: 0.2 m, rotation: {about: z, angle: 40 deg}}": 0.8,
    "implicit: {field: x^2 + 2*y^2 + 3*z^2 - 0.3, bounds: {box: [-3 -3 -3, 3 3 3]}}": 0.55,
    "blobby: {skeleton: [{point: 0 0 0 m, radius: 0.5 m}, {point: 0.7 0.2 0 m, radius: 0.4 m}]}": 0.9,
}
"""Objects and about how large each is [m]."""


@pytest.mark.parametrize(("thing", "size"), SHAPES.items())
def test_the_hull_of_an_outline_holds_its_shape_and_little_more(tmp_path, thing, size):
    (tmp_path / "scene.yaml").write_text(f"objects: {{a: {{{thing}}}}}\noutputs: {{s: {{image: {{size: 64 36}}}}}}\n")
    graph = load(tmp_path / "scene.yaml")
    (moment,) = simulate(graph, [0.0])
    shapes = [one for one in Tools(graph, "s", Report(), tmp_path / "s").frame(moment).shapes if one.name == "a"]
    points = np.concatenate([outline(shape) for shape in shapes])
    assert len(points) <= COUNT * len(shapes)
    mesh(graph, "a", tmp_path / "a.ply", cell=0.04)
    surface = np.asarray(trimesh.load(tmp_path / "a.ply", process=False).vertices)
    directions = np.random.default_rng(1).standard_normal((500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    beyond = (points @ directions.T).max(axis=0) - (surface @ directions.T).max(axis=0)
    assert beyond.min() > -0.03 * size
    assert beyond.max() < 0.25 * size


def test_an_ellipsoid_is_reached_in_each_direction_looked_at():
    half = np.array([3.0, 1.0, 0.2])
    to_local = np.eye(3, 4) / half[:, None]
    stretched = Quadric("a", Surface(), to_local, (1, 1, 1), (0, 0, 0), -1, (-np.inf,) * 3, (np.inf,) * 3)
    squares = tuple(half**-2.0)
    by_squares = Quadric("b", Surface(), np.eye(3, 4), squares, (0, 0, 0), -1, (-np.inf,) * 3, (np.inf,) * 3)
    reach = (outline(by_squares) @ DIRECTIONS.T).max(axis=0)
    assert reach == pytest.approx(np.linalg.norm(DIRECTIONS * half, axis=1), rel=1e-9)
    assert (outline(stretched) @ DIRECTIONS.T).max(axis=0) == pytest.approx(reach, rel=1e-9)


def test_the_outermost_of_many_points_are_few_and_lose_little():
    points = np.random.default_rng(2).standard_normal((5000, 3))
    few = outermost(points)
    assert len(few) <= COUNT
    directions = np.random.default_rng(3).standard_normal((200, 3))
    whole, left = (points @ directions.T).max(axis=0), (few @ directions.T).max(axis=0)
    assert (left > 0.85 * whole).all()
    assert (outermost(few[:5]) == few[:5]).all()


def test_of_very_many_points_the_farthest_is_among_the_outermost():
    points = np.random.default_rng(4).standard_normal((120_001, 3))
    points[60_001] = [0.0, 100.0, 0.0]
    assert outermost(points)[:, 1].max() == 100.0


def test_a_few_strays_of_a_cloud_are_not_what_it_is_seen_by():
    centers = np.random.default_rng(5).uniform(-1, 1, (1000, 3))
    cloud = Points("stars", Surface(), centers, np.full(1000, 0.01))
    strayed = centers.copy()
    strayed[:5] *= 100
    found = outline(Points("stars", Surface(), strayed, np.full(1000, 0.01)))
    assert np.abs(found).max() < 1.02
    assert np.abs(found).max() > 0.95 * np.abs(outline(cloud)).max()
    assert np.abs(outline(Points("few", Surface(), strayed[:100], np.full(100, 0.01)))).max() > 20


FLAT = {"x": "0.02 2 2 m", "y": "2 0.02 2 m", "z": "2 2 0.02 m"}


@pytest.mark.parametrize(("axis", "size"), FLAT.items())
def test_what_is_flat_is_seen_along_its_normal(tmp_path, axis, size):
    view = default_view(tmp_path, f"box: {{size: {size}}}")
    normal = np.eye(3)["xyz".index(axis)]
    assert view.axes[2] @ normal > 0.98


@pytest.mark.parametrize(
    ("size", "back"),
    [
        ("5 0.5 0.5 m", ACROSS[0]),
        ("0.5 0.5 5 m", ACROSS[2]),
        ("1 5 1 m", THREE_QUARTER),
        ("2 2 2 m", THREE_QUARTER),
        ("5 1 1 m", THREE_QUARTER),
    ],
)
def test_what_is_long_and_lies_is_seen_across(tmp_path, size, back):
    seen = default_view(tmp_path, f"box: {{size: {size}}}").axes[2]
    assert seen == pytest.approx(np.array(back) / np.linalg.norm(back), abs=0.01)


@pytest.mark.parametrize(
    ("size", "axis"),
    [
        ("6 4 0.01 m", 2),
        ("0.01 4 6 m", 0),
        ("6 0.01 6 m", None),
        ("2 1 0.01 m", None),
        ("6 4 0.01 m, position: 3 0 4 m", None),
    ],
)
def test_a_map_beside_a_thick_tower_is_seen_nearly_along_its_normal(tmp_path, size, axis):
    """Not what lies flat, as a floor, not a small plate, and not what stands before all else, as a wall."""
    tower = "box: {size: 3 7 3 m, position: 6 3 0 m}}, b: {box: {size: " + size + "}"
    seen = default_view(tmp_path, tower).axes[2]
    towards = THREE_QUARTER if axis is None else NEARLY[axis]
    assert seen == pytest.approx(np.array(towards) / np.linalg.norm(towards), abs=0.01)


@pytest.mark.parametrize("thing", ["sphere: {}", "box: {size: 1 2 1 m}", "sphere: {radius: 20 m, position: 0 9 0 m}"])
def test_a_single_thing_fills_nearly_four_fifths_of_the_height(tmp_path, thing):
    view = default_view(tmp_path, thing)
    points = edge_points(thing, tmp_path)
    seen = (points - np.array(view.origin)) @ view.axes.T
    heights = seen[:, 1] / -seen[:, 2] / view.half_height  # from -1 to 1
    assert 0.75 < (heights.max() - heights.min()) / 2 < 0.8


def default_view(folder, thing):
    (folder / "scene.yaml").write_text(
        f"objects: {{a: {{{thing}}}, floor: none}}\noutputs: {{s: {{image: {{size: 640 360}}}}}}\n"
    )
    graph = load(folder / "scene.yaml")
    (moment,) = simulate(graph, [0.0])
    return graph.tasks["camera"].kind.view((640, 360), moment)


def edge_points(thing, folder):
    graph = load(folder / "scene.yaml")
    mesh(graph, "a", folder / "a.ply", cell=None)
    return np.asarray(trimesh.load(folder / "a.ply", process=False).vertices)
