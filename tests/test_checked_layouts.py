"""`check` tells what shows only as a flow is laid out among its solids, skins and fields."""

import pytest
from click.testing import CliRunner

from sceneql import pipeline
from sceneql.cli import cli
from test_errors import FOLDER

LAID_OUT = (
    "boundary-overlap.flow", "invalid.filling", "invalid.flow-wall", "invalid.open-side", "invalid.skin-coarse",
    "no-cell.flow", "no-cell.flow-gap", "other-domain", "out-of-range.viscosity",
)  # fmt: skip
AIR = "{flow: {size: 1 1 m, cell: 0.1 m, density: 1 kg/m^3, viscosity: 1 Pa*s, initial: {velocity: '[1, y]'}}}"


@pytest.mark.parametrize("name", LAID_OUT)
def test_check_tells_what_a_run_would(name, monkeypatch):
    monkeypatch.chdir(FOLDER)
    found = pipeline.errors_of_layout(pipeline.load(f"{name}.yaml"))
    told = (FOLDER / f"{name}.txt").read_text().rstrip("\n").split("\n\n")
    assert list(map(str, found)) == [one for one in told if one.startswith("error")] != []


def test_fluid_that_solids_close_off_fails_a_check(tmp_path):
    scene = tmp_path / "scene.yaml"
    boundary = "boundary: {left: {inflow: {velocity: '[1, 0]'}}, right: {outflow: {}}}"
    bar = "objects: {bar: {box: {size: 0.2 2 1 m, position: 0.5 0.5 0 m}}}\n"
    air = AIR.replace("initial: {velocity: '[1, y]'}", f"around: [bar], {boundary}")
    scene.write_text(f"clock: {{end: 1 s}}\n{bar}models: {{air: {air}}}\n", encoding="utf-8")
    result = CliRunner().invoke(cli, ["check", str(scene)])
    assert result.exit_code == 1
    assert "'bar' closes this part of it off" in str(result.exception)


def test_many_cells_are_left_to_the_run(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(f"clock: {{end: 1 s}}\nmodels: {{air: {AIR}}}\n", encoding="utf-8")
    assert pipeline.load(scene).tasks["air"].kind.told_by_layout()
    fine = pipeline.load(scene, sets=["models.air.flow.cell=1 mm"])
    assert not fine.tasks["air"].kind.told_by_layout()
