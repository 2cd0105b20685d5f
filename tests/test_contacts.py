"""Contacts: impacts at their exact instants, resting, sliding, no way through thin walls."""

import math

import numpy as np
import pytest

from runs import watch
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run

G = 9.81


def ball(contact: str, objects: str, start: str, end: float, solver: str, forces: str = "[gravity]") -> str:
    return f"""
clock: {{end: {end} s}}
models: {{ball: {{particles: {{list: {{a: {{{start}}}}}}}}}}}
forces: {forces}
contacts: {{hit: {{collision: {contact}}}}}
objects: {objects}
solvers: {{main: {solver}}}
"""


DOPRI5 = "{dopri5: {tolerance: 1e-10}}"
FLOOR = "{floor: plane}"
DROP = "position: 0 1.1 0 m, radius: 0.1 m"
TALLY = ("hit.hits.first.time", "hit.rest.time", "hit.hits.count", "hit.hits.last.speed")


@pytest.mark.parametrize("solver", [DOPRI5, "{rk4: {step: 10 ms}}"])
def test_a_bouncing_ball_hits_and_comes_to_rest_at_the_exact_times(tmp_path, solver):
    script = ball("{restitution: 0.8}", FLOOR, DROP, 6, solver)
    before, after, rest = watch(tmp_path, script, [0.4, 0.5, 6], *TALLY, "ball.a.position", "ball.energy")
    assert math.isnan(before[0])
    assert math.isnan(after[1])
    assert before[2] == 0
    assert after[2] == 1
    assert after[3] == pytest.approx(math.sqrt(2 * G), rel=1e-12)
    assert rest[0] == pytest.approx(0.451523640986, abs=1e-9)
    assert rest[1] == pytest.approx(4.063712768872, abs=1e-9)
    np.testing.assert_allclose(rest[4], [0, 0.1, 0], atol=1e-12)
    assert rest[5] == pytest.approx(1.1 * G, abs=1e-9)


def test_every_bounce_reaches_its_height(tmp_path):
    e, first = 0.8, math.sqrt(2 / G)
    apex, time = [], first
    for k in range(1, 8):
        apex.append(time + e**k * first)
        time += 2 * e**k * first
    script = ball("{restitution: 0.8}", FLOOR, DROP, 4, DOPRI5)
    rows = watch(tmp_path, script, apex, "ball.a.position")
    np.testing.assert_allclose([row[0][1] - 0.1 for row in rows], [e ** (2 * k) for k in range(1, 8)], atol=1e-10)


def test_an_elastic_ball_never_rests(tmp_path):
    script = ball("{restitution: 1}", FLOOR, DROP, 10, DOPRI5)
    ((rest, count, energy),) = watch(tmp_path, script, [10], "hit.rest.time", "hit.hits.count", "ball.energy")
    assert math.isnan(rest)
    assert count == math.floor((10 / math.sqrt(2 / G) + 1) / 2)
    assert energy == pytest.approx(1.1 * G, abs=1e-9)


def test_a_ball_without_bounce_rests_where_it_falls(tmp_path):
    script = ball("{restitution: 0}", FLOOR, DROP, 1, DOPRI5)
    ((place, v, rest, lost),) = watch(
        tmp_path, script, [1], "ball.a.position", "ball.a.velocity", "hit.rest.time", "ball.dissipated"
    )
    np.testing.assert_allclose(place, [0, 0.1, 0], atol=1e-13)
    np.testing.assert_array_equal(v, 0)
    assert rest == pytest.approx(math.sqrt(2 / G), abs=1e-12)
    assert lost == pytest.approx(G, abs=1e-10)


WALL = "{wall: {box: {size: 0.001 2 2 m}}}"


@pytest.mark.parametrize("mode", ["exact", "local"])
@pytest.mark.parametrize("step", [0.01, 0.25])
def test_a_ball_at_500_m_s_does_not_pass_a_thin_wall(tmp_path, mode, step):
    start = "position: -2.3 0.1 0.2 m, velocity: 500 0 0 m/s, radius: 0 m"
    script = ball(f"{{restitution: 0.5, mode: {mode}}}", WALL, start, 1, f"{{rk4: {{step: {step} s}}}}", "[]")
    ((place, v, first),) = watch(tmp_path, script, [1], "ball.a.position", "ball.a.velocity", "hit.hits.first.time")
    hit = (2.3 - 0.0005) / 500
    assert first == pytest.approx(hit, abs=1e-12)
    np.testing.assert_allclose(v, [-250, 0, 0], rtol=1e-12)
    np.testing.assert_allclose(place, [-0.0005 - 250 * (1 - hit), 0.1, 0.2], rtol=1e-12)


@pytest.mark.parametrize("mode", ["exact", "local"])
def test_a_ball_lobbed_over_a_wall_in_one_step_does_not_hit_it(tmp_path, mode):
    start = "position: -3 0 0 m, velocity: [3, 9.81, 0], radius: 0 m"
    script = ball(f"{{mode: {mode}}}", "{wall: {box: {size: 1 4 2 m}}}", start, 2, "{rk4: {step: 2 s}}")
    ((place, count),) = watch(tmp_path, script, [2], "ball.a.position", "hit.hits.count")
    np.testing.assert_allclose(place, [3, 0, 0], atol=1e-12)
    assert count == 0


@pytest.mark.parametrize(("mode", "solver"), [("exact", DOPRI5), ("local", "{rk4: {step: 1 ms}}")])
def test_friction_stops_a_sliding_body_after_its_exact_way(tmp_path, mode, solver):
    start = "position: 0 0.1 0 m, velocity: 3 0 4 m/s, radius: 0.1 m"
    script = ball(f"{{friction: 0.3, mode: {mode}}}", FLOOR, start, 3, solver)
    during, after = watch(tmp_path, script, [1, 3], "ball.a.velocity", "ball.a.position", "ball.energy")
    np.testing.assert_allclose(during[0], np.array([0.6, 0, 0.8]) * (5 - 0.3 * G), atol=1e-9)
    way = 25 / (2 * 0.3 * G)
    np.testing.assert_allclose(after[1], [0.6 * way, 0.1, 0.8 * way], atol=1e-9)
    np.testing.assert_array_equal(after[0], 0)
    assert after[2] == pytest.approx(12.5 + 0.1 * G, abs=1e-8)


@pytest.mark.parametrize(("mode", "solver"), [("exact", DOPRI5), ("local", "{rk4: {step: 1 ms}}")])
def test_on_a_slope_it_sticks_or_slides_by_the_angle_of_friction(tmp_path, mode, solver):
    slope = "{slope: {plane: {normal: 3 4 0}}}"  # tan(angle) = 3/4
    for friction in (0.8, 0.5):
        contact = f"{{friction: {friction}, mode: {mode}}}"
        script = ball(contact, slope, "position: 0 0 0 m, radius: 0 m", 1, solver)
        ((place, v),) = watch(tmp_path, script, [1], "ball.a.position", "ball.a.velocity")
        along = max(0.0, 0.6 - friction * 0.8) * G
        np.testing.assert_allclose(v, np.array([0.8, -0.6, 0]) * along, atol=1e-6)
        np.testing.assert_allclose(place, np.array([0.8, -0.6, 0]) * along / 2, atol=1e-5)


def test_an_impact_with_friction_takes_from_the_slip_what_coulomb_allows(tmp_path):
    start = "position: 0 1 0 m, velocity: 4 0 0 m/s, radius: 0 m"
    script = ball("{restitution: 0.5, friction: 0.2}", FLOOR, start, 0.5, DOPRI5)
    ((v, energy),) = watch(tmp_path, script, [0.5], "ball.a.velocity", "ball.energy")
    assert v[0] == pytest.approx(4 - 0.2 * 1.5 * math.sqrt(2 * G), rel=1e-10)
    assert energy == pytest.approx(8 + G, abs=1e-9)


def test_a_body_leaves_a_smooth_ball_where_nothing_presses_it(tmp_path):
    # From the top with speed v it leaves at cos(angle) = 2/3 + v^2 / (3 g R); then its horizontal speed stays.
    v, radius = 1.0, 1.2
    cosine = 2 / 3 + v**2 / (3 * G * radius)
    start = f"position: 0 {radius} 0 m, velocity: {v} 0 0 m/s, radius: 0.2 m"
    script = ball("{restitution: 0}", "{dome: {sphere: {radius: 1 m}}}", start, 1.5, DOPRI5)
    early, late = watch(tmp_path, script, [0.2, 1.5], "ball.a.position", "ball.a.velocity", "ball.energy")
    assert np.linalg.norm(early[0]) == pytest.approx(radius, abs=1e-9)
    speed = math.sqrt(v**2 + 2 * G * radius * (1 - cosine))
    assert late[1][0] == pytest.approx(speed * cosine, abs=1e-4)
    assert late[2] == pytest.approx(early[2], abs=1e-6)


def test_a_body_rests_in_the_corner_of_two_planes(tmp_path):
    walls = "{left: {plane: {normal: 1 1 0}}, right: {plane: {normal: -1 1 0}}}"
    script = ball("{restitution: 0.3}", walls, "position: 0.3 2 0 m, radius: 0.1 m", 6, DOPRI5)
    ((place, v, energy, first),) = watch(
        tmp_path, script, [6], "ball.a.position", "ball.a.velocity", "ball.energy", "ball.dissipated"
    )
    np.testing.assert_allclose(place, [0, 0.1 * math.sqrt(2), 0], atol=1e-6)
    np.testing.assert_allclose(v, 0, atol=1e-6)
    assert energy == pytest.approx(2 * G, abs=1e-6)
    assert first > 0


@pytest.mark.parametrize("mode", ["exact", "local"])
def test_a_moving_wall_hands_on_its_speed(tmp_path, mode):
    wall = "{wall: {box: {size: 1 1 1 m, position: {x: -1.5 m + 3 m/s*time, y: 0 m, z: 0 m}}}}"
    start = "position: 0 0 0 m, velocity: -1 0 0 m/s, radius: 0.2 m"
    script = ball(f"{{restitution: 1, mode: {mode}}}", wall, start, 1, "{rk4: {step: 5 ms}}", "[]")
    ((v, first),) = watch(tmp_path, script, [1], "ball.a.velocity", "hit.hits.first.time")
    assert first == pytest.approx(0.2, abs=1e-8)
    np.testing.assert_allclose(v, [7, 0, 0], atol=1e-7)


def test_a_body_rides_a_lift(tmp_path):
    lift = "{lift: {box: {size: 2 1 2 m, position: {x: 0 m, y: 0.2 m*sin(2*time/(1 s)), z: 0 m}}}}"
    script = ball("{restitution: 0}", lift, "position: 0 0.6 0 m, velocity: 0 0.4 0 m/s, radius: 0.1 m", 3, DOPRI5)
    for t in (1.0, 2.5):
        ((place, v),) = watch(tmp_path, script, [t], "ball.a.position", "ball.a.velocity")
        assert place[1] == pytest.approx(0.6 + 0.2 * math.sin(2 * t), abs=1e-7)
        assert v[1] == pytest.approx(0.4 * math.cos(2 * t), abs=1e-6)


JELLY = """
clock: {{end: 4 s}}
models:
  jelly:
    mass_spring:
      lattice: {{count: 3 3 3, spacing: 0.3 m, center: 0 1 0 m, rotation: {{about: {axis}, angle: {angle}}}}}
      stiffness: 2 kN/m
      damping: 2 N*s/m
      radius: 0.05 m
forces: [gravity]
contacts: {{hit: {{collision: {{restitution: 0.3, friction: 0.4, mode: {mode}}}}}}}
objects: {{floor: plane}}
solvers: {{main: {{rk4: {{step: 1 ms}}}}}}
"""


@pytest.mark.parametrize(("mode", "loss"), [("exact", 1e-5), ("local", 5e-2)])
def test_a_jelly_comes_to_rest_on_the_floor_and_neither_sinks_nor_buzzes(tmp_path, mode, loss):
    script = JELLY.format(mode=mode, axis="x", angle="0 deg")
    outputs = ("jelly.positions", "jelly.velocities", "jelly.energy")
    start, three, four = watch(tmp_path, script, [0, 3, 4], *outputs)
    assert four[0][:, 1].min() == pytest.approx(0.05, abs=1e-12)
    assert np.abs(four[1]).max() < 1e-9
    np.testing.assert_allclose(four[0], three[0], atol=1e-9)
    assert four[2] == pytest.approx(start[2], rel=loss)


def test_a_tilted_jelly_tumbles_to_rest(tmp_path):
    script = JELLY.format(mode="exact", axis="z", angle="25 deg")
    start, end = watch(tmp_path, script, [0, 4], "jelly.positions", "jelly.velocities", "jelly.energy")
    assert end[0][:, 1].min() > 0.05 - 1e-9
    assert np.abs(end[1]).max() < 0.05
    assert end[2] == pytest.approx(start[2], rel=1e-2)


def test_masses_fall_on_a_ball_in_both_modes_alike(tmp_path):
    ends = []
    for mode in ("exact", "local"):
        script = ball(
            f"{{restitution: 0.6, friction: 0.1, mode: {mode}}}",
            "{dome: {sphere: {radius: 1 m}}}",
            "position: 0.3 2 0.1 m, radius: 0.1 m",
            1,
            "{rk4: {step: 1 ms}}",
        )
        ends.append(watch(tmp_path, script, [1], "ball.a.position")[0][0])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


@pytest.mark.parametrize(
    ("objects", "text"),
    [
        ("{ring: {torus: {tube: 0.1 m + 0.01 m/s*time}}}", "'ring': a surface that changes its shape in time"),
        ("{ring: {implicit: {field: 'x^2 + y^2 + z^2 - t'}}}", "'ring': a surface that changes its shape in time"),
        ("{ring: {mesh: {file: open.obj}}}", "'ring': its mesh is open: 3 edges"),
        ("{ring: {mesh: {file: twice.obj}}}", "'ring': its mesh has edges with more than two triangles"),
        ("{ring: {torus: {position: 0.5 1 0 m}}}", "mass 0 of 'ball' starts inside 'ring', 0.15 m deep"),
        ("{ring: {plane: {height: 2 m}}}", "mass 0 of 'ball' starts inside 'ring', 1 m deep"),
    ],
)
def test_what_cannot_be_collided_with_is_told_with_its_place(tmp_path, objects, text):
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "twice.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    script = ball("{between: [ball, ring]}", objects, "position: 0 1 0 m", 0.1, DOPRI5)
    with pytest.raises(ScriptError, match=text + r"(.|\n)*scene.yaml:5"):
        watch(tmp_path, script, [1], "ball.a.position")


@pytest.mark.parametrize("solver", ["dopri5", "radau"])
def test_a_soft_jelly_is_not_crushed_in_the_long_steps_of_a_loose_tolerance(tmp_path, solver):
    script = """
clock: {end: 1.2 s}
models:
  jelly: {mass_spring: {lattice: {count: 3 3 3, spacing: 0.1 m, center: 0 1 0 m}, stiffness: 200 N/m,
    damping: 2 N*s/m, radius: 0.05 m}}
forces: [gravity]
contacts: {hit: {collision: {restitution: 0.1, friction: 0.4, mode: local}}}
objects: {floor: plane}
solvers: {main: SOLVER}
"""
    shapes = []
    for how in (f"{{{solver}: {{tolerance: 1e-3}}}}", "{rk4: {step: 1 ms}}"):
        ((places,),) = watch(tmp_path, script.replace("SOLVER", how), [1.2], "jelly.positions")
        shapes.append(np.ptp(places, axis=0))
    np.testing.assert_allclose(*shapes, rtol=1e-2)


def test_a_flight_past_local_contacts_costs_no_more_evaluations_of_the_rate(tmp_path):
    counts = []
    for contact in ("{hit: {collision: {mode: local}}}", "{}"):
        path = tmp_path / "scene.yaml"
        script = ball("{}", FLOOR, DROP, 0.4, "{rk4: {step: 10 ms}}").replace("{hit: {collision: {}}}", contact)
        path.write_text(script, encoding="utf-8")
        (island,) = Run(load(path)).islands
        island.advance(0.4)
        counts.append(island.march.statistics.evaluations)
    assert counts[0] == counts[1] > 0


@pytest.mark.parametrize("height", [2, 3, 10])
def test_a_ball_rests_though_nobody_looks_for_long(tmp_path, height):
    """Steps are long then, and flights before it rests so short that the gap near their start is rounding alone."""
    script = f"""
models: {{fall: {{particles: {{of: ball, mass: 1 kg}}}}}}
objects: {{ball: {{sphere: {{radius: 0.1 m, position: 0 {height} 0 m}}}}, floor: plane}}
forces: [gravity]
contacts: [collision]
clock: {{end: 20 s}}
"""
    ((at,),) = watch(tmp_path, script, [15.0], "ball.position")
    assert at == pytest.approx([0.0, 0.1, 0.0], abs=1e-12)
