"""Slopes of rigid bodies, their ties and what acts on their points: the border of the linear systems of stages."""

from functools import partial

import numpy as np

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
    jacobian(system)(march._functions, t, y, values, floats, system.ints)
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
