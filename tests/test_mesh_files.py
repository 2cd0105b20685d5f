"""The command ``mesh``: lengths as scripts write them, cells as coarse as a tolerance lets them be, colors in files."""

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner

from meshes import tape_of
from sceneql import pipeline
from sceneql.cli import cli
from sceneql.field.tape.tape_solid import paint_values
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.cubes.tolerance import distance
from sceneql.mesh.polygons import Polygons
from sceneql.report.mesh import mesh

SCENE = """
objects:
  ball: {sphere: {radius: 1 m}}
  drop: {blobby: {skeleton: [{point: 0 0 0 m, radius: 0.5 m, color: red}, {point: 0.4 0 0 m, radius: 0.5 m}],
    color: "#808080"}}
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text(SCENE)
    return path


@pytest.mark.parametrize("option", ["--cell", "--tolerance"])
def test_lengths_are_read_as_in_scripts(scene, option):
    made = []
    for text in ("50mm", "0.05", "1/20 m", "5 cm"):
        target = scene.with_suffix(".ply")
        result = CliRunner().invoke(cli, ["mesh", str(scene), "--object", "ball", "-o", str(target), option, text])
        assert result.exit_code == 0, result.output
        made.append(target.read_bytes())
    assert len(set(made)) == 1


@pytest.mark.parametrize("text", ["abc", "1 s", "0", "-1mm", "1/0", "1 2 3 m", "inf", "1e400"])
def test_what_is_no_length_is_refused(scene, text):
    target = scene.with_suffix(".ply")
    result = CliRunner().invoke(cli, ["mesh", str(scene), "--object", "ball", "-o", str(target), "--cell", text])
    assert result.exit_code == 2
    assert "is no length above 0" in result.output
    assert not target.exists()


def test_a_larger_tolerance_takes_fewer_triangles_and_keeps_it(scene):
    graph, counts = pipeline.load(scene, pruned=False), []
    for tolerance in (1e-2, 1e-3, 1e-4):
        counts.append(mesh(graph, "ball", scene.with_suffix(".ply"), tolerance=tolerance).triangles)
        found = trimesh.load(scene.with_suffix(".ply"))
        shares = np.random.default_rng(1).dirichlet(np.ones(3), 20)
        places = np.einsum("ki,tij->tkj", shares, found.triangles)
        assert np.abs(np.linalg.norm(places, axis=-1) - 1.0).max() <= tolerance
    assert counts[0] * 3 < counts[1]
    assert counts[1] * 3 < counts[2]


def test_a_distance_is_measured_on_edges_too():
    # Of a long triangle on a cylinder the center is nearer to it than the middle of the edge that spans its bend.
    cylinder = tape_of("sqrt(x^2 + y^2) - 1")
    a = 0.3
    corners = np.array([[np.cos(a), np.sin(a), 0.0], [np.cos(a), -np.sin(a), 0.0], [np.cos(a), np.sin(a), 5.0]])
    gap = 1.0 - np.cos(a)
    found = distance(cylinder, Polygons(corners, np.array([[0, 1, 2]], dtype=np.int32), np.zeros((3, 3))))
    assert gap <= found < 1.1 * gap


def test_a_distance_bounds_all_points_of_triangles_on_smooth_surfaces():
    torus = polygonise(tape_of("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16"), (-1.5,) * 3, (1.5,) * 3, 0.05)
    shares = np.random.default_rng(2).dirichlet(np.ones(3), 30)
    x, y, z = np.moveaxis(np.einsum("ki,tij->tkj", shares, torus.vertices[torus.triangles]), -1, 0)
    farthest = np.abs(np.hypot(np.hypot(x, y) - 1.0, z) - 0.4).max()
    found = distance(tape_of("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16"), torus)
    assert farthest <= 1.01 * found
    assert found <= 1.2 * farthest


@pytest.mark.parametrize("extension", ["ply", "obj", "glb"])
def test_colors_that_are_mixed_in_a_field_are_the_vertices(scene, extension):
    graph, target = pipeline.load(scene, pruned=False), scene.with_suffix(f".{extension}")
    mesh(graph, "drop", target, cell=0.05)
    found = trimesh.load(target, force="mesh")
    colors = found.visual.vertex_colors[:, :3].astype(int)
    left, right = colors[found.vertices[:, 0].argmin()], colors[found.vertices[:, 0].argmax()]
    assert left == pytest.approx([255, 0, 0], abs=1)
    gray = 128 if extension != "glb" else round(255 * ((128 / 255 + 0.055) / 1.055) ** 2.4)
    assert right == pytest.approx([gray] * 3, abs=1)


JOINED = """
objects:
  left: {blobby: {skeleton: [{point: -0.5 0 0 m, radius: 0.9 m, color: red}, {point: -0.5 0.4 0 m, radius: 0.5 m,
    color: blue}]}}
  right: {sphere: {radius: 0.5 m, position: 0.4 0 0 m, color: lime}}
  twins: {group: {children: [left, right], position: 0 3 0 m, scale: 2}}
  both: {union: {of: [left, right]}}
  soft: {union: {of: [left, right], blend: 0.08 m}}
  plain: {union: {of: [left, right], color: gray}}
  one: {sphere: {radius: 1 m, color: red}}
  two: {sphere: {radius: 1 m, position: 1 0 0 m, color: red}}
  bare: {sphere: {radius: 1 m}}
  same: {union: {of: [one, two]}}
  pair: {group: {children: [one, two]}}
  inherited: {group: {children: [bare], color: red}}
  alone: {group: {children: [bare]}}
  alike: {union: {of: {a: {sphere: {radius: 1 m}}, b: {box: {size: 1 1 1 m, position: 1 0 0 m}}}}}
"""


def colored(tmp_path, name):
    """(places, colors) of the vertices of an object of JOINED, colors None where its file has none."""
    path = tmp_path / "s.yaml"
    path.write_text(JOINED)
    mesh(pipeline.load(path, pruned=False), name, path.with_suffix(".ply"), cell=0.05)
    found = trimesh.load(path.with_suffix(".ply"), process=False)
    return found.vertices, found.visual.vertex_colors[:, :3].astype(int) if found.visual.kind == "vertex" else None


@pytest.mark.parametrize("name", ["both", "twins"])
def test_what_is_joined_has_the_color_of_the_member_that_is_there(tmp_path, name):
    places, colors = colored(tmp_path, name)
    green = np.linalg.norm((places - (0, 3, 0)) / 2 - (0.4, 0, 0) if name == "twins" else places - (0.4, 0, 0), axis=1)
    assert (colors[np.abs(green - 0.5) < 1e-6] == [0, 255, 0]).all()
    assert (colors[green > 0.501, 1] == 0).all()
    assert (colors[green > 0.501, 0] > 200).any()
    assert (colors[green > 0.501, 2] > 200).any()


def test_colors_run_over_where_a_blend_joins_and_nowhere_else(tmp_path):
    places, colors = colored(tmp_path, "soft")
    x = places[:, 0]
    assert (colors[x > 0.7] == [0, 255, 0]).all()
    assert (colors[x < -0.7, 1] == 0).all()
    mixed = (colors[:, 1] > 60) & (colors[:, 0] > 60)
    assert mixed.any()
    assert np.ptp(x[mixed]) < 0.3


@pytest.mark.parametrize("name", ["same", "pair"])
def test_what_is_joined_of_members_of_one_color_has_it(tmp_path, name):
    assert (colored(tmp_path, name)[1] == [255, 0, 0]).all()


@pytest.mark.parametrize("name", ["plain", "alike", "inherited", "alone"])
def test_what_is_joined_without_colors_of_members_has_no_colors_in_its_file(tmp_path, name):
    assert colored(tmp_path, name)[1] is None


def test_pictures_show_a_union_by_its_members_colors(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text(JOINED)
    graph = pipeline.load(path, pruned=False)
    moment = next(pipeline.simulate(graph, [0.0]))
    shapes = {
        n: next(iter(graph.tasks[n].kind.lower(n, np.eye(3, 4), moment))) for n in ("both", "soft", "same", "plain")
    }
    assert shapes["plain"].paint is None
    assert paint_values(shapes["same"].paint, np.zeros((1, 3))).tolist() == [[1, 0, 0]]
    for name in ("both", "soft"):
        assert paint_values(shapes[name].paint, np.array([[0.9, 0, 0]]))[0] == pytest.approx([0, 1, 0])
        assert paint_values(shapes[name].paint, np.array([[-0.9, -0.3, 0]]))[0] == pytest.approx([1, 0, 0], abs=0.02)


def test_an_object_of_one_color_has_no_colors_in_its_file(scene):
    graph, target = pipeline.load(scene, pruned=False), scene.with_suffix(".ply")
    mesh(graph, "ball", target, cell=0.2)
    assert b"red" not in target.read_bytes()[:400]
