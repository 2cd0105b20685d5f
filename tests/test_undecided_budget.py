"""A formula of which rounding alone decides the sign: the time of a frame is bounded, and the run says why."""

import numpy as np
import pytest

from common_scenes import tape_of
from sceneql import pipeline
from sceneql.field.packets.packet_roots_kernels import MOST_LOST
from sceneql.field.packets.packets import Memory
from sceneql.field.packets.ray_rows import FOUND_STATUS
from sceneql.field.tape.tape_ops import UNDECIDED

HOPELESS = "(x+1e8)^2-2e8*x-1e16+y^2+z^2-0.5"
SCENE = """
objects:
  thing:
    implicit:
      field: "(x+1e8)^2-2e8*x-1e16+y^2+z^2-0.5"
      bounds: {ball: 1}
cameras: {eye: {orthographic: {look_along: -0.5 -0.4 -0.75, look_at: 0 0 0 m, height: 2.2 m}}}
outputs: {still: {image: {size: 96 54, renderer: tracer}}}
renderers: {tracer: {trace: {samples: 1}}}
"""


@pytest.fixture
def graph(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return pipeline.load(path)


def test_what_rounding_decides_is_drawn_alike_by_any_threads_and_is_told_at_its_line(graph, tmp_path, monkeypatch):
    pictures = []
    for threads in ("1", "2"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        folder = tmp_path / threads
        folder.mkdir()
        report = pipeline.render(graph, folder=folder)
        pictures.append(next(folder.glob("*.png")).read_bytes())
    assert pictures[0] == pictures[1]
    (undecided,) = report.undecided["still"].values()
    assert undecided > 0
    assert report.unsearched["still"] > 0
    (told,) = [one for one in report.warnings if "rounding alone" in (one.help or "")]
    assert told.span.line == 5


def test_a_sound_formula_beside_what_rounding_decides_is_searched_all_the_same(tmp_path):
    sound = '  sound: {implicit: {field: "sin(3*x)^2+y^2+z^2-0.25", bounds: {ball: 1}, position: 2.2 0 0 m}}'
    beside = SCENE.replace("look_at: 0 0 0 m, height: 2.2 m", "look_at: 1.1 0 0 m, height: 5 m")
    beside = beside.replace("-0.5 -0.4 -0.75", "0 0 -1").replace("size: 96 54", "size: 64 36")
    beside = beside.replace("samples: 1", "samples: 1, tolerance: 1e-8")  # ray by ray
    counts = []
    for name, text in (("alone", beside), ("both", beside.replace("objects:", f"objects:\n{sound}"))):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "scene.yaml").write_text(text, encoding="utf-8")
        report = pipeline.render(pipeline.load(folder / "scene.yaml"), folder=folder)
        counts.append(sum(report.undecided["still"].values()))
    assert counts[0] == counts[1] > 0


def test_a_packet_of_what_rounding_decides_leaves_nearly_all_rays_unsearched():
    tape = tape_of(HOPELESS)
    memory = Memory(tape, 256)
    memory.rays[:3, :256] = np.random.default_rng(0).uniform(-0.3, 0.3, (3, 256))
    memory.rays[2, :256] = 1.0
    memory.rays[3:6, :256] = np.array([[0.0], [0.0], [-1.0]])
    memory.rays[6, :256], memory.rays[7, :256] = 0.0, 2.0
    _, certified = memory.settle(256, False)
    assert (memory.found[FOUND_STATUS, :256] == UNDECIDED).sum() > 200
    assert 0 < certified <= 2 * MOST_LOST  # each takes some 16 ms: twice, with and without the shortened tape
