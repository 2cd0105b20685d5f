"""Laws of meshes' topology: edges kept sharp change none of it; folds on smooth solids are found and mended."""

import numpy as np
import pytest

from meshes import BALL, STEINER, assert_closed_manifold, cut_finer, tape_of
from sceneql.field.tape.tape_solid import field_values, many_gradients
from sceneql.frame import Implicit, Surface
from sceneql.mesh.bounded import bounded
from sceneql.mesh.cubes import refine
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.cubes.unresolved import unresolved
from sceneql.mesh.dual.kept_sharp import kept_sharp
from sceneql.mesh.measures import euler_by_piece, euler_characteristic, volume
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.collapse import collapsed
from sceneql.mesh.repair.folds import folds, overturned
from sceneql.report import surface_measures

TWO_CUBES = "min(max(abs(x-0.35), abs(y-0.35), abs(z)), max(abs(x+0.35), abs(y+0.35), abs(z))) - 0.35"
LATTICE = "abs(sin(6*x)*cos(6*y+0.785) + sin(6*y+0.785)*cos(6*z) + sin(6*z)*cos(6*x)) - 0.34 + 0.156*y"
TOUCHING = {  # formulas of solids that touch themselves or nearly do, half sides of their boxes, cells along these
    "two cubes along an edge": (TWO_CUBES, 0.9, 64),
    "lattice": (f"max({LATTICE}, abs(x) - 1, abs(y) - 1, abs(z) - 1)", 1.01, 28),
    "cayley": ("max(4*(x^2 + y^2 + z^2) + 16*x*y*z - 1, sqrt(x^2 + y^2 + z^2) - 1.15)", 1.15, 32),
    "two balls": ("min(sqrt((x-0.5)^2 + y^2 + z^2), sqrt((x+0.5)^2 + y^2 + z^2)) - 0.5", 1.1, 32),
}
SEXTIC = "6.7*(x^2+y^2+z^2-1)^2 - 4*(2.618*x^2-y^2)*(2.618*y^2-z^2)*(2.618*z^2-x^2)"
SHEET = (
    "sqrt(max(abs(sin(9*x)*cos(9*y) + sin(9*y)*cos(9*z) + sin(9*z)*cos(9*x))/14 - 0.01, 0)^2"
    " + max(sqrt(x^2 + y^2 + z^2) - 0.93, 0)^2) - "
)


@pytest.mark.parametrize("name", TOUCHING)
def test_sharp_meshes_have_the_topology_of_others(name):
    text, half, cells = TOUCHING[name]
    box = tape_of(text), (-half,) * 3, (half,) * 3, 2 * half / cells
    sharp, _ = kept_sharp(*box)
    assert_closed_manifold(sharp)
    assert euler_by_piece(sharp.triangles) == euler_by_piece(cut_finer(text, half, cells)[0].triangles)
    assert not len(folds(bounded(*box[:3]), sharp))


@pytest.mark.parametrize(
    ("text", "cells", "pieces"),
    [
        ("max(40*(abs(sqrt(x^2+y^2+z^2) - 0.875) - 0.025), sqrt(x^2+y^2+z^2) - 0.9125)", 50, [2, 2]),
        ("max(40*(abs(sqrt(x^2+y^2+z^2) - 0.875) - 0.025), sqrt(x^2+y^2+z^2) - 0.9125)", 60, [2, 2]),
        ("max(sqrt(x^2+y^2+z^2) - 0.9, 20*(abs(x + 0.4*y + 0.3*z) - 0.02))", 56, [2]),
    ],
)
def test_sheets_that_another_field_cuts_are_not_torn(text, cells, pieces):
    """Near the cut, values inside are those of the distance to it, which say nothing of how thick the sheet is."""
    found = polygonise(tape_of(text), (-1.0,) * 3, (1.0,) * 3, 2.0 / cells)
    assert_closed_manifold(found)
    assert euler_by_piece(found.triangles) == pieces
    assert not len(overturned(bounded(tape_of(text), (-1.0,) * 3, (1.0,) * 3), found))


def test_cubes_that_touch_are_two_with_their_edges_and_corners():
    sharp, _ = kept_sharp(tape_of(TWO_CUBES), (-0.9,) * 3, (0.9,) * 3, 1.8 / 64)
    assert euler_by_piece(sharp.triangles) == [2, 2]
    assert volume(sharp.vertices, sharp.triangles) == pytest.approx(2 * 0.7**3, abs=1e-12)
    assert np.abs(field_values(tape_of(TWO_CUBES), sharp.vertices)).max() < 1e-12


@pytest.mark.parametrize(("rim", "cells"), [(0.006, 16), (0.03, 24), (0.003, 32)])
def test_smooth_solids_whose_rims_are_as_small_as_cells_have_no_folds(rim, cells):
    found, _ = cut_finer(f"{SHEET}{rim}", 0.5, cells)
    assert_closed_manifold(found)
    assert not len(overturned(bounded(tape_of(f"{SHEET}{rim}"), (-0.5,) * 3, (0.5,) * 3), found))
    assert euler_characteristic(found.triangles) == -38
    assert len(found.triangles) < 2**18


def test_folds_at_the_rims_of_cones_are_mended_without_a_change_of_topology(monkeypatch):
    radius, cells = 1.3, 48
    text, half = f"max({SEXTIC}, sqrt(x^2 + y^2 + z^2) - {radius})", 1.02 * radius
    whole = bounded(tape_of(text), (-half,) * 3, (half,) * 3)
    monkeypatch.setattr(refine, "_turns_much", lambda *_: False)  # cells of half the side, which it gets, fold nowhere
    found, _ = cut_finer(text, half, cells)
    assert_closed_manifold(found)
    assert not len(overturned(whole, found))
    monkeypatch.setattr(refine, "unfolded", lambda tape, polygons: polygons)
    folded, _ = cut_finer(text, half, cells)
    assert len(overturned(whole, folded)) > 0
    assert euler_characteristic(folded.triangles) == euler_characteristic(found.triangles)


def test_rims_of_cones_are_cut_by_fine_cells_that_fold_nowhere(monkeypatch):
    """The middles of fans beside rims went to the face beyond."""
    monkeypatch.setattr(refine, "unfolded", lambda tape, polygons: polygons)
    text, half = f"max({SEXTIC}, sqrt(x^2 + y^2 + z^2) - 1.6)", 1.632
    found, _ = cut_finer(text, half, 60)
    whole = bounded(tape_of(text), (-half,) * 3, (half,) * 3)
    assert not len(overturned(whole, found))
    middles = found.vertices[found.triangles].mean(axis=1)
    off = np.abs(field_values(whole, middles)) / np.linalg.norm(many_gradients(whole, middles), axis=1)
    assert off.max() < 0.1 * 2 * half / 60


def test_lines_along_which_a_solid_touches_itself_give_no_slivers():
    """Fine nodes that lay a rounding error beside the double lines had a negative f."""
    found, _ = cut_finer(STEINER, 0.612, 64)
    assert euler_by_piece(found.triangles) == [2, 2, 2, 2]


def test_edges_are_collapsed_at_folds_alone_and_leave_the_topology():
    found = polygonise(tape_of(BALL), (-1.1,) * 3, (1.1,) * 3, 0.22)
    whole = bounded(tape_of(BALL), (-1.1,) * 3, (1.1,) * 3)
    places = found.vertices.copy()
    a, b, c = found.triangles[100]
    places[a] += 1.1 * (places[[b, c]].mean(axis=0) - places[a])
    folded = Polygons(places, found.triangles, found.normals)
    rows = overturned(whole, folded)
    assert len(rows)
    mended = collapsed(whole, folded, rows, found.triangles[:0])
    assert not len(overturned(whole, mended))
    assert_closed_manifold(mended)
    assert 0 < len(found.triangles) - len(mended.triangles) <= 2 * len(rows)
    assert euler_characteristic(mended.triangles) == 2


def test_cells_that_hide_nothing_are_not_cut():
    # Second derivatives of angles are not known.
    text = "0.3 - exp(-3*((x-0.5)^2 + y^2 + z^2)) - exp(-3*((x+0.5)^2 + y^2 + z^2)) + 0.05*atan2(z, x + 3)"
    box = tape_of(text), (-1.6,) * 3, (1.6,) * 3, 3.2 / 48
    doubt = unresolved(*box)
    assert doubt.cells > 0
    found, left = cut_finer(text, 1.6, 48)
    assert len(found.triangles) == len(polygonise(*box).triangles)
    assert left.volume <= doubt.volume


def test_cells_beside_the_faces_that_cut_a_solid_are_proved_as_those_far_from_them():
    # The tanglecube ends within the box, but in blocks that reach its faces: 93 cells were left where 6 are.
    tanglecube = tape_of("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8")
    assert unresolved(tanglecube, (-3.0,) * 3, (3.0,) * 3, 6 / 32).cells < 10


def test_bench_measures_the_meshes_that_the_command_makes(monkeypatch):
    half, drop = 1.0, "min(sqrt(x^2 + y^2 + z^2) - 0.5, sqrt((x-0.83)^2 + (y-0.04)^2 + (z-0.03)^2) - 0.04)"
    shape = Implicit("drop", Surface((1.0, 1.0, 1.0)), tape_of(drop), (-half,) * 3, (half,) * 3)
    monkeypatch.setattr(surface_measures, "CELLS", (16, 24))
    made = surface_measures.mesh_runs(shape)
    for run in made:
        own, _ = cut_finer(drop, half, round(2 * half / run.cell))
        assert (run.euler, run.triangles) == (4, len(own.triangles))
