"""Walls of solids that cut a flow's cells: exact flows, torque, forces, what an explicit step bears."""

import numpy as np
import pytest

from flows import Air
from sceneql.failure import RunFailure
from sceneql.flows import layout
from sceneql.grids.domain.cut import below

INNER, OUTER, SPEED, BACK = 0.4, 1.0, 1.0, -0.5
AXIS = (0.013, 0.021)
SWIRL = (BACK * OUTER**2 - SPEED * INNER**2) / (OUTER**2 - INNER**2)
SINK = (SPEED - BACK) * INNER**2 * OUTER**2 / (OUTER**2 - INNER**2)


def order(errors, factor):
    """Observed order of the first and last of errors, the last by cells ``factor`` times as fine."""
    return np.log(errors[0] / errors[-1]) / np.log(factor)


def faces(air, corner):
    """By face: the middle of what is open (f, 2), the open part, the velocity and the component."""
    state = air.run.state("air")
    ints, floats = state.ints[5:], state.floats
    cells, spacing = ints[:2], np.array(air.tasks["air"].kind.layout(state, "speed").spacing[:2])
    parts, places, speeds, components = [], [], [], []
    for axis in range(2):
        counts = [cells[k] + (k == axis and not ints[layout.PERIODIC + axis]) for k in range(2)]
        rows, columns = np.meshgrid(np.arange(counts[1]), np.arange(counts[0]), indexing="ij")
        off = [0.5 * (k != axis) for k in range(2)]
        index = np.stack([columns.ravel() + off[0], rows.ravel() + off[1]], axis=1)
        places.append(corner + index * spacing)
        first, n = ints[layout.STARTS + axis], len(index)
        parts.append(floats[ints[layout.AREAS] + first :][:n] / spacing[1 - axis])
        speeds.append(state.y[ints[layout.AT] + first :][:n])
        components.append(np.full(n, axis))
    places = np.concatenate(places)
    at, count = ints[layout.MIDDLES], ints[layout.CUT_FACES]
    cut, x, y, _ = floats[at : at + 4 * count].reshape(4, count)
    places[cut.astype(int)] = np.stack([x, y], axis=1)
    opened = np.concatenate(parts) > 0.0
    return places[opened], np.concatenate(speeds)[opened], np.concatenate(components)[opened]


def between_cylinders(folder, cells, edges="cut_cell"):
    """Error in the mean square and at most, torque on both over the exact one, less 1; steady after 1 s."""
    vessel = f"""objects:
  drum: {{sphere: {{position: {AXIS[0]} {AXIS[1]} 0 m, radius: {INNER} m}}}}
  plate: {{box: {{size: 3 3 1 m}}}}
  hole: {{sphere: {{position: {AXIS[0]} {AXIS[1]} 0 m, radius: {OUTER} m}}}}
  vessel: {{difference: {{of: [plate, hole]}}}}
"""
    turns = [
        f'{name}: {{wall: {{velocity: "[{-rate}*(y - {AXIS[1]}), {rate}*(x - {AXIS[0]})]"}}}}'
        for name, rate in (("drum", SPEED), ("vessel", BACK))
    ]
    air = Air(
        folder, "{sbdf2: {step: 20 ms}}", 1.0, before=vessel, size="2.3 2.3 m", corner="-1.15 -1.15 m",
        cell=f"2.3/{cells} m", viscosity="1 Pa*s", around="[drum, vessel]", boundary=f"{{{', '.join(turns)}}}",
        edges=edges, advection="central",
    ).at(1.0)  # fmt: skip
    places, speeds, components = faces(air, -1.15)
    x, y = (places - AXIS).T
    turning = SWIRL + SINK / (x**2 + y**2)
    wrong = speeds - np.where(components == 0, -y * turning, x * turning)
    torques = [air.read(f"{name}.torque")[2] / (4 * np.pi * SINK) for name in ("drum", "vessel")]
    return np.sqrt(np.mean(wrong**2)), np.abs(wrong).max(), torques[0] + 1, torques[1] - 1


def test_flow_between_turning_cylinders_is_of_second_order_and_has_their_torque(tmp_path):
    """u = A r + B/r; the torque a length is 4 pi mu B."""
    found = np.abs([between_cylinders(tmp_path, cells) for cells in (20, 28, 40, 56)])
    assert order(found[:, 0], 2.8) > 1.8
    assert order(found[:, 1], 2.8) > 1.4
    assert found[:, 2:].max() < 0.01
    assert found[-1, 2:] == pytest.approx([0.0, 0.0], abs=2e-3)


def test_a_staircase_between_turning_cylinders_is_of_first_order(tmp_path):
    coarse, fine = (between_cylinders(tmp_path, cells, "staircase") for cells in (28, 56))
    assert fine[0] > 20 * between_cylinders(tmp_path, 56)[0]
    assert order([coarse[0], fine[0]], 2.0) < 1.3


def turned(folder, cells, edges="cut_cell", degrees=30.0, wide=0.31, offset=0.0):
    """Poiseuille's flow between plates across a periodic box: errors over the fastest, force over weight less 1."""
    angle = np.radians(degrees)
    high, apart = np.tan(angle), np.sin(angle)
    plates = "".join(
        f"  p{k}: {{box: {{size: 6 {apart - wide} 1 m, position: 0.5 {high * (0.5 + k - 1) + offset} 0 m, "
        f"rotation: {{xyz: 0 0 {degrees} deg}}}}}}\n"
        for k in range(3)
    )
    air = Air(
        folder, "{sbdf2: {step: 20 ms}}", 0.6, before=f"objects:\n{plates}", size=f"1 {high} m", cell=f"1/{cells} m",
        viscosity="1 Pa*s", around="[p0, p1, p2]", boundary="{left: {periodic: yes}, bottom: {periodic: yes}}",
        force=f'"[{8 * np.cos(angle)}, {8 * np.sin(angle)}]"', edges=edges, advection="central",
    ).at(0.6)  # fmt: skip
    places, speeds, components = faces(air, 0.0)
    across = np.mod((places[:, 1] - offset) * np.cos(angle) - places[:, 0] * np.sin(angle), apart) - 0.5 * apart
    along = np.array([np.cos(angle), np.sin(angle)])
    wrong = (speeds - 4 * (0.25 * wide**2 - across**2) * along[components]) / wide**2
    force = sum(air.read(f"p{k}.force") for k in range(3))[:2]
    return np.sqrt(np.mean(wrong**2)), np.abs(wrong).max(), force / (8 * wide / np.cos(angle)) - along


@pytest.mark.parametrize(("degrees", "wide", "offset"), [(30.0, 0.31, 0.0), (30.0, 0.27, 0.013), (20.0, 0.23, 0.017)])
def test_a_channel_that_is_turned_is_of_second_order(tmp_path, degrees, wide, offset):
    found = [turned(tmp_path, cells, "cut_cell", degrees, wide, offset) for cells in (20, 28, 40, 56)]
    errors = np.array([one[:2] for one in found])
    assert order(errors[:, 0], 2.8) > 1.8
    assert order(errors[:, 1], 2.8) > 1.4
    assert np.abs([force for *_, force in found]).max() < 1e-3


def test_a_staircase_of_a_channel_that_is_turned_is_of_first_order(tmp_path):
    errors = [turned(tmp_path, cells, "staircase")[0] for cells in (28, 56)]
    assert errors[1] > 0.02
    assert order(errors, 2.0) < 1.3


def test_a_ball_that_turns_in_a_hollow_one_has_the_torque_of_lamb(tmp_path):
    """8 pi mu w a^3 b^3/(b^3 - a^3) (Lamb 1932, 334), about an axis askew in the grid."""
    vessel = """objects:
  drum: {sphere: {position: 0.013 0.021 0.007 m, radius: 0.4 m}}
  plate: {box: {size: 3 3 3 m}}
  hole: {sphere: {position: 0.013 0.021 0.007 m, radius: 1 m}}
  vessel: {difference: {of: [plate, hole]}}
"""
    known = 8 * np.pi * 0.4**3 / (1 - 0.4**3)
    spin = np.array([1.0, 2.0, 2.0]) / 3.0
    a, b, c = spin
    x, y, z = "(x - 0.013)", "(y - 0.021)", "(z - 0.007)"
    velocity = f"[{b}*{z} - {c}*{y}, {c}*{x} - {a}*{z}, {a}*{y} - {b}*{x}]"
    air = Air(
        tmp_path, "{sbdf2: {step: 50 ms}}", 0.6, before=vessel, size="2.2 2.2 2.2 m", corner="-1.1 -1.1 -1.1 m",
        cell="2.2/20 m", viscosity="1 Pa*s", around="[drum, vessel]", advection="central",
        boundary=f'{{drum: {{wall: {{velocity: "{velocity}"}}}}}}',
    ).at(0.6)  # fmt: skip
    assert air.read("drum.torque") == pytest.approx(-known * spin, abs=0.02 * known)
    assert air.read("vessel.torque") == pytest.approx(known * spin, abs=0.02 * known)
    assert np.abs(air.read("drum.force")).max() < 0.02


@pytest.mark.parametrize("seed", range(4))
def test_explicit_steps_bear_solids_anywhere_up_to_the_bound_of_the_open_flow(tmp_path, seed):
    """rk4 up to 2.785 over 4 nu (1/h^2 + 1/h^2): however little a wall leaves of a cell."""
    x, y, radius = np.random.default_rng(seed).uniform([0.4, 0.4, 0.1], [0.6, 0.6, 0.3])
    stone = f"objects: {{stone: {{sphere: {{position: {x} {y} 0 m, radius: {radius} m}}}}}}\n"
    air = Air(
        tmp_path, f"{{rk4: {{step: {0.99 * 2.785 / (8 * 20**2)} s}}}}", 0.3, before=stone, around="[stone]",
        viscosity="1 Pa*s", cell="1/20 m", initial='{velocity: "[1 + 0*x, sin(37*x*y)]"}',
        boundary="{left: {periodic: yes}, bottom: {periodic: yes}}",
    ).at(0.05)  # fmt: skip
    before = air.read("kinetic_energy")
    assert air.at(0.3).read("kinetic_energy") < 0.2 * before


def test_a_fluid_at_rest_is_held_by_its_pressure_whatever_a_solid_leaves_of_cells(tmp_path):
    stone = "objects: {stone: {sphere: {position: 0.47 0.52 0 m, radius: 0.23 m}}}\n"
    air = Air(tmp_path, "{sbdf2: {step: 20 ms}}", 0.2, before=stone, around="[stone]", force='"[3, -5]"').at(0.2)
    assert air.read("largest_speed") < 1e-9
    assert air.read("stone.force")[:2] == pytest.approx([-3 * np.pi * 0.23**2, 5 * np.pi * 0.23**2], rel=0.025)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_the_mean_depth_below_a_plane_is_that_of_many_points(axes):
    random = np.random.default_rng(axes)
    phi, slopes = 0.5 * random.normal(size=40), random.normal(size=(40, axes))
    slopes[:4], phi[4:6] = 0.0, (-9.0, 9.0)
    sides = np.array([1.0, 0.7, 1.3])[:axes]
    line = (np.arange(60) + 0.5) / 60 - 0.5
    points = np.stack(np.meshgrid(*(line * side for side in sides), indexing="ij"), axis=-1).reshape(-1, axes)
    depths = np.maximum(-(phi[:, None] + slopes @ points.T), 0.0).mean(axis=1)
    assert below(phi, slopes, sides, depth=True) == pytest.approx(depths, abs=2e-4)


@pytest.mark.parametrize("solver", ["{chorin: {step: 20 ms}}", "{sbdf2: {step: 20 ms}}", "{ark3: {step: 20 ms}}"])
@pytest.mark.parametrize("what", ["pressure", "viscosity"])
def test_a_run_whose_iterations_lead_nowhere_fails_at_its_flow(tmp_path, solver, what):
    """By numbers that no fluid has: a guess of the pressure that is always 0; walls that drive instead of hold."""
    stone = "objects: {stone: {sphere: {position: 0.5 0.45 0 m, radius: 0.2 m}}}\n"
    air = Air(
        tmp_path, solver, 1.0, before=stone, around="[stone]", cell="1/24 m", viscosity="1 Pa*s",
        boundary='{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}',
    ).at(0.1)  # fmt: skip
    floats, count = air.run.march.floats, 24 * 24
    if what == "pressure":
        at = air.run.state("air").ints[5 + layout.SPECTRUM]
        floats[at : at + count] = 0.0
    else:
        at = air.run.march.system.fields.flow.components[0].sink_at
        floats[at : at + count] -= np.random.default_rng(0).uniform(0.0, 1e2, count)
    with pytest.raises(RunFailure, match=r"at 0.1 s, air: .* the pressure and viscosity of a step are not solved for"):
        air.at(0.5)


def test_the_torque_of_a_drum_that_fluid_comes_to_turn_with_is_known_between_steps_of_a_tolerance(tmp_path):
    """Spin-up from rest: 4 pi mu R^2 sum over the zeros b of J1 of exp(-nu (b/R)^2 t) (Batchelor 1967, section 4.3)."""
    from scipy.special import jn_zeros

    drum = "{cylinder: {radius: 0.5 m, height: 2 m, rotation: {about: x, angle: 90 deg}}}"
    air = Air(
        tmp_path, "{auto: {}}", 0.7, before=f"objects: {{drum: {drum}}}\n", size=None, domain="drum", flat="yes",
        cell="1/32 m", boundary='{drum: {wall: {velocity: "[-y, x]"}}}',
    )  # fmt: skip
    for time in (0.4, 0.45, 0.5, 0.65):
        exact = -0.05 * np.pi * np.exp(-0.2 * jn_zeros(1, 9) ** 2 * time).sum()
        assert air.at(time).read("drum.torque")[2] == pytest.approx(exact, rel=0.02)
