"""The command ``mesh``: files of triangles, and messages about what has none."""

import pytest

from sceneql import pipeline
from sceneql.failure import RunFailure, Unsuitable
from sceneql.report.mesh import mesh

SCENE = """
sceneql: 1
clock: {end: 1 s}
objects:
  pair:
    group:
      position: [0 m, 2 m, time*(1 m/s)]
      children:
        ring: {torus: {radius: 1 m, tube: 0.4 m}}
  floor: plane
"""


@pytest.fixture
def graph(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return pipeline.load(path, pruned=False)


@pytest.mark.parametrize("sharp", [False, True])
@pytest.mark.parametrize("extension", ["ply", "stl", "obj", "glb"])
def test_an_object_of_a_scene_becomes_a_file_of_triangles(graph, tmp_path, extension, sharp):
    import trimesh

    path = tmp_path / f"ring.{extension}"
    account = mesh(graph, "ring", path, cell=0.06, time=0.5, sharp=sharp)
    assert [file.name for file in tmp_path.iterdir() if file.suffix != ".yaml"] == [path.name]
    read = trimesh.load(path, force="mesh")
    assert read.is_watertight
    assert read.euler_number == account.euler == 0
    assert read.volume == pytest.approx(account.volume, rel=1e-4)
    assert account.volume == pytest.approx(3.1582734083, rel=0.01)
    assert read.bounds.mean(axis=0) == pytest.approx([0.0, 2.0, 0.5], abs=1e-3)
    assert str(path) in account.text()


def test_what_cannot_be_polygonised_is_told(graph, tmp_path):
    with pytest.raises(Unsuitable, match="did you mean 'ring'"):
        mesh(graph, "rign", tmp_path / "a.ply")
    with pytest.raises(Unsuitable, match=r"\.glb"):
        mesh(graph, "ring", tmp_path / "a.xyz")
    with pytest.raises(RunFailure, match="unbounded"):
        mesh(graph, "floor", tmp_path / "a.ply")
    with pytest.raises(Unsuitable, match="ends at 1 s"):
        mesh(graph, "ring", tmp_path / "a.ply", time=2.0)
    with pytest.raises(RunFailure, match="above 0"):
        mesh(graph, "ring", tmp_path / "a.ply", cell=-1.0)
    with pytest.raises(RunFailure, match="too many"):
        mesh(graph, "ring", tmp_path / "a.ply", cell=1e-9)
    assert not list(tmp_path.glob("a.*"))


EMPTY = """
sceneql: 1
objects:
  never: {implicit: {field: x^2 + y^2 + z^2 + 1, bounds: {ball: 1}}}
  undefined: {implicit: {field: sqrt(-1 - x^2), bounds: {ball: 1}}}
  speck: {implicit: {field: (x - 0.31)^2 + y^2 + z^2 - 1e-6, bounds: {ball: 1}}}
  pointer: {arrow: {vector: 0 1 0 m}}
  endless: {sphere: {radius: 1e90 m}}
  vast: {implicit: {field: "exp(exp(10 + x^2)) - exp(exp(9 + x^2))"}}
"""


@pytest.mark.parametrize(
    ("name", "line", "message"),
    [
        ("never", 4, "its field is nowhere negative in its bounds, so it has no surface that cells could meet"),
        ("undefined", 5, "its field is nowhere defined in its bounds"),
        ("speck", 6, "no surface was met by cells of 1 m; a smaller --cell finds smaller things"),
        ("pointer", 7, "`arrow` has no inside"),
        ("endless", 8, "cells of 1 m are too many for a box of 2e+90 m"),
        ("vast", 9, "its field is nowhere finite in its bounds"),
    ],
)
def test_what_has_no_mesh_is_told_with_its_place(tmp_path, name, line, message):
    path = tmp_path / "empty.yaml"
    path.write_text(EMPTY, encoding="utf-8")
    with pytest.raises(RunFailure) as failed:
        mesh(pipeline.load(path, pruned=False), name, tmp_path / "a.ply", cell=1.0)
    assert failed.value.message == message
    assert failed.value.span.line == line
    assert not list(tmp_path.glob("a.*"))
