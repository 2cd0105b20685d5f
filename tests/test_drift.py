"""Fields that a flow carries: exact shifts, no new extrema, what is kept, flows free of divergence, every solver."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest

from sceneql.failure import LimitRefused, RunFailure
from sceneql.grids import flow
from sceneql.quantities.diagnostic import ScriptError
from test_diffusion import Field

AROUND = "{left: {periodic: yes}, bottom: {periodic: yes}}"
ZALESAK = "(x^2 + (y-0.5)^2 < 0.09)*(1 - (abs(x) < 0.05)*(y < 0.7))"
DISK = np.linspace(0, 2 * np.pi, 61)[:-1]
RIM = ", ".join(f"[{np.cos(a):.5f}, {np.sin(a):.5f}]" for a in DISK)


def drifted(folder, drift, solver, end, **fields):
    return Field(folder, solver, end, drift=drift, **{"coefficient": "0", **fields})


def in_disk(folder, drift, solver, end, **fields):
    """A field in a disk of 1 m."""
    before = f"objects: {{shore: {{outline: {{points: [{RIM}]}}}}}}\n"
    return drifted(folder, drift, solver, end, domain="shore", size=None, before=before, **{"cell": "1/10 m", **fields})


def test_upstream_values_at_one_cell_a_step_shift_exactly(tmp_path):
    field = drifted(tmp_path, "{velocity: '[0.5, 0]', limiter: none}", "{euler: {step: 1/8 s}}", 1,
                    initial="random(floor(16*x), floor(16*y))", boundary=AROUND)  # fmt: skip
    before = field.at(0.0).values.reshape(16, 16)
    assert field.at(1.0).values.reshape(16, 16) == pytest.approx(np.roll(before, 8, axis=1), abs=1e-13)


@pytest.mark.parametrize(("limiter", "order"), [("none", 0.8), ("van_leer", 1.9), ("koren", 2.2)])
def test_limiters_are_of_their_order(tmp_path, limiter, order):
    errors = []
    for n in (24, 48, 96):
        field = drifted(
            tmp_path, f"{{velocity: '[1, 0]', limiter: {limiter}}}", f"{{rk4: {{step: {0.2 / n} s}}}}", 1,
            size=f"1 {2 / n} m", cell=f"1/{n} m", initial="1 + sin(2*pi*x)", boundary="{left: {periodic: yes}}",
        )  # fmt: skip
        before = field.at(0.0).values.copy()
        errors.append(np.abs(field.at(1.0).values - before).mean())
    assert np.log2(errors[1] / errors[2]) > order


def test_zalesaks_disk_comes_round_without_new_extrema(tmp_path):
    turn = 2 * np.pi
    errors = {}
    for limiter in ("koren", "none"):
        field = drifted(
            tmp_path, f"{{stream_function: '-(x^2+y^2)/2', limiter: {limiter}}}", "{heun: {step: pi*1 s/300}}", turn,
            size="2.2 2.2 m", corner="-1.1 -1.1 m", cell="2.2/60 m", initial=ZALESAK,
        )  # fmt: skip
        before, mass = field.at(0.0).values.copy(), field.read("mass")
        after = field.at(turn).values
        assert after.min() > -1e-12
        assert after.max() < 1 + 1e-12
        assert field.read("mass") == pytest.approx(mass, abs=1e-13)
        errors[limiter] = np.abs(after - before).sum() / before.sum()
    assert errors["koren"] < 0.5 * errors["none"]


@pytest.mark.parametrize("edges", ["cut_cell", "staircase"])
@pytest.mark.parametrize("way", ["velocity: '[y - 0.3*x^2, sin(3*x) + 0.2]'", "stream_function: x*y^2 + x"])
def test_in_a_closed_domain_nothing_gathers_and_nothing_is_lost(tmp_path, edges, way):
    initial = "where(x > 0.1, 1, 0)"
    field = in_disk(tmp_path, f"{{{way}}}", "{heun: {step: 5 ms}}", 1, edges=edges, initial=initial)
    mass = field.at(0.0).read("mass")
    field.at(1.0)
    assert field.read("mass") == pytest.approx(mass, abs=1e-13)
    assert field.read("inflow") == 0.0
    assert field.read("min") > -1e-12
    assert field.read("max") < 1 + 1e-12
    even = in_disk(tmp_path, f"{{{way}}}", "{heun: {step: 5 ms}}", 1, edges=edges, initial="1").at(1.0)
    assert even.values == pytest.approx(1.0, abs=1e-12)


def test_a_uniform_wind_moves_nothing_in_a_closed_box_unless_it_is_taken_as_it_is(tmp_path):
    wind = "velocity: '[0.5, 0.25]'"
    field = drifted(tmp_path, f"{{{wind}}}", "{heun: {step: 10 ms}}", 1, initial="x").at(1.0)
    assert field.values == pytest.approx(field.centers[:, 0], abs=1e-12)
    field = drifted(tmp_path, f"{{{wind}, incompressible: no}}", "{heun: {step: 10 ms}}", 1, initial="1").at(1.0)
    assert field.read("max") > 3
    assert field.read("mass") == pytest.approx(1.0, abs=1e-13)


def test_a_channel_fills_from_its_inlet_and_runs_over(tmp_path):
    sides = "{left: {value: 2}, right: {open: yes}}"
    field = drifted(tmp_path, "{velocity: '[1, 0]'}", "{heun: {step: 10 ms}}", 3, boundary=sides)
    assert field.at(0.5).read("mass") == pytest.approx(1.0, abs=1e-12)
    assert field.read("inflow") == pytest.approx(1.0, abs=1e-12)
    assert field.at(3.0).values == pytest.approx(2.0, abs=1e-6)


def test_inlets_may_vary_in_time(tmp_path):
    sides = "{left: {value: t}, right: {open: yes}}"
    field = drifted(tmp_path, "{velocity: '[2, 0]'}", "{rk4: {step: 10 ms}}", 0.4, boundary=sides).at(0.4)
    assert field.read("inflow") == pytest.approx(2 * 0.4**2 / 2, abs=1e-12)


@pytest.mark.parametrize("solver", ["{rk4: {step: 1 ms}}", "{tr_bdf2: {step: 10 ms}}", "{bdf2: {step: 10 ms}}"])
def test_the_layer_at_an_outlet_is_that_of_the_equation(tmp_path, solver):
    sides = "{left: {value: 0}, right: {value: 1}}"
    errors = []
    for n in (16, 32):
        field = drifted(tmp_path, "{velocity: '[1, 0]'}", solver, 6, size=f"1 {2 / n} m", cell=f"1/{n} m",
                        coefficient="0.2", boundary=sides).at(6)  # fmt: skip
        exact = np.expm1(field.centers[:, 0] / 0.2) / np.expm1(1 / 0.2)
        errors.append(np.abs(field.values - exact).max())
    assert errors[1] < 0.4 * errors[0]
    assert errors[1] < 0.01


def test_strength_varies_in_time(tmp_path):
    field = drifted(
        tmp_path, "{velocity: '[1, 0]', strength: cos(pi*time/(1 s)), limiter: none}", "{rk4: {step: 10 ms}}", 1,
        initial="1 + sin(2*pi*x)", boundary=AROUND, cell="1/64 m",
    )  # fmt: skip
    exact = 1 + np.sin(2 * np.pi * (field.at(0.5).centers[:, 0] - 1 / np.pi))
    assert np.abs(field.values - exact).max() < 0.12
    assert np.corrcoef(field.values, exact)[0, 1] > 0.9999


def test_a_wind_that_turns_is_the_wind_from_the_other_side(tmp_path):
    ends = []
    for velocity, strength in (("[1, 0]", "-1"), ("[-1, 0]", "1")):
        field = drifted(
            tmp_path, f"{{velocity: '{velocity}', strength: {strength}}}", "{tr_bdf2: {step: 10 ms}}", 1, initial="0",
            boundary="{left: {value: 2}, right: {value: t + 3}}", cell="1/32 m",
        )  # fmt: skip
        ends.append(field.at(0.6).values.copy())
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-12)
    assert ends[0].max() > 3


def test_three_dimensions(tmp_path):
    sides = "{left: {periodic: yes}, bottom: {periodic: yes}, back: {periodic: yes}}"
    field = drifted(
        tmp_path, "{velocity: '[1, -1, 0.5]'}", "{heun: {step: 10 ms}}", 1, size="1 1 1 m", cell="1/16 m",
        boundary=sides, initial="1 + sin(2*pi*(x+y))*cos(4*pi*z)",
    )  # fmt: skip
    before = field.at(0.0).values.copy()
    field.at(1.0)
    assert np.corrcoef(field.values, before)[0, 1] > 0.98
    assert field.read("mass") == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize(
    "solver", ["auto", "{dopri5: {tolerance: 1e-6}}", "{tr_bdf2: {tolerance: 1e-5}}", "{crank_nicolson: {step: 10 ms}}",
               "{implicit_midpoint: {step: 10 ms}}", "{rodas5p: {tolerance: 1e-5}}", "{bdf2: {tolerance: 1e-6}}"],
)  # fmt: skip
def test_every_kind_of_solver_carries(tmp_path, solver):
    drift, fields = "{stream_function: '(1 - x^2 - y^2)^2'}", {"coefficient": "0.01", "initial": "x"}
    exact = in_disk(tmp_path, drift, "{rk4: {step: 5 ms}}", 0.5, **fields).at(0.5)
    field = in_disk(tmp_path, drift, solver, 0.5, **fields).at(0.5)
    assert np.abs(field.values - exact.values).max() < 2e-3
    assert field.read("mass") == pytest.approx(exact.read("mass"), abs=1e-12)


@pytest.mark.parametrize("limiter", ["koren", "van_leer"])
@pytest.mark.parametrize("cells", [0.2, 1.5, 4, 10])
def test_implicit_steps_may_pass_many_cells(tmp_path, limiter, cells):
    # 1 m/s at the rim, cells of 0.1 m: a step of 0.1 s passes one.
    step = 0.1 * cells
    drift, start = f"{{stream_function: '-(x^2 + y^2)/2', limiter: {limiter}}}", "where(x > 0.1, 1, 0)"
    field = in_disk(tmp_path, drift, f"{{implicit_euler: {{step: {step} s}}}}", 3 * step, initial=start)
    mass = field.at(2 * step).read("mass")
    before = field.run._now[1].copy()
    after = field.at(3 * step).run._now[1].copy()
    assert after - before == pytest.approx(step * field.run.march.rate(3 * step, after), abs=1e-8)
    assert field.read("mass") == pytest.approx(mass, abs=1e-12)
    assert field.values.min() > -1e-9
    assert field.values.max() < 1 + 1e-9


@pytest.mark.parametrize("solver", ["crank_nicolson", "tr_bdf2"])
def test_methods_of_second_order_pass_many_cells_too(tmp_path, solver):
    drift = "{stream_function: '-(x^2 + y^2)/2'}"
    field = in_disk(tmp_path, drift, f"{{{solver}: {{step: 1 s}}}}", 5, initial="1 + x")
    mass = field.at(0.0).read("mass")
    assert np.isfinite(field.at(5.0).values).all()
    assert field.read("mass") == pytest.approx(mass, abs=1e-11)
    named = in_disk(tmp_path, drift, f"{{{solver}: {{step: 1 s, linear: conjugate_gradient}}}}", 5, initial="x > 0")
    with pytest.raises(RunFailure, match="with a drift `linear: auto`"):
        named.at(5.0)


@pytest.mark.parametrize("limiter", ["koren", "van_leer", "none"])
def test_the_jacobian_is_the_derivative_of_the_rate(tmp_path, limiter):
    from sceneql.march.driver import jacobian
    from sceneql.march.modes import jacobian as by_differences

    drift = f"{{velocity: '[1 + x, sin(5*x) - y]', incompressible: no, limiter: {limiter}}}"
    sides = "{left: {periodic: yes}, bottom: {value: 1}, top: {open: yes}}"
    field = drifted(tmp_path, drift, "{bdf2: {step: 10 ms}}", 0.1, cell="1/5 m", boundary=sides, coefficient="0.1",
                    initial="exp(2*x)*sin(3*y) + random(floor(5*x), floor(5*y))")  # fmt: skip
    march = field.at(0.0).run.march
    pattern = march.system.pattern
    values = np.zeros(pattern.room)
    march.rate(0.0, march.system.y)
    functions = march._engaged.functions
    jacobian(march.system)(functions, 0.0, march.system.y, values, march.floats, march.system.ints)
    found = np.zeros((len(march.system.y),) * 2)
    rows = pattern.rows
    found[rows, pattern.columns] = values[: len(pattern.columns)]
    assert found[:-1, :-1] == pytest.approx(by_differences(march)[:-1, :-1], abs=1e-6)


def test_a_flow_made_free_of_divergence_is_the_same_by_factors_and_by_iterations(tmp_path, monkeypatch):
    wind, sides = "{velocity: '[y - 0.3*x^2, sin(3*x) + 0.2]'}", "{left: {open: yes}, top: {open: yes}}"
    flows = []
    for most in (300_000, 0):
        monkeypatch.setattr(flow, "LARGEST_FACTORED", {2: most, 3: most})
        field = drifted(tmp_path, wind, "{heun: {step: 1 ms}}", 0.1, initial="x", boundary=sides).at(0.1)
        flows.append(field.values)
    assert np.abs(flows[0] - flows[1]).max() < 1e-10
    monkeypatch.setattr("scipy.sparse.linalg.cg", lambda matrix, target, **rest: (target, 1))
    with pytest.raises(LimitRefused, match="on so many cells"):
        drifted(tmp_path, wind, "heun", 0.1, boundary=sides)


def test_species_that_stay_in_place_are_not_carried(tmp_path):
    from test_reaction_diffusion import Fields

    species = "{u: {coefficient: 0, initial: sin(2*pi*x)}, v: {initial: sin(2*pi*x)}}"
    field = Fields(tmp_path, species, "{heun: {step: 5 ms}}", 0.5, drift="{velocity: '[1, 0]'}", boundary=AROUND).at(
        0.5
    )
    stays = np.sin(2 * np.pi * field.read("centers")[:, 0])
    assert field.read("v") == pytest.approx(stays, abs=1e-13)
    assert field.read("u") == pytest.approx(-stays, abs=0.05)


@pytest.mark.parametrize(
    ("drift", "said"),
    [
        ("{}", "one of `velocity`, `stream_function` and `by`"),
        ("{velocity: x}", "a vector of two or three"),
        ("{velocity: '[x, y, z]'}", "needs 2 components"),
        ("{stream_function: '[x, y]'}", "one number at each place"),
        ("{velocity: '[1/x, 0]', incompressible: no}", "not finite"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, drift, said):
    with pytest.raises(ScriptError, match=said):
        drifted(tmp_path, drift, "heun", 1, boundary=AROUND).at(0.1)


def test_cells_outside_a_domain_do_not_count_where_a_flow_is_factored(tmp_path, monkeypatch):
    monkeypatch.setattr("scipy.sparse.linalg.cg", lambda matrix, target, **rest: (target, 1))
    for most, holds in ((380, True), (280, False)):  # of 441 cells some 350 lie inside
        monkeypatch.setattr(flow, "LARGEST_FACTORED", {2: most, 3: 0})
        with nullcontext() if holds else pytest.raises(LimitRefused, match="on so many cells"):
            in_disk(tmp_path, "{velocity: '[y, -x^2]'}", "heun", 0.1)
