"""Waves on grids: frequencies of membranes, energies, edges, what scripts get wrong."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import eigsh

from sceneql.march.driver import jacobian
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import IslandRun
from sceneql.words.solvers.rk4 import Rk4

DRUM = np.array([2.404825557695773, 3.831705970207512, 3.831705970207512, 5.135622301840683, 5.135622301840683,
                 5.520078110286311])  # fmt: skip
"""Zeros of Bessel functions: frequencies of a drum of radius 1 at speed 1."""
SQUARE = np.pi * np.sqrt([2.0, 5.0, 5.0, 8.0, 10.0, 10.0])
HELD = "boundary: {rest: {value: 0}}"


def wave(folder, fields, solver="{verlet: {step: 1 ms}}", objects="", end=1.0):
    path = folder / "scene.yaml"
    text = f"clock: {{end: {end} s}}\n{objects}models: {{skin: {{wave: {{of: number, {fields}}}}}}}\n"
    path.write_text(f"{text}solvers: {{main: {solver}}}\n", encoding="utf-8")
    graph = load(path, pruned=False)
    run = IslandRun(graph, graph.islands[0])
    run.advance(0.0)
    kind = graph.tasks["skin"].kind

    def read(output):
        return kind.read(output, run.state("skin"))

    return SimpleNamespace(run=run, kind=kind, read=read)


def frequencies(folder, fields, objects=""):
    """The lowest six, by the slopes of the wave's rate."""
    made = wave(folder, fields, "rk4", objects)
    march = March(made.run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
    system, values = march.system, np.zeros(march.system.pattern.room)
    jacobian(system)(march._engaged.functions, 0.0, system.y, values, march.floats, system.ints)
    places = system.pattern.rows, system.pattern.columns
    n = (len(system.y) - 2) // 2
    matrix = coo_matrix((values[: system.pattern.count], places)).tocsr()[n + 1 : 2 * n + 1, :n]
    inside = np.flatnonzero(matrix.diagonal())
    return np.sqrt(np.sort(eigsh(-matrix[inside][:, inside].tocsc(), k=6, sigma=0)[0]))


@pytest.mark.parametrize(
    ("exact", "place", "objects"),
    [
        (SQUARE, "size: 1 1 m", ""),
        (DRUM, "domain: disk, flat: yes", "objects: {disk: {sphere: {radius: 1 m}}}\n"),
    ],
)
def test_six_frequencies_of_a_membrane_are_of_second_order(tmp_path, exact, place, objects):
    sides = 1 / 12, 1 / 24, 1 / 48
    errors = [
        np.abs(frequencies(tmp_path, f"{place}, cell: {side} m, speed: 1, {HELD}", objects) / exact - 1).max()
        for side in sides
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.9
    assert errors[2] < 2e-3


def test_the_frequency_of_a_run_is_that_of_its_speed(tmp_path):
    fields = f"size: 1 1 m, cell: 1/32 m, speed: 2, initial: sin(pi*x)*sin(pi*y), probes: {{mid: 0.5 0.5 m}}, {HELD}"
    made = wave(tmp_path, fields)
    start = made.read("mid")
    at = 2 * np.sqrt(2) * 32 * np.sin(np.pi / 64) * 2  # of the grid, radians in a second
    made.run.advance(0.7)
    assert made.read("mid") == pytest.approx(start * np.cos(0.7 * at), abs=1e-4)


@pytest.mark.parametrize(("solver", "drift"), [("implicit_midpoint", 1e-10), ("verlet", 2e-2)])
def test_the_energy_stays_over_a_hundred_periods(tmp_path, solver, drift):
    fields = f"size: 1 1 m, cell: 1/8 m, speed: 1, initial: exp(-20*((x-0.4)^2 + (y-0.3)^2)), {HELD}"
    made = wave(tmp_path, fields, f"{{{solver}: {{step: 10 ms}}}}", end=142)
    first = made.read("energy")
    found = []
    for time in np.linspace(0, 141.6, 31).round(2):
        made.run.advance(time)
        found.append(made.read("energy") / first - 1)
    assert first > 0
    assert np.abs(found).max() < drift
    assert abs(np.mean(found[-10:]) - np.mean(found[:10])) < drift / 4


def test_a_pond_keeps_its_volume_and_its_energy_whatever_its_depth(tmp_path):
    fields = "size: 2 1 m, cell: 0.1 m, speed: sqrt(9.81*(0.1 + 0.05*x)), initial: exp(-9*(x-1)^2)"
    made = wave(tmp_path, fields, "{implicit_midpoint: {step: 5 ms}}")
    volume, energy = made.read("volume"), made.read("energy")
    made.run.advance(1.0)
    assert made.read("volume") == pytest.approx(volume, rel=1e-12)
    assert made.read("energy") == pytest.approx(energy, rel=1e-11)
    assert np.abs(made.read("velocity")).max() > 0.1


def test_damping_is_the_decay_of_amplitudes(tmp_path):
    fields = f"size: 1 1 m, cell: 0.1 m, speed: 1, damping: 0.5, initial: sin(pi*x)*sin(pi*y), {HELD}"
    made = wave(tmp_path, fields, "{dopri5: {tolerance: 1e-10}}", end=4)
    first = made.read("energy")
    made.run.advance(4.0)
    assert made.read("energy") / first == pytest.approx(np.exp(-4.0), rel=0.2)


@pytest.mark.parametrize("cell", [1 / 32, 1 / 64])
def test_an_open_side_throws_back_what_half_a_cell_delays(tmp_path, cell):
    """A wave of number k keeps k cell/4 of its amplitude; the mean of k^2 by energy is 24 for this start."""
    fields = f"size: 4 0.25 m, cell: {cell} m, speed: 1, initial: exp(-8*(x-2)^2), "
    made = wave(tmp_path, fields + "boundary: {left: {open: yes}, right: {open: yes}}", "{rk4: {step: 5 ms}}", end=5)
    first = made.read("energy")
    made.run.advance(5.0)
    assert made.read("energy") / first == pytest.approx(24 * (cell / 4) ** 2, rel=0.05)


def test_an_edge_that_moves_sends_waves_in(tmp_path):
    fields = "size: 3 0.2 m, cell: 0.02 m, speed: 1, boundary: {left: {value: sin(4*t)}, right: {open: yes}}"
    made = wave(tmp_path, fields, "{rk4: {step: 5 ms}}", end=6)
    made.run.advance(6.0)
    x = made.read("centers")[:, 0]
    assert np.abs(made.read("value") - np.sin(4 * (6 - x))).max() < 0.03


def test_gauss_radau15_steps_over_instants_without_acceleration(tmp_path):
    fields = f"size: 1 1 m, cell: 1/16 m, speed: 1, initial: sin(pi*x)*sin(pi*y), probes: {{mid: 0.5 0.5 m}}, {HELD}"
    made = wave(tmp_path, fields, "{gauss_radau15: {tolerance: 1e-9}}")
    start = made.read("mid")
    made.run.advance(1.0)
    at = 2 * np.sqrt(2) * 16 * np.sin(np.pi / 32)
    assert made.read("mid") == pytest.approx(start * np.cos(at), abs=1e-10)
    assert made.run.march.statistics.steps < 50


def test_a_mode_whose_edges_throw_back_as_much_as_they_take_is_marched_by_itself(tmp_path):
    """What comes in over all held edges is rounding: its error once asked for 7500 steps in place of 23."""
    held = "boundary: {bottom: {value: 0}, top: {value: 0}}"
    fields = f"size: 1 1 m, cell: 1/16 m, speed: 1, initial: cos(pi*x)*sin(pi*y), {held}"
    made = wave(tmp_path, fields, "auto")
    start = made.read("value")
    made.run.advance(1.0)
    at = 2 * np.sqrt(2) * 16 * np.sin(np.pi / 32)
    assert made.read("value") == pytest.approx(start * np.cos(at), abs=1e-5)
    assert made.run.march.statistics.steps < 50


def test_a_source_may_read_the_field(tmp_path):
    """A kink of the sine-Gordon equation at rest, 4 atan(exp(x)), stays (Skyrme 1962)."""
    fields = "size: 20 1 m, corner: -10 0 m, cell: 0.1 m, speed: 1, source: -sin(c), initial: 4*atan(exp(x))"
    made = wave(tmp_path, fields, "{implicit_midpoint: {step: 20 ms}}", end=3)
    before = made.read("value").copy()
    made.run.advance(3.0)
    assert np.abs(made.read("value") - before).max() < 2e-3


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ("size: 1 1 m, cell: 0.1 m, speed: -1 m/s", "the speed must be at least 0"),
        ("size: 1 1 m, cell: 0.1 m, speed: 1 m/s, damping: -1 /s", "the damping must be at least 0"),
        ("size: 1 1 m, cell: 0.1 m, speed: 1 m/s, damping: x - 0.5", "the damping must be at least 0"),
        ("size: 1 1 m, cell: 0.1 m, speed: x - 0.5, boundary: {left: {open: yes}}", "the speed must be at least 0"),
        (
            "size: 1 1 m, cell: 0.1 m, speed: 1 m/s, probes: {velocity: 0.5 0.5 m}",
            "a probe cannot be called 'velocity'",
        ),
        ("size: 1 1 m, cell: 0.1 m, speed: 1 m/s, probes: {energy: 0.5 0.5 m}", "a probe cannot be called 'energy'"),
        ("size: 1 1 m, cell: 0.1 m, speed: 1/(x - 0.55)/0", "not finite"),
        (
            "size: 1 1 m, cell: 0.1 m, speed: 1 m/s, boundary: {left: {value: 0, open: yes}}",
            "one of `value`, `periodic`",
        ),
        ("size: 1 1 m, cell: 0.1 m, speed: 1 m/s, boundary: {front: {value: 0}}", "no side 'front'"),
        ("cell: 0.1 m, speed: 1 m/s", "in one of the two: a box, `size: 1 1 m`, or an object, `domain: plate`"),
        ("size: 1 1 m, cell: 0.1 m, speed: 1 kg", "speed"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, fields, told):
    with pytest.raises(ScriptError, match=told):
        wave(tmp_path, fields)
