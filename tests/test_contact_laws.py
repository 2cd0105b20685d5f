"""Laws of contacts over all shapes and both modes."""

import math

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.quantities.diagnostic import ScriptError
from test_contacts import DOPRI5, G, ball

QUARTIC = "(x^2 + y^2 + z^2 + 0.84)^2 - 4*(x^2 + z^2)"
FLOORS = {
    "plane": "{floor: plane}",
    "sphere": "{floor: {sphere: {radius: 50 m, position: 0 -50 0 m}}}",
    "box": "{floor: {box: {size: 8 1 8 m, position: 0 -0.5 0 m}}}",
    "mesh": "{floor: {mesh: {file: slab.obj}}}",
    "cylinder": "{floor: {cylinder: {radius: 4 m, height: 1 m, position: 0 -0.5 0 m}}}",
    "implicit": "{floor: {implicit: {field: x^4 + z^4 + 100*y - 1, bounds: {box: [-1 -1 -1, 1 1 1]}, unit: 4 m, "
    "position: 0 -0.04 0 m}}}",
    "blobby": "{floor: {blobby: {points: [[0 m, -0.34641016151377546 m, 0 m]], radius: 1 m, threshold: 0.681472}}}",
    "union": "{floor: {union: {of: [low, side]}}, low: {box: {size: 8 1 8 m, position: 0 -0.5 0 m}}, "
    "side: {sphere: {position: 3 0 0 m, radius: 1 m}}}",
    "group": "{floor: {group: {children: [low], scale: 2, position: 0 -0.5 0 m}}, low: {box: {size: 4 0.5 4 m}}}",
}
"""Solids whose top is at the origin, level there."""
SOLVERS = {"exact": DOPRI5, "local": "{rk4: {step: 1 ms}}"}


def slab(folder, x=4.0, low=-1.0, high=0.0, z=4.0):
    """A closed box as an OBJ file."""
    lines = [f"v {a} {b} {c}" for a in (-x, x) for b in (low, high) for c in (-z, z)]
    lines += [f"f {quad}" for quad in ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")]
    (folder / "slab.obj").write_text("\n".join(lines))


def scene(folder, shape, mode, contact, start, end, forces="[gravity]"):
    slab(folder)
    return ball(
        f"{{between: [ball, floor], mode: {mode}, {contact}}}", FLOORS[shape], start, end, SOLVERS[mode], forces
    )


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("shape", FLOORS)
def test_an_elastic_ball_keeps_its_energy_and_hits_on_time(tmp_path, shape, mode):
    script = scene(tmp_path, shape, mode, "restitution: 1", "position: 0 1.1 0 m, radius: 0.1 m", 2)
    outputs = ("ball.energy", "hit.hits.count", "hit.hits.first.time", "ball.a.position")
    start, end = watch(tmp_path, script, [0, 2], *outputs)
    assert end[0] == pytest.approx(start[0], rel=1e-10)
    assert end[1] == 2
    assert end[2] == pytest.approx(math.sqrt(2 / G), abs=1e-9)
    apart = 2 - 3 * math.sqrt(2 / G)
    height = 1.1 + math.sqrt(2 * G) * apart - G * apart**2 / 2 - 1
    np.testing.assert_allclose(end[3], [0, height, 0], atol=1e-6)


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("shape", FLOORS)
def test_a_ball_comes_to_rest_and_stays(tmp_path, shape, mode):
    contact = "restitution: 0.3, friction: 0.5"
    script = scene(tmp_path, shape, mode, contact, "position: 0 0.2 0 m, radius: 0.1 m", 2)
    start, one, two = watch(tmp_path, script, [0, 1, 2], "ball.energy", "ball.a.position", "ball.a.velocity")
    np.testing.assert_allclose(one[1], [0, 0.1, 0], atol=1e-7)
    np.testing.assert_allclose(two[1], one[1], atol=1e-10)
    np.testing.assert_allclose(two[2], 0, atol=1e-8)
    assert two[0] == pytest.approx(start[0], rel=1e-6)


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("shape", ["plane", "box", "mesh", "cylinder", "union", "group"])
def test_on_a_level_floor_friction_stops_what_slides_after_its_way(tmp_path, shape, mode):
    start = "position: -0.7 0.1 0 m, velocity: 2 0 0 m/s, radius: 0.1 m"
    script = scene(tmp_path, shape, mode, "friction: 0.3", start, 1)
    ((place, v),) = watch(tmp_path, script, [1], "ball.a.position", "ball.a.velocity")
    np.testing.assert_allclose(place, [-0.7 + 4 / (2 * 0.3 * G), 0.1, 0], atol=1e-6)
    np.testing.assert_allclose(v, 0, atol=1e-9)


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("shape", FLOORS)
def test_it_slides_if_the_slope_is_steeper_than_friction_holds(tmp_path, shape, mode):
    # Level ground under gravity from aside.
    for pull, slides in ((0.45, False), (0.55, True)):
        gravity = f"[{{gravity: {{acceleration: [{pull * G} m/s^2, -{G} m/s^2, 0 m/s^2]}}}}]"
        start = "position: 0 0 0 m, radius: 0 m"
        script = scene(tmp_path, shape, mode, "friction: 0.5", start, 0.3, gravity)
        ((place,),) = watch(tmp_path, script, [0.3], "ball.a.position")
        assert (place[0] > 1e-3) == slides
        if not slides:
            assert abs(place[0]) < 1e-6


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("wall", ["{mesh: {file: slab.obj}}", "{box: {size: 0.001 2 2 m}}"])
@pytest.mark.parametrize("radius", [0, 0.02])
def test_nothing_passes_a_wall_of_a_millimeter_at_500_m_s(tmp_path, mode, wall, radius):
    slab(tmp_path, 0.0005, -1, 1, 1)
    start = f"position: -2.3 0.1 0.2 m, velocity: 500 0 0 m/s, radius: {radius} m"
    contact = f"{{between: [ball, wall], restitution: 0, mode: {mode}}}"
    script = ball(contact, f"{{wall: {wall}}}", start, 0.1, "{rk4: {step: 10 ms}}", "[]")
    ((place, v, first),) = watch(tmp_path, script, [0.1], "ball.a.position", "ball.a.velocity", "hit.hits.first.time")
    np.testing.assert_allclose(place, [-0.0005 - radius, 0.1, 0.2], atol=1e-9)
    np.testing.assert_allclose(v, 0, atol=1e-9)
    assert first == pytest.approx((2.3 - 0.0005 - radius) / 500, abs=1e-12)


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("radius", [0, 0.1, 0.3])
def test_a_ball_on_a_torus_given_by_its_quartic_bounces_as_on_the_torus(tmp_path, mode, radius):
    start = f"position: 1.003 1.5 0.01 m, radius: {radius} m"
    ends = []
    for ring in (
        "{torus: {radius: 1 m, tube: 0.4 m}}",
        f"{{implicit: {{field: {QUARTIC}, bounds: {{ball: 3}}}}}}",
    ):
        contact = f"{{between: [ball, ring], restitution: 1, mode: {mode}}}"
        script = ball(contact, f"{{ring: {ring}}}", start, 1.8, SOLVERS[mode])
        rows = watch(tmp_path, script, [0, 0.7, 1.8], "ball.energy", "hit.hits.count", "ball.a.position")
        energies = [row[0] for row in rows]
        assert rows[-1][1] >= 2
        np.testing.assert_allclose(energies, energies[0], rtol=1e-10)
        ends.append(rows[-1][2])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-7)


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("wall", ["{box: {size: 1 1 1 m, POSE}}", "{torus: {radius: 1 m, tube: 0.5 m, POSE}}"])
def test_a_moving_surface_hands_on_its_speed(tmp_path, mode, wall):
    reach = 1.5 if "torus" in wall else 0.5
    wall = wall.replace("POSE", f"position: {{x: -{1 + reach} m + 3 m/s*time, y: 0 m, z: 0 m}}")
    start = "position: 0 0 0 m, velocity: -1 0 0 m/s, radius: 0.2 m"
    contact = f"{{between: [ball, wall], restitution: 1, mode: {mode}}}"
    script = ball(contact, f"{{wall: {wall}}}", start, 1, "{rk4: {step: 5 ms}}", "[]")
    ((v, first),) = watch(tmp_path, script, [1], "ball.a.velocity", "hit.hits.first.time")
    assert first == pytest.approx(0.2, abs=1e-8)
    np.testing.assert_allclose(v, [7, 0, 0], atol=1e-6)


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize("speed", [1, 10, 100])
def test_a_fast_bat_strikes_a_resting_ball_along_the_line_of_centers(tmp_path, mode, speed):
    bat = f'{{bat: {{sphere: {{radius: 0.05 m, position: ["{speed} m/s*(time - 1 s)", 0.02 m, 0 m]}}}}}}'
    contact = f"{{between: [ball, bat], restitution: 1, mode: {mode}}}"
    start = "position: 0 0 0 m, velocity: 0 0 0 m/s, radius: 0.05 m"
    script = ball(contact, bat, start, 1.5, "{rk4: {step: 10 ms}}", "[]")
    ((v, count),) = watch(tmp_path, script, [1.5], "ball.a.velocity", "hit.hits.count")
    normal = np.array([math.sqrt(0.96), -0.2, 0.0])
    np.testing.assert_allclose(v, 2 * speed * normal[0] * normal, atol=1e-6 * speed)
    assert count == 1


@pytest.mark.parametrize("mode", SOLVERS)
@pytest.mark.parametrize(
    ("pose", "place", "v"),
    [
        ('position: ["0.1 m/s*time + 0.05 m", 0, 0]', [0.15 - 0.0005, 0.1, 0.2], [0.1, 0, 0]),
        ('position: ["20 m/s*time", 0, 0]', [20 - 0.0005, 0.1, 0.2], [20, 0, 0]),
        ("rotation: {about: y, angle: 30 deg*time/(1 s)}", None, None),
    ],
)
def test_a_fast_mass_never_passes_a_thin_wall_that_moves(tmp_path, mode, pose, place, v):
    contact = f"{{between: [ball, wall], restitution: 0, mode: {mode}}}"
    wall = f"{{wall: {{box: {{size: 1e-3 3 3 m, {pose}}}}}}}"
    start = "position: -2 0.1 0.2 m, velocity: 500 0 0 m/s, radius: 0 m"
    script = ball(contact, wall, start, 1, "{rk4: {step: 10 ms}}", "[]")
    early, late = watch(tmp_path, script, [0.02, 1], "ball.a.position", "ball.a.velocity", "hit.hits.count")
    assert late[2] >= 1
    if place is None:
        turned = math.radians(30) * 0.02
        assert early[0] @ [math.cos(turned), 0, -math.sin(turned)] == pytest.approx(-0.00065, abs=1.5e-4)
    else:
        np.testing.assert_allclose(late[0], place, atol=1e-6)
        np.testing.assert_allclose(late[1], v, atol=1e-6)


def masses(mode, places, end, step="1 ms", restitution=1, friction=0, more="", forces="[]", objects="{}"):
    rows = ", ".join(
        f"p{k}: {{position: {x} m, velocity: {v} m/s, mass: {m} kg, radius: 0.1 m}}"
        for k, (x, v, m) in enumerate(places)
    )
    return f"""
clock: {{end: {end} s}}
models: {{b: {{particles: {{list: {{{rows}}}}}}}}}
forces: {forces}
contacts: {{hit: {{mutual_collision: {{restitution: {restitution}, friction: {friction}, mode: {mode}}}}}{more}}}
objects: {objects}
solvers: {{main: {{rk4: {{step: {step}}}}}}}
"""


HEAD_ON = [
    (f"{x} {y} 0", f"{-3 * x} {-3 * y} 0", m) for x, y, m in ((1, 0.02, 1), (-1, 0, 2), (0.03, 1, 3), (0, -1.1, 1))
]


@pytest.mark.parametrize("mode", SOLVERS)
def test_masses_that_collide_keep_momentum_and_energy_to_rounding(tmp_path, mode):
    outputs = ("b.momentum", "b.kinetic", "hit.hits.count", "b.positions", "b.energy")
    start, end = watch(tmp_path, masses(mode, HEAD_ON, 1), [0, 1], *outputs)
    assert end[2] >= 2
    np.testing.assert_allclose(end[0], start[0], atol=1e-13)
    assert end[1] == pytest.approx(start[1], rel=1e-13)
    assert end[4] == pytest.approx(start[4], rel=1e-13)
    assert min(np.linalg.norm(a - b) for k, a in enumerate(end[3]) for b in end[3][:k]) >= 0.2 - 1e-12


def test_masses_collide_in_both_modes_alike(tmp_path):
    ends = [watch(tmp_path, masses(mode, HEAD_ON, 1), [1], "b.positions")[0][0] for mode in SOLVERS]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-10)


@pytest.mark.parametrize("mode", SOLVERS)
def test_a_row_of_balls_hands_the_impulse_through(tmp_path, mode):
    row = [("-1 0 0", "2 0 0", 1), ("0 0 0", "0 0 0", 1), ("0.2 0 0", "0 0 0", 1), ("0.4 0 0", "0 0 0", 1)]
    ((v,),) = watch(tmp_path, masses(mode, row, 1), [1], "b.velocities")
    np.testing.assert_allclose(v[:, 0], [0, 0, 0, 2], atol=1e-12)


@pytest.mark.parametrize("step", ["1 ms", "10 ms"])
def test_fast_masses_do_not_pass_through_each_other(tmp_path, step):
    pair = [("-3 0 0", "500 0 0", 1), ("0 0 0", "0 0 0", 1)]
    ((v,),) = watch(tmp_path, masses("local", pair, 0.1, step), [0.1], "b.velocities")
    np.testing.assert_allclose(v, [[0, 0, 0], [500, 0, 0]], atol=1e-9)


def test_inelastic_impacts_keep_momentum_and_count_what_they_take(tmp_path):
    script = masses("local", HEAD_ON, 1, restitution=0.4, friction=0.3)
    start, end = watch(tmp_path, script, [0, 1], "b.momentum", "b.kinetic", "b.energy")
    np.testing.assert_allclose(end[0], start[0], atol=1e-13)
    assert end[1] < 0.9 * start[1]
    assert end[2] == pytest.approx(start[2], rel=1e-12)


def test_a_stack_of_balls_rests_without_jitter(tmp_path):
    stack = [("0 0.1 0", "0 0 0", 1), ("0 0.35 0", "0 0 0", 1), ("0 0.7 0", "0 0 0", 3)]
    more = ", ground: {collision: {restitution: 0.5, mode: local}}"
    script = masses("local", stack, 3, restitution=0.5, more=more, forces="[gravity]", objects="{floor: plane}")
    start, two, three = watch(tmp_path, script, [0, 2, 3], "b.positions", "b.velocities", "b.energy")
    np.testing.assert_allclose(three[0][:, 1], [0.1, 0.3, 0.5], atol=1e-9)
    np.testing.assert_allclose(three[0], two[0], atol=1e-11)
    np.testing.assert_allclose(three[1], 0, atol=1e-9)
    assert three[2] == pytest.approx(start[2], rel=1e-2)


def test_masses_of_two_models_collide(tmp_path):
    script = """
clock: {end: 1 s}
models:
  a: {particles: {list: {p: {position: -1 0 0 m, velocity: 2 0 0 m/s, radius: 0.1 m, mass: 3 kg}}}}
  b: {particles: {list: {p: {position: 0 0 0 m, radius: 0.1 m, mass: 1 kg}}}}
forces: []
contacts: {hit: {mutual_collision: {between: [a, b], restitution: 1}}}
solvers: {main: {rk4: {step: 1 ms}}}
"""
    ((u, v),) = watch(tmp_path, script, [1], "a.p.velocity", "b.p.velocity")
    np.testing.assert_allclose([u[0], v[0]], [1, 3], atol=1e-12)


def test_masses_that_overlap_at_the_start_are_told_by_check_where_they_are_listed_else_by_the_run(tmp_path):
    script = masses("local", [("0 0 0", "0 0 0", 1), ("0 0.15 0", "0 0 0", 1)], 1, restitution=0.5)
    assert "'b.p0' and 'b.p1' overlap by 0.05 m at the start" in complaint(tmp_path, script)
    listed = script[script.index("{list:") : script.index("}}", script.index("p1:")) + 3]
    points = script.replace(listed, "{positions: [0 0 0 m, 0 0.15 0 m], radius: 0.1 m}")
    assert complaint(tmp_path, points) == ""
    with pytest.raises(ScriptError, match=r"mass 0 of 'b' and mass 1 of 'b' overlap by 0.05 m(.|\n)*scene.yaml:5"):
        watch(tmp_path, points, [1], "b.energy")


def test_masses_that_are_not_elastic_cannot_collide_exactly(tmp_path):
    script = masses("exact", [("0 0 0", "0 0 0", 1), ("0 1 0", "0 0 0", 1)], 1, restitution=0.5)
    assert complaint(tmp_path, script) == ""
    with pytest.raises(ScriptError, match=r"are elastic(.|\n)*scene.yaml:5"):
        watch(tmp_path, script, [1], "b.energy")


@pytest.mark.parametrize(
    ("solver", "drift"), [("implicit_euler", 0.015), ("implicit_midpoint", 1e-9), ("bdf2", 1e-3), ("tr_bdf2", 1e-3)]
)
def test_impacts_within_stages_take_the_energy_that_they_say(tmp_path, solver, drift):
    # Its own damping of free flight is implicit Euler's.
    start = "position: 0 1 0 m, velocity: 1 0 0 m/s, radius: 0.1 m"
    contact = "{between: [ball, floor], restitution: 0.5, friction: 0.2, mode: local}"
    script = ball(contact, "{floor: plane}", start, 3, f"{{{solver}: {{step: 2 ms}}}}")
    rows = watch(tmp_path, script, [0, 0.5, 1, 3], "ball.energy")
    np.testing.assert_allclose([row[0] for row in rows], rows[0][0], rtol=drift)
