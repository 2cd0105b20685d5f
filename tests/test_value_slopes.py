"""Values that read the state give slopes: the Jacobian is the rate's derivative, implicit solvers keep their orders."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import LimitRefused
from sceneql.island.value_slopes import KERNEL
from sceneql.march.driver import jacobian
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.report.explain import explain
from sceneql.run.run import IslandRun, Run
from sceneql.words.solvers.rk4 import Rk4

SCENE = """
clock: {{end: 0.6 s}}
models:
  lead: {{particles: {{list: {{a: {{position: 1.2 0.7 -0.4 m, velocity: 0.3 -0.2 0.5 m/s}}}}}}}}
  gas:
    particles:
      positions:
        - [0 m, 0 m, 0 m]
        - [0.2 m, 0.3 m, 0.1 m]
        - [0.1 m, -0.3 m, 0.4 m]
      velocity: 0.1 0.2 0.4 m/s
      mass: 2 kg
  net:
    mass_spring:
      masses:
        bob: {{position: 0.5 0.5 0.5 m, mass: 1 kg}}
        wall: {{position: 0.6 0.4 0.1 m, mass: 3 kg, fixed: yes}}
      springs: [{{between: [bob, wall]}}]
      stiffness: {stiffness}
      damping: {damping}
  {more}
forces:
  it: {force}
solvers: {{main: {{dopri5: {{tolerance: 1e-10}}}}}}
"""
X, V = "lead.a.position", "lead.a.velocity"
NONE = "{drag: {linear: 0 N*s/m}}"
FACTOR = f"(2 + {X}.y/(1 m))"
FORCES = {
    "attractor": f"{{attractor: {{position: {X}, strength: '0.5 m^3/s^2*{FACTOR}', on: [gas, net]}}}}",
    "drag": f"{{drag: {{linear: '0.5 N*s/m*{FACTOR}', quadratic: '0.2 kg/m*{FACTOR}'}}}}",
    "electric": f"{{electric: {{charge: 0.3 C, field: '[1 V/m, 2 V/m, {X}.x*(3 V/m^2)]'}}}}",
    "electric formula": f'{{electric: {{charge: 0.3 C, formula: ["-y", "x*{X}.z", "1"]}}}}',
    "electrostatic": f"{{electrostatic: {{charge: 0.3 C, constant: '1 N*m^2/C^2*{FACTOR}'}}}}",
    "force": f'{{force: {{components: ["{V}.x*m", "sin({X}.y*t)", "x*y"]}}}}',
    "force potential": f'{{force: {{potential: "m*exp(-x^2)*y*{X}.y^2"}}}}',
    "gravity": f"{{gravity: {{strength: '9.81 m/s^2*{FACTOR}'}}}}",
    "magnetic": f"{{magnetic: {{charge: 2 C, field: '[1 T, 2 T, 3 T*{FACTOR}]'}}}}",
    "mutual_gravity": f"{{mutual_gravity: {{constant: '0.02 m^3/kg/s^2*{FACTOR}'}}}}",
    "spring": f"{{spring: {{from: net.bob.position, to: '{X} + [0 m, 1 m, 0 m]', stiffness: '9 N/m*{FACTOR}', "
    "rest: 0.2 m}}",
    "turbulence": f"{{turbulence: {{speed: '2 m/s*{FACTOR}', octaves: 2, lifetime: 1 s, linear: 0.5 N*s/m}}}}",
    "vortex": f"{{vortex: {{circulation: '2 m^2/s*{FACTOR}', updraft: 1 m/s, linear: 0.5 N*s/m}}}}",
    "wind": f"{{wind: {{velocity: '{V}*2', linear: 0.5 N*s/m, quadratic: 0.1 kg/m, gusts: 0.4, period: 0.2 s}}}}",
}
UNSLOPED = {"repulsion", "field_gradient", "emission", "torque", "impulse", "immersion"}
"""Forces whose own slopes are not known: differences of the whole rate are taken. (A blow has none.)"""
GRID = "size: 1 1 m, cell: 0.25 m"
MODELS = {
    "diffusion": f"diffusion: {{{GRID}, of: number, coefficient: '0.1*(1 + x*{X}.y)', initial: x, source: '{X}.x'}}",
    "diffusion drift": f"diffusion: {{{GRID}, of: number, coefficient: 0.1, initial: x*y, "
    f"drift: {{velocity: ['0.1', 0.2], strength: '{X}.x/(1 m)'}}}}",
    "equations": f"equations: {{start: {{a: 1, b: 2}}, rate: {{a: '-b*{X}.y^2', b: 'a + {V}.x'}}}}",
    "equations read": f"equations: {{start: {{a: 1}}, rate: {{a: '{X}.y'}}}}",
}
EXPRESSIONS = (
    "norm(net.bob.position)",
    "where(lead.a.position.x > 0 m, lead.a.position.y, 2 m)",
    "max(lead.a.position.x, net.bob.position.y)",
    "norm(mean(gas.positions))",
    "sqrt(lead.a.position.x^2 + (1 m)^2)*sin(3*net.bob.position.z/(1 m))",
    "(1 m)*exp(-(distance(lead.a.position, net.bob.position)/(0.4 m))^2)",
    "(1 m)*smoothstep(0, 2, lead.a.position.x/(1 m))",
)


def written(force: str = NONE, stiffness: str = "20 N/m", damping: str = "0 N*s/m", more: str = "") -> str:
    return SCENE.format(force=force, stiffness=stiffness, damping=damping, more=more)


def check_derivatives(folder: Path, script: str, h: float = 1e-4, good: float = 1e-6) -> None:
    """The Jacobian of every island is that of fourth-order differences of its rate."""
    path = folder / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    graph = load(path, pruned=False)
    for island in graph.islands:
        run = IslandRun(graph, island)
        march = March(run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
        pattern, system = march.system.pattern, march.system
        assert pattern is not None
        assert pattern.exact, system.unsloped
        y = system.y + 0.05 * np.random.default_rng(3).standard_normal(len(system.y))
        values = np.full(pattern.room, np.nan)
        jacobian(system)(march._engaged.functions, 0.3, y, values, march.floats.copy(), system.ints)
        found = np.zeros((len(y), len(y)))
        found[pattern.rows, pattern.columns] = values[: pattern.count]

        def slope(d: np.ndarray, march: March = march, y: np.ndarray = y) -> np.ndarray:
            near, far = (march.rate(0.3, y + k * d) - march.rate(0.3, y - k * d) for k in (h, 2 * h))
            return (8 * near - far) / (12 * h)

        expected = np.column_stack([slope(d) for d in np.eye(len(y))])
        assert not expected[:, pattern.tallies].any()  # which is why what they depend on may be left out
        expected[pattern.tallies] = 0.0
        work = [bodies.work_at for bodies in run.bodies.values() if bodies is not None]
        expected[work] = 0.0
        np.testing.assert_allclose(found, expected, rtol=good, atol=good)


def test_every_force_word_is_here():
    assert {name.split()[0] for name in FORCES} | UNSLOPED == set(Catalogue().words("forces"))


@pytest.mark.parametrize("name", FORCES)
def test_forces_have_slopes_through_values_that_read_the_state(tmp_path, name):
    # Noise in single precision has no slope over so short a way.
    h, good = (3e-3, 1e-3) if name.startswith("turbulence") else (1e-4, 1e-6)
    check_derivatives(tmp_path, written(FORCES[name]), h, good)


@pytest.mark.parametrize("name", MODELS)
def test_models_have_them_too(tmp_path, name):
    check_derivatives(tmp_path, written(more=f"other: {{{MODELS[name]}}}"))


def test_what_values_alone_read_has_derivatives_of_its_own(tmp_path):
    gravity = "{gravity: {strength: 9.81 m/s^2*(2 + other.a)}}"
    check_derivatives(tmp_path, written(gravity, more=f"other: {{{MODELS['equations read']}}}"))


def test_springs_have_them(tmp_path):
    check_derivatives(tmp_path, written(stiffness=f"'20 N/m*{FACTOR}'", damping=f"'0.3 N*s/m*{FACTOR}'"))


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_the_derivative_of_a_value_is_that_of_its_formula(tmp_path, expression):
    force = f"{{attractor: {{position: 1 0 0 m, strength: '1 m^2/s^2*({expression})'}}}}"
    check_derivatives(tmp_path, written(force))


def test_a_value_far_from_the_origin_has_slopes_as_exact_as_the_force(tmp_path):
    """A satellite and the planet that attracts it, moved together, feel no other force."""
    path = tmp_path / "scene.yaml"
    path.write_text("""
models:
  planet: {particles: {list: {a: {position: 1.5e11 0 0 m}}}}
  satellite: {particles: {list: {a: {position: 150007000000 0 0 m}}}}
forces: [{attractor: {position: planet.a.position, strength: 4e14 m^3/s^2, on: [satellite]}}]
solvers: {main: {bdf2: {step: 1 s}}}
""")
    graph = load(path, pruned=False)
    run = IslandRun(graph, graph.islands[0])
    march = March(run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
    pattern, system = march.system.pattern, march.system
    values = np.zeros(pattern.room)
    jacobian(system)(march._engaged.functions, 0.0, system.y, values, march.floats.copy(), system.ints)
    found = np.zeros((len(system.y),) * 2)
    found[pattern.rows, pattern.columns] = values[: pattern.count]
    own, planet = run.bodies["satellite"], run.bodies["planet"]
    assert own is not None
    assert planet is not None
    rows = found[own.velocity_at : own.velocity_at + 3]
    by_own, by_planet = (rows[:, at : at + 3] for at in (own.position_at, planet.position_at))
    assert np.abs(by_own).max() > 1e-7
    np.testing.assert_allclose(by_planet, -by_own, atol=1e-6 * np.abs(by_own).max())


END = 0.05
CLOTH = """
clock: {{end: {end} s}}
models:
  base: {{particles: {{list: {{a: {{mass: 1 kg, position: 0 1 0 m}}}}}}}}
  sheet:
    mass_spring: {{cloth: {{cells: 12 12, size: 0.6 0.6 m}}, mass: 0.01 kg, stiffness: {stiffness}, pins: [top]}}
forces: [gravity{pull}]
solvers: {{main: {{{solver}}}}}
"""
PULL = ", {{attractor: {{position: {place}, strength: 0.1 m^3/s^2{on}}}}}"
HEIGHT = "(1 m - 4.905 m/s^2*time^2)"


def scripts(linked: bool) -> dict[str, dict[str, str]]:
    """A cloth that a mass attracts, and one whose stiffness follows it; else both follow where it is known to fall."""
    place, height = ("base.a.position", "base.a.position.y") if linked else (f"'[0 m, {HEIGHT}, 0 m]'", HEIGHT)
    return {
        "attractor": {"stiffness": "100 N/m", "pull": PULL.format(place=place, on=", on: [sheet]")},
        "stiffness": {"stiffness": f"'100 N/m*(1 + {height}/(1 m))'", "pull": ""},
    }


def marched(folder: Path, solver: str, stiffness: str, pull: str) -> tuple[np.ndarray, March]:
    """The cloth's positions and velocities at the end."""
    path = folder / "scene.yaml"
    path.write_text(CLOTH.format(end=END, solver=solver, stiffness=stiffness, pull=pull))
    run = Run(load(path, pruned=False)).island_of["sheet"]
    y, _ = run.march.advance(END)
    bodies = run.bodies["sheet"]
    assert bodies is not None
    return y[bodies.position_at : bodies.work_at].copy(), run.march


@pytest.mark.parametrize("name", ["attractor", "stiffness"])
def test_implicit_solvers_keep_their_orders(tmp_path, name):
    script = scripts(linked=True)[name]
    exact, _ = marched(tmp_path, "dop853: {tolerance: 1e-13}", **script)
    for word, order in (("implicit_euler", 1), ("bdf2", 2)):
        errors = [
            np.abs(marched(tmp_path, f"{word}: {{step: {step} ms}}", **script)[0] - exact).max()
            for step in (0.25, 0.125, 0.0625)
        ]
        assert [math.log2(a / b) for a, b in pairwise(errors)] == pytest.approx([order, order], abs=0.05)
    found, _ = marched(tmp_path, "radau: {tolerance: 1e-8}", **script)
    assert np.abs(found - exact).max() < 1e-8


@pytest.mark.parametrize("name", ["attractor", "stiffness"])
@pytest.mark.parametrize("word", ["implicit_euler", "bdf2"])
def test_newton_needs_no_more_than_where_nothing_is_read(tmp_path, name, word):
    iterations = []
    for linked in (True, False):
        _, march = marched(tmp_path, f"{word}: {{step: 5 ms}}", **scripts(linked)[name])
        iterations.append(march.statistics.evaluations / march.statistics.steps)
    assert iterations[0] <= iterations[1] + 1


def test_what_pulls_a_mass_to_its_own_place_has_no_slope_there(tmp_path):
    pulls = [PULL.format(place="base.a.position", on=on) for on in (", on: [sheet]", "", ", softening: 1 mm")]
    iterations = []
    for pull in pulls:
        _, march = marched(tmp_path, "implicit_euler: {step: 5 ms}", stiffness="100 N/m", pull=pull)
        iterations.append(march.statistics.evaluations / march.statistics.steps)
    assert max(iterations) <= iterations[0] + 1


@pytest.mark.parametrize("word", ["implicit_euler", "bdf2"])
def test_contacts_are_solved_within_the_stages_of_such_islands(tmp_path, word):
    contact = (
        "\nobjects: {floor: {plane: {position: 0 1.99 0 m}}}\ncontacts: {hit: {collision: {between: [sheet, floor], "
    )
    iterations, ends = [], []
    for linked in (True, False):
        friction = "'0.3*base.a.position.y/(1 m)'" if linked else f"'0.3*{HEIGHT}/(1 m)'"
        script = scripts(linked)["attractor"]
        pull = f"{script['pull']}]{contact}mode: local, friction: {friction}}}}}}}\nlights: [studio"
        y, march = marched(tmp_path, f"{word}: {{step: 2 ms}}", script["stiffness"], pull)
        assert march.system.structure.local
        iterations.append(march.statistics.evaluations / march.statistics.steps)
        ends.append(y[1 : len(y) // 2 : 3].min())
    assert iterations[0] <= iterations[1] + 1
    assert ends[0] > 1.9949  # 1.9871 without the floor
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)


def test_explain_tells_the_stable_step_of_such_an_island(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(CLOTH.format(end=END, solver="bdf2: {step: 5 ms}", **scripts(linked=True)["stiffness"]))
    assert "any step is stable; rk4 would need steps of at most" in str(explain(load(path, pruned=False)))


@pytest.mark.parametrize(("cells", "warned"), [(13, False), (14, True)])
def test_check_warns_of_what_the_run_refuses(tmp_path, cells, warned):
    pull = PULL.format(place="mean(sheet.positions)", on=", on: [sheet]")
    path = tmp_path / "scene.yaml"
    script = CLOTH.format(end=END, solver="implicit_euler: {step: 5 ms}", stiffness="100 N/m", pull=pull)
    path.write_text(script.replace("12 12", f"{cells} {cells}"))
    graph = load(path, pruned=False)
    assert [one.code for one in graph.warnings] == ["no-slopes"] * warned
    if warned:
        with pytest.raises(LimitRefused, match="a value that reads 675 numbers of the state gives no slopes"):
            Run(graph).islands[-1].march.advance(0.005)
    else:
        Run(graph).islands[-1].march.advance(0.005)


def test_other_islands_know_nothing_of_it(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(written("{attractor: {position: '[sin(time/(1 s))*(1 m), 0 m, 0 m]'}}"))
    graph = load(path, pruned=False)
    for island in graph.islands:
        plain, with_jacobian = (IslandRun(graph, island).assembly.finish(jacobian=asked) for asked in (False, True))
        assert KERNEL not in (with_jacobian.structure.slopes or ())
        assert len(with_jacobian.floats) == len(plain.floats) + 3 * len(plain.y)
