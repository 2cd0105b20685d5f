"""Nets that collide with themselves: layers of cloth do not pass through each other, and momentum stays."""

import numpy as np
import pytest

from runs import watch
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run

FOLDS = """
clock: {end: 0.8 s}
models:
  sheet:
    cloth:
      size: 0.2 0.8 m
      cells: 4 16
      center: 0 0.55 0 m
      facing: 0 0 1
      rotation: {about: x, angle: 6 deg}
      stretch: 100 N/m
      shear: 10 N/m
      bend: 0.3 N/m
      damping: 0.1
      thickness: 60 mm
objects: {floor: plane}
forces: [gravity, {drag: {linear: 0.1 g/s}}]
contacts:
  land: {collision: {between: [sheet, floor], restitution: 0, friction: 0.4, mode: local}}
  self: {mutual_collision: {between: [sheet, floor], restitution: 0, friction: 0.3, mode: local}}
solvers: {main: {rk4: {step: 1 ms}}}
"""


def test_a_strip_that_folds_lies_on_itself(tmp_path):
    """Sides of cells are 50 mm: its masses overlap, but none that no spring ties comes nearer than the thickness."""
    path = tmp_path / "scene.yaml"
    path.write_text(FOLDS)
    energies, nearest, layers = [], [], []
    for moment in Run(load(path)).moments(np.linspace(0, 0.8, 33)):
        net = moment.run.graph.tasks["sheet"].kind.net
        x = moment.read("sheet", "positions")
        i, j = np.triu_indices(len(x), 1)
        tied = np.isin(i * len(x) + j, np.sort(net.pairs, axis=1) @ [len(x), 1])
        tied |= np.linalg.norm(net.points[i] - net.points[j], axis=1) < 0.06
        apart = np.linalg.norm(x[i] - x[j], axis=1)
        nearest.append(apart[~tied].min())
        layers.append(np.count_nonzero(apart[~tied] < 0.061))
        energies.append(moment.read("sheet", "energy"))
    assert min(nearest) > 0.97 * 0.06
    assert layers[-1] > 20
    assert max(energies) < energies[0] * (1 + 1e-3)
    assert moment.read("self", "hits.count") > 20


HAIRPIN = """
clock: {{end: 0.2 s}}
models:
  pin:
    mass_spring:
      masses:
        top: {{position: 0 0.2 0 m, velocity: 0.3 -1 0 m/s}}
        bend: {{position: 0.08 0.1 0.01 m}}
        bottom: {{position: 0 0 0.02 m, velocity: 0 1 0 m/s}}
      springs: [{{between: [top, bend]}}, {{between: [bend, bottom]}}]
      radius: 70 mm
contacts: {{hit: {{mutual_collision: {{restitution: {restitution}, mode: {mode}}}}}}}
solvers: {{main: {{rk4: {{step: 0.1 ms}}}}}}
"""


@pytest.mark.parametrize("restitution", [0, 0.5, 1])
def test_ends_of_a_hairpin_meet_and_keep_momentum(tmp_path, restitution):
    names = ("pin.momentum", "pin.angular_momentum", "pin.energy", "hit.hits.count", "pin.positions")
    rows = watch(tmp_path, HAIRPIN.format(restitution=restitution, mode="local"), np.linspace(0, 0.2, 41), *names)
    for momentum, spin, energy, _, x in rows:
        np.testing.assert_allclose(momentum, rows[0][0], atol=1e-13)
        np.testing.assert_allclose(spin, rows[0][1], atol=1e-6)
        assert energy == pytest.approx(rows[0][2], rel=1e-4)
        assert np.linalg.norm(x[0] - x[2]) > 0.14 * (1 - 1e-6)
    assert rows[-1][3] >= 1
    assert min(np.linalg.norm(x[0] - x[1]) for *_, x in rows) < 0.14  # tied masses do not meet


def test_in_exact_mode_all_masses_meet_and_so_must_be_apart(tmp_path):
    with pytest.raises(ScriptError, match="mass 0 of 'pin' and mass 1 of 'pin' overlap"):
        watch(tmp_path, HAIRPIN.format(restitution=1, mode="exact"), [0], "pin.energy")
