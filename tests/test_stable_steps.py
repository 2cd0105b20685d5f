"""Bounds on steps by any force and any model: by the script alone, and by the spectrum."""

import math
import re

import numpy as np
import pytest

from sceneql.compiler.passes import stable_steps
from sceneql.failure import RunFailure
from sceneql.kinds.stable_step import stable_step
from sceneql.march.spectrum import dominant, spectrum
from sceneql.march.stability import stability
from sceneql.report.explain import explain, text
from sceneql.run.run import Run
from steps import loaded, warnings

TAIL = "solvers: {main: {rk4: {step: 1 s}}}\nclock: {end: 1 s}\noutputs: {data: {record: {of: [net.energy]}}}\n"
PAIR = """\
clock: {end: 1 s}
models:
  p: {particles: {list: {a: {position: 1 0 0 m, velocity: 0 1 0 m/s}, b: {position: -1 0.1 0 m, mass: 3 kg}}}}
outputs: {table: {record: {of: [p.positions]}}}
"""
STRONG = {
    "attractor: {strength: 1e6 m^3/s^2}": "verlet",
    "attractor: {strength: 1e6 m^3/s^2, exponent: -1}": "rk4",
    "drag: {linear: 2e4 N*s/m}": "rk4",
    "drag: {quadratic: 2e4 kg/m}": "rk4",
    "wind: {velocity: 3 0 4 m/s, linear: 1e4 N*s/m, quadratic: 1e3 kg/m}": "rk4",
    "vortex: {linear: 1e4 N*s/m}": "rk4",
    "turbulence: {linear: 1e5 N*s/m}": "rk4",
    "electric: {charge: 1 C, potential: 1e8*(x^2 + y^2 - 2*z^2)}": "verlet",
    "electric: {charge: 1 C, formula: '[-1e8*x, -1e8*y, 0]'}": "rk4",
    "magnetic: {charge: 1 C, field: 0 0 1e4 T}": "rk4",
    "magnetic: {charge: 1 C, formula: '[0, 0, 1e4 + x]'}": "rk4",
    "electrostatic: {charge: 1 C}": "verlet",
    "mutual_gravity: {constant: 1e8 m^3/kg/s^2}": "verlet",
    "repulsion: {strength: 1e8 N, range: 3 m}": "rk4",
    "spring: {from: p.a.position, to: p.b.position, stiffness: 1e8 N/m}": "rk4",
    "spring: {from: p.a.position, to: 0 0 0 m, stiffness: 100 N/m, damping: 1e5 N*s/m}": "rk4",
    "force: {components: '[-1e8*x - 1e5*vx, -1e8*y - 1e5*vy, -1e8*z]'}": "rk4",
    "force: {potential: 0.5e8*(x^2 + y^2 + z^2)}": "rk4",
}
"""Forces that bound a step, with a method of which they do so by a mode that the check sees whole."""


@pytest.mark.parametrize(("force", "word"), STRONG.items())
def test_every_force_is_bounded_by_the_script_alone_as_by_the_spectrum(tmp_path, force, word):
    """Two masses: what is told before anything is built is the bound of the assembled Jacobian."""
    graph = loaded(tmp_path, PAIR + f"forces: {{f: {{{force}}}}}\nsolvers: {{main: {{{word}: {{step: 0.1 s}}}}}}\n")
    (island,) = Run(graph).islands
    bound = stability(island.march, island.solver).step
    told = re.fullmatch(r"dt = 0.1 s exceeds (\S+) (ms|us), set by force 'f' \(scene.yaml:5\)", warnings(graph)[0])
    assert float(told[1]) * {"ms": 1e-3, "us": 1e-6}[told[2]] == pytest.approx(bound, rel=0.02)


@pytest.mark.parametrize(
    "force",
    [
        "force: {components: '[exp(700*x), 0, 0]'}",
        "attractor: {exponent: -10, position: 1e200 0 0 m}",
        "attractor: {exponent: 10, position: 1.00000000000001 0 0 m}",
        "force: {components: '[1/(x - 1), 0, 0]'}",
    ],
)
def test_forces_beyond_all_numbers_are_left_to_the_run(tmp_path, force):
    graph = loaded(tmp_path, PAIR + f"forces: [{{{force}}}]\nsolvers: {{main: {{rk4: {{step: 0.1 s}}}}}}\n")
    assert not [found for found in graph.warnings if not re.search(r"exceeds \S+ (s|ms|us|ns), set by", found.message)]


def test_equations_are_bounded_by_the_script_alone(tmp_path):
    """Van der Pol's, whose fast mode at the start is -3e6; a system of second order; one that turns."""
    script = "clock: {end: 1 s}\nmodels: {e: {equations: {start: {y: 2, z: 0}, rate: RATE}}}\n"
    script += "outputs: {table: {record: {of: [e.y]}}}\nsolvers: {main: {rk4: {step: 1 ms}}}\n"
    stiff = script.replace("RATE", '{y: z, z: "((1-y^2)*z-y)/1e-6"}')
    assert warnings(loaded(tmp_path, stiff)) == ["dt = 1 ms exceeds 0.928 us, set by 'e' (scene.yaml:2)"]
    swing = script.replace("{y: 2, z: 0}", "{y: 2, y': 0}").replace("RATE", "{y'': -1e8*y}").replace("rk4", "verlet")
    assert warnings(loaded(tmp_path, swing)) == ["dt = 1 ms exceeds 0.2 ms, set by 'e' (scene.yaml:2)"]
    turning = script.replace("RATE", "{y: z, z: -1e4*y}").replace("rk4", "semi_implicit_euler")
    assert "stable at no step" in warnings(loaded(tmp_path, turning))[0]
    assert warnings(loaded(tmp_path, script.replace("RATE", "{y: z, z: -y}"))) == []


ALONE = """\
clock: {end: 1 s}
models: {e: {equations: {start: {y: 0, v: 0}, rate: {y: v, v: "-4*y - 0.2*u"}, where: {u: "JUMP"}}}}
outputs: {table: {record: {of: [e.y]}}}
"""
AT_REST = PAIR.replace("velocity: 0 1 0 m/s, ", "").replace(", velocity: 0 1 0 m/s", "")
ALONG_X = AT_REST + "forces: {f: {force: {components: ['-4*x - 0.2*JUMP', '0', '0']}}}\n"
STEP = "solvers: {main: {euler: {step: 5 ms}}}\n"


@pytest.mark.parametrize("jump", ["sign(v)", "floor(v + 1)", "ceil(1e3*v)", "where(v > 0, 1, -1)", "mod(v, 1)"])
def test_a_jump_at_the_start_is_no_slope(tmp_path, jump):
    """Friction of Coulomb and its like at rest: what is left is a swing of 2/s."""
    classic = STEP.replace("euler", "rk4")
    assert warnings(loaded(tmp_path, ALONE.replace("JUMP", jump) + classic)) == []
    assert warnings(loaded(tmp_path, ALONG_X.replace("JUMP", jump.replace("v", "vx")) + classic)) == []


def test_a_steep_slope_at_the_start_is_no_jump(tmp_path):
    """Smoothed friction that rises within a ten-millionth of the unit of speed decays at 0.2e7/s there."""
    assert warnings(loaded(tmp_path, ALONE.replace("JUMP", "tanh(1e7*v)") + STEP)) == [
        "dt = 5 ms exceeds 1 us, set by 'e' (scene.yaml:2)"
    ]
    force = ALONG_X.replace("JUMP", "tanh(1e7*vx)").replace("-4*x", "0")
    assert warnings(loaded(tmp_path, force + STEP)) == ["dt = 5 ms exceeds 1 us, set by force 'f' (scene.yaml:5)"]


def test_masses_that_swing_alike_are_looked_at_once(tmp_path, monkeypatch):
    """Two hundred masses, each with a frequency and a decay of its own, are two searches of stable steps, not 400."""
    searched = []
    monkeypatch.setattr(stable_steps, "stable_step", lambda growth: searched.append(growth) or stable_step(growth))
    bodies = ", ".join(f"b{k}: {{position: {k + 1} 0 0 m, velocity: {k + 1} 0 0 m/s}}" for k in range(200))
    script = f"clock: {{end: 1 s}}\nmodels: {{p: {{particles: {{list: {{{bodies}}}}}}}}}\n"
    script += "forces: [{force: {components: ['-x^2 - vx^2', 0, 0]}}]\nsolvers: {main: {rk4: {step: 1 ms}}}\n"
    assert warnings(loaded(tmp_path, script + "outputs: {table: {record: {of: [p.positions]}}}\n")) == []
    assert len(searched) == 2


@pytest.mark.parametrize(
    "shape",
    [
        "of: shape, spacing: 0.5 m, element: p1",
        "of: shape",
        "block: {size: 1 0.2 0.2 m}, element: p1, retardation: 1 ms",
    ],
)
def test_the_bound_of_elements_is_told_by_law_and_size_alone(tmp_path, shape):
    """It is never below what is stable, so that no step is blamed that holds."""
    law = "law: {neo_hookean: {modulus: 10 MPa, poisson: 0.3}}"
    script = f"objects: {{shape: {{sphere: {{radius: 0.5 m}}}}}}\nmodels: {{net: {{elastic: {{{shape}, {law}}}}}}}\n"
    graph = loaded(tmp_path, script + TAIL)
    (island,) = Run(graph).islands
    told = re.search(r"exceeds (\S+) (ms|us), set by the elements of 'net'", warnings(graph)[0])
    sharp = stability(island.march, island.solver).step
    assert sharp < float(told[1]) * {"ms": 1e-3, "us": 1e-6}[told[2]] < 2.2 * sharp


@pytest.mark.parametrize("shape", ["{cells: 12 9, size: 1.2 0.8 m, stretch: 4e5 N/m, damping: 0.1}", "{bend: 300 N/m}"])
def test_the_bound_of_a_cloth_is_told_by_the_script_alone(tmp_path, shape):
    script = f"models: {{net: {{cloth: {shape}}}}}\n" + TAIL
    graph = loaded(tmp_path, script)
    (island,) = Run(graph).islands
    told = re.search(r"exceeds (\S+) (ms|us), set by the springs of 'net'", warnings(graph)[0])
    sharp = stability(island.march, island.solver).step
    assert 0.75 * sharp < float(told[1]) * {"ms": 1e-3, "us": 1e-6}[told[2]] < 1.001 * sharp


BODY = """\
clock: {end: 1 s}
models: {p: {particles: {list: {a: {position: 1 0 0 m, velocity: 0 1 0 m/s, mass: 2 kg}}}}}
outputs: {table: {record: {of: [p.velocities]}}}
"""
SPLIT = ["semi_implicit_euler", "verlet", "blanes_moan", "boris"]
"""Methods that advance positions by velocities."""


def bound_of(tmp_path, script, word):
    graph = loaded(tmp_path, script + f"solvers: {{main: {{{word}: {{step: 1 ms}}}}}}\n")
    (island,) = Run(graph).islands
    return stability(island.march, island.solver).step


def test_charges_that_run_round_are_no_oscillations_of_a_place(tmp_path):
    """Only Boris' method turns velocities exactly; the others take them along explicitly, which grows at any step."""
    turning = BODY + "forces: [{magnetic: {charge: 2 C, field: 0 0 100 T}}]\n"
    assert [bound_of(tmp_path, turning, word) for word in SPLIT] == [0.0, 0.0, 0.0, math.inf]
    slow = turning + "solvers: {main: {verlet: {step: 15 ms}}}\n"
    with pytest.raises(RunFailure, match="unstable"):
        list(Run(loaded(tmp_path, slow)).moments([1.0]))


def test_states_that_turn_without_velocities_do_so_explicitly(tmp_path):
    round_ = "models: {e: {equations: {start: {y: 1, z: 0}, rate: {y: z, z: -1e4*y}}}}\nclock: {end: 1 s}\n"
    round_ += "outputs: {table: {record: {of: [e.y]}}}\n"
    assert [bound_of(tmp_path, round_, word) for word in SPLIT] == [0.0, 0.0, 0.0, 0.0]
    second = round_.replace("{y: 1, z: 0}", "{y: 1, y': 0}").replace("{y: z, z: -1e4*y}", "{y'': -1e4*y}")
    assert bound_of(tmp_path, second, "verlet") == pytest.approx(0.02, rel=1e-3)


def test_what_grows_by_itself_bounds_no_step_and_hides_no_bound(tmp_path):
    """The saddle of a quadrupole: swings across, grows along."""
    saddle = BODY + "forces: [{force: {potential: 1e6*(x^2 + y^2 - 2*z^2)}}]\n"
    bounds = [bound_of(tmp_path, saddle, word) * 1e3 for word in SPLIT]
    assert bounds == pytest.approx([2.0, 2.0, bounds[2], 2.0], rel=1e-3)
    assert bounds[2] == pytest.approx(bound_of(tmp_path, saddle.replace("- 2*z^2", "+ z^2"), "blanes_moan") * 1e3)


@pytest.mark.parametrize("force", ["vortex: {circulation: 3 m^2/s,", "turbulence: {", "wind: {velocity: 1 0 0 m/s,"])
def test_air_that_carries_away_is_bounded_by_its_drag(tmp_path, force):
    blown = BODY + f"forces: [{{{force} linear: 2e4 N*s/m}}}}]\n"
    bounds = [bound_of(tmp_path, blown, word) * 1e3 for word in ("euler", "semi_implicit_euler", "boris", "verlet")]
    assert bounds == pytest.approx([0.2, 0.2, 0.2, 0.1], rel=2e-3)


def test_the_bound_of_a_large_cloth_is_as_sharp_as_that_of_a_small_one(tmp_path):
    """The same cloth: its fastest waves are as long as its cells, and k/m goes with the square of their number."""
    script = "clock: {end: 1 s}\nforces: [gravity]\nmodels: {c: {cloth: {cells: N N, pins: [top]}}}\n"
    script += "outputs: {table: {record: {of: [c.energy]}}}\n"
    small, large = (bound_of(tmp_path, script.replace("N", str(n)), "semi_implicit_euler") * n for n in (40, 62))
    assert large == pytest.approx(small, rel=2e-3)


@pytest.mark.parametrize(
    ("solver", "measure"),
    [
        ("radau: {}", "1e-06 of how large entries have been"),
        ("rodas5p: {absolute: 1e-9}", "1e-06 of an entry plus 1e-09 in SI units"),
        ("dopri5: {tolerance: 1e-4}", "0.0001 of an entry plus 0.0001 in SI units"),
        ("gauss_radau15: {}", "1e-09;"),
    ],
)
def test_explain_says_what_a_tolerance_is_a_part_of(tmp_path, solver, measure):
    script = PAIR + f"forces: [{{spring: {{from: p.a.position, to: p.b.position}}}}]\nsolvers: {{main: {{{solver}}}}}\n"
    assert f"steps by the tolerance {measure}" in text(explain(loaded(tmp_path, script)))


@pytest.mark.parametrize("seed", range(20))
def test_two_masses_on_an_oblique_spring_swing_at_its_frequency(seed):
    """In 13 entries, the last of them at rest: a Krylov space in which most directions have no rate."""
    rng = np.random.default_rng(seed)
    masses, stiffness, places = 10.0 ** rng.uniform(-2, 1, 2), 10.0 ** rng.uniform(0, 8), rng.normal(size=6)
    length = 0.9 * np.linalg.norm(places[:3] - places[3:])

    def rate(t, y):
        apart = y[3:6] - y[:3]
        pull = stiffness * (1.0 - length / np.linalg.norm(apart)) * apart
        return np.concatenate([y[6:12], pull / masses[0], -pull / masses[1], [0.0]])

    partner = np.array([*range(6, 12), *[-1] * 7])
    found = dominant(spectrum(rate, partner, 0.0, np.concatenate([places, np.zeros(7)])))
    assert found.imag == pytest.approx(math.sqrt(stiffness * np.sum(1.0 / masses)), rel=1e-3)
    assert abs(found.real) < 1e-3 * found.imag


def test_numbers_beyond_all_doubles_leave_a_check_whole(tmp_path):
    stream = (
        "models: {water: {flow: {size: 2 1 m, cell: 0.1 m, density: 1 kg/m^3, viscosity: 1e-3 Pa*s, "
        "boundary: {left: {inflow: {velocity: '[1e300*y, 0]'}}, right: {outflow: {}}}}}}\n"
        "solvers: {main: {sbdf2: {step: 1 ms}}}\n"
    )
    outputs = "clock: {end: 1 s}\noutputs: {data: {record: {of: [water.kinetic_energy]}}}\n"
    assert ["stable at no step" in one for one in warnings(loaded(tmp_path, stream + outputs))] == [True]
    cells = "models: {m: {diffusion: {size: 1 1 m, cell: 1e308 m, coefficient: 1 m^2/s, initial: x}}}\n"
    cells += "solvers: {main: {rk4: {step: 1 ms}}}\n"
    assert warnings(loaded(tmp_path, cells + outputs.replace("water.kinetic_energy", "m.mass"))) == []


DEEP = """\
clock: {{end: 1 s}}
models: {{m: {{{model}: {{{where}, cell: 0.1 m, {fields}}}}}}}
objects: {{ball: {{sphere: {{radius: 0.52 m}}}}}}
solvers: {{main: {{{solver}: {{step: {step} s}}}}}}
outputs: {{data: {{record: {{of: [m.{output}]}}}}}}
"""
INSIDE = {
    "wave": ("speed: 1 m/s, initial: exp(-x^2/0.02)", "verlet", "0.065", "max", 2.0 / (2.0 * math.sqrt(3) / 0.1)),
    "diffusion": ("coefficient: 1 m^2/s, initial: exp(-x^2/0.02)", "euler", "2e-3", "max", 2.0 / (12.0 / 0.1**2)),
    "flow": (
        "density: 1 kg/m^3, viscosity: 1 Pa*s, initial: {velocity: '[-y, x, 0]'}", "euler", "2e-3",
        "largest_speed", 2.0 / (12.0 / 0.1**2),
    ),
}  # fmt: skip
"""Models in a domain, with a method, a step beyond its bound in three dimensions and below that in two, and that."""


@pytest.mark.parametrize(("model", "case"), INSIDE.items())
def test_the_bound_in_a_deep_domain_is_that_of_three_dimensions(tmp_path, model, case):
    """It was told as that of a flat one, by which steps seemed to hold that do not."""
    fields, solver, step, output, bound = case
    script = DEEP.format(model=model, where="domain: ball", fields=fields, solver=solver, step=step, output=output)
    (told,) = warnings(loaded(tmp_path, script))
    found = re.fullmatch(r"dt = .* exceeds (\S+) ms, set by the .* over cells of 0.1 m \(scene.yaml:2\)", told)
    assert float(found[1]) * 1e-3 == pytest.approx(bound, rel=1e-2)
    flat = script.replace("domain: ball", "domain: ball, flat: yes").replace("[-y, x, 0]", "[-y, x]")
    assert warnings(loaded(tmp_path, flat)) == []


def test_speeds_and_coefficients_by_formulas_bound_the_step_by_their_largest(tmp_path):
    """Nothing was told of them."""
    box = {"where": "size: 2 1 m", "solver": "verlet", "output": "max"}
    script = DEEP.format(model="wave", fields="speed: 1 + x, initial: exp(-x^2/0.02)", step="0.03", **box)
    (told,) = warnings(loaded(tmp_path, script))
    bound = 2.0 / (2.0 * 3.0 * math.sqrt(2) / 0.1)
    assert float(re.search(r"exceeds (\S+) ms", told)[1]) * 1e-3 == pytest.approx(bound, rel=1e-2)
    (island,) = Run(loaded(tmp_path, script)).islands
    assert bound <= stability(island.march, island.solver).step < 1.25 * bound
    spread = DEEP.format(
        model="diffusion", fields="coefficient: 1 + x, initial: exp(-x^2/0.02)", step="1.2e-3",
        **box | {"solver": "euler"},
    )  # fmt: skip
    (told,) = warnings(loaded(tmp_path, spread))
    assert float(re.search(r"exceeds (\S+) ms", told)[1]) * 1e-3 == pytest.approx(2.0 / (8.0 * 3.0 / 0.1**2), rel=1e-2)


def test_a_solid_that_moves_bounds_the_step_of_the_flow_around_it(tmp_path):
    """The fluid is at rest at the start, whose spectrum tells nothing of what the solid will do."""
    script = (
        "clock: {end: 1 s}\nmodels: {air: {flow: {size: 2 1 m, cell: 0.1 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s, "
        "around: [cyl]}}}\nobjects: {cyl: {sphere: {radius: 0.2 m, position: '[0.5 m + 4 m*time^2/(1 s^2)/8, 0.5 m, "
        "0 m]'}}}\nsolvers: {main: {rk4: {step: 0.3 s}}}\noutputs: {data: {record: {of: [air.largest_speed]}}}\n"
    )
    graph = loaded(tmp_path, script)
    (told,) = warnings(graph)
    assert "set by the viscosity" in told  # 4 nu of both directions: 0.034 s
    fast = script.replace("4 m*time", "400 m*time").replace("0.3 s", "20 ms")
    (told,) = warnings(loaded(tmp_path, fast))
    found = re.fullmatch(r"dt = 20 ms exceeds (\S+) ms, set by the solid 'cyl' that moves .* \(scene.yaml:2\)", told)
    assert 2.5 / (100.0 / 0.1) < float(found[1]) * 1e-3 < 3.0 / (100.0 / 0.1)  # |v| dt/cell of rk4
    plan = text(explain(loaded(tmp_path, fast)))
    assert re.search(rf"after the start stable up to a step of {found[1]} ms, set by the solid 'cyl'", plan)


def test_a_coefficient_that_varies_in_time_is_bounded_by_its_start(tmp_path):
    """`check` and `explain` ended in a traceback."""
    field = 'size: 1 1 m, cell: 0.1 m, coefficient: "0.01*(1 + t)", initial: x'
    script = f"models: {{heat: {{diffusion: {{{field}}}}}}}\nsolvers: {{main: {{ftcs: {{step: 1 s}}}}}}\n"
    (warning,) = loaded(tmp_path, script + "clock: {end: 2 s}\n").warnings
    assert "0.25 s" in warning.message
