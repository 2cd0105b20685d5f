"""Reaction-diffusion systems: exact waves and fronts, homogeneous states, growth of modes, sums that reactions keep."""

from __future__ import annotations

import numpy as np
import pytest

from runs import complaint
from sceneql.failure import RunFailure
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

FISHER = (
    "{u: {coefficient: 1, initial: '1/(1+exp((x-8)/sqrt(6)))^2', rate: u*(1-u),"
    " boundary: {left: {value: '1/(1+exp((x-8-5/sqrt(6)*t)/sqrt(6)))^2'}}}}"
)
SCHNAKENBERG = (
    "{u: {coefficient: 1, initial: '1 + 1e-5*cos(pi*x/8)', rate: 0.1 - u + u^2*v},"
    " v: {coefficient: 40, initial: '0.9', rate: 0.9 - u^2*v}}"
)
GRAY_SCOTT = (
    "{u: {coefficient: 2e-5, initial: '1 - 0.5*exp(-200*((x-0.4)^2+(y-0.5)^2))', rate: -uvv + F*(1-u)},"
    " v: {coefficient: 1e-5, initial: '0.25*exp(-200*((x-0.4)^2+(y-0.5)^2))', rate: uvv - (F+k)*v}}"
)


class Fields:
    """One system on its way."""

    def __init__(self, folder, species, solver, end, define="{F: 0.04, k: 0.06}", before="", models="", **fields):
        fields = {**({} if "domain" in fields else {"size": "1 1 m"}), "cell": "1/24 m", "species": species, **fields}
        lines = "\n".join(f"      {key}: {value}" for key, value in fields.items())
        path = folder / "scene.yaml"
        text = f"clock: {{end: {end} s}}\ndefine: {define}\n{before}models:\n{models}"
        text += f"  dish:\n    reaction_diffusion:\n{lines}\n"
        path.write_text(f"{text}solvers: {{main: {solver}}}\n", encoding="utf-8")
        graph = load(path, pruned=False)
        self.model, self.end = graph.tasks["dish"].kind, end
        self.run = IslandRun(graph, graph.islands[0])

    def at(self, time):
        self.run.advance(time)
        return self

    def read(self, output):
        return self.model.read(output, self.run.state("dish"))


def front_error(folder, cell, solver="{dop853: {tolerance: 1e-9}}", end=4.0):
    """Largest error of Fisher's wave of speed 5/sqrt(6) (Ablowitz & Zeppetella 1979), and its mean speed."""
    field = Fields(folder, FISHER, solver, end, size=f"40 {2 * cell} m", cell=f"{cell} m")
    x, u = field.at(end).read("centers")[:, 0], field.read("u")
    exact = (1 + np.exp((x - 8 - 5 / np.sqrt(6) * end) / np.sqrt(6))) ** -2
    quarter = np.interp(-0.25, -u[: len(u) // 2], x[: len(u) // 2])
    return np.abs(u - exact).max(), (quarter - 8) / end


def test_fishers_wave_is_of_second_order(tmp_path):
    errors = [front_error(tmp_path, cell)[0] for cell in (0.5, 0.25, 0.125)]
    assert np.diff(np.log2(errors)) == pytest.approx(-2, abs=0.1)
    assert errors[-1] < 1e-3


def test_fishers_wave_has_its_speed(tmp_path):
    assert front_error(tmp_path, 0.125)[1] == pytest.approx(5 / np.sqrt(6), rel=2e-3)


@pytest.mark.parametrize("a", [0.5, 0.2])
def test_a_front_between_two_states_keeps_its_profile_and_speed(tmp_path, a):
    species = "{u: {coefficient: 1, initial: '1/(1+exp((x-16)/sqrt(2)))', rate: u*(1-u)*(u-a)}}"
    field = Fields(
        tmp_path, species, "{dop853: {tolerance: 1e-8}}", 8, size="40 0.4 m", cell="0.2 m", define=f"{{a: {a}}}"
    ).at(8)
    x = field.read("centers")[:, 0]
    exact = 0.5 - 0.5 * np.tanh((x - 16 - (1 - 2 * a) / np.sqrt(2) * 8) / (2 * np.sqrt(2)))
    assert np.abs(field.read("u") - exact).max() < 2e-3


@pytest.mark.parametrize("sign", [1, -1])
def test_gray_scott_rests_in_its_homogeneous_states(tmp_path, sign):
    feed, kill = 0.04, 0.05
    u = 0.5 * (1 + sign * np.sqrt(1 - 4 * (feed + kill) ** 2 / feed))
    v = feed * (1 - u) / (feed + kill)
    species = (
        f"{{u: {{coefficient: 2e-5, initial: {u}, rate: -u*v^2 + F*(1-u)}},"
        f" v: {{coefficient: 1e-5, initial: {v}, rate: u*v^2 - (F+k)*v}}}}"
    )
    field = Fields(tmp_path, species, "{rk4: {step: 1 s}}", 20, cell="1/8 m", define="{F: 0.04, k: 0.05}").at(20)
    assert np.abs(field.read("u") - u).max() < 1e-12
    assert np.abs(field.read("v") - v).max() < 1e-12


@pytest.mark.parametrize("solver", ["{dop853: {tolerance: 1e-11}}", "{rodas5p: {tolerance: 1e-9}}"])
def test_a_small_mode_grows_as_turing_says(tmp_path, solver):
    field = Fields(tmp_path, SCHNAKENBERG, solver, 4, size="8 0.5 m", cell="0.25 m").at(4)
    x = field.read("centers")[:, 0]
    mode = np.cos(np.pi * x / 8)
    found = [(field.read(name) @ mode) / (mode @ mode) for name in ("u", "v")]
    wave = (2 - 2 * np.cos(np.pi / 32)) / 0.25**2
    matrix = np.array([[-1 + 2 * 0.9, 1.0], [-2 * 0.9, -1.0]]) - np.diag([1, 40]) * wave
    values, vectors = np.linalg.eig(matrix)
    exact = (vectors * np.exp(4 * values)) @ np.linalg.solve(vectors, [1e-5, 0])
    assert found == pytest.approx(exact.real, rel=2e-4)


@pytest.mark.parametrize(
    "solver",
    ["{rk4: {step: 1 s}}", "{tr_bdf2: {tolerance: 1e-6}}", "{bdf2: {step: 0.5 s}}", "{crank_nicolson: {step: 1 s}}",
     "{implicit_midpoint: {step: 1 s}}", "auto"],
)  # fmt: skip
def test_every_kind_of_solver_marches_species(tmp_path, solver):
    exact = Fields(tmp_path, GRAY_SCOTT, "{dop853: {tolerance: 1e-10}}", 20, where="{uvv: u*v^2}").at(20)
    field = Fields(tmp_path, GRAY_SCOTT, solver, 20, where="{uvv: u*v^2}").at(20)
    for name in "uv":
        assert np.abs(field.read(name) - exact.read(name)).max() < 1e-3


@pytest.mark.parametrize(("word", "order"), [("implicit_euler", 1), ("crank_nicolson", 2), ("tr_bdf2", 2)])
def test_implicit_schemes_are_of_their_order_in_time(tmp_path, word, order):
    def final(solver):
        return Fields(tmp_path, GRAY_SCOTT, solver, 20, where="{uvv: u*v^2}", cell="1/12 m").at(20).read("v")

    exact = final("{dop853: {tolerance: 1e-12}}")
    errors = [np.abs(final(f"{{{word}: {{step: {step} s}}}}") - exact).max() for step in (1, 0.5)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("where", ["size: 1 1 m", "size: 1 0.8 0.6 m", "domain: disk"])
@pytest.mark.parametrize("solver", ["{rk4: {step: 2 ms}}", "{tr_bdf2: {step: 10 ms}}"])
def test_a_reaction_keeps_the_sum_that_it_keeps(tmp_path, where, solver):
    key, value = where.split(": ")
    corners = ", ".join(f"[{0.5 * np.cos(a):.4f}, {0.5 * np.sin(a):.4f}]" for a in np.linspace(0, 2 * np.pi, 40)[:-1])
    objects = f"objects: {{disk: {{outline: {{points: [{corners}]}}}}}}\n"
    species = "{a: {coefficient: 0.02, initial: '1 + x', rate: -made}, b: {initial: '1 - y', rate: made}}"
    field = Fields(
        tmp_path, species, solver, 0.4, before=objects, where="{made: a^2*b - 3*b}", cell="1/8 m", **{key: value}
    )
    start = [field.at(0.0).read(f"{name}.mass") for name in "ab"]
    now = [field.at(0.4).read(f"{name}.mass") for name in "ab"]
    came = [field.read(f"{name}.inflow") for name in "ab"]
    assert sum(now) == pytest.approx(sum(start), abs=1e-13)
    assert np.array(now) - came == pytest.approx(start, abs=1e-13 if "rk4" in solver else 1e-8)
    assert abs(came[1]) > 0.01


def test_starts_may_use_what_where_says(tmp_path):
    field = Fields(tmp_path, "{u: {initial: 1 - hill}}", "heun", 1, where="{hill: top*x, top: 3}", cell="1/4 m").at(0)
    assert field.read("u") == pytest.approx(1 - 3 * field.read("centers")[:, 0])


def test_each_species_may_have_its_own_boundary(tmp_path):
    species = (
        "{a: {coefficient: 1, initial: x, boundary: {left: {value: 0}, right: {value: 1}}},"
        " b: {coefficient: 1, initial: '2 + y'}}"
    )
    field = Fields(tmp_path, species, "{tr_bdf2: {step: 10 ms}}", 1, cell="1/8 m",
                   boundary="{bottom: {value: 2}, top: {value: 3}}").at(1)  # fmt: skip
    x, y, _ = field.read("centers").T
    assert field.read("a") == pytest.approx(x, abs=1e-9)
    assert field.read("b") == pytest.approx(2 + y, abs=1e-9)


def test_rates_may_read_place_time_and_other_parts(tmp_path):
    pump = "{motion: {position: '[0 m, 2 m/s*time, 0 m]'}}"
    species = "{a: {rate: x + y*t + pump.position.y}}"
    text = f"  pump: {pump}\n"
    field = Fields(tmp_path, species, "{rk4: {step: 0.1 s}}", 1, cell="1/4 m", models=text).at(1)
    x, y, _ = field.read("centers").T
    assert field.read("a") == pytest.approx(x + 0.5 * y + 1.0, abs=1e-12)


def test_a_changed_number_compiles_nothing(tmp_path):
    from sceneql.compiled.kernels import compiled

    Fields(tmp_path, GRAY_SCOTT, "{rk4: {step: 1 s}}", 2, where="{uvv: u*v^2}", cell="1/8 m").at(2)
    before = compiled.count
    other = GRAY_SCOTT.replace("2e-5", "3e-5").replace("0.25", "0.125")
    Fields(tmp_path, other, "{rk4: {step: 0.5 s}}", 2, where="{uvv: u*v^2}", cell="1/9 m",
           define="{F: 0.03, k: 0.05}").at(2)  # fmt: skip
    assert compiled.count == before


def test_a_rate_that_runs_away_is_named(tmp_path):
    with pytest.raises(RunFailure, match="dish"):
        Fields(tmp_path, "{u: {initial: 1, rate: u^2}}", "{rk4: {step: 0.1 s}}", 5, cell="1/4 m").at(5)


def wrong(folder, species, more=""):
    return complaint(
        folder, f"models: {{dish: {{reaction_diffusion: {{size: 1 1 m, cell: 0.1 m, species: {species}{more}}}}}}}\n"
    )


@pytest.mark.parametrize(
    ("species", "more", "said"),
    [
        ("{}", "", "nothing to spread"),
        ("{x: {rate: 1}}", "", "'x' is a coordinate"),
        ("{c: {rate: 1}}", "", "stands for each species"),
        ("{u: {rate: w}}", ", where: {w: v, v: w}", "defined by itself"),
        ("{u: {rate: u*vv}}", "", "nothing is called 'vv'"),
        ("{u: {initial: 1 + v}, v: {rate: 1}}", "", "'v' has no value before the start"),
        ("{u: {initial: w}}", ", where: {w: t*x}", "'time' has no value before the start"),
        ("{u: {rate: '[u, 1, 2]'}}", "", "one number at each place"),
        ("{u: {rate: 1}}", ", where: {u: 2}", "already"),
        ("{u: {rate: 1, boundary: {top: {flux: 1}, front: {flux: 1}}}}", "", "no side 'front'"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, species, more, said):
    assert said in wrong(tmp_path, species, more)


def test_what_marches_one_field_alone_is_not_measured_on_several(tmp_path):
    from sceneql.compiler.catalogue import Catalogue
    from sceneql.report.work_precision import solvers

    graph = Fields(tmp_path, GRAY_SCOTT, "heun", 1, where="{uvv: u*v^2}", cell="1/4 m").run.graph
    found = solvers(graph, graph.islands[0], Catalogue())
    assert not {"adi", "exact"} & set(found)
    assert {"tr_bdf2", "rk4"} <= set(found)
