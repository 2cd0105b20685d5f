"""Closed sheets of triangles around fluid in deep flows, and the laws of skins."""

import numpy as np
import pytest

from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run
from sceneql.skins.closed_surface import wrong
from skins import ballooned, deep, forces

DRAWN = """
models:
  air: {{flow: {{{fields}}}}}
  balloon: {{membrane: {{of: ball, law: {{tension: 1 N/m}}}}}}
forces: [{{immersion: {{on: [balloon], in: air}}}}]
objects: {{ball: {{sphere: {{position: 0.5 0.5 0.5 m, radius: 0.3 m}}}}}}
outputs: {{still: {{image: {{}}}}}}
"""
BALL = "x^2 + y^2 + z^2 - 0.09"
EGG = "(x/0.34)^2 + (y/0.24)^2 + (z/0.26)^2 - 1"
LAWS = [
    "law: {tension: 2 N/m}",
    "law: {springs: {stretch: 3 N/m}}, prestress: 1 N/m",
    "law: {neo_hookean: {modulus: 5 N/m}}",
    "law: {skalak: {modulus: 4 N/m, area: 2.5}}",
    "law: {tension: 2 N/m}, bend: 0.03 J",
]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("make", [ballooned, deep], ids=["flat", "deep"])
def test_forces_are_the_slopes_of_the_energy(tmp_path, make, law):
    air = make(tmp_path, law) if make is ballooned else make(tmp_path, law, EGG)
    skin, start = air.at(0.0).tasks["balloon"].kind.made, air.read("positions", "balloon")
    rng = np.random.default_rng(7)
    flat = len(skin.triangles) == 0
    moved = start + 0.003 * rng.standard_normal(start.shape) * ([1, 1, 0] if flat else 1)
    way = rng.standard_normal(start.shape) * ([1, 1, 0] if flat else 1)
    slope = (skin.potential(moved + 2e-7 * way) - skin.potential(moved - 2e-7 * way)) / 4e-7
    found = forces(air, moved)
    assert -(found * way).sum() == pytest.approx(slope, rel=1e-6)
    assert found.sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-9)
    assert np.cross(moved, found).sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-9)


def test_sheets_that_are_blown_up_evenly_have_the_energy_of_their_law(tmp_path):
    """Springs T = stretch e, as of a cloth, on triangles of any shape; rubber W = G/2 (2 s^2 + s^-4 - 3)."""
    s = 1.07
    for law, dense in (
        ("law: {springs: {stretch: 3 N/m}}", 3.0 * (s - 1.0) ** 2),
        ("law: {neo_hookean: {modulus: 5 N/m}}", 2.5 * (2.0 * s**2 + s**-4 - 3.0)),
        (LAWS[3], (2 * s**2 - 1) ** 2 - 1 - 2 * (s**4 - 1) + 2.5 * (s**4 - 1) ** 2),
        ("law: {tension: 2 N/m}", 2.0 * (s**2 - 1.0)),
    ):
        air = deep(tmp_path, law, EGG).at(0.0)
        skin, points = air.tasks["balloon"].kind.made, air.read("positions", "balloon")
        assert skin.potential(s * points) == pytest.approx(dense * skin.area(points), rel=1e-10)
        assert skin.potential(points) == pytest.approx(0.0, abs=1e-12)


def test_a_solid_is_covered_by_even_triangles(tmp_path):
    air = deep(tmp_path, LAWS[0], EGG, cells=20).at(0.0)
    points, triangles = air.read("positions", "balloon"), air.read("triangles", "balloon").astype(int)
    place = (points - 0.5) / [0.34, 0.24, 0.26]
    assert (place**2).sum(axis=1) == pytest.approx(np.ones(len(points)), abs=1e-9)
    assert wrong(len(points), triangles) == ""
    assert len(triangles) == 2 * len(points) - 4  # Euler, of a sphere
    corners = points[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert (4.0 * np.sqrt(3.0) * areas / (sides**2).sum(axis=1)).min() > 0.6  # 1 of equal sides
    assert sides.max() < 0.8 / 20
    assert air.read("volume", "balloon") == pytest.approx(4 / 3 * np.pi * 0.34 * 0.24 * 0.26, rel=4e-3)
    assert air.read("center", "balloon") == pytest.approx([0.5, 0.5, 0.5], abs=1e-5)
    assert air.read("deformation", "balloon") == pytest.approx((0.34 - 0.24) / (0.34 + 0.24), abs=1e-3)


def test_the_cells_inside_are_told(tmp_path):
    """A torus, whose inside a line meets twice; across the seam of the box, too."""
    torus = "(hypot(x, y) - 0.22)^2 + z^2 - 0.13^2"
    air = deep(tmp_path, LAWS[0], torus, at="0.5 0.5 0.9", cells=16).at(0.0)
    skin, points = air.tasks["balloon"].kind.made, air.read("positions", "balloon")
    centers = air.read("centers") + np.array([0.0, 0.0, 0.5])
    x, y, z = (centers - [0.5, 0.5, 0.9]).T
    level = np.hypot(np.hypot(x, y) - 0.22, z) - 0.13
    known = np.abs(level) > 0.01
    assert np.array_equal(skin.holds(centers, points)[known], level[known] < 0.0)
    assert air.read("triangles", "balloon").shape[0] == 2 * len(points)


def test_a_bubble_rests_under_the_pressure_of_laplace(tmp_path):
    air = deep(tmp_path, LAWS[0], BALL, cells=16, solver="{sbdf2: {step: 5 ms}}", end=0.05).at(0.05)
    assert air.read("pressure_jump", "balloon") == pytest.approx(2.0 * 2.0 / 0.3, rel=0.01)
    assert air.read("largest_speed") * 0.05 / 2.0 < 1e-3


@pytest.mark.parametrize("boundary", [None, "{}"], ids=["periodic", "walls"])
def test_what_is_drawn_keeps_its_volume_and_gives_its_energy_to_the_fluid(tmp_path, boundary):
    more = {} if boundary is None else {"boundary": boundary, "at": "0.42 0.42 0.5"}
    solver = "{rk4: {step: 5 ms}}"
    air = deep(tmp_path, LAWS[1], EGG, viscosity="0 Pa*s", solver=solver, volume="kept", end=0.15, **more).at(0.0)
    volume = air.read("volume", "balloon")
    for time in (0.073, 0.15):
        assert air.at(time).read("volume", "balloon") == pytest.approx(volume, rel=1e-13)
    assert 0.0 < air.read("volume_correction", "balloon") < 1e-3 * volume
    stored, moving = air.read("potential", "balloon"), air.read("kinetic_energy")
    assert moving > 1e-3
    assert moving + stored == pytest.approx(0.0, abs=0.02 * moving)


def test_a_deep_flow_with_a_flat_skin_or_one_of_two_pieces_is_refused(tmp_path):
    shell = "abs(x^2 + y^2 + z^2 - 0.06) - 0.03"
    with pytest.raises(ScriptError, match="it has 2 surfaces, and a skin is one"):
        deep(tmp_path, LAWS[0], shell).at(0.0)
    outline = "objects: {egg: {outline: {points: [[0.2 m, 0.2 m], [0.8 m, 0.2 m], [0.5 m, 0.8 m]]}}}\n"
    with pytest.raises(ScriptError, match="it is flat"):
        deep(tmp_path, LAWS[0], BALL, objects=outline).at(0.0)


def test_triangles_that_are_open_or_meet_in_an_edge_are_no_skin():
    closed = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    assert wrong(4, closed) == ""
    assert "closer" in wrong(4, closed[:3])
    assert "closer" in wrong(6, np.concatenate([closed, [[0, 1, 4], [1, 0, 5], [4, 1, 5], [0, 4, 5]]]))
    assert "2 surfaces" in wrong(8, np.concatenate([closed, closed + 4]))


def test_a_deep_skin_is_drawn_smooth_and_its_flow_does_not_hide_it(tmp_path):
    air = {"fields": "size: 1 1 1 m, cell: 1/14 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s"}
    path = tmp_path / "scene.yaml"
    path.write_text(DRAWN.format(**air), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.02])
    (mesh,) = moment.lower(graph.drawn["still"])
    assert mesh.name == "balloon"
    assert (mesh.normals * (mesh.vertices - 0.5)).sum(axis=1).min() > 0.25
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(np.ones(len(mesh.normals)), rel=1e-12)
