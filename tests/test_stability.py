"""Steps told to be stable or not: by `check` from the script alone, by `explain` from the spectrum, and by running."""

import json
import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sceneql import pipeline
from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import RunFailure, Unsuitable
from sceneql.kinds.eigenvalues import eigenvalues
from sceneql.kinds.stable_step import StaticScene, stable_step
from sceneql.march.stability import stability
from sceneql.report.stability import stability as report
from sceneql.report.stability_map import default_sweep
from sceneql.report.stability_sweep import parse_sweep
from sceneql.run import watch
from sceneql.run.run import Run
from sceneql.words.models.mass_spring import MassSpring
from steps import loaded, warnings

PENDULUM = """\
sceneql: 1
define: {k: 1e6 N/m, dt: 1 ms, c: 0 N*s/m}
clock: {end: 2 s}
models:
  swing:
    mass_spring:
      masses: {pivot: {fixed: yes}, bob: {position: 1 0 0 m, mass: 1 kg}}
      springs:
        - {between: [pivot, bob], stiffness: k, damping: c, name: tether}
forces: [gravity]
solvers: {main: {rk4: {step: dt}}}
outputs: {table: {record: {of: [swing.bob.position]}}}
"""
NETS = {
    "lattice": "{count: 4 5 3, spacing: 0.3 m, shear: 0.7}",
    "cloth": "{cells: 5 6, size: 2 3 m, shear: 0.5, bend: 0.1}",
    "rope": "{from: 0 0 0 m, to: 1 0 0 m, count: 12}",
}
ONE_NET = "models: {{net: {{mass_spring: {{{net}: {how}, stiffness: 200 N/m, damping: 0.1 N*s/m}}}}}}\n"
CHAIN = """\
models:
  net:
    mass_spring:
      masses: {a: {fixed: yes}, b: {position: 1 0 0 m}, c: {position: 2 1 0 m, mass: 20 g}, d: {position: 2 2 1 m}}
      springs: [{between: [a, b]}, {between: [b, c], stiffness: 3 kN/m}, {between: [c, d]}, {between: [d, b]}]
"""
TAIL = "solvers: {main: {rk4: {step: 1 ms}}}\nclock: {end: 1 s}\noutputs: {data: {record: {of: [net.energy]}}}\n"


def test_a_step_beyond_the_bound_is_warned_of_with_the_spring_that_sets_it(tmp_path):
    assert warnings(loaded(tmp_path, PENDULUM)) == []
    graph = loaded(tmp_path, PENDULUM, "define.dt=1/60 s")
    assert warnings(graph) == ["dt = 16.7 ms exceeds 2.83 ms, set by spring 'tether' (scene.yaml:9)"]
    assert "smaller step" in graph.warnings[0].help
    assert graph.warnings[0].span.text == "dt"
    half = loaded(tmp_path, PENDULUM, "solvers.main={semi_implicit_euler: {step: 3 ms}}")
    assert warnings(half) == ["dt = 3 ms exceeds 2 ms, set by spring 'tether' (scene.yaml:9)"]


def test_a_method_without_a_stable_step_says_how_far_it_swings(tmp_path):
    (message,) = warnings(loaded(tmp_path, PENDULUM, "solvers.main={euler: {step: 1 ms}}"))
    assert message == (
        "euler is stable at no step: with dt = 1 ms spring 'tether' (scene.yaml:9) swings 1e301 times as far after 2 s"
    )
    assert warnings(loaded(tmp_path, PENDULUM, "solvers.main={euler: {step: 1 ms}}", "define.k=1 N/m")) == []
    # A damped spring has a bound, and drag may damp one.
    damped = ("solvers.main={euler: {step: 1 ms}}", "define.c=100 N*s/m")
    assert warnings(loaded(tmp_path, PENDULUM, *damped)) == [
        "dt = 1 ms exceeds 0.1 ms, set by spring 'tether' (scene.yaml:9)"
    ]
    drag = PENDULUM.replace("[gravity]", "[gravity, {drag: {linear: 1 N*s/m}}]")
    assert warnings(loaded(tmp_path, drag, damped[0])) == []


@pytest.mark.parametrize("word", ["verlet", "boris", "blanes_moan"])
def test_strong_damping_bounds_methods_that_advance_by_pairs(tmp_path, word):
    graph = loaded(tmp_path, PENDULUM, f"solvers.main={{{word}: {{step: 1 s}}}}", "define.c=1e4 N*s/m")
    told = re.fullmatch(r"dt = 1 s exceeds (\S+) (ms|us), set by spring 'tether' \(scene.yaml:9\)", warnings(graph)[0])
    (island,) = Run(graph).islands
    sharp = stability(island.march, island.solver).step
    assert float(told[1]) * {"ms": 1e-3, "us": 1e-6}[told[2]] == pytest.approx(sharp, rel=0.01)


def test_the_stiff_spring_is_told_not_a_soft_one_that_hangs_on_it(tmp_path):
    soft = PENDULUM.replace(
        "name: tether}", "name: tether}\n        - {between: [bob, end], stiffness: 1 N/m, name: thread}"
    )
    soft = soft.replace("mass: 1 kg}}", "mass: 1 kg}, end: {position: 2 0 0 m, mass: 1 kg}}")
    assert warnings(loaded(tmp_path, soft, "define.dt=1/60 s")) == [
        "dt = 16.7 ms exceeds 2.83 ms, set by spring 'tether' (scene.yaml:9)"
    ]


@pytest.mark.parametrize("damping", [100.0, 1900.0, 3e3])
def test_damped_springs_have_their_bound_under_semi_implicit_euler(tmp_path, damping):
    # It holds up to step decay + (step frequency)^2 / 2 = 2.
    sets = (f"define.c={damping} N*s/m", "define.dt=5 ms")
    (message,) = warnings(loaded(tmp_path, PENDULUM.replace("rk4", "semi_implicit_euler"), *sets))
    exact = (math.sqrt(damping**2 + 4 * 1e6) - damping) / 1e6
    assert message == f"dt = 5 ms exceeds {exact * 1e3:.3g} ms, set by spring 'tether' (scene.yaml:9)"


def test_adaptive_steps_are_not_warned_of(tmp_path):
    assert warnings(loaded(tmp_path, PENDULUM, "define.dt=1 s", "solvers.main=dopri5")) == []


@pytest.mark.parametrize("script", [*(ONE_NET.format(net=net, how=how) for net, how in NETS.items()), CHAIN])
def test_the_bound_of_the_script_holds_and_is_near_the_spectrum(tmp_path, script):
    """Frequencies told by fields alone are not below those of the Jacobian, and at most 30 % above."""
    graph = loaded(tmp_path, script + TAIL)
    (island,) = Run(graph).islands
    model = next(task.kind for task in graph.tasks.values() if isinstance(task.kind, MassSpring))
    told = max(fast.frequency for fast in model.fastest("net", StaticScene({}, 1.0)))
    from sceneql.march.modes import jacobian

    matrix = jacobian(island.march)
    of = island.march.system.partner
    positions = np.flatnonzero(of >= 0)
    sharp = math.sqrt(np.abs(np.linalg.eigvals(matrix[np.ix_(of[positions], positions)])).max())
    assert sharp * (1 - 1e-6) <= told <= 1.3 * sharp


FIXED = ["euler", "heun", "midpoint", "rk4", "semi_implicit_euler", "verlet", "blanes_moan", "boris"]


@pytest.mark.parametrize("word", FIXED)
@given(st.floats(0.1, 10.0), st.floats(0.0, 30.0), st.floats(-5.0, 5.0), st.floats(1e-3, 3.0))
def test_growth_without_numpy_is_the_growth(word, frequency, decay, turn, scaled):
    """Of x'' = -frequency^2 x - (decay - i turn) x', written out in real numbers."""
    solver = Catalogue().load("solvers", word).model_validate({})
    step = scaled / max(frequency, decay, abs(turn))
    matrix = np.zeros((4, 4))
    matrix[:2, 2:] = np.eye(2)
    matrix[2:, :2] = -(frequency**2) * np.eye(2)
    matrix[2:, 2:] = [[-decay, -turn], [turn, -decay]]
    growth = solver.growth(matrix, np.array([2, 3, -1, -1]), step)
    assert solver.oscillation(frequency, decay, step, turn) == pytest.approx(growth, rel=1e-6)


@given(st.integers(1, 12), st.integers(0, 2**32 - 1), st.booleans())
def test_eigenvalues_without_numpy_are_the_eigenvalues(n, seed, sparse):
    chance = np.random.default_rng(seed)
    matrix = chance.standard_normal((n, n)) * 10.0 ** chance.uniform(-3, 3, (n, 1))
    matrix *= chance.random((n, n)) < (0.4 if sparse else 1.0)
    exact, found = np.linalg.eigvals(matrix), np.array(eigenvalues(matrix.tolist()))
    # Symmetric functions of them: single ones of a defective matrix are known to the root of the rounding unit alone.
    size = np.linalg.norm(matrix) or 1.0
    for power in range(1, n + 1):
        assert np.sum((found / size) ** power) == pytest.approx(np.sum((exact / size) ** power), abs=1e-10 * n)


def test_known_stable_steps():
    known = {"rk4": 2 * math.sqrt(2), "semi_implicit_euler": 2.0, "verlet": 2.0}
    known |= {"euler": 0.0, "midpoint": 0.0, "heun": 0.0}
    for word, bound in known.items():
        solver = Catalogue().load("solvers", word).model_validate({})
        assert stable_step(lambda z, solver=solver: solver.oscillation(1.0, 0.0, z)) == pytest.approx(bound, abs=1e-4)


@pytest.mark.parametrize("word", ["auto", "implicit_euler: {step: 1 ms}"])
def test_what_rk4_would_need_is_told_of_methods_that_need_it_not(tmp_path, word):
    graph = loaded(tmp_path, PENDULUM, f"solvers.main={{{word if ':' in word else f'{word}: {{}}'}}}")
    (island,) = Run(graph).islands
    told = re.search(r"rk4 would need steps of at most (\S+) s", stability(island.march, island.solver).text)
    assert float(told[1]) == pytest.approx(2 * math.sqrt(2) / 1e3, rel=1e-3)


@pytest.mark.parametrize("word", ["rk4", "semi_implicit_euler"])
def test_runs_hold_below_the_bound_and_fail_above(tmp_path, word):
    """A spring without length and nothing else: linear, so that what grows at all fails."""
    script = PENDULUM.replace("forces: [gravity]\n", "").replace("stiffness: k", "stiffness: k, rest: 0 m")
    graph = loaded(tmp_path, script, f"solvers.main={{{word}: {{step: dt}}}}", "clock.end=10 s")
    bound = stability(*(lambda run: (run.march, run.solver))(Run(graph).islands[0])).step
    for factor in (0.95, 1.05):
        again = loaded(tmp_path, script, f"solvers.main={{{word}: {{step: {factor * bound!r} s}}}}", "clock.end=10 s")
        run = Run(again)
        if factor < 1:
            (moment,) = run.moments([10.0])
            assert abs(moment.read("swing", "bob.position")[0]) < 1.1
            assert not again.warnings
        else:
            with pytest.raises(RunFailure, match="unstable"):
                list(run.moments([10.0]))
            assert warnings(again)


@pytest.fixture
def few(monkeypatch):
    """Fewer solvers: each is compiled for each structure of an island. No other family is asked for."""
    words = Catalogue.words
    kept = {"dopri5", "euler", "midpoint", "radau", "rk4", "semi_implicit_euler"}
    monkeypatch.setattr(Catalogue, "words", lambda self, family: [w for w in words(self, family) if w in kept])


def dry_run(tmp_path, script, **options):
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    text = report(lambda more: pipeline.load(path, sets=more), output=tmp_path, **options)
    return text, json.loads((tmp_path / "scene.stability.json").read_text())["cells"]


def test_the_map_over_steps_turns_at_the_bound(tmp_path, few):
    """A linear spring: below its bound a run holds, above it fails."""
    script = PENDULUM.replace("forces: [gravity]\n", "").replace("stiffness: k", "stiffness: k, rest: 0 m")
    _, cells = dry_run(tmp_path, script, sweep="step=1e-4..1e-2", points=9)
    assert {cell["solver"] for cell in cells} >= {"euler", "midpoint", "rk4", "semi_implicit_euler"}
    for cell in cells:
        if cell["solver"] in ("rk4", "semi_implicit_euler"):
            assert cell["bound"] == pytest.approx(
                {"rk4": 2.828e-3, "semi_implicit_euler": 2e-3}[cell["solver"]], rel=1e-3
            )
            assert (cell["outcome"] == "failed") == (cell["setting"] > cell["bound"])
        if cell["solver"] == "euler":
            assert (cell["outcome"], cell["bound"]) == ("failed", 0)
    fine = {cell["solver"]: cell for cell in cells if cell["value"] == 1e-4}
    assert fine["rk4"]["outcome"] == "stable"
    assert fine["rk4"]["error"] < 1e-2


def test_the_map_over_stiffness_tells_stable_from_inaccurate_and_failed(tmp_path, few):
    """A spring pendulum from soggy to stiff at 1/60 s."""
    script = PENDULUM.replace("dt: 1 ms", "dt: 1/60 s")
    _, cells = dry_run(tmp_path, script, sweep="define.k=1e0..1e6 N/m", points=4)
    by = {(cell["solver"], cell["value"]): cell for cell in cells}
    assert [by["rk4", k]["outcome"] for k in (1.0, 100.0)] == ["stable", "stable"]
    assert {cell["value"] for cell in cells} == {1.0, 100.0, 1e4, 1e6}
    assert by["euler", 1e6]["outcome"] == "failed"
    assert by["dopri5", 1e6]["outcome"] == "stable"
    assert by["euler", 1e4]["outcome"] == "failed"
    for cell in cells:
        if cell["outcome"] == "failed":
            stopped = cell["error"] is None and "s, swing" in cell["why"]
            assert stopped or (cell["error"] > 10 and "ran away" in cell["why"])
    for extension in ("csv", "svg", "html"):
        assert (tmp_path / f"scene.stability.{extension}").stat().st_size > 0


def test_the_steps_tried_by_default_lie_around_the_bound(tmp_path):
    sweep = default_sweep(loaded(tmp_path, PENDULUM))
    assert sweep.path == "step"
    assert sweep.values[0] < 2e-4 < 2e-3 < 2e-2 < sweep.values[-1]


@given(st.floats(1e-12, 1e12), st.floats(1e-12, 1e12), st.integers(2, 40))
def test_a_sweep_is_even_in_the_logarithm_and_keeps_its_ends(low, high, points):
    values = parse_sweep(f"define.k={low!r}..{high!r} N/m", points).values
    assert (values[0], values[-1], len(values)) == (low, high, points)
    steps = np.diff(np.log(values))
    assert steps == pytest.approx(np.full(points - 1, math.log(high / low) / (points - 1)), abs=1e-5)


def test_sweeps_are_read(tmp_path):
    decades = parse_sweep("define.k = 1e0 .. 1e12 N/m", 13)
    assert decades.values == tuple(10.0**k for k in range(13))
    assert decades.sets(100.0) == ("define.k=100.0 N/m",)
    assert parse_sweep("define.a=-1..1", 3).values == (-1.0, 0.0, 1.0)
    assert parse_sweep("step=1e-4..1e-2 s", 3).sets(1e-3) == ()
    for wrong in ("define.k", "define.k=1", "step=0..1", "step=1..2 m", "tolerance=1e-3..1e-1 s"):
        with pytest.raises(Unsuitable):
            parse_sweep(wrong)


def test_energy_out_of_nothing_is_warned_of_and_a_sound_run_is_not(tmp_path):
    """Beyond its bound a spring that flips over its pivot saturates: its state stays finite, its energy does not."""
    wild = pipeline.render(loaded(tmp_path, PENDULUM, "define.dt=3 ms"), folder=tmp_path, account=True)
    assert [found.code for found in wild.warnings] == ["energy-gained"]
    assert "more than its forces can give" in wild.warnings[0].message
    sound = pipeline.render(loaded(tmp_path, PENDULUM), folder=tmp_path, account=True)
    assert sound.warnings == ()
    (line,) = sound.conserved
    assert float(re.search(r", (\S+) at most", line)[1]) < 0.05


def test_rounding_of_a_sheet_at_rest_is_no_energy_out_of_nothing(tmp_path):
    """A cloth without forces has 1e-26 J of rounding, which grew fifty times: its step was called too large."""
    cloth = "models: {flag: {cloth: {size: 1.2 0.8 m, cells: 12 8, center: 1 2 0 m, facing: 0 0 1, pins: [left]}}}\n"
    still = "clock: {end: 1 s}\noutputs: {still: {image: {size: 32 18, time: 1 s}}}\n"
    (tmp_path / "rest.yaml").write_text(cloth + still + "solvers: {main: {implicit_euler: {step: 1/120 s}}}\n")
    done = pipeline.render(pipeline.load(tmp_path / "rest.yaml"), folder=tmp_path)
    assert "energy-gained" not in {found.code for found in done.warnings}


def test_energy_out_of_nothing_is_warned_of_beside_a_planet(tmp_path):
    """A satellite by Euler's method: the planet's mass is no measure of what rounding is."""
    script = """
models:
  sky:
    particles:
      list: {earth: {mass: 6e24 kg, fixed: yes}, sat: {mass: 1000 kg, position: 7000 0 0 km, velocity: 0 7.5 0 km/s}}
forces: [mutual_gravity]
solvers: {main: {euler: {step: 200 s}}}
clock: {end: 20000 s, speed: 4000}
outputs: {table: {record: {of: [sky.energy], every: 2000 s}}}
"""
    done = pipeline.render(loaded(tmp_path, script), folder=tmp_path)
    assert [found.code for found in done.warnings] == ["energy-gained"]


def test_energy_out_of_nothing_is_warned_of_where_one_picture_is_made_at_the_end(tmp_path):
    still = PENDULUM[: PENDULUM.index("outputs:")] + "outputs: {still: {image: {size: 32 32}}}\n"
    wild = pipeline.render(loaded(tmp_path, still, "define.dt=3 ms"), folder=tmp_path)
    assert [found.code for found in wild.warnings] == ["energy-gained"]


def test_energy_that_births_bring_is_no_fault(tmp_path):
    spray = "models: {spray: {particles: {emit: {rate: 30 Hz, spread: 30 deg, lifetime: 1 s}}}}\nforces: [gravity]\n"
    spray += "clock: {end: 1.2 s}\noutputs: {table: {record: {of: [spray.energy]}}}\n"
    assert pipeline.render(loaded(tmp_path, spray), folder=tmp_path).warnings == ()


def test_momentum_is_told_where_nothing_outside_acts(tmp_path):
    free = PENDULUM.replace("forces: [gravity]\n", "").replace("pivot: {fixed: yes}", "pivot: {velocity: 0 1 0 m/s}")
    (line,) = pipeline.render(loaded(tmp_path, free, "define.k=100 N/m"), folder=tmp_path, account=True).conserved
    assert float(re.search(r"momentum drift (\S+)", line)[1]) < 1e-12
    (line,) = pipeline.render(loaded(tmp_path, PENDULUM), folder=tmp_path).conserved
    assert "momentum" not in line


def test_large_nets_are_watched_when_a_look_is_cheap_beside_the_run(tmp_path, monkeypatch):
    """Runs of no time at all cannot afford one; of 10 s between two pictures can."""
    script = "clock: {end: 0.1 s, fps: 100}\nforces: [{gravity: {strength: 1e3 m/s^2}}]\n"
    script += "models: {c: {cloth: {cells: 64 64, stretch: 4 N/m, shear: 0.4 N/m, bend: 0.04 N/m, pins: [top]}}}\n"
    script += "solvers: {main: {semi_implicit_euler: {step: 1 ms}}}\noutputs: {table: {record: {of: [c.center]}}}\n"
    for seconds, codes in ((0.0, []), (10.0, ["over-stretched"])):
        clock = [0.0]
        monkeypatch.setattr(watch.time, "perf_counter", lambda clock=clock: clock[0])
        run = Run(loaded(tmp_path, script))
        seen = watch.Watch(run)
        for k in range(11):
            clock[0] += seconds
            seen.look(run.at(k / 100))
        assert [found.code for found in seen.warnings()] == codes


def test_the_start_of_large_nets_is_looked_at_whatever_it_costs(tmp_path):
    """Springs drawn out within the first picture are so beside the start, though no run affords a look there."""
    script = "clock: {end: 0.1 s, fps: 100}\nforces: [{gravity: {strength: 1e3 m/s^2}}]\n"
    script += "models: {c: {cloth: {cells: 64 64, stretch: 4 N/m, shear: 0.4 N/m, bend: 0.04 N/m, pins: [top]}}}\n"
    script += "solvers: {main: {semi_implicit_euler: {step: 1 ms}}}\noutputs: {table: {record: {of: [c.center]}}}\n"
    run = Run(loaded(tmp_path, script))
    seen = watch.Watch(run)
    seen.look(run.at(0.0))
    (balance,) = seen.balances
    assert balance.times == [0.0]
    assert balance.stretch["c"][0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "force",
    [
        "mutual_gravity: {constant: 1 m^3/kg/s^2}",
        "repulsion: {range: 3 m}",
        "electrostatic: {charge: 1 uC}",
        "spring: {from: p.a.position, to: p.b.position}",
    ],
)
def test_momentum_is_told_where_masses_move_each_other_alone(tmp_path, force):
    script = "clock: {end: 1 s}\noutputs: {table: {record: {of: [p.energy]}}}\nmodels: {p: {particles: {list: {"
    script += f"a: {{velocity: 0 1 0 m/s}}, b: {{position: 1 0.2 0 m, mass: 2 kg}}}}}}}}}}\nforces: [{{{force}}}]\n"
    (line,) = pipeline.render(loaded(tmp_path, script), folder=tmp_path, account=True).conserved
    assert float(re.search(r"momentum drift (\S+)", line)[1]) < 1e-12
    held = (
        script.replace("to: p.b.position", "to: 1 1 0 m") if "spring" in force else script.replace("[{", "[gravity, {")
    )
    (line,) = pipeline.render(loaded(tmp_path, held), folder=tmp_path, account=True).conserved
    assert "momentum" not in line


def test_invariants_of_equations_are_told(tmp_path):
    """A swing by Euler's method, whose energy grows by 1 + h^2 a step."""
    script = "clock: {end: 1 s, fps: 10}\nsolvers: {main: {euler: {step: 0.1 s}}}\nmodels: {e: {equations: {"
    script += "start: {y: 1, y': 0}, rate: {y'': -y}, invariants: {energy: (y^2 + y'^2)/2, nothing: 0*y}}}}\n"
    script += "outputs: {table: {record: {of: [e.y]}}}\n"
    energy, nothing = pipeline.render(loaded(tmp_path, script), folder=tmp_path, account=True).conserved
    assert energy == f"e: energy drift {1.01**9 - 1:.2e} at the end, {1.01**9 - 1:.2e} at most"
    assert nothing == "e: nothing drift 0.00e+00 at the end, 0.00e+00 at most"
    lost = pipeline.render(loaded(tmp_path, script, "clock.end=6 s"), folder=tmp_path).warnings
    assert [found.code for found in lost] == ["invariant-lost"]
    assert pipeline.render(loaded(tmp_path, script, "clock.end=3 s"), folder=tmp_path).warnings == ()


def test_an_invariant_that_begins_with_nothing_but_rounding_is_not_lost(tmp_path):
    """A pendulum let go from 90 degrees: cos(pi/2) is 6e-17, and every error much more than that."""
    script = "clock: {end: 2 s, fps: 10}\nsolvers: {main: {rk4: {step: 10 ms}}}\nmodels: {e: {equations: {"
    script += "start: {a: 90 deg, a': 0}, rate: {a'': -9.81*sin(a)}, invariants: {energy: a'^2/2 - 9.81*cos(a)}}}}\n"
    script += "outputs: {table: {record: {of: [e.a]}}}\n"
    assert pipeline.render(loaded(tmp_path, script), folder=tmp_path).warnings == ()
    coarse = script.replace("{rk4: {step: 10 ms}}", "{euler: {step: 50 ms}}").replace("end: 2 s", "end: 6 s")
    assert [found.code for found in pipeline.render(loaded(tmp_path, coarse), folder=tmp_path).warnings] == [
        "invariant-lost"
    ]


def test_an_island_that_a_method_refuses_is_mapped_by_the_others(tmp_path, few):
    """More states than full matrices are factored for."""
    script = "clock: {end: 0.1 s}\nforces: [gravity]\nsolvers: {main: {rk4: {step: 1 ms}}}\n" + ONE_NET.format(
        net="rope", how="{from: 0 0 0 m, to: 1 0 0 m, count: 80}"
    )
    _, cells = dry_run(
        tmp_path, script + "outputs: {data: {record: {of: [net.energy]}}}\n", sweep="step=1e-3..2e-3", points=2
    )
    assert {cell["outcome"] for cell in cells if cell["solver"] == "rk4"} == {"stable"}


SKIN = """\
clock: {end: 4 ms}
models:
  air: {flow: {size: 1 1 m, cell: 1/CELLS m, density: 1 kg/m^3, viscosity: 0.1 Pa*s}}
  egg: {membrane: {of: ball, law: {tension: 1 N/m}FILLING}}
objects: {ball: {implicit: {field: x^2 + y^2 - 0.09, position: 0.5 0.5 0 m}}}
forces: [{immersion: {on: [egg], in: air}}]
solvers: {main: {chorin: {step: 1 ms}}}
outputs: {data: {record: {of: [egg.area]}}}
"""


FILLING = ", filling: {density: 3 kg/m^3, viscosity: 0.1 Pa*s}"


@pytest.mark.parametrize(
    ("cells", "filling", "refusing", "text"),
    [(32, "", "implicit_euler", "gives no slopes"), (8, FILLING, "sbdf2", "density or viscosity varies")],
    ids=["large", "full"],
)
def test_a_skin_in_a_flow_is_mapped_by_what_marches_it(tmp_path, monkeypatch, cells, filling, refusing, text):
    """Implicit methods refuse many vertices, and some of those for flows what holds another fluid."""
    words = Catalogue.words
    kept = {"dopri5", "implicit_euler", "sbdf2", "chorin"}
    monkeypatch.setattr(Catalogue, "words", lambda self, family: [w for w in words(self, family) if w in kept])
    script = SKIN.replace("FILLING", filling).replace("CELLS", str(cells))
    _, tried = dry_run(tmp_path, script, sweep="step=1e-3..2e-3", points=2)
    skipped = {cell["solver"]: cell["why"] for cell in tried if cell["outcome"] == "skipped"}
    assert skipped[refusing].startswith(f"{refusing} does not apply: ")
    assert text in skipped[refusing]
    assert "does not apply" not in skipped.get("chorin", "")


def test_many_masses_in_free_flight_have_no_step_to_bound(tmp_path):
    """More than their spectrum is worked out for whole: nothing that iterates finds a mode of what only falls."""
    rain = "models: {rain: {particles: {emit: {rate: 1 kHz, from: 0 5 0 m, lifetime: 1 s}}}}\nforces: [gravity]\n"
    rain += "clock: {end: 1 s}\noutputs: {table: {record: {of: [rain.energy]}}}\n"
    (island,) = Run(loaded(tmp_path, rain)).islands
    found = stability(island.march, island.solver)
    assert found.step == math.inf
    assert "any step is stable" in found.text
