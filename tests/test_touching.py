"""Masses that touch: impacts at one instant, rest without chatter, piles whose energy is accounted, exact paddles."""

import math

import numpy as np
import pytest

from runs import watch
from sceneql.contacts.mutual.simultaneous_kernels import collide_at_once
from sceneql.pipeline import load
from sceneql.report.explain import explain, text

CRADLE = """
clock: {end: 0.7 s}
models:
  c:
    mass_spring:
      masses: {MASSES}
      springs: [SPRINGS]
      pins: [PINS]
      mass: 1 kg
      radius: 0.1 m
forces: [gravity]
objects: {}
contacts: {hit: {mutual_collision: {restitution: 1, mode: MODE}}}
solvers: {main: {dopri5: {tolerance: 1e-9}}}
outputs: {film: {video: {}}}
"""


def cradle(count, mode, pulled=1):
    """Balls on threads of a meter that touch, the first ones pulled aside."""
    masses, springs = [], []
    for k in range(count):
        angle, x = -0.5 if k < pulled else 0.0, 0.2 * k
        masses.append(f"t{k}: {{position: {x} 0 0 m}}")
        masses.append(f"b{k}: {{position: {x + math.sin(angle)} {-math.cos(angle)} 0 m}}")
        springs.append(f"{{between: [t{k}, b{k}], stiffness: 10 kN/m, rest: 1 m}}")
    words = {"MASSES": ", ".join(masses), "SPRINGS": ", ".join(springs), "MODE": mode}
    script = CRADLE.replace("PINS", ", ".join(f"t{k}" for k in range(count)))
    for word, said in words.items():
        script = script.replace(word, said)
    return script


ROWS = [(5, 1, "exact"), (5, 2, "exact"), *((5, pulled, "local") for pulled in (1, 2, 3, 4)), (9, 3, "local")]


@pytest.mark.parametrize(("count", "pulled", "mode"), ROWS)
def test_a_hanging_cradle_gives_out_as_many_balls_as_come_in(tmp_path, count, pulled, mode):
    outputs = ("c.positions", "c.velocities", "c.energy", "hit.hits.count")
    start, one, end = watch(tmp_path, cradle(count, mode, pulled), [0, 0.6, 0.7], *outputs)
    v = one[1][1::2, 0]
    np.testing.assert_allclose(v[: count - pulled], 0, atol=3e-3)
    assert min(v[count - pulled :]) > 1.4
    assert np.diff(end[0][1::2, 0]).min() > 0.2 - 1e-3
    if mode == "exact":
        assert end[2] == pytest.approx(start[2], abs=1e-6)
        assert end[3] < 1000


def test_explain_tells_how_many_pairs_of_a_net_do_not_collide_and_why(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(cradle(9, "local"), encoding="utf-8")
    assert "hit: left out: pairs of one net, 9 that springs tie\n" in text(explain(load(path)))
    path.write_text(cradle(9, "local").replace("radius: 0.1 m", "radius: 0.11 m"), encoding="utf-8")
    said = text(explain(load(path)))
    assert "9 that springs tie and 15 that overlap at the start\n" in said


def test_a_pair_at_rest_that_a_weak_spring_presses_does_not_chatter(tmp_path):
    script = """
clock: {end: 1 s}
models:
  c:
    mass_spring:
      masses: {a: {position: 0 0 0 m, velocity: 1 0 0 m/s}, b: {position: 0.4 0 0 m}, d: {position: 0.6 0 0 m}}
      springs: [{between: [a, b], stiffness: 1e-9 N/m}]
      mass: 1 kg
      radius: 0.1 m
forces: []
contacts: {hit: {mutual_collision: {restitution: 1, mode: exact}}}
"""
    ((v, count, energy),) = watch(tmp_path, script, [1], "c.velocities", "hit.hits.count", "c.energy")
    np.testing.assert_allclose(v[:, 0], [0, 0, 1], atol=1e-9)
    assert count == 2
    assert energy == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("gap", [0.0, 1e-12])
@pytest.mark.parametrize("count", [2, 5, 9])
@pytest.mark.parametrize("ratio", [1.0, 1.7])
def test_a_row_of_touching_balls_keeps_momentum_and_energy(tmp_path, count, gap, ratio):
    places = [-1.0, *((0.2 + gap) * k for k in range(count - 1))]
    rows = ", ".join(
        f"p{k}: {{position: {x!r} 0 0 m, velocity: {float(k == 0)} 0 0 m/s, mass: {ratio ** (k % 3)!r} kg, "
        f"radius: 0.1 m}}"
        for k, x in enumerate(places)
    )
    script = f"""
clock: {{end: 2 s}}
models: {{b: {{particles: {{list: {{{rows}}}}}}}}}
forces: []
contacts: {{hit: {{mutual_collision: {{restitution: 1, mode: exact}}}}}}
"""
    outputs = ("b.momentum", "b.kinetic", "b.velocities", "hit.hits.count")
    start, end = watch(tmp_path, script, [0, 2], *outputs)
    np.testing.assert_allclose(end[0], start[0], rtol=1e-12, atol=1e-12)
    assert end[1] == pytest.approx(start[1], rel=1e-12)
    assert np.diff(end[2][:, 0]).min() > -1e-9
    assert end[3] < 100
    if ratio == 1.0:
        assert end[3] == count - 1
        np.testing.assert_allclose(end[2][:, 0], [0.0] * (count - 1) + [1.0], atol=1e-12)


def at_once(places, velocities, masses, restitution=1.0):
    """Velocities after the impacts of balls of diameter 1, and their number."""
    x, v, m = (np.array(given, dtype=float) for given in (places, velocities, masses))
    i, j = np.triu_indices(len(x), 1)
    near = np.linalg.norm(x[i] - x[j], axis=1) < 1 + 1e-9
    pairs, normals = np.column_stack([i, j])[near], (x[i] - x[j])[near]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    lost, kinetic = np.zeros(len(pairs)), 0.5 * m @ (v**2).sum(axis=1)
    hits = collide_at_once(pairs, np.ascontiguousarray(normals), 1 / m, restitution, 0.0, 0.0, v, lost)
    assert 0.5 * m @ (v**2).sum(axis=1) + lost.sum() == pytest.approx(kinetic, rel=1e-14)
    return v, hits


LINE = [(k, 0, 0) for k in range(5)]


@pytest.mark.parametrize(
    ("masses", "before", "after"),
    [
        ([1, 1, 1, 1, 1], [1, 0, 0, 0, 0], [0, 0, 0, 0, 1]),
        ([1, 1, 1, 1, 1], [1, 1, 0, 0, 0], [0, 0, 0, 1, 1]),
        ([0.5, 1, 1, 1, 1], [1, 0, 0, 0, 0], [-1 / 3, 0, 0, 0, 2 / 3]),
    ],
)
def test_impulses_go_through_a_cradle_in_a_chain(masses, before, after):
    v, _ = at_once(LINE, [(one, 0, 0) for one in before], masses)
    np.testing.assert_allclose(v[:, 0], after, atol=1e-15)


def test_a_ball_that_strikes_two_at_once_leaves_them_symmetric():
    """Bernoulli's problem: lines of centers at 30 degrees."""
    high = math.sqrt(3) / 2
    places = [(0, 0, 0), (high, 0.5, 0), (high, -0.5, 0)]
    v, _ = at_once(places, [(1, 0, 0), (0, 0, 0), (0, 0, 0)], [1, 1, 1])
    want = [(-1 / 5, 0, 0), (3 / 5, math.sqrt(3) / 5, 0), (3 / 5, -math.sqrt(3) / 5, 0)]
    np.testing.assert_allclose(v, want, atol=1e-15)


@pytest.mark.parametrize("restitution", [0.0, 0.05, 0.9])
def test_what_impacts_at_one_instant_lose_leaves_none_approaching(restitution):
    v, hits = at_once(LINE, [(1, 0, 0)] + 4 * [(0, 0, 0)], [1, 1, 1, 1, 1], restitution)
    assert v[:, 0].sum() == pytest.approx(1, abs=1e-14)
    assert np.diff(v[:, 0]).min() > -1e-12
    if restitution < 0.1:  # infinitely many impacts in finite time, or one: they end together
        np.testing.assert_allclose(v[:, 0], 0.2, atol=1e-7)
    else:
        assert v[4, 0] == pytest.approx(0.95**4, abs=1e-12)
        assert hits == 10


COLUMN = """
clock: {end: 1.2 s}
models: {b: {particles: {fill: {count: 11, object: crate}, mass: 0.1 kg, radius: 0.04 m}}}
forces: [gravity]
objects:
  crate: {box: {size: 0.2 3 0.2 m, position: 0 1.6 0 m}}
  floor: plane
  left: {plane: {position: -0.15 0 0 m, normal: 1 0 0}}
  right: {plane: {position: 0.15 0 0 m, normal: -1 0 0}}
  back: {plane: {position: 0 0 -0.15 m, normal: 0 0 1}}
  front: {plane: {position: 0 0 0.15 m, normal: 0 0 -1}}
contacts:
  ground: {collision: {between: [b, floor, left, right, back, front], restitution: 0}}
  each: {mutual_collision: {between: [b, floor, left, right, back, front], restitution: 0}}
solvers: {main: {rk4: {step: 2 ms}}}
"""


def test_the_energy_of_a_confined_pile_is_accounted(tmp_path):
    outputs = ("b.energy", "b.kinetic", "b.potential", "b.positions")
    rows = watch(tmp_path, COLUMN, np.linspace(0, 1.2, 13), *outputs)
    for energy, kinetic, potential, x in rows:
        assert energy == pytest.approx(rows[0][0], rel=1e-4)
        assert kinetic + potential < rows[0][0] * (1 + 1e-9)
        assert np.abs(x[:, [0, 2]]).max() < 0.11 + 1e-2
    assert rows[-1][1] < 0.01


@pytest.mark.parametrize("restitution", [0, 0.5])
def test_masses_of_a_dense_pile_do_not_sink_into_each_other_and_come_to_rest(tmp_path, restitution):
    places = np.stack(np.meshgrid([-0.09, 0, 0.09], 0.09 * np.arange(1, 9), [-0.09, 0, 0.09]), axis=-1).reshape(-1, 3)
    places += np.random.default_rng(1).uniform(-0.004, 0.004, places.shape)
    rows = ", ".join(f"p{k}: {{position: {x!r} {y!r} {z!r} m}}" for k, (x, y, z) in enumerate(places.tolist()))
    script = COLUMN.replace("fill: {count: 11, object: crate}", f"list: {{{rows}}}")
    script = script.replace("restitution: 0", f"restitution: {restitution}, friction: 0.2")
    script = script.replace("1.2 s", "2 s").replace("2 ms", "4 ms")
    start, *after = watch(tmp_path, script, [0, 0.5, 1, 2], "b.energy", "b.positions", "b.velocities")
    i, j = np.triu_indices(len(places), 1)
    for energy, x, _ in after:
        assert energy == pytest.approx(start[0], rel=1e-3)
        assert np.linalg.norm(x[i] - x[j], axis=1).min() > 0.08 - 4e-5
        assert np.abs(x[:, [0, 2]]).max() < 0.11 + 4e-5
    assert np.linalg.norm(after[-1][2], axis=1).max() < 1e-3


PADDLE = """
clock: {end: 0.3 s}
models: {ball: {particles: {list: {a: {position: START, velocity: -1 0 0 m/s, radius: 0.05 m, mass: 1 kg}}}}}
forces: []
objects: {paddle: {box: {size: 0.1 1 1 m, MOTION}}}
contacts: {hit: {collision: {between: [ball, paddle], restitution: 1, mode: exact}}}
"""
OUT = ("ball.a.velocity", "hit.hits.first.time")


def test_a_ball_leaves_a_paddle_at_the_speed_of_its_formula(tmp_path):
    motion = 'position: ["-0.2 m + 0.1 m*sin(40*time/(1 s))", 0 m, 0 m]'
    script = PADDLE.replace("START", "0 0 0 m").replace("MOTION", motion)
    ((v, t),) = watch(tmp_path, script, [0.3], *OUT)
    assert v[0] == pytest.approx(1 + 8 * math.cos(40 * t), abs=1e-10)


def test_a_ball_leaves_a_turning_paddle_at_the_speed_of_its_formula(tmp_path):
    motion = "position: -0.2 0 0 m, rotation: {about: z, angle: 0.5*sin(20*time/(1 s))}"
    script = PADDLE.replace("START", "0.1 0.3 0 m").replace("MOTION", motion)
    ((v, t),) = watch(tmp_path, script, [0.3], *OUT)
    angle, spin = 0.5 * math.sin(20 * t), 10 * math.cos(20 * t)
    normal = np.array([math.cos(angle), math.sin(angle), 0])
    apart = np.array([0.3 - t, 0.3, 0])
    surface = spin * np.array([-apart[1], apart[0], 0])
    came = np.array([-1.0, 0, 0])
    np.testing.assert_allclose(v, came - 2 * ((came - surface) @ normal) * normal, atol=1e-10)
