"""The island's Jacobian, and the solvers of stiff systems that use it."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from sceneql.pipeline import load
from sceneql.simulation.driver import jacobian
from sceneql.simulation.march import March
from sceneql.simulation.run import IslandRun
from sceneql.simulation.solvers.rk4 import Rk4

TRIANGLE = """
  net:
    mass_spring:
      masses: {a: {position: 0 0 0 m, fixed: yes}, b: {position: 1 0.2 0 m, mass: 2 kg}, c: {position: 0.4 1 0.3 m}}
      springs: [{between: [a, b], rest: 0.8 m}, {between: [b, c]}, {between: [c, a], damping: 3 N*s/m}]
      velocity: 0.3 -0.2 0.5 m/s
"""
DUST = (
    "  dust: {particles: {list: {p: {position: 1 2 3 m, velocity: 2 0 1 m/s}, q: {mass: 3 kg, position: 1 0 0 m}}}}\n"
)
FREE = """
  free:
    equations: {start: {a: 1, a': 0.3, b: 2}, rate: {a'': -sin(a)*b + 0.1*t, b: a'*b}, copies: {count: 3}}
"""
SCENES = {
    "springs": f"models: {TRIANGLE}",
    "springs and drag": f"models: {TRIANGLE}forces: {{air: {{drag: {{linear: 0.1 N*s/m, quadratic: 0.2 kg/m}}}}}}",
    "attractors": f"models:\n{DUST}forces: [gravity, attractor: {{exponent: 3, softening: 0.2 m, position: 0 0 1 m}}]",
    "varying": f"models: {TRIANGLE}forces: {{air: {{drag: {{linear: 0.1 N/m * (time + 1 s)}}}}}}",
    "equations": f"models: {FREE}",
}


def island(folder, script, solver="rk4"):
    path = folder / "scene.yaml"
    path.write_text(f"{script}\nclock: {{end: 1 s}}\nsolvers: {{main: {solver}}}\n", encoding="utf-8")
    graph = load(path, pruned=False)
    return IslandRun(graph, graph.islands[0])


def dense(march, t, y):
    """The Jacobian by its kernel, as a full matrix."""
    system = march.system
    pattern = system.pattern
    values = np.full(pattern.room, np.nan)
    jacobian(system)(march._functions, t, y, values, march.floats.copy(), system.ints)
    matrix = np.zeros((len(y), len(y)))
    rows = np.repeat(np.arange(len(y)), np.diff(pattern.starts))
    matrix[rows, pattern.columns] = values[: len(rows)]
    return matrix


@pytest.mark.parametrize("scene", SCENES)
def test_the_jacobian_is_the_derivative_of_the_rate(tmp_path, scene):
    run = island(tmp_path, SCENES[scene])
    march = March(run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
    y = march.system.y + 0.1 * np.random.Generator(np.random.Philox(3)).standard_normal(len(march.system.y))
    assert march.system.pattern.exact
    found = dense(march, 0.3, y)
    h = 1e-5
    expected = np.column_stack(
        [(march.rate(0.3, y + h * d) - march.rate(0.3, y - h * d)) / (2 * h) for d in np.eye(len(y))]
    )
    works = [bodies.work_at for bodies in run.bodies.values() if bodies is not None]
    expected[works] = 0.0
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-6)
    assert np.abs(expected).max() > 0.1


def test_a_term_that_does_not_know_its_slopes_is_differenced(tmp_path):
    run = island(tmp_path, f"models: {TRIANGLE}")
    run.assembly.term("force", "sceneql.simulation.bodies_kernels:close", (0, 9, 0, 0))
    exact = March(island(tmp_path, f"models: {TRIANGLE}").assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
    march = March(run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
    assert not march.system.pattern.exact
    np.testing.assert_allclose(
        dense(march, 0.0, march.system.y)[:18], dense(exact, 0.0, exact.system.y)[:18], rtol=1e-4, atol=1e-3
    )


def test_an_explicit_solver_loads_nothing_of_the_jacobian(tmp_path):
    loaded = set(sys.modules)
    run = island(tmp_path, f"models: {FREE}".replace("0.1*t", "0.17*t^3"))
    run.advance(0.5)
    assert run.march.system.pattern is None
    assert not [name for name in set(sys.modules) - loaded if "jacobian_" in name or "slopes" in name]
