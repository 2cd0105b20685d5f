"""What acts at the end of steps leaves those alone in which it changes nothing: their dense output and their cost."""

import numpy as np
import pytest

from sceneql.march.march_kernels import ALTERED
from sceneql.pipeline import load
from sceneql.run.run import Run

CLOTH = """
models:
  sheet: {{mass_spring: {{cloth: {{cells: {cells}, size: 0.6 0.6 m}}, mass: 0.01 kg, stiffness: {stiffness}, {more}}}}}
forces: [gravity]
solvers: {{main: {{{solver}}}}}
clock: {{end: {end} s}}
outputs: {{data: {{record: {{of: [sheet.positions]}}}}}}
"""


def march(folder, more="pins: [top]", solver="dop853: {tolerance: 1e-9}", end=1, cells="6 6", stiffness="100 N/m"):
    """Positions 30 times a second, how many springs are torn then, and the march."""
    path = folder / "scene.yaml"
    path.write_text(CLOTH.format(cells=cells, stiffness=stiffness, more=more, solver=solver, end=end))
    run = Run(load(path))
    rows = [
        (moment.read("sheet", "positions").copy(), moment.read("sheet", "torn"))
        for moment in run.moments(np.arange(1, 30 * end + 1) / 30)
    ]
    return np.array([row[0] for row in rows]), np.array([row[1] for row in rows]), run.islands[0].march


def test_a_tear_that_never_comes_costs_neither_accuracy_nor_evaluations(tmp_path):
    exact, _, _ = march(tmp_path, solver="dop853: {tolerance: 1e-13}")
    plain, _, without = march(tmp_path)
    torn, count, with_tear = march(tmp_path, "pins: [top], tear: {at: 1000}")
    assert count.max() == 0
    assert np.abs(torn - exact).max() < 3e-10
    np.testing.assert_array_equal(torn, plain)
    assert with_tear.statistics.evaluations == without.statistics.evaluations


@pytest.mark.parametrize(
    "pins",
    [
        pytest.param("top: {until: 100 s}", id="held, and let go after the end"),
        pytest.param("top: {shift: [0 m, 0 m, 0.1 m/s*time]}", id="led evenly"),
    ],
)
def test_a_pin_that_stands_where_it_must_costs_no_accuracy(tmp_path, pins):
    exact, _, _ = march(tmp_path, f"pins: {{{pins}}}", "dop853: {tolerance: 1e-13}")
    found, _, led = march(tmp_path, f"pins: {{{pins}}}", "dop853: {tolerance: 1e-9}")
    assert np.abs(found - exact).max() < 1e-9
    assert led.statistics.steps < 400  # far apart enough that the cubic through their ends is off by more


def test_a_pin_that_is_led_evenly_is_moved_by_hardly_any_step(tmp_path):
    path = tmp_path / "scene.yaml"
    pins = "pins: {top: {shift: [0 m, 0.2 m/s^2*time^2, 0.3 m/s*time]}}"
    solver = "dop853: {tolerance: 1e-9}"
    path.write_text(CLOTH.format(cells="4 4", stiffness="100 N/m", more=pins, solver=solver, end=1))
    run = Run(load(path))
    march, ends = run.islands[0].march, {}
    for moment in run.moments(np.linspace(0, 1, 4001)):
        assert moment.now <= march.time
        ends[march.time] = bool(march._counts[ALTERED])
    assert len(ends) > 100
    assert sum(ends.values()) <= 2


def test_a_pin_that_is_led_evenly_leaves_bdf2_its_order(tmp_path):
    more, errors = "pins: {top: {shift: [0 m, 0 m, 0.3 m/s*time]}}", []
    exact, _, _ = march(tmp_path, more, "dop853: {tolerance: 1e-12}", cells="4 4")
    for step in ("2 ms", "1 ms", "0.5 ms"):
        found, _, _ = march(tmp_path, more, f"bdf2: {{step: {step}}}", cells="4 4")
        errors.append(np.abs(found - exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.6).all(), (errors, orders)


def test_springs_tear_within_a_step_of_the_times_that_a_finer_run_tells(tmp_path):
    more = "pins: [top], tear: {at: 1.12}"
    _, fine, _ = march(tmp_path, more, "rk4: {step: 0.02 ms}", stiffness="20 N/m")
    _, found, marched = march(tmp_path, more, "dop853: {tolerance: 1e-9}", stiffness="20 N/m")
    assert fine[-1] > 3
    longest = int(np.ceil(30 * marched.end / marched.statistics.steps)) + 1
    assert found[-1] == fine[-1]
    for k in range(longest, len(fine) - longest):
        assert fine[k - longest] <= found[k] <= fine[k + longest]


def test_what_is_born_is_born_for_every_solver(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("""
models: {jet: {particles: {emit: {from: 0 1 0 m, velocity: 1 2 0 m/s, rate: 20 1/s, lifetime: 10 s}, mass: 1 g}}}
forces: [gravity]
solvers: {main: {dop853: {tolerance: 1e-9}}}
clock: {end: 1 s}
outputs: {data: {record: {of: [jet.positions]}}}
""")
    for moment in Run(load(path)).moments(np.linspace(0.1, 1, 10)):
        born = np.arange(0.0, moment.time + 1e-12, 0.05)
        age = moment.time - born
        places = np.array([age, 1 + 2 * age - 0.5 * 9.81 * age**2, 0 * age]).T
        found = moment.read("jet", "positions")
        assert found.shape == places.shape
        assert np.abs(found[np.argsort(found[:, 0])] - places[np.argsort(places[:, 0])]).max() < 1e-9
