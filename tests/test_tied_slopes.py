"""Slopes of rigid bodies, their ties and what acts on their points: the border of the linear systems of stages."""

from functools import partial

import numpy as np
import pytest

import runs
from sceneql.island import island
from sceneql.linear.stage import stage_plan
from sceneql.linear.stage_kernels import factor_stage, solve_stage
from sceneql.march.driver import jacobian
from sceneql.pipeline import load
from sceneql.run.run import Run

watch = partial(runs.watch, pruned=False)
INERTIA = "mass: 2 kg, inertia: 0.1 0.2 0.25 kg*m^2"
TILT = "about: 1 2 3, angle: 40 deg"
MANY = f"""
clock: {{end: 1 s}}
objects: {{cart: {{box: {{size: 0.1 0.1 0.1 m, position: [0.3 m*sin(4*time/(1 s)), 3 m, 0 m]}}}}}}
models:
  it:
    rigid:
      bodies:
        a: {{{INERTIA}, position: 0.5 0.1 0 m, spin: 0.3 1 2 rad/s, points: {{hook: 0.1 0.2 0.3 m}}}}
        b: {{{INERTIA}, position: 1.5 0 0.2 m, rotation: {{{TILT}}}, points: {{eye: -0.2 0.1 0 m}}}}
        c: {{{INERTIA}, position: 2.5 0.2 0 m, spin: 1 2 0.5 rad/s, velocity: 1 0 2 m/s}}
        d: {{{INERTIA}, position: 0 2.5 0 m}}
        e: {{{INERTIA}, position: 4 0 0 m}}
        f: {{{INERTIA}, position: 5 0 0 m}}
        held: {{{INERTIA}, position: 6 1 0 m, fixed: yes, points: {{peg: 0.1 0 0 m}}}}
  net: {{particles: {{list: {{bob: {{position: 2.5 1 0 m, mass: 0.5 kg, velocity: 0.4 0 0 m/s}}}}}}}}
forces:
  down: gravity
  air: {{drag: {{linear: 0.3 N*s/m}}}}
  pull: {{force: {{at: it.a.hook, components: ["3*sin(x) - vy", "2 + z*vx", "-x*y"]}}}}
  well: {{force: {{at: it.b.eye, potential: "2*x*x + 3*y*y*z"}}}}
  twist: {{torque: {{components: ["0.3*vx", "0.2*x*y", "-vz"]}}}}
  bow: {{spring: {{from: it.a.hook, to: it.b.eye, stiffness: 40 N/m, damping: 3 N*s/m, rest: 0.4 m}}}}
  line: {{spring: {{from: it.b.eye, to: net.bob.position, stiffness: 30 N/m, rest: 0.5 m}}}}
  stay: {{spring: {{from: it.a.hook, to: 0 1 1 m, stiffness: 30 N/m}}}}
  peg: {{spring: {{from: it.f.position, to: it.held.peg, stiffness: 30 N/m, rest: 0.2 m}}}}
ties:
  first: {{hinge: {{between: [it.a, world], at: 0 0 0 m, axis: 1 1 0, stiffness: 2 N*m, damping: 0.1 N*m*s}}}}
  second: {{ball: {{between: [it.b, it.a], at: 1 0.1 0.1 m}}}}
  third: {{rod: {{between: [it.b, net.bob]}}}}
  fourth: {{rod: {{between: [net.bob, it.c], to: 2.4 0.1 0 m}}}}
  fifth: {{slider: {{between: [it.d, cart], axis: 0 1 1, stiffness: 4 N/m, rest: 0.2 m}}}}
  sixth: {{hinge: {{between: [it.e, world], at: 4 0 0 m}}}}
  seventh: {{hinge: {{between: [it.f, world], at: 5 0 0 m}}}}
  eighth: {{gear: {{between: [it.e, it.f], teeth: 12 30}}}}
  ninth: {{weld: {{between: [it.held, it.c]}}}}
solvers: {{main: {{SOLVER}}}}
"""


def system_of(folder, script, time):
    """The system of an island with its slopes, and rate and state there."""
    path = folder / "scene.yaml"
    path.write_text(script)
    run = Run(load(path, pruned=False))
    run.at(time)
    return run.islands[0].march


def test_systems_that_ties_border_are_solved_as_those_of_all_slopes(tmp_path, monkeypatch):
    monkeypatch.setattr(island, "TIED", 0)
    march = system_of(tmp_path, MANY.replace("SOLVER", "bdf2: {step: 1 ms}"), 0.1)
    system, t = march.system, 0.1
    assert system.border == 5 + 3 + 1 + 1 + 5 + 5 + 5 + 1 + 6
    y, floats = march._y1.copy(), march.floats
    n = len(y)
    plan = stage_plan(system, exact=True)
    values, store, a = np.zeros(system.pattern.room), np.zeros(plan.store), 0.03
    jacobian(system)(march._engaged.functions, t, y, values, floats, system.ints)
    assert factor_stage(plan.numbers, a, values, plan.scales, store)
    whole = np.zeros((n, n))
    for k in range(n):
        for side in (1, -1):
            moved = y.copy()
            moved[k] += side * 1e-5
            whole[:, k] += side * march.rate(t, moved) / 2e-5
    kept = np.setdiff1d(np.arange(n), system.pattern.tallies)
    whole = whole[np.ix_(kept, kept)]
    right = np.random.default_rng(1).normal(size=n)
    found = right.copy()
    assert solve_stage(plan.numbers, a, values, plan.scales, store, found)
    np.testing.assert_allclose(found[kept], np.linalg.solve(np.eye(len(kept)) - a * whole, right[kept]), atol=1e-6)


def chain(count, solver):
    """Rods on hinges, level at the start, which turn about axes that differ."""
    bodies = "\n".join(
        f"        b{k}: {{mass: 1 kg, inertia: 0.01 0.09 0.08 kg*m^2, position: {k + 0.5} 0 0 m}}" for k in range(count)
    )
    ties = "\n".join(
        f"  t{k}: {{hinge: {{between: [rods.b{k}, {f'rods.b{k - 1}' if k else 'world'}], at: {k} 0 0 m,"
        f" axis: 0 {k % 2} 1, stiffness: 20 N*m, damping: 1 N*m*s}}}}"
        for k in range(count)
    )
    return f"""
clock: {{end: 1 s}}
models:
  rods:
    rigid:
      bodies:
{bodies}
forces: [gravity]
ties:
{ties}
solvers: {{main: {{{solver}}}}}
"""


@pytest.mark.parametrize(
    ("solver", "good"),
    [
        ("bdf2: {step: 2 ms}", 1e-4),
        ("implicit_midpoint: {step: 5 ms}", 1e-4),
        ("radau: {tolerance: 1e-5}", 1e-6),
        ("rodas5p: {tolerance: 1e-5}", 1e-6),
    ],
)
def test_implicit_methods_swing_a_long_chain_of_links(tmp_path, solver, good):
    names = [f"rods.b{k}.position" for k in (0, 17, 34)]
    exact, found = (
        watch(tmp_path, chain(35, word), [0.15], *names)[0] for word in ("dop853: {tolerance: 1e-10}", solver)
    )
    assert exact[0][1] < -0.01
    assert exact[0][2] != 0
    np.testing.assert_allclose(found, exact, atol=good)


CLOTH = """
clock: {end: 1 s}
models:
  bars:
    rigid:
      mass: 0.2 kg
      bodies:
        a: {inertia: 0.0002 0.006 0.006 kg*m^2, position: -0.3 0 0 m}
        b: {inertia: 0.0002 0.006 0.006 kg*m^2, position: 0.3 0 0 m, points: {eye: 0 0 0.1 m}}
  sheet: {cloth: {size: 1.2 0.8 m, cells: 9 6, center: 0 -0.4 0 m, facing: 0 0 1}}
  ball: {particles: {list: {bob: {position: 0.3 -0.3 0.1 m, mass: 0.1 kg}}}}
forces:
  down: gravity
  cord: {spring: {from: bars.b.eye, to: ball.bob.position, stiffness: 200 N/m}}
ties:
  middle: {hinge: {between: [bars.a, world], at: 0 0 0 m}}
  joint: {hinge: {between: [bars.b, bars.a], at: 0 0 0 m}}
  left: {ball: {between: [sheet.top_left, bars.a], at: -0.6 0 0 m}}
  right: {ball: {between: [sheet.top_right, bars.b], at: 0.6 0 0 m}}
solvers: {main: {SOLVER}}
"""


def test_a_cloth_hangs_on_bars_that_hinges_hold_by_an_implicit_method(tmp_path):
    words = ("dop853: {tolerance: 1e-9}", "bdf2: {step: 2 ms}", "bdf2: {step: 1 ms}")
    names = ("bars.a.position", "bars.b.eye.position", "sheet.bottom_left.position", "sheet.top_right.position")
    exact, coarse, fine = (watch(tmp_path, CLOTH.replace("SOLVER", word), [0.2], *names)[0] for word in words)
    errors = [np.abs(np.subtract(found, exact)).max() for found in (coarse, fine)]
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.4)


def test_many_bodies_on_springs_at_their_points_take_implicit_methods(tmp_path):
    count = 35
    bodies = "\n".join(
        f"        b{k}: {{mass: 1 kg, inertia: 0.01 0.02 0.03 kg*m^2, position: {k} 0 0 m,"
        " points: {up: 0.1 0.1 0 m, end: 0.3 0 0.1 m, start: -0.3 0 0 m}}"
        for k in range(count)
    )
    springs = "\n".join(
        f"  u{k}: {{spring: {{from: many.b{k}.up, to: {k} 1 0 m, stiffness: 50 N/m, damping: 1 N*s/m}}}}\n"
        f"  s{k}: {{spring: {{from: many.b{k}.end, to: many.b{abs(k - 1)}.start, stiffness: 9 N/m, rest: 0.3 m}}}}"
        for k in range(count)
    )
    script = f"""
clock: {{end: 1 s}}
models:
  many:
    rigid:
      bodies:
{bodies}
forces:
  down: gravity
{springs}
  push: {{force: {{at: many.b3.end, components: ["-0.1*x", "sin(t)", "0.1*vy"]}}}}
solvers: {{main: {{SOLVER}}}}
"""
    names = [f"many.b{k}.{output}" for k in (0, 3, 17) for output in ("position", "spin")]
    words = ("dop853: {tolerance: 1e-10}", "radau: {tolerance: 1e-6}")
    exact, found = (watch(tmp_path, script.replace("SOLVER", word), [0.3], *names)[0] for word in words)
    np.testing.assert_allclose(found, exact, rtol=1e-5, atol=1e-5)


def test_a_light_link_holds_a_weight_of_any_ratio(tmp_path):
    """The forces on the light one cancel to rounding, which once left its acceleration to chance."""
    places = []
    for ratio in (1e8, 1e12):
        path = tmp_path / "scene.yaml"
        path.write_text(f"""
clock: {{end: 1 s}}
models:
  two:
    rigid:
      bodies:
        light: {{mass: 1 kg, inertia: 0.01 0.083 0.083 kg*m^2, position: 0.5 0 0 m}}
        heavy: {{mass: {ratio} kg, inertia: {ratio / 100} {ratio / 12} {ratio / 12} kg*m^2, position: 1.5 0 0 m}}
forces: [gravity]
ties:
  one: {{hinge: {{between: [two.light, world], at: 0 0 0 m}}}}
  between: {{hinge: {{between: [two.heavy, two.light], at: 1 0 0 m}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-9}}}}}}
""")
        run = Run(load(path, pruned=False))
        moment = run.at(0.1)  # the former ratio took 17 steps to there, the latter above 30,000
        assert run.islands[0].march.statistics.steps < 100
        places.append(
            [moment.read("two", f"{name}.{output}") for name in ("light", "heavy") for output in ("position", "spin")]
        )
    np.testing.assert_allclose(places[1], places[0], atol=1e-7)


def test_a_ball_on_a_stiff_spring_swings_as_a_mass_does(tmp_path):
    script = """
clock: {end: 2 s}
objects: {round: {sphere: {radius: 0.1 m, position: 1 0 0 m}}}
models: {a: MODEL}
forces: {down: gravity, rod: {spring: {from: PLACE, to: 0 0 0 m, stiffness: 1e8 N/m, rest: 1 m}}}
solvers: {main: {radau: {tolerance: 1e-6}}}
"""
    for model, place in (
        ("{particles: {list: {bob: {position: 1 0 0 m, mass: 1 kg}}}}", "a.bob.position"),
        ("{rigid: {of: round, mass: 1 kg}}", "a.position"),
    ):
        ((found,),) = watch(tmp_path, script.replace("MODEL", model).replace("PLACE", place), [2], place)
        np.testing.assert_allclose(found, [0.7935662 - 6.39e-7, -0.60848393 - 1.122e-6, 0], atol=1e-7)
