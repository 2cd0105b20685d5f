"""What does not change from frame to frame is made once."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing.solids import bundles
from sceneql import pipeline
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.field.tape.tape_solid import field_values
from sceneql.frame import Implicit
from sceneql.report.explain import explain, text
from sceneql.run.run import Run
from sceneql.words.objects.blobby import Blobby
from stage import WHITE, frame, sun

SCENE = """
clock: {end: 0.1 s, fps: 20}
models:
  wheel: {motion: {rotation: {about: y, angle: 60 deg*time/(1 s)}}}
  cloud: {particles: {positions: [0 0 0 m, 1 0 0 m], velocity: 0 1 0 m/s}}
objects:
  torus: {implicit: {field: "(x^2+y^2+z^2+0.2)^2-x^2-y^2", rotation: wheel.rotation}}
  blobs: {blobby: {points: cloud.positions, radius: 0.6 m}}
  ball: {sphere: {position: 3 0 0 m}}
  both: {union: {of: [torus, ball]}}
cameras: {eye: {orthographic: {look_along: 0 0 -1, look_at: 0 0 0 m, height: 4 m}}}
outputs: {film: {images: {size: 16 16}}}
"""


def turned(angle):
    """A cone in a ball, about z, in coordinates that are turned about y."""
    matrix = np.array([[np.cos(angle), 0, np.sin(angle), 0.1], [0, 1, 0, 0.2], [-np.sin(angle), 0, np.cos(angle), 0.3]])
    build = TapeBuilder()
    x, y, z = build.affine(matrix, build.x, build.y, build.z)
    square = build.op("add", build.op("square", x), build.op("square", y))
    cone = build.op("sub", square, build.op("mul", build.op("square", z), build.constant(0.7)))
    ball = build.op("sub", build.op("add", square, build.op("square", z)), build.constant(1.1))
    return build.finish(build.op("max", cone, ball))


def kummer(angle):
    """A product of four planes beside a ball, in coordinates that are turned about y: it has more than three forms."""
    matrix = np.array([[np.cos(angle), 0, np.sin(angle), 0], [0, 1, 0, 0], [-np.sin(angle), 0, np.cos(angle), 0]])
    build = TapeBuilder()
    x, y, z = build.affine(matrix, build.x, build.y, build.z)
    ball = build.op("add", build.op("add", build.op("square", x), build.op("square", y)), build.op("square", z))
    planes = build.constant(0.7)
    for sign, other in (("add", x), ("sub", x), ("add", y), ("sub", y)):
        wide = build.op("mul", other, build.constant(2**0.5))
        planes = build.op("mul", planes, build.op(sign, build.op("sub", build.constant(1.0), z), wide))
    return build.finish(build.op("sub", build.op("square", ball), planes))


@pytest.mark.parametrize("solid", [turned, kummer])
def test_a_solid_that_turns_is_the_same_tape_in_its_own_coordinates(solid):
    first, other = (in_own_coordinates(solid(angle)) for angle in (0.4, 1.1))
    assert first[0] is other[0]
    assert abs(first[1] - other[1]).max() > 0.1
    points = np.random.default_rng(1).normal(size=(50, 3))
    seen = points @ other[1][:, :3].T + other[1][:, 3]
    np.testing.assert_allclose(field_values(other[0], seen), field_values(solid(1.1), points), rtol=1e-12, atol=1e-12)


def test_memory_of_packets_is_taken_over_from_frame_to_frame(monkeypatch):
    monkeypatch.setenv("SCENEQL_THREADS", "1")
    seen = []
    for angle in (0.4, 1.1):
        shape = Implicit("cone", WHITE, turned(angle), (-1.5,) * 3, (1.5,) * 3)
        Trace(samples=1).draw(frame(shape, lights=[sun((1, 1, 1))], seen=stage.view(size=(32, 32))))
        seen.append(bundles._of_thread.memories[0])
    assert seen[0] is seen[1]
    other = frame(stage.implicit_sphere(WHITE), lights=[sun((1, 1, 1))], seen=stage.view(size=(32, 32)))
    Trace(samples=1).draw(other)
    assert bundles._of_thread.memories[0] is not seen[0]


@pytest.fixture
def graph(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return pipeline.load(path)


def test_points_that_move_are_packed_once_a_frame(graph, tmp_path, monkeypatch):
    asked = []
    packed = Blobby._parts

    def counted(kind, moment):
        asked.append(moment.time)
        return packed(kind, moment)

    monkeypatch.setattr(Blobby, "_parts", counted)
    pipeline.render(graph, folder=tmp_path)
    assert len(list(tmp_path.glob("*.png"))) == 2
    assert asked == [0.0, 0.05]


def test_explain_tells_what_is_made_once_and_what_each_frame(graph):
    plan = explain(graph)
    assert plan["changing"] == {"torus": ["rotation"], "blobs": ["points"], "ball": [], "both": ["of"]}
    anew = "blobs by its points; torus by its rotation; both by its of"
    assert f"\nmade once: ball\neach frame anew: {anew}\n" in text(plan)


def test_skeletons_of_a_group_are_not_mistaken_for_each_other(tmp_path):
    """Copies in the group's material take each other's place in memory; a skeleton was found by it, so that one object
    was drawn as another."""
    path = tmp_path / "scene.yaml"
    lines = ["objects:", "  pair:", "    group:", "      material: {glossy: {}}", "      children:"]
    for count in range(1, 5):
        points = ", ".join(f"{k} 0 0 m" for k in range(count))
        lines.append(f"        n{count}: {{blobby: {{skeleton: [{{points: [{points}]}}]}}}}")
    path.write_text("\n".join([*lines, "outputs: {still: {image: {size: 32 32}}}"]))
    moment = Run(pipeline.load(path)).at(0.0)
    pair = moment.run.graph.tasks["pair"].kind
    kept = [child for _, child in pair._objects(moment)]
    counts = [len(kept.pop(0).model_copy().parts(moment).weights) for _ in range(4)]
    assert counts == [1, 2, 3, 4]
