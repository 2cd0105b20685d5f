"""Rigid bodies: free motion against exact values, mass from objects, forces, torques and blows at their points."""

from functools import partial

import numpy as np
import pytest

import runs
from sceneql.compiler.catalogue import Catalogue
from sceneql.pipeline import load
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Type
from sceneql.run.run import Run
from test_value_slopes import check_derivatives

watch = partial(runs.watch, pruned=False)
FREE = """
clock: {{end: {end} s}}
models: {{top: {{rigid: {{mass: 1 kg, inertia: 1 2 3 kg*m^2, spin: {spin} rad/s}}}}}}
solvers: {{main: {{{solver}}}}}
"""
TUMBLE = "0.8 0.7 0.6", 20, [-0.636295763417436, 0.515834806373842, 0.0142968800686671, -0.57344376638916]
RACKET = "0.01 1 0.01", 100, [-0.0156462415148542, 0.965439574274269, -7.97160940397554e-5, -0.260156908801055]
"""Spin in the body's axes, time, rotation then: by power series of order 26 with 30 digits."""


def turned(folder, case, solver):
    """The largest error of the rotation, and of the angular momentum, at the end of a case."""
    spin, end, expected = case
    script = FREE.format(spin=spin, end=end, solver=solver)
    ((q, momentum),) = watch(folder, script, [end], "top.rotation", "top.angular_momentum")
    start = np.array([1, 2, 3]) * np.array(spin.split(), dtype=float)
    error = min(np.abs(q - expected).max(), np.abs(q + expected).max())
    return error, np.abs(momentum - start).max()


@pytest.mark.parametrize(
    ("case", "solver", "good"),
    [
        (TUMBLE, "dop853: {tolerance: 1e-12}", 1e-10),
        (TUMBLE, "dop853: {tolerance: 1e-13}", 2e-11),
        (RACKET, "dop853: {tolerance: 1e-14}", 1e-9),
        (RACKET, "gauss_radau15", 2e-12),
        (TUMBLE, "radau: {tolerance: 1e-10}", 1e-9),
        (TUMBLE, "verlet: {step: 1 ms}", 1e-12),
        (TUMBLE, "verlet: {step: 20 s}", 1e-12),
        (RACKET, "verlet: {step: 70 ms}", 1e-11),
        (RACKET, "blanes_moan: {step: 9 s}", 1e-11),
        (TUMBLE, "semi_implicit_euler: {step: 3 s}", 1e-12),
    ],
)
def test_a_free_body_turns_as_power_series_say(tmp_path, case, solver, good):
    assert turned(tmp_path, case, solver)[0] < good


SOLVERS = {word: Catalogue().load("solvers", word) for word in Catalogue().words("solvers")}
STEPPING = sorted(word for word, solver in SOLVERS.items() if solver.marches == "anything" and not solver.static)
STEPPING = [word for word in STEPPING if word not in ("modal", "runge_kutta")]


@pytest.mark.parametrize("word", STEPPING)
def test_every_solver_keeps_the_angular_momentum_to_rounding_where_no_torque_acts(tmp_path, word):
    solver = f"{word}: {{step: 20 ms}}" if "step" in SOLVERS[word].model_fields else word
    assert turned(tmp_path, (TUMBLE[0], 2, TUMBLE[2]), solver)[1] < 1e-15 * 4


@pytest.mark.parametrize("case", [TUMBLE, RACKET], ids=["A", "B"])
def test_auto_moves_what_flies_freely_exactly(tmp_path, case):
    error, off = turned(tmp_path, case, "auto: {tolerance: 1e-3}")
    assert error < 1e-13
    assert off == 0


def test_rotations_of_what_flies_freely_have_length_1_on_every_frame(tmp_path):
    script = FREE.format(spin=TUMBLE[0], end=50, solver="auto")
    lengths = [np.sum(q**2) for (q,) in watch(tmp_path, script, np.linspace(0, 50, 400), "top.rotation")]
    assert np.abs(np.array(lengths) - 1.0).max() < 5e-16


def test_a_thrown_body_flies_along_a_parabola_and_turns_as_without_gravity(tmp_path):
    spin, end, expected = TUMBLE
    model = f"{{rigid: {{mass: 1 kg, inertia: 1 2 3 kg*m^2, spin: {spin} rad/s, velocity: 3 90 0 m/s}}}}"
    script = f"clock: {{end: {end} s}}\nmodels: {{top: {model}}}\nforces: [gravity]\n"
    times = [0.0, 7.0, end]
    rows = watch(tmp_path, script, times, "top.position", "top.velocity", "top.rotation", "top.energy")
    for t, (place, velocity, _, energy) in zip(times, rows, strict=True):
        assert place == pytest.approx([3 * t, 90 * t - 0.5 * 9.81 * t**2, 0], abs=1e-11)
        assert velocity == pytest.approx([3, 90 - 9.81 * t, 0], abs=1e-12)
        assert energy == pytest.approx(rows[0][3], rel=1e-13)
    assert np.abs(rows[-1][2]) == pytest.approx(np.abs(expected), abs=1e-13)


@pytest.mark.parametrize(
    "more",
    [
        "forces: {f: {force: {on: [top], components: [0 N, 1 N, 0 N]}}}",
        "forces: {g: {gravity: {strength: 9.81 m/s^2 * (1 - time / 1 s)}}}",
        "forces: {i: {impulse: {on: top.position, at: 0.5 s, value: 0 1 0 N*s}}}",
        "ties: {b: {ball: {between: [top, world], at: 0 0 0 m}}}",
    ],
)
def test_auto_takes_steps_where_more_than_constant_gravity_acts(tmp_path, more):
    path = tmp_path / "scene.yaml"
    model = "{rigid: {mass: 1 kg, inertia: 1 2 3 kg*m^2, spin: 1 0 0 rad/s}}"
    path.write_text(f"clock: {{end: 1 s}}\nmodels: {{top: {model}}}\n{more}\n")
    (island,) = Run(load(path, pruned=False)).islands
    assert island.methods.first.needs.march is None


def test_a_body_that_turns_for_long_has_a_quaternion_of_length_1(tmp_path):
    ((q,),) = watch(tmp_path, FREE.format(spin="1 2 3", end=20, solver="euler: {step: 10 ms}"), [20], "top.rotation")
    assert np.linalg.norm(q) == pytest.approx(1, abs=1e-15)


@pytest.mark.parametrize("unit", [1, 1e-4, 1e-7])
def test_the_first_step_of_gauss_radau15_is_as_exact_as_all_others(tmp_path, unit):
    # By its units alone a small body had a first step whose iteration did not end in the passes that it has.
    script = FREE.format(spin="0.08 0 8", end=14, solver="SOLVER").replace(
        "1 2 3 kg*m^2", f"{2.69 * unit:g} {5.13 * unit:g} {7.56 * unit:g} kg*m^2"
    )
    (exact,), (found,) = (
        watch(tmp_path, script.replace("SOLVER", word), [14], "top.rotation")[0]
        for word in ("verlet: {step: 1 s}", "gauss_radau15")
    )
    assert min(np.abs(found - exact).max(), np.abs(found + exact).max()) < 1e-12


BLOCK = """
clock: {end: 1 s}
objects:
  plank: {box: {size: 0.4 0.2 0.1 m, position: 1 2 3 m, rotation: {about: y, angle: 30 deg}}}
models:
  it:
    rigid: {of: plank, density: 500 kg/m^3, spin: 1 2 3 rad/s, velocity: 1 0 0 m/s, points: {tip: 0.2 0.1 0 m}}
"""


def test_mass_and_inertia_are_those_of_the_object_in_its_own_axes(tmp_path):
    outputs = ("it.inertia", "it.momentum", "it.position", "it.body_spin", "it.spin")
    ((inertia, momentum, place, own, spin),) = watch(tmp_path, BLOCK, [0], *outputs)
    mass = 500 * 0.4 * 0.2 * 0.1
    sides = np.array([0.4, 0.2, 0.1]) ** 2
    np.testing.assert_allclose(inertia, np.diag(mass / 12 * (sides.sum() - sides)), rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(momentum, [mass, 0, 0], rtol=1e-13)
    np.testing.assert_allclose(place, [1, 2, 3], rtol=1e-14)
    np.testing.assert_allclose(spin, [1, 2, 3], rtol=1e-13)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    np.testing.assert_allclose(own, [c * 1 - s * 3, 2, s * 1 + c * 3], rtol=1e-13)


def test_the_object_and_the_points_follow_the_body(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(BLOCK)
    run = Run(load(path, pruned=False))
    for moment in run.moments([0, 0.7, 1]):
        q, x = moment.read("it", "rotation"), moment.read("it", "position")
        np.testing.assert_array_equal(moment.read("plank", "rotation"), q)
        np.testing.assert_allclose(moment.read("plank", "position"), x, atol=1e-15)
        w, u, arm = q[0], q[1:], np.array([0.2, 0.1, 0])
        arm = arm + 2 * np.cross(u, np.cross(u, arm) + w * arm)
        np.testing.assert_allclose(moment.read("it", "tip.position"), x + arm, rtol=1e-14)
        speed = moment.read("it", "velocity") + np.cross(moment.read("it", "spin"), arm)
        np.testing.assert_allclose(moment.read("it", "tip.velocity"), speed, rtol=1e-13)


def test_bodies_that_share_an_object_drive_one_each(tmp_path):
    script = """
clock: {end: 0.5 s}
objects: {brick: {box: {size: 0.4 0.2 0.2 m}}}
models:
  pair: {rigid: {density: 800 kg/m^3, bodies: {a: {of: brick, position: 0 1 0 m}, b: {of: brick, position: 1 1 0 m}}}}
  row: {repeat: {count: 2, as: k}, rigid: {of: brick, density: 800 kg/m^3, position: ["1 m*k", 3 m, 0 m]}}
"""
    (tmp_path / "scene.yaml").write_text(script)
    run = Run(load(tmp_path / "scene.yaml", pruned=False))
    (moment,) = run.moments([0.5])
    shapes = [name for name in run.graph.tasks if name.partition(".")[0] == "brick"]
    places = sorted(tuple(moment.read(name, "position").tolist()) for name in shapes)
    assert places == [(0, 1, 0), (0, 3, 0), (1, 1, 0), (1, 3, 0)]


def test_a_center_of_mass_off_the_origin_moves_the_object_about_itself(tmp_path):
    script = BLOCK.replace("density: 500 kg/m^3", "mass: 2 kg, center: 0.1 0 0 m")
    rows = watch(tmp_path, script, [0, 1], "it.position", "it.origin", "it.energy", "plank.position")
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    np.testing.assert_allclose(rows[0][0], [1 + 0.1 * c, 2, 3 - 0.1 * s], rtol=1e-14)
    np.testing.assert_allclose(rows[1][0], rows[0][0] + [1, 0, 0], rtol=1e-12)
    for row in rows:
        np.testing.assert_allclose(row[1], row[3], atol=1e-15)
        assert np.linalg.norm(row[0] - row[1]) == pytest.approx(0.1, rel=1e-13)


PAIR = """
clock: {end: 1 s}
models:
  one: {rigid: {mass: 2 kg, inertia: 1 2 2.5 kg*m^2, spin: 1 -2 0.5 rad/s, points: {hook: 0.3 0.2 -0.1 m}}}
  two:
    rigid: {mass: 1 kg, inertia: 0.3 0.2 0.4 kg*m^2, position: 1 1 0 m, spin: 0 1 3 rad/s, points: {eye: 0 0.2 0.4 m}}
  net: {particles: {list: {bob: {mass: 0.5 kg, position: 0 0 1 m}}}}
FORCES
solvers: {main: {dop853: {tolerance: 1e-12}}}
"""
SPRINGS = """forces:
  a: {spring: {from: one.hook, to: two.eye, stiffness: 30 N/m, rest: 0.5 m, damping: DAMPING}}
  b: {spring: {from: one.hook, to: net.bob, stiffness: 20 N/m, rest: 0.5 m}}"""
SUMS = tuple(
    f"{name}.{output}" for output in ("energy", "momentum", "angular_momentum") for name in ("one", "two", "net")
)


@pytest.mark.parametrize("damping", ["0 N*s/m", "2 N*s/m"])
def test_springs_between_points_keep_energy_momentum_and_angular_momentum(tmp_path, damping):
    script = PAIR.replace("FORCES", SPRINGS.replace("DAMPING", damping))
    first, last = ([sum(row[k : k + 3]) for k in (0, 3, 6)] for row in watch(tmp_path, script, [0, 1], *SUMS))
    assert last[0] == pytest.approx(first[0], rel=1e-10)
    np.testing.assert_allclose(last[1], first[1], atol=1e-13)
    np.testing.assert_allclose(last[2], first[2], atol=1e-12)


def test_work_of_forces_and_torques_is_counted(tmp_path):
    forces = """forces:
  a: {force: {at: one.hook, components: ["3*sin(5*t)", "-vx", "x*y"]}}
  b: {force: {at: two.eye, potential: "x^2 + 2*y^2 + z"}}
  c: {torque: {components: ["0.3", "t", "-x"]}}
  d: {impulse: {on: one.hook, at: 0.5 s, value: 0 2 1 N*s}}
  e: {impulse: {on: net.bob, at: 0.25 s, value: 0 2 1 N*s}}"""
    script = PAIR.replace("FORCES", forces)
    names = [f"{name}.energy" for name in ("one", "two", "net")]
    first, last = watch(tmp_path, script, [0, 1], *names)
    np.testing.assert_allclose(last, first, rtol=1e-9)


def test_a_blow_changes_velocity_and_angular_momentum_at_once(tmp_path):
    script = PAIR.replace("FORCES", "forces: {d: {impulse: {on: one.hook, at: 0.5 s, value: 0 2 1 N*s}}}")
    outputs = ("one.velocity", "one.angular_momentum", "one.hook.position", "one.position")
    before, after = watch(tmp_path, script, [0.4998, 0.500001], *outputs)
    blow = np.array([0, 2, 1])
    np.testing.assert_allclose(after[0] - before[0], blow / 2, rtol=1e-12)
    own = [row[1] - 2 * np.cross(row[3], row[0]) for row in (before, after)]
    np.testing.assert_allclose(own[1] - own[0], np.cross(after[2] - after[3], blow), rtol=1e-5)


def test_a_constant_torque_spins_a_ball_up_evenly(tmp_path):
    script = """
clock: {end: 2 s}
objects: {shape: {sphere: {radius: 0.5 m}}}
models: {ball: {rigid: {of: shape, mass: 3 kg}}}
forces: {turn: {torque: {components: ["0", "0.6", "0"]}}}
"""
    ((spin, place),) = watch(tmp_path, script, [2], "ball.spin", "ball.position")
    np.testing.assert_allclose(spin, [0, 0.6 * 2 / (0.4 * 3 * 0.25), 0], rtol=1e-12)
    np.testing.assert_array_equal(place, 0)


def test_a_point_within_a_formula_is_where_reading_finds_it(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(PAIR.replace("FORCES", ""))
    run = Run(load(path, pruned=False))
    moment = run.at(0.3)
    expr = run.island_of["one"].assembly.formula(Link("one", "hook.position", Type((3,))))
    np.testing.assert_allclose(
        evaluate(expr, lambda node: moment.read(node.task, node.output), arrays=True),
        moment.read("one", "hook.position"),
        atol=1e-15,
    )


def test_slopes_of_turning_bodies_are_those_of_differences(tmp_path):
    check_derivatives(tmp_path, PAIR.replace("FORCES", "forces: [gravity, {drag: {linear: 0.3 N*s/m}}]"))


def test_a_fixed_body_stays(tmp_path):
    script = PAIR.replace("FORCES", SPRINGS.replace("DAMPING", "0 N*s/m"))
    script = script.replace("spin: 1 -2 0.5 rad/s", "fixed: yes")
    first, last = watch(
        tmp_path, script, [0, 1], "one.position", "one.rotation", "one.angular_momentum", "one.hook.position"
    )
    for before, after in zip(first, last, strict=True):
        np.testing.assert_array_equal(after, before)


def test_several_bodies_have_the_fields_of_each(tmp_path):
    script = """
clock: {end: 1 s}
objects: {a: {sphere: {radius: 0.1 m}}, b: {box: {size: 0.2 0.2 0.2 m, position: 1 0 0 m}}}
models:
  both:
    rigid:
      bodies: {ball: {of: a, spin: 0 0 2 rad/s}, cube: {of: b, velocity: 0 1 0 m/s, points: {top: 0 0.1 0 m}}}
"""
    outputs = ("both.count", "both.ball.spin", "both.cube.top.position", "b.position", "both.kinetic")
    ((count, spin, top, place, kinetic),) = watch(tmp_path, script, [1], *outputs)
    assert count == 2
    np.testing.assert_allclose(spin, [0, 0, 2], rtol=1e-12)
    np.testing.assert_allclose(top, [1, 1.1, 0], rtol=1e-12)
    np.testing.assert_allclose(place, [1, 1, 0], rtol=1e-12)
    ball = 1000 * 4 / 3 * np.pi * 1e-3
    assert kinetic == pytest.approx(0.5 * 8 + 0.5 * 0.4 * ball * 0.01 * 4, rel=1e-12)


def test_a_ball_on_a_stiff_spring_swings_as_near_as_a_mass_for_as_much_work(tmp_path):
    """The spring pendulum of k = 1e8 N/m, from its side and at rest: its place after 2 s by Radau at 1e-12."""
    clock, solver = "clock: {end: 2 s}\n", "solvers: {main: {radau: {tolerance: 1e-6}}}\n"
    spring = "stiffness: 1e8 N/m, rest: 1 m"
    scripts = {
        "mass": f"""{clock}{solver}forces: [gravity]
models:
  it:
    mass_spring:
      masses: {{a: {{position: 1 0 0 m, mass: 1 kg}}, o: {{position: 0 0 0 m, fixed: true}}}}
      springs: [{{between: [o, a], {spring}}}]
""",
        "ball": f"""{clock}{solver}objects: {{s: {{sphere: {{radius: 0.1 m, position: 1 0 0 m}}}}}}
forces: [gravity, {{spring: {{from: it.position, to: o.a.position, {spring}}}}}]
models:
  it: {{rigid: {{of: s, mass: 1 kg}}}}
  o: {{mass_spring: {{masses: {{a: {{position: 0 0 0 m, fixed: true}}}}}}}}
""",
    }

    exact = [0.7935655612626729, -0.6084850516915553]
    errors, work = {}, {}
    for name, script in scripts.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(script)
        run = Run(load(path, pruned=False))
        (moment,) = run.moments([2])
        x = moment.read("it", "a.position" if name == "mass" else "position")
        errors[name], work[name] = np.abs(x[:2] - exact).max(), run.islands[0].march.statistics.evaluations
    assert max(errors.values()) < 1e-7
    assert errors["ball"] < 3 * errors["mass"] + 1e-9
    assert work["ball"] < 3 * work["mass"]
