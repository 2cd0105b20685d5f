"""Rigid bodies on objects that move by themselves: carried, pushed and lifted."""

import numpy as np
import pytest

from test_rigid_contacts import watch

STEP = "semi_implicit_euler: {{step: {} ms}}"


def test_a_ball_rolls_in_a_circle_on_a_turntable(tmp_path):
    table = '{box: {size: 9 1 9 m, position: 0 -0.5 0 m, rotation: {about: y, angle: "3 rad/s*time"}}}'
    objects = {"o": "{sphere: {radius: 0.1 m, position: 1 0.1 0 m}}", "table": table}
    bodies = {"b": "{of: o, velocity: 0 0 -0.3 m/s, spin: 27 0 0 rad/s}"}  # it does not slip at the start
    errors = []
    for step in (4, 2):
        solver, law = STEP.format(step), "restitution: 0, friction: 1"
        ((x, v),) = watch(tmp_path, objects, bodies, [4], "it.b.position", "it.b.velocity", law=law, solver=solver)
        exact = [0.3143138, 0.1, 0.09906955, 0.08491676, 0, 0.28773103]
        errors.append(np.abs(np.concatenate([x, v]) - exact).max())
    assert errors[0] < 3e-3
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("solver", ["semi_implicit_euler: {step: 5 ms}", "auto", "verlet: {step: 3 ms}"])
def test_a_belt_carries_a_block_at_its_speed(tmp_path, solver):
    belt = '{box: {size: 40 1 4 m, position: ["1 m/s*time", -0.5 m, 0 m]}}'
    objects = {"o": "{box: {position: 0 0.5 0 m}}", "belt": belt}
    seen = watch(tmp_path, objects, {"b": "{of: o}"}, [0.1, 1], "it.b.velocity", "it.b.position", solver=solver)
    (early, _), (late, place) = seen
    assert early[0] == pytest.approx(0.5 * 9.81 * 0.1, abs=0.03)  # friction alone drags it
    np.testing.assert_allclose(late, [1, 0, 0], atol=1e-12)
    assert place[0] == pytest.approx(1 - 0.5 / (0.5 * 9.81), abs=0.01)
    assert place[1] == pytest.approx(0.5, abs=1e-12)


def test_a_lift_carries_a_stack_without_a_gap(tmp_path):
    height = "0.3 m*sin(3 rad/s*time)"
    objects = {f"o{k}": f"{{box: {{position: 0 {k + 0.5} 0 m}}}}" for k in range(3)}
    objects["lift"] = f'{{plane: {{height: "{height}"}}}}'
    bodies = {f"b{k}": f"{{of: o{k}, mass: {10**k} kg}}" for k in range(3)}
    times = np.array([0.3, 0.5, 1.0, 1.5])
    for time, (places,) in zip(times, watch(tmp_path, objects, bodies, times, "it.positions"), strict=True):
        np.testing.assert_allclose(places[:, 1] - 0.3 * np.sin(3 * time), [0.5, 1.5, 2.5], atol=1e-12)


def test_a_paddle_strikes_a_ball(tmp_path):
    """Against the wall that moves the ball's speed turns round, times the restitution."""
    wall = '{box: {size: 0.2 2 2 m, position: ["4 m/s*time", 0 m, 0 m]}}'
    objects = {"o": "{sphere: {radius: 0.1 m, position: 1 0 0 m}}", "wall": wall}
    bodies = {"b": "{of: o, velocity: -1 0 0 m/s}"}
    more, law = "", "restitution: 0.5, between: [it, wall]"
    ((v,),) = watch(tmp_path, objects, bodies, [0.5], "it.b.velocity", more=more, law=law, solver=STEP.format(1))
    assert v[0] == pytest.approx(4 + 0.5 * 5, abs=1e-9)


def test_a_small_ball_does_not_pass_a_fast_thin_bat(tmp_path):
    bat = '{box: {size: 0.001 2 2 m, position: ["-3 m + 300 m/s*time", 0 m, 0 m]}}'
    objects = {"o": "{sphere: {radius: 0.01 m, position: 0 0 0 m}}", "bat": bat}
    for step in (1, 7, 20):
        ((x,),) = watch(tmp_path, objects, {"b": "{of: o}"}, [0.06], "it.b.position", solver=STEP.format(step))
        assert x[0] == pytest.approx(-3 + 300 * 0.06 + 0.0105, abs=1e-6)


def test_what_changes_its_shape_is_refused_at_its_place(tmp_path):
    objects = {"o": "sphere", "big": '{sphere: {position: 0 -9 0 m, radius: "1 m + 1 m/s*time"}}'}
    with pytest.raises(Exception, match="`radius` of 'big' varies in time"):
        watch(tmp_path, objects, {"b": "{of: o}"}, [0.1], "it.b.position")
