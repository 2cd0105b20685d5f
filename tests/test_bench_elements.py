"""The bench of elastic solids: kinds of elements over spacings, beside exact values or the finest, with orders."""

from __future__ import annotations

import csv
import json
import math

import pytest
from click.testing import CliRunner

from sceneql.cli import cli
from sceneql.pipeline import load
from sceneql.report import element_runs
from sceneql.report.bench import bench
from sceneql.report.element_runs import solids, watched_of

BAR = (
    "clock: {{end: 1 s, fps: 1}}\nmodels: {{beam: {{elastic: {{block: {{size: 0.4 0.1 0.1 m, cells: [{cells}, 1, 1]}}, "
    "law: {{linear: {{modulus: 1 MPa, poisson: {poisson}}}}}, hold: {{wall: {{where: x < -0.199}}}}, "
    "loads: {{tip: {{where: x > 0.199, force: {force} N}}}}, probes: {{end: 0.2 0 0 m}}}}}}}}\n"
    "solvers: {{main: {solver}}}\noutputs: {{table: {{record: {{of: [beam.end.position.y, beam.positions]}}}}}}\n"
    "{more}"
)


@pytest.fixture(autouse=True)
def _few(monkeypatch):
    monkeypatch.setattr(element_runs, "PARTS", (2.0, 1.0, 0.5))
    monkeypatch.setattr(element_runs, "REPEATS", 1)


def scene(folder, cells=4, poisson=0.3, force="0 1 0", solver="equilibrium", more=""):
    path = folder / "beam.yaml"
    path.write_text(BAR.format(cells=cells, poisson=poisson, force=force, solver=solver, more=more), encoding="utf-8")
    return path


def test_all_elements_are_measured_over_spacings_and_each_run_is_told_as_it_ends(tmp_path):
    """A bench of `equilibrium` gave nothing for minutes."""
    done = CliRunner().invoke(cli, ["bench", str(scene(tmp_path)), "-o", str(tmp_path / "out")])
    assert done.exit_code == 0
    first = done.stderr.splitlines()[:2]
    assert first[0] == "beam by elements and spacings, by equilibrium:"
    assert "beam.end.position.y" in first[1]
    assert "equilibrium finds rests, and takes no steps" in done.stdout
    rows = list(csv.DictReader((tmp_path / "out.elements.csv").read_text().splitlines()))
    assert {row["quantity"] for row in rows} == {"displacements", "beam.end.position.y"}  # nodes are not compared
    for quantity in ("displacements", "beam.end.position.y"):
        mine = {
            one: [row for row in rows if (row["element"], row["quantity"]) == (one, quantity)]
            for one in ("p1", "p2", "p2_mean")
        }
        errors = {one: [float(row["error"]) for row in some] for one, some in mine.items()}
        assert errors["p1"] == sorted(errors["p1"], reverse=True)
        assert errors["p2"][1] < errors["p2"][0]
        assert errors["p2"][1] < 0.1 * errors["p1"][1]
        # Of 2, 4 and 8 cells by 1, 1 and 2 across the first two differ along alone: an order would tell nothing.
        assert [math.isnan(float(row["order"])) for row in mine["p1"]] == [True, True, False]
        assert float(mine["p1"][2]["order"]) == pytest.approx(math.log2(errors["p1"][1] / errors["p1"][2]))
    kept = json.loads((tmp_path / "out.json").read_text())["elements"]
    assert len(kept) == len(rows)


def test_the_error_is_that_of_the_exact_value_which_the_scene_expects(tmp_path, monkeypatch):
    """Tension of a bar that is free across: F L / E A, which every element finds."""
    exact = "{of: final(beam.end.position.x), value: 0.2 m + 1 N * 0.4 m / (1 MPa * 0.01 m^2), because: exact}"
    monkeypatch.setattr(element_runs, "PARTS", (2.0, 1.0))
    told = bench(load(scene(tmp_path, poisson=0, force="1 0 0", more=f"expect: {{longer: {exact}}}\n")), tmp_path / "o")
    assert "longer beside exact, 0.20004:" in told
    rows = list(csv.DictReader((tmp_path / "o.elements.csv").read_text().splitlines()))
    mine = [row for row in rows if row["quantity"] == "longer"]
    assert len([row for row in mine if row["element"] == "p2"]) == 2  # the finest, too
    assert all(float(row["error"]) < 1e-9 for row in mine)


def test_meshes_that_are_alike_are_run_once_and_what_takes_long_is_not_begun(tmp_path, monkeypatch):
    """A block of one cell is as coarse as it can be; an order between equal spacings was a division by zero."""
    monkeypatch.setattr(element_runs, "PARTS", (2.0, 1.4, 1.0))
    told = bench(load(scene(tmp_path, cells=1)), tmp_path / "o")
    assert "fewer than two runs by p2" in told
    monkeypatch.setattr(element_runs, "BUDGET", 1e-6)
    told = bench(load(scene(tmp_path, cells=2)), tmp_path / "o")
    assert "is not tried: it would take about" in told
    told = bench(load(scene(tmp_path, cells=1, solver="bdf2")), tmp_path / "o")
    assert "p1 at 2 of the spacing: at 1 s, beam: given up after 0 s" in told
    assert told.count("given up") == 3  # finer ones are not begun
    assert "beam: solvers are not compared" in told


def test_the_finest_run_is_by_elements_that_do_not_lock(tmp_path):
    graph = load(scene(tmp_path, poisson=0.49))
    (island,) = graph.islands
    assert solids(graph, island) == ["beam"]
    assert element_runs.best_of(graph, "beam") == "p2_mean"
    assert list(watched_of(graph, island)[0]) == ["beam.end.position.y"]
