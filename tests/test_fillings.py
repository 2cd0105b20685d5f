"""Fluids of several densities and viscosities: `filling` of skins, `viscosity` by a formula."""

import numpy as np
import pytest

from flows import WAVES, Air, waves
from sceneql.flows.varying import fluid_layout
from sceneql.quantities.diagnostic import ScriptError
from skins import ballooned

FALLING = "forces: [gravity, {immersion: {on: [balloon], in: air}}]\n"
WALLED = "{}"
SLACK = "law: {springs: {stretch: 1 N/m}}"
BOTTOM_HALF = "objects: {egg: {outline: {points: [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]}}}\n"


def filled(folder, heavy, thick=0.05, law="law: {springs: {stretch: 4 N/m}}, prestress: 1 N/m", **more):
    """A skin `balloon` around a fluid of its own in a flow `air` of 1 m."""
    more = {"solver": "{auto: {}}", **more}
    filling = f"filling: {{density: {heavy!r} kg/m^3, viscosity: {thick!r} Pa*s}}"
    return ballooned(folder, f"{law}, {filling}", **more)


def masses(air):
    """The mass in each face's own cell, component after component, and the state's floats."""
    flow = air.run.march.system.fields.flow
    at = flow.varying[fluid_layout.MASSES]
    sizes = [int(np.prod(grid.cells.shape)) for grid in flow.components]
    found = air.run.state("air").floats[at : at + sum(sizes)]
    return np.split(found, np.cumsum(sizes)[:-1])


@pytest.mark.parametrize("boundary", [WAVES, WALLED], ids=["periodic", "walls"])
def test_the_mass_in_cells_is_what_the_drawn_line_cuts_off(tmp_path, boundary):
    # Round the box where that is periodic: a third of the ellipse stands beyond its high sides.
    at = "0.9 0.95" if boundary == WAVES else "0.45 0.6"
    air = filled(tmp_path, 11.0, at=at, boundary=boundary, cells=13).at(0.0)
    area = air.read("volume", "balloon")
    for mass in masses(air):
        assert mass.sum() == pytest.approx(1.0 + 10.0 * area, rel=1e-13)
        assert mass.min() >= 0.5 / 13**2 * (1 - 1e-12)
        assert mass.max() <= 11.0 / 13**2 * (1 + 1e-12)


def test_a_rectangle_that_cuts_cells_leaves_the_exact_part_of_each(tmp_path):
    objects = "objects: {egg: {outline: {points: [[0.23, 0.31], [0.71, 0.31], [0.71, 0.84], [0.23, 0.84]]}}}\n"
    air = filled(tmp_path, 3.0, cells=10, objects=objects, boundary=WALLED, spacing="1 mm").at(0.0)
    mass = masses(air)[0].reshape(10, 11)  # of the faces across x, whose own cells lie around i h

    def inside(low, high, a, b):
        return np.maximum(np.minimum(high, b) - np.maximum(low, a), 0.0)

    i, j = np.arange(11) / 10, np.arange(10) / 10
    along = inside(np.maximum(i - 0.05, 0.0), np.minimum(i + 0.05, 1.0), 0.23, 0.71)
    exact = inside(j, j + 0.1, 0.31, 0.84)[:, None] * along
    whole = 0.1 * (np.minimum(i + 0.05, 1.0) - np.maximum(i - 0.05, 0.0))
    # The vertices stand evenly, and so up to half a millimeter off the four corners.
    assert mass == pytest.approx(np.broadcast_to(whole, mass.shape) + 2.0 * exact, abs=2.0 * 0.25e-6 * 2)


def test_a_rate_asked_for_once_more_and_after_another_is_the_same(tmp_path):
    air = filled(tmp_path, 10.0, forces=FALLING, boundary=WALLED).at(0.05)
    march, skin = air.run.march, air.tasks["balloon"].kind.made.membrane
    y, floats, rates = air.run.state("air").y.copy(), march.floats.copy(), []
    for shift in (0.0, 0.0, 0.013, 0.0):
        moved, rate = y.copy(), np.zeros(len(y))
        moved[skin.position_at : skin.position_at + 3 * skin.count : 3] += shift
        march.driver.rate(0.05, moved, rate, floats, march.system.ints)
        rates.append(rate)
    assert np.abs(rates[0]).max() > 1.0
    assert (rates[1] == rates[0]).all()
    assert np.abs(rates[2] - rates[0]).max() > 0.1
    assert (rates[3] == rates[0]).all()


@pytest.mark.parametrize("density", [1000.0, 1.0])
def test_layers_rest_under_the_exact_pressure_of_what_they_weigh(tmp_path, density):
    air = filled(tmp_path, density, law=SLACK, forces=FALLING, objects=BOTTOM_HALF, boundary=WALLED, end=0.2).at(0.2)
    heights = (np.arange(16) + 0.5) / 16
    exact = -(density - 1.0) * 9.81 * np.minimum(heights, 0.5)  # beyond the weight of the flow's own fluid
    pressure = air.read("pressure").reshape(16, 16)
    assert pressure == pytest.approx(np.broadcast_to((exact - exact.mean())[:, None], (16, 16)), rel=1e-11, abs=1e-11)
    assert air.read("largest_speed") <= (1e-13 if density > 1.0 else 0.0)


@pytest.mark.parametrize("density", [3.0, 1000.0])
def test_a_heavy_circle_begins_to_fall_against_the_inertia_of_what_is_around_it(tmp_path, density):
    found = []
    for cells in (24, 48):
        air = filled(
            tmp_path, density, 1e-5, "law: {springs: {stretch: 1e-3 N/m}}", formula="x^2 + y^2 - 0.01", cells=cells,
            forces=FALLING, boundary=WALLED, viscosity="1e-5 Pa*s", solver="{imex_midpoint: {step: 2 ms}}", end=0.01,
        )  # fmt: skip
        before = air.at(0.0).read("center", "balloon")[1]
        found.append(2.0 * (air.at(0.01).read("center", "balloon")[1] - before) / 0.01**2)
    exact = -9.81 * (density - 1.0) / (density + 1.0)  # a cylinder takes as much of the fluid along as it displaces
    # Walls four radii off add (1/4)^2 pi^2/6 to that in the mean (images of the dipole), of the light fluid alone.
    drawn = 2.0 * found[1] - found[0]  # of first order: velocities that slip past each other are smeared over a cell
    assert drawn == pytest.approx(exact, rel=0.03 if density < 10.0 else 2e-3)
    assert abs(found[1] - exact) < 0.6 * abs(found[0] - exact) + 2e-3 * abs(exact)


@pytest.mark.parametrize("solver", ["{imex_midpoint: {step: 4 ms}}", "{chorin: {step: 4 ms}}", "{auto: {}}"])
@pytest.mark.parametrize("ratio", [10.0, 1000.0])
def test_momentum_and_what_is_drawn_stay(tmp_path, solver, ratio):
    stream = '{stream_function: "0.05*(cos(2*pi*x) + cos(2*pi*y)) + 0.3*y"}'
    air = filled(tmp_path, ratio, 0.01 * ratio, solver=solver, initial=stream, advection="koren", end=0.1)
    air.at(0.0)
    momentum, area = air.read("momentum"), air.read("volume", "balloon")
    energy = air.read("kinetic_energy") + air.read("potential", "balloon")
    air.at(0.1)
    assert air.read("momentum") == pytest.approx(momentum, abs=1e-11 * abs(momentum).max())
    assert air.read("volume", "balloon") == pytest.approx(area, rel=1e-12)
    assert air.read("kinetic_energy") + air.read("potential", "balloon") < 1.005 * energy


def test_fluid_a_thousand_times_as_heavy_falls_through_air_without_noise(tmp_path):
    law = "law: {springs: {stretch: 60 N/m}}, prestress: 4 N/m"
    air = filled(
        tmp_path, 1400.0, 5.0, law, formula="x^2 + y^2 - 0.04", at="0.5 0.9", size="1 1.25 m", cells=24, end=0.3,
        forces=FALLING, boundary=WALLED, density="1.2 kg/m^3", viscosity="1.8e-5 Pa*s", advection="koren",
    )  # fmt: skip
    for time in (0.1, 0.2, 0.3):
        air.at(time)
        fallen = 0.9 - air.read("center", "balloon")[1]
        assert fallen == pytest.approx(0.5 * 9.81 * time**2, rel=0.01)  # as if there were no air
    assert air.read("center", "balloon")[0] == pytest.approx(0.5, abs=1e-5)
    assert air.read("stretch", "balloon") < 1.03  # nothing crumples it
    radii = np.hypot(*(air.read("positions", "balloon") - air.read("center", "balloon"))[:, :2].T)
    bends = np.diff(radii, 2, append=radii[:1], prepend=radii[-1:])
    assert np.abs(bends).max() < 1e-3 * 0.2


@pytest.mark.parametrize("ratio", [10.0, 1000.0])
def test_a_full_circle_of_one_tension_rests_under_the_pressure_of_laplace(tmp_path, ratio):
    off = []
    for cells in (16, 32):
        air = filled(
            tmp_path, ratio, 0.1 * ratio, formula="x^2 + y^2 - 0.0625", at="0.51 0.51", cells=cells,
            viscosity="0.1 Pa*s", end=0.5,
        ).at(0.5)  # fmt: skip
        off.append(air.read("pressure_jump", "balloon") * air.read("area", "balloon") / (2.0 * np.pi) - 1.0)
    assert abs(off[0]) < 2e-2
    assert abs(off[1]) < 5e-3


def test_flow_along_two_layers_of_unequal_viscosity_is_exact(tmp_path):
    air = Air(
        tmp_path, "{auto: {}}", 400.0, size="0.25 1 m", viscosity='"where(y < 0.25, 1, 0.01)"',
        boundary="{left: {periodic: yes}}", force='"[1, 0]"',
    ).at(400.0)  # fmt: skip
    y, h = (np.arange(16) + 0.5) / 16, 0.25
    top = (h**2 / 2 + (1 - h**2) / 2 / 0.01) / (h + (1 - h) / 0.01)  # the stress is top - y
    exact = np.where(y < h, top * y - y**2 / 2, (-top * (1 - y) + (1 - y**2) / 2) / 0.01)
    # The stress at a wall is by half a cell: that leaves what a parabola errs by there, and nothing else.
    exact += np.where(y < h, 1.0, 1.0 / 0.01) / (8 * 16**2)
    u = air.read("velocity").reshape(16, 4, 3)[:, :, 0]
    assert u == pytest.approx(np.broadcast_to(exact[:, None], u.shape), rel=5e-4)


def test_a_formula_of_one_viscosity_is_that_viscosity(tmp_path):
    plain = waves(tmp_path, 16, "{rk4: {step: 10 ms}}", 0.1).at(0.1)
    formed = waves(tmp_path, 16, "{rk4: {step: 10 ms}}", 0.1, viscosity='"0.1 + 0*x"').at(0.1)
    assert formed.read("velocity") == pytest.approx(plain.read("velocity"), rel=1e-12, abs=1e-12)


def test_the_midpoint_is_of_second_order(tmp_path):
    def at(step):
        air = waves(
            tmp_path, 12, f"{{imex_midpoint: {{step: {step} ms}}}}", 0.4, viscosity='"0.1*(1 + 0.5*sin(x + t))"'
        )
        return air.at(0.4).read("velocity")

    fine = at(2.5)
    errors = [np.abs(at(step) - fine).max() for step in (40, 20)]
    assert 1.85 < np.log2(errors[0] / errors[1]) < 2.3


def test_viscosity_that_varies_in_time_lets_velocities_decay_by_its_integral(tmp_path):
    air = waves(tmp_path, 24, "{imex_midpoint: {step: 5 ms}}", 0.4, viscosity='"0.1*(1 + t)"').at(0.4)
    plain = waves(tmp_path, 24, "{imex_midpoint: {step: 5 ms}}", 0.4, viscosity='"0.12 + 0*x"').at(0.4)
    assert air.read("velocity") == pytest.approx(plain.read("velocity"), rel=1e-4, abs=1e-6)


def warmed(folder, cells, solver, end, viscosity="exp(-2*c)", **more):
    """Between plates a meter apart, whose field `heat.temperature` is 0 below and 1 above; the upper one moves."""
    box = {"size": "0.5 1 m", "cell": f"1/{cells} m"}
    said = "of: temperature, coefficient: 1e-3 m^2/s, initial: y, drift: {by: air}"
    said += f", size: 0.5 1 m, cell: 1/{cells} m, boundary: "
    heat = f"  heat: {{diffusion: {{{said}{{bottom: {{value: 0}}, top: {{value: 1}}, left: {{periodic: yes}}}}}}}}\n"
    more = {"boundary": '{left: {periodic: yes}, top: {wall: {velocity: "[1, 0]"}}}', **more}
    by = {"viscosity": f'"{viscosity}"', "viscosity_by": "heat.temperature"}
    return Air(folder, solver, end, models=heat, **box, **by, **more).at(end)


def test_fluid_that_is_thin_where_it_is_warm_is_sheared_there(tmp_path):
    """The stress is the same everywhere: u = (exp(2 y) - 1)/(exp(2) - 1), of second order in the cells."""
    errors = []
    for cells in (8, 16):
        air = warmed(tmp_path, cells, "{imex_midpoint: {tolerance: 1e-5}}", 8.0)
        y, u = air.read("centers")[:, 1], air.read("velocity")[:, 0]
        errors.append(np.abs(u - np.expm1(2 * y) / np.expm1(2)).max())
    assert errors[1] < 2.5e-3
    assert np.log2(errors[0] / errors[1]) > 1.85


def test_viscosity_by_a_field_is_read_where_the_field_is_now(tmp_path):
    """Of second order in time, while a swirl carries the field that thickens it."""

    def at(step):
        swirl = '{velocity: "[sin(2*pi*y)*cos(4*pi*x), -2*sin(pi*y)^2*sin(4*pi*x)]"}'
        return warmed(
            tmp_path, 12, f"{{imex_midpoint: {{step: {step} ms}}}}", 0.16, viscosity="0.02*(1 + 4*c)", initial=swirl
        ).read("velocity")

    fine = at(1)
    errors = [np.abs(at(step) - fine).max() for step in (16, 8)]
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.4


@pytest.mark.parametrize("solver", ["{ark3: {}}", "{sbdf2: {step: 1 ms}}", "{cnab2: {step: 1 ms}}"])
def test_solvers_of_one_density_refuse_several(tmp_path, solver):
    with pytest.raises(ScriptError, match="density or viscosity varies"):
        filled(tmp_path, 10.0, solver=solver)


def test_a_flow_of_one_fluid_is_not_marched_as_several(tmp_path):
    with pytest.raises(ScriptError, match="has one density and viscosity"):
        ballooned(tmp_path, solver="{imex_midpoint: {}}")


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"pressure": "direct"}, "changes, and not by `direct`"),
        ({"viscosity": '"0.5 - x"'}, "is -0.4"),
        ({"viscosity": "-1 Pa*s"}, "at least 0 and at most 1e.100, and is -1"),
    ],
)
def test_what_several_fluids_cannot_bear_is_told(tmp_path, fields, text):
    with pytest.raises(ScriptError, match=text):
        filled(tmp_path, 10.0, **fields)


def test_a_heavy_bag_rests_on_a_floor_as_tall_and_wide_as_its_tension_lets_it(tmp_path):
    floor = 2.0 / 24
    egg = f'egg: {{implicit: {{field: "x^2 + y^2 - 0.0324", position: 0.5 {floor + 0.185} 0 m}}}}'
    ledge = f"ledge: {{plane: {{position: 0 {floor} 0 m, normal: 0 1 0}}}}"
    air = filled(
        tmp_path, 1000.0, 80.0, "law: {springs: {stretch: 4000 N/m}}", cells=24, viscosity="0.08 Pa*s", end=1.4,
        forces=f"{FALLING}contacts: {{land: {{collision: {{between: [balloon, ledge]}}}}}}\n",
        objects=f"objects: {{{egg}, {ledge}}}\n", boundary="{bottom: {wall: {slip: free}}}",
    )  # fmt: skip
    sides = [np.ptp(air.at(time).read("positions", "balloon"), axis=0)[:2] for time in (1.1, 1.2, 1.3, 1.4)]
    # Of an elastic line around a weight that leans on a plane (its equation, solved apart).
    assert np.mean(sides, axis=0) == pytest.approx([0.46532072, 0.26211314], rel=0.01)
