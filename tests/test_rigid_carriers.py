"""Rigid bodies whose objects have no position: tubes, blobby and twisted solids move as a group of them would."""

from __future__ import annotations

import imageio.v3 as imageio
import pytest

from sceneql.pipeline import load, render, simulate
from sceneql.quantities.diagnostic import ScriptError

SCRIPT = """
objects:
  body: {{{body}}}
  group: {{group: {{children: [body]}}}}
  floor: none
models: {{fall: {{rigid: {{of: {of}, mass: 2 kg, spin: 1 0 2 rad/s}}}}}}
forces: [gravity]
cameras: {{eye: {{perspective: {{position: 0 1 4 m, look_at: 0 0.5 0 m}}}}}}
outputs: {{still: {{image: {{size: 48 32, time: 0.3 s}}}}}}
clock: {{end: 0.3 s}}
"""


def picture(folder, body, of):
    text = SCRIPT.format(body=body, of=of)
    if of == "body":
        text = text.replace("  group: {group: {children: [body]}}\n", "")
    (folder / "scene.yaml").write_text(text)
    graph = load(folder / "scene.yaml")
    assert "fall" in graph.tasks
    (file,) = render(graph, folder=folder).files
    return imageio.imread(file).tobytes()


@pytest.mark.parametrize(
    "body",
    [
        "blobby: {points: [-0.2 1.5 0 m, 0.2 1.5 0 m], radius: 0.5 m, color: orange}",
        "tube: {through: [0 1 0 m, 0.3 1.4 0 m], radius: 0.1 m, color: orange}",
    ],
)
def test_it_moves_as_a_group_of_it(tmp_path, body):
    """A blobby body was left out of the run, and stood still, without a word."""
    alone = picture(tmp_path, body, "body")
    assert alone == picture(tmp_path, body, "group")
    assert alone != picture(tmp_path, body.replace("1.5 0 m", "1.6 0 m").replace("1.4 0 m", "1.5 0 m"), "body")


def test_what_cannot_be_a_body_is_called_by_its_own_name(tmp_path):
    with pytest.raises(ScriptError, match="'body' cannot be a rigid body: it is empty"):
        picture(tmp_path, "outline: {points: [0 0 m, 1 0 m, 0 1 m]}", "body")


def test_it_is_met_and_shown_by_its_name_where_it_is(tmp_path):
    """What collides with the object, and films of it alone, had the one that stood still."""
    (tmp_path / "scene.yaml").write_text("""
objects:
  floor: none
  blob: {blobby: {points: [-0.2 1.5 0 m, 0.2 1.5 0 m], radius: 0.5 m}}
  ball: {sphere: {radius: 0.1 m, position: 0 3 0 m}}
models:
  fall: {rigid: {of: blob, mass: 1 kg}}
  drop: {particles: {of: ball, mass: 1 kg}}
forces: [gravity, {collision: {between: [drop, blob]}}]
outputs: {film: {images: {size: 16 16, show: [blob]}}}
clock: {end: 0.8 s, fps: 5}
""")
    graph = load(tmp_path / "scene.yaml", pruned=False)
    (moment,) = simulate(graph, [0.8])
    assert moment.read("ball", "position")[1] == pytest.approx(3 - 9.81 * 0.8**2 / 2, abs=1e-6)
    assert "fall" in load(tmp_path / "scene.yaml").tasks
