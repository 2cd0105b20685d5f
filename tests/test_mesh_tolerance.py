"""Distances between meshes and surfaces are those of geometry; a tolerance on them is kept, or it is told."""

import math
from functools import partial

import numpy as np
import pytest

from meshes import (
    BALL,
    TORUS,
    TURNED,
    assert_closed_manifold,
    cut,
    cut_sharp,
    tape_of,
)
from sceneql import pipeline
from sceneql.mesh.bounded import bounded
from sceneql.mesh.cubes import tolerance as tolerance_module
from sceneql.mesh.cubes.refine import refined
from sceneql.mesh.cubes.tolerance import distance, missed, polygonise_within
from sceneql.mesh.hausdorff import hausdorff
from sceneql.mesh.measures import euler_characteristic
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.folds import folds
from sceneql.report.mesh import mesh


def test_hausdorff_distances_are_those_of_geometry():
    # An octahedron in the unit sphere: its faces' middles are nearest to the center, at 1/sqrt(3).
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
    faces = [[x, y, z] if (x + y + z) % 2 == 0 else [y, x, z] for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    octahedron = Polygons(corners, np.array(faces, dtype=np.int32), corners)
    found = hausdorff(octahedron, tape_of(BALL))
    assert found.to_surface == pytest.approx(1.0 - 3**-0.5, rel=1e-3)
    assert found.to_mesh == pytest.approx(1.0 - 3**-0.5, rel=1e-3)
    assert found.distance == max(found)
    # A cube that is too large by 0.1 on all sides: its corners are off by the diagonal, the faces in it by 0.1.
    cube = hausdorff(
        cut_sharp("max(abs(x), abs(y), abs(z)) - 0.8", 1.0, 16), tape_of("max(abs(x), abs(y), abs(z)) - 0.7")
    )
    assert cube.to_surface == pytest.approx(0.1 * 3**0.5, rel=0.03)
    assert cube.to_mesh == pytest.approx(0.1, abs=1e-9)


def test_hausdorff_distances_fall_with_the_square_of_the_cell_and_stay_with_sharp_edges():
    torus = [hausdorff(cut(TORUS, 1.5, cells), tape_of(TORUS), 4000).distance for cells in (32, 64)]
    assert math.log2(torus[0] / torus[1]) == pytest.approx(2.0, abs=0.4)
    chamfered, sharp = (hausdorff(made(TURNED, 1.3, 32), tape_of(TURNED), 4000) for made in (cut, cut_sharp))
    assert chamfered.distance > 0.01
    assert sharp.distance < 1e-9


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_a_tolerance_is_kept(tolerance):
    tape, low, high = tape_of(TORUS), (-1.5,) * 3, (1.5,) * 3
    made = polygonise_within(tape, low, high, tolerance, 0.5, refined)
    assert distance(bounded(tape, low, high), made.polygons) <= tolerance
    assert made.missed <= tolerance
    assert made.cell <= 0.5


CREASED = {  # of which all cells were shortened, and how many triangles are enough
    "lens": ("max(sqrt((x - 0.3)^2 + y^2 + z^2) - 0.8, sqrt((x + 0.3)^2 + y^2 + z^2) - 0.8)", 1.0, 60_000),
    "cube without a corner": (
        "max(max(abs(x), abs(y), abs(z)) - 0.8, 0.5 - max(abs(x - 0.8), abs(y - 0.8), abs(z - 0.8)))",
        1.0,
        300_000,
    ),
}


@pytest.mark.parametrize("name", CREASED)
def test_creases_shorten_the_cells_along_them_alone(name):
    text, half, most = CREASED[name]
    box = tape_of(text), (-half,) * 3, (half,) * 3
    made = polygonise_within(*box, 1e-3, half / 8, partial(refined, tolerance=1e-3))
    assert_closed_manifold(made.polygons)
    assert not len(folds(bounded(*box), made.polygons))
    assert distance(bounded(*box), made.polygons) <= 1e-3
    assert hausdorff(made.polygons, box[0], 20_000).to_surface <= 1.05e-3
    assert len(made.polygons.triangles) < most


SHELL = "abs(x^2 + y^2 + z^2 - 0.5) - 2e-2"  # walls of 28 mm


THIN = "abs(x^2 + y^2 + z^2 - 0.5) - 1e-3"  # of 1.4 mm


def test_a_tolerance_is_kept_by_walls_that_pass_between_coarse_cells():
    tape, low, high = tape_of(SHELL), (-0.75,) * 3, (0.75,) * 3
    coarse = refined(tape, low, high, 0.25)
    assert missed(bounded(tape, low, high), *coarse) > 1.5e-2
    made = polygonise_within(tape, low, high, 1.5e-2, 0.25, refined)
    assert euler_characteristic(made.polygons.triangles) == 4
    assert made.missed <= 1.5e-2
    assert hausdorff(made.polygons, tape, 4000).distance <= 1.5e-2


def test_cells_are_not_shortened_beyond_a_count_and_it_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(tolerance_module, "MOST", 20_000)
    path = tmp_path / "shell.yaml"
    path.write_text(f'sceneql: 1\nobjects: {{shell: {{implicit: {{field: "{THIN}"}}}}}}\n', encoding="utf-8")
    account = mesh(pipeline.load(path, pruned=False), "shell", tmp_path / "a.ply", tolerance=1e-2)
    assert account.missed > 1e-2
    assert "the tolerance is not kept" in account.text()
