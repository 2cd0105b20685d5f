"""Forces by their exact solutions."""

import math

import numpy as np
import pytest

from runs import complaint, watch

DOPRI5 = "solvers: {main: {dopri5: {tolerance: 1e-11}}}"


def test_a_projectile_flies_a_parabola_and_keeps_its_energy(tmp_path):
    script = f"""
clock: {{end: 3 s}}
models: {{shot: {{particles: {{list: {{ball: {{mass: 2 kg, position: 0 1 0 m, velocity: 3 10 -1 m/s}}}}}}}}}}
forces: [gravity]
{DOPRI5}
"""
    for t in (0.5, 2.9):
        ((place, energy, momentum),) = watch(
            tmp_path, script, [t], "shot.ball.position", "shot.energy", "shot.momentum"
        )
        np.testing.assert_allclose(place, [3 * t, 1 + 10 * t - 4.905 * t**2, -t], rtol=0, atol=1e-9)
        assert energy == pytest.approx(110 + 2 * 9.81, abs=1e-9)
        np.testing.assert_allclose(momentum, [6, 20 - 2 * 9.81 * t, -2], rtol=0, atol=1e-9)


def test_gravity_by_vector_and_by_direction_is_the_same(tmp_path):
    def end(force: str) -> np.ndarray:
        script = f"""
clock: {{end: 1 s}}
models: {{stone: {{particles: {{list: {{a: {{}}}}}}}}}}
forces: {{pull: {{gravity: {force}}}}}
solvers: {{main: {{rk4: {{step: 10 ms}}}}}}
"""
        return watch(tmp_path, script, [1], "stone.a.position")[0][0]

    vector = end("{acceleration: 0 -3 -4 m/s^2}")
    np.testing.assert_allclose(end("{strength: 5 m/s^2, direction: 0 -6 -8}"), vector, rtol=1e-14)
    np.testing.assert_allclose(vector, [0, -1.5, -2], rtol=1e-12)


def test_gravity_that_varies_in_time_is_seen_at_stage_times(tmp_path):
    script = """
clock: {end: 2 s}
models: {stone: {particles: {list: {a: {}}}}}
forces: {pull: {gravity: {strength: 6 m/s^3 * time}}}
solvers: {main: {rk4: {step: 0.5 s}}}
"""
    ((place,),) = watch(tmp_path, script, [2], "stone.a.position")
    assert place[1] == pytest.approx(-8.0, rel=1e-12)  # -t^3: rk4 is exact for a cubic


def test_linear_drag_decays_exponentially_and_counts_what_it_takes(tmp_path):
    script = f"""
clock: {{end: 3 s}}
models: {{shot: {{particles: {{list: {{a: {{mass: 2 kg, velocity: 3 0 4 m/s}}}}}}}}}}
forces: {{air: {{drag: {{linear: 0.8 N*s/m}}}}}}
{DOPRI5}
"""
    ((v, lost, energy),) = watch(tmp_path, script, [3], "shot.a.velocity", "shot.dissipated", "shot.energy")
    factor = math.exp(-0.4 * 3)
    np.testing.assert_allclose(v, np.array([3, 0, 4]) * factor, rtol=1e-9)
    assert lost == pytest.approx(25 * (1 - factor**2), rel=1e-9)
    assert energy == pytest.approx(25, rel=1e-10)


def test_quadratic_drag_leads_to_the_terminal_velocity(tmp_path):
    script = f"""
clock: {{end: 4 s}}
models: {{shot: {{particles: {{list: {{a: {{mass: 0.5 kg}}}}}}}}}}
forces: {{weight: gravity, air: {{drag: {{quadratic: 0.02 kg/m}}}}}}
{DOPRI5}
"""
    terminal = math.sqrt(0.5 * 9.81 / 0.02)
    for t in (1.0, 4.0):
        ((v, energy),) = watch(tmp_path, script, [t], "shot.a.velocity", "shot.energy")
        assert v[1] == pytest.approx(-terminal * math.tanh(9.81 * t / terminal), rel=1e-9)
        assert energy == pytest.approx(0, abs=1e-7)


ORBIT = """
clock: {{end: {end}}}
models: {{sky: {{particles: {{list: {{moon: {{mass: 3 kg, position: {place}, velocity: {velocity}}}}}}}}}}}
forces: {{sun: {{attractor: {{strength: {strength}{more}}}}}}}
solvers: {{main: {{dopri5: {{tolerance: 1e-12}}}}}}
"""


def test_a_circular_orbit_closes_and_an_ellipse_keeps_energy_and_angular_momentum(tmp_path):
    period = 2 * math.pi * math.sqrt(8 / 10)
    circle = ORBIT.format(
        end=f"{period} s", place="2 0 0 m", velocity=f"[0, {math.sqrt(5)}, 0]", strength="10 m^3/s^2", more=""
    )
    ((place,),) = watch(tmp_path, circle, [period], "sky.moon.position")
    np.testing.assert_allclose(place, [2, 0, 0], rtol=0, atol=1e-9)

    # Half the period of an ellipse of eccentricity 0.6 leads from pericenter 0.4 to apocenter 1.6.
    half = math.pi
    ellipse = ORBIT.format(end=f"{half} s", place="0.4 0 0 m", velocity="0 2 0 m/s", strength="1 m^3/s^2", more="")
    (first, last) = watch(
        tmp_path, ellipse, [0, half], "sky.moon.position", "sky.energy", "sky.angular_momentum", "sky.potential"
    )
    np.testing.assert_allclose(last[0], [-1.6, 0, 0], rtol=0, atol=1e-9)
    assert first[1] == pytest.approx(3 * (2 - 2.5), rel=1e-12)
    assert last[1] == pytest.approx(first[1], rel=1e-10)
    np.testing.assert_allclose(last[2], [0, 0, 3 * 0.8], rtol=1e-10, atol=1e-12)
    assert last[3] == pytest.approx(-3 / 1.6, rel=1e-9)


@pytest.mark.parametrize("more", ["exponent: -1", "exponent: 1, softening: 0.1 m", "exponent: 3", "softening: 0.3 m"])
def test_every_attractor_has_the_potential_of_its_force(tmp_path, more):
    script = ORBIT.format(
        end="1.5 s", place="1 0.2 0 m", velocity="0 1 0.5 m/s", strength="1.3 m^3/s^2", more=f", {more}"
    )
    energies = [row[0] for row in watch(tmp_path, script, [0, 0.7, 1.5], "sky.energy")]
    assert max(energies) - min(energies) < 1e-9


def test_an_attractor_at_the_particle_itself_pulls_nowhere(tmp_path):
    script = ORBIT.format(end="1 s", place="0 0 0 m", velocity="0 0 0 m/s", strength="1 m^3/s^2", more="")
    ((place,),) = watch(tmp_path, script, [1], "sky.moon.position")
    np.testing.assert_array_equal(place, 0)


def test_contradictory_and_empty_forces_are_refused_where_they_stand(tmp_path):
    body = "models: {{a: {{particles: {{list: {{b: {{}}}}}}}}}}\nforces: {{f: {}}}\n"
    both = complaint(tmp_path, body.format("{gravity: {acceleration: 0 -1 0 m/s^2, strength: 2 m/s^2}}"))
    assert "either the vector `acceleration`" in both
    assert "scene.yaml:2" in both
    assert "drag needs a coefficient" in complaint(tmp_path, body.format("drag"))
    assert "at least" in complaint(tmp_path, body.format("{drag: {linear: -1 N*s/m}}"))
