"""What solvers tell: errors by each state's own size, singularities, decays, rings at boundaries, errors by kind."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql import pipeline
from sceneql.failure import RunFailure
from sceneql.march.stability import stability
from sceneql.report.error_measure import ErrorMeasure
from sceneql.run.ringing import ringing
from sceneql.run.run import IslandRun
from sceneql.system import IslandFacts
from sceneql.words.solvers.auto import Auto
from sceneql.words.solvers.gauss_radau15 import GaussRadau15

E5 = """models: {e5: {equations: {
  start: {y1: 1.76e-3, y2: 0, y4: 0},
  where: {y3: y2-y4, p: 7.89e-10*y1, q: 1.1e7*y1*y3, r: 1.13e9*y2*y3, s: 1.13e3*y4},
  rate: {y1: -p-q, y2: p-r, y4: q-s}}}}"""
ORBIT = """models: {m: {particles: {list: {p: {position: 0.1 0 0 m, velocity: [0, 19^0.5, 0]}}}}}
forces: [attractor]"""
ROOT = """models: {m: {equations: {copies: {count: 20, as: i}, start: {x: "i + 1", y: "2 - i/40"}, rate: ROWS}}}"""


def island(folder, script, solver, end=1.0):
    path = folder / "scene.yaml"
    path.write_text(f"{script}\nclock: {{end: {end} s, speed: {end}}}\nsolvers: {{main: {solver}}}\n")
    graph = pipeline.load(path, pruned=False)
    return IslandRun(graph, graph.islands[0])


@pytest.mark.parametrize(
    ("solver", "digits"), [("radau: {tolerance: 1e-9}", 8), ("rodas5p: {tolerance: 1e-9}", 8), ("auto", 5)]
)
def test_a_state_nineteen_decades_below_another_is_seen(tmp_path, solver, digits):
    """The chemical kinetics E5 (Enright, Hull & Lindberg 1975); inside a step and at the end; SciPy's at rtol 1e-12."""
    run = island(tmp_path, E5, f"{{{solver}}}" if ":" in solver else solver, 1e13)
    for t, exact in ((9e12, 9.847258618535418e-23), (1e13, 8.861233521288889e-23)):
        y, _ = run.march.advance(t)
        assert y[1] == pytest.approx(exact, rel=10.0**-digits, abs=0.0)


@pytest.mark.parametrize(
    "solver", ["auto", "dopri5", "{dop853: {tolerance: 1e-12}}", "radau", "gauss_radau15", "adams"]
)
def test_an_end_of_the_equations_in_one_of_many_copies_is_told_with_its_copy(tmp_path, solver):
    """x of copy 0 comes first below its bound; that of y is undefined from the first instant in none."""
    run = island(tmp_path, ROOT.replace("ROWS", "{x: '-1 - 0*x^1e-6', y: '-y'}"), solver, 3)
    with pytest.raises(RunFailure, match="a singularity, beyond which the rate of x of copy 0 has no value") as told:
        run.march.advance(3.0)
    assert told.value.time == pytest.approx(1.0, abs=1e-6)
    assert told.value.span.text.startswith("'-1")


def test_an_end_at_the_first_instant_is_told(tmp_path):
    run = island(tmp_path, ROOT.replace('"i + 1"', "0").replace("ROWS", "{x: '-1 - 0*x^1e-6', y: '-y'}"), "auto")
    with pytest.raises(RunFailure, match="x of copy 0"):
        run.march.advance(1.0)


@pytest.mark.parametrize(
    ("row", "why"),
    [("y^2", "a singularity, where"), ("-1/(2*y)", "a singularity, where"), ("1e3*sin(1e12*z)*y", "rounding")],
)
def test_a_singularity_is_told_from_a_tolerance_that_rounding_exceeds(tmp_path, row, why):
    script = f"models: {{m: {{equations: {{start: {{y: 1, z: 1e6}}, rate: {{y: '{row}', z: -z}}}}}}}}"
    with pytest.raises(RunFailure, match=why):
        island(tmp_path, script, "gauss_radau15" if why == "rounding" else "auto", 2).march.advance(2.0)


def test_steps_that_never_come_to_the_next_instant_are_told_soon(tmp_path, monkeypatch):
    monkeypatch.setattr("sceneql.march.march.ENTRIES_A_CALL", 100_000)
    fast = "models: {m: {equations: {start: {a: 1, b: 0}, rate: {a: 1e16*b/(1 s), b: -1e16*a/(1 s)}}}}"
    with pytest.raises(RunFailure, match=r"as short as .* s are left .*: the rate of [ab] is .* too large"):
        island(tmp_path, fast, "dopri5").march.advance(1.0)


def test_steps_that_are_short_at_first_alone_go_on(tmp_path):
    """A rate of 1e14/s that dies out within 1e-12 s."""
    script = "models: {m: {equations: {start: {a: 1}, rate: {a: -1e14*a*exp(-1e14*time)}}}}"
    y, _ = island(tmp_path, script, "dopri5").march.advance(1.0)
    assert y == pytest.approx(np.exp(-1.0), rel=1e-3)


@pytest.mark.parametrize("damping", ["1e300 %", "1e308 %"])
def test_a_first_step_that_vanishes_is_told(tmp_path, damping):
    cloth = f"size: 1 1 m, cells: 2 2, stretch: 800 N/m, damping: {damping}, pins: {{top_left: {{}}}}"
    script = f"models: {{m: {{cloth: {{{cloth}}}}}}}\nforces: [gravity]"
    with pytest.raises(RunFailure, match="below the resolution of time"):
        island(tmp_path, script, "auto").march.advance(1.0)


@pytest.mark.parametrize(("tolerance", "name"), [(1e-3, "dopri5"), (1e-4, "dop853"), (1e-8, "dop853")])
def test_auto_takes_order_8_where_its_tolerance_is_tight(tmp_path, tolerance, name):
    script = "models: {m: {equations: {start: {a: 1, a': 0}, rate: {a'': -a}}}}"
    run = island(tmp_path, script, f"{{auto: {{tolerance: {tolerance}}}}}")
    assert run.march.choices()[0][1].startswith(name)


def test_auto_follows_orbits_to_rounding_at_tight_tolerances(tmp_path):
    run = island(tmp_path, ORBIT, "{auto: {tolerance: 1e-11}}", 20)
    assert isinstance(run.solver, GaussRadau15)
    y, _ = run.march.advance(20.0)
    energy = 0.5 * y[3:6] @ y[3:6] - 1 / np.linalg.norm(y[:3])
    assert energy == pytest.approx(-0.5, abs=1e-13)


def test_auto_takes_an_absolute_error():
    methods = Auto(absolute=1e-30).choose(IslandFacts(3))
    assert methods.first.control.absolute == methods.stiff.control.absolute == 1e-30


def test_a_decay_is_told_by_its_rate(tmp_path):
    run = island(tmp_path, "models: {m: {equations: {start: {y: 1}, rate: {y: -100*y}}}}", "{rk4: {step: 50 ms}}")
    assert "a decay of 'm' at 100/s" in stability(run.march, run.solver).text


@pytest.mark.parametrize(("solver", "rings"), [("crank_nicolson", True), ("tr_bdf2", False)])
def test_cells_that_lag_behind_a_moving_boundary_value_ring_with_a_warning(tmp_path, solver, rings):
    script = """objects: {disc: {sphere: {radius: 0.45 m, hidden: yes}}}
models: {d: {diffusion: {domain: disc, cell: 1/8 m, of: number, coefficient: 1 m^2/s,
  boundary: {disc: {value: sin(3*t)}}}}}"""
    found = ringing(island(tmp_path, script, f"{{{solver}: {{step: 20 ms}}}}"))
    assert (found is not None) == rings
    assert found is None or "tr_bdf2" in found.help


def test_errors_do_not_depend_on_where_the_origin_is_and_what_comes_to_rest_is_told(tmp_path):
    def measured(off, shrink):
        run = island(tmp_path, "models: {m: {equations: {start: {x: 1, x': 0}, rate: {x'': -x}}}}", "dopri5")
        times = np.linspace(0, 30, 200)
        looks = [(t, np.array([off + np.cos(t), -np.sin(t)])) for t in times]
        rest = [(t, np.array([off + shrink * np.cos(t), -shrink * np.sin(t)])) for t in times]
        measure = ErrorMeasure.of(run, np.ones(2, dtype=bool), looks)
        return measure.error(looks[-1][1] + [0.02, 0.01], looks[-1][1]), measure.damped(rest)

    (near, entry), gone = measured(0.0, 0.01)
    (far, _), kept = measured(1000.0, 0.9)
    assert entry == 0
    assert near == pytest.approx(0.01, rel=1e-3) == far
    assert gone is not None
    assert kept is None
