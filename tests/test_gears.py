"""Wheels that mesh: planets on an arm, against the accelerations of the two angles that are free."""

import numpy as np
import pytest

import runs

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
