"""Rigid bodies in mode `exact` that roll over edges and corners: from face to edge to corner, each change an event."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rigid_scenes
from sceneql.failure import RunFailure

GRAVITY = 9.81
TABLE = "{box: {size: 1 0.2 1 m, position: 0 -0.1 0 m}}"
HALF = np.array([0.5, 0.1, 0.5])


def watch(folder, objects, motion, times, *outputs, law, solver="auto"):
    """Outputs of the body `it` of the object `it` among these objects."""
    bodies = {"it": f"{{of: it, density: 1000 kg/m^3, {motion}}}"}
    law = f"mode: exact, {law}"
    return rigid_scenes.watch(folder, objects, bodies, times, *outputs, law=law, solver=solver, model="body")


def gap(centers, middle=(0, -0.1, 0), half=HALF):
    """How far balls of 0.1 m around (n, 3) are outside a box [m]."""
    return np.linalg.norm(centers - (np.clip(centers - middle, -half, half) + middle), axis=1) - 0.1


def over_the_edge(speed, moment, start, times):
    """Places (n, 2) from the edge of a ball of 0.1 m of a moment about it [m r^2], and when it leaves the edge [s].

    It turns about the edge by a'' = g sin(a) / (moment r) from where its center passes it, and leaves it where
    m g cos(a) = m r a'^2.
    """
    radius, passes = 0.1, -start / speed

    def turn(t, state):
        angle, spin = state
        return spin, GRAVITY / (moment * radius) * np.sin(angle)

    def pressed(t, state):
        angle, spin = state
        return GRAVITY * np.cos(angle) - radius * spin**2

    pressed.terminal = True
    tight = {"rtol": 1e-13, "atol": 1e-14, "method": "DOP853", "dense_output": True}
    turned = solve_ivp(turn, (passes, passes + 2), (0, speed / radius), events=pressed, **tight)
    leaves, (angle, spin) = turned.t[-1], turned.y[:, -1]
    places = []
    for t in times:
        if t < passes:
            places.append((start + speed * t, radius))
        elif t < leaves:
            now = turned.sol(t)[0]
            places.append((radius * np.sin(now), radius * np.cos(now)))
        else:
            h, v = t - leaves, radius * spin
            x, y = radius * np.sin(angle), radius * np.cos(angle)
            places.append((x + v * np.cos(angle) * h, y - v * np.sin(angle) * h - GRAVITY * h**2 / 2))
    return np.array(places), leaves


def ball(x, z=0.0):
    """A table, and a ball that rests on it."""
    return {"table": TABLE, "it": f"{{sphere: {{radius: 0.1 m, position: {x} 0.1 {z} m}}}}"}


@pytest.mark.parametrize("speed", [0.3, 0.7])
def test_a_ball_slides_over_an_edge_turns_about_it_and_leaves_it_where_nothing_presses(tmp_path, speed):
    times = np.linspace(0, 0.36 if speed < 0.5 else 0.24, 37)
    law, solver = "restitution: 0", "dop853: {tolerance: 1e-12}"
    rows = watch(tmp_path, ball(0.46), f"velocity: {speed} 0 0 m/s", times, "body.it.position", law=law, solver=solver)
    expected, leaves = over_the_edge(speed, 1.0, -0.04, times)
    assert times[-1] > leaves
    np.testing.assert_allclose(np.array([x for (x,) in rows])[:, :2] - (0.5, 0), expected, atol=1e-10)


def test_a_ball_that_rolls_over_an_edge_turns_about_it_with_the_moment_of_rolling(tmp_path):
    # Up to where it begins to slip: there the force across is a thousand times what presses, a hair before it leaves.
    _, leaves = over_the_edge(0.3, 1.4, -0.04, [0.0])
    times = np.linspace(0, 0.97 * leaves, 33)
    law, solver = "restitution: 0, friction: 1000", "dop853: {tolerance: 1e-12}"
    motion = "velocity: 0.3 0 0 m/s, spin: 0 0 -3 rad/s"
    rows = watch(tmp_path, ball(0.46), motion, times, "body.it.position", law=law, solver=solver)
    expected, _ = over_the_edge(0.3, 1.4, -0.04, times)
    np.testing.assert_allclose(np.array([x for (x,) in rows])[:, :2] - (0.5, 0), expected, atol=1e-10)


@pytest.mark.parametrize("speed", [0.27, 0.3, 0.33])
@pytest.mark.parametrize(
    ("solver", "deep", "made"),
    [("auto", 1e-7, 3e-6), ("dopri5: {tolerance: 1e-9}", 1e-9, 1e-8), ("rk4: {step: 2 ms}", 1e-9, 3e-5)],
)
def test_a_ball_that_slides_and_rolls_off_a_box_is_never_in_it(tmp_path, solver, deep, made, speed):
    """Frames in the step in which it lifts off have that step's error, by `auto` 1e-6 of the ball's size. By rk4 the
    end of a slip that no step saw made 1 % of the energy at two of these speeds."""
    times = np.linspace(0, 0.55, 56)
    law = "restitution: 0, friction: 0.5"
    outputs = "body.it.position", "body.energy"
    rows = watch(tmp_path, ball(0.46), f"velocity: {speed} 0 0 m/s", times, *outputs, law=law, solver=solver)
    assert gap(np.array([x for x, _ in rows])).min() > -deep
    energies = np.array([energy for _, energy in rows])
    assert np.ptp(energies) < made * np.abs(energies).max()


@pytest.mark.parametrize("spin", ["0 0 0", "3 0 -5"])
@pytest.mark.parametrize("friction", [0, 0.5])
def test_a_ball_passes_over_the_corner_of_a_box(tmp_path, spin, friction):
    times = np.linspace(0, 0.6, 61)
    law, solver = f"restitution: 0.5, friction: {friction}", "dop853: {tolerance: 1e-10}"
    motion = f"velocity: 0.4 0 0.4 m/s, spin: {spin} rad/s"
    outputs = "body.it.position", "touch.points"
    rows = watch(tmp_path, ball(0.46, 0.46), motion, times, *outputs, law=law, solver=solver)
    assert gap(np.array([x for x, _ in rows])).min() > -1e-9
    assert any(len(points) == 1 and np.abs(points - (0.5, 0, 0.5)).max() < 1e-8 for _, points in rows)


def test_a_ball_rolls_into_the_gap_of_two_boxes_and_rests_on_both_edges(tmp_path):
    objects = {
        "left": "{box: {size: 1 0.2 1 m, position: -0.55 -0.1 0 m}}",
        "right": "{box: {size: 1 0.2 1 m, position: 0.55 -0.1 0 m}}",
        "it": "{sphere: {radius: 0.1 m, position: -0.2 0.1 0 m}}",
    }
    times, law = np.linspace(0, 1.2, 61), "restitution: 0, friction: 0.5"
    motion, solver = "velocity: 0.6 0 0 m/s, spin: 0 0 -6 rad/s", "dopri5: {tolerance: 1e-9}"
    rows = watch(tmp_path, objects, motion, times, "body.it.position", law=law, solver=solver)
    centers = np.array([x for (x,) in rows])
    for middle in (-0.55, 0.55):
        assert gap(centers, (middle, -0.1, 0)).min() > -1e-9
    np.testing.assert_allclose(centers[-1], (0, np.sqrt(0.1**2 - 0.05**2), 0), atol=1e-9)


@pytest.mark.parametrize("friction", [0, 1000])
def test_an_ellipsoid_rolls_off_an_edge_as_a_ball_that_is_as_round_across_it(tmp_path, friction):
    # About its long axis it has the moment of a ball.
    moment = 1.4 if friction else 1.0
    _, leaves = over_the_edge(0.3, moment, -0.04, [0.0])
    times = np.linspace(0, 0.97 * leaves if friction else 0.36, 33)
    egg = "{group: {scale: 1 1 2, position: 0.46 0.1 0 m, children: [{sphere: {radius: 0.1 m}}]}}"
    motion = "velocity: 0.3 0 0 m/s" + (", spin: 0 0 -3 rad/s" if friction else "")
    law, solver = f"restitution: 0, friction: {friction}", "dop853: {tolerance: 1e-12}"
    rows = watch(tmp_path, {"table": TABLE, "it": egg}, motion, times, "body.it.position", law=law, solver=solver)
    expected, _ = over_the_edge(0.3, moment, -0.04, times)
    np.testing.assert_allclose(np.array([x for (x,) in rows])[:, :2] - (0.5, 0), expected, atol=1e-9)


def test_a_cube_on_its_corner_falls_from_where_the_corner_passes_the_edge(tmp_path):
    height = 0.1 * np.sqrt(3)
    turn = "{about: 0.7071067811865476 0 -0.7071067811865476, angle: 54.735610317245346 deg}"
    cube = f"{{box: {{size: 0.2 0.2 0.2 m, position: 0.47 {height} 0 m, rotation: {turn}}}}}"
    times = np.array([0.04, 0.06, 0.08])
    rows = watch(
        tmp_path, {"table": TABLE, "it": cube}, "velocity: 0.6 0 0 m/s", times, "body.it.position", law="restitution: 0"
    )
    falls = np.maximum(0.0, times - 0.05)
    np.testing.assert_allclose([x[1] for (x,) in rows], height - GRAVITY * falls**2 / 2, atol=1e-6)


def test_a_column_that_tips_over_an_edge_is_told_of_at_the_line_of_its_contact(tmp_path):
    column = "{cylinder: {radius: 0.1 m, height: 0.2 m, position: 0.3 0.1 0 m, rotation: {about: y, angle: 20 deg}}}"
    law = "restitution: 0, friction: 0.2"
    with pytest.raises(RunFailure, match=r"contacts: \{touch"):
        watch(tmp_path, {"table": TABLE, "it": column}, "velocity: 2 0 0 m/s", [0.3], "body.it.position", law=law)


@pytest.mark.parametrize("friction", [0, 1000])
def test_a_cylinder_goes_off_an_edge_along_its_axis_turning_about_it(tmp_path, friction):
    """As a ball that turns about the edge, with the moment of rolling of a cylinder."""
    turn = "rotation: {about: x, angle: 90 deg}"
    can = f"{{cylinder: {{radius: 0.1 m, height: 0.3 m, position: 0.46 0.1 0.05 m, {turn}}}}}"
    times = np.linspace(0.05, 0.35, 7)
    motion = "velocity: 0.3 0 0 m/s" + (", spin: 0 0 -3 rad/s" if friction else "")
    law = f"restitution: 0, friction: {friction}"
    solver = "dop853: {tolerance: 1e-12}"
    rows = watch(
        tmp_path, {"table": TABLE, "it": can}, motion, times, "body.it.position", "touch.points", law=law, solver=solver
    )
    places = np.array([x for x, _ in rows])
    expected, leaves = over_the_edge(0.3, 1.5 if friction else 1, -0.04, times)
    np.testing.assert_allclose(places[:, :2] - (0.5, 0), expected, atol=1e-6 if friction else 1e-9)
    np.testing.assert_allclose(places[:, 2], 0.05, atol=1e-9)
    assert [len(points) for _, points in rows] == [2 if t < leaves else 0 for t in times]


def test_a_cylinder_lies_on_the_edges_of_two_boxes(tmp_path):
    boxes = {
        f"box{k}": f"{{box: {{size: 1 0.2 {w} m, position: {x} -0.1 0 m}}}}"
        for k, x, w in ((0, -0.55, 1), (1, 0.55, 0.2))
    }
    can = "{cylinder: {radius: 0.1 m, height: 0.4 m, position: 0.001 0.1 0 m, rotation: {about: x, angle: 90 deg}}}"
    rows = watch(
        tmp_path, {**boxes, "it": can}, "velocity: 0 0 0 m/s", [1, 2], "body.it.position", "touch.points",
        law="restitution: 0, friction: 0.3",
    )  # fmt: skip
    for x, points in rows:
        np.testing.assert_allclose(x[:2], [0, np.sqrt(0.1**2 - 0.05**2)], atol=1e-6)
        assert len(points) == 4
