"""Solids of tetrahedra: closed, upright, as large and as heavy as their objects, alike in every direction."""

import math
from dataclasses import replace

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.bodies.filling.stuffing import stuffed
from sceneql.bodies.filling.tetrahedra import ENDS, FACES, boundary, edges, volumes
from sceneql.frame import Mesh
from sceneql.mesh.measures import edge_counts, euler_characteristic, volume
from sceneql.pipeline import load
from sceneql.run.run import Run


def dihedral_angles(points, tetrahedra):
    """(t, 6) angles [rad] between the two faces at each edge of ENDS."""
    corners = points[tetrahedra]
    normals = [np.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, a]) for a, b, c in FACES]
    normals = [n / np.linalg.norm(n, axis=1, keepdims=True) for n in normals]
    # The faces at an edge are those across from the two other corners.
    others = [[k for k in range(4) if k not in ends] for ends in ENDS]
    cosines = np.stack([-np.einsum("ij,ij->i", normals[a], normals[b]) for a, b in others], axis=1)
    return np.arccos(np.clip(cosines, -1.0, 1.0))


def filled(field, half, spacing):
    """The tetrahedra where a field of places (n, 3) is negative, in the box -half..half."""

    def crossing(inner, outer):
        low, high = np.zeros(len(inner)), np.ones(len(inner))
        for _ in range(45):
            middle = 0.5 * (low + high)
            held = field(inner + middle[:, None] * (outer - inner)) < 0
            low, high = np.where(held, middle, low), np.where(held, high, middle)
        return low

    box = np.broadcast_to(np.asarray(half, dtype=float), 3)
    return stuffed(-box, box, spacing, lambda places: field(places) < 0, crossing)


def ball(places):
    return np.linalg.norm(places - [0.013, 0.021, 0.007], axis=1) - 1.0


def ring(places):
    return np.hypot(np.hypot(places[:, 0], places[:, 2]) - 1.0, places[:, 1]) - 0.4


def block(places):
    return np.abs(places @ turn).max(axis=1) - 0.6


turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
SHAPES = {
    "ball": (ball, 1.04, 4 / 3 * math.pi, 2),
    "ring": (ring, (1.4, 0.4, 1.4), 2 * math.pi**2 * 0.16, 0),
    "block": (block, 1.1, 1.2**3, 2),
}


@pytest.mark.parametrize("spacing", [0.31, 0.2, 0.1])
@pytest.mark.parametrize("shape", SHAPES)
def test_tetrahedra_are_upright_and_their_boundary_is_closed(shape, spacing):
    field, half, _, euler = SHAPES[shape]
    made = filled(field, half, spacing)
    held, skin = volumes(made.points, made.tetrahedra), boundary(made.tetrahedra)
    assert held.min() > 0.003 * spacing**3  # those of the lattice hold 1/12
    assert held[made.whole] == pytest.approx(spacing**3 / 12)
    assert volume(made.points, skin) == pytest.approx(held.sum(), rel=1e-12)  # none lies over another
    assert edge_counts(skin)[1:] == (0, 0)
    assert euler_characteristic(skin) == euler
    assert set(np.unique(made.tetrahedra)) == set(range(len(made.points)))
    assert np.abs(field(made.points[np.unique(skin)])).max() < 1e-12
    angles = np.degrees(dihedral_angles(made.points, made.tetrahedra))
    assert angles.min() > 15
    assert angles.max() < 155


@pytest.mark.parametrize("shape", SHAPES)
def test_the_volume_is_of_second_order(shape):
    field, half, exact, _ = SHAPES[shape]
    errors = []
    for spacing in (0.2, 0.1, 0.05):
        made = filled(field, half, spacing)
        errors.append(exact - volumes(made.points, made.tetrahedra).sum())
    assert 1.7 < math.log2(errors[0] / errors[2]) / 2 < 2.3


@pytest.mark.parametrize("seed", range(8))
def test_what_the_lattice_cannot_resolve_is_upright_too(seed):
    chance = np.random.default_rng(seed)
    waves, phases, parts = chance.normal(size=(20, 3)) * 15, chance.normal(size=20), chance.normal(size=20)

    def rough(places):
        return np.maximum(np.sin(places @ waves.T + phases) @ parts, np.abs(places).max(axis=1) - 1.0)

    made = filled(rough, 1.0, 0.2)
    held = volumes(made.points, made.tetrahedra)
    assert held.min() > 0.003 * 0.2**3
    skin = boundary(made.tetrahedra)
    assert volume(made.points, skin) == pytest.approx(held.sum(), rel=1e-12)
    assert edge_counts(skin)[1] == 0
    angles = np.degrees(dihedral_angles(made.points, made.tetrahedra))
    assert angles.min() > 9
    assert angles.max() < 165


def test_an_angle_of_a_regular_tetrahedron():
    points = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]])
    assert dihedral_angles(points, np.array([[0, 1, 2, 3]])) == pytest.approx(math.acos(1 / 3))
    assert volumes(points, np.array([[0, 1, 3, 2], [0, 1, 2, 3]])) == pytest.approx([8 / 3, -8 / 3])
    pairs, which = edges(np.array([[0, 1, 2, 3]]))
    assert len(pairs) == 6
    assert sorted(which[0]) == list(range(6))


JELLY = """
clock: {{end: 1 s}}
objects:
  body: {{{shape}}}
  skin: {{surface: {{of: jelly}}}}
models:
  jelly:
    mass_spring:
      solid: {{object: body, spacing: {spacing}, density: 500 kg/m^3, modulus: 30 kPa}}
      damping: 0.1 N*s/m
      velocity: 1 2 0 m/s
      {more}
solvers: {{main: {{rk4: {{step: 0.5 ms}}}}}}
"""
RING = "torus: {radius: 0.5 m, tube: 0.2 m, position: 1 0 0 m, hidden: yes}"
BOX = "box: {size: 1 1 1 m, hidden: yes}"


def state_of(folder, script):
    """The model and its state at the start."""
    path = folder / "scene.yaml"
    path.write_text(script)
    moment = next(iter(Run(load(path)).moments([0])))
    return moment.run.graph.tasks["jelly"].kind, moment.state("jelly"), moment


def strained(kind, state, gradient):
    """Potential energy of positions mapped by a matrix (3, 3)."""
    places = state.y.copy()
    n = 3 * state.bodies.count
    at = state.bodies.position_at
    places[at : at + n] = (places[at : at + n].reshape(-1, 3) @ np.asarray(gradient).T).ravel()
    return kind.read("potential", replace(state, y=places)), kind.read("volume", replace(state, y=places))


def test_a_solid_weighs_what_its_tetrahedra_hold_and_has_its_modulus(tmp_path):
    kind, state, _ = state_of(tmp_path, JELLY.format(shape=RING, spacing="0.08 m", more=""))
    held = kind.read("volume", state)
    assert held == pytest.approx(2 * math.pi**2 * 0.5 * 0.04, rel=0.03)
    m = state.floats[state.bodies.mass_at :][: state.bodies.count]
    assert m.min() > 0
    assert m.sum() == pytest.approx(500 * held, rel=1e-12)
    small = 1e-5
    energy, larger = strained(kind, state, np.eye(3) * (1 + small))
    assert energy == pytest.approx(3 * 30e3 * small**2 * held, rel=1e-6)  # 9/2 K strain^2, K = 2/3 E
    assert larger == pytest.approx(held * (1 + small) ** 3)
    assert kind.read("inverted", state) == 0
    mirrored = state.y.copy()
    mirrored[state.bodies.position_at : state.bodies.position_at + 3 * state.bodies.count : 3] *= -1
    assert kind.read("inverted", replace(state, y=mirrored)) == len(kind.net.tetrahedra)


def test_a_solid_is_stiff_alike_in_every_direction(tmp_path):
    """Poisson's ratio 1/4: 1.2 E along any axis, sides held. What is cut at the surface is not quite so."""
    kind, state, _ = state_of(tmp_path, JELLY.format(shape=BOX, spacing="0.05 m", more=""))
    small = 1e-5
    for axis in ([1, 0, 0], [1, 1, 0], [1, 1, 1]):
        way = np.array(axis) / math.sqrt(sum(axis))
        energy, _ = strained(kind, state, np.eye(3) + small * np.outer(way, way))
        assert energy == pytest.approx(0.5 * 1.2 * 30e3 * small**2, rel=0.02), axis
    sheared, _ = strained(kind, state, np.eye(3) + small * np.outer([1, 0, 0], [0, 1, 0]))
    assert sheared == pytest.approx(0.5 * 0.4 * 30e3 * small**2, rel=0.02)


def test_a_jelly_in_flight_keeps_momentum_and_energy(tmp_path):
    script = JELLY.format(shape=RING, spacing="0.15 m", more="spin: 0 1 2 rad/s")
    names = ("jelly.momentum", "jelly.angular_momentum", "jelly.energy", "jelly.volume", "jelly.inverted")
    start, end = watch(tmp_path, script, [0, 0.5], *names)
    for before, after in zip(start[:3], end[:3], strict=True):
        np.testing.assert_allclose(after, before, rtol=1e-6, atol=1e-9)
    assert end[3] == pytest.approx(start[3], rel=0.1)
    assert end[4] == 0


def test_a_retardation_damps_by_the_springs_stiffness(tmp_path):
    """What swells alike in every direction loses 9 K tau (strain rate)^2 of its volume, K = 2/3 E."""
    script = JELLY.format(shape=BOX, spacing="0.2 m", more="").replace("kPa}", "kPa, retardation: 2 ms}")
    kind, state, moment = state_of(tmp_path, script)
    assert kind.net.dampers == pytest.approx(2e-3 * kind.net.springs)
    swelling = state.y.copy()
    n, at, moving = 3 * state.bodies.count, state.bodies.position_at, state.bodies.velocity_at
    swelling[moving : moving + n] = 0.5 * state.y[at : at + n]
    rate = moment.run.islands[0].march.rate(0.0, swelling)
    assert rate[state.bodies.work_at] == pytest.approx(2 * 3 * 30e3 * 2e-3 * 0.5**2 * kind.read("volume", state))


def test_a_solid_draws_its_skin_less_what_tore(tmp_path):
    more = "tear: {at: 1.2}"
    kind, state, moment = state_of(tmp_path, JELLY.format(shape=RING, spacing="0.1 m", more=more))
    (own,) = kind.lower("jelly", state, moment)
    (skin,) = moment.lower(["skin"])
    assert isinstance(own, Mesh)
    assert (own.triangles == skin.triangles).all()
    assert edge_counts(own.triangles)[1:] == (0, 0)
    assert volume(own.vertices, own.triangles) == pytest.approx(kind.read("volume", state), rel=1e-12)
    numbers = state.floats.copy()
    blocks = numbers[state.ints[0] :][: 5 * len(kind.net.pairs)].reshape(-1, 5)
    torn = np.abs(kind.net.points[kind.net.pairs].mean(axis=1)[:, 2]) < 0.1
    blocks[torn] = 0.0
    cut = replace(state, floats=numbers)
    rest = kind.tetrahedra(cut)
    assert 0 < len(rest) < len(kind.net.tetrahedra)
    assert not set(map(tuple, edges(rest)[0])) & set(map(tuple, kind.net.pairs[torn]))
    skin = kind.read("triangles", cut).astype(int)
    assert edge_counts(skin)[1] == 0  # what is left is closed again, in two halves
    assert euler_characteristic(skin) == 4
    assert kind.read("volume", cut) == pytest.approx(volume(kind.net.points, skin), rel=1e-12)


def test_a_closed_mesh_is_filled_up_to_its_triangles(tmp_path):
    (tmp_path / "cube.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
        + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
    )
    shape = "mesh: {file: cube.obj, rotation: {xyz: 20 30 10 deg}, hidden: yes}"
    kind, state, _ = state_of(tmp_path, JELLY.format(shape=shape, spacing="0.1 m", more=""))
    skin = kind.net.triangles
    assert edge_counts(skin)[1:] == (0, 0)
    assert euler_characteristic(skin) == 2
    assert kind.read("volume", state) == pytest.approx(1, rel=0.02)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ("shear: 0.5", "tetrahedra have no shear"),
        ("cells: cubes, density: 1 kg/m^3", "cubes have no density"),
        ("cells: cubes, modulus: 1 Pa", "cubes have no modulus"),
        ("retardation: 1 ms", "a retardation needs a `modulus`"),
        ("density: 0 kg/m^3", "must be above 0"),
    ],
)
def test_fields_of_the_other_cells_are_told(tmp_path, fields, said):
    entry = f"objects: {{b: sphere}}\nmodels:\n  bad: {{mass_spring: {{solid: {{object: b, {fields}}}}}}}\n"
    assert said in complaint(tmp_path, entry)


def test_the_bound_on_the_step_knows_the_modulus(tmp_path):
    script = JELLY.format(shape=BOX, spacing="0.25 m", more="").replace("0.5 ms", "40 ms")
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    assert "the springs of 'jelly'" in str(load(path).warnings[0])
