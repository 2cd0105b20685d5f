"""Outputs that get shapes, and the object and the output that ARCHITECTURE.md shows to newcomers (tests/words)."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from sceneql import pipeline
from sceneql.failure import RunFailure, Unsuitable
from sceneql.report.explain import explain
from sceneql.run.run import Run

WORDS = Path(__file__).parent / "words"
COUNT = '''
from typing import ClassVar

from sceneql.kinds import Output


class Count(Output):
    """Asks for shapes without saying so."""

    def times(self, clock):
        return [0.0]

    def open(self, tools):
        self.tools
'''
SCENE = """
clock: {{end: 1 s, fps: 4}}
models:
  swing:
    mass_spring:
      masses: {{wall: {{position: 0 0 0 m, fixed: yes}}, bob: {{position: 1.2 0 0 m, mass: 1 kg}}}}
      springs: [{{between: [wall, bob], rest: 1 m, stiffness: 100 N/m}}]
  idle: {{particles: {{list: {{a: {{mass: 1 kg, position: 0 9 0 m}}}}}}}}
forces: [gravity]
materials: {{gold: metal, red: {{matte: {{color: red}}}}}}
objects:
  ball: {{sphere: {{radius: 0.2 m, position: swing.bob.position, material: gold}}}}
  moon: {{sphere: {{radius: 0.5 m, position: idle.a.position, material: red, hidden: yes}}}}
{rest}
"""


@pytest.fixture
def load(tmp_path, monkeypatch):
    """The scene with the rest given; a folder of words has the output `ply`; files go to the folder of the scene."""
    shutil.copytree(WORDS, tmp_path / "words")
    (tmp_path / "words" / "outputs" / "count.py").write_text(COUNT)
    monkeypatch.chdir(tmp_path)

    def load(rest, **options):
        (tmp_path / "scene.yaml").write_text(SCENE.format(rest=rest))
        return pipeline.load(tmp_path / "scene.yaml", words=tmp_path / "words", **options)

    return load


def test_it_writes_the_shapes_of_every_frame_where_the_physics_has_them(load, tmp_path):
    graph = load("outputs: {files: {ply: {show: [ball]}}}")
    report = pipeline.render(graph)
    assert [path.name for path in report.files] == [f"scene.{k:04d}.ply" for k in range(4)]
    assert report.frames == 4
    for moment, path in zip(Run(graph).moments([0.0, 0.25, 0.5, 0.75]), report.files, strict=True):
        ball = trimesh.load(path, force="mesh")
        assert ball.is_watertight
        assert ball.bounds.mean(axis=0) == pytest.approx(moment.read("swing", "bob.position"), abs=1e-3)
        assert np.ptp(ball.bounds, axis=0) == pytest.approx(0.4, abs=0.01)


def test_it_keeps_what_it_draws_and_nothing_else(load):
    graph = load(
        "outputs: {files: {ply: {show: [ball]}}}\noverlays: {note: {caption: {text: hello}}}\nlights: [studio]"
    )
    assert set(graph.tasks) == {"files", "ball", "gold", "swing", "gravity", "solver"}
    assert graph.needed_by["swing"] == graph.needed_by["gold"] == ("files",)
    assert {part.name for part in graph.left_out} >= {"idle", "moon", "red", "note"}
    plan = explain(graph)
    assert plan["outputs"] == [{"name": "files", "word": "ply", "moments": 4}]
    assert plan["ahead"] == []
    assert [island["models"] for island in plan["islands"]] == [["swing"]]


def test_it_needs_no_camera_and_no_light_and_draws_all_that_is_not_hidden(load):
    graph = load("outputs: {files: ply}", pruned=False)
    assert graph.drawn["files"] == ("ball", "swing", "idle")
    assert not {task.family for task in graph.tasks.values()} & {"cameras", "lights"}
    assert graph.cameras == {}


def test_it_changes_no_picture_beside_it(load, tmp_path):
    film = "image: {size: 64 36, time: 0.5 s}"
    alone = load(f"outputs: {{film: {{{film}}}}}")
    (one,) = pipeline.render(alone, output=tmp_path / "one.png").files
    pipeline.render(load(f"outputs: {{film: {{{film}}}, files: {{ply: {{show: [ball, moon]}}}}}}"), folder=tmp_path)
    np.testing.assert_array_equal(Image.open(one), Image.open(tmp_path / "scene.film.png"))


def test_what_has_no_bounds_is_no_field(load):
    with pytest.raises(RunFailure, match="unbounded"):
        pipeline.render(load("  floor: plane\noutputs: {files: {ply: {show: [floor]}}}"))


def test_a_solid_that_was_never_there_is_told(load):
    nothing = "  no: {intersection: {of: [ball, moon]}}\noutputs: {files: {ply: {show: [no, ball]}}}"
    (warning,) = pipeline.render(load(nothing)).warnings
    assert "nothing of 'no' was ever there" in warning.message


def test_a_word_that_does_not_draw_gets_no_shapes(load, tmp_path):
    graph = load("outputs: {files: count}")
    (moment,) = pipeline.simulate(graph, [0.0])
    tools = pipeline.Tools(graph, "files", pipeline.Report(), tmp_path / "file")
    with pytest.raises(Unsuitable, match="`draws`"):
        tools.frame(moment)


def test_the_object_to_start_from_is_drawn_where_it_is_placed_with_its_outside_out(load, tmp_path):
    placed = "position: 1 0 2 m, rotation: {about: x, angle: 90 deg}"
    graph = load(
        f"  tip: {{pyramid: {{width: 2 m, height: 1 m + time*2 m/s, {placed}}}}}\n"
        "outputs: {still: {image: {show: [tip], time: 1 s}}}"
    )
    (moment,) = pipeline.simulate(graph, [1.0])
    (mesh,) = pipeline.Tools(graph, "still", pipeline.Report(), tmp_path / "file").frame(moment).shapes
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(2 * 2 * 3 / 3, rel=1e-12)
    assert mesh.vertices[4] == pytest.approx([1, 0, 5], abs=1e-12)
