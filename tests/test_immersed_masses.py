"""Masses in flows that are solved: lattices, solids, ropes and cloth under `immersion`."""

import numpy as np
import pytest

from flows import WAVES, Air
from sceneql.failure import RunFailure
from sceneql.flows.varying.fluid_layout import FASTEST, MASSES
from sceneql.kinds.stable_step import StaticScene, stable_step
from sceneql.quantities.diagnostic import ScriptError
from sceneql.words.forces.immersion import swing
from sceneql.words.solvers.imex_midpoint import ImexMidpoint

IMMERSED = "forces: [{immersion: {on: [net], in: air}}]\n"
ROUND = '{velocity: "[1 + 0.3*sin(2*pi*y), 0.2*sin(2*pi*x)]"}'
DEEP = {"size": "1 1 1 m", "boundary": "{left: {periodic: yes}, bottom: {periodic: yes}, back: {periodic: yes}}"}
BALL = "objects: {ball: {sphere: {radius: 0.2 m, position: 0.5 0.5 0.5 m}}}\n"


def netted(folder, net, forces=IMMERSED, objects="", solver="{auto: {}}", **more):
    """A model `net` in a flow `air` of 1 m, periodic where nothing else is said."""
    more = {"boundary": WAVES, "advection": "central", **more}
    return Air(folder, solver, models=f"  net: {net}\n{forces}{objects}", **more)


def block(mass, stiffness=0.5, spacing=0.03, count="9, 9, 1", more=""):
    """A flat lattice in the middle."""
    lattice = f"{{count: [{count}], spacing: {spacing!r} m, center: 0.5 0.5 0 m}}"
    return f"{{mass_spring: {{lattice: {lattice}, mass: {mass!r} kg, stiffness: {stiffness!r} N/m{more}}}}}"


def rope(mass, count=17, stiffness=1.0, more=""):
    """A line in the middle."""
    line = f"{{from: 0.3 0.5 0 m, to: 0.7 0.5 0 m, count: {count}}}"
    return f"{{mass_spring: {{rope: {line}, mass: {mass!r} kg, stiffness: {stiffness!r} N/m{more}}}}}"


def face_masses(air):
    """The sum of the masses in the own cells of the faces of each component."""
    flow = air.run.march.system.fields.flow
    sizes = [int(np.prod(grid.cells.shape)) for grid in flow.components]
    at = flow.varying[MASSES]
    found = air.run.state("air").floats[at : at + sum(sizes)]
    return [part.sum() for part in np.split(found, np.cumsum(sizes)[:-1])], found.min()


@pytest.mark.parametrize(
    ("net", "added"),
    [(block(0.01), 0.81 - 0.24**2), (block(0.0004), 0.0324 - 0.24**2), (rope(0.02), 0.34)],
    ids=["heavy", "light", "rope"],
)
def test_masses_stand_in_place_of_the_fluid_and_momentum_stays(tmp_path, net, added):
    air = netted(tmp_path, net, initial=ROUND, end=0.05, cell="1/12 m").at(0.0)
    sums, least = face_masses(air)
    assert sums == pytest.approx([1.0 + added] * 2, rel=1e-13)
    assert least > 0.0
    before = air.read("momentum")
    assert before == pytest.approx([1.0 + added, 0.0, 0.0], rel=1e-3, abs=2e-3)
    air.at(0.05)
    assert air.read("momentum") == pytest.approx(before, abs=2e-11 * before[0])
    assert face_masses(air)[0] == pytest.approx([1.0 + added] * 2, rel=1e-13)
    assert air.read("divergence") < 1e-8


def test_what_moves_with_an_even_flow_goes_on_with_it_to_rounding(tmp_path):
    air = netted(tmp_path, block(0.05), initial='{velocity: "[0.7, -0.4]"}', end=0.1, cell="1/12 m").at(0.0)
    start = air.read("positions", "net")
    assert air.at(0.1).read("positions", "net") - start == pytest.approx(
        np.broadcast_to([0.07, -0.04, 0.0], start.shape), abs=1e-11
    )


def test_a_neutral_solid_without_strength_moves_as_the_fluid_alone(tmp_path):
    soft = "{mass_spring: {solid: {object: ball, spacing: 0.09 m, density: 1 kg/m^3, modulus: 1e-9 Pa}}}"
    twirl = '{velocity: "[sin(2*pi*y), sin(2*pi*z), sin(2*pi*x)]"}'
    more = {**DEEP, "cell": "0.1 m", "initial": twirl, "end": 0.02, "solver": "{heun: {step: 4 ms}}"}
    (tmp_path / "alone").mkdir()
    alone = Air(tmp_path / "alone", advection="central", **more).at(0.02)
    air = netted(tmp_path, soft, objects=BALL, **more).at(0.02)
    assert air.read("velocity") == pytest.approx(alone.read("velocity"), abs=1e-9)
    points, moved = air.read("positions", "net"), air.read("velocities", "net")
    turning = np.sin(2 * np.pi * np.roll(points, -1, axis=1)) * np.exp(-0.05 * 4 * np.pi**2 * 0.02)
    assert moved == pytest.approx(turning, abs=0.15)  # what splines smooth, and how the flow itself has changed
    assert air.read("volume", "net") == pytest.approx(4 / 3 * np.pi * 0.2**3, rel=0.06)


def test_energy_of_flow_and_springs_falls_by_friction_alone(tmp_path):
    lost = []
    for step in (4, 2):
        more = {"viscosity": "1e-6 Pa*s", "solver": f"{{imex_midpoint: {{step: {step} ms}}}}", "end": 0.2}
        air = netted(tmp_path, block(0.02, 2.0, more=", pins: [left]"), initial=ROUND, cell="1/12 m", **more).at(0.0)
        whole = [air.read("kinetic_energy") + air.read("potential", "net")]
        whole.append(air.at(0.2).read("kinetic_energy") + air.read("potential", "net"))
        lost.append(1.0 - whole[1] / whole[0])
    assert 0.0 < lost[1] < 0.02
    assert lost[1] == pytest.approx(lost[0], abs=2e-3)


def drag(radius):
    """What draws a long cylinder at unit speed through a square row of such, by viscosity and length.

    Hasimoto (1959), J. Fluid Mech. 5, 317-328, with the next terms of Sangani & Acrivos (1982).
    """
    part = np.pi * radius**2
    return 4 * np.pi / (-0.5 * np.log(part) - 0.738 + part - 0.887 * part**2 + 2.038 * part**3)


def disc(radius, rings, mass, stiffness):
    """Masses in rings, all of them in near ones tied: a stiff net of no volume."""
    points = [(0.0, 0.0)]
    for k in range(1, rings + 1):
        turns = 2 * np.pi * (np.arange(count := round(2 * np.pi * k)) / count + 0.05 * k)
        points += [(radius * k / rings * np.cos(turn), radius * k / rings * np.sin(turn)) for turn in turns]
    places = np.array(points)
    pairs = np.argwhere(np.triu(np.linalg.norm(places[:, None] - places, axis=2) < 1.6 * radius / rings, 1))
    masses = ", ".join(f"m{k}: {{position: {x + 0.5:.12f} {y + 0.5:.12f} 0 m}}" for k, (x, y) in enumerate(points))
    springs = ", ".join(f"{{between: [m{a}, m{b}]}}" for a, b in pairs)
    numbers = f"mass: {mass / len(points)!r} kg, stiffness: {stiffness!r} N/m"
    return f"{{mass_spring: {{{numbers}, masses: {{{masses}}}, springs: [{springs}]}}}}"


@pytest.mark.parametrize("cells", [12, 20])
def test_a_stiff_disc_sinks_as_hasimoto_has_a_cylinder_wider_by_less_than_a_cell(tmp_path, cells):
    forces = "forces: [{immersion: {on: [net], in: air}}, {gravity: {acceleration: 20 0 0 m/s^2}}]\n"
    flow = {"viscosity": "1 Pa*s", "cell": f"1/{cells} m", "force": '"[-1, 0]"', "end": 0.2}
    air = netted(tmp_path, disc(0.15, cells * 3 // 10, 0.05, 1000.0), forces, **flow).at(0.2)
    speed = air.read("velocities", "net")[:, 0].mean()
    past = speed - (air.read("momentum")[0] - 0.05 * speed)  # the fluid in the mean, which goes back
    radii = np.linspace(0.15, 0.3, 1501)
    wider = np.interp(1.0 / past, drag(radii), radii) - 0.15
    assert 0.5 < wider * cells < 0.9  # forces are spread over some cells: an error of order 1


def test_accelerations_are_the_slopes_of_velocities(tmp_path):
    air = netted(tmp_path, block(0.01), initial=ROUND, end=0.052, solver="{imex_midpoint: {step: 1 ms}}", cell="1/12 m")
    before = air.at(0.049).read("velocities", "net").copy()
    told = air.at(0.05).read("accelerations", "net").copy()
    after = air.at(0.051).read("velocities", "net")
    assert told == pytest.approx((after - before) / 2e-3, abs=0.02 * np.abs(told).max())


def test_masses_that_are_held_stay_and_led_ones_move_as_they_are_led(tmp_path):
    pins = ', pins: {start: {shift: "[0, 0.1 m/s*time, 0]"}, end: {}}'
    air = netted(tmp_path, rope(0.01, more=pins), initial=ROUND, end=0.1, cell="1/12 m").at(0.0)
    start = air.read("positions", "net")
    moved = air.at(0.1).read("positions", "net") - start
    assert moved[0] == pytest.approx([0.0, 0.01, 0.0], abs=1e-12)
    assert not moved[-1].any()
    assert air.read("velocities", "net")[0] == pytest.approx([0.0, 0.1, 0.0], abs=1e-9)
    assert moved[8, 0] > 0.01


def test_a_lattice_that_sinks_comes_to_rest_on_the_floor(tmp_path):
    forces = (
        "forces: [{immersion: {on: [net], in: air}}, gravity]\ncontacts: {land: {collision: {between: [net, pan]}}}\n"
    )
    pan = "objects: {pan: {box: {size: 2 0.2 1 m, position: 0.5 0 0 m}}}\n"
    net = block(0.02, 200.0, 0.04, "5, 5, 1")
    more = {"boundary": "{}", "viscosity": "0.3 Pa*s", "end": 1.5, "cell": "1/16 m"}
    air = netted(tmp_path, net, forces, pan, **more).at(1.5)
    assert 0.1 < air.read("positions", "net")[:, 1].min() < 0.1 + 1 / 16
    assert np.abs(air.read("velocities", "net")).max() < 2e-3


def landing(folder, other, objects="", models="", friction=0.0, end=1.5):
    """A lattice that sinks in syrup and lands on something."""
    forces = (
        "forces: [{immersion: {on: [net], in: air}}, {gravity: {on: [net]}}]\n"
        f"contacts: {{land: {{collision: {{between: [net, {other}], friction: {friction}}}}}}}\n"
    )
    net = block(0.02, 200.0, 0.04, "5, 5, 1")
    more = {"boundary": "{}", "viscosity": "0.3 Pa*s", "end": end, "cell": "1/16 m"}
    return netted(folder, net, models + forces, objects, **more)


def test_a_lattice_that_lands_on_what_rises_goes_up_with_it(tmp_path):
    pan = "objects: {pan: {box: {size: 2 0.2 1 m, position: '[0.5 m, 0.1 m/s*time, 0 m]'}}}\n"
    air = landing(tmp_path, "pan", pan)
    for time in (0.9, 1.2, 1.5):
        air.at(time)
        assert 0.1 * time + 0.1 < air.read("positions", "net")[:, 1].min() < 0.1 * time + 0.1 + 1 / 16
    assert air.read("velocities", "net")[:, 1] == pytest.approx(0.1, abs=0.01)


def test_friction_takes_a_lattice_along_with_what_slides_under_it(tmp_path):
    pan = "objects: {pan: {box: {size: 4 0.2 1 m, position: '[0.5 m + 0.1 m/s*time, 0 m, 0 m]'}}}\n"
    speeds = []
    for friction in (0.0, 1.0):
        (folder := tmp_path / str(friction)).mkdir()
        air = landing(folder, "pan", pan, friction=friction).at(1.5)
        assert 0.1 < air.read("positions", "net")[:, 1].min() < 0.1 + 1 / 16
        speeds.append(air.read("velocities", "net")[:, 0].mean())
    assert abs(speeds[0]) < 2e-3
    assert speeds[1] > 0.05


@pytest.mark.parametrize("rigid", [False, True], ids=["mass", "body"])
def test_what_a_lattice_lands_on_takes_up_its_weight(tmp_path, rigid):
    objects = "objects: {plate: {box: {size: 0.6 0.2 1 m, position: 0.5 0.2 0 m}}}\n" if rigid else ""
    body = "{rigid: {of: plate, mass: 5000 kg}}"  # so that it stays about where it is
    if not rigid:
        body = "{mass_spring: {masses: {b: {position: 0.5 0.15 0 m, mass: 5000 kg}}, radius: 0.15 m}}"
    air = landing(tmp_path, "load", objects, f"  load: {body}\n", end=1.2).at(0.8)
    before = air.read("velocities", "load")[0, 1]
    air.at(1.2)
    gained = air.read("velocities", "load")[0, 1] - before
    weight = 9.81 * (25 * 0.02 - 0.16**2)  # less that of the fluid that the lattice displaces
    if rigid:  # at rest on it
        assert gained == pytest.approx(-weight * 0.4 / 5000.0, rel=0.02)
    else:  # on its way off the ball
        assert -1.2 * weight * 0.4 / 5000.0 < gained < -0.2 * weight * 0.4 / 5000.0
    assert air.read("positions", "net")[:, 1].min() > 0.1


@pytest.mark.parametrize("cells", [16, 32])
@pytest.mark.parametrize("count", [33, 65])
@pytest.mark.parametrize("mass", [0.1, 1e-4])
def test_the_fastest_swing_that_check_tells_bounds_that_of_the_run(tmp_path, cells, count, mass):
    step = {"solver": "{imex_midpoint: {step: 1 us}}", "cell": f"1/{cells} m", "end": 1e-6}
    spacing = 0.25 / (count // 2)
    for net in (rope(mass, count), block(spacing**2, 1.0, spacing, f"{count // 2 + 1}, {count // 2 + 1}, 1")):
        air = netted(tmp_path, net, **step).at(0.0)
        at = air.run.march.system.fields.flow.varying[FASTEST]
        told = swing("net", air.tasks["net"].kind, 1.0, 1 / cells, 2, 1.0, StaticScene({}, 1.0))
        assert 0.97 <= told / air.run.state("air").floats[at] <= 1.3


@pytest.mark.parametrize(("part", "holds"), [(0.9, True), (2.5, False)])
def test_fixed_steps_bear_what_check_tells(tmp_path, part, holds):
    waved = '{velocity: "[0.01*sin(2*pi*x)*cos(2*pi*y), -0.01*cos(2*pi*x)*sin(2*pi*y)]"}'
    turn = 2.0 * (200.0 / 0.02) ** 0.5 * 0.6 * 0.025 * 12 * (0.02 / (0.02 + 0.025 * 2.5 / 12)) ** 0.5
    bound = stable_step(lambda step: ImexMidpoint().oscillation(0.0, 0.0, step, turn))
    assert bound == pytest.approx(2.0 / turn, rel=1e-5)  # as Verlet's method
    end, solver = 100 * part * bound, f"{{imex_midpoint: {{step: {part * bound!r} s}}}}"
    air = netted(
        tmp_path, rope(0.02, stiffness=200.0), initial=waved, cell="1/12 m", viscosity="1e-4 Pa*s", solver=solver,
        end=end,
    )  # fmt: skip
    told = [one.message for one in air.graph.warnings]
    assert any("set by the springs of 'net'" in one for one in told) is not holds
    if holds:
        assert air.at(end).read("largest_speed") < 0.02
    else:
        with pytest.raises(RunFailure):
            air.at(end)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"net": block(0.01, spacing=0.07)}, "masses of 'net' 0.07 m apart are too coarse for cells of 0.0625 m"),
        ({"net": block(0.0001)}, "as heavy as the fluid that it displaces"),
        ({"net": block(0.01, count="9, 9, 2")}, "masses of 'net' stand off the plane z = 0"),
        ({"net": block(0.01, more=", velocity: 1 0 0 m/s")}, "has no velocity of its own"),
        ({"net": rope(0.01).replace("0.7 0.5", "1.2 0.5"), "boundary": "{}"}, "'net' stands outside its flow"),
        ({"net": rope(0.01, more=", pins: {start: {until: 1 s}}")}, "the pin 'start' lets go of masses that a flow"),
        ({"forces": "forces: [{immersion: {on: [net], in: air, kernel: peskin}}]\n"}, "Peskin's kernel is here"),
        ({"pressure": "direct"}, "masses in it weigh other than its fluid"),
        ({"forces": IMMERSED + "contacts: {hits: {mutual_collision: {between: [net]}}}\n"}, "which keeps them apart"),
        (
            {"forces": "forces: [{immersion: {on: [net], in: air}}, {impulse: {on: net.start.position, at: 1 ms, "
             "value: 0 1 0 kg*m/s}}]\n"},
            "a blow at an instant",
        ),
        (
            {"forces": IMMERSED + "ties: {held: {rod: {between: [net.start, world]}}}\n"},
            "is carried by a flow, and ties hold nothing",
        ),
    ],
)  # fmt: skip
def test_masses_that_do_not_fit_their_flow_are_refused(tmp_path, change, message):
    change = {"net": rope(0.01), **change}
    with pytest.raises(ScriptError, match=message):
        netted(tmp_path, change.pop("net"), **change).at(0.0)
