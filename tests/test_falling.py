"""The watch over masses that fall into objects without a contact."""

import pytest

from sceneql import pipeline

SCENE = """
clock: {end: 1 s, fps: 10}
objects:
  tip: {arrow: {vector: 0 1 0}}
  crate: {box: {size: 1 1 1 m}}
  both: {group: {children: [tip, crate]}}
  OTHER
models: {p: {particles: {list: {a: {position: 0 3 0 m, radius: 0.2 m}}}}}
forces: [gravity]
outputs: {still: {image: {size: 8 8}}}
"""


@pytest.mark.parametrize(("other", "told"), [("", []), ("ground: {plane: {position: 0 1 0 m}}", ["falls-through"])])
def test_objects_without_an_inside_are_passed_over(tmp_path, other, told):
    """A group of an arrow, which is seen through, and a box has no field: it ended the run."""
    (tmp_path / "scene.yaml").write_text(SCENE.replace("OTHER", other))
    graph = pipeline.load(tmp_path / "scene.yaml")
    report = pipeline.render(graph, output=tmp_path / "still.png")
    assert [warning.code for warning in (*graph.warnings, *report.warnings)] == told
