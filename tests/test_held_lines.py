"""Lines and points on the surface of an elastic solid, which are held or loaded where the mesh had no nodes."""

from math import pi, sqrt

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.bodies.elements.element_mesh import fine_rule
from sceneql.bodies.elements.on_faces import line_shares
from sceneql.pipeline import load
from sceneql.run.run import Run
from solids import Solid

LAW = "law: {linear: {modulus: 1 MPa, poisson: 0.3}}"
BAR = "block: {size: 1 0.2 0.3 m, cells: [5, 2, 3]}"
BALL = "objects: {ball: {sphere: {radius: 1 m, hidden: yes}}}"


def whole(solid, volume, least, share=1e-9):
    """Whether no element is turned, the volume is kept, and no angle [deg] is smaller than ``least``."""
    mesh = solid.mesh
    assert mesh.sizes(fine_rule()[0]).min() > 0.0
    assert mesh.tables()[1].sum() == pytest.approx(volume, rel=share)
    assert np.degrees(solid.kind._made.angles[0]) > least


@pytest.mark.parametrize(("element", "nodes"), [("p1", 7), ("p2", 13)])
def test_a_line_between_the_nodes_of_a_block_is_held_whole(tmp_path, element, nodes):
    hold = "hold: {a: {where: (x == -0.37)*(y == -0.1)}, b: {where: (x == 0.42)*(y == -0.1), components: yz}}"
    solid = Solid(tmp_path, f"{{{BAR}, element: {element}, {LAW}, {hold}}}", "forces: [gravity]\n")
    whole(solid, 0.06, 8)
    assert solid.mesh.put == (14, 0)
    assert "; for lines and points 14 nodes were added and 0 moved; " in solid.kind.remark(None)
    moves = solid.rest()[0] - solid.places
    assert np.abs(moves).max() > 1e-3
    for name, x, axes in (("hold a", -0.37, [0, 1, 2]), ("hold b", 0.42, [1, 2])):
        on = solid.mesh.lines[name].nodes
        places = solid.mesh.points[on]
        assert np.abs(places[:, :2] - (x, -0.1)).max() < 1e-15
        assert len(on) == nodes
        edges = solid.mesh.points[solid.mesh.lines[name].edges]
        assert np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum() == pytest.approx(0.3, rel=1e-12)
        assert (moves[on][:, axes] == 0.0).all()


def test_a_line_that_others_cross_and_points_stand_on_is_held_whole(tmp_path):
    hold = "hold: {a: {where: (x == 0.03)*(y == 0.1)}, p: {near: 0.03 0.1 -0.11 m, components: x}, "
    hold += "c: {where: (z == 0.02)*(y == 0.1), components: y}}"
    solid = Solid(tmp_path, f"{{{BAR}, element: p2, {LAW}, {hold}}}")
    whole(solid, 0.06, 3)
    for name, length in (("hold a", 0.3), ("hold c", 1.0)):
        edges = solid.mesh.points[solid.mesh.lines[name].edges]
        assert np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum() == pytest.approx(length, rel=1e-12)
    x, y, _ = solid.mesh.points.T
    along = (np.abs(x - 0.03) < 1e-9) & (np.abs(y - 0.1) < 1e-9)
    assert solid.bodies.skin.held[along].all()


def test_where_nodes_stand_a_line_or_a_face_is_held_by_these_alone(tmp_path):
    hold = "hold: {a: {where: x == -0.5}, b: {where: (x == 0.1)*(y == 0.1)}, c: {near: 0.3 0.1 0.05 m}}"
    solid = Solid(tmp_path, f"{{{BAR}, element: p2, {LAW}, {hold}}}")
    plain = Solid(tmp_path, f"{{{BAR}, element: p2, {LAW}, hold: {{a: {{where: x < -0.4999}}}}}}")
    assert solid.mesh.put == (0, 0)
    assert (solid.mesh.points == plain.mesh.points).all()
    assert (solid.mesh.cells == plain.mesh.cells).all()
    held = np.zeros(len(solid.mesh.points), dtype=bool)
    x, y, z = solid.mesh.points.T
    held |= (x == -0.5) | ((np.abs(x - 0.1) < 1e-12) & (y == 0.1))
    held |= (np.abs(x - 0.3) < 1e-12) & (y == 0.1) & (np.abs(z - 0.05) < 1e-12)
    assert (solid.bodies.skin.held.all(axis=1) == held).all()


@pytest.mark.parametrize("block", [True, False])
def test_a_point_is_held_where_it_is_asked(tmp_path, block):
    places = {"face": (0.03, 0.1, 0.02), "edge": (0.23, 0.1, 0.15), "off": (-0.27, 0.2, 0.11), "inside": (0.2, 0.01, 0)}
    hold = ", ".join(f"{name}: {{near: {x} {y} {z} m}}" for name, (x, y, z) in places.items())
    body = BAR if block else "of: bar, spacing: 0.15 m"
    more = "objects: {bar: {box: {size: 1 0.2 0.3 m, hidden: yes}}}"
    solid = Solid(tmp_path, f"{{{body}, {LAW}, hold: {{{hold}}}}}", more)
    whole(solid, 0.06, 8)
    for name in ("face", "edge", "off"):
        (node,) = solid.mesh.lines[f"hold {name}"].nodes
        x, y, z = places[name]
        assert solid.mesh.points[node] == pytest.approx([x, min(y, 0.1), z], abs=1e-8)
    assert "hold inside" not in solid.mesh.lines
    assert solid.bodies.skin.held.any(axis=1).sum() == 4


def test_a_circle_around_a_ball_is_held_along_curved_edges(tmp_path):
    """No node lies on the latitude 0.07 m; the point is on the ball below a place above it."""
    hold = "hold: {e: {where: y == 0.07}, p: {near: 0.3 0.9 0.3 m, components: y}}"
    solid = Solid(tmp_path, f"{{of: ball, spacing: 0.4 m, element: p2, {LAW}, {hold}}}", BALL)
    whole(solid, 4 / 3 * pi, 15, 2e-3)
    mesh, on = solid.mesh, solid.mesh.lines["hold e"]
    places = mesh.points[on.nodes]
    assert np.abs(places[:, 1] - 0.07).max() < 1e-12
    assert np.abs(np.linalg.norm(places, axis=1) - 1.0).max() < 1e-12
    assert len(on.nodes) == 2 * len(on.edges)  # it is closed
    (top,) = mesh.points[mesh.lines["hold p"].nodes]
    assert top == pytest.approx(np.array([0.3, 0.9, 0.3]) / np.sqrt(0.99), abs=1e-6)


def test_a_circle_on_the_flat_face_of_a_block_bends_the_edges_on_it(tmp_path):
    block = "block: {size: 1 0.4 1 m, cells: [5, 2, 5]}"
    load_ = "loads: {ring: {where: '(hypot(x, z) == 0.3)*(y == 0.2)', force: 0 -1 0 N}}"
    solid = Solid(tmp_path, f"{{{block}, element: p2, {LAW}, {load_}}}")
    whole(solid, 0.4, 8)
    on = solid.mesh.lines["load ring"]
    places = solid.mesh.points[on.nodes]
    assert np.abs(np.hypot(places[:, 0], places[:, 2]) - 0.3).max() < 1e-9
    assert places[:, 1] == pytest.approx(0.2, abs=1e-15)
    assert len(on.nodes) == 2 * len(on.edges)
    assert solid.forces(solid.places).sum(axis=0) == pytest.approx([0, -1, 0], abs=1e-12)


def test_a_force_on_a_line_is_spread_by_length():
    points = np.array([[0, 0, 0], [1, 0, 0], [3, 0, 0], [0.5, 0, 0], [2, 0, 0]], dtype=float)
    assert line_shares(points, np.array([[0, 1], [1, 2]]))[:3] == pytest.approx([1 / 6, 1 / 2, 1 / 3])
    found = line_shares(points, np.array([[0, 1, 3], [1, 2, 4]]))
    assert found == pytest.approx(np.array([1, 3, 2, 4, 8]) / 18)


@pytest.mark.parametrize("solver", ["equilibrium: {}", "bdf2: {step: 50 ms}", "dopri5: {tolerance: 1e-5}"])
def test_a_line_follows_its_shift_by_every_solver(tmp_path, solver):
    hold = "a: {where: (x == -0.33)*(y == -0.1)}, "
    hold += "b: {where: (x == 0.31)*(y == -0.1), shift: [0 m, 0.1 m/s*time, 0 m]}"
    path = tmp_path / "scene.yaml"
    path.write_text(
        f"clock: {{end: 0.2 s}}\nsolvers: {{main: {{{solver}}}}}\nmodels: {{body: {{elastic: {{"
        "block: {size: 1 0.2 0.2 m, cells: [4, 1, 1]}, element: p1, "
        f"law: {{neo_hookean: {{modulus: 20 kPa, poisson: 0.3}}}}, hold: {{{hold}}}}}}}}}\n"
    )
    run = Run(load(path, pruned=False))
    last = list(run.moments([0.0, 0.2]))[-1]
    mesh = run.graph.tasks["body"].kind.solid.mesh
    places = last.read("body", "positions")
    for name, up in (("hold a", 0.0), ("hold b", 0.02)):
        on = mesh.lines[name].nodes
        assert np.abs(mesh.points[on, 0] - (0.31 if up else -0.33)).max() < 1e-15
        assert places[on] == pytest.approx(mesh.points[on] + [0.0, up, 0.0], abs=1e-12)


def test_a_beam_on_two_lines_sounds_as_beams_do(tmp_path):
    """By pi/2 sqrt(E I/(m L^4)) of Euler and Bernoulli, and Timoshenko's first part for inertia and shear."""
    length, height = 0.9, 0.03
    at = f"(x == {{}}{length / 2})*(y == 0)"
    hold = f"a: {{where: {at.format('-')}}}, b: {{where: {at.format('')}, components: yz}}"
    script = (
        "solvers: {main: modal}\nmodels: {bar: {elastic: {modes: 4, element: p2, "
        f"block: {{size: {length} {height} 0.02 m, cells: [9, 1, 1]}}, "
        f"law: {{linear: {{modulus: 1 GPa, poisson: 0}}}}, hold: {{{hold}}}}}}}}}\n"
    )
    (found,) = watch(tmp_path, script, [0.0], "bar.frequencies")[0]
    simple = pi / 2 / length**2 * sqrt(1e9 * height**2 / 12 / 1000)
    shear = 1 + (1 + 2 * 1.2) * (pi * height / length) ** 2 / 12
    assert found.min() == pytest.approx(simple / sqrt(shear), rel=5e-3)


def test_what_no_edge_crosses_is_told_with_what_to_write(tmp_path):
    script = f"models: {{bar: {{elastic: {{{BAR}, {LAW}, hold: {{a: {{where: (x == 0.02)*(y > 0.11)}}}}}}}}}}\n"
    told = complaint(tmp_path, script)
    assert "'a' holds no node" in told
