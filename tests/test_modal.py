"""The solver `modal` and the modes of solids: beside exact frequencies, and beside steps of small length."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from numpy.random import Generator, Philox
from scipy.sparse import csr_array, diags_array

from runs import complaint, watch
from sceneql.failure import LimitRefused, RunFailure
from sceneql.march import modal_march
from sceneql.march.mode_loads import Modes
from sceneql.pipeline import load
from sceneql.run.run import Run
from sceneql.stepping.eigenmodes import lowest

TORSIONAL, SPHEROIDAL = 2.501132620409, 2.639869277902
"""Frequency times radius over shear speed of the first modes of a free sphere, both five-fold (REFERENCES: Poisson's
ratio 0.25)."""
SWING = "traction: {x: 0 Pa, y: 1 Pa * sin(20 rad/s * time), z: 0.3 Pa}"


def scene(fields, solver="modal", more="", end=1.0, law="linear: {modulus: 200 kPa, poisson: 0.3}"):
    return (
        f"models: {{body: {{elastic: {{law: {{{law}}}, density: 1000 kg/m^3, {fields}}}}}}}\n"
        f"solvers: {{main: {solver}}}\nclock: {{end: {end} s}}\n{more}"
    )


def bar(more="", cells="2, 1, 1"):
    held = "hold: {wall: {where: x < -0.49}}, probes: {tip: 0.5 0 0 m}"
    return f"block: {{size: 1 0.2 0.2 m, cells: [{cells}]}}, element: p2, {held}{more}"


def refused(folder, script):
    path = folder / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    with pytest.raises(LimitRefused) as found:
        Run(load(path, pruned=False))
    return found.value.diagnostic


def test_a_free_sphere_has_six_zero_modes_and_five_of_each_first_kind(tmp_path):
    ball = "objects: {ball: {sphere: {radius: 1 m, hidden: yes}}}\n"
    fields = "of: ball, spacing: 0.4 m, element: p2, modes: 16"
    script = scene(fields, "rk4", ball, law="linear: {modulus: 1 MPa, poisson: 0.25}")
    ((found,),) = watch(tmp_path, script, [0.0], "body.frequencies", pruned=False)
    assert not found[:6].any()
    times = 2 * np.pi * found[6:] / np.sqrt(1e6 / 2.5 / 1000.0)
    assert times[:5] == pytest.approx(np.full(5, TORSIONAL), rel=1.5e-3)
    assert times[5:] == pytest.approx(np.full(5, SPHEROIDAL), rel=1.5e-3)


@pytest.mark.parametrize("law", ["neo_hookean", "corotated", "saint_venant"])
@pytest.mark.parametrize("element", ["p1", "p2", "p2_mean"])
def test_the_modes_of_every_law_are_those_of_the_linear_one(tmp_path, law, element):
    fields = f"block: {{size: 1 0.2 0.3 m, cells: [3, 1, 1]}}, element: {element}, rotation: {{xyz: 10 20 30 deg}}"
    found = [
        watch(tmp_path, scene(fields, law=f"{one}: {{modulus: 2 kPa, poisson: 0.3}}"), [0.0], "body.frequencies")[0][0]
        for one in ("linear", law)
    ]
    assert found[1] == pytest.approx(found[0], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    "more",
    [
        f", loads: {{pull: {{where: x > 0.49, {SWING}}}}}",
        ", loads: {pull: {where: x > 0.49, force: {x: 0 N, y: {keys: {0 s: 0 N, 0.3 s: 1 N, 0.5 s: -1 N}}, z: 0 N}}}",
        f", loads: {{pull: {{where: x > 0.49, {SWING}}}}}, mass_damping: 2 Hz",
        f", retardation: 1 ms, loads: {{pull: {{where: x > 0.49, {SWING}}}}}",
        ", bent: {mode: 3, most: 1 mm}",
        ", velocity: 0.01 0.02 0 m/s",
    ],
)
def test_the_motion_of_a_linear_solid_is_that_of_small_steps_with_what_is_dissipated(tmp_path, more):
    outputs = ("body.tip.position", "body.tip.velocity", "body.dissipated", "body.kinetic")
    solvers = ("{modal: {modes: 1000}}", "{dop853: {tolerance: 1e-10, absolute: 1e-14}}")
    found = [watch(tmp_path, scene(bar(more), one), (0.17, 0.6), *outputs, pruned=False) for one in solvers]
    for own, steps in zip(*found, strict=True):
        for one, other in zip(own, steps, strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-9)


def test_a_solid_that_starts_in_a_mode_swings_at_its_frequency(tmp_path):
    ((told,),) = watch(tmp_path, scene(bar()), [0.0], "body.frequencies", pruned=False)
    outputs = ("body.displacements", "body.velocities")
    times = [0.0, 0.5 / told[1], 1.0 / told[1]]
    found = watch(tmp_path, scene(bar(", bent: {mode: 2, most: 5 mm}"), end=3.0), times, *outputs, pruned=False)
    start, half, whole = (one[0] for one in found)
    assert np.linalg.norm(start, axis=1).max() == pytest.approx(5e-3)
    np.testing.assert_allclose(half, -start, atol=1e-9)
    np.testing.assert_allclose(whole, start, atol=1e-9)


def test_masses_on_springs_have_modes_and_free_ones_fly_on(tmp_path):
    springs = (
        "models: {net: {mass_spring: {mass: 1 kg, masses: {a: {position: 0 0 0 m, fixed: yes}, "
        "b: {position: 1 0 0 m, velocity: 0.1 0 0 m/s}}, springs: [{between: [a, b], rest: 1 m, stiffness: 9 N/m}]}}}\n"
        "clock: {end: 2 s}\nsolvers: {main: modal}\n"
    )
    rows = watch(tmp_path, springs, [0.5, 1.7], "net.b.position", pruned=False)
    assert [row[0][0] - 1.0 for row in rows] == pytest.approx([0.1 / 3 * np.sin(3 * t) for t in (0.5, 1.7)])


def test_the_same_script_gives_the_same_bytes(tmp_path):
    script = scene(bar(", loads: {pull: {near: 0.5 0 0 m, force: 0 -1 0 N}}", "4, 1, 1"))
    found = [watch(tmp_path, script, [0.7], "body.displacements", pruned=False)[0][0].tobytes() for _ in range(2)]
    assert found[0] == found[1]


@pytest.mark.parametrize(
    ("fields", "more", "says"),
    [
        (bar(", loads: {pull: {where: x > 0.49, pressure: 1 kPa}}"), "", "the forces of 'body' have no potential"),
        (bar(", loads: {pull: {where: x > 0.49, pressure: {keys: {0 s: 0 Pa, 1 s: 1 Pa}}}}"), "", "changes in time"),
        (bar().replace("-0.49}", "-0.49, shift: {x: 1 cm * time/(1 s), y: 0 m, z: 0 m}}"), "", "modes are those of"),
        (bar(), "forces: {air: {drag: {linear: 1 N*s/m}}}", "its damping couples modes"),
    ],
)
def test_what_is_not_linear_motion_is_refused_at_its_line(tmp_path, fields, more, says):
    told = refused(tmp_path, scene(fields, more=more))
    assert says in told.message
    assert told.span is not None


def test_a_load_that_jumps_within_a_formula_ends_the_run(tmp_path):
    rough = "traction: {x: 0 Pa, y: 1 Pa * sin(1e9 rad/s * time), z: 0 Pa}"
    with pytest.raises(RunFailure, match="loads are not smooth"):
        watch(
            tmp_path,
            scene(bar(f", loads: {{pull: {{where: x > 0.49, {rough}}}}}")),
            [0.5],
            "body.kinetic",
            pruned=False,
        )


def test_a_mode_that_a_solid_has_not_is_told(tmp_path):
    script = scene("block: {size: 1 1 1 m, cells: [1, 1, 1]}, element: p1, bent: {mode: 99, most: 1 cm}")
    path = tmp_path / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    with pytest.raises(Exception, match="there is no mode 99: this solid has"):
        Run(load(path, pruned=False))
    assert "least" in complaint(tmp_path, script.replace("99", "0")) or "at least 1" in complaint(
        tmp_path, script.replace("99", "0")
    )


def test_equal_squares_are_all_found_and_modes_are_orthogonal():
    n = 600
    squares = np.repeat(np.arange(1.0, 1.0 + n / 6), 6)
    random = Generator(Philox(5))
    mass = diags_array(1.0 + random.random(n)).tocsr()
    stiffness = csr_array(diags_array(mass.diagonal() * squares))
    found, shapes = lowest(stiffness, mass, 20, random.random((n, 3)))
    np.testing.assert_allclose(found, squares[:20], rtol=1e-10)
    np.testing.assert_allclose(shapes.T @ (mass @ shapes), np.eye(20), atol=1e-10)


@pytest.mark.parametrize("square", [0.0, 1e-8, 4.0, 1e8])
@pytest.mark.parametrize("decay", [0.0, 0.3, 1e5])
def test_a_mode_moves_on_as_by_two_halves(square, decay):
    modes = Modes(np.array([decay]), np.array([square]))
    loads = np.array([[1.0, 2.0, -3.0, 0.5, 0.2]])
    q, speed, whole = modes.moved(np.array([0.3]), np.array([-0.2]), loads, 0.7)
    half = loads @ np.array(
        [[0.35 ** (j - k) / [1, 1, 2, 6, 24][j - k] if j >= k else 0.0 for k in range(5)] for j in range(5)]
    )
    first = modes.moved(np.array([0.3]), np.array([-0.2]), loads, 0.35)
    second = modes.moved(first[0], first[1], half, 0.35)
    scale = max(1.0, square**0.5)
    assert second[0] == pytest.approx(q, rel=1e-9, abs=1e-9)
    assert second[1] == pytest.approx(speed, rel=1e-8, abs=1e-9 * scale)
    assert first[2][0, 0] + second[2][0, 0] == pytest.approx(whole[0, 0], rel=1e-9, abs=1e-9)


def test_stiffness_that_may_vary_is_kept_once(tmp_path, monkeypatch):
    """Loads that vary have it looked at eight times, one after the other."""
    peaks = []

    def tangent(*arguments):
        tracemalloc.start()
        found = original(*arguments)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        return found

    original = modal_march.tangent
    monkeypatch.setattr(modal_march, "tangent", tangent)
    for force in ("0 -1 0 N", "{x: 0 N, y: 1 N * sin(20 rad/s * time), z: 0 N}"):
        script = scene(bar(f", loads: {{pull: {{near: 0.5 0 0 m, force: {force}}}}}", "6, 3, 3"))
        watch(tmp_path, script, [0.0], "body.displacements", pruned=False)
    assert peaks[1] < 1.4 * peaks[0]


def test_a_run_of_a_solid_holds_little_beside_its_numbers_and_integers(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(scene(bar(cells="4, 3, 3")), encoding="utf-8")
    graph = load(path, pruned=False)
    Run(graph)
    tracemalloc.start()
    run = Run(graph)
    held = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    system = run.islands[0].march.system
    assert held < 3.0 * (system.floats.nbytes + system.ints.nbytes)


@pytest.mark.parametrize(
    ("load", "exact"),
    [
        ("sin(2*t)", (math.sin(6) - 0.2 * math.sin(30)) / 96),
        ("where((t > 1)*(t < 1.01), 1, 0)", (math.cos(10 * 1.99) - math.cos(10 * 2.0)) / 100),
    ],
)
def test_loads_by_formulas_of_the_time_are_followed(tmp_path, load, exact):
    """A mass on a spring, 10 rad/s, under a force by formula: it was taken as constant, and nothing moved."""
    script = f"""
clock: {{end: 3 s}}
models:
  net:
    mass_spring:
      masses: {{a: {{position: 0 0 0 m, fixed: yes}}, b: {{position: 1 0 0 m, mass: 1 kg}}}}
      springs: [{{between: [a, b], stiffness: 100 N/m}}]
forces: [{{force: {{components: ["{load}", "0", "0"]}}}}]
solvers: {{main: modal}}
"""
    ((place,),) = watch(tmp_path, script, [3.0], "net.b.position")
    assert place[0] - 1 == pytest.approx(exact, abs=1e-6)
