"""In a list of parts the name of a repeated part, or of an instance of a template, means all that it stands for."""

from __future__ import annotations

import pytest

from sceneql import pipeline
from sceneql.quantities.diagnostic import ScriptError

SCENE = """
templates:
  pair: {objects: {left: sphere, right: {box: {position: 1 0 0 m}}}, lights: [point]}
parts:
  twins: pair
  many: {repeat: {count: 2}, pair: {}}
objects:
  bead: {repeat: {count: 3, as: i}, sphere: {position: [1 m*i, 1 m, 0 m]}}
"""


def load(tmp_path, rest, more=""):
    (tmp_path / "scene.yaml").write_text(f"{SCENE}{more}\noutputs: {{still: {{image: {rest}}}}}\n")
    return pipeline.load(tmp_path / "scene.yaml")


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("bead", ("bead.0", "bead.1", "bead.2")),
        ("bead.1", ("bead.1",)),
        ("twins", ("twins.left", "twins.right")),
        ("many", ("many.0.left", "many.0.right", "many.1.left", "many.1.right")),
        ("many.1", ("many.1.left", "many.1.right")),
    ],
)
def test_a_name_of_many_is_each_of_them(tmp_path, name, parts):
    assert load(tmp_path, f"{{show: [{name}]}}").drawn["still"] == parts
    assert load(tmp_path, f"{{show: {name}}}").drawn["still"] == parts


def test_a_group_moves_them_and_draws_them_once(tmp_path):
    graph = load(tmp_path, "{}", "  all: {group: {children: [bead, twins.left], position: 0 1 0 m}}")
    assert not {name for name in graph.drawn["still"] if name.startswith("bead")}
    assert "all" in graph.drawn["still"]
    assert {"bead.0", "bead.1", "bead.2", "twins.left"} <= graph.tasks.keys()


def test_parts_of_another_family_are_told(tmp_path):
    more = "\nmodels: {ball: {repeat: {count: 2}, particles: {of: bead.0, mass: 1 kg}}}"
    with pytest.raises(ScriptError, match="no part of objects is called 'ball'"):
        load(tmp_path, "{}", f"  all: {{group: {{children: [ball]}}}}{more}")
