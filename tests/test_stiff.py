"""The island's Jacobian, and the solvers of stiff systems that use it."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

import sceneql.system.channels as channels
from sceneql.bodies.mass_spring_slopes_kernels import HOLDS
from sceneql.failure import LimitRefused, RunFailure
from sceneql.march.driver import jacobian
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.run.run import IslandRun, Run
from sceneql.words.solvers.rk4 import Rk4

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
    jacobian(system)(march._engaged.functions, t, y, values, march.floats.copy(), system.ints)
    matrix = np.zeros((len(y), len(y)))
    rows = pattern.rows
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


def test_positive_slopes_leave_a_spring_what_inertia_holds(tmp_path):
    """Pressed by a tenth, k = 500 N/m pushes across with 500 * 0.1/0.9 N/m, on the lighter mass of 2 kg."""
    march, bodies = lone_spring(tmp_path)
    y = march.system.y
    row, column = bodies.velocity_at + 4, bodies.position_at + 4
    march.floats[-channels.BEFORE * len(y) :] = np.concatenate([y, y])
    for positive, rate, expected in ((0, 20, 500 / 9), (1, 1e6, 500 / 9), (1, 20.0, 40.0), (1, 1e-300, 0.0)):
        march.floats[channels.POSITIVE] = positive
        march.floats[channels.NEWTON] = HOLDS / rate
        found = dense(march, 0.0, y)
        assert found[row, column] == pytest.approx(expected / 2)
        assert found[row - 1, column - 1] == pytest.approx(-500 / 2)


def test_slopes_of_newtons_method_take_the_force_that_the_latest_change_foresaw(tmp_path):
    """A spring of 0.9 m that a change moves by 0.3 m along and 0.4 m across: its linear length is 1.2 m."""
    march, bodies = lone_spring(tmp_path)
    old, new = march.system.y, march.system.y.copy()
    new[bodies.position_at + 3] += 0.3
    new[bodies.position_at + 4] += 0.4
    march.floats[-channels.BEFORE * len(old) :] = np.concatenate([old, new])
    march.floats[channels.NEWTON] = 1.0
    found = dense(march, 0.0, new)
    across = np.array([-0.4, 1.2, 0.0]) / np.hypot(0.4, 1.2)
    at = bodies.position_at + 3, bodies.velocity_at + 3
    block = found[at[1] : at[1] + 3, at[0] : at[0] + 3]
    assert across @ block @ across == pytest.approx(-500 * (1.2 - 1.0) / np.hypot(0.4, 1.2) / 2)


def lone_spring(folder):
    """A spring of 500 N/m and 1 m between 3 kg and 2 kg, pressed to 0.9 m: the march and the masses."""
    masses = "{a: {position: 0 0 0 m, mass: 3 kg}, b: {position: 0.9 0 0 m, mass: 2 kg}}"
    spring = "{between: [a, b], stiffness: 500 N/m, rest: 1 m}"
    run = island(folder, f"models: {{net: {{mass_spring: {{masses: {masses}, springs: [{spring}]}}}}}}")
    return March(run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0), run.bodies["net"]


def test_a_term_that_does_not_know_its_slopes_is_differenced(tmp_path):
    run = island(tmp_path, f"models: {TRIANGLE}")
    run.assembly.term("force", "sceneql.bodies.bodies_kernels:close", (0, 9, 0, 0))
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


# --- radau ---


def equations(start, rate):
    return f"models: {{system: {{equations: {{start: {start}, rate: {rate}}}}}}}"


VAN_DER_POL = equations("{y: 2, z: 0}", "{y: z, z: ((1-y^2)*z-y)/1e-6}")


def marched(folder, script, solver, end, at=None):
    path = folder / "scene.yaml"
    path.write_text(f"{script}\nclock: {{end: {end} s, fps: 10}}\nsolvers: {{main: {{{solver}}}}}\n", encoding="utf-8")
    graph = load(path, pruned=False)
    run = IslandRun(graph, graph.islands[0])
    return run.march.advance(end if at is None else at)[0], run.march


@pytest.mark.parametrize(("tolerance", "digits"), [(1e-4, 5.5), (1e-7, 9.0), (1e-10, 12.0)])
def test_radau_meets_the_exact_values_of_van_der_pol(tmp_path, tolerance, digits):
    solver = f"radau: {{tolerance: {tolerance}, absolute: [{tolerance}, {1e-3 * tolerance}]}}"
    y, march = marched(tmp_path, VAN_DER_POL, solver, 2)
    exact = np.array([1.706167732170483, -0.8928097010247975])
    assert np.abs(y / exact - 1).max() < 10**-digits
    assert march.statistics.steps < 12_000


BY_SCALE = ["radau", "rodas5p"]
"""Whose errors are measured by how large entries have been."""
HIRES = """{y1: -1.71*y1 + 0.43*y2 + 8.32*y3 + 0.0007*U, y2: 1.71*y1 - 8.75*y2, y3: -10.03*y3 + 0.43*y4 + 0.035*y5,
  y4: 8.32*y2 + 1.71*y3 - 1.12*y4, y5: -1.745*y5 + 0.43*y6 + 0.43*y7,
  y6: -280/U*y6*y8 + 0.69*y4 + 1.71*y5 - 0.43*y6 + 0.69*y7, y7: 280/U*y6*y8 - 1.81*y7, y8: -280/U*y6*y8 + 1.81*y7}"""


def hires(unit):
    start = f"{{y1: {unit!r}, y2: 0, y3: 0, y4: 0, y5: 0, y6: 0, y7: 0, y8: {0.0057 * unit!r}}}"
    return equations(start, HIRES.replace("U", repr(unit)))


@pytest.mark.parametrize("word", BY_SCALE)
def test_small_entries_are_seen_without_being_told_how_small_they_are(tmp_path, word):
    y, _ = marched(tmp_path, hires(1.0), f"{word}: {{tolerance: 1e-7}}", 321.8122)
    exact = """7.371312573325668e-4 1.442485726316185e-4 5.888729740967575e-5 1.175651343283149e-3 2.386356198831331e-3
        6.238968252742796e-3 2.849998395185769e-3 2.850001604814231e-3"""
    assert np.abs(y / np.array(exact.split(), dtype=float) - 1).max() < 1e-8


@pytest.mark.parametrize("word", BY_SCALE)
def test_steps_are_alike_in_all_units(tmp_path, word):
    runs = []
    for unit in (1.0, 2.0**-20, 2.0**20):
        y, march = marched(tmp_path, hires(unit), f"{word}: {{tolerance: 1e-6, first_step: 1 us}}", 30)
        runs.append((march.statistics.steps, *(y / unit)))
    assert runs[0] == runs[1] == runs[2]


@pytest.mark.parametrize("word", BY_SCALE)
@pytest.mark.parametrize(
    "row",
    ["b: 1000*((a + 0.1) - 0.1 - a - b)", "b: 0*a", "b: 'where(t > 5, a, 0) - b'", "b: -1e4*b", "b: a - sin(t)"],
)
def test_no_stall_on_entries_that_stay_at_zero_or_at_rounding(tmp_path, row, word):
    start = "{a: 1, a': 0, b: 1e-17}"
    y, march = marched(tmp_path, equations(start, "{a'': -a, " + row + "}"), f"{word}: {{tolerance: 1e-6}}", 10)
    assert y[0] == pytest.approx(np.cos(10), abs=1e-5)
    assert march.statistics.steps < 1000


def test_radau_keeps_what_linear_invariants_conserve(tmp_path):
    rate = '{a: "-0.04*a + 1e4*b*c", b: "0.04*a - 1e4*b*c - 3e7*b^2", c: "3e7*b^2"}'
    y, _ = marched(tmp_path, equations("{a: 1, b: 0, c: 0}", rate), "radau: {absolute: 1e-18}", 40)
    assert sum(y) == pytest.approx(1, abs=1e-12)
    assert y[0] == pytest.approx(0.7158270688, abs=1e-6)


@pytest.mark.parametrize("word", BY_SCALE)
def test_none_follows_small_motion_through_the_last_of_its_vibrations(tmp_path, word):
    """Hung a micrometer off its rest, a mass on a stiff damped spring: neither of any size beside the spring's."""
    masses = "{hold: {position: 0 0 0 m, fixed: yes}, bob: {position: 0 -1.0000108 0 m, mass: 1 kg}}"
    spring = "{between: [hold, bob], rest: 1 m, stiffness: 1e6 N/m, damping: 10 N*s/m}"
    script = f"models: {{m: {{mass_spring: {{masses: {masses}, springs: [{spring}]}}}}}}\nforces: [gravity]"
    y, march = marched(tmp_path, script, f"{word}: {{tolerance: 1e-5}}", 20)
    assert y[4] == pytest.approx(-1 - 9.81e-6, abs=1e-6)
    assert march.statistics.steps < 200


def test_radau_counts_the_energy_that_stiff_damping_takes(tmp_path):
    spring = "{mass_spring: {masses: {a: {position: 0 0 0 m, fixed: yes}, b: {position: 2 0 0 m}}, mass: 1 kg, "
    spring += "springs: [{between: [a, b], rest: 1 m}], stiffness: 1e4 N/m, damping: 1e4 N*s/m}}"
    path = tmp_path / "scene.yaml"
    path.write_text(f"models: {{m: {spring}}}\nclock: {{end: 3 s}}\nsolvers: {{main: radau}}\n", encoding="utf-8")
    graph = load(path, pruned=False)
    run = IslandRun(graph, graph.islands[0])
    run.advance(3.0)
    model = graph.tasks["m"].kind
    assert model.read("energy", run.state("m")) == pytest.approx(5000, rel=1e-5)
    assert model.read("dissipated", run.state("m")) > 4900
    assert run.march.statistics.steps < 200


def test_an_absolute_tolerance_for_each_number_is_one_for_each(tmp_path):
    with pytest.raises(RunFailure, match="3 numbers"):
        marched(tmp_path, VAN_DER_POL, "radau: {absolute: [1, 1, 1]}", 1)


# --- auto ---


def pendulum(stiffness):
    """A mass of 1 kg on a spring of 1 m, let go level with its hold."""
    masses = "{hold: {position: 0 0 0 m, fixed: yes}, bob: {position: 1 0 0 m, mass: 1 kg}}"
    spring = f"{{between: [hold, bob], stiffness: {stiffness:g} N/m}}"
    return f"models: {{m: {{mass_spring: {{masses: {masses}, springs: [{spring}]}}}}}}\nforces: [gravity]"


def test_auto_follows_a_stiff_pendulum(tmp_path):
    y, march = marched(tmp_path, pendulum(1e8), "auto: {tolerance: 1e-8}", 2)
    np.testing.assert_allclose(y[3:5], [0.7935656, -0.6084851], rtol=0, atol=1e-7)
    assert march.choices()[0][1].startswith("radau")
    assert march.statistics.steps < 4000


RIGID = [0.7935662, -0.60848393]
"""Where the pendulum is after 2 s on a rod, from an elliptic integral."""


@pytest.mark.parametrize("power", range(0, 13, 2))
def test_auto_never_fails_whatever_the_stiffness(tmp_path, power):
    y, march = marched(tmp_path, pendulum(10.0**power), "auto: {tolerance: 1e-6}", 2)
    assert march.statistics.steps < 10_000
    if power >= 4:
        np.testing.assert_allclose(y[3:5], RIGID, rtol=0, atol=130 / 10.0**power + 3e-6)


def test_auto_comes_near_the_rigid_pendulum_as_one_over_the_stiffness(tmp_path):
    """The stiffer by ten, the nearer by ten, down to the eighth decimal."""
    off = []
    for power in range(4, 9):
        y, _ = marched(tmp_path, pendulum(10.0**power), "auto: {tolerance: 1e-11}", 2)
        off.append((y[3:5] - RIGID) * 10.0**power)
    np.testing.assert_allclose(off, np.broadcast_to(off[1], (5, 2)), rtol=0.012)


def test_auto_stays_explicit_where_nothing_is_stiff(tmp_path):
    _, march = marched(tmp_path, equations("{a: 1, a': 0}", "{a'': -a}"), "auto: {}", 200)
    assert [why.partition(":")[0] for _, why in march.choices()] == ["dop853"]


def test_auto_changes_to_radau_where_a_run_becomes_stiff(tmp_path):
    script = equations("{a: 1, b: 1}", "{a: -b*(a - cos(t)), b: 'where(t > 5, 0, 3)*b'}")
    y, march = marched(tmp_path, script, "auto: {}", 50)
    assert [why.partition(":")[0] for _, why in march.choices()] == ["dop853", "radau"]
    assert march.choices()[1][0] < 10
    assert march.statistics.steps < 5000
    assert y[0] == pytest.approx(np.cos(50), abs=1e-5)
    late, _ = marched(tmp_path, script, "auto: {}", 50, at=30.03)
    assert late[0] == pytest.approx(np.cos(30.03), abs=1e-5)


def test_auto_goes_on_explicitly_where_radau_refuses(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(f"{pendulum(1e8)}\nclock: {{end: 0.02 s}}\nsolvers: {{main: auto}}\n", encoding="utf-8")
    graph = load(path, pruned=False)
    run = IslandRun(graph, graph.islands[0])
    march = run.march
    march._with_jacobian = lambda: replace(run.assembly.finish(jacobian=True), pattern=None)
    march.advance(0.02)
    assert [why.partition(":")[0] for _, why in march.choices()] == ["radau", "dop853"]
    assert "Jacobian" in march.choices()[1][1]


def test_radau_restarts_at_exact_contacts(tmp_path):
    script = """
models: {drop: {mass_spring: {masses: {a: {position: 0 1 0 m}}, radius: 0 m}}}
objects: {floor: plane}
forces: [gravity]
contacts: {bounce: {collision: {between: [drop, floor], restitution: 0.8, friction: 0}}}
"""
    for solver in ("radau: {tolerance: 1e-9}", "auto: {tolerance: 1e-9}"):
        y, march = marched(tmp_path, script, solver, 0.9, at=0.9)
        hit = np.sqrt(2 / 9.81)
        up = 0.8 * 9.81 * hit
        assert y[1] == pytest.approx(up * (0.9 - hit) - 4.905 * (0.9 - hit) ** 2, abs=1e-9)
        assert march.statistics.events == 1


def test_auto_leaves_local_contacts_to_the_explicit_method(tmp_path):
    script = f"""
{pendulum(1e8)}
objects: {{floor: plane}}
contacts: {{bounce: {{collision: {{between: [m, floor], mode: local}}}}}}
"""
    _, march = marched(tmp_path, script, "auto: {}", 0.01)
    assert march.choices() == []
    assert march.statistics.steps > 50


def test_a_refusal_names_the_force_without_slopes(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\n"
        "objects: {ball: {sphere: {radius: 1 m, hidden: yes}}}\n"
        "models: {dust: {particles: {fill: {object: ball, count: 100}}}}\n"
        "forces: {shy: {repulsion: {range: 1 cm}}}\n"
        "solvers: {main: {bdf2: {step: 10 ms}}}\n"
    )
    with pytest.raises(LimitRefused, match="shy gives no slopes") as refused:
        Run(load(path, pruned=False)).islands[0].advance(0.1)
    assert "`auto`" in refused.value.diagnostic.help
