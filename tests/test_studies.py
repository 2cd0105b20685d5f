"""Studies: values in place of the script's, and what comes of them."""

from __future__ import annotations

import csv
import json
import math
import xml.etree.ElementTree as ET

import pytest
from click.testing import CliRunner

from sceneql import pipeline
from sceneql.cli import cli
from sceneql.failure import Unsuitable
from sceneql.report.plots import study_errors
from sceneql.report.study import trials
from sceneql.report.study_page import study

SCENE = """
define: {k: 100 N/m, dt: 10 ms, w: sqrt(k/(1 kg))}
clock: {end: 1 s}
models:
  spring:
    mass_spring:
      masses: {wall: {position: 0 0 0 m, fixed: yes}, bob: {position: 1 0 0 m, mass: 1 kg}}
      springs: [{between: [wall, bob], rest: 0 m, stiffness: k}]
solvers: {main: {rk4: {step: dt}}}
studies:
  steps:
    sweep:
      dt: 1e-3 .. 1e-1 s, 3 points
      solvers.main: [{euler: {step: dt}}, {rk4: {step: dt}}]
    of: final(spring.bob.position.x)
    exact: 1 m*cos(w*(1 s))
    measure: {most: max(spring.bob.position.x)}
  stiff:
    sweep: {k: 1e2 .. 1e8 N/m, solvers.main: [{rk4: {step: dt}}, {radau: {tolerance: 1e-6}}]}
    of: final(spring.bob.position)
    reference: {solvers.main: {dop853: {tolerance: 1e-12}}}
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def loading(path):
    return lambda more: pipeline.load(path, sets=more, pruned=False)


def test_errors_are_those_of_the_methods(scene):
    found = list(trials(loading(scene), "steps"))
    assert [tuple(value.label for value in trial.values) for trial in found] == [
        (f"{step} s", word) for step in ("0.001", "0.01", "0.1") for word in ("euler", "rk4")
    ]
    right = math.cos(10.0)
    for trial in found:
        step, z = trial.values[0].number, 10j * trial.values[0].number
        growth = 1 + z + (z**2 / 2 + z**3 / 6 + z**4 / 24 if trial.values[1].label == "rk4" else 0)
        by_hand = (growth ** round(1 / step)).real  # of y' = i w y, y(0) = 1
        assert trial.error == pytest.approx(abs(by_hand - right) / abs(right), rel=1e-6, abs=1e-12)
        assert trial.steps == round(1 / step)
        assert trial.outcome == ("stable" if trial.error <= 0.1 else "inaccurate")
        assert trial.measured["most"] >= 1


def test_a_study_may_be_compared_with_another_solver_and_says_what_fails(scene):
    graph = pipeline.load(scene, sets=["studies.stiff.sweep.k=1e2 .. 1e6 N/m, 3 points"])
    assert graph.settings.studies["stiff"].exact is None
    load = lambda more: pipeline.load(  # noqa: E731
        scene, sets=["studies.stiff.sweep.k=1e2 .. 1e6 N/m, 3 points", *more], pruned=False
    )
    found = {tuple(value.label for value in trial.values): trial for trial in trials(load, "stiff")}
    assert found["100 N/m", "rk4"].outcome == "stable"
    assert found["1e+06 N/m", "rk4"].outcome == "failed"
    assert "unstable" in found["1e+06 N/m", "rk4"].why
    assert all(found[k, "radau"].error < 1e-2 for k in ("100 N/m", "1e+04 N/m"))


def test_a_report_has_every_run(scene, tmp_path):
    told = study(loading(scene), "steps", tmp_path)
    assert "euler  . ~ ~" in told
    with (tmp_path / "scene.steps.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert all(0.0 < float(row["seconds"]) <= float(row["median"]) for row in rows)
    for name in ("scene.steps.png", "scene.steps.map.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    runs = json.loads((tmp_path / "scene.steps.json").read_text())["runs"]
    assert len(rows) == len(runs) == 6
    assert [float(row["error"]) for row in rows] == [run["error"] for run in runs]
    assert {row["solvers.main"] for row in rows} == {"euler", "rk4"}
    page = (tmp_path / "scene.steps.html").read_text()
    assert page.count("data:image/svg+xml") == 2
    assert page.count("<tr>") == 7


def test_a_study_must_be_named_where_there_are_several(scene, tmp_path):
    with pytest.raises(Unsuitable, match="which study"):
        study(loading(scene), None, tmp_path)
    with pytest.raises(Unsuitable, match="did you mean 'stiff'"):
        study(loading(scene), "stif", tmp_path)
    with pytest.raises(Unsuitable, match="has no `studies`"):
        study(lambda more: pipeline.load(scene, sets=["studies={}", *more]), None, tmp_path)


def test_checking_a_script_tries_every_value(scene):
    scene.write_text(SCENE.replace("{rk4: {step: dt}}]", "{rk4: {stepp: dt}}]", 1), encoding="utf-8")
    said = CliRunner().invoke(cli, ["check", str(scene)])
    assert "rk4 has no field 'stepp'" in str(said.exception)
    assert "scene.yaml:14:" in str(said.exception)


@pytest.mark.parametrize(
    ("numbers", "told"),
    [((1.0, 7.0, 50.0), ["1", "2", "5", "10", "20", "50"]), ((1e-6, 1e-2), ["10\u22126", "10\u22122"])],
)
def test_few_digits_stand_at_an_axis_without_powers_of_ten(tmp_path, numbers, told):
    runs = {"rk4": [(number, 1e-4 * number, 1e-3, 1e-3) for number in numbers]}
    study_errors(tmp_path / "study.svg", "scene: steps", "dt [ms]", runs)
    below = ET.parse(tmp_path / "study.svg").getroot().find(".//*[@id='axes_2']/*[@id='matplotlib.axis_3']")
    written = ["".join("".join(one.itertext()).split()) for one in below.iter("{http://www.w3.org/2000/svg}text")]
    assert [text for text in written if text in told] == sorted(told, key=written.index)
