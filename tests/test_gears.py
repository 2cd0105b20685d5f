"""Wheels that mesh: planets on an arm, against the accelerations of the two angles that are free; in a housing."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import runs
from sceneql.shapes.placement import rotation_matrix

SCRIPT = """
clock: {{end: 2 s}}
models:
  m:
    rigid:
      bodies:
        sun: {{mass: 1 kg, inertia: 1 1 0.02 kg*m^2}}
        arm: {{mass: 1 kg, inertia: 1 1 0.3 kg*m^2}}
        ring: {{mass: 1 kg, inertia: 1 1 2 kg*m^2}}
        planet: {{mass: 0.5 kg, inertia: 0.1 0.1 0.01 kg*m^2, position: 0.3 0 0 m}}
        crank: {{mass: 1e-9 kg, inertia: 1e-12 1e-12 1e-12 kg*m^2, position: 0.35 0 0 m}}
forces: []
ties:
  sun: {{hinge: {{between: [m.sun, world], at: 0 0 0 m, motor: {{torque: 1 N*m}}}}}}
  arm: {{hinge: {{between: [m.arm, world], at: 0 0 0 m, motor: {{torque: -0.4 N*m}}}}}}
  ring: {{hinge: {{between: [m.ring, world], at: 0 0 0 m, motor: {{torque: 0.3 N*m}}}}}}
  pin: {{hinge: {{between: [m.crank, m.planet], at: 0.35 0 0 m}}}}
  planet: {{hinge: {{between: [m.planet, m.arm], at: 0.3 0 0 m}}}}
  mesh: {{gear: {{between: [m.sun, m.planet], teeth: 20 10}}}}
  outer: {{gear: {{between: [m.planet, m.ring], teeth: 10 40, inner: yes}}}}
solvers: {{main: {{{solver}}}}}
"""


@pytest.mark.parametrize(
    ("solver", "good"), [("dop853: {tolerance: 1e-12}", 1e-6), ("verlet: {step: 1 ms}", 1e-4), ("radau", 1e-6)]
)
def test_a_planet_turns_against_the_line_from_axle_to_axle(tmp_path, solver, good):
    outputs = ("sun.angle", "arm.angle", "ring.angle", "planet.angle", "mesh.force")
    ((*angles, force),) = runs.watch(tmp_path, SCRIPT.format(solver=solver), [2], *outputs, pruned=False)
    # By angles s of the sun and a of the arm (Willis): the planet's is 3 a - 2 s, the ring's (3 a - s)/2.
    inertia = np.diag([0.02, 0.3 + 0.5 * 0.3**2, 2, 0.01])
    of = np.array([[1, 0], [0, 1], [-0.5, 1.5], [-2, 3]])
    pushed = np.linalg.solve(of.T @ inertia @ of, of.T @ [1, -0.4, 0.3, 0])
    sun, arm, ring, planet = 0.5 * 2**2 * of @ pushed
    np.testing.assert_allclose(angles, [sun, arm, ring, planet - arm], atol=good)
    # The force of the teeth on the sun, at its radius of 0.2 m.
    assert np.linalg.norm(force) == pytest.approx(abs(0.02 * pushed[0] - 1) / 0.2, rel=1e-6)


FREE = """
clock: {{end: 1 s}}
models:
  m:
    rigid:
      bodies:
        house: {{mass: 2 kg, inertia: 0.05 0.08 0.1 kg*m^2, velocity: 0.3 0 0 m/s, spin: 3 2 1 rad/s}}
        one: {{mass: 1 kg, inertia: 0.01 0.01 0.018 kg*m^2, position: 0.2 0 0 m, spin: 3 2 9 rad/s}}
        two: {{mass: 1 kg, inertia: {inertia} kg*m^2, position: -0.2 0.1 0.05 m}}
forces: []
ties:
  first: {{hinge: {{between: [m.one, m.house], at: 0.2 0 0.04 m, motor: {{torque: 0.02 N*m}}}}}}
  second: {{hinge: {{between: [m.two, m.house], at: -0.2 0.1 0.05 m, axis: {axis}}}}}
  mesh: {{gear: {{between: [m.one, m.two], teeth: 12 30, other_axis: {axis}}}}}
solvers: {{main: {{{solver}}}}}
"""


@pytest.mark.parametrize("axis", ["0 0 1", "1 0 0"])
@pytest.mark.parametrize(
    ("solver", "good"), [("dop853: {tolerance: 1e-11}", 1e-8), ("verlet: {step: 1 ms}", 1e-4), ("radau", 1e-5)]
)
def test_wheels_in_a_housing_that_tumbles_turn_against_it(tmp_path, axis, solver, good):
    """Round wheels leave the inertia of the whole: a gyrostat, whose wheels turn by 30 and by -12 of one angle."""
    axes = np.array([[0, 0, 1.0], [float(part) for part in axis.split()]])
    own = np.array([[0.01, 0.01, 0.018], 0.02 + 0.01 * axes[1]])
    script = FREE.format(axis=axis, solver=solver, inertia=" ".join(map(str, own[1])))
    outputs = ["m.house.spin", "m.one.spin", "first.angle", "second.angle", "m.house.rotation"]
    begin, end = runs.watch(tmp_path, script, [0, 1], *outputs, pruned=False)
    places, masses = np.array([[0, 0, 0], [0.2, 0, 0], [-0.2, 0.1, 0.05]]), np.array([2, 1, 1])
    whole = np.diag(np.array([0.05, 0.08, 0.1]) + own.sum(axis=0))
    for mass, arm in zip(masses, places - masses @ places / 4, strict=True):
        whole += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    by, about = np.array([30, -12]), np.array([0.018, 0.03])
    along = (about * by) @ axes
    both = np.block([[whole, along[:, None]], [along, about @ by**2]])

    def rate(_, y):
        # Momenta J w + g s, in the world, and g w + a s; the axes of the housing, in which both are; the angle.
        turn = y[3:12].reshape(3, 3)
        *spin, speed = np.linalg.solve(both, [*(turn.T @ y[:3]), y[13]])
        return [0, 0, 0, *np.cross(turn, spin).ravel(), speed, 30 * 0.02]

    first = both @ [*begin[0], (begin[1] - begin[0])[2] / 30]
    start = [*first[:3], *np.eye(3).ravel(), 0, first[3]]
    y = solve_ivp(rate, (0, 1), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    turn = y[3:12].reshape(3, 3)
    np.testing.assert_allclose(end[2:4], by * y[12], atol=good)
    np.testing.assert_allclose(rotation_matrix(end[4]), turn, atol=good)
    np.testing.assert_allclose(end[0], turn @ np.linalg.solve(both, [*(turn.T @ y[:3]), y[13]])[:3], atol=10 * good)


def test_an_axis_that_is_rounded_is_that_of_the_hinges(tmp_path):
    """It counted as none of the housing, which stood still then for the gear."""
    angles = []
    for axis in ("1 2 3", "0.267 0.535 0.802"):
        script = FREE.format(axis="1 2 3", solver="dop853: {}", inertia="0.02 0.02 0.02")
        script = script.replace("at: 0.2 0 0.04 m,", "at: 0.2 0 0.04 m, axis: 1 2 3,")
        script = script.replace("other_axis: 1 2 3", f"axis: {axis}, other_axis: {axis}").replace(
            "spin: 3 2 9", "spin: 3 2 1"
        )
        angles.append(runs.watch(tmp_path, script, [1], "first.angle", "second.angle", pruned=False)[0])
    np.testing.assert_allclose(*angles, atol=1e-3)
