"""Fluids of several densities and viscosities in flows with solids in them, or around them."""

import numpy as np
import pytest

from flows import Air
from sceneql.quantities.diagnostic import ScriptError
from test_fillings import BOTTOM_HALF, FALLING, SLACK, filled

EDGES = ["cut_cell", "staircase"]
WALLED = "{}"


def with_pole(radius, at, objects=BOTTOM_HALF):
    return objects.replace("objects: {", f"objects: {{pole: {{sphere: {{radius: {radius} m, position: {at} m}}}}, ")


@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("height", [0.25, 0.76], ids=["in the heavy one", "in the light one"])
def test_layers_around_a_pole_rest_under_the_exact_pressure_of_what_they_weigh(tmp_path, height, edges):
    more = {"objects": with_pole(0.13, f"0.5 {height} 0"), "around": "[pole]", "edges": edges}
    air = filled(tmp_path, 1000.0, law=SLACK, forces=FALLING, boundary=WALLED, end=0.2, **more).at(0.2)
    heights = (np.arange(16) + 0.5) / 16
    exact = np.broadcast_to(-999.0 * 9.81 * np.minimum(heights, 0.5)[:, None], (16, 16))
    open_ = np.hypot(heights - 0.5, heights[:, None] - height) > 0.13 + 0.09
    off = (air.read("pressure").reshape(16, 16) - exact)[open_]
    assert np.ptp(off) < 1e-11 * np.ptp(exact)
    assert air.read("largest_speed") <= 1e-13


BY_NUMBER_AND_FORMULA = [("0.2 Pa*s", "{ark3: {step: 20 ms}}"), ('"0.2 + 0*x"', "{imex_midpoint: {step: 20 ms}}")]


def mean_speed(folder, cells, viscosity, solver, edges, deep=False):
    """Along a channel past a pole, or a ball, driven by a force."""
    air = Air(
        folder, solver, 0.4, cell=f"1/{cells} m", viscosity=viscosity, boundary="{left: {periodic: yes}}", edges=edges,
        models=with_pole(0.21, "0.52 0.47 " + ("0.5" if deep else "0"), "objects: {}\n").replace(", }", "}"),
        around="[pole]", force='"[1, 0*x, 0*x]"' if deep else '"[1, 0*x]"', size="1 1 1 m" if deep else "1 1 m",
    )  # fmt: skip
    return air.at(0.4).read("velocity")[:, 0].mean()


@pytest.mark.parametrize("edges", EDGES)
def test_a_viscosity_by_formula_comes_to_the_same_past_a_pole_as_a_number(tmp_path, edges):
    off = []
    for cells in (12, 24):
        one, other = (mean_speed(tmp_path, cells, *fluid, edges) for fluid in BY_NUMBER_AND_FORMULA)
        off.append(abs(other / one - 1.0))
    assert off[0] < 0.1
    assert off[1] < 0.65 * off[0]


def test_a_viscosity_by_formula_comes_to_the_same_past_a_ball_as_a_number(tmp_path):
    one, other = (mean_speed(tmp_path, 12, *fluid, "cut_cell", deep=True) for fluid in BY_NUMBER_AND_FORMULA)
    assert other == pytest.approx(one, rel=0.05)


@pytest.mark.parametrize("around", [False, True], ids=["beside the flow", "in the flow"])
def test_a_heavy_bag_rests_on_a_block_in_the_flow_as_on_one_that_is_none_of_it(tmp_path, around):
    egg = 'egg: {implicit: {field: "x^2 + y^2 - 0.0324", position: 0.5 0.32 0 m}}'
    ledge = "ledge: {box: {size: 3 1 1 m, position: 0.5 -0.4 0 m}}"
    air = filled(
        tmp_path, 1000.0, 80.0, "law: {springs: {stretch: 4000 N/m}}", cells=24, viscosity="0.08 Pa*s", end=1.4,
        forces=f"{FALLING}contacts: {{land: {{collision: {{between: [balloon, ledge]}}}}}}\n",
        objects=f"objects: {{{egg}, {ledge}}}\n", boundary=WALLED, **({"around": "[ledge]"} if around else {}),
    )  # fmt: skip
    sides = [np.ptp(air.at(time).read("positions", "balloon"), axis=0)[:2] for time in (1.1, 1.2, 1.3, 1.4)]
    # Of an elastic line around a weight that leans on a plane (its equation, solved apart).
    assert np.mean(sides, axis=0) == pytest.approx([0.46532072, 0.26211314], rel=0.01)
    assert air.read("volume_correction", "balloon") < 0.02 * air.read("volume", "balloon")


def test_a_heavy_skin_sinks_in_a_round_domain_and_stays_in_it(tmp_path):
    bowl = "bowl: {sphere: {radius: 0.5 m, position: 0.5 0.5 0 m}}"
    egg = 'egg: {implicit: {field: "x^2 + y^2 - 0.04", position: 0.5 0.6 0 m}}'
    air = filled(
        tmp_path, 10.0, law="law: {springs: {stretch: 40 N/m}}", boundary=WALLED, size=None, domain="bowl", flat="yes",
        objects=f"objects: {{{egg}, {bowl}}}\n", forces=FALLING, end=0.6,
    )  # fmt: skip
    at = [air.at(time).read("center", "balloon")[1] for time in (0.0, 0.1, 0.2, 0.6)]
    assert np.all(np.diff(at) < 0.0)
    assert at[0] - at[1] < 0.5 * 9.81 * 0.1**2 * 9 / 11  # slower than without walls and viscosity
    assert np.hypot(*(air.read("positions", "balloon")[:, :2] - 0.5).T).max() < 0.5


def test_what_cannot_be_beside_solids_is_told(tmp_path):
    objects = with_pole(0.1, "{keys: {0 s: 0.8 0.5 0 m, 1 s: 0.8 0.6 0 m}}")
    objects = objects.replace("}} m}", "}}}").replace(
        BOTTOM_HALF[10:], "egg: {sphere: {radius: 0.2 m, position: 0.3 0.5 0 m}}}\n"
    )
    with pytest.raises(ScriptError, match="walls of solids in the flow move, and skins in it hold other fluids"):
        filled(tmp_path, 10.0, objects=objects, around="[pole]", boundary=WALLED)
    still = with_pole(0.1, "0.5 0.76 0")
    air = filled(tmp_path, 10.0, objects=still, around="[pole]", boundary=WALLED, law=SLACK).at(0.0)
    with pytest.raises(ValueError, match="the force on a solid is not known in a flow whose density"):
        air.read("pole.force")
