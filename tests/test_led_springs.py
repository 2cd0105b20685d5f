"""Springs that hang from places that move: the motion, its energy, the bound on the step."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from runs import watch
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run
from sceneql.run.watch import Watch

LED = """
clock: {end: 1 s}
models:
  hand: {motion: {position: "[0.1 m*sin(3*time/(1 s)), 0, 0]"}}
  bob: {particles: {list: {a: {mass: 2 kg, position: 1 0 0 m}}}}
forces: {tie: {spring: {from: ENDS, stiffness: 32 N/m, damping: DAMPING N*s/m, rest: 1 m}}}
solvers: {main: {SOLVER}}
"""
TIED = "hand.position, to: bob.a.position"


def scripted(solver, damping=0, ends=TIED):
    return LED.replace("ENDS", ends).replace("DAMPING", str(damping)).replace("SOLVER", solver)


def loaded_from(tmp_path, script):
    path = tmp_path / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    return load(path)


@pytest.mark.parametrize("ends", [TIED, "bob.a.position, to: hand.position"])
@pytest.mark.parametrize("damping", [0, 4])
def test_a_spring_hangs_from_a_motion_and_dashpots_know_its_velocity(tmp_path, ends, damping):
    """m x'' = -k (x - 1 - u) - c (x' - u'), u = sin(3 t)/10, by scipy; what the hand gives is counted."""

    def rate(t, y):
        x, v = y
        return v, -16 * (x - 1 - 0.1 * math.sin(3 * t)) - 0.5 * damping * (v - 0.3 * math.cos(3 * t))

    script = scripted("dopri5: {tolerance: 1e-11}", damping, ends)
    outputs = ("bob.a.position", "bob.a.velocity", "bob.energy")
    first, last = watch(tmp_path, script, [0, 1], *outputs)
    exact = solve_ivp(rate, (0, 1), [1, 0], rtol=1e-12, atol=1e-12).y[:, -1]
    assert [last[0][0], last[1][0]] == pytest.approx(exact, abs=1e-8)
    assert last[2] == pytest.approx(first[2], abs=1e-8)


def test_implicit_solvers_know_how_fast_the_place_of_a_dashpot_moves(tmp_path):
    (explicit,), (implicit,) = (
        watch(tmp_path, scripted(f"{word}: {{tolerance: 1e-10}}", 4), [1], "bob.a.position", "bob.a.velocity")
        for word in ("dopri5", "radau")
    )
    np.testing.assert_allclose(implicit, explicit, rtol=0, atol=1e-8)


def test_the_momentum_of_what_hangs_from_a_motion_is_not_watched(tmp_path):
    graph = loaded_from(tmp_path, scripted("rk4: {}"))
    assert [balance.isolated for balance in Watch(Run(graph), always=True).balances] == [False]


def test_a_spring_from_a_motion_bounds_the_step_as_one_from_a_place(tmp_path):
    """2/omega of verlet, omega = 4/s."""
    (warning,) = loaded_from(tmp_path, scripted("verlet: {step: 0.6 s}")).warnings
    assert "dt = 0.6 s exceeds 0.5 s, set by force 'tie'" in warning.message


def test_a_damped_spring_needs_a_place_whose_velocity_is_known(tmp_path):
    script = scripted("rk4: {}", 4, "bob.a.position, to: 2*bob.a.position")
    with pytest.raises(ScriptError, match="how fast its ends move") as told:
        Run(loaded_from(tmp_path, script))
    assert "scene.yaml:6:" in str(told.value)


@pytest.mark.parametrize("model", ["particles: {of: ball, mass: 2 kg}", "rigid: {of: ball, mass: 2 kg}"])
def test_a_spring_at_an_object_pulls_what_moves_it(tmp_path, model):
    """x = 1 + cos(omega t)/2, omega^2 = 32/2, whether the object or the mass is named; it was left out before."""
    script = f"""
clock: {{end: 1 s}}
objects: {{ball: {{sphere: {{position: 1.5 0 0 m}}}}}}
models: {{body: {{{model}}}}}
forces: {{tie: {{spring: {{from: ball.position, to: 0 0 0 m, stiffness: 32 N/m, rest: 1 m}}}}}}
solvers: {{main: {{dopri5: {{tolerance: 1e-11}}}}}}
"""
    _, last = watch(tmp_path, script, [0, 1], "body.position", "ball.position")
    assert [last[0][0], last[1][0]] == pytest.approx(2 * [1 + 0.5 * math.cos(4)], abs=1e-8)


def test_keys_of_an_object_that_a_model_moves_are_told_to_be_lost(tmp_path):
    script = """
objects: {ball: {sphere: {position: {keys: {0 s: 0 2 0 m, 1 s: 1 2 0 m}}}}}
models: {fall: {particles: {of: ball}}}
forces: [gravity]
"""
    (warning,) = loaded_from(tmp_path, script).warnings
    assert warning.code == "moved-twice"
    assert not loaded_from(
        tmp_path, script.replace("particles: {of: ball}", "particles: {positions: [0 1 0 m]}")
    ).warnings
