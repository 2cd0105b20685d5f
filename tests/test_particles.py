"""Particles that fill shapes, are born and die: exact births, chance by counters, places inside."""

import math

import numpy as np
import pytest

from runs import complaint, watch
from sceneql import pipeline
from sceneql.bodies.emitter_kernels import draw
from sceneql.bodies.filling.winding import winding
from sceneql.quantities.chance import random

G = 9.81
FOUNTAIN = """
clock: {{end: 2 s}}
models:
  fountain:
    particles:
      emit: {{rate: 300 Hz, from: 0 0.1 0 m, velocity: 0 4 0 m/s, spread: 10 deg, variation: 0.1, lifetime: 1 s{more}}}
      mass: 1 g
forces: [gravity]
solvers: {{main: {{{solver}}}}}
"""


def thrown(ages, x, v):
    """Where each was born, and how fast, by the parabola that it has flown."""
    start = v + np.array([0, G, 0]) * ages[:, None]
    return x - start * ages[:, None] + 0.5 * np.array([0, G, 0]) * ages[:, None] ** 2, start


@pytest.mark.parametrize("solver", ["rk4: {step: 10 ms}", "rk4: {step: 37 ms}", "dopri5: {tolerance: 1e-6}"])
def test_a_particle_flies_its_parabola_from_the_instant_of_its_birth(tmp_path, solver):
    script = FOUNTAIN.format(solver=solver, more="")
    names = ("fountain.ages", "fountain.positions", "fountain.velocities", "fountain.count")
    for t, (ages, x, v, count) in zip((0.5, 1.61, 2), watch(tmp_path, script, [0.5, 1.61, 2], *names), strict=True):
        births = np.round((t - ages) * 300)
        np.testing.assert_allclose(ages, t - births / 300, atol=1e-12)
        assert len(np.unique(births)) == len(births) == count
        old = ages > 0.04  # its velocity is that of a whole step
        where, speed = thrown(ages, x, v)
        np.testing.assert_allclose(where[old], np.broadcast_to([0, 0.1, 0], where[old].shape), atol=1e-10)
        speeds = np.linalg.norm(speed, axis=1)[old]
        assert 3.6 - 1e-9 <= speeds.min() < 3.7
        assert 4.3 < speeds.max() <= 4.4 + 1e-9
        tilts = np.degrees(np.arccos(speed[old, 1] / speeds))
        assert 8 < tilts.max() <= 10 + 1e-6


def test_the_shower_is_the_same_at_any_step_and_frame_rate(tmp_path):
    seen = []
    for solver in ("rk4: {step: 5 ms}", "rk4: {step: 16 ms}"):
        for times in ([1.9], [k / 24 for k in range(40)] + [1.9]):
            script = FOUNTAIN.format(solver=solver, more="")
            seen.append(watch(tmp_path, script, times, "fountain.positions")[-1][0])
    np.testing.assert_array_equal(seen[0], seen[1])
    np.testing.assert_array_equal(seen[2], seen[3])
    np.testing.assert_allclose(seen[0], seen[2], atol=1e-10)


def test_another_seed_is_another_shower(tmp_path):
    one, two = (
        watch(tmp_path, FOUNTAIN.format(solver="rk4: {step: 10 ms}", more=f", seed: {k}"), [1], "fountain.center")
        for k in (1, 2)
    )
    assert np.abs(one[0][0] - two[0][0]).max() > 1e-4


def test_no_more_live_than_may_and_no_more_are_born_than_shall(tmp_path):
    def counts(more):
        script = FOUNTAIN.format(solver="rk4: {step: 10 ms}", more=more)
        return [row[0] for row in watch(tmp_path, script, [0, 0.5, 2], "fountain.count")]

    assert counts(", most: 40")[1:] == [40, 40]
    assert counts(", count: 100") == [0, 100, 0]
    assert counts(", start: 0.2 s, until: 0.4 s")[1:] == [61, 0]


def test_births_from_a_moving_source_leave_no_clumps(tmp_path):
    script = """
clock: {end: 1 s}
models:
  drip:
    particles:
      emit: {rate: 100 Hz, from: [3 m/s * time, 0 m, 0 m], velocity: 0 0 0 m/s, lifetime: 2 s}
solvers: {main: {rk4: {step: 45 ms}}}
"""
    ((x, ages),) = watch(tmp_path, script, [1], "drip.positions", "drip.ages")
    np.testing.assert_allclose(x[:, 0], 3 * (1 - ages), atol=1e-12)


def test_what_is_not_alive_weighs_nothing(tmp_path):
    script = FOUNTAIN.format(solver="rk4: {step: 10 ms}", more=", count: 3")
    names = ("fountain.momentum", "fountain.kinetic", "fountain.potential", "fountain.positions", "fountain.center")
    ((p, kinetic, potential, x, center),) = watch(tmp_path, script, [1.9], *names)
    assert len(x) == 0
    assert kinetic == potential == 0
    np.testing.assert_array_equal([*p, *center], 0)


def test_chance_in_kernels_is_chance_in_scripts():
    for birth, number, key in ((0, 0, 0), (7, 3, 12345), (2**32 - 1, 4, 2**32 - 1)):
        assert draw(birth, number, key) == random(birth, number, key)


FILLED = """
objects:
  body: {{{shape}}}
models:
  grains: {{particles: {{fill: {{object: body, {how}}}, mass: 1 g}}}}
"""
BALL = "sphere: {radius: 0.5 m, position: 1 2 3 m, hidden: yes}"


@pytest.mark.parametrize("how", ["count: 3000", "count: 3000, pattern: even", "spacing: 6 cm, pattern: grid"])
def test_a_ball_is_filled_evenly(tmp_path, how):
    ((x,),) = watch(tmp_path, FILLED.format(shape=BALL, how=how), [0], "grains.positions")
    away = np.linalg.norm(x - [1, 2, 3], axis=1)
    assert away.max() <= 0.5
    np.testing.assert_allclose(x.mean(axis=0), [1, 2, 3], atol=0.02)
    assert np.mean((away / 0.5) ** 3) == pytest.approx(0.5, abs=0.05)
    if "count" in how:
        assert len(x) == 3000
    else:
        assert len(x) * 0.06**3 == pytest.approx(math.pi / 6, rel=0.05)


def test_even_places_keep_apart(tmp_path):
    def nearest(pattern):
        script = FILLED.format(shape=BALL, how=f"count: 500, pattern: {pattern}")
        ((x,),) = watch(tmp_path, script, [0], "grains.positions")
        apart = np.linalg.norm(x[:, None] - x[None], axis=2) + 9 * np.eye(len(x))
        return apart.min()

    assert nearest("even") > 0.5 * (math.pi / 6 / 500) ** (1 / 3)
    assert nearest("random") < 0.2 * (math.pi / 6 / 500) ** (1 / 3)


def test_a_closed_mesh_winds_once_around_what_is_inside():
    a = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    corners = a[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    places = np.random.default_rng(1).uniform(-0.2, 1, (400, 3))
    inside = (places > 0).all(axis=1) & (places.sum(axis=1) < 1)
    assert (winding(corners).holds(places) == inside).all()


WRONG = {
    "{particles: {emit: {rate: 0 Hz}}}": "must be above 0",
    "{particles: {emit: {lifetime: -1 s}}}": "must be above 0",
    "{particles: {emit: {rate: 1e12 Hz}}}": "4e+12 particles need about",
    "{particles: {emit: {start: 2 s, until: 1 s}}}": "after `start`",
    "{particles: {emit: {}, mass: 0 kg}}": "must be above 0",
    "{particles: {fill: {object: b, count: 1000000000000}}}": "1e+12 particles need about",
    "{particles: {fill: {object: b}}}": "either `count` or `spacing`",
    "{particles: {positions: [[0, 0, 0]], aging: {color: red}}}": "only particles that are emitted",
}


@pytest.mark.parametrize("entry", WRONG)
def test_wrong_particles_are_told_with_their_place(tmp_path, entry):
    said = complaint(tmp_path, f"objects: {{b: sphere}}\nmodels:\n  bad: {entry}\n")
    assert WRONG[entry] in said
    assert "scene.yaml:3:" in said


def test_a_drop_that_takes_the_place_of_one_that_lay_bounces_as_that_did(tmp_path):
    script = """
clock: {end: 3 s}
objects: {floor: plane}
models: {rain: {particles: {emit: {rate: 1 Hz, lifetime: 0.9 s, from: 0 0.1 0 m, velocity: 0 0 0 m/s}, radius: 1 mm}}}
forces: [gravity]
contacts: {splash: {collision: {between: [rain, floor], restitution: 0.3, friction: 0.2, mode: local}}}
solvers: {main: {semi_implicit_euler: {step: 10 ms}}}
"""
    (one,), (two,), (three,) = watch(tmp_path, script, [0.95, 1.95, 2.95], "splash.hits.count")
    assert one >= 2
    assert (two, three) == (2 * one, 3 * one)


@pytest.mark.parametrize("kind", ["csv", "npz"])
def test_a_table_of_what_is_born_and_dies_keeps_its_columns(tmp_path, kind):
    script = """
clock: {end: 1 s, fps: 4}
models:
  drip: {particles: {emit: {rate: 2 Hz, start: 0.1 s, lifetime: 0.4 s, velocity: 0 0 0 m/s}, mass: 1 g}}
outputs: {t: {record: {of: [drip.ages, drip.count, time + 1 s], format: KIND}}}
"""
    path = tmp_path / "scene.yaml"
    path.write_text("sceneql: 1" + script.replace("KIND", kind))
    (file,) = pipeline.render(pipeline.load(path), folder=tmp_path).files
    table = np.load(file) if kind == "npz" else np.genfromtxt(file, delimiter=",", names=True, deletechars="")
    ages, count, later = [
        table[name].reshape(4, -1) for name in list(table.files if kind == "npz" else table.dtype.names)[1:]
    ]
    assert later[:, 0] == pytest.approx([1.0, 1.25, 1.5, 1.75])
    assert count[:, 0] == pytest.approx([0, 1, 0, 1])
    assert ages[:, 0] == pytest.approx([np.nan, 0.15, np.nan, 0.15], nan_ok=True)
