"""Diffusion on grids: against exact solutions, what is conserved, every solver and linear solver, boundaries."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql.failure import LimitRefused, RunFailure
from sceneql.grids.prepare_stages import report
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.run.run import IslandRun
from sceneql.words.solvers.rk4 import Rk4
from test_stiff import dense

SQUARE = "{rest: {value: 0}}"
MODE = "sin(pi*x)*sin(pi*y)"


class Field:
    """One diffusion model on its way."""

    def __init__(self, folder, solver, end=0.1, before="", **fields):
        fields = {"size": "1 1 m", "cell": "1/16 m", "of": "number", "coefficient": "1", **fields}
        lines = "\n".join(f"      {key}: {value}" for key, value in fields.items() if value is not None)
        path = folder / "scene.yaml"
        text = f"clock: {{end: {end} s, fps: 10}}\n{before}models:\n  plate:\n    diffusion:\n{lines}\n"
        path.write_text(f"{text}solvers: {{main: {solver}}}\n", encoding="utf-8")
        graph = load(path, pruned=False)
        self.model, self.end = graph.tasks["plate"].kind, end
        self.run = IslandRun(graph, graph.islands[0])

    def at(self, time):
        self.run.advance(time)
        return self

    def read(self, output):
        return self.model.read(output, self.run.state("plate"))

    @property
    def values(self):
        return self.read("concentration")

    @property
    def centers(self):
        return self.read("centers")


def sine_error(folder, cells, solver, end=0.02, **more):
    """Largest error of the first mode of the unit square, in parts of what is left of it."""
    field = Field(folder, solver, end, cell=f"1/{cells} m", initial=MODE, boundary=SQUARE, **more).at(end)
    x, y, _ = field.centers.T
    exact = np.sin(np.pi * x) * np.sin(np.pi * y) * np.exp(-2 * np.pi**2 * end)
    return np.abs(field.values - exact).max() / exact.max()


# --- accuracy ---


def test_space_is_of_second_order(tmp_path):
    errors = [sine_error(tmp_path, n, "{tr_bdf2: {step: 0.2 ms}}") for n in (8, 16, 32)]
    orders = np.log2(errors[:-1]) - np.log2(errors[1:])
    assert orders.min() > 1.9
    assert errors[-1] < 5e-4


@pytest.mark.parametrize(
    ("word", "order"),
    [("implicit_euler", 1), ("crank_nicolson", 2), ("tr_bdf2", 2), ("implicit_midpoint", 2), ("adi", 2)],
)
def test_schemes_are_of_their_order_in_time(tmp_path, word, order):
    fine = Field(tmp_path, "{rk4: {step: 50 us}}", 0.02, initial=MODE, boundary=SQUARE).at(0.02).values
    errors = []
    for steps in (4, 8, 16):
        solver = f"{{{word}: {{step: {0.02 / steps} s}}}}"
        errors.append(np.abs(Field(tmp_path, solver, 0.02, initial=MODE, boundary=SQUARE).at(0.02).values - fine).max())
    assert np.log2(errors[1] / errors[2]) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize(
    "solver",
    ["auto", "radau", "bdf2", "dopri5", "rk4: {step: 0.2 ms}", "ftcs: {step: 0.1 ms}", "tr_bdf2"],
)
def test_every_kind_of_solver_marches_a_field(tmp_path, solver):
    word = f"{{{solver}}}" if ":" in solver else solver
    assert sine_error(tmp_path, 8, word) < 8e-3


def test_three_dimensions(tmp_path):
    field = Field(
        tmp_path,
        "{tr_bdf2: {step: 1 ms}}",
        0.02,
        size="1 1 1 m",
        cell="1/12 m",
        initial=f"{MODE}*sin(pi*z)",
        boundary=SQUARE,
    ).at(0.02)
    exact = np.prod(np.sin(np.pi * field.centers), axis=1) * np.exp(-3 * np.pi**2 * 0.02)
    assert np.abs(field.values - exact).max() < 6e-3 * exact.max()


def test_a_periodic_field_moves_through_its_sides(tmp_path):
    sides = "{left: {periodic: yes}, bottom: {periodic: yes}}"
    field = Field(tmp_path, "{tr_bdf2: {step: 0.5 ms}}", 0.02, cell="1/32 m",
                  initial="1+sin(2*pi*(x+y)+0.3)", boundary=sides).at(0.02)  # fmt: skip
    x, y, _ = field.centers.T
    exact = 1 + np.sin(2 * np.pi * (x + y) + 0.3) * np.exp(-8 * np.pi**2 * 0.02)
    assert np.abs(field.values - exact).max() < 4e-3
    assert field.read("mass") == pytest.approx(1.0, abs=1e-13)


# --- linear solvers ---


@pytest.mark.parametrize(
    "linear", ["direct", "multigrid", "conjugate_gradient", "gauss_seidel", "sor", "fast_transform"]
)
@pytest.mark.parametrize("size", ["1 1 m", "1 0.7 0.5 m"])
def test_linear_solvers_agree_and_conserve(tmp_path, linear, size):
    sides = "left: {value: 2}, right: {robin: {coefficient: 3 m/s, outside: 1}}, bottom: {periodic: yes}"
    sides = f"{{{sides}, front: {{flux: 0.5}}}}" if "0.5" in size else f"{{{sides}}}"
    fields = {"size": size, "cell": "1/9 m", "initial": "where(x<0.4, 1, 0)+y", "boundary": sides}
    if linear == "fast_transform":
        if "0.5" in size:
            pytest.skip("flat boxes alone")
        fields["boundary"] = sides.replace("bottom: {periodic: yes}", "top: {value: 0.5}")
    field = Field(tmp_path, f"{{tr_bdf2: {{step: 10 ms, linear: {linear}}}}}", **fields)
    start = field.at(0.0).read("mass")
    field.at(0.1)
    exact = Field(tmp_path, "{radau: {tolerance: 1e-9}}", **fields).at(0.1)
    assert np.abs(field.values - exact.values).max() < 2e-3
    assert field.read("mass") - field.read("inflow") == pytest.approx(start, abs=1e-13)
    done = report(field.run.march.scratch)
    assert done.systems == 20
    assert done.iterations >= done.systems
    if linear not in ("direct", "fast_transform"):
        assert done.residuals[-1] < 1e-6 * done.residuals[0]
        assert linear in field.run.march.prepared_text


@pytest.mark.parametrize("size", ["1 1 m", "1 0.7 0.5 m"])
def test_alternating_directions_conserve_and_reach_the_steady_state(tmp_path, size):
    sides = "{left: {value: 2}, right: {robin: {coefficient: 3 m/s, outside: 1}}, bottom: {periodic: yes}}"
    fields = {"size": size, "cell": "1/9 m", "initial": "where(x<0.4, 1, 0)+y", "boundary": sides}
    field = Field(tmp_path, "{adi: {step: 5 ms}}", 3, **fields)
    start = field.at(0.0).read("mass")
    field.at(0.1)
    exact = Field(tmp_path, "{tr_bdf2: {tolerance: 1e-7}}", **fields).at(0.1)
    assert np.abs(field.values - exact.values).max() < 2e-3
    field.at(3)
    assert field.read("mass") - field.read("inflow") == pytest.approx(start, abs=1e-12)
    # Through the side's own resistance 1/3 and the meter from 2 to 1: the flux is 1/(1 + 1/3).
    assert np.abs(field.values - (2 - 0.75 * field.centers[:, 0])).max() < 1e-6


def test_multigrid_needs_as_many_iterations_on_a_finer_grid(tmp_path):
    counts = []
    for n in (32, 64, 128):
        step = 1e4 / n**2
        field = Field(tmp_path, f"{{implicit_euler: {{step: {step} s, linear: multigrid}}}}", step, cell=f"1/{n} m",
                      initial="where((x-0.4)^2+y^2<0.3, 1, 0)")  # fmt: skip
        field.at(step)
        counts.append(report(field.run.march.scratch).iterations)
    assert max(counts) <= 10
    assert counts[2] <= counts[0] + 1


def test_mass_stays_whatever_the_linear_solver_leaves(tmp_path):
    solver = "{implicit_euler: {step: 1 ms, linear: multigrid}}"
    field = Field(tmp_path, solver, 1.0, cell="1/8 m", initial="exp(-20*((x-0.3)^2+(y-0.6)^2))")
    start = field.at(0.0).read("mass")
    assert field.at(1.0).read("mass") == pytest.approx(start, rel=1e-13)


def test_slivers_of_cells_at_a_boundary_are_solved_as_well_as_whole_ones(tmp_path):
    """Small residuals, but for their volume: they were 11 K above all that was given, and steps a fifth as long."""
    fields = {"size": None, "domain": "disk", "cell": "3.1 cm", "of": "temperature", "coefficient": "1e-3",
              "initial": "293", "boundary": "{edge: {where: x < -0.3, value: 363}}"}  # fmt: skip
    solver = "{tr_bdf2: {tolerance: 1e-4, linear: multigrid}}"
    before = "objects: {disk: {cylinder: {radius: 0.5 m, height: 0.1 m}}}\n"
    field = Field(tmp_path, solver, 3.0, before, **fields)
    highest = [field.at(0.5 * k).read("max") for k in range(1, 7)]
    assert max(highest) < 363.5
    assert field.run.march.statistics.steps < 25


# --- coefficients, sources, boundaries ---


def test_layers_in_a_row_carry_one_flux(tmp_path):
    ends = "{left: {value: 1}, right: {value: 0}}"
    field = Field(tmp_path, "{implicit_euler: {step: 1 s}}", 40, coefficient="where(x<0.5, 1, 0.1)", boundary=ends).at(
        40
    )
    x = field.centers[:, 0]
    # Resistances 0.5/1 and 0.5/0.1 in a row: the middle is at 10/11.
    exact = np.where(x < 0.5, 1 - x / 5.5, (1 - x) * 10 / 5.5)
    assert np.abs(field.values - exact).max() < 1e-8


def test_exchange_with_the_outside_has_the_resistance_of_the_boundary(tmp_path):
    ends = "{left: {robin: {coefficient: 2 m/s, outside: 3}}, right: {flux: 0.5}}"
    field = Field(tmp_path, "{implicit_euler: {step: 10 s}}", 200, coefficient="0.25", boundary=ends).at(200)
    # The flux 0.5 goes through: at the left side c = 3 + 0.5/2, then it rises by 0.5/0.25 a meter.
    assert np.abs(field.values - (3.25 + 2 * field.centers[:, 0])).max() < 1e-8


def test_a_coefficient_that_depends_on_the_field(tmp_path):
    ends = "{left: {value: 1}, right: {value: 0}}"
    steady = []
    for n in (10, 20):
        field = Field(
            tmp_path, "{implicit_euler: {step: 0.5 s}}", 20, cell=f"1/{n} m", coefficient="1+c", boundary=ends
        )
        x = field.at(20).centers[:, 0]
        # Kirchhoff: c + c^2/2 is a line from 3/2 to 0.
        steady.append(np.abs(field.values - (np.sqrt(1 + 3 * (1 - x)) - 1)).max())
    assert steady[1] < 1e-3
    assert steady[0] / steady[1] > 3.5


def test_a_reaction_keeps_its_wave(tmp_path):
    """Fisher's equation c_t = c_xx + c (1 - c) has the wave (1 + exp((x - 5 t/sqrt 6)/sqrt 6))^-2 (Ablowitz 1979)."""
    wave = "1/(1+exp((x-{0}*5/sqrt(6))/sqrt(6)))^2"
    ends = f'{{left: {{value: "{wave.format("t")}"}}, right: {{value: "{wave.format("t")}"}}}}'
    field = Field(tmp_path, "{tr_bdf2: {tolerance: 1e-5}}", 2, size="20 1 m", corner="-6 0 m", cell="0.25 m",
                  coefficient="1", source="c*(1-c)", initial=f'"{wave.format("0")}"', boundary=ends).at(2)  # fmt: skip
    exact = (1 + np.exp((field.centers[:, 0] - 10 / np.sqrt(6)) / np.sqrt(6))) ** -2.0
    assert np.abs(field.values - exact).max() < 5e-4
    assert field.run.march.statistics.steps < 60


def test_what_comes_in_is_counted(tmp_path):
    sides = '{left: {value: "sin(5*t)+y"}, right: {flux: "1+t"}, top: {robin: {coefficient: 1 m/s, outside: "c/2+x"}}}'
    field = Field(tmp_path, "{tr_bdf2: {tolerance: 1e-4}}", 0.5, source="x-0.3*c^2", coefficient="0.3+c^2",
                  boundary=sides, initial="x*y")  # fmt: skip
    start = field.at(0.0).read("mass")
    field.at(0.5)
    assert abs(field.read("inflow")) > 0.1
    assert field.read("mass") - field.read("inflow") == pytest.approx(start, abs=1e-13)


def test_the_jacobian_is_the_derivative_of_the_rate(tmp_path):
    sides = '{left: {value: "sin(5*t)+y"}, right: {flux: "1+t"}, bottom: {periodic: yes}}'
    field = Field(tmp_path, "{rk4: {step: 1 ms}}", size="1 1 1 m", cell="1/3 m", source="x-0.3*c^2",
                  coefficient="0.3+c^2", boundary=sides, initial="x*y+z")  # fmt: skip
    march = March(field.run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
    y = march.system.y + 0.1 * np.random.Generator(np.random.Philox(3)).standard_normal(len(march.system.y))
    h = 1e-6
    expected = np.column_stack(
        [(march.rate(0.3, y + h * d) - march.rate(0.3, y - h * d)) / (2 * h) for d in np.eye(len(y))]
    )
    expected[-1] = 0.0  # of the inflow, which nothing depends on
    # What the ends of the boundary's own weights add is left out there.
    inner = np.abs(field.at(0.0).centers[:, 0] - 0.5) < 0.2
    found = dense(march, 0.3, y)
    assert inner.sum() == 9
    np.testing.assert_allclose(found[:-1][inner], expected[:-1][inner], rtol=1e-6, atol=1e-6)


# --- stability ---


def test_a_jump_stays_between_its_values_and_rings_in_crank_nicolson(tmp_path):
    n = 64
    jump = {"cell": f"1/{n} m", "initial": "where(x<0.5, 1, 0)*where(y<0.3, 1, 0)"}
    step = 1000 / n**2
    inside = Field(tmp_path, f"{{tr_bdf2: {{step: {step} s}}}}", 4 * step, **jump)
    rings = Field(tmp_path, f"{{crank_nicolson: {{step: {step} s}}}}", 4 * step, **jump)
    for k in range(1, 5):
        assert inside.at(k * step).read("min") > -1e-6
        assert inside.read("max") < 1 + 1e-6
        assert rings.at(k * step).read("min") < -0.2


def test_the_explicit_limit_is_sharp_and_its_failure_is_located(tmp_path):
    limit = 1 / (4 * 16**2)
    rough = {"initial": "where(sin(50*x)*sin(61*y)>0, 1, 0)", "end": 0.4}
    assert Field(tmp_path, f"{{ftcs: {{step: {0.9 * limit} s}}}}", **rough).at(0.4).read("max") < 1
    with pytest.raises(RunFailure) as failure:
        Field(tmp_path, f"{{ftcs: {{step: {1.1 * limit} s}}}}", **rough).at(0.4)
    assert failure.value.part == "plate"
    assert failure.value.span is not None
    assert "unstable" in failure.value.message


def test_an_exchange_of_no_size_is_a_closed_side_also_where_nothing_spreads(tmp_path):
    sides = "{left: {robin: {coefficient: 0 m/s}}}"
    for coefficient in ("0", "x"):
        field = Field(tmp_path, "{tr_bdf2: {step: 0.1 s}}", 1.0, coefficient=coefficient, initial="x", boundary=sides)
        before = field.at(0.0).read("mass")
        assert field.at(1.0).read("mass") == pytest.approx(before, rel=1e-13)


# --- what cannot be solved so ---


@pytest.mark.parametrize(
    ("solver", "fields", "said"),
    [
        ("{tr_bdf2: {linear: direct}}", {"cell": "1/800 m"}, "factors of 640000 cells would not fit"),
        ("{tr_bdf2: {linear: fast_transform}}", {"coefficient": "1 + x"}, "a fast transform needs a flat box"),
    ],
)
def test_a_solver_that_does_not_take_a_grid_is_told_with_its_line(tmp_path, solver, fields, said):
    with pytest.raises(LimitRefused, match=said) as found:
        Field(tmp_path, solver, **fields)
    span = found.value.diagnostic.span
    assert span is not None
    assert "main: " in (tmp_path / "scene.yaml").read_text().splitlines()[span.line - 1]
