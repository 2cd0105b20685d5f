"""Two round bodies on each other in mode `exact`: balls, cylinders, rings, ellipsoids that roll, rock and bounce."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rigid_scenes

GRAVITY = 9.81
BALL, LOG = "sphere: {radius: 0.5 m}", "cylinder: {radius: 0.5 m, height: 1 m, rotation: {about: x, angle: 90 deg}}"
TIGHT = {"rtol": 1e-13, "atol": 1e-14, "method": "DOP853", "dense_output": True}
START = 0.3
"""Angle from the top at which what rolls off begins [rad]."""
AT = f"position: {0.6 * np.sin(START)} {0.6 * np.cos(START)} 0.1 m"


def watch(folder, objects, bodies, times, *outputs, law, forces="[gravity]"):
    """Outputs of the model `it` of the bodies of these objects, by how they move, among all."""
    objects = {name: f"{{{what}}}" for name, what in objects.items()}
    bodies = {name: f"{{of: {name}, {motion}}}" for name, motion in bodies.items()}
    return rigid_scenes.watch(folder, objects, bodies, times, *outputs, law=f"mode: exact, {law}", forces=forces)


@pytest.mark.parametrize("friction", [0, 1000])
@pytest.mark.parametrize(
    ("below", "body", "moment"),
    [
        (BALL, f"sphere: {{radius: 0.1 m, {AT.replace('0.1 m', '0 m')}}}", 0.4),
        (LOG, f"sphere: {{radius: 0.1 m, {AT}}}", 0.4),
        (LOG, f"cylinder: {{radius: 0.1 m, height: 0.3 m, rotation: {{about: x, angle: 90 deg}}, {AT}}}", 0.5),
        (LOG, f"cylinder: {{radius: 0.1 m, height: 3 m, rotation: {{about: x, angle: 90 deg}}, {AT}}}", 0.5),
        (LOG, f"torus: {{radius: 0.07 m, tube: 0.03 m, rotation: {{about: x, angle: 90 deg}}, {AT}}}", 0.5575),
        (LOG, f"group: {{scale: 1 1 2, {AT}, children: [{{sphere: {{radius: 0.1 m}}}}]}}", 0.4),
    ],
    ids=["ball on ball", "ball", "cylinder", "longer cylinder", "ring", "ellipsoid"],
)
def test_what_rolls_off_a_round_body_leaves_it_where_nothing_presses(tmp_path, below, body, moment, friction):
    """Rolling, (1 + moment) l angle'' = g sin angle, l the distance of the centers: a ball leaves where the cosine is
    10/17 of that at the start."""

    def rate(t, state):
        return state[1], GRAVITY * np.sin(state[0]) / (0.6 * (1 + (moment if friction else 0)))

    def presses(t, state):
        return GRAVITY * np.cos(state[0]) - 0.6 * state[1] ** 2

    presses.terminal = True
    whole = solve_ivp(rate, (0, 3), (START, 0), events=presses, **TIGHT)
    leaves = whole.t[-1]
    if friction and moment == 0.4:
        assert np.cos(whole.y[0, -1]) == pytest.approx(10 / 17 * np.cos(START), abs=1e-12)
    # With friction up to where it slips, a hair before it leaves.
    times = np.append(np.linspace(0, 0.97 if friction else 0.999, 7) * leaves, leaves + 0.01)
    law = f"restitution: 0, friction: {friction}"
    objects = {"below": below, "body": body}
    rows = watch(tmp_path, objects, {"body": "mass: 1 kg"}, times, "it.positions", "touch.points", "it.energy", law=law)
    angles = whole.sol(times[:-1])[0]
    expected = 0.6 * np.column_stack([np.sin(angles), np.cos(angles)])
    np.testing.assert_allclose([x[0, :2] for x, *_ in rows[:-1]], expected, atol=1e-10)
    assert all(len(points) > 0 for _, points, _ in rows[:-1])
    assert len(rows[-1][1]) == 0
    np.testing.assert_allclose([energy for *_, energy in rows], rows[0][2], atol=1e-10)


@pytest.mark.parametrize("speed", [1.0, 0.3])
def test_a_cylinder_rocks_across_another_without_slip(tmp_path, speed):
    """As a plank of half its thickness: the contact runs over both, and v^2 = (r^2 + R^2 angle^2) angle'^2."""
    below, radius, length = 0.5, 0.1, 0.6
    inertia = (3 * radius**2 + length**2) / 12

    def rate(t, state):
        angle, spin = state
        pull = GRAVITY * (radius * np.sin(angle) - below * angle * np.cos(angle)) - below**2 * angle * spin**2
        return spin, pull / (inertia + radius**2 + below**2 * angle**2)

    whole = solve_ivp(rate, (0, 2), (0, speed), **TIGHT)
    times = np.linspace(0.1, 2, 8)
    objects = {
        "below": LOG,
        "body": f"cylinder: {{radius: 0.1 m, height: {length} m, rotation: {{about: z, angle: 90 deg}}, "
        "position: 0 0.6 0 m}",
    }
    bodies = {"body": f"mass: 1 kg, spin: 0 0 {-speed} rad/s, velocity: {speed * radius} 0 0 m/s"}
    law = "restitution: 0, friction: 1000"
    rows = watch(tmp_path, objects, bodies, times, "it.positions", "touch.points", law=law)
    for t, (x, points) in zip(times, rows, strict=True):
        angle, _ = whole.sol(t)
        s, c = np.sin(angle), np.cos(angle)
        np.testing.assert_allclose(x[0], [0.6 * s - below * angle * c, 0.6 * c + below * angle * s, 0], atol=1e-10)
        np.testing.assert_allclose(points, [[below * s, below * c, 0]], atol=1e-9)


@pytest.mark.parametrize(
    ("turn", "height", "spin", "friction"),
    [
        ("{about: x, angle: 90 deg}", 0.1, "0 0 0", 0.3),
        ("{about: x, angle: 60 deg}", 0.1, "1 2 3", 0),
        ("{about: x, angle: 60 deg}", 0.1, "1 2 3", 0.3),
        ("{about: z, angle: 60 deg}", 0.1, "0 0 0", 0.3),
        ("{about: 1 2 3, angle: 60 deg}", 0, "0 1 0", 0),
        ("{about: z, angle: 30 deg}", 0.45, "1 3 0", 0),
    ],
    ids=["crossed", "askew", "askew and rough", "rim on side", "turned", "twice"],
)
def test_cylinders_that_strike_each_other_keep_momentum_and_energy(tmp_path, turn, height, spin, friction):
    objects = {
        "a": "cylinder: {radius: 0.1 m, height: 1 m}",
        "b": f"cylinder: {{radius: 0.15 m, height: 0.6 m, rotation: {turn}, position: 1 {height} 0 m}}",
    }
    bodies = {"a": "mass: 1 kg", "b": f"mass: 2 kg, velocity: -2 0 0 m/s, spin: {spin} rad/s"}
    law = f"between: [it], restitution: 1, friction: {friction}"
    outputs = ("it.momentum", "it.angular_momentum", "it.energy", "touch.hits.count", "it.positions")
    start, end = watch(tmp_path, objects, bodies, [0, 1.5], *outputs, law=law, forces="[]")
    assert end[3] > 0
    np.testing.assert_allclose(end[0], start[0], atol=1e-13)
    np.testing.assert_allclose(end[1], start[1], atol=1e-13)
    assert end[2] == pytest.approx(start[2], abs=1e-10)
    assert np.linalg.norm(end[4][1] - end[4][0]) > 0.3


def logs(apart):
    """Three logs of 0.1 m: two on the floor at an angle to the vertical as seen from the third on both [rad]."""
    where = [(-0.2 * np.sin(apart), 0.1), (0.2 * np.sin(apart), 0.1), (0, 0.1 + 0.2 * np.cos(apart))]
    turn = "rotation: {about: x, angle: 90 deg}"
    shape = "cylinder: {{radius: 0.1 m, height: 1 m, {}, position: {} {} 0 m}}"
    objects = {f"l{k}": shape.format(turn, *at) for k, at in enumerate(where)}
    return {**objects, "floor": "plane: {}"}, dict.fromkeys(objects, "mass: 1 kg")


def test_smooth_logs_are_pushed_apart_by_the_one_on_them(tmp_path):
    def rate(t, state):
        s, c = np.sin(state[0]), np.cos(state[0])
        return state[1], (GRAVITY / 0.2 * s + s * c * state[1] ** 2) / (s**2 + 2 * c**2)

    apart = np.radians(33)
    whole = solve_ivp(rate, (0, 0.15), (apart, 0), **TIGHT)
    times = np.linspace(0.03, 0.15, 5)
    rows = watch(tmp_path, *logs(apart), times, "it.positions", law="restitution: 0")
    for t, (x,) in zip(times, rows, strict=True):
        angle = whole.sol(t)[0]
        np.testing.assert_allclose(x[:, 0], 0.2 * np.sin(angle) * np.array([-1, 1, 0]), atol=1e-9)
        assert x[2, 1] == pytest.approx(0.1 + 0.2 * np.cos(angle), abs=1e-9)


def test_rough_logs_stay_on_one_another(tmp_path):
    rows = watch(tmp_path, *logs(np.radians(33)), [0, 2], "it.positions", law="restitution: 0, friction: 0.3")
    np.testing.assert_allclose(rows[1][0], rows[0][0], atol=1e-9)


def test_a_cube_bounces_elastically_on_a_torus_and_keeps_its_energy(tmp_path):
    turn = "rotation: {about: 1 0.4 0.2, angle: 33 deg}"
    objects = {
        "cube": f"{{box: {{size: 0.6 0.6 0.6 m, position: 0.05 0.6 0.02 m, {turn}}}}}",
        "ring": "{torus: {radius: 0.5 m, tube: 0.15 m}}",
    }
    rows = rigid_scenes.watch(
        tmp_path, objects, {"cube": "{of: cube, mass: 1 kg, spin: 1 2 -1 rad/s}"}, np.linspace(0, 0.5, 21),
        "it.energy", "touch.hits.count", law="mode: exact, restitution: 1, friction: 0",
    )  # fmt: skip
    energy, hits = np.array(rows).T
    assert hits[-1] > 2
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
