"""The methods that `auto` takes: by the tolerance, by the modes of the island, by how much of the run is left."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql.march import engaged
from sceneql.march.march import March
from sceneql.march.spectrum import spectrum
from sceneql.pipeline import load
from sceneql.report.explain import explain
from sceneql.report.work_precision import at, setting_of
from sceneql.run.run import IslandRun
from sceneql.words.solvers.auto import Auto


def equations(start: str, rate: str) -> str:
    return f"models: {{system: {{equations: {{start: {start}, rate: {rate}}}}}}}"


def marched(folder, script: str, solver: str, end: float) -> tuple[np.ndarray, March]:
    """The state at the end, and the march."""
    path = folder / "scene.yaml"
    path.write_text(
        f"{script}\nclock: {{end: {end} s, speed: {end}}}\nsolvers: {{main: {{{solver}}}}}\n", encoding="utf-8"
    )
    graph = load(path, pruned=False)
    island = IslandRun(graph, graph.islands[0])
    return island.march.advance(end)[0], island.march


def taken(march: March) -> list[str]:
    """The methods in turn."""
    return [why.partition(":")[0] for _, why in march.choices()]


ROBERTSON = equations("{a: 1, b: 0, c: 0}", "{a: -p+q, b: p-q-r, c: r}").replace(
    "rate:", "where: {p: 0.04*a, q: 1e4*b*c, r: 3e7*b^2}, rate:"
)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_auto_takes_no_more_evaluations_than_radau_where_a_decay_is_over_long_before_the_end(tmp_path, tolerance):
    _, ours = marched(tmp_path, ROBERTSON, f"auto: {{tolerance: {tolerance}}}", 1e11)
    _, named = marched(tmp_path, ROBERTSON, f"radau: {{tolerance: {tolerance}}}", 1e11)
    assert ours.choices()[0][1].startswith("radau: a decay at 0.04/s")
    assert ours.statistics.evaluations < 1.1 * named.statistics.evaluations


def test_auto_takes_the_stiff_method_for_some_hundred_steps_that_stability_holds(tmp_path):
    """Its change was reckoned three times as dear as it is: 1,744 steps of dop853 went on to the end."""
    relaxing = equations("{x: 0}", "{x: '-1000*(x - cos(t)) - sin(t)'}")
    y, march = marched(tmp_path, relaxing, "auto: {tolerance: 1e-9}", 10)
    assert taken(march) == ["dop853", "radau"]
    assert march.statistics.steps < 600
    assert y[0] == pytest.approx(np.cos(10), abs=1e-9)


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9])
def test_auto_errs_no_more_than_radau_on_slow_relaxations(tmp_path, tolerance):
    """It left radau for dop853 in their swift parts: no sooner at the end, and with a hundred times its error."""
    system = equations("{y: 2, z: 0}", "{y: z, z: 200*(1 - y^2)*z - y}")
    exact, _ = marched(tmp_path, system, "radau: {tolerance: 1e-13}", 400)
    named, _ = marched(tmp_path, system, f"radau: {{tolerance: {tolerance}}}", 400)
    ours, _ = marched(tmp_path, system, f"auto: {{tolerance: {tolerance}}}", 400)
    assert abs(ours[0] - exact[0]) < 3.0 * abs(named[0] - exact[0])


def test_auto_leaves_a_decay_that_a_growth_mirrors_to_the_explicit_method(tmp_path):
    """Near a heavy body one direction falls apart as fast as another closes: nothing is over in such a time."""
    script = """
models: {b: {particles: {list: {planet: {position: 0.01 0 0 m, velocity: [0, 199^0.5, 0]}}}}}
forces: [attractor]
"""
    _, march = marched(tmp_path, script, "auto: {}", 60)
    assert taken(march) == ["dop853"]


FOLLOWING = equations("{x: 1, y: 0}", "{x: '-2000*(x - cos(y))', y: 1}")


def test_auto_finds_stiffness_where_rounding_keeps_steps_below_the_stable_one(tmp_path):
    """At a tolerance of 1e-11 the steps are a sixth of the longest stable one, 18,175 of them."""
    y, march = marched(tmp_path, FOLLOWING, "auto: {tolerance: 1e-11}", 10)
    assert taken(march) == ["dop853", "radau"]
    assert march.statistics.steps < 2500
    assert y[0] == pytest.approx((2000**2 * np.cos(10) + 2000 * np.sin(10)) / (2000**2 + 1), abs=1e-11)


VAN_DER_POL = equations("{y: 2, z: 0}", "{y: z, z: ((1 - y^2)*z - y)*1e6}")


def test_a_method_that_is_taken_again_is_not_laid_out_again(tmp_path, monkeypatch):
    """Its first steps know nothing of the last ones before: they are those of a method laid out anew."""
    laid_out = []
    engage = engaged.engage

    def counted(system, stepper, driver):
        laid_out.append(stepper.method.name)
        return engage(system, stepper, driver)

    monkeypatch.setattr(engaged, "engage", counted)
    y, march = marched(tmp_path, VAN_DER_POL, "auto: {tolerance: 1e-11}", 2)
    assert taken(march) == ["radau", "dop853", "radau", "dop853", "radau"]
    assert laid_out == ["dop853", "radau", "dop853"], "the island is laid out anew with its Jacobian after the first"
    monkeypatch.setattr(engaged.Methods, "begin", lambda _, *island, counts: engage(*island).begin(counts))
    anew, _ = marched(tmp_path, VAN_DER_POL, "auto: {tolerance: 1e-11}", 2)
    assert np.array_equal(y, anew)


@pytest.mark.parametrize("seconds", [0.0, 1e9])
def test_how_many_steps_a_compiled_call_takes_changes_no_byte(tmp_path, monkeypatch, seconds):
    """A call takes a third of a second: twenty would pass before a flow's run could be interrupted or limited."""
    expected, one = marched(tmp_path, VAN_DER_POL, "auto: {tolerance: 1e-11}", 2)
    monkeypatch.setattr("sceneql.march.pace.A_CALL", seconds)
    found, other = marched(tmp_path, VAN_DER_POL, "auto: {tolerance: 1e-11}", 2)
    assert found.tobytes() == expected.tobytes()
    assert (other.statistics.steps, other.choices()) == (one.statistics.steps, one.choices())


def test_auto_does_not_change_its_method_for_the_few_steps_that_are_left(tmp_path):
    """Laying the island out for radau takes longer than some hundred short steps."""
    script = equations("{a: 1, b: 1}", "{a: -b*(a - cos(t)), b: 'where(t > 5, 0, 3)*b'}")
    _, march = marched(tmp_path, script, "auto: {}", 3.0)
    assert taken(march) == ["dop853"]


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_auto_takes_the_evaluations_of_order_8_on_a_spring(tmp_path, tolerance):
    spring = equations("{a: 1, a': 0}", "{a'': -a}")
    y, ours = marched(tmp_path, spring, f"auto: {{tolerance: {tolerance}}}", 50)
    by_five, five = marched(tmp_path, spring, f"dopri5: {{tolerance: {tolerance}}}", 50)
    assert ours.statistics.evaluations < 0.8 * five.statistics.evaluations
    assert abs(y[0] - np.cos(50)) < abs(by_five[0] - np.cos(50))


def test_a_look_at_modes_that_are_slow_asks_for_no_eigenvalues(monkeypatch):
    asked = []
    monkeypatch.setattr(np.linalg, "eigvals", lambda matrix: asked.append(matrix) or np.zeros(len(matrix)))
    partner, y = np.array([1, -1]), np.array([1.0, 0.0])

    def rate(t, y):
        return np.array([y[1], -1e4 * y[0]])

    assert not len(spectrum(rate, partner, 0.0, y, negligible=120.0))
    assert not asked
    assert len(spectrum(rate, partner, 0.0, y, negligible=90.0)) == len(asked[0]) == 2


def test_the_stable_step_of_auto_is_that_of_the_method_that_it_begins_with(tmp_path):
    script = """
models: {a: {particles: {list: {p: {position: 0 1 0 m, mass: 1 kg}}, radius: 0.1 m}}}
forces: [{spring: {from: a.p.position, to: 0 2 0 m, stiffness: 1000 N/m, rest: 1 m}}]
contacts: [collision]
outputs: {table: {record: {of: [a.energy]}}}
solvers: {main: {SOLVER}}
"""
    steps = []
    for solver in ("auto: {tolerance: 1e-5}", "dopri5: {tolerance: 1e-5}"):
        path = tmp_path / "scene.yaml"
        path.write_text(script.replace("SOLVER", solver))
        (island,) = explain(load(path))["islands"]
        steps.append(island["step_bound"])
    assert steps[0] == pytest.approx(steps[1], rel=1e-9)
    assert setting_of(at(Auto(), 1e-4)) == 1e-4


def test_what_auto_makes_of_elastic_solids_is_told(tmp_path):
    """It said that auto takes its place, and radau where it is stiff."""
    path = tmp_path / "scene.yaml"
    path.write_text(
        "models: {b: {elastic: {block: {size: 1 1 1 m, cells: [1, 1, 1]}, element: p1, "
        "law: {linear: {modulus: 1 kPa, poisson: 0.3}}}}}\nsolvers: {main: auto}\n"
        "outputs: {table: {record: {of: [b.energy]}}}\n"
    )
    (island,) = explain(load(path))["islands"]
    assert "elastic solids at a tolerance of 0.0001, by tr_bdf2, not radau, where they are stiff" in island["why"]
    assert "takes its place" not in island["why"]


def test_a_cloth_that_lands_leaves_the_stiff_method_to_few_steps(tmp_path):
    """Landings cut steps of radau to 1e-7 s, and modes of contacts passed for explicit steps that it replaced: the
    cloth took fifty times what dopri5 takes by name."""
    script = """
objects: {ball: {sphere: {radius: 0.6 m, position: 0 0.8 0 m}}}
models: {sheet: {cloth: {size: 2 2 m, cells: 24 24, center: 0 1.8 0 m}}}
forces: [gravity]
contacts: {touch: {collision: {friction: 0.4, restitution: 0}}}"""
    _, ours = marched(tmp_path, script, "auto: {}", 0.5)
    _, named = marched(tmp_path, script, "dopri5: {}", 0.5)
    assert "radau" in taken(ours)
    assert ours.statistics.evaluations < 2 * named.statistics.evaluations
    assert ours._switch._early == 0  # the trial is over: none of its checks is taken for one of the explicit method


def test_auto_marches_a_beam_by_steps_of_its_slow_motion(tmp_path):
    """At a tolerance of 1e-6 it took 2,100 steps of order 8 for half of this, held by waves across the beam."""
    script = (
        "models: {beam: {elastic: {block: {size: 1 0.1 0.1 m, cells: [4, 1, 1]}, element: p2, "
        "law: {neo_hookean: {modulus: 1 MPa}}, hold: {wall: {where: x < -0.49}}}}}\nforces: [gravity]"
    )
    end, march = marched(tmp_path, script, "auto: {}", 0.5)
    exact, _ = marched(tmp_path, script, "radau: {tolerance: 1e-5}", 0.5)
    positions = march.system.partner >= 0
    np.testing.assert_allclose(end[positions], exact[positions], atol=1e-3)
    assert taken(march)[-1] == "tr_bdf2"
    assert march.statistics.steps < 500
