"""Laws of refined cells: closed beside coarse ones, and honest about what they do not resolve."""

import dataclasses
import math

import numpy as np
import pytest

from meshes import (
    BALL,
    PART,
    STEINER,
    TANGLECUBE,
    TORUS,
    TURNED,
    WALL,
    assert_closed_manifold,
    cut,
    cut_finer,
    tape_of,
)
from sceneql.field.tape.tape_solid import field_gradients, field_values
from sceneql.mesh.bounded import bounded
from sceneql.mesh.cubes.grid import grid_around
from sceneql.mesh.cubes.grid_extraction import Found, GridExtraction
from sceneql.mesh.cubes.kept_blocks import KeptBlocks
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.cubes.unresolved import unresolved
from sceneql.mesh.measures import euler_characteristic, volume
from sceneql.mesh.repair import move_vertices
from sceneql.mesh.repair.folds import overturned


def test_blocks_asked_for_later_hold_what_they_hold_at_once():
    low, high = (-3.0,) * 3, (3.0,) * 3
    shop = GridExtraction(bounded(tape_of(TANGLECUBE), low, high), grid_around(low, high, 0.125))
    blocks, kept = shop.met(), KeptBlocks(shop)
    kept.extracted(blocks[::3].copy())
    kept.extracted(blocks[::2].copy())
    wanted = blocks[::-1].copy()
    later, once = kept.extracted(wanted), shop.extracted(wanted)
    for field in dataclasses.fields(Found):
        assert np.array_equal(getattr(later, field.name), getattr(once, field.name)), field.name


def test_blocks_without_surface_are_proved_by_slopes_where_ranges_are_too_wide():
    """Each coordinate is there twice: by its range, f may be zero in 166 blocks."""
    low, high = (-1.5,) * 3, (1.5,) * 3
    shop = GridExtraction(
        bounded(tape_of("x^2 - x + y^2 - y + z^2 - z + 0.5"), low, high), grid_around(low, high, 3 / 64)
    )
    blocks, sides = shop.met(), 8 * shop.grid.blocks + 1
    assert len(blocks) == 100
    places = [first + np.arange(side) * shop.grid.cell for first, side in zip(shop.grid.low, sides, strict=True)]
    nodes = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 3)
    inside, told = field_values(shop.whole, nodes).reshape(sides) < 0.0, set(map(tuple, blocks.tolist()))
    for i, j, k in np.ndindex(*shop.grid.blocks):
        some = inside[8 * i : 8 * i + 9, 8 * j : 8 * j + 9, 8 * k : 8 * k + 9]
        assert some.all() or not some.any() or (i, j, k) in told


def test_a_smooth_solid_that_turns_too_much_all_over_gets_cells_of_half_the_side():
    """It took twice the time, and was twice as far from the surface, with a third of its cells cut by four."""
    (halved, left), (asked, _) = cut_finer(TANGLECUBE, 3.0, 32), cut_finer(TANGLECUBE, 3.0, 64)
    assert left.cell == 6 / 64  # as `mesh` tells
    assert np.array_equal(halved.vertices, asked.vertices)
    assert np.array_equal(halved.triangles, asked.triangles)
    creased = cut_finer(STEINER, 0.6, 32)[0]  # along creases alone
    assert len(creased.triangles) < len(cut(STEINER, 0.6, 64).triangles) * 1.5


def test_resolved_shapes_hide_next_to_nothing():
    found = unresolved(tape_of(TORUS), (-1.5,) * 3, (1.5,) * 3, 0.05)
    assert found.volume < 1e-6
    assert unresolved(tape_of(BALL), (-1.1,) * 3, (1.1,) * 3, 0.05).cells == 0


def test_of_a_smooth_solid_nothing_is_left_unresolved_but_what_is_there():
    doubt = unresolved(tape_of(TANGLECUBE), (-3.0,) * 3, (3.0,) * 3, 6 / 64)
    assert doubt.cells == 0  # bulges through faces are of sheets that the cells beyond show
    assert len(cut_finer(TANGLECUBE, 3.0, 64)[0].triangles) == len(cut(TANGLECUBE, 3.0, 64).triangles)


def test_a_lens_in_a_plane_of_nodes_is_no_bulge_of_what_the_cells_beyond_show():
    """Monotone on either side of the plane, and thin, it is yet shown by neither."""
    low, high, cell = (-1.0,) * 3, (1.0,) * 3, 0.125
    x, y, z = (float(c) for c in grid_around(low, high, cell).low + 8 * cell + np.array([0.5, 0.5, 0.0]) * cell)
    lens = f"abs(z - {z!r}) + 2*((x - {x!r})^2 + (y - {y!r})^2) - 0.01"
    assert not len(polygonise(tape_of(lens), low, high, cell).triangles)
    assert unresolved(tape_of(lens), low, high, cell).volume > math.pi * 0.01**2 / 2
    assert euler_characteristic(cut_finer(lens, 1.0, 16)[0].triangles) == 2


def test_what_passes_between_the_samples_is_told():
    drop = "min(sqrt(x^2 + y^2 + z^2) - 0.5, sqrt((x - 0.83)^2 + (y - 0.04)^2 + (z - 0.03)^2) - 0.01)"
    with_drop = unresolved(tape_of(drop), (-1.0,) * 3, (1.0,) * 3, 0.125)
    alone = unresolved(tape_of("sqrt(x^2 + y^2 + z^2) - 0.5"), (-1.0,) * 3, (1.0,) * 3, 0.125)
    assert with_drop.cells > alone.cells
    assert with_drop.volume - alone.volume > 4 / 3 * math.pi * 0.01**3
    wall = "abs(sqrt(x^2 + y^2 + z^2) - 0.7) - 0.0005"
    assert unresolved(tape_of(wall), (-1.0,) * 3, (1.0,) * 3, 0.125).volume > 0.0061575226482


FAR_DROP = "min(sqrt(x^2 + y^2 + z^2) - 0.5, sqrt((x - 0.83)^2 + (y - 0.04)^2 + (z - 0.03)^2) - 0.04)"


@pytest.mark.parametrize(
    ("text", "half", "cells"),
    [(PART, 1.0, 20), (STEINER, 0.6, 40), (WALL, 1.0, 16), (TURNED, 1.3, 20), (TANGLECUBE, 3.0, 16)],
    ids=["part", "steiner", "wall", "cube", "tanglecube"],
)
def test_refined_cells_meet_the_others_without_gaps(text, half, cells):
    found, _ = cut_finer(text, half, cells)
    assert_closed_manifold(found)
    assert len(np.unique(found.triangles)) == len(found.vertices)
    assert len(found.triangles) > len(cut(text, half, cells).triangles)
    slopes = np.linalg.norm(field_gradients(tape_of(text), found.vertices), axis=1)
    steep = slopes > 1e-3
    assert (np.abs(field_values(tape_of(text), found.vertices))[steep] / slopes[steep]).max() < 1e-6


@pytest.mark.parametrize("cells", [48, 96])
def test_no_triangle_faces_inward_where_fine_cells_meet_coarse_ones(cells):
    found, _ = cut_finer(TANGLECUBE, 3.0, cells)
    a, b, c = (found.vertices[found.triangles[:, k]] for k in range(3))
    inward = (np.cross(b - a, c - a) * field_gradients(tape_of(TANGLECUBE), (a + b + c) / 3)).sum(axis=1) < 0
    assert inward.sum() == 0
    assert euler_characteristic(found.triangles) == -8


def test_a_sliver_between_fine_and_coarse_cells_is_not_flipped_into_a_larger_fold():
    planes = "(1-z-sqrt(2)*x)*(1-z+sqrt(2)*x)*(1+z+sqrt(2)*y)*(1+z-sqrt(2)*y)"
    kummer = f"max((x^2+y^2+z^2-1.3)^2 - 2.9/1.7*{planes}, sqrt(x^2+y^2+z^2) - 2.5)"
    found, _ = cut_finer(kummer, 2.55, 44)
    assert not len(overturned(bounded(tape_of(kummer), (-2.55,) * 3, (2.55,) * 3), found))


def test_no_corner_is_tried_again_before_something_near_it_has_moved(monkeypatch):
    tried = []

    def noted(tape, places, normals, star, vertex):
        tried.append((vertex, places[star].tobytes()))
        return moved(tape, places, normals, star, vertex)

    moved = move_vertices._moved
    monkeypatch.setattr(move_vertices, "_moved", noted)
    gyroid = "sin(9*x)*cos(9*y) + sin(9*y)*cos(9*z) + sin(9*z)*cos(9*x)"
    found, _ = cut_finer(f"max({gyroid}, sqrt(x^2 + y^2 + z^2) - 1)", 1.0, 40)
    assert_closed_manifold(found)
    assert len(tried) == len(set(tried)) > 10


def test_what_passes_between_the_samples_is_found_by_finer_ones():
    assert euler_characteristic(cut(FAR_DROP, 1.0, 16).triangles) == 2
    found, left = cut_finer(FAR_DROP, 1.0, 16)
    assert euler_characteristic(found.triangles) == 4
    assert left.volume < 1e-2 * unresolved(tape_of(FAR_DROP), (-1.0,) * 3, (1.0,) * 3, 0.125).volume
    assert euler_characteristic(cut_finer(TANGLECUBE, 3.0, 16)[0].triangles) == -8


def test_faces_that_hold_nodes_hide_nothing():
    # Cells of 0.1 m cut in four have nodes at 0.7 m, where f is exactly zero.
    assert cut_finer("max(abs(x), abs(y), abs(z)) - 0.7", 1.0, 20)[1].volume == 0.0


def test_refined_walls_that_stay_too_thin_are_told():
    before = unresolved(tape_of(WALL), (-1.0,) * 3, (1.0,) * 3, 0.125)
    _, left = cut_finer(WALL, 1.0, 16)
    assert 0.0061575226482 < left.volume < 0.3 * before.volume


@pytest.mark.parametrize("along", ["x", "y", "z"])
def test_a_sheet_that_passes_cells_twice_is_cut_further_or_told(along):
    """It lies in cells that show a change of sign, but was torn where no node lies inside of it."""
    others = "xyz".replace(along, "")
    sheet = f"max(abs({along} - 0.1*sin(5*{others[0]})) - {{}}, abs({others[0]}) - 0.5, abs({others[1]}) - 0.1)"
    found, left = cut_finer(sheet.format(0.008), 0.525, 16)
    assert_closed_manifold(found)
    assert euler_characteristic(found.triangles) == 2
    assert volume(found.vertices, found.triangles) == pytest.approx(0.016 * 0.2, rel=0.02)
    assert not left.cells
    found, left = cut_finer(sheet.format(0.003), 0.525, 16)
    assert euler_characteristic(found.triangles) != 2
    assert left.seen.sum() > 100


def test_refined_edges_are_cut_less():
    errors = [
        1.4**3 - volume(found.vertices, found.triangles)
        for found in (cut(TURNED, 1.3, 32), cut_finer(TURNED, 1.3, 32)[0])
    ]
    assert 0.0 < errors[1] < errors[0] / 12  # cells of a quarter, so a sixteenth of what is cut off


@pytest.mark.parametrize(
    "jumps",
    [
        "0.17 - 0.96*atan2(y, x - 0.3)",
        "abs(0.73*floor(7.8*x) + 0.44*log(0.1 + y^2) + 0.21*max(sin(8.7*x), sin(8.7*y))) - 0.1",
    ],
)
@pytest.mark.parametrize("count", [20, 33])
def test_no_vertex_leaves_its_cells_where_a_field_jumps(jumps, count):
    """There Newton's method goes anywhere: triangles reached thousands of cells beyond the solid."""
    mesh, _ = cut_finer(f"max({jumps}, x^2 + y^2 + z^2 - 0.8)", 1.0, count)
    assert_closed_manifold(mesh)
    assert np.linalg.norm(mesh.vertices, axis=1).max() < np.sqrt(0.8) + 1e-9
    corners = mesh.vertices[mesh.triangles]
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() < 4 * 2 / count
