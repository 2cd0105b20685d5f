"""Solids in a flow whose walls move along themselves, and what cut cells make of shapes that meet the grid."""

import numpy as np
import pytest

from flows import Air
from sceneql.flows.schemes.multistep import operators_of
from sceneql.flows.schemes.operators_kernels import EXACT
from sceneql.quantities.diagnostic import ScriptError

INNER, OUTER, SPEEDS = 0.35, 0.8, (1.0, -0.5)
B = (SPEEDS[0] - SPEEDS[1]) * INNER**2 * OUTER**2 / (OUTER**2 - INNER**2)
A = (SPEEDS[1] * OUTER**2 - SPEEDS[0] * INNER**2) / (OUTER**2 - INNER**2)
TUBE = "{box: [[-2, -2, -1], [2, 2, 1]]}"


def between_cylinders(folder, cells, solver="{ark3: {step: 20 ms}}"):
    """Couette's flow between turning cylinders, steady: root mean square of its error, both torques over exact ones."""
    x0, y0 = 0.013, 0.007
    skins = ", ".join(
        f'{name}: {{wall: {{velocity: "[{-w}*(y - {y0}), {w}*(x - {x0})]"}}}}'
        for name, w in zip(("drum", "tube"), SPEEDS, strict=True)
    )
    objects = (
        f"objects:\n  drum: {{sphere: {{radius: {INNER} m, position: {x0} {y0} 0 m}}}}\n"
        f'  tube: {{implicit: {{field: "{OUTER} - sqrt((x - {x0})^2 + (y - {y0})^2)", bounds: {TUBE}}}}}\n'
    )
    air = Air(
        folder, solver, 2.0, before=objects, size="2 2 m", corner="-1 -1 m", cell=f"{2 / cells} m",
        around="[drum, tube]", density="2 kg/m^3", viscosity="1 Pa*s", boundary=f"{{{skins}}}",
    ).at(2.0)  # fmt: skip
    x, y = (air.read("centers")[:, :2] - [x0, y0]).T
    r = np.hypot(x, y)
    exact = (A + B / np.maximum(r, 0.1) ** 2)[:, None] * np.stack([-y, x], axis=1)
    there = (r > INNER + 2 / cells) & (r < OUTER - 2 / cells)
    error = np.linalg.norm(air.read("velocity")[:, :2] - exact, axis=1)[there]
    torques = air.read("drum.torque")[2] / (-4 * np.pi * B), air.read("tube.torque")[2] / (4 * np.pi * B)
    return np.sqrt(np.mean(error**2)), torques


def test_flow_between_turning_cylinders_and_their_torques(tmp_path):
    """u = A r + B/r; the torque 4 pi mu B a length needs both parts of the stress."""
    rough, _ = between_cylinders(tmp_path, 24)
    fine, torques = between_cylinders(tmp_path, 48)
    assert fine < 0.006
    assert fine < 0.45 * rough
    assert torques == pytest.approx((1, 1), abs=0.03)


def test_a_drum_in_the_middle_of_a_channel_is_lifted_by_its_turning_alone(tmp_path):
    """Level sets that touch corners of cells are cut alike on both sides, whatever the rounding."""

    def lift(turn):
        skin = f', drum: {{wall: {{velocity: "[{-turn}*(y - 1), {turn}*(x - 1)]"}}}}' if turn else ""
        return Air(
            tmp_path, "{sbdf2: {step: 30 ms}}", 0.6, size="3 2 m", cell="0.1 m", viscosity="0.3 Pa*s", around="[drum]",
            before="objects: {drum: {sphere: {position: 1 1 0 m, radius: 0.3 m}}}\n", advection="central",
            boundary='{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}, top: {wall: {slip: free}}, '
            f"bottom: {{wall: {{slip: free}}}}{skin}}}",
        ).at(0.6).read("drum.force")  # fmt: skip

    still, left, right = lift(0), lift(2), lift(-2)
    assert abs(still[1]) < 1e-9 * still[0]
    assert left[1] < -0.01 * still[0]  # Magnus: to the side where the drum goes along with the stream
    assert right[1] == pytest.approx(-left[1], rel=1e-6)


@pytest.mark.parametrize(
    ("skin", "text"),
    [
        ('wall: {velocity: "[1, 0]"}', "leads through that of the solid"),
        ('wall: {velocity: "[-y*t, x*t]"}', "does not vary in time"),
        ('wall: {velocity: "[-y, x, 0]"}', "needs 2 components"),
        ("wall: {slip: free}", "a whole `wall` with a `velocity`"),
        ("outflow: {}", "a whole `wall` with a `velocity`"),
    ],
)
def test_the_skin_of_a_solid_that_is_no_wall_along_itself_is_refused(tmp_path, skin, text):
    ball = "objects: {drum: {sphere: {radius: 0.3 m}}}\n"
    with pytest.raises(ScriptError, match=text):
        Air(tmp_path, before=ball, size="2 2 m", corner="-1 -1 m", around="[drum]", boundary=f"{{drum: {{{skin}}}}}")


@pytest.mark.parametrize(
    ("fields", "exact"),
    [
        ({}, [True, True]),
        (
            {"boundary": '{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}, top: {wall: {slip: free}}}'},
            [True, True],
        ),
        ({"boundary": "{left: {periodic: yes}, bottom: {wall: {slip: 0.1 m}}}"}, [False, True]),
        ({"boundary": '{left: {outflow: {}, where: "y - 0.5"}}'}, [False, False]),
        (
            {"around": "[ball]", "before": "objects: {ball: {sphere: {position: 0.5 0.5 0 m, radius: 0.2 m}}}\n"},
            [False, False],
        ),
    ],
)
def test_transforms_solve_viscosity_where_they_are_exact_and_iterations_elsewhere(tmp_path, fields, exact):
    air = Air(tmp_path, "{sbdf2: {step: 5 ms}}", **fields)
    operators = operators_of(air.run.march.system)[1]
    assert [op[EXACT] == 1 for op in operators] == exact
