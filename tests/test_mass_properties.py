"""Mass, center and inertia of solids: exact values, orders of convergence, laws under affine maps, what has none."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from moment import FakeMoment, const, formula
from sceneql.bodies.rigid.mass_properties import by_field, impossible, moments_of, of_moments, principal, properties
from sceneql.kinds import Ref, VolumeMoments
from sceneql.mesh import polyhedra
from sceneql.shapes.placement import affine, apply, rotation_matrix
from sceneql.words.objects.blobby import Blobby
from sceneql.words.objects.box import Box
from sceneql.words.objects.cylinder import Cylinder
from sceneql.words.objects.difference import Difference
from sceneql.words.objects.group import Group
from sceneql.words.objects.implicit import Implicit, Within
from sceneql.words.objects.mesh import Mesh
from sceneql.words.objects.plane import Plane
from sceneql.words.objects.polygonised import Polygonised
from sceneql.words.objects.sphere import Sphere
from sceneql.words.objects.torus import Torus
from sceneql.words.objects.tube import Tube
from sceneql.words.objects.union import Union

NOW = FakeMoment()
AT, TURN = (0.2, -1.1, 0.3), (0.8, 0.3, -0.4, 0.33)
PLACED = {"position": const(AT), "rotation": const(TURN)}
RADIUS = math.sqrt(1.0 - 0.3 ** (1 / 3))
"""Of the ball that one kernel of radius 1 is at the threshold 0.3."""
CUBE = trimesh.creation.box()
LENGTHS = st.floats(0.1, 3.0)
TURNS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)
PLACES = st.tuples(*[st.floats(-5.0, 5.0)] * 3)


def squares(volume, x, y, z):
    """Inertia about the center by the means of the squares of the coordinates."""
    return volume * np.diag([y + z, z + x, x + y])


def ring(R, r):
    volume = 2 * math.pi**2 * R * r * r
    return volume, volume * np.diag([R * R / 2 + 5 / 8 * r * r, R * R + 3 / 4 * r * r, R * R / 2 + 5 / 8 * r * r])


def capsule(r, length):
    """About its middle, along x: as tables of mechanics have it."""
    column, half = math.pi * r * r * length, 2 / 3 * math.pi * r**3
    along = column * r * r / 2 + 2 * half * 2 / 5 * r * r
    middle = length * length / 4 + 3 / 8 * r * length
    across = column * (length * length / 12 + r * r / 4) + 2 * half * (2 / 5 * r * r + middle)
    return column + 2 * half, np.diag([along, across, across])


def ball(r):
    volume = 4 / 3 * math.pi * r**3
    return volume, 2 / 5 * volume * r * r * np.eye(3)


SOLIDS = {
    "sphere": (lambda **at: Sphere(radius=const(0.7), **at), *ball(0.7)),
    "box": (lambda **at: Box(size=const([1.0, 0.6, 1.4]), **at), 0.84, squares(0.84, 1 / 12, 0.03, 1.96 / 12)),
    "cylinder": (
        lambda **at: Cylinder(radius=const(0.4), height=const(0.9), **at),
        math.pi * 0.16 * 0.9,
        squares(math.pi * 0.16 * 0.9, 0.04, 0.0675, 0.04),
    ),
    "torus": (lambda **at: Torus(radius=const(1.0), tube=const(0.4), **at), *ring(1.0, 0.4)),
}


def by_cells(solid, moment=NOW):
    """Properties by the field with 16, 32 and 64 cells."""
    return [of_moments(by_field(solid, moment, cells)) for cells in (16, 32, 64)]


def order(errors):
    """The order by which errors fall as cells are halved."""
    return math.log2(errors[0] / errors[-1]) / (len(errors) - 1)


@pytest.mark.parametrize("name", SOLIDS)
def test_closed_forms_are_exact_at_any_place(name):
    made, volume, inertia = SOLIDS[name]
    found, turn = properties(made(**PLACED), NOW), rotation_matrix(TURN)
    assert found.exact
    assert found.volume == pytest.approx(volume, rel=1e-14)
    assert found.center == pytest.approx(AT, abs=1e-15)
    assert found.inertia == pytest.approx(turn @ inertia @ turn.T, abs=1e-14 * np.trace(inertia))


@pytest.mark.parametrize("name", SOLIDS)
def test_closed_forms_agree_with_the_fields(name):
    made, _, _ = SOLIDS[name]
    exact, found = properties(made(**PLACED), NOW), of_moments(by_field(made(**PLACED), NOW, 32))
    assert not found.exact
    assert found.volume == pytest.approx(exact.volume, rel=1e-5)
    assert found.center == pytest.approx(exact.center, abs=1e-5)
    assert found.inertia == pytest.approx(exact.inertia, abs=1e-5 * np.trace(exact.inertia))


def test_a_tube_through_two_points_is_a_capsule():
    a, b = np.array([0.3, 0.1, -0.2]), np.array([0.9, -0.7, 0.4])
    volume, inertia = capsule(0.25, float(np.linalg.norm(b - a)))
    axis = (b - a) / np.linalg.norm(b - a)
    for closed in (False, True):
        found = properties(Tube(through=const([a, b]), radius=const(0.25), closed=closed), NOW)
        assert found.volume == pytest.approx(volume, rel=1e-14)
        assert found.center == pytest.approx((a + b) / 2, abs=1e-15)
        whole = inertia[1, 1] * np.eye(3) + (inertia[0, 0] - inertia[1, 1]) * np.outer(axis, axis)
        assert found.inertia == pytest.approx(whole, abs=1e-15)
    point = properties(Tube(through=const([a, a]), radius=const(0.25)), NOW)
    assert point.inertia == pytest.approx(ball(0.25)[1], abs=1e-16)
    bent = properties(Tube(through=const([a, b, a + 1.0]), radius=const(0.25)), NOW)
    assert bent.error.volume > 0.0


def test_a_torus_without_a_hole_is_measured_by_its_field():
    horn, spindle = (Torus(radius=const(0.4), tube=const(tube)) for tube in (0.4, 0.5))
    assert properties(horn, NOW).volume == pytest.approx(2 * math.pi**2 * 0.064, rel=1e-14)
    found = properties(spindle, NOW, 32)
    # Pappus's theorem for the part of the disk on one side of the axis.
    angle = math.acos(-0.8)
    exact = 2 * math.pi * (0.4 * 0.25 * (angle + 0.8 * 0.6) + 2 / 3 * 0.3**3)
    assert found.volume == pytest.approx(exact, rel=2e-5)
    assert abs(found.volume - exact) < 2.0 * found.error.volume


def test_a_torus_and_a_blob_of_one_kernel_by_their_fields_converge_with_order_four_or_more():
    blob = Blobby(points=const([[0.1, 0.2, 0.3]]), radius=const(1.0))
    for solid, (volume, inertia) in ((SOLIDS["torus"][0](), ring(1.0, 0.4)), (blob, ball(RADIUS))):
        runs = by_cells(solid)
        sizes = [abs(run.volume / volume - 1.0) for run in runs]
        turns = [float(np.abs(run.inertia - inertia).max() / inertia.max()) for run in runs]
        assert max(sizes[2], turns[2]) < 1e-9  # at 64 cells
        assert min(order(sizes), order(turns)) > 5.5
        for run, size, turn in list(zip(runs, sizes, turns, strict=True))[1:]:
            assert size * volume < run.error.volume
            assert turn * inertia.max() < run.error.inertia
        assert runs[-1].center == pytest.approx([0.1, 0.2, 0.3] if solid is blob else 0.0, abs=1e-10)


def test_a_box_less_a_cylinder_is_good_to_a_hundred_thousandth():
    parts = {
        "block": Box(size=const([1.0, 0.8, 0.9])),
        "hole": Cylinder(radius=const(0.3), height=const(2.0), position=const([0.1, 0.0, 0.0])),
    }
    moment = FakeMoment(parts=parts)
    block, hole = 0.72, math.pi * 0.09 * 0.8
    volume = block - hole
    center = np.array([-0.1 * hole / volume, 0.0, 0.0])
    inertia = squares(block, 1 / 12, 0.64 / 12, 0.81 / 12) + block * center[0] ** 2 * np.diag([0, 1, 1])
    inertia -= squares(hole, 0.0225, 0.64 / 12, 0.0225) + hole * (0.1 - center[0]) ** 2 * np.diag([0, 1, 1])
    turned = rotation_matrix(TURN)
    for at, turn, place, cells in (({}, np.eye(3), np.zeros(3), 64), (PLACED, turned, np.array(AT), 24)):
        found = properties(Difference(of=(Ref("block"), Ref("hole")), **at), moment, cells)
        assert found.volume == pytest.approx(volume, rel=1e-6 if cells == 64 else 1e-5)
        assert found.center == pytest.approx(place + turn @ center, abs=2e-6)
        assert found.inertia == pytest.approx(turn @ inertia @ turn.T, abs=5e-6 * np.trace(inertia))
        assert abs(found.volume - volume) < found.error.volume < 1e-4
        assert np.linalg.norm(found.inertia - turn @ inertia @ turn.T) < found.error.inertia < 1e-4


@pytest.mark.parametrize(
    ("text", "volume"), [("max(x^2 + z^2, y^2 + z^2) - 0.25", 2 / 3), ("abs(x) + abs(y) + abs(z) - 0.6", 0.288)]
)
def test_creases_and_corners_of_formulas_are_met(text, volume):
    solid = Implicit(field=formula(text), bounds=Within(box=((-0.7, -0.7, -0.7), (0.7, 0.7, 0.7))))
    assert properties(solid, NOW, 32).volume == pytest.approx(volume, rel=1e-5)


@pytest.mark.parametrize("far", [0.0, 2.0**20])
def test_polyhedra_are_exact_near_and_far_from_the_origin(far):
    # Powers of two: the corners lie at the same places from one another, wherever they are.
    corners = np.array(list(product((0.0, 1.0), (0.0, 0.5), (0.0, 2.0)))) + far
    block = trimesh.convex.convex_hull(corners - far)
    found = of_moments(polyhedra.moments(block.vertices + far, block.faces))
    assert found.volume == pytest.approx(1.0, rel=1e-13)
    assert found.center == pytest.approx(far + np.array([0.5, 0.25, 1.0]), rel=1e-15)
    assert found.inertia == pytest.approx(squares(1.0, 1 / 12, 1 / 48, 1 / 3), abs=1e-13)
    simplex = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + far
    found = of_moments(polyhedra.moments(simplex, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])))
    assert found.volume == pytest.approx(1 / 6, rel=1e-13)
    assert found.center == pytest.approx(far + np.full(3, 0.25), rel=1e-15)
    # The integrals of x^2 and x y over it are 1/60 and 1/120.
    assert found.inertia == pytest.approx(np.full((3, 3), 1 / 480) + (1 / 80 - 1 / 480) * np.eye(3), abs=1e-14)


SHAPES = {
    "icosphere": trimesh.creation.icosphere(subdivisions=2),
    "annulus": trimesh.creation.annulus(r_min=0.3, r_max=0.5, height=1.2),
    "hull": trimesh.convex.convex_hull(np.random.default_rng(3).normal(size=(40, 3))),
    "shell": trimesh.util.concatenate(
        [trimesh.creation.icosphere(radius=1.0), trimesh.Trimesh(0.4 * CUBE.vertices + 0.2, CUBE.faces[:, ::-1])]
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_meshes_have_the_values_of_trimesh(name, tmp_path):
    mesh = SHAPES[name].copy()
    mesh.density = 1.0
    found = of_moments(polyhedra.moments(np.array(mesh.vertices), np.array(mesh.faces)))
    assert found.volume == pytest.approx(mesh.volume, rel=1e-13)
    assert found.center == pytest.approx(mesh.center_mass, abs=1e-13)
    assert found.inertia == pytest.approx(mesh.moment_inertia, abs=1e-12)
    mesh.export(tmp_path / "a.ply")
    solid = Mesh(file=str(tmp_path / "a.ply"), scale=const(0.5), **PLACED)
    placed, turn = properties(solid, NOW), rotation_matrix(TURN)
    assert placed.volume == pytest.approx(found.volume / 8, rel=1e-6)  # the file has single precision
    assert placed.center == pytest.approx(np.array(AT) + turn @ found.center / 2, abs=1e-6)
    assert placed.inertia == pytest.approx(turn @ found.inertia @ turn.T / 32, abs=1e-6)


def test_meshes_that_enclose_nothing_are_told(tmp_path):
    sphere = SHAPES["icosphere"]
    made = {
        "closed: 1 hole of 3 edges": trimesh.Trimesh(sphere.vertices, sphere.faces[1:]),
        "closed: .* opposite ways": trimesh.Trimesh(
            sphere.vertices, np.concatenate([sphere.faces[:1, ::-1], sphere.faces[1:]]), process=False
        ),
        "turned inside out: it encloses -": trimesh.Trimesh(sphere.vertices, sphere.faces[:, ::-1], process=False),
        "encloses no volume": trimesh.Trimesh(sphere.vertices * [1, 1, 0], sphere.faces, process=False),
    }
    for text, mesh in made.items():
        mesh.export(tmp_path / "a.off")
        with pytest.raises(ValueError, match=text):
            properties(Mesh(file=str(tmp_path / "a.off")), NOW)


def test_a_slit_of_no_width_leaves_a_mesh_closed():
    # One side's edge has a vertex in its middle that its neighbor lacks.
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0, 0]])
    faces = np.array([[0, 2, 4], [4, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert polyhedra.moments(corners, faces).volume == pytest.approx(1 / 6, rel=1e-15)


def test_what_has_no_inside_no_end_or_no_volume_is_told():
    small = Implicit(field=formula("1 + x^2"))
    for solid, kind, text in (
        (Plane(), TypeError, "unbounded, and cannot be weighed"),
        (Group(children={}), ValueError, "a group of nothing|empty"),
        (small, ValueError, "empty, or smaller than cells"),
    ):
        with pytest.raises(kind, match=text):
            properties(solid, NOW)


def test_walls_thinner_than_cells_are_told_as_errors():
    exact = 4 * math.pi * 0.7**2 * 1e-3
    found = properties(Implicit(field=formula("abs(sqrt(x^2 + y^2 + z^2) - 0.7) - 0.0005")), NOW)
    assert abs(found.volume - exact) > 0.5 * exact
    assert found.error.volume > abs(found.volume - exact)


def test_equal_solids_are_measured_once(monkeypatch):
    from sceneql.mesh import curved_moments

    runs = []

    def counted(*arguments):
        runs.append(arguments)
        return measure(*arguments)

    measure = curved_moments.curved_moments
    monkeypatch.setattr(curved_moments, "curved_moments", counted)
    egg = formula("x^2 + 2*y^2 + 3*z^2 - 0.5")
    found = [properties(Implicit(field=egg, position=const([k, 0, 0])), NOW, 8) for k in range(4)]
    assert len(runs) == 2
    assert [one.center[0] for one in found] == pytest.approx([0, 1, 2, 3], abs=1e-3)


def test_groups_and_unions_of_what_stands_apart_are_exact():
    parts = {
        "head": Box(size=const([0.4, 0.2, 0.2]), position=const([0.0, 1.1, 0.0])),
        "shaft": Cylinder(radius=const(0.05), height=const(1.0), position=const([0.0, 0.5, 0.0])),
        "near": Sphere(radius=const(0.2), position=const([0.0, 1.1, 0.0])),
    }
    moment = FakeMoment(parts=parts)
    head, shaft = 0.016, math.pi * 0.0025
    y = (1.1 * head + 0.5 * shaft) / (head + shaft)
    about = squares(head, 0.16 / 12, 0.04 / 12, 0.04 / 12) + squares(shaft, 0.0025 / 4, 1 / 12, 0.0025 / 4)
    about += (head * (1.1 - y) ** 2 + shaft * (0.5 - y) ** 2) * np.diag([1, 0, 1])
    for solid in (Group(children=(Ref("head"), Ref("shaft"))), Union(of=(Ref("head"), Ref("shaft")))):
        found = properties(solid, moment)
        assert found.exact
        assert found.volume == pytest.approx(head + shaft, rel=1e-14)
        assert found.center == pytest.approx([0, y, 0], abs=1e-15)
        assert found.inertia == pytest.approx(about, abs=1e-15)
    blended = Union(of=(Ref("head"), Ref("shaft")), blend=const(0.1))
    assert properties(blended, moment, 16).volume > head + shaft + 1e-5
    joined = properties(Group(children=(Ref("head"), Ref("near"))), moment, 16)
    assert joined.volume < head + ball(0.2)[0]  # what both hold counts once
    assert not joined.exact
    assert properties(Polygonised(of=Ref("shaft")), moment).volume == pytest.approx(shaft, rel=1e-14)


def test_a_stretched_ball_is_an_ellipsoid():
    moment = FakeMoment(parts={"ball": Sphere(radius=const(0.5), position=const([1.0, 0.0, 0.0]))})
    found = properties(Group(children=(Ref("ball"),), scale=const([0.4, 2.0, 1.2])), moment)
    volume = 4 / 3 * math.pi * 0.2 * 1.0 * 0.6
    assert found.volume == pytest.approx(volume, rel=1e-14)
    assert found.center == pytest.approx([0.4, 0, 0], abs=1e-15)
    assert found.inertia == pytest.approx(squares(volume, 0.04 / 5, 0.2, 0.36 / 5), abs=1e-14)


@settings(max_examples=50, deadline=None)
@given(sides=st.tuples(LENGTHS, LENGTHS, LENGTHS), share=st.floats(0.1, 0.9), turn=TURNS, at=PLACES)
def test_parts_of_a_box_together_are_the_box(sides, share, turn, at):
    a, b, c = sides
    halves = []
    for low, high in ((0.0, share * a), (share * a, a)):
        block = VolumeMoments.centered((high - low) * b * c, ((high - low) ** 2 / 12, b * b / 12, c * c / 12))
        halves.append(block.mapped(affine(((low + high - a) / 2, 0, 0), (1, 0, 0, 0))).mapped(affine(at, turn)))
    whole = VolumeMoments.joined(halves)
    exact = moments_of(Box(size=const(sides), position=const(at), rotation=const(turn)), NOW)
    assert whole.volume == pytest.approx(exact.volume, rel=1e-13)
    assert whole.center == pytest.approx(exact.center, abs=1e-13)
    assert whole.second == pytest.approx(exact.second, abs=1e-12 * np.trace(exact.second))


@settings(max_examples=50, deadline=None)
@given(
    linear=st.lists(st.floats(-2.0, 2.0, allow_subnormal=False), min_size=9, max_size=9),
    at=PLACES,
    mirrored=st.booleans(),
)
def test_moments_follow_any_affine_map_also_one_that_mirrors(linear, at, mirrored):
    place = np.column_stack([np.reshape(linear, (3, 3)), at])
    assume(abs(np.linalg.det(place[:, :3])) > 0.1)
    if mirrored:
        place[:, 0] *= -1.0
    hull = SHAPES["hull"]
    faces = hull.faces if np.linalg.det(place[:, :3]) > 0 else hull.faces[:, ::-1]
    exact = polyhedra.moments(apply(place, hull.vertices), faces)
    found = polyhedra.moments(np.array(hull.vertices), hull.faces).mapped(place)
    assert found.volume == pytest.approx(exact.volume, rel=1e-11)
    assert found.center == pytest.approx(exact.center, abs=1e-11)
    assert found.second == pytest.approx(exact.second, abs=1e-11 * np.trace(exact.second))


@settings(max_examples=50, deadline=None)
@given(sides=st.tuples(LENGTHS, LENGTHS, LENGTHS), turn=TURNS, factor=st.floats(0.1, 10.0))
def test_turning_and_scaling_change_inertia_as_they_should(sides, turn, factor):
    plain = properties(Box(size=const(sides)), NOW)
    moment = FakeMoment(parts={"box": Box(size=const(sides), rotation=const(turn))})
    found = properties(Group(children=(Ref("box"),), scale=const(factor)), moment)
    R = rotation_matrix(turn)
    assert found.volume == pytest.approx(factor**3 * plain.volume, rel=1e-13)
    whole = factor**5 * R @ plain.inertia @ R.T
    assert found.inertia == pytest.approx(whole, abs=1e-13 * np.trace(whole))
    values, axes = principal(found.inertia)
    assert values == pytest.approx(factor**5 * np.sort(np.diag(plain.inertia)), rel=1e-11)
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=1e-13)
    assert axes @ np.diag(values) @ axes.T == pytest.approx(found.inertia, abs=1e-13 * np.trace(whole))
    assert impossible(values) == ""


def test_errors_of_parts_bound_those_of_the_whole():
    rng = np.random.default_rng(5)
    for _ in range(50):
        parts, off = [], []
        for _ in range(3):
            root = rng.normal(size=(3, 3))
            true = VolumeMoments(float(rng.uniform(0.5, 2.0)), rng.normal(size=3), root @ root.T)
            error = tuple(1e-6 * rng.uniform(size=3))
            aside, turned = rng.normal(size=3), rng.normal(size=(3, 3))
            away = error[1] * aside / np.linalg.norm(aside), error[2] * turned / np.linalg.norm(turned)
            parts.append(VolumeMoments(true.volume, true.center, true.second, error))
            off.append(VolumeMoments(true.volume + error[0], true.center + away[0], true.second + away[1]))
        place = affine(rng.normal(size=3), rng.normal(size=4), rng.uniform(0.2, 2.0, size=3))
        told, moved = (VolumeMoments.joined(some).mapped(place) for some in (parts, off))
        assert abs(moved.volume - told.volume) <= 1.0001 * told.error[0]
        assert np.linalg.norm(moved.center - told.center) <= 1.0001 * told.error[1]
        assert np.linalg.norm(moved.second - told.second) <= 1.0001 * told.error[2]
        assert (
            np.linalg.norm(of_moments(moved).inertia - of_moments(told).inertia) <= 1.0001 * of_moments(told).error[2]
        )


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((1.0, 2.0, 3.0), ""),
        ((2.0, 2.0, 2.0), ""),
        ((0.1, 0.2, 0.30000000000000004), ""),
        ((5.0, 1.0, 3.0), "the largest, 5, is above the sum of the others, 4"),
        ((1.0, 1.0, 2.1), "above the sum"),
        ((0.0, 0.0, 0.0), "above 0"),
        ((-1.0, 2.0, 2.0), "above 0"),
        ((1.0, 2.0, math.inf), "above 0"),
        ((1.0, math.nan, 2.0), "above 0"),
        ((0.0, 1.0, 1.0), "a line"),
    ],
)
def test_inertia_that_no_body_has_is_told(values, text):
    found = impossible(values)
    assert (text in found) if text else not found
