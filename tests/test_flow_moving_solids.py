"""Solids that move through a flow: drag as that of the same in a stream, added mass, torque, errors."""

import math

import numpy as np
import pytest

from flows import Air
from sceneql.quantities.diagnostic import ScriptError

SPIN = "objects: {drum: {sphere: {position: 0.5 0.5 0 m, radius: 0.2 m}}}\n"
TURNED = (
    "objects: {drum: {sphere: {position: 0.5 0.5 0 m, radius: 0.2 m, rotation: {about: z, angle: 0.5 rad/s*time}}}}\n"
)


def drawn(folder, moves, step=4e-3, solver="heun"):
    """A cylinder, eight cells across, in a periodic channel, drawn at 1 m/s or in a stream of that speed."""
    place = "[0.4 m + 1 m/s*time, 0.263 m, 0 m]" if moves else "0.4 0.263 0 m"
    wall = '{wall: {velocity: "[-1, 0]"}}'
    steps = "" if step is None else f"step: {step} s"
    return Air(
        folder, f"{{{solver}: {{{steps}}}}}", 0.6, size="1.2 0.5 m", cell="1/40 m", viscosity="0.025 Pa*s",
        before=f"objects: {{cyl: {{sphere: {{position: {place}, radius: 0.1 m}}}}}}\n", around="[cyl]",
        advection="central", initial=None if moves else '{velocity: "[-1 + 0*x, 0*x]"}',
        boundary="{left: {periodic: yes}}" if moves else f"{{left: {{periodic: yes}}, bottom: {wall}, top: {wall}}}",
    )  # fmt: skip


def drags(air, times):
    return np.array([air.at(float(now)).read("cyl.force")[0] for now in times])


def test_a_cylinder_drawn_through_a_fluid_at_rest_has_the_drag_of_one_in_a_stream(tmp_path):
    """Galileo; between two cells' crossings too: four of them lie between the first time and the last."""
    times = 0.2 + 0.0073 * np.arange(15)
    still, moving = drags(drawn(tmp_path, False), times), drags(drawn(tmp_path, True), times)
    apart = moving / still - 1.0
    assert abs(apart.mean()) < 0.015
    assert np.abs(apart).max() < 0.03
    assert np.isfinite(still).all()


def test_a_ball_drawn_through_a_deep_box_has_the_drag_of_one_in_a_stream(tmp_path):
    """Galileo again, between four walls; six cells across."""

    def drag(moves):
        wall = '{wall: {velocity: "[-1, 0, 0]"}}'
        walls = "" if moves else "".join(f", {side}: {wall}" for side in ("bottom", "top", "back", "front"))
        place = "[0.35 m + 1 m/s*time, 0.513 m, 0.487 m]" if moves else "0.35 0.513 0.487 m"
        air = Air(
            tmp_path, "{heun: {step: 5 ms}}", 0.2, size="1 1 1 m", around="[ball]", advection="central",
            before=f"objects: {{ball: {{sphere: {{position: {place}, radius: 0.2 m}}}}}}\n",
            initial=None if moves else '{velocity: "[-1 + 0*x, 0*x, 0*x]"}',
            boundary=f"{{left: {{periodic: yes}}{walls}}}",
        )  # fmt: skip
        return np.array([air.at(float(now)).read("ball.force")[0] for now in 0.12 + 0.0173 * np.arange(4)])

    apart = drag(True) / drag(False) - 1.0
    assert abs(apart.mean()) < 0.01
    assert np.abs(apart).max() < 0.02


def test_steps_by_error_leave_out_what_solids_leave_and_come_to(tmp_path):
    """It has no order: of 106 steps 30 were refused for it, where 70 do."""
    air = drawn(tmp_path, True, step=None, solver="ark3").at(0.15)
    done = air.run.march.statistics
    assert done.rejected < 0.3 * done.steps
    assert done.steps < 66


def test_a_cylinder_that_starts_has_the_added_mass_of_its_own_volume(tmp_path):
    """density pi a^2 acceleration in all the plane (Lamb 1932, art. 68); between walls at 15 radii 1 + 2/15^2 of it."""
    before = "objects: {cyl: {sphere: {position: [0.01 m + 0.5*3 m/s^2*time*time, 0.013 m, 0 m], radius: 0.1 m}}}\n"
    air = Air(
        tmp_path, before=before, size="3 3 m", corner="-1.5 -1.5 m", cell="1/48 m", density="2 kg/m^3",
        viscosity="0 Pa*s", around="[cyl]",
    ).at(0.0)  # fmt: skip
    force = air.read("cyl.force")
    assert force[0] == pytest.approx(-2.0 * math.pi * 0.1**2 * 3.0 * (1.0 + 2.0 / 15.0**2), rel=0.02)
    assert abs(force[1]) < 0.01 * abs(force[0])


@pytest.mark.parametrize("solver", ["{rk4: {step: 5 ms}}", "{ark3: {step: 10 ms}}"])
def test_a_drum_that_turns_by_its_rotation_is_one_whose_wall_has_that_velocity(tmp_path, solver):
    """Cut by kernels in every step, and once by NumPy, whose normals are differences over a cell."""
    more = {"around": "[drum]", "cell": "1/20 m", "density": "2 kg/m^3", "viscosity": "0.02 Pa*s"}
    skin = '{drum: {wall: {velocity: "[-0.5*(y - 0.5), 0.5*(x - 0.5)]"}}}'
    one = Air(tmp_path, solver, before=TURNED, **more).at(0.1)
    other = Air(tmp_path, solver, before=SPIN, boundary=skin, **more).at(0.1)
    assert one.read("drum.torque")[2] == pytest.approx(other.read("drum.torque")[2], rel=4e-3)
    assert one.read("kinetic_energy") == pytest.approx(other.read("kinetic_energy"), rel=1e-2)
    outside = np.hypot(*(one.read("centers")[:, :2] - 0.5).T) > 0.27
    assert np.abs(one.read("speed") - other.read("speed"))[outside].max() < 5e-3 * 0.1


def test_what_a_solid_pushes_away_in_a_closed_box_comes_back_behind_it(tmp_path):
    before = "objects: {cyl: {sphere: {position: [0.5 m + 0.2 m*sin(4*time/(1 s)), 0.47 m, 0 m], radius: 0.11 m}}}\n"
    air = Air(tmp_path, "{sbdf2: {step: 5 ms}}", 0.5, before=before, around="[cyl]", cell="1/24 m").at(0.5)
    assert air.read("divergence") < 1e-8 * 0.8 * 24
    assert 0.1 < air.read("largest_speed") < 2.0


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"edges": "staircase"}, "a staircase would jump"),
        ({"pressure": "direct"}, "would factor anew"),
        ({"boundary": '{drum: {wall: {velocity: "[-y, x]"}}}'}, "has the velocity of its own motion"),
    ],
)
def test_what_does_not_go_with_solids_that_move_is_told(tmp_path, fields, text):
    with pytest.raises(ScriptError, match=text):
        Air(tmp_path, before=TURNED, around="[drum]", **fields)


def test_a_solid_that_leaves_a_closed_box_is_told(tmp_path):
    before = "objects: {cyl: {sphere: {position: [0.98 m + 1 m/s*time, 0.5 m, 0 m], radius: 0.1 m}}}\n"
    with pytest.raises(ScriptError, match="moves through a side of a closed box"):
        Air(tmp_path, before=before, around="[cyl]")


def test_multigrid_takes_the_pressure_of_cells_that_are_cut_anew(tmp_path):
    before = "objects: {cyl: {sphere: {position: [0.4 m + 1 m/s*time, 0.5 m, 0 m], radius: 0.15 m}}}\n"
    found = [
        Air(tmp_path, "{rk4: {step: 5 ms}}", before=before, around="[cyl]", pressure=name).at(0.1)
        for name in ("auto", "multigrid")
    ]
    assert found[0].read("cyl.force") == pytest.approx(found[1].read("cyl.force"), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("solver", ["{rk4: {step: 5 ms}}", "{sbdf2: {step: 5 ms}}"])
def test_dye_beside_a_solid_that_moves_stays_what_it_is(tmp_path, solver):
    """Evenly spread it stays so; what there is stays but for the error of a step."""
    before = "objects: {cyl: {sphere: {position: [0.5 m + 0.2 m*sin(4*time/(1 s)), 0.47 m, 0 m], radius: 0.11 m}}}\n"
    dye = '{diffusion: {size: 1 1 m, cell: 1/20 m, of: number, coefficient: 1e-4 m^2/s, initial: "START", '
    models = "".join(
        f"  {name}: {dye.replace('START', start)}drift: {{by: air}}}}}}\n"
        for name, start in (("even", "1 + 0*x"), ("half", "where(x > 0.5, 1, 0)"))
    )
    more = {"around": "[cyl]", "cell": "1/20 m", "viscosity": "0.01 Pa*s"}
    air = Air(tmp_path, solver, 0.6, before=before, models=models, **more).at(0.0)
    half = air.read("mass", "half")
    air.at(0.6)
    assert np.abs(air.read("concentration", "even") - 1.0).max() < 5e-3
    assert air.read("mass", "half") - air.read("inflow", "half") == pytest.approx(half, rel=1e-12)
    assert abs(air.read("inflow", "half")) < 3e-3 * half


def test_steps_are_as_long_as_a_solid_that_moves_unevenly_lets_them_be(tmp_path):
    """A quarter of a cell each, along all axes: of its middle, and of the corners of one that turns in its place."""
    swings = "[0.5 m + 0.1 m*sin(2*time/(1 s)), 0.5 m, 0 m]"
    turns = "0.5 0.5 0 m, rotation: {about: z, angle: 60 deg*sin(2*time/(1 s))}"
    for place, cells in ((swings, 0.2 * 16), (turns, 2.0 * math.pi / 3.0 * 0.2 * math.sqrt(2) * 1.4 * 16)):
        before = f"objects: {{drum: {{box: {{size: 0.4 0.4 1 m, position: {place}}}}}}}\n"
        air = Air(tmp_path, "{auto: {}}", 1.0, before=before, around="[drum]")
        assert air.run.march.system.largest_step == pytest.approx(0.25 / cells, rel=0.05)


def test_a_solid_that_shakes_fast_bounds_the_steps(tmp_path):
    """Its places in even intervals of the run are always the same."""
    before = "objects: {drum: {box: {size: 0.4 0.4 1 m, position: '[0.5 m + 1 cm*sin(80*pi*time/(1 s)), 0.5 m, 0]'}}}\n"
    air = Air(tmp_path, "{auto: {}}", 1.0, before=before, around="[drum]")
    cells = 80 * math.pi * 0.01 * 16
    assert air.run.march.system.largest_step == pytest.approx(0.25 / cells, rel=0.05)
