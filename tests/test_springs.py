"""Springs that tear, pins that move, solids of any shape, and cloth with the numbers of cloth."""

import math
from dataclasses import replace

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.failure import LimitRefused
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run

TETHER = """
clock: {end: 1 s}
models:
  sling:
    mass_spring:
      masses: {wall: {fixed: yes}, stone: {position: 1 0 0 m, mass: 2 kg, velocity: 3 0 0 m/s}}
      springs: [{between: [wall, stone], stiffness: 50 N/m, name: tether}]
      tear: {at: 1.4}
solvers: {main: {rk4: {step: 1 ms}}}
"""


def test_a_torn_spring_lets_go_and_its_energy_is_counted(tmp_path):
    names = ("sling.torn", "sling.stone.velocity", "sling.energy", "sling.dissipated", "sling.tether.tension")
    early, late = watch(tmp_path, TETHER, [0.1, 1], *names)
    assert early[0] == early[3] == 0
    torn, v, energy, lost, tension = late
    assert torn == 1
    assert tension == 0
    assert energy == pytest.approx(9, rel=1e-9)
    assert lost == pytest.approx(0.5 * 50 * 0.4**2, rel=0.02)  # it tears at the end of a step
    assert v[0] == pytest.approx(math.sqrt(9 - lost), rel=1e-9)


def test_a_spring_tears_where_it_reaches_its_length_if_a_tolerance_chooses_the_steps(tmp_path):
    """x = 1 + 0.6 sin 5t up to 1.4, then at the speed that is left."""
    script = TETHER.replace("rk4: {step: 1 ms}", "dop853: {tolerance: 1e-11}")
    ((lost, place, v),) = watch(
        tmp_path, script, [1], "sling.dissipated", "sling.stone.position", "sling.stone.velocity"
    )
    assert lost == pytest.approx(4, rel=1e-8)
    assert v[0] == pytest.approx(math.sqrt(5), rel=1e-8)
    assert place[0] == pytest.approx(1.4 + math.sqrt(5) * (1 - math.asin(2 / 3) / 5), rel=1e-8)


def test_what_is_torn_is_neither_drawn_nor_stretched(tmp_path):
    ((ends, stretch),) = watch(tmp_path, TETHER, [1], "sling.springs", "sling.stretch")
    assert len(ends) == stretch == 0


LED = """
clock: {{end: 2 s}}
models:
  chain:
    mass_spring:
      rope: {{from: 0 0 0 m, to: 1 0 0 m, count: 3}}
      mass: 0.5 kg
      stiffness: 40 N/m
      damping: 0.2 N*s/m
      pins: {{start: {{shift: {shift}{until}}}}}
solvers: {{main: {{rk4: {{step: 1 ms}}}}}}
"""


@pytest.mark.parametrize(
    ("shift", "place", "velocity"),
    [
        ("[0.2 m * sin(3*time/(1 s)), 0 m, 0 m]", 0.2 * math.sin(4.5), 0.6 * math.cos(4.5)),
        ("{keys: {0 s: 0 0 0 m, 1 s: 0.5 0 0 m, 2 s: 0 0 0 m}, curve: linear}", 0.25, -0.5),
    ],
)
def test_a_pin_goes_where_it_is_led_and_its_work_is_counted(tmp_path, shift, place, velocity):
    script = LED.format(shift=shift, until="")
    names = ("chain.positions", "chain.velocities", "chain.energy", "chain.dissipated")
    x, v, energy, lost = watch(tmp_path, script, [1.5], *names)[0]
    np.testing.assert_allclose(x[0], [place, 0, 0], atol=1e-7)
    np.testing.assert_allclose(v[0], [velocity, 0, 0], atol=1e-5)
    if "sin" in shift:  # a kink of keyframes is a jerk, whose work no step sees
        assert energy == pytest.approx(watch(tmp_path, script, [0], "chain.energy")[0][0], abs=1e-5)
        assert abs(lost) > 0.01


def test_a_pin_lets_go_in_time(tmp_path):
    script = LED.format(shift="[time*0.3 m/s, 0 m, 0 m]", until=", until: 0.5 s")
    rows = watch(tmp_path, script, [0.5, 2], "chain.positions", "chain.momentum", "chain.energy")
    assert rows[0][0][0, 0] == pytest.approx(0.15, abs=1e-9)
    np.testing.assert_allclose(rows[0][1], rows[1][1], atol=1e-12)  # free: no force from outside
    assert rows[1][0][0, 0] > 0.3
    assert rows[0][2] == pytest.approx(rows[1][2], rel=1e-8)


SHEET = """
clock: {{end: 0.5 s}}
models: {{sheet: {{cloth: {{size: 1 1 m, cells: 4 4, center: 0 2 0 m, facing: 0 0 1, pins: {pins}}}}}}}
forces: [gravity]
solvers: {{main: {{rk4: {{step: 1 ms}}}}}}
"""


def test_pins_may_be_told_by_where_they_start(tmp_path):
    both = "{top: {until: 0.3 s}, left: {}}", "{hem: {where: y > 2.4, until: 0.3 s}, side: {where: x < -0.4}}"
    named, told = (watch(tmp_path, SHEET.format(pins=pins), [0.5], "sheet.positions")[0][0] for pins in both)
    np.testing.assert_array_equal(named, told)
    with pytest.raises(ScriptError, match="pin 'hem': no mass starts where"):
        watch(tmp_path, SHEET.format(pins="{hem: {where: y > 3}}"), [0.5], "sheet.positions")


SOLID = """
clock: {{end: 0.5 s}}
objects: {{body: {{{shape}}}}}
models:
  jelly: {{mass_spring: {{solid: {{object: body, spacing: {spacing} m, cells: cubes}}, mass: 1 g, pins: [{pins}]}}}}
solvers: {{main: {{rk4: {{step: 1 ms}}}}}}
"""


def test_a_solid_of_cubes_has_the_springs_of_a_lattice_inside_its_object(tmp_path):
    shape = "torus: {radius: 0.5 m, tube: 0.2 m, position: 1 0 0 m, hidden: yes}"
    ((x, ends, stretch),) = watch(
        tmp_path, SOLID.format(shape=shape, spacing=0.07, pins="bottom"), [0.5], "jelly.positions", "jelly.springs",
        "jelly.stretch",
    )  # fmt: skip
    ring = np.hypot(np.hypot(x[:, 0] - 1, x[:, 2]) - 0.5, x[:, 1])
    assert ring.max() <= 0.2
    assert len(x) * 0.07**3 == pytest.approx(2 * math.pi**2 * 0.5 * 0.04, rel=0.1)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / 0.07
    assert set(np.round(lengths**2).astype(int)) == {1, 2, 3}
    assert stretch < 1e-9


@pytest.mark.parametrize(
    ("shape", "spacing", "pins", "said"),
    [
        ("plane: {}", 0.1, "", "it has no end"),
        ("sphere: {radius: 0.1 m}", 3, "", "no two neighbors"),
        ("sphere: {radius: 0.1 m}", 0.05, '"999"', "are counted from 0"),
    ],
)
def test_a_solid_that_cannot_be_is_told(tmp_path, shape, spacing, pins, said):
    path = tmp_path / "scene.yaml"
    path.write_text(SOLID.format(shape=shape, spacing=spacing, pins=pins))
    with pytest.raises(ScriptError, match=said) as error:
        Run(load(path))
    assert "scene.yaml:5" in str(error.value)


def test_a_spacing_whose_cube_is_beyond_all_numbers_is_no_crash(tmp_path):
    path = tmp_path / "scene.yaml"
    solid = "{solid: {object: body, spacing: 1e297 m, density: 300 kg/m^3}}"
    path.write_text(f"objects: {{body: sphere}}\nmodels: {{jelly: {{mass_spring: {solid}}}}}\n")
    assert load(path, pruned=False).islands[0].models == ("jelly",)


def test_a_solid_that_is_too_much_is_refused_before_it_is_made(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SOLID.format(shape="box: {size: 1 1 1 m}", spacing=0.008, pins=""))
    with pytest.raises(LimitRefused, match=r"1.91e\+06 masses and .* springs need about") as error:
        Run(load(path))  # its grid can be looked at, its springs cannot be held
    assert "scene.yaml:5" in str(error.value)


CLOTH = """
clock: {{end: {end} s}}
models:
  sheet: {{cloth: {{size: 1 0.5 m, cells: {cells}, facing: 0 0 1, center: 0 0 0 m, {more}}}}}
{forces}
solvers: {{main: {{rk4: {{step: 0.2 ms}}}}}}
"""


@pytest.mark.parametrize("cells", ["4 2", "8 8"])
def test_a_finer_cloth_is_the_same_cloth(tmp_path, cells):
    path = tmp_path / "scene.yaml"
    path.write_text(CLOTH.format(cells=cells, end=1, more="stretch: 300 N/m, shear: 0 N/m, bend: 0 N/m", forces=""))
    moment = next(iter(Run(load(path)).moments([0])))
    state = moment.state("sheet")
    assert np.sum(state.floats[state.bodies.mass_at :][: state.bodies.count]) == pytest.approx(0.1)
    kind = moment.run.graph.tasks["sheet"].kind
    stretched = state.y.copy()
    stretched[: 3 * state.bodies.count : 3] *= 1.01  # a strain along the width
    energy = kind.read("potential", replace(state, y=stretched))
    assert energy == pytest.approx(0.5 * 300 * 0.01**2 * 1 * 0.5, rel=1e-9)


def test_shear_has_its_modulus(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(CLOTH.format(cells="10 5", end=1, more="shear: 40 N/m, bend: 0 N/m", forces=""))
    moment = next(iter(Run(load(path)).moments([0])))
    state = moment.state("sheet")
    sheared = state.y.copy()
    n = 3 * state.bodies.count
    sheared[0:n:3] += 1e-5 * sheared[1:n:3]
    energy = moment.run.graph.tasks["sheet"].kind.read("potential", replace(state, y=sheared))
    assert energy == pytest.approx(0.5 * 40 * 1e-10 * 0.5, rel=1e-3)


def test_a_heavy_cloth_tears_off_its_pins(tmp_path):
    more = "stretch: 3 N/m, pins: [top_left, top_right], tear: {at: 1.3, variation: 0.1}"
    script = CLOTH.format(cells="8 4", end=0.6, more=more, forces="forces: [gravity]")
    (torn, energy, start) = (
        *watch(tmp_path, script, [0.6], "sheet.torn", "sheet.energy")[0],
        watch(tmp_path, script, [0], "sheet.energy")[0][0],
    )
    assert torn >= 2
    assert energy == pytest.approx(start, abs=1e-6)


@pytest.mark.parametrize("long", [1e-200, 1e300])
def test_a_cloth_faces_along_a_direction_of_any_length(tmp_path, long):
    script = "models: {sheet: {cloth: {facing: %s, cells: 2 2}}}\n"
    one, other = (watch(tmp_path, script % f"{-by} {by} 0", [0], "sheet.positions")[0][0] for by in (1.0, long))
    np.testing.assert_allclose(other, one, atol=1e-15)


@pytest.mark.parametrize("long", [1e-200, 1e300])
def test_gravity_pulls_along_a_direction_of_any_length(tmp_path, long):
    """Its square overflowed or vanished: nothing fell."""
    script = "models: {stone: {particles: {list: {a: {mass: 1 kg, position: 0 0 0 m}}}}}\nforces: [{gravity: {%s}}]\n"
    ((x,),) = watch(tmp_path, script % f"direction: {0.6 * long} {-0.8 * long} 0", [1], "stone.a.position")
    np.testing.assert_allclose(x, [0.6 * 9.81 / 2, -0.8 * 9.81 / 2, 0.0], rtol=1e-12)


WRONG = {
    "{cloth: {stretch: 0 N/m}}": "must be above 0",
    "{cloth: {mass: -1 kg/m^2}}": "must be above 0",
    "{cloth: {pins: [middle]}}": "no mass is called 'middle'",
    "{cloth: {tear: {at: 1}}}": "must be above 1",
    "{cloth: {facing: 0 0 0}}": "gives a direction, which 0 0 0 does not have",
    "{cloth: {size: 2 99999999999 m}}": "at most 1,000,000 times as long as wide",
    "{cloth: {cells: 100000 100000}}": "at most",
    "{mass_spring: {rope: {}, pins: {lid: {}}}}": "no mass is called 'lid'",
    "{mass_spring: {solid: {object: b, spacing: 0 m}}}": "must be above 0",
}


@pytest.mark.parametrize("entry", WRONG)
def test_wrong_springs_are_told_with_their_place(tmp_path, entry):
    said = complaint(tmp_path, f"objects: {{b: sphere}}\nmodels:\n  bad: {entry}\n")
    assert WRONG[entry] in said
    assert "scene.yaml:3:" in said


def test_an_implicit_method_leads_pins_and_tears_too(tmp_path):
    script = LED.format(shift="[0.2 m * sin(3*time/(1 s)), 0 m, 0 m]", until="")
    implicit = script.replace("rk4: {step: 1 ms}", "radau: {tolerance: 1e-7}")
    ((x,), (there,)) = (watch(tmp_path, one, [1.5], "chain.positions")[0] for one in (script, implicit))
    np.testing.assert_allclose(there, x, atol=1e-5)
    torn, energy = watch(tmp_path, TETHER.replace("rk4: {step: 1 ms}", "radau"), [1], "sling.torn", "sling.energy")[0]
    assert torn == 1
    assert energy == pytest.approx(9, rel=1e-3)
