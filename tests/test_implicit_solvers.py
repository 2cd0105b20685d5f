"""Implicit solvers: stability, conservation, stiff limits, failures and the systems that they solve."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from islands import TETHER, assembly, balls, final, fixed, simple, springs
from runs import watch
from sceneql.bodies import springs as springs_module
from sceneql.failure import LimitRefused, RunFailure
from sceneql.island import jacobian as layout
from sceneql.linear import stage, stage_kernels
from sceneql.linear.kept_factors_kernels import solve_by_kept
from sceneql.march import driver
from sceneql.march.march import March
from sceneql.march.modes import jacobian
from sceneql.pipeline import load, render
from sceneql.run.run import IslandRun
from sceneql.words.solvers.bdf2 import Bdf2
from sceneql.words.solvers.implicit_euler import ImplicitEuler
from sceneql.words.solvers.implicit_midpoint import ImplicitMidpoint
from sceneql.words.solvers.rodas5p import Rodas5p
from sceneql.words.solvers.tr_bdf2 import TrBdf2

ALL = (ImplicitEuler, ImplicitMidpoint, TrBdf2, Bdf2, Rodas5p)
L_STABLE = (ImplicitEuler, TrBdf2, Bdf2, Rodas5p)
CHAIN = """sceneql: 1
clock: {{end: 1 s}}
models:
  chain:
    mass_spring:
      rope: {{from: 0 0 0 m, to: {length} 0 0 m, count: {count}}}
      mass: {mass} kg
      stiffness: {stiffness} N/m
      pins: [start, end]
solvers:
  main: {solver}
outputs:
  film: {{video: {{size: 16 16}}}}
"""


def oscillator(damping: float, square: float) -> np.ndarray:
    return np.array([[0.0, 1.0], [-square, -damping]])


@pytest.mark.parametrize("word", ALL)
def test_no_step_grows_what_does_not_grow(word):
    kind = word()
    for z in np.logspace(-3, 6, 60):
        for damping in (0.0, 0.1, 3.0):
            assert kind.growth(oscillator(damping, 1.0), np.array([1, -1]), z) <= 1.0 + 1e-9


@pytest.mark.parametrize("word", L_STABLE)
def test_stiff_modes_die_out_at_once(word):
    assert word().growth(np.array([[-1.0]]), np.array([-1]), 1e10) < 1e-4


def test_bdf2_grows_by_its_largest_root():
    system = simple("linear", [1.0, 0.0], [-0.3, 1.0])
    march = March(system, Bdf2(step=0.4).stepper(), 100.0)
    sizes = [np.hypot(*march.advance(0.4 * k)[0]) for k in (100, 200)]
    expected = Bdf2().growth(np.array([[-0.3, -1.0], [1.0, -0.3]]), np.array([-1, -1]), 0.4)
    assert (sizes[1] / sizes[0]) ** 0.01 == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("word", L_STABLE)
def test_a_stiff_spring_leaves_the_slow_one_alone(word):
    """The slow spring of two is as exact as alone, though the fast one is far from resolved."""
    step = 1e-2
    alone = final(springs([4.0], [0.2]), fixed(word().stepper(), step), 1.0)
    both = final(springs([4.0, 1e10], [0.2, 1e3]), fixed(word().stepper(), step), 1.0)
    assert both[[0, 2]] == pytest.approx(alone, abs=1e-9)
    assert abs(both[1]) < 1e-6


def test_the_midpoint_rule_keeps_quadratic_invariants():
    system = springs([9.0], [0.0])
    march = March(system, ImplicitMidpoint(step=0.1).stepper(), 1000.0)
    for t in (10.0, 1000.0):
        x, v = march.advance(t)[0]
        assert 9.0 * x * x + v * v == pytest.approx(10.0, rel=1e-10)


@pytest.mark.parametrize("word", [TrBdf2, Bdf2, Rodas5p])
def test_the_error_follows_the_tolerance(word):
    system = simple("pendulum", [1.5, 0.2])
    exact = final(system, fixed(Rodas5p().stepper(), 1e-3), 3.0)
    errors = [np.abs(final(system, word(tolerance=tol).stepper(), 3.0) - exact).max() for tol in (1e-4, 1e-6)]
    assert errors[0] < 1e-2
    assert errors[1] < errors[0] / 8


@pytest.mark.parametrize("word", [TrBdf2, Bdf2, Rodas5p])
def test_a_bounce_is_found_and_restarted_from(word):
    found = balls([1.0], 0.8)
    march = March(found.system, word(tolerance=1e-8).stepper(), 1.0)
    y = march.advance(0.9)[0]
    hit = math.sqrt(2.0 / 9.81)
    speed, rest = 0.8 * 9.81 * hit, 0.9 - hit
    assert y[0] == pytest.approx(speed * rest - 4.905 * rest**2, abs=1e-6)
    assert march.statistics.events == 1


PENDULUM = """sceneql: 1
clock: {{end: 0.5 s}}
models:
  swing:
    mass_spring:
      masses: {{hold: {{position: 0 0 0 m, fixed: yes}}, bob: {{position: 1 0 0 m, mass: 1 kg}}}}
      springs: [{{between: [hold, bob], stiffness: {stiffness} N/m}}]
forces: [gravity]
solvers: {{main: {{{word}: {{step: 1/60 s}}}}}}
outputs: {{film: {{video: {{size: 16 16}}}}}}
"""


TIED = """sceneql: 1
clock: {{end: 0.5 s}}
models:
  swing: {{particles: {{list: {{far: {{position: 0 2 0 m, mass: 1 kg}}, bob: {{position: 1 0 0 m, mass: 1 kg}}}}}}}}
forces: [gravity, {{spring: {{from: swing.bob.position, to: 0 0 0 m, stiffness: {stiffness} N/m}}}}]
solvers: {{main: {{{word}: {{step: 1/60 s}}}}}}
outputs: {{film: {{video: {{size: 16 16}}}}}}
"""


@pytest.mark.parametrize("script", [PENDULUM, TIED])
@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e12])
def test_implicit_euler_swings_on_a_very_stiff_spring(tmp_path, stiffness, script):
    """Each step in closed form: along the free flight's direction from the hold, its length nearly the spring's."""
    script = script.format(stiffness=stiffness, word="implicit_euler")
    h, place, speed = 1 / 60, np.array([1.0, 0.0]), np.zeros(2)
    for _ in range(30):
        free = place + h * speed - [0.0, 9.81 * h * h]
        far = math.hypot(*free)
        after = free / far * (1.0 + (far - 1.0) / (1.0 + h * h * stiffness))
        place, speed = after, (after - place) / h
    (found,) = watch(tmp_path, script, [0.5], "swing.positions")[0]
    assert found[1, :2] == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize("word", ["implicit_euler", "implicit_midpoint", "tr_bdf2", "bdf2"])
@pytest.mark.parametrize("stiffness", [1e8, 1e10, 1e12])
def test_short_steps_swing_like_a_rod_on_a_very_stiff_spring(tmp_path, word, stiffness):
    """Rounding of a length times the stiffness is far above the tolerance of Newton's method.

    Errors of order 2 are some (0.001)^2 here, and bdf2's first step is Euler's, half of g h^2 off.
    """
    script = PENDULUM.format(stiffness=stiffness, word=word).replace("1/60 s}", "1 ms}")
    rod = solve_ivp(lambda t, y: [y[1], -9.81 * math.cos(y[0])], (0, 0.2), [0, 0], rtol=1e-10, atol=1e-12)
    (found,) = watch(tmp_path, script, [0.2], "swing.positions")[0]
    angle = rod.y[0, -1]
    error = np.abs(found[1, :2] - (math.cos(angle), math.sin(angle))).max()
    assert error < (2e-3 if word == "implicit_euler" else 1e-5)


def test_a_step_without_a_solution_is_halved_until_it_has_one_and_that_is_told(tmp_path):
    """y1 = y0 + h y1^2 has a real solution as long as 4 h y0 < 1: not from 1 in 0.45 s, nor from there in 0.225 s."""
    script = """models: {blow: {equations: {start: {y: 1}, rate: {y: y^2}}}}
solvers: {main: {implicit_euler: {step: 0.45 s}}}
clock: {end: 0.45 s}
outputs: {table: {record: {of: [blow.y]}}}
"""
    y = 1.0
    for h in (0.225, 0.1125, 0.1125):
        y = (1.0 - math.sqrt(1.0 - 4.0 * h * y)) / (2.0 * h)
    path = tmp_path / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    graph = load(path, pruned=False)
    march = IslandRun(graph, graph.islands[0]).march
    assert march.advance(0.45)[0] == pytest.approx(y, rel=1e-8)
    assert (march.statistics.steps, march.statistics.rejected) == (3, 2)
    (told,) = render(load(path), folder=tmp_path).warnings
    assert (told.code, told.span.line) == ("steps-halved", 2)
    assert "no solution 2 times: steps of 0.45 s" in told.message


def test_a_step_that_newton_finds_no_solution_of_says_so(tmp_path):
    """y = 1/(1 - t) ends at 1 s: no step over that instant has a solution, however often it is halved."""
    blow_up = "{equations: {start: {y: 1}, rate: {y: y^2}}}"
    script = (
        f"models: {{blow: {blow_up}}}\nsolvers: {{main: {{implicit_euler: {{step: 0.5 s}}}}}}\nclock: {{end: 2 s}}\n"
    )
    path = tmp_path / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    graph = load(path, pruned=False)
    with pytest.raises(RunFailure, match="Newton's method finds no solution") as caught:
        IslandRun(graph, graph.islands[0]).march.advance(2.0)
    assert caught.value.span is not None


def test_a_flat_cloth_falls_in_steps_that_plain_newton_diverges_at(tmp_path):
    """Springs under compression: the same fall from steps of 20 ms and of 5 ms, on the sparse factorization."""
    script = """sceneql: 1
clock: {{end: 0.3 s}}
models: {{cloth: {{mass_spring: {{cloth: {{size: 10 10 m, cells: 11 11}}, mass: 0.01 kg, stiffness: 1 MN/m,
  damping: 20 N*s/m, pins: [top_left, top_right]}}}}}}
forces: [gravity, {{drag: {{linear: 0.1 N*s/m}}}}]
solvers: {{main: {{bdf2: {{step: {step} ms, newton: 1e-4}}}}}}
outputs: {{film: {{video: {{size: 16 16}}}}}}
"""
    ends = [watch(tmp_path, script.format(step=step), [0.3], "cloth.positions")[0][0] for step in (20, 5)]
    assert np.abs(ends[0][:, 1] - 2.0).max() > 0.1
    assert ends[0] == pytest.approx(ends[1], abs=0.01)


def test_a_stage_without_a_solution_is_a_located_failure():
    system = simple("blow_up", [1.0])
    for word in (ImplicitEuler, ImplicitMidpoint):
        with pytest.raises(RunFailure) as caught:
            final(system, word(step=0.5).stepper(), 2.0)
        assert caught.value.span == TETHER


@pytest.mark.parametrize(("count", "kind"), [(6, "dense"), (60, "sparse")])
def test_a_stage_system_is_solved(tmp_path, monkeypatch, count, kind):
    """(1 - a J) d = r for the Jacobian by differences, though positions and fixed masses are eliminated."""
    monkeypatch.setattr(stage, "KEPT", 0)
    from sceneql.pipeline import load
    from sceneql.run.run import Run

    path = tmp_path / "scene.yaml"
    text = CHAIN.format(length=count, count=count, mass=0.5, stiffness=200, solver="{tr_bdf2: {step: 1 ms}}")
    path.write_text(text, encoding="utf-8")
    march = Run(load(path)).islands[0].march
    system = march.system
    plan = stage.stage_plan(system)
    assert plan.text.startswith(kind)
    values, store = np.zeros(system.pattern.room), np.zeros(plan.store)
    driver.jacobian(march.system)(march._engaged.functions, 0.0, system.y, values, march.floats, system.ints)
    a, n = 0.3, len(system.y)
    right = np.random.default_rng(3).standard_normal(n)
    right[np.abs(jacobian(march)).sum(axis=1) == 0.0] = 0.0
    d = right.copy()
    assert stage_kernels.factor_stage(plan.numbers, a, values, plan.scales, store)
    assert stage_kernels.solve_stage(plan.numbers, a, values, plan.scales, store, d)
    assert (np.eye(n) - a * jacobian(march)) @ d == pytest.approx(right, abs=1e-5)
    if kind == "sparse":
        assert plan.numbers[stage_kernels.SYMMETRIC] == 1
        # The factors serve another matrix, by conjugate gradients: one that is near, not one that is far.
        for other, near in ((0.31, True), (1e-3, False)):
            stage_kernels.assemble_stage(plan.numbers, other, values, plan.scales, store)
            d = right.copy()
            assert solve_by_kept(plan.numbers, other, values, plan.scales, store, d) == near
            if near:
                exact = np.linalg.solve(np.eye(n) - other * jacobian(march), right)
                assert np.linalg.norm(d - exact) < 0.1 * np.linalg.norm(exact)
            else:
                assert (d == right).all()


def test_threads_share_the_slopes_to_the_same_bytes(tmp_path, monkeypatch):
    """Of cloth in any shape, damped and moving: those of one thread, and within rounding of differences."""
    monkeypatch.setattr(layout, "TILE", 700)
    monkeypatch.setattr(springs_module, "SPRINGS_A_TILE", 100)
    cloth = "{mass_spring: {cloth: {size: 1 1 m, cells: 6 5}, mass: 0.1 kg, stiffness: 50 N/m, damping: 0.3 N*s/m}}"
    path = tmp_path / "scene.yaml"
    text = f"models: {{cloth: {cloth}}}\nforces: [gravity, {{drag: {{linear: 0.1 N*s/m}}}}]\nclock: {{end: 1 s}}\n"
    path.write_text(f"{text}solvers: {{main: bdf2}}\n", encoding="utf-8")
    graph = load(path, pruned=False)
    found = []
    for threads in (1, 2, 3):
        monkeypatch.setenv("SCENEQL_THREADS", str(threads))
        march = IslandRun(graph, graph.islands[0]).march
        system = march.system
        y = system.y + 0.05 * np.random.default_rng(7).standard_normal(len(system.y))
        values = np.full(system.pattern.room, 7.0)
        driver.jacobian(march.system)(march._engaged.functions, 0.0, y, values, march.floats, system.ints)
        found.append(values[: len(system.pattern.columns)].copy())
    assert found[0].tobytes() == found[1].tobytes() == found[2].tobytes()
    rows = system.pattern.rows
    whole = np.zeros((len(y), len(y)))
    whole[rows, system.pattern.columns] = found[0]
    moves = 1e-6 * np.eye(len(y))
    differences = [(march.rate(0.0, y + move) - march.rate(0.0, y - move)) / 2e-6 for move in moves]
    known = [k for k in range(len(y)) if k not in system.pattern.tallies]
    assert whole[known] == pytest.approx(np.array(differences).T[known], abs=1e-4)


def test_a_chain_of_springs_has_its_dispersion(tmp_path):
    """omega = 2 sqrt(k/m) sin(q a/2) of standing longitudinal waves (the modes of the assembled Jacobian)."""
    from sceneql.pipeline import load
    from sceneql.run.run import Run

    count, mass, stiffness = 22, 0.1, 50.0
    path = tmp_path / "scene.yaml"
    path.write_text(
        CHAIN.format(length=count - 1, count=count, mass=mass, stiffness=stiffness, solver="rodas5p"), encoding="utf-8"
    )
    march = Run(load(path)).islands[0].march
    values = np.zeros(march.system.pattern.room)
    driver.jacobian(march.system)(
        march._engaged.functions, 0.0, march.system.y, values, march.floats, march.system.ints
    )
    rows, columns = march.system.pattern.rows, march.system.pattern.columns
    whole = np.zeros((len(march.system.y),) * 2)
    whole[rows, columns] = values[: len(columns)]
    along = np.arange(3, 3 * (count - 1), 3)
    squares = -np.linalg.eigvalsh(whole[np.ix_(3 * count + along, along)])
    q = np.pi * np.arange(1, count - 1) / (count - 1)
    expected = 2.0 * math.sqrt(stiffness / mass) * np.sin(q / 2)
    assert np.sqrt(np.sort(squares)) == pytest.approx(expected, rel=1e-6)


def test_a_wave_on_the_chain_keeps_its_frequency(tmp_path):
    """The lowest standing wave, run: after a period of its dispersion the chain is where it began."""
    count, mass, stiffness, amplitude = 8, 0.1, 50.0, 1e-2
    q = math.pi / (count - 1)
    period = math.pi / (math.sqrt(stiffness / mass) * math.sin(q / 2))
    masses = ", ".join(f"m{k}: {{position: {k + amplitude * math.sin(q * k)} 0 0 m}}" for k in range(count))
    ties = ", ".join(f"{{between: [m{k}, m{k + 1}], rest: 1 m}}" for k in range(count - 1))
    script = f"""sceneql: 1
clock: {{end: {period} s}}
models:
  chain: {{mass_spring: {{masses: {{{masses}}}, springs: [{ties}], mass: {mass} kg, stiffness: {stiffness} N/m,
    pins: [m0, m{count - 1}]}}}}
solvers: {{main: {{rodas5p: {{tolerance: 1e-9}}}}}}
outputs: {{film: {{video: {{size: 16 16}}}}}}
"""
    (start,), (half,), (end,) = watch(tmp_path, script, [0.0, period / 2, period], "chain.positions")
    assert end == pytest.approx(start, abs=1e-6 * amplitude * 10)
    assert half[:, 0] - np.arange(count) == pytest.approx(np.arange(count) - start[:, 0], abs=1e-7)


def test_differences_stand_in_where_slopes_are_unknown():
    island = assembly()
    with island.word("model", TETHER):
        island.state([1.0, 0.5])
    island.term("internal", "solver_kernels:pendulum", (0,))
    system = island.finish(jacobian=True)
    assert not system.pattern.exact
    plan = stage.stage_plan(system)
    assert "dense" in plan.text


def test_explain_says_how_stage_systems_are_solved(tmp_path):
    from sceneql.pipeline import load
    from sceneql.report.explain import explain

    path = tmp_path / "scene.yaml"
    path.write_text(CHAIN.format(length=5, count=6, mass=0.1, stiffness=50, solver="tr_bdf2"), encoding="utf-8")
    assert "dense LU factorization of 12 unknowns" in str(explain(load(path)))


def test_an_implicit_solver_refuses_what_it_has_no_jacobian_of():
    system = simple("pendulum", [0.0] * 1000)
    assert system.pattern is None
    with pytest.raises(LimitRefused, match="Jacobian"):
        March(system, TrBdf2().stepper(), 1.0)
