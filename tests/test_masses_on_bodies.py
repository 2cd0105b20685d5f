"""Masses against rigid bodies: they bounce off and push them, rest on them and are carried, by one step problem."""

import numpy as np
import pytest
from click.testing import CliRunner

import runs
from runs import complaint
from sceneql.cli import cli
from sceneql.shapes.placement import rotation_matrix

FREE = """
clock: {end: 1 s}
objects: {o: {%s: {position: 0 0 0 m}}}
models:
  it: {rigid: {of: o, mass: 3 kg, spin: 0 %s 0 rad/s}}
  net: {mass_spring: {radius: 5 cm, masses: {a: {position: 0.3 1.4 0.1 m, mass: 1 kg, velocity: 0.2 -3 0.1 m/s}}}}
contacts: {c: {collision: {between: [it, net], restitution: %s, friction: %s}}}
solvers: {main: {%s}}
"""
BOTH = [f"{name}.{what}" for what in ("momentum", "angular_momentum", "kinetic") for name in ("it", "net")]


@pytest.mark.parametrize("shape", ["box", "sphere", "torus", "cylinder"])
@pytest.mark.parametrize("solver", ["rk4: {step: 7 ms}", "auto"])
@pytest.mark.parametrize(("restitution", "friction", "spin"), [(1, 0, 2), (0.5, 0.3, 0), (0, 2, 5)])
def test_an_impact_keeps_momentum_and_angular_momentum(tmp_path, shape, solver, restitution, friction, spin):
    script = FREE % (shape, spin, restitution, friction, solver)
    start, end = runs.watch(tmp_path, script, [0, 1], *BOTH, "c.hits.count", "net.a.velocity", pruned=False)
    assert np.abs(np.subtract(start[-1], end[-1])).max() > 0.1
    for k in (0, 2):
        np.testing.assert_allclose(end[k] + end[k + 1], start[k] + start[k + 1], atol=1e-13)
    if friction == 0:
        assert end[4] + end[5] == pytest.approx(start[4] + start[5], rel=2e-4 if spin else 1e-9)


@pytest.mark.parametrize("step", ["3 ms", "10 ms", "41 ms"])
def test_a_mass_and_a_ball_part_as_the_restitution_says(tmp_path, step):
    script = f"""
clock: {{end: 1 s}}
objects: {{o: {{sphere: {{radius: 0.2 m, position: 0 0 0 m}}}}}}
models:
  it: {{rigid: {{of: o, mass: 3 kg, velocity: 1 0 0 m/s}}}}
  net: {{mass_spring: {{radius: 5 cm, masses: {{a: {{position: 1 0 0 m, mass: 2 kg, velocity: -2 0 0 m/s}}}}}}}}
contacts: {{c: {{collision: {{between: [it, net], restitution: 0.8}}}}}}
solvers: {{main: {{rk4: {{step: {step}}}}}}}
"""
    outputs = ("it.velocity", "net.a.velocity", "it.position", "net.a.position", "c.hits.count", "c.hits.last.time")
    ((v, u, x, y, hits, when),) = runs.watch(tmp_path, script, [1], *outputs)
    mean = (3 * 1 - 2 * 2) / 5
    np.testing.assert_allclose([v[0], u[0]], [mean - 0.8 * 3 * 2 / 5, mean + 0.8 * 3 * 3 / 5], atol=1e-12)
    assert (hits, when) == (1, pytest.approx(0.25, abs=1e-3))
    at = np.array([0.25, 0.5]) + 0.75 * np.array([v[0], u[0]])
    np.testing.assert_allclose([x[0], y[0]], at, atol=1e-3)


@pytest.mark.parametrize(
    "solver", ["semi_implicit_euler: {step: 5 ms}", "rk4: {step: 5 ms}", "radau: {tolerance: 1e-6}"]
)
def test_masses_rest_on_bodies_that_rest_on_a_floor(tmp_path, solver):
    script = f"""
clock: {{end: 2 s}}
objects: {{o: {{box: {{size: 1 0.2 1 m, position: 0 0.1 0 m}}}}, floor: plane}}
models:
  it: {{rigid: {{of: o, mass: 3 kg}}}}
  net:
    mass_spring:
      radius: 5 cm
      masses: {{a: {{position: 0.3 1 0.1 m}}, b: {{position: -0.2 0.25 0 m, mass: 2 t}}, c: {{position: 0.8 0.3 0 m}}}}
forces: [gravity]
contacts: {{c: {{collision: {{restitution: 0.3, friction: 0.4}}}}}}
solvers: {{main: {{{solver}}}}}
"""
    outputs = ("it.position", "net.positions", "net.kinetic", "it.kinetic", "c.forces")
    ((x, at, *kinetic, forces),) = runs.watch(tmp_path, script, [2], *outputs, pruned=False)
    np.testing.assert_allclose(x, [0, 0.1, 0], atol=1e-9)
    np.testing.assert_allclose(at, [[0.3, 0.25, 0.1], [-0.2, 0.25, 0], [0.8, 0.05, 0]], atol=1e-9)
    assert max(kinetic) < 1e-15
    # Of all on the floor, and of two masses on the box.
    assert np.abs(forces[:, 1]).sum() == pytest.approx(9.81 * (2003.2 + 2000.1), rel=1e-9)


def test_a_mass_is_carried_until_its_friction_has_made_it_as_fast(tmp_path):
    script = """
clock: {end: 1 s}
objects: {o: {box: {size: 4 0.2 1 m, position: 0 0.1 0 m}}, floor: plane}
models:
  it: {rigid: {of: o, mass: 3 kg, velocity: 2 0 0 m/s}}
  net: {mass_spring: {radius: 0 m, masses: {a: {position: 0.3 0.2 0 m, mass: 1 kg}}}}
forces: [gravity]
contacts: {c: {collision: {restitution: 0, friction: 0.2}}}
solvers: {main: {rk4: {step: 2.5 ms}}}
"""
    outputs = ("it.velocity", "net.a.velocity", "it.position", "net.a.position")
    slides, sticks, rests = runs.watch(tmp_path, script, [0.3, 0.5, 1], *outputs)
    g = 9.81
    assert slides[0][0] == pytest.approx(2 - 0.2 * g * 5 / 3 * 0.3, abs=1e-3)
    assert slides[1][0] == pytest.approx(0.2 * g * 0.3, abs=1e-3)
    meet = 2 / (0.2 * g * (5 / 3 + 1))
    fast = 0.2 * g * meet - 0.2 * g * (0.5 - meet)  # together: the floor's friction on both
    assert [sticks[0][0], sticks[1][0]] == pytest.approx([fast, fast], abs=0.02)
    assert max(np.abs(rests[0]).max(), np.abs(rests[1]).max()) < 1e-12
    assert rests[3][1] == pytest.approx(0.2, abs=1e-12)


def test_many_particles_never_are_in_bodies_that_they_push(tmp_path):
    script = """
clock: {end: 0.6 s}
objects:
  o: {box: {size: 1 0.2 1 m, position: 0 0.1 0 m, rotation: {about: y, angle: 20 deg}}}
  ball: {sphere: {radius: 0.2 m, position: 1.1 0.2 0 m}}
  floor: plane
  cloud: {box: {size: 3 0.5 1 m, position: 0.3 1 0 m, hidden: true}}
models:
  it: {rigid: {bodies: {o: {of: o, mass: 3 kg}, ball: {of: ball, mass: 0.2 kg, velocity: -1 0 0 m/s}}}}
  dust: {particles: {fill: {object: cloud, count: 1000}, radius: 5 mm, mass: 1 g, velocity: 0 -2 0 m/s}}
forces: [gravity]
contacts: {c: {collision: {restitution: 0.3, friction: 0.4}}}
solvers: {main: {semi_implicit_euler: {step: 5 ms}}}
"""
    outputs = ("it.positions", "it.o.rotation", "dust.positions", "it.energy", "dust.energy", "c.hits.count")
    rows = runs.watch(tmp_path, script, [0, 0.2, 0.3, 0.4, 0.5, 0.6], *outputs)
    for (box, ball), turn, at, *_ in rows:
        beside = np.abs((at - box) @ rotation_matrix(turn)) - [0.5, 0.1, 0.5]
        outside = np.linalg.norm(np.maximum(beside, 0), axis=1) + np.minimum(beside.max(axis=1), 0)
        gaps = min(outside.min(), np.linalg.norm(at - ball, axis=1).min() - 0.2, at[:, 1].min())
        assert gaps > 0.005 - 1e-8
    assert rows[-1][5] > 500
    energies = [row[3] + row[4] for row in rows]
    assert np.diff(energies).max() < 1e-9  # contacts make none


@pytest.mark.parametrize("speed", [0, 0.5])
def test_a_cloth_falls_over_a_box_and_lies_on_it(tmp_path, speed):
    script = f"""
clock: {{end: 0.4 s}}
objects: {{o: {{box: {{size: 0.6 0.6 0.6 m, position: 0 0.3 0 m}}}}, floor: plane}}
models:
  it: {{rigid: {{of: o, mass: 3 kg, velocity: {speed} 0 0 m/s}}}}
  net: {{cloth: {{size: 1 1 m, cells: 10 10, center: 0.01 0.75 0 m, radius: 1 cm, damping: 0.1}}}}
forces: [gravity]
contacts: {{c: {{collision: {{restitution: 0, friction: 0.4}}}}}}
solvers: {{main: {{rk4: {{step: 1 ms}}}}}}
"""
    outputs = ("it.position", "it.rotation", "net.positions", "it.energy", "net.energy")
    start, *rows = runs.watch(tmp_path, script, [0, 0.2, 0.3, 0.4], *outputs, pruned=False)
    for x, turn, at, *energies in rows:
        beside = np.abs((at - x) @ rotation_matrix(turn)) - 0.3
        outside = np.linalg.norm(np.maximum(beside, 0), axis=1) + np.minimum(beside.max(axis=1), 0)
        assert outside.min() > 0.01 - 1e-7
        assert sum(energies) == pytest.approx(start[3] + start[4], rel=2e-3)
        assert x[1] == pytest.approx(0.3, abs=1e-6)
    assert rows[-1][2][:, 1].max() < 0.7
    assert rows[-1][2][:, 1].min() < 0.55


def test_a_pinned_mass_stands_in_a_body_s_way_and_a_fast_one_passes_no_thin_body(tmp_path):
    script = """
clock: {end: 1 s}
objects: {o: {box: {size: 1 1 1 m, position: 0 0 0 m}}, wall: {box: {size: [1 mm, 1 m, 1 m], position: 5 0 0 m}}}
models:
  it: {rigid: {of: o, mass: 3 kg, velocity: 0 2 0 m/s}}
  plate: {rigid: {of: wall, mass: 1 kg}}
  net:
    mass_spring:
      radius: 1 cm
      masses:
        held: {position: 0 1 0 m, fixed: true}
        fast: {position: 4 0 0 m, mass: 1 g, velocity: 500 0 0 m/s}
contacts: {c: {collision: {restitution: 0, between: [it, plate, net]}}}
solvers: {main: {rk4: {step: 10 ms}}}
"""
    outputs = ("it.position", "net.held.position", "net.fast.position", "plate.position", "plate.velocity")
    ((x, held, fast, plate, speed),) = runs.watch(tmp_path, script, [1], *outputs, pruned=False)
    assert x[1] == pytest.approx(0.49, abs=1e-6)
    np.testing.assert_allclose(held, [0, 1, 0])
    assert plate[0] - fast[0] == pytest.approx(0.0105, abs=1e-6)
    assert speed[0] == pytest.approx(500e-3 / 1.001, rel=1e-9)


def test_what_masses_and_bodies_cannot_do_is_told(tmp_path):
    script = """objects: {o: {box: {position: 0 0.5 0 m}}, floor: plane}
models: {it: {rigid: {of: o}}, net: {mass_spring: {masses: {a: {position: 0 %s 0 m}}}}}
contacts: {c: {collision: {between: [net, it, floor], mode: %s}}}
outputs: {t: {record: {of: [it.energy, net.energy]}}}
"""
    assert not complaint(tmp_path, script % (2, "local"))
    for height, mode, text in (
        (0.8, "exact", "mass 0 of 'net' starts inside 'o', 0.25 m deep"),
        (0.8, "local", "mass 0 of 'net' starts inside 'o', 0.2 m deep"),
    ):
        with pytest.raises(runs.ScriptError, match=text):
            runs.watch(tmp_path, script % (height, mode), [0], "it.energy")


def test_steps_too_long_for_springs_beside_bodies_are_told(tmp_path):
    script = """clock: {end: 0.3 s}
objects: {o: {box: {size: 1 0.2 1 m, position: 0 0.1 0 m}}, floor: plane}
models:
  it: {rigid: {of: o}}
  net: {cloth: {size: 0.2 0.2 m, cells: 2 2, center: 0 0.22 0 m}}
forces: [gravity]
contacts: {c: {collision: {restitution: 0}}}
solvers: {main: {SOLVER}}
outputs: {t: {record: {of: [it.energy, net.energy]}}}
"""
    for solver, told in (("implicit_euler: {step: 1/60 s}", True), ("auto", False)):
        path = tmp_path / "scene.yaml"
        path.write_text(script.replace("SOLVER", solver))
        done = CliRunner().invoke(cli, ["render", str(path), "-o", str(tmp_path / "out")])
        assert done.exit_code == 0, done.output
        assert ("masses on springs touched something" in done.output) is told
