"""Laws over every force word: energy, Newton's third law, exact motions, errors told in place."""

import math

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.compiler.catalogue import Catalogue
from sceneql.march.driver import jacobian
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.explain import explain
from sceneql.run.run import IslandRun, Run
from sceneql.words.solvers.rk4 import Rk4

SCENE = """
clock: {{end: 0.6 s}}
models:
  cloud:
    diffusion: {{size: 2 2 2 m, corner: -1 -1 -1 m, cell: 0.5 m, of: number, coefficient: 0.1, initial: x + x*y}}
  gas:
    particles:
      positions:
        - [0 m, 0 m, 0 m]
        - [0.2 m, 0.3 m, 0.1 m]
        - [0.1 m, -0.3 m, 0.4 m]
        - [0.3 m, 0.1 m, 0 m]
      velocity: 0.1 0.2 0.4 m/s
      mass: 2 kg
  net:
    mass_spring:
      masses: {{bob: {{position: 0.5 0.5 0.5 m, mass: 1 kg}}, wall: {{position: 0.6 0.4 0.1 m, fixed: yes}}}}
      springs: [{{between: [bob, wall], stiffness: 20 N/m}}]
forces:
  it: {force}
solvers: {{main: {{dopri5: {{tolerance: 1e-10}}}}}}
"""

FORCES = {
    "attractor": "{attractor: {position: 1 0 0 m, strength: 0.5 m^3/s^2}}",
    "drag": "{drag: {linear: 0.5 N*s/m, quadratic: 0.2 kg/m}}",
    "electric": "{electric: {charge: 0.3 C, field: 1 2 3 V/m}}",
    "electric potential": '{electric: {charge: 0.3 C, potential: "x^2 + y^2 - 2*z^2 + sin(x*y)"}}',
    "electric formula": '{electric: {charge: 0.3 C, formula: ["-y", "x*t", "1"]}}',
    "electrostatic": "{electrostatic: {charge: 0.3 C, constant: 1}}",
    "emission": "{emission: {into: cloud.concentration, rate: 3 m^3/s}}",
    "field_gradient": "{field_gradient: {of: cloud.concentration, factor: 2 J}}",
    "force": '{force: {components: ["-vx*abs(vx)*m", "sin(3*t)", "x*y"]}}',
    "force potential": '{force: {potential: "m*exp(-x^2)*y"}}',
    "gravity": "gravity",
    "magnetic": "{magnetic: {charge: 2 C, field: 1 2 3 T}}",
    "magnetic formula": '{magnetic: {charge: 2 C, formula: ["x", "y", "-2*z"]}}',
    "mutual_gravity": "{mutual_gravity: {constant: 0.02}}",
    "mutual_gravity tree": "{mutual_gravity: {constant: 0.02, method: tree, softening: 1 cm}}",
    "repulsion": "{repulsion: {strength: 5 N, range: 0.6 m, exponent: 3}}",
    "spring": "{spring: {from: net.bob.position, to: 0 1 0 m, damping: 1 N*s/m, rest: 0.2 m}}",
    "turbulence": "{turbulence: {speed: 2 m/s, octaves: 2, lifetime: 1 s, linear: 0.5 N*s/m}}",
    "vortex": "{vortex: {circulation: 2 m^2/s, updraft: 1 m/s, linear: 0.5 N*s/m}}",
    "wind": "{wind: {velocity: 1 0 0.5 m/s, linear: 0.5 N*s/m, quadratic: 0.1 kg/m, gusts: 0.4, period: 0.2 s}}",
}
each_force = pytest.mark.parametrize("name", FORCES)


def test_every_force_word_is_here():
    """Torques and blows on rigid bodies are in test_rigid.py, skins in flows in test_membranes.py."""
    assert {name.split()[0] for name in FORCES} | {"impulse", "torque", "immersion"} == set(Catalogue().words("forces"))


@each_force
def test_energy_is_conserved_once_the_work_is_counted(tmp_path, name):
    script = SCENE.format(force=FORCES[name])
    first, middle, last = watch(tmp_path, script, [0, 0.3, 0.6], "gas.energy", "net.energy")
    assert sum(middle) == pytest.approx(sum(first), abs=2e-8)
    assert sum(last) == pytest.approx(sum(first), abs=2e-8)


@pytest.mark.parametrize("name", [name for name in FORCES if name != "emission"])  # which moves no mass
def test_it_is_told_apart_from_no_force(tmp_path, name):
    acting, free = (
        watch(tmp_path, SCENE.format(force=force), [0.6], "gas.velocities", "net.bob.velocity")[0]
        for force in (FORCES[name], "{drag: {linear: 0 N*s/m}}")
    )
    assert max(np.abs(a - b).max() for a, b in zip(acting, free, strict=True)) > 1e-3


@pytest.mark.parametrize("name", ["mutual_gravity", "electrostatic", "repulsion"])
def test_forces_between_masses_keep_the_momentum_of_all(tmp_path, name):
    script = SCENE.format(force=FORCES[name]).replace("stiffness: 20 N/m", "stiffness: 1e-30 N/m")
    first, last = watch(tmp_path, script.replace(", fixed: yes", ""), [0, 0.6], "gas.momentum", "net.momentum")
    np.testing.assert_allclose(sum(last), sum(first), rtol=0, atol=1e-13)


def test_two_masses_run_round_their_center_by_kepler(tmp_path):
    # Total mass 4, distance 2, G = 1: omega^2 = G M / d^3 = 1/2, the light one three times as far out.
    omega = math.sqrt(0.5)
    script = f"""
clock: {{end: {2 * math.pi / omega} s}}
models:
  heavy: {{particles: {{list: {{a: {{mass: 3 kg, position: 0.5 0 0 m, velocity: [0, {0.5 * omega}, 0]}}}}}}}}
  light: {{particles: {{list: {{b: {{mass: 1 kg, position: -1.5 0 0 m, velocity: [0, {-1.5 * omega}, 0]}}}}}}}}
forces: {{pull: {{mutual_gravity: {{constant: 1}}}}}}
solvers: {{main: {{dopri5: {{tolerance: 1e-12}}}}}}
"""
    ((a, b, u, v),) = watch(
        tmp_path,
        script,
        [math.pi / omega],
        "heavy.a.position",
        "light.b.position",
        "heavy.potential",
        "light.potential",
    )
    np.testing.assert_allclose(a, [-0.5, 0, 0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(b, [1.5, 0, 0], rtol=0, atol=1e-9)
    assert u == pytest.approx(-0.75)
    assert v == pytest.approx(-0.75)


def test_charges_of_several_models_stand_in_one_list_in_the_order_of_the_models(tmp_path):
    # Places (0, 0), (1, 0), (0, 1); charges 1, -2, 1.5; masses 1, 2, 3; k = 0.1, by Coulomb's law.
    script = """
clock: {end: 1 s}
models:
  a: {particles: {list: {p: {mass: 1 kg}, q: {mass: 2 kg, position: 1 0 0 m}}}}
  b: {particles: {list: {r: {mass: 3 kg, position: 0 1 0 m}}}}
forces: [{electrostatic: {ON: charge: [CHARGES], constant: 0.1 N*m^2/C^2}}]
"""
    for on, charges in (("[a, b]", "1 C, -2 C, 1.5 C"), ("[b, a]", "1.5 C, 1 C, -2 C")):
        text = script.replace("ON:", f"on: {on},").replace("CHARGES", charges)
        ((of_a, of_b),) = watch(tmp_path, text, [0], "a.accelerations", "b.accelerations")
        side = 0.1 * 2 * 1.5 / 2**1.5
        np.testing.assert_allclose(of_a, [[0.2, -0.15, 0], [-0.2 / 2 - side / 2, side / 2, 0]], rtol=0, atol=1e-15)
        np.testing.assert_allclose(of_b, [[side / 3, 0.15 / 3 - side / 3, 0]], rtol=0, atol=1e-15)


def test_a_charge_runs_round_in_a_magnetic_field_and_drifts_across_an_electric_one(tmp_path):
    script = """
clock: {end: 2 s}
models: {ion: {particles: {list: {a: {mass: 2 kg, velocity: 3 0 0 m/s}}}}}
forces:
  b: {magnetic: {charge: 4 C, field: 0 0 1.5 T}}
  e: {electric: {charge: 4 C, field: 0 6 0 V/m}}
solvers: {main: {dopri5: {tolerance: 1e-12}}}
"""
    ((v, x),) = watch(tmp_path, script, [2], "ion.a.velocity", "ion.a.position")
    # In the frame of the drift E x B / B^2 = (4, 0, 0) the velocity (-1, 0, 0) turns by -q B t / m = -6.
    np.testing.assert_allclose(v, [4 - math.cos(6), math.sin(6), 0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(x, [8 - math.sin(6) / 3, (1 - math.cos(6)) / 3, 0], rtol=0, atol=1e-9)


def test_formulas_are_the_fields_that_they_say(tmp_path):
    def end(forces: str) -> np.ndarray:
        script = SCENE.format(force=f"{{drag: {{linear: 0 N*s/m}}}}\n{forces}")
        return watch(tmp_path, script, [0.6], "gas.positions")[0][0]

    uniform = end("  b: {magnetic: {charge: 2 C, field: 1 2 3 T}}\n  e: {electric: {charge: 2 C, field: 0 1 5 V/m}}")
    formulas = end(
        '  b: {magnetic: {charge: 2 C, formula: ["1", "2", "3"]}}\n'
        '  e: {electric: {charge: 2 C, potential: "-y - 5*z"}}'
    )
    np.testing.assert_allclose(formulas, uniform, rtol=0, atol=1e-9)
    weight = end('  g: {force: {potential: "9.81*m*y"}}')
    np.testing.assert_allclose(weight, end("  g: gravity"), rtol=0, atol=1e-9)


def test_charges_may_be_given_one_by_one(tmp_path):
    script = """
clock: {end: 1 s}
models: {ions: {particles: {positions: [[0 m, 0 m, 0 m], [1 m, 0 m, 0 m]], mass: 1 kg}}}
forces: {e: {electric: {charge: [1 C, -2 C], field: 0 1 0 V/m}}}
solvers: {main: {rk4: {step: 0.1 s}}}
"""
    ((v,),) = watch(tmp_path, script, [1], "ions.velocities")
    np.testing.assert_allclose(v, [[0, 1, 0], [0, -2, 0]], atol=1e-12)


def test_air_takes_masses_along(tmp_path):
    def final(force: str) -> np.ndarray:
        script = f"""
clock: {{end: 20 s}}
models: {{dust: {{particles: {{list: {{a: {{position: 1 0 0 m, mass: 1 g}}}}}}}}}}
forces: {{air: {force}}}
solvers: {{main: {{dopri5: {{tolerance: 1e-8}}}}}}
"""
        return watch(tmp_path, script, [20], "dust.a.velocity")[0][0]

    np.testing.assert_allclose(final("{wind: {velocity: 3 1 0 m/s, linear: 0.1 N*s/m}}"), [3, 1, 0], atol=1e-6)
    still = final("{turbulence: {speed: 0 m/s, velocity: 0 2 0 m/s, linear: 0.1 N*s/m}}")
    np.testing.assert_allclose(still, [0, 2, 0], atol=1e-6)
    up = final("{vortex: {position: 1 0 0 m, updraft: 2 m/s, linear: 0.1 N*s/m}}")
    np.testing.assert_allclose(up, [0, 2, 0], atol=1e-6)


def test_a_spring_ties_models_and_swings_by_the_reduced_mass(tmp_path):
    script = """
clock: {end: 1 s}
models:
  one: {particles: {list: {a: {mass: 2 kg}}}}
  two: {particles: {list: {b: {mass: 6 kg, position: 1.2 0 0 m}}}}
forces: {tie: {spring: {from: one.a.position, to: two.b.position, stiffness: 54 N/m, rest: 1 m}}}
solvers: {main: {dopri5: {tolerance: 1e-12}}}
"""
    ((a, b, u, v),) = watch(tmp_path, script, [1], "one.a.position", "two.b.position", "one.energy", "two.energy")
    # Reduced mass 1.5 kg: omega = 6/s.
    assert b[0] - a[0] == pytest.approx(1 + 0.2 * math.cos(6), abs=1e-9)
    assert u + v == pytest.approx(0.5 * 54 * 0.04, abs=1e-9)


def test_gusts_and_eddies_do_not_depend_on_where_the_film_looks(tmp_path):
    script = SCENE.format(force=FORCES["wind"]) + "  \n"
    script = script.replace("forces:", f"forces:\n  t: {FORCES['turbulence']}")
    once = watch(tmp_path, script, [0.6], "gas.positions")[0][0]
    often = watch(tmp_path, script, [0.1, 0.2, 0.21, 0.5, 0.6], "gas.positions")[-1][0]
    np.testing.assert_array_equal(once, often)
    other = watch(tmp_path, script.replace("gusts: 0.4", "gusts: 0.4, seed: 3"), [0.6], "gas.positions")[0][0]
    assert np.abs(other - once).max() > 1e-6


WRONG = {
    "{electric: {charge: 1 C}}": "said in one way",
    "{electric: {charge: 1 C, field: 1 0 0 V/m, potential: x}}": "said in one way",
    "{electric: {field: 1 0 0 V/m}}": "needs 'charge'",
    "{electric: {charge: 1 kg, field: 1 0 0 V/m}}": "charge",
    '{electric: {charge: 1 C, formula: ["x", "y"]}}': "3 formulas are needed",
    '{electric: {charge: 1 C, formula: ["x", "y", "w"]}}': "nothing is called 'w'",
    "{magnetic: {charge: 1 C}}": "said in one way",
    "{force: {}}": "said in one way",
    '{force: {components: ["vx", "u", "1"]}}': "nothing is called 'u'",
    "{wind: {velocity: 1 0 0 m/s}}": "needs a coefficient",
    "{repulsion: {range: 0 m}}": "above 0",
    "{spring: {from: 0 0 0 m, to: 0 1 0 m}}": "a mass at one of its ends",
    "{turbulence: {size: 0 m}}": "above 0",
    "{mutual_gravity: {softening: -1 m}}": "at least 0",
    "{mutual_gravity: {opening: 2}}": "at most 1",
    "{vortex: {axis: 0 0 0}}": "axis",
}


@pytest.mark.parametrize("entry", WRONG)
def test_a_wrong_force_is_told_with_its_place(tmp_path, entry):
    said = complaint(tmp_path, f"models: {{a: {{particles: {{list: {{b: {{}}}}}}}}}}\nforces:\n  bad: {entry}\n")
    assert WRONG[entry] in said
    assert "scene.yaml:3:" in said


NOT_STARTED = {
    "{mutual_gravity: {}}": "start at one place",
    "{electrostatic: {charge: 1 C}}": "start at one place",
    "{electric: {charge: [1 C, 2 C, 3 C], field: 1 0 0 V/m}}": "3 charges are given for 2 masses",
    "{spring: {from: a.b.position, to: a.b.position}}": "from a mass to itself",
    "{spring: {from: a.center, to: 0 1 0 m}}": "a mass at one of its ends",
}


@pytest.mark.parametrize("entry", NOT_STARTED)
def test_what_has_no_force_at_the_start_is_told_before_it(tmp_path, entry):
    path = tmp_path / "scene.yaml"
    path.write_text(
        f"models: {{a: {{particles: {{list: {{b: {{}}, c: {{}}}}}}}}}}\nforces:\n  bad: {entry}\n", encoding="utf-8"
    )
    with pytest.raises(ScriptError) as told:
        Run(load(path))
    assert NOT_STARTED[entry] in str(told.value)
    assert "scene.yaml:3:" in str(told.value)


def test_softened_masses_may_start_at_one_place(tmp_path):
    script = """
clock: {end: 1 s}
models: {a: {particles: {list: {b: {}, c: {}}}}}
forces: {pull: {mutual_gravity: {constant: 1, softening: 1 cm}}}
solvers: {main: {rk4: {step: 0.1 s}}}
"""
    ((x,),) = watch(tmp_path, script, [1], "a.positions")
    np.testing.assert_array_equal(x, 0)


def slopes_known(name: str) -> bool:
    """Whether a force gives its derivatives; of trees, of repulsion and of fields differences are taken."""
    unknown = ("mutual_gravity tree", "repulsion", "field_gradient", "emission")
    return not name.startswith(unknown)


@pytest.mark.parametrize("name", [*filter(slopes_known, FORCES)])
def test_the_derivatives_are_those_of_the_rate(tmp_path, name):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.format(force=FORCES[name]).replace("wall: {", "wall: {mass: 3 kg, "), encoding="utf-8")
    graph = load(path, pruned=False)
    for island in graph.islands:
        run = IslandRun(graph, island)
        march = March(run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
        pattern, system = march.system.pattern, march.system
        assert pattern.exact
        y = system.y + 0.1 * np.random.default_rng(3).standard_normal(len(system.y))
        values = np.full(pattern.room, np.nan)
        jacobian(system)(march._engaged.functions, 0.3, y, values, march.floats.copy(), system.ints)
        found = np.zeros((len(y), len(y)))
        rows = pattern.rows
        found[rows, pattern.columns] = values[: len(rows)]
        # Noise in single precision has no slope over so short a way.
        h, good = (3e-3, 1e-3) if name.startswith("turbulence") else (1e-5, 1e-6)
        expected = np.column_stack(
            [(march.rate(0.3, y + h * d) - march.rate(0.3, y - h * d)) / (2 * h) for d in np.eye(len(y))]
        )
        expected[[bodies.work_at for bodies in run.bodies.values() if bodies is not None]] = 0.0
        np.testing.assert_allclose(found, expected, rtol=good, atol=good)


def test_what_is_not_yet_born_does_nothing(tmp_path):
    def momenta(force: str) -> list:
        script = f"""
clock: {{end: 0.4 s}}
models:
  one: {{particles: {{list: {{a: {{position: 0.1 0 0 m}}}}}}}}
  later: {{particles: {{emit: {{rate: 1 Hz, from: 0 0 0 m, start: 0.5 s, velocity: 1 0 0 m/s}}}}}}
forces: {{it: {force}}}
solvers: {{main: {{rk4: {{step: 10 ms}}}}}}
"""
        return watch(tmp_path, script, [0.4], "one.momentum")[0]

    for force in (FORCES["mutual_gravity"], FORCES["electrostatic"], FORCES["repulsion"]):
        np.testing.assert_array_equal(momenta(force)[0], 0)


def test_explain_tells_the_error_of_a_tree(tmp_path):
    path = tmp_path / "scene.yaml"
    galaxy = "{stars: 300, constant: 1, softening: 1 cm, thickness: 5 cm}"
    pull = "{constant: 1, softening: 1 cm, method: tree, opening: %s}"
    told = []
    for opening in ("0.1", "0.8"):
        path.write_text(
            f"clock: {{end: 1 s}}\nmodels: {{disk: {{galaxy: {galaxy}}}}}\n"
            f"forces: {{pull: {{mutual_gravity: {pull % opening}}}}}\nsolvers: {{main: {{rk4: {{step: 10 ms}}}}}}\n"
        )
        (island,) = explain(load(path, pruned=False))["islands"]
        told.append(float(island["force_remarks"]["pull"].partition("off by ")[2].partition(" ")[0]))
    # Of the pull of a heavy center next to light stars little is left to err about.
    assert 0 < told[0] < 1e-5
    assert told[0] < 0.3 * told[1] < 1e-2


def test_a_galaxy_turns_as_it_is_told(tmp_path):
    script = """
clock: {end: 1 s}
models:
  disk:
    galaxy: {stars: 500, constant: 1, heart: 2 kg, disk: 0.2 kg, axis: 0 0 2, position: 1 2 3 m, velocity: 4 0 0 m/s}
forces: {pull: {mutual_gravity: {constant: 1, softening: 5 cm}}}
solvers: {main: {rk4: {step: 5 ms}}}
"""
    first, last = watch(
        tmp_path, script, [0, 1], "disk.momentum", "disk.core", "disk.angular_momentum", "disk.positions", "disk.energy"
    )
    np.testing.assert_allclose(first[0], [8.8, 0, 0], atol=1e-12)
    np.testing.assert_allclose(last[0], [8.8, 0, 0], atol=1e-12)
    np.testing.assert_allclose(first[1], [1, 2, 3])
    spin = first[2] - np.cross(first[3].mean(axis=0), first[0])
    assert spin[2] > 10 * np.abs(spin[:2]).max()
    r = np.linalg.norm((first[3] - [1, 2, 3])[1:, :2], axis=1)
    assert r.max() <= 1
    # Half of the stars of an exponential disk of scale 1/3 cut at 1 stand within 0.4592.
    assert np.median(r) == pytest.approx(0.4592, abs=0.04)
    late = np.linalg.norm((last[3] - last[1])[1:, :2], axis=1)
    assert np.median(late / r) == pytest.approx(1, abs=0.1)
    assert last[4] == pytest.approx(first[4], rel=1e-3)


def test_a_force_on_named_models_ties_them_only_where_it_reads_one(tmp_path):
    """Each of two models that fall keeps its own solver; one that is pushed as the other goes is solved with it."""
    scene = """\
models:
  one: {particles: {list: {a: {mass: 1 kg}}}}
  other: {particles: {list: {b: {position: 1 0 0 m}}}}
forces:
  weight: {gravity: {on: [one, other], strength: STRENGTH}}
solvers: {near: {rk4: {on: [one], step: 1 ms}}, far: {verlet: {on: [other], step: 2 ms}}}
outputs: {data: {record: {of: [one.a.position, other.b.position]}}}
"""
    path = tmp_path / "scene.yaml"
    path.write_text(scene.replace("STRENGTH", "9.81 m/s^2"))
    assert [island.models for island in load(path).islands] == [("one",), ("other",)]
    path.write_text(scene.replace("STRENGTH", "9.81 m/s^2 + norm(one.a.position)*1 Hz^2"))
    with pytest.raises(ScriptError, match="both march one, other"):
        load(path)
