"""Laws of folds: no triangle faces inward of its own mesh, and those that do are found."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import LONG, examples
from meshes import (
    BALL,
    CLOSED,
    PART,
    STEINER,
    TORUS,
    TURN,
    TURNED,
    assert_closed_manifold,
    cut,
    cut_finer,
    cut_sharp,
    tape_of,
)
from random_tapes import tapes
from sceneql.field.tape.tape_solid import field_gradients, field_values
from sceneql.mesh.bounded import bounded
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.cubes.refine import refined
from sceneql.mesh.dual.sharp import polygonise_sharp
from sceneql.mesh.measures import edge_counts, euler_characteristic, volume
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.flips import facing
from sceneql.mesh.repair.folds import folds, told, winding
from sceneql.mesh.repair.self_intersections import self_intersections


@pytest.mark.parametrize("name", CLOSED)
def test_closed_smooth_shapes_are_closed_manifolds_facing_outward(name):
    text, half, euler = CLOSED[name]
    found = cut(text, half, 64)
    assert edge_counts(found.triangles)[1:] == (0, 0)
    assert euler_characteristic(found.triangles) == euler
    a, b, c = (found.vertices[found.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    outward = field_gradients(tape_of(text), (a + b + c) / 3)
    assert ((across * outward).sum(axis=1) > 0).all()


@pytest.mark.parametrize("way", ["refined", "sharp"])
@pytest.mark.parametrize("cells", [12, 20, 24, 32, 38])
def test_coarse_cells_leave_no_triangle_facing_inward(way, cells):
    # Where coarse triangles follow fine curves, and where a quad's corners lie past one another, some folded over.
    for text, half, euler in (CLOSED["tanglecube"], CLOSED["torus"]):
        found = cut_finer(text, half, cells)[0] if way == "refined" else cut_sharp(text, half, cells)
        assert_closed_manifold(found)
        assert euler_characteristic(found.triangles) == euler
        assert facing(tape_of(text), found.vertices[found.triangles]).min() > 0.0
        if way == "refined":
            steep = np.linalg.norm(field_gradients(tape_of(text), found.vertices), axis=1)
            assert (np.abs(field_values(tape_of(text), found.vertices)) / steep).max() < 1e-6 * half


CREASED = {  # formulas that meet themselves or their ball at sharp angles, half sides of their boxes
    "cayley": ("max(4*(x^2 + y^2 + z^2) + 16*x*y*z - 1, sqrt(x^2 + y^2 + z^2) - 1.15)", 1.15),
    "kummer": (
        "max((x^2 + y^2 + z^2 - 1.3)^2 - 2.9/1.7*((1 - z)^2 - 2*x^2)*((1 + z)^2 - 2*y^2), sqrt(x^2 + y^2 + z^2) - 2)",
        2.0,
    ),
    "gyroid": ("max(sin(9*x)*cos(9*y) + sin(9*y)*cos(9*z) + sin(9*z)*cos(9*x), sqrt(x^2 + y^2 + z^2) - 1)", 1.0),
    "wedges": ("max(max(0.9*x - y, 0.9*x + y - 0.3*z), max(abs(z) - 0.8, -x - 0.9))", 1.0),
}


@pytest.mark.parametrize("name", ["torus", "tanglecube"])
def test_a_mesh_goes_around_what_is_inside_and_nothing_else(name):
    text, half, _ = CLOSED[name]
    found = cut(text, half, 40)
    points = np.random.default_rng(0).uniform(-half, half, (400, 3))
    around = winding(points, found.vertices, found.triangles)
    assert ((around == 1) == (field_values(tape_of(text), points) < 0.0)).all()
    assert set(around) == {0, 1}
    turned = winding(points, found.vertices, found.triangles[:, ::-1].copy())
    assert (turned == -around).all()


@pytest.mark.parametrize("name", CREASED)
def test_triangles_across_a_crease_part_inside_from_outside_though_the_gradient_is_of_one_face(name):
    text, half = CREASED[name]
    whole = bounded(tape_of(text), (-half,) * 3, (half,) * 3)
    against = 0
    for cells in (48, 64):
        found = cut(text, half, cells)
        against += (facing(whole, found.vertices[found.triangles]) < 0.0).sum()
        assert not len(folds(whole, found))
    assert against > 0


SELF_CROSSING = {
    "steiner": (STEINER, 0.6),
    "barth sextic": (
        "max(4.23606797749979*(x^2 + y^2 + z^2 - 1)^2 - 4*(2.618033988749895*x^2 - y^2)"
        "*(2.618033988749895*y^2 - z^2)*(2.618033988749895*z^2 - x^2), sqrt(x^2 + y^2 + z^2) - 2)",
        2.04,
    ),
    "lattice": (
        "max(abs(sin(9*x)*cos(9*y) + sin(9*y)*cos(9*z) + sin(9*z)*cos(9*x)) - 0.3, sqrt(x^2 + y^2 + z^2) - 1)",
        1.0,
    ),
    # Thousands of folds at once, which were too many to be looked at.
    "planes": ("max(abs(sin(25*x))*abs(sin(25*y))*abs(sin(25*z)) - 0.01, sqrt(x^2 + y^2 + z^2) - 1)", 1.0),
}


@pytest.mark.parametrize("name", [*CREASED, *SELF_CROSSING])
def test_sharp_polygons_fold_nowhere_though_sheets_are_nearer_than_cells(name):
    text, half = (CREASED | SELF_CROSSING)[name]
    whole = bounded(tape_of(text), (-half,) * 3, (half,) * 3)
    for cells in (48, 64) if LONG else (48,):
        found = cut_sharp(text, half, cells)
        assert_closed_manifold(found)
        assert not len(folds(whole, found))


def test_corners_that_pass_one_another_on_an_edge_are_put_in_order_along_it():
    # Turned so, 3 of the cube's edges cut corners off cells whose planes put vertices on them in the wrong order.
    whole = bounded(tape_of(TURNED), (-1.3,) * 3, (1.3,) * 3)
    for cells in (20, 33, 48, 51, 64, 96):
        found = cut_sharp(TURNED, 1.3, cells)
        assert not len(folds(whole, found))
        assert ((np.abs(np.abs(found.vertices @ TURN.T) - 0.7) < 1e-6).sum(axis=1) >= 1).all()
        assert volume(found.vertices, found.triangles) == pytest.approx(1.4**3, abs=1e-9)


def test_many_rays_through_a_mesh_take_little_memory():
    found = cut(TORUS, 1.5, 24)
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (40_000, 3))
    tracemalloc.start()
    around = winding(points, found.vertices, found.triangles)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert set(around) == {0, 1}
    assert most < 2**26


def test_triangles_that_pass_through_others_are_found_with_them():
    # A triangle across one side of another, one beside it, and one that shares a corner with the first.
    places = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, -1], [0.2, 0.2, 1], [-1, -1, 0], [5, 5, 5], [6, 5, 5], [5, 6, 5],
         [0.3, 0.1, 1.0], [0.1, 0.3, -1.0]], dtype=float,
    )  # fmt: skip
    triangles = np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8], [0, 9, 10]], dtype=np.int32)
    first, other = self_intersections(places, triangles, np.array([0]))
    assert set(first) == {0}
    assert set(other) == {1, 3}


def test_a_corner_pushed_through_the_mesh_is_found_folded():
    found = cut(BALL, 1.1, 20)
    assert not len(folds(tape_of(BALL), found))
    vertices = found.vertices.copy()
    beside = np.setdiff1d(found.triangles[(found.triangles == 0).any(axis=1)], [0])
    vertices[0] += 3.0 * (vertices[beside[0]] - vertices[0])
    turned = facing(tape_of(BALL), vertices[found.triangles]) < 0.0
    assert turned.any()
    assert (folds(tape_of(BALL), Polygons(vertices, found.triangles, found.normals)) == np.flatnonzero(turned)).all()


@settings(max_examples=examples(150))
@given(tape=tapes(), cell=st.sampled_from([0.13, 0.25, 0.4]))
def test_any_field_whatever_gives_a_closed_manifold_of_finite_vertices(tape, cell):
    found = polygonise(tape, (-1.5,) * 3, (1.5,) * 3, cell)
    assert edge_counts(found.triangles)[1:] == (0, 0)
    assert np.isfinite(found.vertices).all()
    assert np.isfinite(found.normals).all()
    assert len(np.unique(found.triangles)) == len(found.vertices)
    assert np.abs(found.vertices).max(initial=0.0) <= 1.5 + 1e-6
    assert volume(found.vertices, found.triangles) >= -1e-9


@pytest.mark.parametrize(
    ("text", "half", "euler"), [*CLOSED.values(), (PART, 1.0, -4)], ids=[*CLOSED, "part of three bores"]
)
def test_sharp_meshes_are_closed_manifolds_whose_vertices_lie_on_the_surface(text, half, euler):
    found = cut_sharp(text, half, 48)
    assert_closed_manifold(found)
    assert euler_characteristic(found.triangles) == euler
    steep = np.linalg.norm(field_gradients(tape_of(text), found.vertices), axis=1)
    assert (np.abs(field_values(tape_of(text), found.vertices)) / steep).max() < 1e-6


@settings(max_examples=60)
@given(tape=tapes(), cell=st.sampled_from([0.13, 0.25, 0.4]))
def test_any_field_whatever_gives_a_closed_sharp_manifold_of_finite_vertices(tape, cell):
    found = polygonise_sharp(tape, (-1.5,) * 3, (1.5,) * 3, cell)
    assert_closed_manifold(found)
    assert np.isfinite(found.vertices).all()
    assert len(np.unique(found.triangles)) == len(found.vertices)
    lengths = np.linalg.norm(found.normals, axis=1)
    assert ((np.abs(lengths - 1.0) < 1e-9) | (lengths == 0.0)).all()


@pytest.mark.parametrize("text", ["floor(x + 0.5)", "x/0"])
def test_folds_of_a_field_that_jumps_leave_a_closed_manifold(text):
    """Flips went on to the rim of what is looked at, and made an edge that was there beyond it."""
    assert_closed_manifold(refined(tape_of(text), (-1.5,) * 3, (1.5,) * 3, 0.3, 3e-3)[0])


@settings(max_examples=examples(40))
@given(tape=tapes(), cell=st.sampled_from([0.3, 0.5]), tolerance=st.sampled_from([None, 3e-3, 0.03]))
def test_any_field_whatever_gives_a_closed_manifold_when_refined(tape, cell, tolerance):
    found, left = refined(tape, (-1.5,) * 3, (1.5,) * 3, cell, tolerance)
    assert_closed_manifold(found)
    assert np.isfinite(found.vertices).all()
    assert np.isfinite(left.volume)


def test_walls_at_which_a_field_jumps_are_no_folds():
    """Thousands were told, since the gradient beside a step knows nothing of it."""
    found, _ = cut_finer(stairs := "max(z - 0.2*floor(5*x), abs(x) - 0.5, abs(y) - 0.5, abs(z) - 0.9)", 1.0, 24)
    assert_closed_manifold(found)
    rows = told(bounded(tape_of(stairs), (-1.0,) * 3, (1.0,) * 3), found)
    corners = found.vertices[found.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outside, inside = (field_values(tape_of(stairs), corners.mean(axis=1) + step * across) for step in (0.1, -0.1))
    rightly = (inside < 0.0) & (outside >= 0.0)
    assert not rightly[rows].any()
    assert len(rows) < 10
