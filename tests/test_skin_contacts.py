"""Rigid bodies that are curved or not convex, mode `local`: what stands, rolls, hangs over a peg, lies in a bowl."""

import numpy as np
import pytest

from test_rigid_contacts import watch

COLUMN = "radius: 0.3 m, height: 1 m"
BOWL = (
    "{difference: {of: [{sphere: {radius: 0.3 m}}, {sphere: {radius: 0.28 m}},"
    " {box: {size: 2 1 2 m, position: 0 0.5 0 m}}], position: 0 0.3 0 m}}"
)
TIPPED = "rotation: {about: [1, 2, 3], angle: 40 deg}"


@pytest.mark.parametrize("solver", ["semi_implicit_euler: {step: 5 ms}", "auto"])
def test_a_column_stands_on_its_end_and_on_another(tmp_path, solver):
    objects = {f"o{k}": f"{{cylinder: {{{COLUMN}, position: 0 {k + 0.5} 0 m}}}}" for k in range(2)}
    bodies = {"low": "{of: o0, mass: 1 kg}", "high": "{of: o1, mass: 100 kg}"}
    ((places, kinetic),) = watch(
        tmp_path, {**objects, "floor": "plane"}, bodies, [1], "it.positions", "it.kinetic", solver=solver
    )
    np.testing.assert_allclose(places, [[0, 0.5, 0], [0, 1.5, 0]], atol=1e-9)
    assert kinetic < 1e-12


def test_a_column_slides_on_its_side_and_then_rolls(tmp_path):
    """Its speed is 2/3 of that at the start once it rolls (a ball keeps 5/7)."""
    column = f"{{cylinder: {{{COLUMN}, position: 0 0.3 0 m, rotation: {{about: x, angle: 90 deg}}}}}}"
    objects, bodies = {"o": column, "floor": "plane"}, {"b": "{of: o, mass: 2 kg, velocity: 3 0 0 m/s}"}
    ((velocity, spin, place),) = watch(tmp_path, objects, bodies, [1], "it.b.velocity", "it.b.spin", "it.b.position")
    np.testing.assert_allclose(velocity, [2, 0, 0], atol=1e-7)
    np.testing.assert_allclose(spin, [0, 0, -2 / 0.3], atol=1e-7)
    assert place[1] == pytest.approx(0.3, abs=1e-10)


@pytest.mark.parametrize(("angle", "stands"), [(30.5, True), (31.5, False)])
def test_a_column_tips_back_up_to_the_angle_of_its_diagonal(tmp_path, angle, stands):
    """atan(2 radius / height) = 30.96 degrees: below it comes down on its end, above on its side."""
    tilt = np.radians(angle)
    high = 0.3 * np.sin(tilt) + 0.5 * np.cos(tilt)
    column = f"{{cylinder: {{{COLUMN}, position: 0 {high} 0 m, rotation: {{about: z, angle: {angle} deg}}}}}}"
    objects = {"o": column, "floor": "plane"}
    ((place, kinetic),) = watch(
        tmp_path, objects, {"b": "{of: o}"}, [3], "it.b.position", "it.kinetic", law="restitution: 0, friction: 1"
    )
    assert place[1] == pytest.approx(0.5 if stands else 0.3, abs=1e-6)
    assert not stands or kinetic < 1e-12


def test_a_ring_comes_to_rest_on_the_floor_around_a_peg(tmp_path):
    ring = "{torus: {radius: 0.25 m, tube: 0.05 m, position: 0.05 1.3 0 m, rotation: {about: z, angle: 10 deg}}}"
    objects = {"peg": "{cylinder: {radius: 0.1 m, height: 1 m, position: 0 0.5 0 m}}", "floor": "plane", "o": ring}
    bodies, law = {"b": "{of: o, mass: 2 kg}"}, "restitution: 0.2, friction: 0.3"
    ((place, kinetic),) = watch(tmp_path, objects, bodies, [2], "it.b.position", "it.kinetic", law=law)
    assert place[1] == pytest.approx(0.05, abs=1e-6)
    assert np.hypot(place[0], place[2]) < 0.1 + 1e-6
    assert kinetic < 1e-20


def test_a_drilled_cube_comes_to_rest_in_a_hollow_bowl(tmp_path):
    drilled = "{difference: {of: [{box: {size: 0.12 0.12 0.12 m}}, {cylinder: {radius: 0.04 m, height: 1 m}}],"
    objects = {
        "bowl": BOWL,
        "a": f"{drilled} position: 0.05 0.2 0 m, {TIPPED}}}}}",
    }
    bodies = {"a": "{of: a, mass: 1 kg}"}
    outputs, law = ("it.positions", "it.kinetic", "touch.points"), "restitution: 0, friction: 0.5"
    ((early, _, _), (late, kinetic, points)) = watch(tmp_path, objects, bodies, [1.1, 1.3], *outputs, law=law)
    np.testing.assert_allclose(early, late, atol=1e-9)
    assert kinetic < 1e-16
    assert np.linalg.norm(points - [0, 0.3, 0], axis=1).max() == pytest.approx(0.28, abs=1e-6)


@pytest.mark.parametrize("step", [0.5, 5, 20])
def test_a_small_ball_of_500_m_a_second_does_not_pass_a_thin_bowl(tmp_path, step):
    objects = {"bowl": BOWL, "o": "{sphere: {radius: 0.01 m, position: 0 0.45 0.01 m}}"}
    bodies = {"b": "{of: o, mass: 1 kg, velocity: 30 -500 10 m/s}"}
    solver = f"semi_implicit_euler: {{step: {step} ms}}"
    for (x,) in watch(tmp_path, objects, bodies, [0.02, 0.04], "it.b.position", solver=solver):
        assert x[1] > 0.03 - 1e-4


def test_a_hollow_body_is_carried_by_a_turning_column(tmp_path):
    table = '{cylinder: {radius: 1 m, height: 0.3 m, rotation: {about: y, angle: "1 rad/s*time"}}}'
    pipe = "{difference: {of: [{cylinder: {radius: 0.1 m, height: 0.2 m}}, {cylinder: {radius: 0.08 m, height: 1 m}}],"
    objects = {"o": f"{pipe} position: 0.3 0.25 0 m}}}}", "table": table}
    ((place, spin),) = watch(tmp_path, objects, {"b": "{of: o}"}, [1], "it.b.position", "it.b.spin")
    np.testing.assert_allclose(spin, [0, 1, 0], atol=1e-9)
    assert np.hypot(place[0], place[2]) == pytest.approx(0.3, abs=3e-3)
    assert place[1] == pytest.approx(0.25, abs=1e-8)


def test_what_starts_inside_a_hollow_shape_is_told_and_what_is_in_its_hole_not(tmp_path):
    ring = "{torus: {radius: 0.5 m, tube: 0.1 m}}"
    ball = "{{sphere: {{radius: 0.1 m, position: {} 0 0 m}}}}"
    watch(tmp_path, {"o": ball.format(0.2), "ring": ring}, {"b": "{of: o}"}, [0.01], "it.kinetic")
    for x, told in ((0.4, "'o' starts inside 'ring'"), (0.303, r"'o' starts 0\.00[23]\d* m inside 'ring'")):
        with pytest.raises(Exception, match=told):
            watch(tmp_path, {"o": ball.format(x), "ring": ring}, {"b": "{of: o}"}, [0.01], "it.kinetic")
