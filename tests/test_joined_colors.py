"""Colors of what is cut, joined or warped: those of the member whose surface is seen there, mixed along blends."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql import pipeline
from sceneql.field.tape.tape_solid import paint_values
from sceneql.shapes.color import linear

RED, BLUE, LIME, GOLD = [1, 0, 0], [0, 0, 1], [0, 1, 0], [1, 215 / 255, 0]
SCRIPT = """
objects:
  ball: {sphere: {radius: 1 m, color: red}}
  cube: {box: {size: 1 1 1 m, position: 0.5 0.5 0.5 m, color: blue}}
  bare: {box: {size: 1 1 1 m, position: 0.5 0.5 0.5 m}}
  cap: {sphere: {radius: 0.4 m, position: -1 0 0 m, color: lime}}
  bitten: {difference: {of: [ball, cube]}}
  plainly: {difference: {of: [ball, bare]}}
  softly: {difference: {of: [ball, cube], blend: 0.2 m}}
  corner: {intersection: {of: [ball, cube]}}
  cleared: {intersection: {of: [bare, ball]}}
  painted: {difference: {of: [ball, cube], color: gold}}
  capped: {union: {of: [ball, cap]}}
  deep: {difference: {of: [capped, bare]}}
  turned: {twist: {of: capped, about: x, angle: 90 deg, per: 1 m}}
  bitten_turned: {twist: {of: bitten, about: z, angle: 90 deg, per: 0.3 m, position: 0 3 0 m}}
  blob: {blobby: {color: gold, skeleton: [{point: -0.3 0 0 m, radius: 1 m, color: red}, {point: 0.9 0 0 m, radius: 1 m,
    color: blue}]}}
  turned_blob: {twist: {of: blob, about: x, angle: 90 deg, per: 1 m}}
  with_turned: {union: {of: [{twist: {of: ball, about: x, angle: 90 deg, per: 1 m}}, cap]}}
  overpainted: {twist: {of: capped, about: x, angle: 90 deg, per: 1 m, color: gold}}
"""
FACE, SKIN, KEPT = (0, 0.3, 0.3), (-0.6, 0, 0.8), (0.5, 0.5, 0.5**0.5)


@pytest.fixture(scope="module")
def paint(tmp_path_factory):
    """The function that tells an object's colors (n, 3) at places (n, 3) [m]."""
    path = tmp_path_factory.mktemp("colors") / "s.yaml"
    path.write_text(SCRIPT)
    graph = pipeline.load(path, pruned=False)
    moment = next(pipeline.simulate(graph, [0.0]))

    def colors(name, *places):
        shape = next(iter(graph.tasks[name].kind.lower(name, np.eye(3, 4), moment)))
        own = np.tile(shape.surface.color, (len(places), 1))
        return own if shape.paint is None else paint_values(shape.paint, np.array(places, dtype=float))

    return colors


@pytest.mark.parametrize(
    ("name", "face", "skin"),
    [("bitten", BLUE, SKIN), ("plainly", RED, SKIN), ("deep", RED, SKIN), ("corner", BLUE, KEPT)],
)
def test_a_cut_face_has_the_color_of_what_cut_it_or_of_the_first_member(paint, name, face, skin):
    assert paint(name, FACE)[0] == pytest.approx(face)
    assert paint(name, skin)[0] == pytest.approx(RED)


def test_members_that_are_cut_keep_the_colors_of_their_own_members(paint):
    assert paint("deep", (-1.4, 0, 0))[0] == pytest.approx(LIME)


def test_an_intersection_with_what_has_no_color_shows_it_in_the_default_color_where_it_comes_first(paint):
    face, skin = paint("cleared", FACE, KEPT)
    assert skin == pytest.approx(RED)
    assert face != pytest.approx(RED)


def test_colors_run_over_along_a_blended_edge_and_nowhere_else(paint):
    face, skin = paint("softly", FACE, SKIN)
    assert face == pytest.approx(BLUE)
    assert skin == pytest.approx(RED)
    edge = paint("softly", (0, 0.5**0.5, 0.5**0.5))[0]  # on both surfaces
    assert edge == pytest.approx([0.5, 0, 0.5])


def test_what_has_a_color_of_its_own_shows_no_other(paint):
    for name in ("painted", "overpainted"):
        colors = paint(name, FACE, SKIN)
        assert colors == pytest.approx(np.tile(linear(GOLD), (2, 1)))


def test_a_warped_object_shows_the_colors_where_its_points_came_from(paint):
    assert paint("turned", (-1.4, 0, 0))[0] == pytest.approx(LIME)
    assert paint("turned", (1, 0, 0))[0] == pytest.approx(RED)
    # At z = 0.3 all is turned by 90 degrees about z: what was in the direction y is in the direction -x.
    face, outer = paint("bitten_turned", (-0.3, 3, 0.3), (-0.3, 3 - (1 - 0.18) ** 0.5, 0.3))
    assert face == pytest.approx(BLUE)
    assert outer == pytest.approx(RED)
    assert paint("turned_blob", (-0.9, 0, 0))[0] == pytest.approx(RED)
    assert paint("turned_blob", (1.5, 0, 0))[0] == pytest.approx(BLUE)


def test_a_warped_member_brings_its_color(paint):
    assert paint("with_turned", (1, 0, 0))[0] == pytest.approx(RED)
