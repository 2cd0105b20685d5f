"""Children written in place under names are parts of the script, as if they stood in its sections."""

import numpy as np
import pytest

from sceneql.language.script import read_script
from sceneql.language.tree import written
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.span import Source
from sceneql.run.run import Run

NESTED = """
templates:
  leg:
    fields: {at: 0 0 0 m, side: 1}
    objects:
      hip:
        group:
          position: at
          rotation: {about: z, angle: 90 deg}
          children:
            knee:
              group:
                position: [0 m, -0.22 m, 0.05 m * side]
                children: {toe: {sphere: {radius: 0.1 m, position: 0.05 -0.2 0.02 m}}}
      mark: {sphere: {radius: 0.5 * toe.radius, position: knee.position}}
parts:
  left: {leg: {at: 0.4 0.45 0.16 m}}
  right: {leg: {at: 0.4 0.45 -0.16 m, side: -1}}
objects:
  far: {sphere: {radius: left.toe.radius + right.toe.radius, position: right.knee.position}}
"""
FLAT = """
templates:
  leg:
    fields: {at: 0 0 0 m, side: 1}
    objects:
      hip: {group: {position: at, rotation: {about: z, angle: 90 deg}, children: {knee: knee}}}
      knee: {group: {position: [0 m, -0.22 m, 0.05 m * side], children: {toe: toe}}}
      toe: {sphere: {radius: 0.1 m, position: 0.05 -0.2 0.02 m}}
      mark: {sphere: {radius: 0.5 * toe.radius, position: knee.position}}
parts:
  left: {leg: {at: 0.4 0.45 0.16 m}}
  right: {leg: {at: 0.4 0.45 -0.16 m, side: -1}}
objects:
  far: {sphere: {radius: left.toe.radius + right.toe.radius, position: right.knee.position}}
"""


def entries(text, **options):
    read = read_script(Source("s.yaml", text), **options)
    return [
        (n, e.word, e.fields and written(e.fields)) for section in read.sections.values() for n, e in section.items()
    ]


def test_nested_children_are_entries_of_their_own():
    assert entries(NESTED) == entries(FLAT)
    assert {"left.hip", "left.knee", "left.toe", "right.toe"} <= {name for name, _, _ in entries(NESTED)}


def test_children_are_linked_to_by_their_names_and_drawn_where_their_groups_are(tmp_path):
    (tmp_path / "s.yaml").write_text(NESTED)
    graph = load(tmp_path / "s.yaml")
    (moment,) = Run(graph).moments([0.0])
    assert moment.read("far", "radius") == pytest.approx(0.2)
    np.testing.assert_allclose(moment.read("left.mark", "position"), [0, -0.22, 0.05])
    assert not {"left.knee", "left.toe"} & set(moment.everything)  # drawn by their groups alone
    (toe,) = (shape for shape in moment.lower(["right.hip"]) if shape.name == "right.toe")
    center = -np.linalg.solve(toe.to_local[:, :3], toe.to_local[:, 3])
    # A quarter of a turn about z takes (x, y) to (-y, x).
    np.testing.assert_allclose(center, [0.4 + 0.42, 0.45 + 0.05, -0.16 - 0.05 + 0.02], atol=1e-12)


def test_a_patch_finds_a_child_where_it_is_written():
    path = "templates.leg.objects.hip.group.children.knee.group.children.toe.sphere.radius=0.3 m"
    patched = {name: fields for name, _, fields in entries(NESTED, sets=(path,))}
    assert patched["left.toe"]["radius"] == "0.3 m"


def test_names_of_parts_and_copies_stay_in_place():
    text = """
objects:
  ball: sphere
  pair: {group: {children: {one: ball, two: {sphere: {}}}}}
  many: {group: {children: {each: {sphere: {}}}}, repeat: {count: 2}}
"""
    assert [name for name, _, _ in entries(text)] == ["ball", "pair", "two", "many.0", "many.1"]


def test_a_child_with_the_name_of_another_part_is_an_error():
    text = "objects: {floor: plane, pair: {group: {children: {floor: {plane: {}}}}}}\n"
    with pytest.raises(ScriptError, match="'floor' is used twice"):
        read_script(Source("s.yaml", text))


def test_cameras_see_a_joint_where_its_groups_have_put_it(tmp_path):
    cameras = (
        "cameras:\n"
        "  beside: {perspective: {follow: right.toe, from: 0 0 2 m}}\n"
        "  around: {turntable: {around: right.knee, distance: 3 m}}\n"
        "  joint: {orthographic: {follow: right.knee, height: 1 m}}\n"
        "outputs: {a: {image: {camera: beside}}, b: {image: {camera: around}}, c: {image: {camera: joint}}}\n"
    )
    (tmp_path / "s.yaml").write_text(NESTED + cameras)
    graph = load(tmp_path / "s.yaml")
    (moment,) = Run(graph).moments([0.0])
    knee, toe = (0.4 + 0.22, 0.45, -0.16 - 0.05), (0.4 + 0.42, 0.45 + 0.05, -0.16 - 0.05 + 0.02)
    views = [graph.tasks[name].kind.view((64, 36), moment) for name in ("beside", "around", "joint")]
    np.testing.assert_allclose(views[0].origin, np.add(toe, (0, 0, 2)), atol=1e-12)
    np.testing.assert_allclose(views[1].origin - 3 * views[1].axes[2], toe, atol=1e-9)  # all that the knee draws
    np.testing.assert_allclose(np.subtract(views[2].origin, knee) @ views[2].axes[:2].T, 0, atol=1e-12)
