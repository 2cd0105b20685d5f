"""Rigid bodies and elastic ones in one collision: by the barrier, with momentum kept and nothing crossed."""

import numpy as np
import pytest
from numpy.random import Generator, Philox

from barrier_energy_kernels import between_skins
from crossing import crossings
from sceneql.linear import newton_kernels
from sceneql.march.driver import limit
from sceneql.pipeline import load
from sceneql.run.run import Run
from sceneql.shapes.placement import rotation_matrix

LAW = "law: {neo_hookean: {modulus: 50 kPa, poisson: 0.3}}"
CUBE = f"block: {{size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}}, element: p1, {LAW}"


def run_of(tmp_path, text):
    path = tmp_path / "scene.yaml"
    path.write_text(text + "outputs: {film: {image: {size: 32 18}}}\n", encoding="utf-8")
    return Run(load(path, pruned=False)).islands[0]


def pair(tmp_path, solver="bdf2: {step: 5 ms}", friction=0.0, of="box: {size: 0.2 0.3 0.25 m"):
    """A rigid body that spins and flies at an elastic cube, with nothing else."""
    return run_of(
        tmp_path,
        f"clock: {{end: 0.3 s}}\nsolvers: {{main: {{{solver}}}}}\n"
        f"objects: {{b: {{{of}, position: -0.35 0.02 0.01 m, rotation: {{xyz: 20 30 10 deg}}}}}}}}\nmodels:\n"
        "  crate: {rigid: {of: b, density: 300 kg/m^3, velocity: 1.5 0 0 m/s, spin: 2 1 3 /s}}\n"
        f"  cube: {{elastic: {{{CUBE}, density: 1000 kg/m^3}}}}\n"
        f"contacts: {{touch: {{collision: {{between: [crate, cube], friction: {friction}}}}}}}\n",
    )


HALF = np.array([0.1, 0.15, 0.125])
CORNERS = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * HALF
SIDES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
BOX = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]])


def box_at(y, body):
    """Corners (8, 3) of the box of `pair`, by its state alone."""
    q = y[body.turning.rotation_at :][:4]
    return y[body.position_at :][:3] + CORNERS @ rotation_matrix(q / np.linalg.norm(q)).T


def crossed(y, island):
    crate, cube = island.bodies["crate"], island.bodies["cube"]
    places = np.concatenate([box_at(y, crate), y[cube.position_at :][: 3 * cube.count].reshape(-1, 3)])
    return crossings(places, np.concatenate([BOX, 8 + cube.skin.triangles]))


def pressed(island):
    """A state in which the crate presses on the cube at rest, edges on faces."""
    island.advance(0.0)
    march, crate = island.march, island.bodies["crate"]
    ask, y = limit(march.system), island.y.copy()
    for _ in range(6):
        moved = y.copy()
        moved[crate.position_at] += 0.3
        moved[crate.turning.rotation_at : crate.turning.rotation_at + 4] += (0.0, 0.05, 0.02, -0.03)
        y += 0.5 * ask(0.0, y, moved, march.floats, march.system.ints) * (moved - y)
    return y


def test_forces_and_torques_on_a_rigid_body_are_slopes_of_the_energy(tmp_path):
    island = pair(tmp_path)
    y = pressed(island)
    march, crate = island.march, island.bodies["crate"]
    ints = np.array(island.assembly.ints_of("sceneql.contacts.barrier.skin_forces_kernels:force"), dtype=np.int64)

    def value(y):
        return between_skins(0.0, y, march.floats, ints)

    assert value(y) > value(island.y) + 1e-6
    rate = march.rate(0.0, y)
    mass = march.floats[crate.mass_at]
    q = crate.turning.rotation_at
    for seed in range(4):
        way = Generator(Philox(seed)).standard_normal((2, 3))
        h, ends = 1e-7, []
        for sign in (h, -h):
            moved = y.copy()
            moved[crate.position_at : crate.position_at + 3] += sign * way[0]
            w, v = y[q], y[q + 1 : q + 4]
            moved[q] -= 0.5 * sign * way[1] @ v
            moved[q + 1 : q + 4] += 0.5 * sign * (w * way[1] + np.cross(way[1], v))
            ends.append(value(moved))
        power = mass * rate[crate.velocity_at :][:3] @ way[0] + rate[crate.turning.momentum_at :][:3] @ way[1]
        assert (ends[0] - ends[1]) / (2 * h) == pytest.approx(-power, rel=2e-4)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_forces_and_torques_between_them_balance_to_rounding(tmp_path, friction):
    island = pair(tmp_path, "dopri5", friction)
    y = pressed(island)
    march, crate, cube = island.march, island.bodies["crate"], island.bodies["cube"]
    rate = march.rate(0.0, y)
    masses = march.floats[cube.mass_at :][: cube.count, None]
    forces = masses * rate[cube.velocity_at :][: 3 * cube.count].reshape(-1, 3)
    own = march.floats[crate.mass_at] * rate[crate.velocity_at :][:3]
    assert np.linalg.norm(own) > 1.0
    assert forces.sum(axis=0) == pytest.approx(-own, abs=1e-11 * np.abs(forces).sum())
    torque = np.cross(y[cube.position_at :][: 3 * cube.count].reshape(-1, 3), forces).sum(axis=0)
    other = np.cross(y[crate.position_at :][:3], own) + rate[crate.turning.momentum_at :][:3]
    assert torque == pytest.approx(-other, abs=1e-11 * np.abs(forces).sum())


def test_a_limit_of_a_body_that_turns_is_short_of_crossing(tmp_path):
    island = pair(tmp_path)
    island.advance(0.0)
    march, crate = island.march, island.bodies["crate"]
    ask, y, short = limit(march.system), island.y.copy(), 0
    for seed in range(8):
        draw = Generator(Philox(seed))
        changed = y.copy()
        changed[crate.position_at : crate.position_at + 3] += 0.1 * draw.standard_normal(3) + (0.1, 0.0, 0.0)
        changed[crate.turning.rotation_at :][:4] += 0.8 * draw.standard_normal(4)
        part = ask(0.0, y, changed, march.floats, march.system.ints)
        short += part < 1.0
        for share in np.linspace(0, part, 12):
            assert crossed(y + share * (changed - y), island) == 0
    assert short > 3


@pytest.mark.parametrize(
    ("solver", "friction"),
    [("bdf2: {step: 5 ms}", 0.0), ("implicit_midpoint: {step: 5 ms}", 0.3), ("dopri5", 0.4), ("radau", 0.4)],
)
def test_nothing_passes_at_any_step_and_momentum_is_kept(tmp_path, solver, friction):
    island = pair(tmp_path, solver, friction)
    crate, cube = island.bodies["crate"], island.bodies["cube"]
    island.advance(0.0)

    def momenta():
        y, floats = island.y, island.march.floats
        v = y[cube.velocity_at :][: 3 * cube.count].reshape(-1, 3) * floats[cube.mass_at :][: cube.count, None]
        own = floats[crate.mass_at] * y[crate.velocity_at :][:3]
        turned = np.cross(y[cube.position_at :][: 3 * cube.count].reshape(-1, 3), v).sum(axis=0)
        turned += np.cross(y[crate.position_at :][:3], own) + y[crate.turning.momentum_at :][:3]
        return v.sum(axis=0) + own, turned

    first = momenta()
    for t in np.linspace(0, 0.3, 31):
        island.advance(t)
        assert crossed(island.y, island) == 0
    last = momenta()
    assert last[0] == pytest.approx(first[0], abs=1e-7)
    # Friction acts at the nearest places of both, which a gap of 5 mm is between: a couple of that arm at most.
    assert last[1] == pytest.approx(first[1], abs=friction * 0.005 * 3.5 + (1e-3 if "bdf2" in solver else 1e-6))
    assert island.y[cube.velocity_at :][: 3 * cube.count : 3].mean() > 0.3


def test_newtons_method_knows_all_slopes_of_a_solid_of_ten_nodes_beside_a_rigid_body(tmp_path):
    # Its inertia is a matrix: what the barrier adds in its rows stood beside its stiffness, and one of both was lost.
    island = run_of(
        tmp_path,
        "clock: {end: 0.1 s}\nsolvers: {main: {bdf2: {step: 5 ms}}}\nobjects: {b: {box: {size: 0.1 0.1 0.1 m}}}\n"
        "models:\n  crate: {rigid: {of: b}}\n"
        f"  cube: {{elastic: {{block: {{size: 0.2 0.2 0.2 m, cells: [1, 1, 1]}}, element: p2, {LAW}, "
        "position: 0 1 0 m}}\n"
        "forces: [gravity]\ncontacts: {touch: {collision: {between: [crate, cube]}}}\n",
    )
    island.advance(0.1)
    settings, steps = island.march._settings, island.march.statistics.steps
    assert steps <= 21
    assert settings[newton_kernels.ITERATIONS] <= 3 * steps


def at_rest(tmp_path, rigid, soft, end, density=500):
    """Rigid and soft one above the other on a floor, each given its object and its place."""
    return run_of(
        tmp_path,
        f"clock: {{end: {end} s}}\nsolvers: {{main: {{bdf2: {{step: 10 ms, newton: 1e-8}}}}}}\n"
        f"objects: {{floor: plane, b: {{{rigid}}}}}\n"
        f"models:\n  hard: {{rigid: {{of: b, density: {density} kg/m^3}}}}\n"
        f"  soft: {{elastic: {{{soft}, element: p1, density: 1000 kg/m^3, retardation: 50 ms, {LAW}}}}}\n"
        "forces: [gravity]\ncontacts: {touch: {collision: {between: [hard, soft, floor], friction: 0.4}}}\n",
    )


def forces_of(island, end, slow=5e-3):
    """Of each model the rate of momentum [N] at the end of the run, in which all has come to rest; and its weight."""
    island.advance(end)
    march, found = island.march, {}
    rate = march.rate(end, island.y)
    for name, b in island.bodies.items():
        masses = march.floats[b.mass_at :][: b.count]
        found[name] = masses @ rate[b.velocity_at :][: 3 * b.count].reshape(-1, 3), 9.81 * masses.sum()
        assert np.abs(island.y[b.velocity_at :][: 3 * b.count]).max() < slow
    return found


def test_a_soft_cube_comes_to_rest_on_a_crate_that_the_floor_bears(tmp_path):
    crate = "box: {size: 0.3 0.3 0.3 m, position: 0 0.155 0 m}"
    island = at_rest(tmp_path, crate, "block: {size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}, position: 0.02 0.42 0.01 m", 2.0)
    for force, weight in forces_of(island, 2.0).values():
        assert force == pytest.approx([0.0, 0.0, 0.0], abs=0.01 * weight)
    hard = island.bodies["hard"]
    x, q = island.y[hard.position_at :][:3], island.y[hard.turning.rotation_at :][:4]
    corners = x + (CORNERS / HALF * 0.15) @ rotation_matrix(q / np.linalg.norm(q)).T
    assert 0.0 < corners[:, 1].min() < 0.01
    soft = island.bodies["soft"]
    assert island.y[soft.position_at :][: 3 * soft.count].reshape(-1, 3)[:, 1].min() > corners[:, 1].max()


def test_a_ball_comes_to_rest_in_a_soft_block(tmp_path):
    ball = "sphere: {radius: 0.1 m, position: 0 0.33 0 m}"
    soft = "block: {size: 0.4 0.2 0.4 m, cells: [4, 2, 4]}, position: 0 0.11 0 m"
    island = at_rest(tmp_path, ball, soft, 0.8, 3000)
    for force, weight in forces_of(island, 0.8, 0.02).values():
        assert force == pytest.approx([0.0, 0.0, 0.0], abs=0.02 * weight)
    hard, soft = island.bodies["hard"], island.bodies["soft"]
    nodes = island.y[soft.position_at :][: 3 * soft.count].reshape(-1, 3)
    away = np.linalg.norm(nodes - island.y[hard.position_at :][:3], axis=1)
    assert 0.0995 < away.min() < 0.106  # within a gap of the ball, none inside
    assert nodes[:, 1].min() > 0.0
    assert island.march._settings[newton_kernels.ITERATIONS] <= 25 * island.march.statistics.steps
