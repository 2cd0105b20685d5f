"""Cameras whose subject is hidden behind something else for most of the film are told of."""

from __future__ import annotations

import pytest

from sceneql.pipeline import load, render, simulate
from sceneql.run.covered import look, warnings
from sceneql.tools import frame_of

SCRIPT = """
clock: {{end: 4 s}}
objects:
  ball: {{sphere: {{radius: 0.3 m, position: ["-1 m + 0.5 m/s*time", 0.3 m, -1 m]}}}}
  wall: {{{wall}}}
cameras: {{eye: {{{camera}}}}}
outputs: {{film: {{video: {{size: 16 10, fps: 2}}}}}}
"""
LOOKS = "perspective: {position: 0 1 6 m, look_at: ball.position}"
PLATE = "size: 3 2 0.2 m, position: 0 1 1 m"


def told(folder, wall, camera=LOOKS):
    """The warnings of a film of nine frames."""
    (folder / "scene.yaml").write_text(SCRIPT.format(wall=wall, camera=camera))
    (folder / "plate.obj").write_text("v -1.5 0 1\nv 1.5 0 1\nv 1.5 2 1\nv -1.5 2 1\nf 1 2 3\nf 1 3 4\n")
    graph, covered = load(folder / "scene.yaml"), {}
    for moment in simulate(graph, [0.5 * k for k in range(9)]):
        look(frame_of(graph, "film", (16, 10), moment, 0), "eye", graph.tasks, covered)
    return [one.message for one in warnings(covered, graph.tasks)]


@pytest.mark.parametrize(
    "wall",
    [
        f"box: {{{PLATE}}}",
        "sphere: {radius: 1.6 m, position: 0 0.5 2 m}",
        "cylinder: {radius: 1.6 m, height: 4 m, position: 0 1 2 m}",
        "tube: {through: [-3 0.5 2 m, 3 0.5 2 m], radius: 0.5 m}",
        "group: {children: [{box: {size: 3 2 0.2 m}}], position: 0 1 1 m}",
        "difference: {of: [{box: {size: 3 2 0.4 m, position: 0 1 1 m}}, {sphere: {radius: 0.1 m, position: 3 3 3 m}}]}",
        "implicit: {field: x^2 + y^2 + z^2 - 2.56, bounds: {ball: 1.7}, position: 0 0.5 2 m}",
        "mesh: {file: plate.obj}",
    ],
)
def test_a_subject_behind_a_solid_is_told_of(tmp_path, wall):
    (message,) = told(tmp_path, wall)
    assert message.startswith("'ball', at which the camera 'eye' looks, is hidden behind 'wall")
    assert message.endswith("most of the time from 0 s to 4 s")


@pytest.mark.parametrize(
    "camera",
    [
        "perspective: {follow: ball, from: 0 0 7 m}",
        "orthographic: {look_at: ball.position, height: 4 m}",
        "turntable: {around: ball, distance: 4 m, seconds: 1000 s, start: 0 deg, tilt: 5 deg}",
    ],
)
def test_every_camera_knows_what_it_is_aimed_at(tmp_path, camera):
    assert len(told(tmp_path, "box: {size: 6 4 0.2 m, position: 0 1 1 m}", camera)) == 1


@pytest.mark.parametrize(
    ("wall", "camera"),
    [
        (f"box: {{{PLATE}, material: {{glass: {{}}}}}}", LOOKS),
        ("box: {size: 0.8 2 0.2 m, position: 0 1 1 m}", LOOKS),
        ("box: {size: 3 0.3 0.2 m, position: 0 0.5 1 m}", LOOKS),
        ("box: {size: 3 2 0.2 m, position: 0 1 -2 m}", LOOKS),
        ("cylinder: {radius: 0.1 m, height: 2 m, position: 0 1 1 m}", LOOKS),
        (f"box: {{{PLATE}}}", "perspective: {position: 0 1 6 m, look_at: 0 0.3 -1 m}"),
        (f"box: {{{PLATE}}}", "perspective: {position: 0 1 6 m, look_at: wall.position}"),
        (f"box: {{{PLATE}}}", "perspective: {position: 3 6 4 m, look_at: ball.position}"),
    ],
    ids=["glass", "for a while", "in part", "behind it", "a thin one", "no subject", "the wall", "from above"],
)
def test_what_is_seen_at_least_half_of_the_time_is_not_told_of(tmp_path, wall, camera):
    assert told(tmp_path, wall, camera) == []


def test_a_film_tells_of_it_with_its_line(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCRIPT.format(wall=f"box: {{{PLATE}}}", camera=LOOKS))
    (warning,) = render(load(tmp_path / "scene.yaml"), folder=tmp_path).warnings
    assert (warning.code, warning.span.line) == ("hidden-subject", 6)
