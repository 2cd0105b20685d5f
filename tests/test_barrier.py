"""Contact of elastic solids by a barrier: nothing passes, friction is Coulomb's, forces are slopes of energies."""

import math

import numpy as np
import pytest
from numpy.random import Generator, Philox

from crossing import crossings
from friction_kernels import derivative, direction_after, direction_at
from sceneql.contacts.barrier import barrier_kernels
from sceneql.contacts.barrier.distance_kernels import edge_edge, point_triangle
from sceneql.failure import RunFailure
from sceneql.linear import newton_kernels
from sceneql.march.driver import energy, limit
from sceneql.pipeline import load
from sceneql.run.run import Run
from sceneql.system import channels

LAW = "law: {neo_hookean: {modulus: 50 kPa, poisson: 0.3}}"
CUBE = "block: {size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}, element: p1"


barrier, push, steepness, mobilized, friction_potential = (
    getattr(barrier_kernels, name).py_func
    for name in ("barrier", "push", "steepness", "mobilized", "friction_potential")
)


def run_of(tmp_path, text):
    path = tmp_path / "scene.yaml"
    path.write_text(text + "outputs: {film: {image: {size: 32 18}}}\n", encoding="utf-8")
    return Run(load(path, pruned=False)).islands[0]


def spelled(solver):
    return f"{{{solver}}}" if ":" in solver else solver


def two_cubes(tmp_path, solver="bdf2: {step: 5 ms}", friction=0.0, speed=2.0):
    """Two cubes that fly at one another, turned, so that edges cross."""
    return run_of(
        tmp_path,
        f"clock: {{end: 0.2 s}}\nsolvers: {{main: {spelled(solver)}}}\nmodels:\n"
        f"  one: {{elastic: {{{CUBE}, {LAW}, position: -0.15 0 0 m, velocity: {speed} 0 0 m/s}}}}\n"
        f"  two: {{elastic: {{{CUBE}, {LAW}, position: 0.15 0.05 0.02 m, rotation: {{xyz: 20 40 20 deg}}}}}}\n"
        f"contacts: {{touch: {{collision: {{between: [one, two], friction: {friction}}}}}}}\n",
    )


def dropped(tmp_path, solver, friction=0.0):
    return run_of(
        tmp_path,
        f"clock: {{end: 0.25 s}}\nsolvers: {{main: {spelled(solver)}}}\nobjects: {{floor: plane}}\n"
        f"models: {{body: {{elastic: {{{CUBE}, {LAW}, position: 0 0.2 0 m, rotation: {{xyz: 15 0 25 deg}}}}}}}}\n"
        "forces: [gravity]\n"
        f"contacts: {{touch: {{collision: {{between: [body, floor], friction: {friction}}}}}}}\n",
    )


def skins(island):
    """Places (n, 3) and triangles (m, 3) of all skins."""
    places, triangles, first = [], [], 0
    for bodies in island.bodies.values():
        places.append(island.y[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3))
        triangles.append(bodies.skin.triangles + first)
        first += bodies.count
    return np.concatenate(places), np.concatenate(triangles)


def to_segment(p, a, b):
    t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.linalg.norm(p - a - t * (b - a))


def test_distances_are_those_to_the_nearest_feature():
    draw = Generator(Philox(1))
    for k in range(400):
        x = draw.standard_normal((4, 3)) * (1.0, 1.0, 0.01 if k % 3 == 0 else 1.0)
        d, *_, u, v, w = point_triangle(x.ravel(), 0, 3, 6, 9)
        p, a, b, c = x
        normal = np.cross(b - a, c - a)
        inside = all(np.cross(t - s, p - s) @ normal > 0 for s, t in ((a, b), (b, c), (c, a)))
        plane = abs((p - a) @ normal) / np.linalg.norm(normal)
        known = plane if inside else min(to_segment(p, s, t) for s, t in ((a, b), (b, c), (c, a)))
        assert d == pytest.approx(known, rel=1e-9)
        assert np.linalg.norm(p - u * a - v * b - w * c) == pytest.approx(d, rel=1e-9)
        d, *_, s, t = edge_edge(x.ravel(), 0, 3, 6, 9)
        ends = [to_segment(p, b, c), to_segment(a, b, c), to_segment(b, p, a), to_segment(c, p, a)]
        grid = np.linspace(0, 1, 41)
        tried = np.linalg.norm((p + grid[:, None] * (a - p))[:, None] - (b + grid[:, None] * (c - b))[None], axis=2)
        assert d <= min(*ends, tried.min()) * (1 + 1e-9)
        assert np.linalg.norm(p + s * (a - p) - b - t * (c - b)) == pytest.approx(d, rel=1e-9)


def test_parallel_edges_have_a_distance():
    x = np.array([0.0, 0, 0, 1, 0, 0, 0.25, 0.5, 0, 2, 0.5, 0])
    assert edge_edge(x, 0, 3, 6, 9)[0] == pytest.approx(0.5)


def test_the_barrier_and_friction_are_the_slopes_of_their_potentials():
    for s in (0.01, 0.3, 0.9, 0.999):
        h = 1e-6 * s
        assert -(barrier(s + h) - barrier(s - h)) / (2 * h) == pytest.approx(push(s), rel=1e-5, abs=1e-9)
        assert -(push(s + h) - push(s - h)) / (2 * h) == pytest.approx(steepness(s), rel=1e-5, abs=1e-9)
        change = friction_potential(2 * s + h, 1.0) - friction_potential(2 * s - h, 1.0)
        assert change / (2 * h) == pytest.approx(2 * s * mobilized(2 * s, 1.0), rel=1e-5)
    assert barrier(1.0) == push(1.0) == steepness(1.0) == 0.0


def test_forces_between_skins_are_slopes_of_their_energy_and_positive_stiffness_is_near_theirs(tmp_path):
    island = two_cubes(tmp_path)
    island.advance(0.0)
    one = island.bodies["one"]
    march = island.march
    stored = energy(march.system)
    y = island.y.copy()
    own = slice(one.position_at, one.position_at + 3 * one.count)
    y[own] += np.tile([0.022, 0.0, 0.0], one.count)
    y[own] += 1e-4 * Generator(Philox(3)).standard_normal(3 * one.count)
    alone = stored(0.0, island.y, march.floats, march.system.ints)
    assert stored(0.0, y, march.floats, march.system.ints) > alone + 1e-6
    masses = np.repeat(march.floats[one.mass_at :][: one.count], 3)
    forces = march.rate(0.0, y)[one.velocity_at :][: 3 * one.count] * masses
    for seed in range(3):
        way, h = np.zeros(len(y)), 1e-8
        way[own] = Generator(Philox(seed)).standard_normal(3 * one.count)
        change = stored(0.0, y + h * way, march.floats, march.system.ints)
        change -= stored(0.0, y - h * way, march.floats, march.system.ints)
        assert change / (2 * h) == pytest.approx(-forces @ way[own], rel=2e-4)


def test_a_limit_is_short_of_crossing(tmp_path):
    island = two_cubes(tmp_path)
    island.advance(0.0)
    one, _ = island.bodies.values()
    march, y = island.march, island.y.copy()
    ask = limit(march.system)
    own = slice(one.position_at, one.position_at + 3 * one.count)
    places, triangles = skins(island)
    for seed in range(8):
        changed = y.copy()
        way = 0.3 * Generator(Philox(seed)).standard_normal(3) + (0.3, 0.0, 0.0)
        changed[own] += np.tile(way, one.count) + 0.02 * Generator(Philox(seed)).standard_normal(3 * one.count)
        part = ask(0.0, y, changed, march.floats, march.system.ints)
        whole = (changed - y)[own].reshape(-1, 3)
        for share in np.linspace(0, part, 12):
            moved = places.copy()
            moved[: one.count] += share * whole
            assert crossings(moved, triangles) == 0


@pytest.mark.parametrize(
    ("solver", "friction"),
    [("bdf2: {step: 5 ms}", 0.0), ("implicit_midpoint: {step: 5 ms}", 0.0), ("dopri5", 0.0), ("dopri5", 0.4)],
)
def test_nothing_passes_at_any_step_and_momentum_is_kept(tmp_path, solver, friction):
    island = two_cubes(tmp_path, solver, friction)
    for t in np.linspace(0, 0.2, 41):
        island.advance(t)
        assert crossings(*skins(island)) == 0
    momentum = sum(
        (
            island.march.floats[b.mass_at :][: b.count, None] * island.y[b.velocity_at :][: 3 * b.count].reshape(-1, 3)
        ).sum(0)
        for b in island.bodies.values()
    )
    assert momentum == pytest.approx([2.0 * 8.0, 0.0, 0.0], abs=1e-6)
    two = island.bodies["two"]
    assert island.y[two.velocity_at :][: 3 * two.count].reshape(-1, 3)[:, 0].mean() > 0.5


@pytest.mark.parametrize(
    ("solver", "friction"),
    [("bdf2: {step: 5 ms}", 0.0), ("verlet: {step: 0.2 ms}", 0.3), ("radau", 0.4), ("dop853", 0.4)],
)
def test_a_solid_stays_above_a_floor(tmp_path, solver, friction):
    island = dropped(tmp_path, solver, friction)
    for t in np.linspace(0, 0.25, 26):
        island.advance(t)
        assert skins(island)[0][:, 1].min() > 0.0
    assert island.y[next(iter(island.bodies.values())).velocity_at + 1 :: 3].max() > 0.1
    assert island.march.statistics.evaluations < 40_000


def test_auto_takes_a_fast_soft_solid_through_its_impact(tmp_path):
    island = run_of(
        tmp_path,
        "clock: {end: 0.15 s}\nobjects: {floor: plane}\nmodels:\n"
        "  jelly: {elastic: {block: {size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}, element: p1, velocity: 0 -3 0 m/s,"
        " position: 0 0.15 0 m, law: {neo_hookean: {modulus: 20 kPa, poisson: 0.4}}}}\nforces: [gravity]\n"
        "contacts: {touch: {collision: {between: [jelly, floor], friction: 0.4}}}\n",
    )
    y, _ = island.march.advance(0.15)
    assert 72 <= island.march.statistics.steps <= 108  # those of tr_bdf2, some halved
    bodies = island.bodies["jelly"]
    assert y[bodies.position_at : bodies.position_at + 3 * bodies.count].reshape(-1, 3)[:, 1].min() > 0.0


def test_auto_leaves_a_soft_ball_its_energy_as_it_bounces(tmp_path):
    """Nothing takes any: steps of bdf2 of 1/240 s took 8.6 J of the 26.8 J in 0.1 s, until it had left the floor."""
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 0.1 s}\nobjects: {floor: plane, round: {sphere: {radius: 0.15 m, position: 0 0.3 0 m}}}\n"
        "models:\n  ball: {elastic: {of: round, spacing: 7 cm, element: p1, velocity: 0 -2 0 m/s, "
        "law: {neo_hookean: {modulus: 100 kPa, poisson: 0.4}}}}\nforces: [gravity]\n"
        "contacts: {touch: {collision: {between: [ball, floor]}}}\noutputs: {film: {image: {size: 32 18}}}\n",
        encoding="utf-8",
    )
    run = Run(load(path, pruned=False))
    first, kinetic = (float(run.at(0.0).read("ball", name)) for name in ("energy", "kinetic"))
    assert float(run.at(0.1).read("ball", "energy")) == pytest.approx(first, abs=0.06 * kinetic)


def test_friction_is_the_same_by_implicit_and_explicit_methods(tmp_path):
    ends = []
    for solver in ("radau", "dop853", "verlet: {step: 0.1 ms}"):
        island = dropped(tmp_path, solver, 0.4)
        island.advance(0.2)
        body = island.bodies["body"]
        ends.append(island.y[body.position_at :][: 3 * body.count].reshape(-1, 3).mean(axis=0))
    assert ends[1] == pytest.approx(ends[0], abs=2e-4)
    assert ends[2] == pytest.approx(ends[0], abs=2e-4)
    assert ends[0][0] > 0.01  # it lands on a corner and is thrown aside


@pytest.mark.parametrize("fields", ["modulus: 20 kPa, poisson: 0.4", "modulus: 500 kPa, poisson: 0.3"])
def test_friction_that_sticks_and_slips_at_an_impact_takes_few_updates(tmp_path, fields):
    island = run_of(
        tmp_path,
        "clock: {end: 0.04 s}\nsolvers: {main: {bdf2: {step: 4 ms}}}\nobjects: {table: {box: {size: 2 0.2 2 m, "
        "position: 0 -0.1 0 m}}}\nmodels:\n  body: {elastic: {block: {size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}, "
        f"element: p2, law: {{neo_hookean: {{{fields}}}}}, position: 0 0.16 0 m, velocity: 1 -2 0 m/s, "
        "rotation: {xyz: 15 0 25 deg}}}\nforces: [gravity]\n"
        "contacts: {touch: {collision: {between: [body, table], friction: 0.4}}}\n",
    )
    island.advance(0.04)
    assert island.march._settings[newton_kernels.ITERATIONS] <= 30 * island.march.statistics.steps
    assert island.march.statistics.steps == 10


def test_a_ball_that_lands_takes_few_factorizations_a_stage(tmp_path):
    island = run_of(
        tmp_path,
        "objects: {floor: plane, shape: {sphere: {radius: 0.2 m, position: 0 0.203 0 m, hidden: yes}}}\nmodels:\n"
        "  body: {elastic: {of: shape, spacing: 12 cm, element: p2, velocity: 0 -2.5 0 m/s, "
        "law: {neo_hookean: {modulus: 50 kPa, poisson: 0.4}}}}\nforces: [gravity]\n"
        "contacts: {touch: {collision: {between: [body, floor], friction: 0.4}}}\n",
    )
    island.advance(0.1)
    stages = island.march.floats[channels.STAGES]
    assert island.march._settings[newton_kernels.FACTORIZATIONS] <= 6 * stages
    assert island.march.statistics.rejected <= 2


def test_friction_of_skins_that_roll_over_one_another_takes_few_updates_a_stage(tmp_path):
    ball = "elastic: {of: %s, spacing: 10 cm, element: p1, law: {neo_hookean: {modulus: 50 kPa, poisson: 0.4}}"
    island = run_of(
        tmp_path,
        "objects: {a: {sphere: {radius: 0.2 m, position: -0.201 1 0 m}}, "
        "b: {sphere: {radius: 0.2 m, position: 0.202 1.05 0 m}}}\nmodels:\n"
        f"  one: {{{ball % 'a'}, velocity: 1 0 0 m/s}}}}\n  two: {{{ball % 'b'}, velocity: -1 0 0 m/s}}}}\n"
        "contacts: {touch: {collision: {between: [one, two], friction: 0.3}}}\n",
    )
    island.advance(0.06)
    assert island.march._settings[newton_kernels.ITERATIONS] <= 9 * island.march.floats[channels.STAGES]
    assert island.march.statistics.rejected == 0


def matrix(normal, u, p, slip):
    xx, xy, xz, yy, yz, zz = derivative(normal, u, p, slip)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def test_slopes_of_friction_are_its_derivative_where_its_direction_is_known_and_positive_else():
    draw = Generator(Philox(5))
    for k in range(60):
        normal = draw.standard_normal(3)
        normal /= np.linalg.norm(normal)
        across = np.eye(3) - np.outer(normal, normal)
        slip = 0.3 * 4.0 ** (k % 5 - 2)
        u = across @ draw.standard_normal(3)

        def friction(u, slip=slip):
            return mobilized(np.linalg.norm(u), slip) * u

        known = np.array(direction_at(u, slip))
        assert known == pytest.approx(friction(u), rel=1e-12)
        way, h = across @ draw.standard_normal(3), 1e-6 * slip
        change = (friction(u + h * way) - friction(u - h * way)) / (2 * h)
        assert matrix(normal, u, known, slip) @ way == pytest.approx(change, rel=1e-5, abs=1e-6 / slip)
        p = across @ draw.standard_normal(3)
        there = np.array(direction_after(p / max(1.0, np.linalg.norm(p)), u, across @ draw.standard_normal(3), slip))
        assert np.linalg.norm(there) <= 1.0 + 1e-12
        assert np.linalg.eigvalsh(matrix(normal, u, there, slip))[0] > -1e-12 / slip


def test_beside_barriers_solids_are_factored_however_many_nodes_they_have(tmp_path, monkeypatch):
    """Iterations on systems as stiff took two to three times as long, from 3000 nodes on."""
    monkeypatch.setattr("sceneql.linear.stage.SOLID_GROUPS", 50)
    body = "block: {size: 0.2 0.2 0.2 m, cells: [3, 3, 3]}, element: p2"
    island = run_of(
        tmp_path,
        "clock: {end: 0.1 s}\nsolvers: {main: {bdf2: {step: 5 ms}}}\nobjects: {floor: plane}\nforces: [gravity]\n"
        f"models: {{body: {{elastic: {{{body}, {LAW}, position: 0 0.2 0 m}}}}}}\n"
        "contacts: {touch: {collision: {between: [body, floor]}}}\n",
    )
    assert "sparse factorization" in island.march.prepared_text


def test_pairs_that_come_near_get_places_once(tmp_path):
    island = two_cubes(tmp_path)
    island.advance(0.2)
    assert 1 <= island.march.statistics.orderings <= 12


def test_a_given_step_of_an_explicit_method_fails_where_surfaces_would_pass(tmp_path):
    island = two_cubes(tmp_path, "rk4: {step: 1 ms}", speed=1000.0)
    with pytest.raises(RunFailure, match="surfaces would pass through one another"):
        island.advance(0.2)


def on_incline(tmp_path, friction, stiff, time, speed=0.0, solver="bdf2: {step: 5 ms, newton: 1e-8}"):
    """The mass-weighted way along an incline of tangent 0.5 of a block that presses on it in balance."""
    angle = math.atan(0.5)
    slope = f"{9.81 * math.sin(angle)} {-9.81 * math.cos(angle)} 0 m/s^2"
    wanted, s = 200.0 * 9.81 * math.cos(angle) / stiff, 1.0
    while push(s) < wanted:
        s -= 1e-4
    island = run_of(
        tmp_path,
        f"clock: {{end: {time} s}}\nsolvers: {{main: {spelled(solver)}}}\nobjects: {{floor: plane}}\n"
        f"models: {{body: {{elastic: {{block: {{size: 0.4 0.2 0.4 m, cells: [2, 1, 2]}}, element: p1, "
        f"position: 0 {0.1 + 0.001 * s} 0 m, velocity: {speed} 0 0 m/s, "
        f"law: {{neo_hookean: {{modulus: {stiff} Pa, poisson: 0.3}}}}}}}}}}\n"
        f"forces: {{down: {{gravity: {{acceleration: {slope}}}}}}}\n"
        f"contacts: {{touch: {{collision: {{between: [body, floor], friction: {friction}, gap: 1 mm}}}}}}\n",
    )
    body = island.bodies["body"]
    island.advance(0.0)
    masses = island.march.floats[body.mass_at :][: body.count]
    start = np.average(island.y[body.position_at :][: 3 * body.count : 3], weights=masses)
    island.advance(time)
    return np.average(island.y[body.position_at :][: 3 * body.count : 3], weights=masses) - start


@pytest.mark.parametrize("friction", [0.1, 0.3, 0.45, 0.49, 0.51, 0.6])
def test_a_stiff_block_slides_or_sticks_on_an_incline(tmp_path, friction):
    exact = max(0.0, 9.81 * 0.25 * (0.5 - friction) / math.sqrt(5))
    assert on_incline(tmp_path, friction, 1e8, 0.5) == pytest.approx(exact, abs=3e-4)


@pytest.mark.parametrize("friction", [0.1, 0.3, 0.45])
def test_a_soft_block_that_slides_is_braked_by_the_force_that_presses_it(tmp_path, friction):
    exact = 0.5 + 9.81 * 0.25 * (0.5 - friction) / math.sqrt(5)
    assert on_incline(tmp_path, friction, 1e6, 0.5, speed=1.0) == pytest.approx(exact, abs=3e-4)


@pytest.mark.parametrize("solver", ["dopri5", "verlet: {step: 0.1 ms}", "semi_implicit_euler: {step: 0.1 ms}"])
def test_a_block_that_slides_is_braked_as_much_by_explicit_methods(tmp_path, solver):
    exact = 0.3 + 9.81 * 0.09 * 0.2 / math.sqrt(5)
    assert on_incline(tmp_path, 0.3, 1e6, 0.3, 1.0, solver) == pytest.approx(exact, abs=5e-4)


def test_a_damped_solid_that_falls_freely_ends_each_step_at_rounding(tmp_path):
    island = run_of(
        tmp_path,
        "clock: {end: 0.1 s}\nsolvers: {main: {bdf2: {step: 10 ms, newton: 1e-4}}}\nobjects: {floor: plane}\n"
        f"models: {{body: {{elastic: {{{CUBE}, {LAW}, retardation: 4 ms, position: 0 1 0 m, "
        "rotation: {about: [1, 0, 1], angle: -50 deg}}}}\nforces: [gravity]\n"
        "contacts: {touch: {collision: {between: [body, floor], friction: 0.3}}}\n",
    )
    island.advance(0.1)
    assert island.march.statistics.evaluations < 100


def test_newtons_method_leaves_a_part_of_what_a_step_of_bdf2_errs(tmp_path):
    """Where no `newton` is written: by 1e-10 this took 151 updates in place of 96."""
    found = []
    for fields in ("step: 10 ms", "step: 10 ms, newton: 1e-10", "step: 2.5 ms, newton: 1e-10"):
        island = run_of(
            tmp_path,
            f"clock: {{end: 0.1 s}}\nsolvers: {{main: {{bdf2: {{{fields}}}}}}}\nobjects: {{floor: plane}}\nmodels:\n"
            f"  body: {{elastic: {{block: {{size: 0.2 0.2 0.2 m, cells: [3, 3, 3]}}, element: p1, {LAW}, "
            "position: 0 0.17 0 m, velocity: 1 -1 0 m/s, rotation: {xyz: 15 0 25 deg}}}\nforces: [gravity]\n"
            "contacts: {touch: {collision: {between: [body, floor], friction: 0.4}}}\n",
        )
        island.advance(0.1)
        body = island.bodies["body"]
        places = island.y[body.position_at :][: 3 * body.count].copy()
        found.append((places, island.march._settings[newton_kernels.ITERATIONS]))
    (own, few), (exact, many), (right, _) = found
    assert few <= 0.75 * many
    assert abs(own - exact).max() <= 2e-2 * abs(exact - right).max()
