"""The bench of fields on grids: errors against exact solutions, observed orders in space, linear solvers."""

from __future__ import annotations

import csv
import math
from itertools import pairwise

import pytest

from sceneql.compiler.catalogue import Catalogue
from sceneql.pipeline import load
from sceneql.report import bench_methods
from sceneql.report.bench_grids import grid_section
from sceneql.report.bench_schemes import front, scheme_runs
from sceneql.report.grid_ends import difference, ends_on_grids
from sceneql.report.grid_runs import linear_runs, on_grids
from sceneql.report.work_precision import solvers
from sceneql.words.solvers.exact import Exact

PLATE = "size: 1 1 m, cell: 1/16 m, initial: sin(pi*x)*sin(pi*y), boundary: {rest: {value: 0}}"


def field(folder, fields, solver="tr_bdf2", objects="", end=0.05):
    path = folder / "scene.yaml"
    model = f"{{diffusion: {{of: number, coefficient: 1, {fields}}}}}"
    path.write_text(
        f"clock: {{end: {end} s, fps: 20}}\n{objects}models: {{plate: {model}}}\nsolvers: {{main: {solver}}}\n"
        "outputs: {table: {record: {of: [plate.mass]}}}\n",
        encoding="utf-8",
    )
    graph = load(path)
    return graph, graph.islands[0]


def test_the_error_of_a_grid_is_that_of_the_exact_solution(tmp_path):
    ends, how = ends_on_grids(*field(tmp_path, PLATE))
    runs, order = on_grids("plate", ends)
    assert how == "exact"
    assert order == pytest.approx(2, abs=0.05)
    for run in runs:
        n = round(1 / run.cell)
        assert run.cells == n * n
        # The first mode of n cells decays by 8 n^2 sin^2(pi/2n); its root mean square is half of its largest value.
        wrong = math.expm1((2 * math.pi**2 - 8 * n * n * math.sin(math.pi / 2 / n) ** 2) * 0.05)
        assert run.error == pytest.approx(0.5 * wrong, rel=0.12)


@pytest.mark.parametrize(("edges", "low", "high"), [("cut_cell", 1.8, 2.4), ("staircase", 0.4, 1.5)])
def test_the_order_in_space_is_that_of_the_boundary(tmp_path, edges, low, high):
    start = f"domain: ball, flat: yes, edges: {edges}, cell: 1/8 m, initial: x*x"
    ball = "objects: {ball: {sphere: {radius: 1 m}}}\n"
    ends, how = ends_on_grids(*field(tmp_path, start, objects=ball, end=0.02))
    _, order = on_grids("plate", ends)
    assert "tr_bdf2" in how
    assert low < order < high


def test_every_linear_solver_tells_its_residuals(tmp_path):
    found = {run.linear: run for run in linear_runs(*field(tmp_path, PLATE, "{implicit_euler: {step: 5 ms}}"))}
    assert set(found) == {"direct", "multigrid", "conjugate_gradient", "gauss_seidel", "sor", "fast_transform"}
    assert found["multigrid"].iterations < found["conjugate_gradient"].iterations < found["gauss_seidel"].iterations
    for name in ("multigrid", "conjugate_gradient"):
        shares = found[name].residuals
        assert len(shares) == found[name].iterations + 1
        assert shares[0] == 1
        assert shares[-1] < 1e-6


def test_schemes_reach_the_errors_of_grids_by_steps_of_their_own(tmp_path):
    graph, island = field(tmp_path, PLATE)
    ends, _ = ends_on_grids(graph, island)
    applying = solvers(graph, island, Catalogue(None))
    chosen = {word: applying[word] for word in ("exact", "implicit_euler", "tr_bdf2", "euler")}
    runs = list(scheme_runs(graph, island, chosen, ends))
    assert {run.solver for run in runs} == set(chosen)
    for end in ends[2:5]:
        mine = [run for run in runs if run.cell == end.cell]
        (exact,) = (run for run in mine if run.solver == "exact")
        assert exact.error == pytest.approx(difference(end, ends[0]))
        by_word = {word: [run for run in mine if run.solver == word] for word in chosen}
        coarse = [run.error for run in by_word["implicit_euler"] if run.error > 4.0 * exact.error]
        for first, second in pairwise(coarse):  # of first order: with four times the steps a fourth of time's error
            assert (first - exact.error) / (second - exact.error) == pytest.approx(4, rel=0.25)
        assert len(by_word["tr_bdf2"]) < len(by_word["implicit_euler"])
    best = front(runs)
    assert all(a.seconds <= b.seconds and a.error > b.error for a, b in pairwise(best))


def test_the_section_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr(bench_methods, "LEVELS", (2.0, 1.0))
    graph, _ = field(tmp_path, PLATE, "{implicit_euler: {step: 5 ms}}")
    section = grid_section(graph, tmp_path / "out", {"plate": {"exact": Exact()}})
    assert section.lines[0].startswith("plate on grids, exact in time: observed order 2.0")
    assert [path.name for _, path in section.plots] == [
        "out.schemes.svg",
        "out.grids.svg",
        "out.linear.svg",
        "out.methods.svg",
    ]
    assert all("<svg" in path.read_text() for _, path in section.plots)
    rows = list(csv.DictReader(section.files[0].read_text().splitlines()))
    assert [float(row["cell"]) for row in rows] == sorted((float(row["cell"]) for row in rows), reverse=True)
    methods = list(csv.DictReader(section.files[3].read_text().splitlines()))
    assert list(dict.fromkeys(row["method"] for row in methods)) == ["cells", "p1", "p2"]
    finest = {row["method"]: float(row["error"]) for row in methods}  # the last of each stays
    assert finest["p2"] < 0.5 * finest["cells"], "with sides of twice the length: the finest is what all are beside"
    assert {row["linear"] for row in csv.DictReader(section.files[2].read_text().splitlines())} >= {"multigrid", "sor"}


def test_a_scene_without_fields_has_no_section(tmp_path):
    path = tmp_path / "ball.yaml"
    path.write_text(
        "models: {ball: {particles: {positions: [0 0 0 m], mass: 1 kg}}}\nforces: [gravity]\n"
        "outputs: {table: {record: {of: [ball.positions]}}}\n",
        encoding="utf-8",
    )
    assert grid_section(load(path), tmp_path / "out", {}) is None
