"""Cameras that stand inside a solid are told of, with part and time."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql.pipeline import load, render, simulate
from sceneql.run.blind import around, look, warnings
from sceneql.tools import frame_of
from stage import GLOW, segment

SCRIPT = """
objects: {{thing: {{{thing}}}}}
cameras: {{eye: {{{camera}}}}}
outputs: {{film: {{image: {{size: 16 9, time: 0 s}}}}}}
"""
TURNED = "rotation: {about: z, angle: 90 deg}"


def told(folder, thing, eye, camera="perspective: {position: AT m, look_at: 0 20 30 m}"):
    """The warnings for a camera at a place."""
    path = folder / "scene.yaml"
    path.write_text(SCRIPT.format(thing=thing, camera=camera.replace("AT", eye)))
    graph = load(path)
    (moment,) = simulate(graph, [0.0])
    within = {}
    look(frame_of(graph, "film", (16, 9), moment, 0), "eye", within)
    return [one.message for one in warnings(within, graph.tasks)]


@pytest.mark.parametrize(
    ("thing", "inside", "outside"),
    [
        ("sphere: {radius: 0.5 m, position: 0 1 0 m}", "0.2 1.4 0", "0.4 1.4 0"),
        ("box: {size: 2 0.2 0.2 m}", "0.9 0.05 0.05", "0.9 0.15 0.05"),
        (f"cylinder: {{radius: 0.2 m, height: 2 m, {TURNED}}}", "0.9 0.1 0.1", "0.1 0.9 0.1"),
        ("torus: {radius: 1 m, tube: 0.2 m}", "0.95 0 0.05", "0 0 0"),
        ("tube: {through: [-1 0 0 m, 1 0 0 m], radius: 0.1 m}", "0.5 0.05 0.05", "0.5 0.15 0.05"),
        (
            "difference: {of: [{box: {size: 2 2 2 m}}, {sphere: {radius: 0.9 m}}]}",
            "0.95 0.95 0.9",
            "0.1 0.2 0.3",
        ),
        (
            "implicit: {field: x^2 + y^2 + z^2 - 1, bounds: {box: [-1.1 -1.1 -1.1, 1.1 1.1 1.1]}}",
            "0.5 0.5 0.5",
            "0.7 0.7 0.7",
        ),
    ],
)
def test_a_camera_inside_a_solid_is_told_of_and_one_beside_it_is_not(tmp_path, thing, inside, outside):
    assert told(tmp_path, thing, outside) == []
    assert told(tmp_path, thing, inside) == ["the camera 'eye' stands inside 'thing' at 0 s: it sees nothing else"]


@pytest.mark.parametrize(
    "thing",
    [
        "sphere: {radius: 0.5 m, material: {glass: {}}}",
        "plane: {position: 0 1 0 m}",
        "difference: {of: [{box: {size: 2 2 2 m}}, {sphere: {radius: 0.9 m}}]}",
    ],
)
def test_glass_ground_and_hollows_may_be_looked_from(tmp_path, thing):
    assert told(tmp_path, thing, "0.1 0.2 0.1") == []


def test_a_window_of_an_orthographic_view_may_stand_anywhere(tmp_path):
    assert told(tmp_path, "sphere: {radius: 0.5 m}", "", "orthographic: {look_at: 0 0 0 m, height: 2 m}") == []


def test_a_film_tells_when_its_camera_flies_through_a_ball(tmp_path):
    (tmp_path / "scene.yaml").write_text("""
clock: {end: 1 s}
objects: {ball: {sphere: {radius: 0.5 m, position: 0 0.6 0 m}}}
cameras: {eye: {perspective: {position: ["-1 m + 2 m*time/(1 s)", 0.6 m, 0 m], look_at: 9 0.6 0 m}}}
outputs: {film: {video: {size: 16 10, fps: 10}}}
""")
    (warning,) = render(load(tmp_path / "scene.yaml"), folder=tmp_path).warnings
    assert warning.message.startswith("the camera 'eye' stands inside 'ball' from 0.3 s to 0.7 s")
    assert warning.span.line == 4


def test_a_segment_as_long_as_numbers_go_is_looked_at_without_a_warning():
    assert not around(segment(GLOW, (0, 0, 0), (1e300, 0, 0), 0.1), np.array([0.0, 0.0, 3.0]))
