"""Edges and corners of objects in the elements that fill them."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql.bodies.elements import filled
from sceneql.bodies.elements.element_mesh import fine_rule, worst_angle
from sceneql.bodies.filling import kept_creases, split_creases
from sceneql.bodies.filling.kept_creases import creases_kept
from sceneql.bodies.filling.stuffing import stuffed
from sceneql.bodies.filling.tetrahedra import boundary, volumes
from sceneql.words.objects.sphere import Sphere
from sceneql.words.objects.torus import Torus
from solids import Solid

OBJECTS = {
    "box": ("box: {size: 1 0.7 0.53 m}", 0.371, 1e-9),
    "joined": ("union: {of: [{box: {size: 1 0.5 0.5 m}}, {box: {size: 0.5 1 0.5 m, position: 0.25 0.5 0 m}}]}",
               0.4375, 1e-3),
    "bitten": ("difference: {of: [{box: {size: 1 1 1 m}}, {sphere: {radius: 0.5 m, position: 0.5 0.5 0.5 m}}]}",
               1 - np.pi / 48, 2e-3),
    "turned": ("box: {size: 1 0.7 0.53 m, rotation: {xyz: 20 30 40 deg}}", 0.371, 0.005),
}  # fmt: skip


def made(folder, text, spacing, element="p1", objects=""):
    shape = text[: text.rindex("}")] + ", hidden: yes}"
    more = f"objects:\n  shape: {{{shape}}}\n{objects}"
    fields = f"{{of: shape, spacing: {spacing} m, element: {element}, law: {{linear: {{modulus: 1 MPa}}}}}}"
    return Solid(folder, fields, more).mesh


@pytest.mark.parametrize("name", OBJECTS)
@pytest.mark.parametrize("spacing", [0.2, 0.16])
def test_edges_and_corners_of_objects_are_kept(tmp_path, name, spacing):
    text, volume, tolerance = OBJECTS[name]
    mesh = made(tmp_path, text, spacing, "p2")
    places, weights = fine_rule()
    held = mesh.sizes(places)
    assert held.min() > 0.0
    assert held.mean(axis=0) @ weights / 6 * len(held) == pytest.approx(volume, rel=tolerance)


def test_creases_between_curved_faces_are_nodes_to_rounding(tmp_path):
    """The rims of a cylinder: corners there, and the nodes on edges in between."""
    mesh = made(tmp_path, "cylinder: {radius: 0.5 m, height: 0.7 m}", 0.2, "p2")
    outer = mesh.points[np.unique(mesh.faces)]
    side, end = np.hypot(outer[:, 0], outer[:, 2]), np.abs(outer[:, 1])
    near = (side > 0.48) & (end > 0.33)
    assert near.sum() > 40
    np.testing.assert_allclose(side[near], 0.5, atol=1e-6)
    np.testing.assert_allclose(end[near], 0.35, atol=1e-6)


def test_all_corners_of_a_box_are_nodes(tmp_path):
    mesh = made(tmp_path, OBJECTS["box"][0], 0.11)
    for corner in np.array(np.meshgrid([-0.5, 0.5], [-0.35, 0.35], [-0.265, 0.265])).reshape(3, -1).T:
        assert np.linalg.norm(mesh.points - corner, axis=1).min() < 1e-9


PLATE = (
    "difference: {of: [{intersection: {of: [{group: {children: [disk], scale: [3.25, 1, 2.75]}}, "
    "{box: {size: 4 1 4 m, position: 2 0 2 m}}]}}, {group: {children: [core], scale: [2, 1, 1]}}]}"
)
BALL = "intersection: {of: [{sphere: {radius: 1 m}}, {box: {size: 2 2 2 m, position: 1 %s m}}]}"
HALF = "intersection: {of: [{cylinder: {radius: 1 m, height: 1.3 m}}, {box: {size: 3 3 3 m, position: 1.5 0 0 m}}]}"
DISKS = "  disk: {cylinder: {radius: 1 m, height: 0.6 m}}\n  core: {cylinder: {radius: 1 m, height: 1 m}}\n"


def ellipse(x, z, a, b):
    return np.hypot(x / a, z / b) - 1


# What the surfaces of a solid are zero of, and its corners.
SOLIDS = {
    "plate": (PLATE, lambda x, y, z: [ellipse(x, z, 2, 1), ellipse(x, z, 3.25, 2.75), y - 0.3, y + 0.3, x, z],
              [(x, y, z) for y in (0.3, -0.3) for x, z in ((2, 0), (3.25, 0), (0, 1), (0, 2.75))]),
    "quarter ball": (BALL % "1 0", lambda x, y, z: [np.hypot(np.hypot(x, y), z) - 1, x, y], [(0, 0, 1), (0, 0, -1)]),
    "octant": (BALL % "1 1", lambda x, y, z: [np.hypot(np.hypot(x, y), z) - 1, x, y, z],
               [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]),
    "half cylinder": (HALF, lambda x, y, z: [np.hypot(x, z) - 1, x, y - 0.65, y + 0.65],
                      [(0, y, z) for y in (0.65, -0.65) for z in (1, -1)]),
}  # fmt: skip
CAP = "intersection: {of: [{sphere: {radius: 1 m}}, {box: {size: 4 2 4 m, position: 0 %s 0 m}}]}"
SPACINGS = {
    "plate": [0.25, 0.28, 0.31, 0.35, 0.4],
    "quarter ball": [0.3, 0.4],
    "octant": [0.23, 0.3],
    "half cylinder": [0.3, 0.37],
}


@pytest.mark.parametrize(("name", "spacing"), [(name, one) for name in SOLIDS for one in SPACINGS[name]])
def test_corners_are_nodes_and_nodes_of_creases_stand_on_both_surfaces_at_any_spacing(tmp_path, name, spacing):
    text, surfaces, corners = SOLIDS[name]
    mesh = made(tmp_path, text, spacing, "p2", DISKS if name == "plate" else "")
    assert mesh.sizes(np.concatenate([np.eye(4), fine_rule()[0]])).min() > 0.0
    assert np.degrees(worst_angle(mesh.points, mesh.cells[:, :4])[0]) > 5.0
    for corner in corners:
        assert np.linalg.norm(mesh.points[: mesh.corners] - corner, axis=1).min() < 1e-9
    on = np.abs(surfaces(*mesh.points.T)) < 1e-9
    assert on[:, mesh.faces[:, :3]].all(axis=2).any(axis=0).all(), "an outer face cuts off a crease"
    for k, ends in enumerate(((0, 1), (1, 2), (2, 0))):
        both = on[:, mesh.faces[:, ends]].all(axis=2)
        crease = both.sum(axis=0) > 1
        assert (on[:, mesh.faces[crease, 3 + k]] >= both[:, crease]).all()


@pytest.mark.parametrize(("height", "spacing"), [(0.5, 0.26), (0.5, 0.15), (0.7, 0.15)])
def test_no_face_cuts_off_an_acute_lip(tmp_path, height, spacing):
    """There is more than a spacing from the middle of an edge that cuts it off to the lip."""
    mesh = made(tmp_path, CAP % (1 + height), spacing, "p2")
    on = np.abs([np.linalg.norm(mesh.points, axis=1) - 1, mesh.points[:, 1] - height]) < 1e-9
    assert on[:, mesh.faces[:, :3]].all(axis=2).any(axis=0).all()
    lip = np.hypot(*mesh.points[np.unique(mesh.faces[:, :3])][:, [0, 2]].T).max()
    assert lip == pytest.approx(np.sqrt(1 - height**2), abs=1e-9)
    assert mesh.sizes(np.concatenate([np.eye(4), fine_rule()[0]])).min() > 0.0


@pytest.mark.parametrize("place", ["0 1.6 0", "0.1 0.3 7", "1e3 0 0"])
def test_boxes_of_whole_numbers_of_spacings_have_good_angles_at_any_place(tmp_path, place):
    box = made(tmp_path, f"box: {{size: 1 0.5 0.3 m, position: {place} m}}", 0.1)
    assert np.degrees(worst_angle(box.points, box.cells)[0]) > 44.0
    assert volumes(box.points, box.cells).sum() == pytest.approx(0.15, rel=1e-12)


@pytest.mark.parametrize("spacing", [0.25, 0.4, 0.6, 0.9])
def test_what_has_no_crease_stays_as_it_is(spacing):
    def holds(places):
        return np.linalg.norm(places, axis=1) < 1.0

    def crossing(inner, outer):
        way = outer - inner
        a, b, c = (way**2).sum(1), 2 * (way * inner).sum(1), (inner**2).sum(1) - 1.0
        return (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a)

    low = np.full(3, -1.0)
    ball = stuffed(low, -low, spacing, holds, crossing)
    moved = creases_kept(ball.points, ball.tetrahedra, spacing, holds, crossing).points
    np.testing.assert_array_equal(moved, ball.points)


def test_corners_inside_never_move():
    def holds(places):
        return (np.abs(places) < 0.5).all(axis=1)

    def crossing(inner, outer):
        low, high = np.zeros(len(inner)), np.ones(len(inner))
        for _ in range(40):
            middle = 0.5 * (low + high)
            held = holds(inner + middle[:, None] * (outer - inner))
            low, high = np.where(held, middle, low), np.where(held, high, middle)
        return low

    cube = stuffed(np.full(3, -0.5), np.full(3, 0.5), 0.19, holds, crossing)
    moved = creases_kept(cube.points, cube.tetrahedra, 0.19, holds, crossing).points
    inner = np.setdiff1d(np.arange(len(moved)), boundary(cube.tetrahedra))
    np.testing.assert_array_equal(moved[inner], cube.points[inner])
    assert volumes(cube.points, cube.tetrahedra).sum() < 0.99
    assert volumes(moved, cube.tetrahedra).sum() == pytest.approx(1.0, abs=5e-3)


SMOOTH = {
    "ball": ("sphere: {radius: 0.5 m}", 0.4),
    "ring": ("torus: {radius: 1 m, tube: 0.4 m}", 0.4),
    "egg": ("group: {scale: [1, 0.4, 2], children: {b: {sphere: {radius: 0.5 m}}}, rotation: {xyz: 30 0 0 deg}}", 0.4),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_no_crease_is_searched_on_objects_known_to_have_none_and_the_search_finds_none(tmp_path, monkeypatch, name):
    text, spacing = SMOOTH[name]
    with monkeypatch.context() as at:
        for module in (kept_creases, split_creases):
            at.setattr(module, "onto_crease", lambda *_: pytest.fail("a crease is searched"))
        quick = made(tmp_path, text, spacing, "p2")
    filled._kept.clear()
    for word in (Sphere, Torus):
        monkeypatch.setattr(word, "smooth", lambda *_: False)
    searched = made(tmp_path, text, spacing, "p2")
    filled._kept.clear()
    assert quick.points.tobytes() == searched.points.tobytes()
    assert quick.cells.tobytes() == searched.cells.tobytes()


def test_a_ring_without_a_hole_is_searched_for_its_dents(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(filled, "creases_kept", lambda *given: calls.append(given[-1]) or creases_kept(*given))
    for tube in (0.2, 0.3):
        made(tmp_path, f"torus: {{radius: 0.3 m, tube: {tube} m}}", 0.2)
    assert calls == [True, False]
