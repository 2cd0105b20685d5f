"""Insides of meshes: winding numbers by clusters against the sums over all triangles, holes, and what asks for them."""

import math
import os
import resource
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

from meshes import BALL, TORUS, cut
from runs import watch
from sceneql import pipeline
from sceneql.bodies.filling import winding_kernels as kernels
from sceneql.bodies.filling.winding import MANY, Winding, winding
from sceneql.bodies.filling.winding_cells import Cells
from sceneql.contacts.shapes.closed_mesh import closed
from sceneql.grids.domain.mesh import MeshLevel
from sceneql.mesh.holes import described, loops, open_sides, welded
from sceneql.mesh.measures import edge_counts, volume

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
SIDES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)
"""Of the unit cube, counterclockwise from outside: two triangles for each of left, right, bottom, top, back, front."""
WITHOUT_TOP = np.delete(SIDES, [6, 7], axis=0)


def summed(places, corners):
    """(n,) winding numbers (van Oosterom & Strackee 1983, eq. 8) of triangles (m, 3, 3), one by one."""
    found = np.zeros(len(places))
    for triangle in corners:
        a, b, c = (corner - places for corner in triangle)
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        rest = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
        found += np.arctan2((a * np.cross(b, c)).sum(axis=1), rest)
    return found / (2 * np.pi)


def torus():
    made = cut(TORUS, 1.5, 24)
    return made.vertices[made.triangles]


def holed(corners):
    """A mesh without the triangles in a ball about its lowest point, and some single ones."""
    middles = corners.mean(axis=1)
    kept = np.linalg.norm(middles - middles[middles[:, 1].argmin()], axis=1) > 0.3
    kept[::97] = False
    return corners[kept]


@cache
def shapes():
    ball = cut(BALL, 1.1, 16)
    sphere = ball.vertices[ball.triangles]
    cube = CUBE[SIDES]
    return {
        "closed": torus(),
        "holed": holed(sphere),
        "self-intersecting": np.concatenate([sphere, 0.8 * sphere + [0.6, 0.1, 0]]),
        "an edge of four triangles": np.concatenate([cube, cube + np.array([1, 1, 0])]),
        "a wall within": np.concatenate([cube, CUBE[[[0, 3, 7]]]]),
        "one triangle": cube[:1],
    }


@pytest.mark.parametrize("shape", shapes())
def test_of_many_places_the_same_are_inside_as_one_by_one(shape, monkeypatch):
    corners = shapes()[shape]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    places = np.random.Generator(np.random.Philox(8)).uniform(low - 0.1, high + 0.1, (MANY, 3))
    alone = Winding(corners).holds(places[: MANY // 2])
    asked, inside = [], Cells.around
    monkeypatch.setattr(Cells, "around", lambda mesh: asked.append(inside(mesh)) or asked[0])
    together = Winding(corners).holds(places)
    assert (together[: MANY // 2] == alone).all()
    crossed = asked[0].turns == kernels.MIXED
    assert shape == "one triangle" or 0 < crossed.mean() < 0.6


@pytest.mark.parametrize("shape", shapes())
def test_a_place_is_inside_where_the_sum_over_all_triangles_says_so(shape):
    corners = shapes()[shape]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    draw = np.random.Generator(np.random.Philox(3))
    near = corners[draw.integers(len(corners), size=300)].mean(axis=1)
    near = near + draw.normal(size=near.shape) * 10.0 ** draw.uniform(-6, -1, (300, 1))
    places = np.concatenate([draw.uniform(low - 0.1, high + 0.1, (500, 3)), near])
    exact = summed(places, corners)
    clear = np.abs(exact - 0.5) > 1e-9
    assert clear.mean() > 0.99
    assert (winding(corners).holds(places) == (exact > 0.5))[clear].all()


def test_the_bound_on_what_clusters_leave_out_holds():
    corners = torus()
    asked = Winding(corners)._clusters.arrays
    places = np.random.Generator(np.random.Philox(4)).uniform(-1.5, 1.5, (100, 3))
    exact = summed(places, corners)
    widest = 0.0
    for clusters in kernels.WIDEST:
        found = np.array([kernels.winds(*asked, *p, clusters) for p in places])
        error = np.abs(found[:, 0] - exact)
        assert (error <= found[:, 1] + 1e-12).all()
        widest = max(widest, error.max())
    assert widest > 1e-6  # else no cluster was expanded


def test_answers_are_the_same_for_any_number_of_threads(monkeypatch):
    corners = holed(torus())
    places = np.random.Generator(np.random.Philox(5)).uniform(-1.5, 1.5, (4000, 3))
    told = []
    for threads in ("1", "3"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        asked = Winding(corners)
        held = asked.holds(places)
        inner, outer = places[held][:200], places[~held][:200]
        told.append((asked._clusters.arrays[2].tobytes(), held.tobytes(), asked.exits(inner, outer).tobytes()))
    assert told[0] == told[1]


def test_a_segment_leaves_where_the_sum_falls_through_a_half():
    for corners in (holed(torus()), shapes()["self-intersecting"]):
        asked = Winding(corners)
        places = np.random.Generator(np.random.Philox(6)).uniform(-1.4, 1.4, (3000, 3))
        held = asked.holds(places)
        inner, outer = places[held][:150], places[~held][:150]
        share = asked.exits(inner, outer)[:, None]
        before, behind = (summed(inner + (share + by) * (outer - inner), corners) for by in (-1e-6, 1e-6))
        assert ((before > 0.5 - 1e-4) & (behind < 0.5 + 1e-4)).all()


def test_a_mesh_that_faces_inwards_is_filled_too():
    asked = Winding(CUBE[SIDES[:, ::-1]])
    assert asked.holds(np.array([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]])).tolist() == [True, False]


# --- holes ---


def test_holes_are_counted_and_closed():
    assert described(CUBE, SIDES) == ""
    assert described(CUBE, WITHOUT_TOP) == "1 hole of 4 edges"
    assert described(CUBE, np.delete(SIDES, [4, 5, 6, 7], axis=0)) == "2 holes of 8 edges"
    made = closed(CUBE, WITHOUT_TOP.astype(np.int32))
    places, triangles = welded(made.corners.reshape(-1, 3), np.arange(3 * len(made.corners)).reshape(-1, 3))
    assert edge_counts(triangles)[1:] == (0, 0)
    assert volume(places, triangles) == pytest.approx(1, rel=1e-14)


def test_holes_that_touch_in_a_corner_are_two():
    grid = np.array([[x, y, 0] for x in range(5) for y in range(5)], dtype=float)
    squares = [(x, y) for x in range(4) for y in range(4) if (x, y) not in ((1, 1), (2, 2))]
    two = [[[5 * x + y, 5 * x + y + 5, 5 * x + y + 6], [5 * x + y, 5 * x + y + 6, 5 * x + y + 1]] for x, y in squares]
    _, triangles = welded(grid, np.array(two).reshape(-1, 3))
    found = loops(open_sides(triangles))
    assert sorted(map(len, found)) == [4, 4, 16]
    assert all(len(set(loop)) == len(loop) for loop in found)


def test_a_mesh_of_which_most_is_missing_is_not_closed():
    with pytest.raises(ValueError, match="its mesh is open: 3 edges"):
        closed(CUBE, SIDES[:1].astype(np.int32))


def test_a_domain_whose_mesh_has_a_hole_is_that_of_the_closed_one():
    places = np.random.Generator(np.random.Philox(7)).uniform(-0.5, 1.5, (300, 3))
    whole, without = (MeshLevel(CUBE[sides], "box").values(places) for sides in (SIDES, WITHOUT_TOP))
    np.testing.assert_allclose(without, whole, atol=1e-12)


def obj(vertices, triangles):
    """The text of an OBJ file."""
    return "".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + "".join(
        f"f {a} {b} {c}\n" for a, b, c in triangles + 1
    )


def test_a_mass_lands_on_what_closes_a_hole(tmp_path):
    (tmp_path / "crate.obj").write_text(obj(CUBE, WITHOUT_TOP))
    script = """
clock: {end: 2 s}
objects: {crate: {mesh: {file: crate.obj}}}
models: {ball: {particles: {positions: [[0.4, 1.5, 0.6]], radius: 0.1 m}}}
forces: [gravity]
contacts: {land: {collision: {restitution: 0.2}}}
"""
    ((place,),) = watch(tmp_path, script, [2], "ball.positions")
    assert place[0, 1] == pytest.approx(1.1, abs=1e-9)


SOLID = """
clock: {end: 20 ms}
objects: {scan: {mesh: {file: scan.obj, hidden: yes}}}
models: {it: {mass_spring: {solid: {object: scan}}}}
forces: [gravity]
solvers: {main: {rk4: {step: 1 ms}}}
outputs: {still: {image: {size: 16 9}}}
"""


def test_what_a_mesh_holds_is_asked_once_though_the_camera_runs_ahead(tmp_path, monkeypatch):
    (tmp_path / "scan.obj").write_text(obj(CUBE - 0.137, WITHOUT_TOP))
    (tmp_path / "scene.yaml").write_text(SOLID)
    asked, hold = [], kernels.hold

    def counted(corners, links, moments, places, held, first, last):
        asked.append(last - first)
        hold(corners, links, moments, places, held, first, last)

    monkeypatch.setattr(kernels, "hold", counted)
    graph = pipeline.load(tmp_path / "scene.yaml")
    assert [warning.code for warning in graph.warnings] == ["open-mesh"]
    pipeline.render(graph, folder=tmp_path)
    places = 13**3 + 12**3
    assert sum(asked) == places


def bumpy(n):
    """A bumpy ball of 8 n^2 triangles with a hole, as an octahedron blown up."""
    i, j = (part.ravel() for part in np.mgrid[0 : n + 1, 0 : n + 1])
    low = np.stack([i, j, i + 1, j, i, j + 1], axis=1).reshape(-1, 3, 2)[(i + j < n)]
    high = np.stack([i + 1, j, i + 1, j + 1, i, j + 1], axis=1).reshape(-1, 3, 2)[(i + j < n - 1)]
    flat = np.concatenate([low, high])
    face = np.concatenate([flat, n - flat.sum(axis=2, keepdims=True)], axis=2).astype(float)
    signs = [np.array([x, y, z]) for x in (1, -1) for y in (1, -1) for z in (1, -1)]
    corners = np.concatenate([(face * sign)[:, :: int(sign.prod())] for sign in signs])
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    corners *= 1 + 0.1 * np.sin(5 * corners[:, :, :1]) * np.cos(4 * corners[:, :, 1:2])
    return corners[40:]


def test_a_scan_of_many_triangles_is_explained_in_seconds(tmp_path):
    corners = bumpy(40)
    (tmp_path / "scan.obj").write_text(obj(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    (tmp_path / "scene.yaml").write_text(SOLID)

    def limited():
        resource.setrlimit(resource.RLIMIT_CPU, (60, 60))  # summed pair by pair it takes some 170 s

    command = [sys.executable, "-m", "sceneql", "explain", "scene.yaml"]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, preexec_fn=limited, check=False, env=os.environ
    )
    assert done.returncode == 0, done.stderr
    assert "'it' asks for the inside of 'scan', which is open: it has" in done.stderr
    assert "solved together: it" in done.stdout


def test_volumes_of_a_filled_scan_are_those_of_its_triangles(tmp_path):
    corners = bumpy(20)
    (tmp_path / "scan.obj").write_text(obj(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    ((held,),) = watch(tmp_path, SOLID, [0], "it.volume")
    whole = volume(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    assert held == pytest.approx(whole, rel=0.01)
    assert whole == pytest.approx(4 / 3 * math.pi, rel=0.1)
