"""What holds a body to the world is seen: a pin on a hinge, a bead on a ball joint, where nothing else stands."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql.frame import Points, Segments
from sceneql.pipeline import frame_of, load
from sceneql.run.run import Run

HUNG = """
objects: {{rod: {{box: {{size: 0.08 1 0.08 m, position: 0.5 1.5 0 m, rotation: [0.5^0.5, 0, 0, 0.5^0.5]}}}}{objects}}}
models: {{swing: {{rigid: {{of: rod}}}}{models}}}
ties: {{pivot: {{{tie}}}}}
forces: [gravity]
cameras: {{eye: {{perspective: {{position: 0 1 5 m, look_at: 0 1 0 m}}}}}}
outputs: {{film: {{image: {{size: 64 36{shown}}}}}}}
"""
HINGE = "hinge: {between: [world, swing], at: 0 1.5 0 m}"
BALL = "ball: {between: [swing, world], at: 0 1.5 0 m}"


def supports(folder, tie, objects="", models="", shown=""):
    (folder / "s.yaml").write_text(HUNG.format(tie=tie, objects=objects, models=models, shown=shown))
    graph = load(folder / "s.yaml")
    frame = frame_of(graph, "film", (64, 36), Run(graph).at(0.0), 0)
    return [shape for shape in frame.shapes if shape.name == "pivot.support"]


def test_a_hinge_has_a_pin_along_its_axis_that_comes_out_of_the_body(tmp_path):
    (pin,) = supports(tmp_path, HINGE)
    assert isinstance(pin, Segments)
    np.testing.assert_allclose(pin.ends.mean(axis=1), [[0, 1.5, 0]], atol=1e-9)
    assert np.ptp(pin.ends[0], axis=0) == pytest.approx([0, 0, np.ptp(pin.ends[0, :, 2])])
    assert np.abs(pin.ends[0, :, 2]).min() > 0.04
    assert 0.02 < pin.radii[0] < 0.04


def test_a_ball_joint_has_a_bead(tmp_path):
    (bead,) = supports(tmp_path, BALL)
    assert isinstance(bead, Points)
    np.testing.assert_allclose(bead.centers, [[0, 1.5, 0]])
    assert 0.04 < bead.radii[0] < 0.08


@pytest.mark.parametrize(
    "given",
    [
        {"objects": ", wall: {box: {size: 0.2 3 1 m, position: -0.1 1.5 0 m}}"},
        {"shown": ", show: [other]", "objects": ", other: {sphere: {radius: 0.1 m, position: 3 1 0 m}}"},
        {
            "tie": HINGE.replace("world", "arm"),
            "objects": ", beam: {box: {size: 1 0.1 0.1 m, position: -0.5 1.5 0 m}}",
            "models": ", arm: {rigid: {of: beam}}",
        },
        {"tie": HINGE.replace("0 1.5 0 m", "0 3 0 m")},
    ],
    ids=["held by a wall", "not shown", "on a body", "off the body"],
)
def test_nothing_is_drawn_where_something_else_holds_the_body_or_it_is_not_there(tmp_path, given):
    assert supports(tmp_path, given.pop("tie", HINGE), **given) == []
