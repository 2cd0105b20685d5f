"""Local contacts within the steps of implicit solvers: nothing sinks in, friction holds, what rests is still."""

import numpy as np
import pytest

from runs import watch
from sceneql.failure import LimitRefused

G = 9.81
SOLVERS = (
    "implicit_euler: {step: 1/120 s}",
    "bdf2: {step: 1/120 s}",
    "tr_bdf2: {step: 1/120 s}",
    "implicit_midpoint: {step: 1/120 s}",
)
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


@pytest.mark.parametrize("solver", SOLVERS)
def test_on_a_slope_a_sheet_slides_if_it_is_steeper_than_friction_holds(tmp_path, solver):
    # tan(angle) = 3/4.
    normal = np.array([0.6, 0.8, 0])
    down = np.array([0.8, -0.6, 0])
    for friction in (0.0, 0.5, 0.74, 0.76):
        slope = "{plane: {normal: 3 4 0}}"
        script = sheet(solver, 0.5, "0.006 0.008 0 m", friction, slope, "3 4 0")
        early, late = watch(tmp_path, script, [0.25, 0.5], "sheet.positions", "sheet.velocities")
        faster = max(0.0, 0.6 - friction * 0.8) * G * 0.25
        np.testing.assert_allclose(late[1] - early[1], np.tile(down * faster, (100, 1)), atol=1e-8)
        np.testing.assert_allclose(late[0] @ normal, 0.01, atol=1e-9)
        if friction > 0.75:
            np.testing.assert_allclose(late[1], 0, atol=1e-9)


@pytest.mark.parametrize("word", ["implicit_euler", "bdf2"])
@pytest.mark.parametrize(
    "wall", ["{box: {size: 0.001 9 9 m}}", "{plane: {normal: -1 0 0}}", "{sphere: {radius: 2 m, position: 2 0 0 m}}"]
)
def test_nothing_passes_a_wall_at_500_m_s(tmp_path, word, wall):
    script = f"""
clock: {{end: 0.2 s}}
models: {{dust: {{particles: {{fill: {{object: room, count: 100}}, velocity: 500 0 0 m/s, radius: 1 mm}}}}}}
objects: {{room: {{box: {{size: 1 1 1 m, position: -3 0 0 m}}}}, wall: {wall}}}
contacts: {{hit: {{collision: {{between: [dust, wall], restitution: 0, mode: local}}}}}}
solvers: {{main: {{{word}: {{step: 10 ms}}}}}}
"""
    rows = watch(tmp_path, script, [0.01, 0.02, 0.2], "dust.positions", "hit.hits.count")
    for positions, _ in rows:
        if "sphere" in wall:
            assert np.linalg.norm(positions - [2, 0, 0], axis=1).min() > 2
        else:
            assert positions[:, 0].max() < 0
    assert rows[-1][1] >= 100


def test_bounces_reach_their_heights(tmp_path):
    script = """
clock: {end: 1 s}
models: {dust: {particles: {fill: {object: room, count: 100}, radius: 10 mm}}}
objects: {room: {box: {size: 1 1 1 m, position: 0 1.5 0 m}}, floor: plane}
forces: [gravity]
contacts: {hit: {collision: {between: [dust, floor], restitution: 0.8, mode: local}}}
solvers: {main: {bdf2: {step: 1 ms}}}
"""
    start, end = watch(tmp_path, script, [0, 1], "dust.positions", "hit.hits.count")
    height = start[0][:, 1] - 0.01
    fall = np.sqrt(2 * height / G)
    apart = 1 - fall
    expected = 0.01 + 0.8 * np.sqrt(2 * G * height) * apart - G * apart**2 / 2
    once = (apart > 0) & (apart < 1.6 * fall)
    assert once.sum() > 50
    np.testing.assert_allclose(end[0][once, 1], expected[once], atol=0.01)


DRAPE = """clock: {{end: 4 s}}
models:
  sheet: {{cloth: {{size: 0.8 0.8 m, cells: 10 10, center: 0 0.61 0 m, stretch: 400 N/m, shear: 100 N/m,
    bend: 40 N/m, damping: 0.2, thickness: 20 mm, pins: [60]}}}}
objects: {{ball: {{sphere: {{radius: 0.6 m}}}}}}
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


def test_a_solver_without_such_stages_refuses_many_masses(tmp_path):
    script = sheet("rodas5p: {}", 1, "0 0.2 0 m")
    with pytest.raises(LimitRefused, match="hit gives no slopes"):
        watch(tmp_path, script, [0.1], "sheet.energy")
