"""Local contacts of implicit solvers, within their stages or between steps: nothing sinks in, friction holds, what
rests is still."""

import numpy as np
import pytest

from runs import watch
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

G = 9.81
SOLVERS = (
    "implicit_euler: {step: 1/120 s}",
    "bdf2: {step: 1/120 s}",
    "tr_bdf2: {step: 1/120 s}",
    "implicit_midpoint: {step: 1/120 s}",
)
BETWEEN = ("radau: {}", "rodas5p: {}")
"""Those whose contacts act between steps, in which what rests is tied."""
SHEET = """clock: {{end: {end} s}}
models:
  sheet: {{cloth: {{size: 1 1 m, cells: 9 9, center: {center}, facing: {facing}, stretch: 4 kN/m, shear: 400 N/m,
    bend: 40 N/m, damping: 0.1, thickness: 20 mm}}}}
objects: {{floor: {floor}}}
forces: [gravity]
contacts: {{hit: {{collision: {{friction: {friction}, restitution: {restitution}, mode: local}}}}}}
solvers: {{main: {{{solver}}}}}
"""


def sheet(solver, end, center, friction=0.0, floor="plane", facing="0 1 0", restitution=0.0):
    return SHEET.format(**locals())


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_stiff_sheet_lands_on_the_floor_and_lies_still(tmp_path, solver):
    outputs = ("sheet.positions", "sheet.velocities", "sheet.energy", "hit.hits.count")
    *_, one, two = watch(tmp_path, sheet(solver, 1, "0 0.11 0 m"), [0, 0.5, 1], *outputs)
    assert one[3] == two[3] == 100
    np.testing.assert_allclose(two[0][:, 1], 0.01, atol=1e-12)
    np.testing.assert_allclose(two[0], one[0], atol=1e-9)
    np.testing.assert_allclose(two[1], 0, atol=1e-9)
    assert two[2] == pytest.approx(one[2], rel=1e-9)


@pytest.mark.parametrize("solver", BETWEEN)
def test_a_stiff_sheet_lands_and_lies_still_between_steps_of_any_length(tmp_path, solver):
    outputs = ("sheet.positions", "sheet.velocities", "sheet.energy", "hit.hits.count")
    start, one, two = watch(tmp_path, sheet(solver, 1, "0 0.11 0 m"), [0, 0.5, 1], *outputs)
    assert one[3] == two[3] >= 100
    np.testing.assert_allclose(two[0][:, 1], 0.01, atol=1e-9)
    np.testing.assert_allclose(two[0], one[0], atol=1e-9)
    np.testing.assert_allclose(two[1], 0, atol=1e-8)
    assert two[2] == pytest.approx(start[2], rel=1e-3)


@pytest.mark.parametrize("solver", [*SOLVERS, *BETWEEN])
def test_on_a_slope_a_sheet_slides_if_it_is_steeper_than_friction_holds(tmp_path, solver):
    # tan(angle) = 3/4.
    normal = np.array([0.6, 0.8, 0])
    down = np.array([0.8, -0.6, 0])
    for friction in (0.0, 0.5, 0.74, 0.76):
        slope = "{plane: {normal: 3 4 0}}"
        script = sheet(solver, 0.5, "0.006 0.008 0 m", friction, slope, "3 4 0")
        early, late = watch(tmp_path, script, [0.25, 0.5], "sheet.positions", "sheet.velocities")
        faster = max(0.0, 0.6 - friction * 0.8) * G * 0.25
        # A friction that turns into rest, or nearly, is no rate that steps between contacts see to the end.
        atol = 1e-8 if solver in SOLVERS else 2e-5
        np.testing.assert_allclose(late[1] - early[1], np.tile(down * faster, (100, 1)), atol=atol)
        np.testing.assert_allclose(late[0] @ normal, 0.01, atol=1e-9)
        if friction > 0.75:
            np.testing.assert_allclose(late[1], 0, atol=1e-9)


@pytest.mark.parametrize("solver", ["implicit_euler: {step: 10 ms}", "bdf2: {step: 10 ms}", *BETWEEN])
@pytest.mark.parametrize(
    "wall", ["{box: {size: 0.001 9 9 m}}", "{plane: {normal: -1 0 0}}", "{sphere: {radius: 2 m, position: 2 0 0 m}}"]
)
def test_nothing_passes_a_wall_at_500_m_s(tmp_path, solver, wall):
    script = f"""
clock: {{end: 0.2 s}}
models: {{dust: {{particles: {{fill: {{object: room, count: 100}}, velocity: 500 0 0 m/s, radius: 1 mm}}}}}}
objects: {{room: {{box: {{size: 1 1 1 m, position: -3 0 0 m}}}}, wall: {wall}}}
contacts: {{hit: {{collision: {{between: [dust, wall], restitution: 0, mode: local}}}}}}
solvers: {{main: {{{solver}}}}}
"""
    rows = watch(tmp_path, script, [0.01, 0.02, 0.2], "dust.positions", "hit.hits.count")
    for positions, _ in rows:
        if "sphere" in wall:
            assert np.linalg.norm(positions - [2, 0, 0], axis=1).min() > 2
        else:
            assert positions[:, 0].max() < 0
    assert rows[-1][1] >= 100


@pytest.mark.parametrize("solver", ["bdf2: {step: 1 ms}", "dopri5: {}", *BETWEEN])
def test_bounces_reach_their_heights(tmp_path, solver):
    script = f"""
clock: {{end: 1 s}}
models: {{dust: {{particles: {{fill: {{object: room, count: 100}}, radius: 10 mm}}}}}}
objects: {{room: {{box: {{size: 1 1 1 m, position: 0 1.5 0 m}}}}, floor: plane}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [dust, floor], restitution: 0.8, mode: local}}}}}}
solvers: {{main: {{{solver}}}}}
"""
    start, end = watch(tmp_path, script, [0, 1], "dust.positions", "hit.hits.count")
    height = start[0][:, 1] - 0.01
    fall = np.sqrt(2 * height / G)
    apart = 1 - fall
    expected = 0.01 + 0.8 * np.sqrt(2 * G * height) * apart - G * apart**2 / 2
    once = (apart > 0) & (apart < 1.6 * fall)
    assert once.sum() > 50
    np.testing.assert_allclose(end[0][once, 1], expected[once], atol=0.01 if "bdf2" in solver else 1e-4)


DRAPE = """clock: {{end: 4 s}}
models:
  sheet: {{cloth: {{size: 0.8 0.8 m, cells: 10 10, center: 0 0.61 0 m, stretch: 400 N/m, shear: 100 N/m,
    bend: 40 N/m, damping: 0.2, thickness: 20 mm, pins: [60]}}}}
objects: {{ball: {{sphere: {{radius: 0.6 m}}}}, floor: {{plane: {{height: -5 m}}}}}}
forces: [gravity, {{drag: {{linear: 5 g/s}}}}]
contacts: {{hit: {{collision: {{restitution: 0, mode: local}}}}}}
solvers: {{main: {{{solver}}}}}
"""


def drape(folder, solver):
    return watch(folder, DRAPE.format(solver=solver), np.linspace(0, 4, 41), "sheet.positions", "sheet.energy")


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    return drape(tmp_path_factory.mktemp("drape"), "rk4: {step: 0.5 ms}")


@pytest.mark.parametrize(
    ("solver", "drift"),
    [("implicit_euler: {step: 1/60 s}", 0.04), ("bdf2: {step: 1/120 s}", 0.03), ("tr_bdf2: {step: 1/60 s}", 0.004)],
)
def test_cloth_drapes_over_a_ball_as_by_rk4(tmp_path, reference, solver, drift):
    rows = drape(tmp_path, solver)
    np.testing.assert_allclose(rows[-1][0], reference[-1][0], atol=1e-7)
    for positions, _ in rows:
        assert np.linalg.norm(positions, axis=1).min() > 0.61 - 1e-9
    energies = np.array([row[1] for row in rows])
    assert np.abs(energies - energies[0]).max() < drift * energies[0]
    # Euler's method loses throughout, those of order 2 may err in what impacts take.
    assert np.diff(energies).max() < (1e-12 if "euler" in solver else 1e-3) * energies[0]


@pytest.mark.parametrize("solver", ["radau: {tolerance: 1e-4}", "rodas5p: {tolerance: 1e-4}"])
def test_cloth_drapes_over_a_ball_between_steps(tmp_path, reference, solver):
    rows = drape(tmp_path, solver)
    np.testing.assert_allclose(rows[-1][0], reference[-1][0], atol=1e-7)
    for (positions, energy), (expected, _) in zip(rows, reference, strict=True):
        np.testing.assert_allclose(positions, expected, atol=1e-3)
        assert np.linalg.norm(positions, axis=1).min() > 0.61 - 1e-6
        assert energy == pytest.approx(rows[0][1], rel=2e-4)


def test_auto_takes_radau_once_the_cloth_hardly_moves(tmp_path, reference):
    path = tmp_path / "scene.yaml"
    path.write_text(DRAPE.format(solver="auto: {}"), encoding="utf-8")
    graph = load(path, pruned=False)
    march = IslandRun(graph, graph.islands[0]).march
    y, _ = march.advance(4.0)
    assert [why.partition(":")[0] for _, why in march.choices()] == ["dopri5", "radau"]
    places = np.linalg.norm(y[: 3 * 121].reshape(-1, 3) - reference[-1][0], axis=1)
    assert places.max() < 1e-7


def test_a_tie_that_pulls_is_let_go(tmp_path):
    """Gravity turns round after half a second: beads fly off the floor, and nothing holds them back."""
    script = """
clock: {end: 1 s}
models: {dust: {particles: {fill: {object: room, count: 100}, radius: 1 mm}}}
objects: {room: {box: {size: 1 0.002 1 m, position: 0 0.002 0 m, hidden: yes}}, floor: plane}
forces: {pull: {gravity: {acceleration: {x: 0 m/s^2, y: 20 m/s^3*(time - 0.5 s), z: 0 m/s^2}}}}
contacts: {hit: {collision: {between: [dust, floor], restitution: 0, mode: local}}}
solvers: {main: {SOLVER}}
"""
    for solver in BETWEEN:
        half, end = watch(tmp_path, script.replace("SOLVER", solver), [0.5, 1], "dust.positions")
        np.testing.assert_allclose(half[0][:, 1], 0.001, atol=1e-9)
        np.testing.assert_allclose(end[0][:, 1], 0.001 + 20 * 0.5**3 / 6, atol=1e-7)


def test_a_tie_that_asks_too_much_of_friction_is_let_go(tmp_path):
    """The pull grows beyond what friction holds: beads slide from that instant on, though many are let go at once."""
    script = """
clock: {end: 0.53 s}
models: {dust: {particles: {fill: {object: room, count: 100}, radius: 1 mm}}}
objects: {room: {box: {size: 1 0.002 1 m, position: 0 0.002 0 m, hidden: yes}}, floor: plane}
forces: {pull: {gravity: {acceleration: {x: "20 km/s^3*max(0 s, time - 0.5 s)", y: -10 m/s^2, z: 0 m/s^2}}}}
contacts: {hit: {collision: {between: [dust, floor], restitution: 0, friction: 0.5, mode: local}}}
solvers: {main: {SOLVER}}
"""
    way = 2e4 * (0.03 - 5 / 2e4) ** 3 / 6
    for solver in BETWEEN:
        early, end = watch(tmp_path, script.replace("SOLVER", solver), [0.4, 0.53], "dust.positions")
        np.testing.assert_allclose(end[0] - early[0], np.tile([way, 0, 0], (100, 1)), atol=1e-7)


@pytest.mark.parametrize("solver", BETWEEN)
def test_a_valley_of_two_slopes_holds_what_rests_on_both(tmp_path, solver):
    script = f"""
clock: {{end: 1 s}}
models: {{dust: {{particles: {{fill: {{object: room, count: 100}}, radius: 10 mm}}}}}}
objects:
  room: {{box: {{size: 0.1 0.1 1 m, position: 0 0.3 0 m, hidden: yes}}}}
  left: {{plane: {{normal: 1 1 0}}}}
  right: {{plane: {{normal: -1 1 0}}}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [dust, left, right], restitution: 0, mode: local}}}}}}
solvers: {{main: {{{solver}}}}}
"""
    outputs = ("dust.positions", "dust.velocities", "dust.energy")
    start, end = watch(tmp_path, script, [0, 1], *outputs)
    expected = start[0] * [0, 0, 1] + [0, 0.01 * np.sqrt(2), 0]
    np.testing.assert_allclose(end[0], expected, atol=1e-9)
    np.testing.assert_allclose(end[1], 0, atol=1e-9)
    assert end[2] == pytest.approx(start[2], rel=1e-3)


@pytest.mark.parametrize("solver", ["radau: {tolerance: 1e-4}", "rodas5p: {tolerance: 1e-4}"])
def test_a_flight_that_touches_nothing_is_as_smooth_within_steps_as_without_contacts(tmp_path, solver):
    script = f"""
clock: {{end: 0.1 s}}
models: {{m: {{mass_spring: {{masses: {{a: {{position: 1.1 0 0, mass: 1 kg}}, wall: {{position: 0 0 0, fixed: yes}}}},
  springs: [{{between: [a, wall], stiffness: {(80 * np.pi) ** 2} N/m, rest: 1 m}}]}}}}}}
objects: {{floor: {{plane: {{height: -5 m}}}}}}
contacts: {{hit: {{collision: {{between: [m, floor], mode: local}}}}}}
solvers: {{main: {{{solver}}}}}
"""
    times = np.linspace(0, 0.1, 401)
    x = np.array([row[0][0] for row in watch(tmp_path, script, times, "m.a.position")])
    np.testing.assert_allclose(x, 1 + 0.1 * np.cos(80 * np.pi * times), atol=2e-5)
