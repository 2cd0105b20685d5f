"""Stops, motors, dry friction, rolling and masses among exact contacts of rigid bodies, against exact motions."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import runs
from sceneql.pipeline import load
from sceneql.report.explain import explain, text
from sceneql.run.run import Run

GRAVITY = 9.81
INERTIA = (1 + 0.1**2) / 12 + 0.25
"""Of the rod about its hinge [kg m^2]."""
TIMES = np.linspace(0, 2, 9)


def scene(drive, forces, mode="exact", solver="dop853: {tolerance: 1e-12}"):
    """A rod of 1 m and 1 kg on a hinge at its end, level at the start, and a ball that falls to the floor beside it."""
    return f"""
clock: {{end: 2 s}}
objects:
  rod: {{box: {{size: 1 0.1 0.1 m, position: 0.5 0 0 m}}}}
  ball: {{sphere: {{radius: 0.1 m, position: 5 0 0 m}}}}
  floor: {{plane: {{position: 0 -2 0 m}}}}
models: {{it: {{rigid: {{bodies: {{rod: {{of: rod, mass: 1 kg}}, ball: {{of: ball, mass: 1 kg}}}}}}}}}}
ties: {{h: {{hinge: {{between: [it.rod, world], at: 0 0 0 m, axis: 0 0 1, {drive}}}}}}}
forces: [{forces}]
contacts: {{touch: {{collision: {{mode: {mode}, restitution: 0.5, friction: 0.2}}}}}}
solvers: {{main: {{{solver}}}}}
"""


def watch(folder, *outputs, times=TIMES, **how):
    return runs.watch(folder, scene(**how), times, *outputs, pruned=False)


def swings(times, stop, restitution):
    """Angle and speed (n, 2) of the rod that falls on a stop."""

    def rate(t, y):
        return y[1], -GRAVITY * 0.5 * np.cos(y[0]) / INERTIA

    def hit(t, y):
        return y[0] - stop

    hit.terminal, hit.direction = True, -1
    found, t, y = np.full((len(times), 2), np.nan), 0.0, np.zeros(2)
    tight = {"rtol": 1e-13, "atol": 1e-14, "method": "DOP853", "dense_output": True}
    while t < times[-1]:
        part = solve_ivp(rate, (t, times[-1]), y, events=hit, **tight)
        now = (times >= t) & (times <= part.t[-1])
        found[now] = np.reshape([part.sol(u) for u in times[now]], (-1, 2))
        t, y = part.t[-1], part.y[:, -1] * (1, -restitution)
        if t < times[-1] and abs(y[1]) < 1e-5:
            found[times > t] = stop, 0.0
            break
    return found


@pytest.mark.parametrize(("stop", "restitution"), [(-60, 0.5), (-37, 0.8), (-90, 1), (-20, 0)])
def test_a_rod_bounces_off_its_stop_and_comes_to_lie_on_it(tmp_path, stop, restitution):
    drive = f"limits: {stop} 10 deg, restitution: {restitution}"
    rows = watch(tmp_path, "h.angle", "h.speed", "it.energy", "h.effort", drive=drive, forces="gravity")
    expected = swings(TIMES, np.radians(stop), restitution)
    np.testing.assert_allclose([row[:2] for row in rows], expected, atol=1e-8)
    np.testing.assert_allclose([row[2] for row in rows], rows[0][2], atol=1e-9)
    if restitution < 0.8:
        assert rows[-1][3] == pytest.approx(0.5 * GRAVITY * np.cos(np.radians(stop)), abs=1e-9)


def test_a_motor_reaches_its_speed_by_its_largest_torque_and_keeps_it(tmp_path):
    most, speed = 0.5, 2.0
    drive = f"motor: {{speed: {speed} rad/s, torque: {most} N*m}}"
    rows = watch(tmp_path, "h.angle", "h.speed", "h.given", "h.effort", drive=drive, forces="")
    reached = INERTIA * speed / most
    grows = np.minimum(TIMES, reached)
    angles = 0.5 * most / INERTIA * grows**2 + speed * np.maximum(0, TIMES - reached)
    np.testing.assert_allclose([row[0] for row in rows], angles, atol=1e-10)
    np.testing.assert_allclose([row[1] for row in rows], most / INERTIA * grows, atol=1e-11)
    np.testing.assert_allclose([row[2] for row in rows], 0.5 * most**2 / INERTIA * grows**2, atol=1e-11)
    np.testing.assert_allclose([row[3] for row in rows], np.where(reached > TIMES, most, 0), atol=1e-11)


def test_a_motor_that_follows_an_angle_takes_its_error_away_as_it_settles(tmp_path):
    motor = "motor: {angle: 0.5 rad*sin(2*time/(1 s)), torque: 8 N*m, settling: 0.2 s}"
    rows = watch(tmp_path, "h.angle", "it.energy", "h.given", drive=motor, forces="gravity")

    def behind(t, y):
        return y[1] - np.cos(2 * t) - (0.5 * np.sin(2 * t) - y[0]) / 0.2

    def rate(t, y):
        return y[1], (-GRAVITY * 0.5 * np.cos(y[0]) + 8) / INERTIA

    behind.terminal, behind.direction = True, 1
    slips = solve_ivp(rate, (0, 2), (0, 0), events=behind, rtol=1e-13, atol=1e-14, method="DOP853")
    t0, error = slips.t[-1], slips.y[0, -1] - 0.5 * np.sin(2 * slips.t[-1])
    expected = 0.5 * np.sin(2 * TIMES[1:]) + error * np.exp((t0 - TIMES[1:]) / 0.2)
    np.testing.assert_allclose([angle for angle, *_ in rows[1:]], expected, atol=1e-9)
    np.testing.assert_allclose([energy for _, energy, _ in rows], rows[0][1], atol=1e-9)
    angle, speed = expected[-1], np.cos(4) - error / 0.2 * np.exp((t0 - 2) / 0.2)
    assert rows[-1][2] == pytest.approx(0.5 * INERTIA * speed**2 + 0.5 * GRAVITY * np.sin(angle), abs=1e-8)


def test_dry_friction_brakes_a_rod_and_holds_it_where_it_can(tmp_path):
    rows = watch(tmp_path, "h.angle", "h.speed", "h.effort", "it.energy", drive="friction: 3 N*m", forces="gravity")

    def rate(t, y):
        return y[1], (-GRAVITY * 0.5 * np.cos(y[0]) + 3) / INERTIA

    def turns(t, y):
        return y[1]

    turns.terminal, turns.direction = True, 1
    whole = solve_ivp(rate, (0, 2), (0, 0), events=turns, rtol=1e-13, atol=1e-14, method="DOP853", dense_output=True)
    falls = whole.t[-1]
    expected = [whole.sol(min(t, falls))[0] for t in TIMES]
    np.testing.assert_allclose([angle for angle, *_ in rows], expected, atol=1e-10)
    assert rows[-1][1] == pytest.approx(0, abs=1e-15)
    assert rows[-1][2] == pytest.approx(0.5 * GRAVITY * np.cos(expected[-1]), abs=1e-9)
    np.testing.assert_allclose([energy for *_, energy in rows], rows[0][3], atol=1e-9)


def test_a_slider_is_driven_up_to_its_stop_and_held_there(tmp_path):
    script = """
clock: {end: 2 s}
objects: {o: {box: {size: 0.2 0.2 0.2 m, position: 0 1 0 m}}, floor: plane}
models: {it: {rigid: {of: o, mass: 2 kg}}}
ties: {rail: {slider: {between: [it, world], axis: 1 0 0, limits: -1 0.5 m, motor: {speed: 3 m/s, force: 4 N}}}}
forces: [gravity]
contacts: {touch: {collision: {restitution: 0}}}
solvers: {main: {dop853: {tolerance: 1e-12}}}
"""
    times = [0.5, 0.7, 1, 2]
    rows = runs.watch(tmp_path, script, times, "rail.shift", "rail.speed", "rail.effort", "rail.given", pruned=False)
    reached = np.sqrt(0.5)
    np.testing.assert_allclose([row[0] for row in rows], np.minimum(0.5, np.square(times)), atol=1e-11)
    np.testing.assert_allclose([row[1] for row in rows], np.where(np.less(times, reached), np.multiply(2, times), 0))
    np.testing.assert_allclose([row[2] for row in rows], np.where(np.less(times, reached), 4, 0), atol=1e-10)
    np.testing.assert_allclose([row[3] for row in rows], 4 * np.minimum(0.5, np.square(times)), atol=1e-10)


def test_motors_and_stops_go_on_in_steps_where_exact_contacts_give_way(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("""
clock: {end: 0.6 s}
objects:
  table: {box: {size: 1 0.2 1 m, position: 0 -0.1 0 m}}
  ring: {torus: {radius: 0.08 m, tube: 0.02 m, position: 0.3 0.02 0 m, rotation: {about: y, angle: 20 deg}}}
  rod: {box: {size: 0.2 0.02 0.02 m, position: 0 1 0 m}}
models: {it: {rigid: {bodies: {ring: {of: ring, mass: 1 kg, velocity: 2 0 0 m/s}, rod: {of: rod, mass: 1 kg}}}}}
ties: {h: {hinge: {between: [it.rod, world], at: 0 1 0 m, axis: 0 0 1, motor: {speed: 3 rad/s, torque: 0.05 N*m}}}}
forces: [gravity]
contacts: {touch: {collision: {restitution: 0, friction: 0.2}}}
""")
    run, inertia = Run(load(path, pruned=False)), 0.2**2 / 12 + 0.02**2 / 12
    rows = [
        [moment.read("h", "speed"), moment.read("h", "given"), run.islands[0].assembly.contact_mode]
        for moment in run.moments([0.04, 0.6])
    ]
    assert [mode for *_, mode in rows] == ["exact", "local"]
    assert rows[0][:2] == pytest.approx([0.05 * 0.04 / inertia, 0.5 * (0.05 * 0.04) ** 2 / inertia], rel=1e-9)
    assert rows[1][:2] == pytest.approx([3, 0.5 * inertia * 9], rel=2e-2)


BALL = "sphere: {radius: 0.1 m, position: 0 0.1 0 m}"


def rolls(folder, motion, times, *outputs, friction=0.5, rolling="5 mm", ball=BALL, floor="plane"):
    """Outputs of a ball `it` of 0.1 m and 2 kg on a floor that resists rolling."""
    script = f"""
clock: {{end: {max(times)} s}}
objects: {{b: {{{ball}}}, floor: {floor}}}
models: {{it: {{rigid: {{of: b, mass: 2 kg, {motion}}}}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{mode: exact, restitution: 0, friction: {friction}, rolling: {rolling}}}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-12}}}}}}
"""
    return runs.watch(folder, script, times, *outputs, pruned=False)


def test_a_ball_rolls_to_rest_after_the_exact_way(tmp_path):
    times = np.array([1, 2, 3, 4])
    rows = rolls(tmp_path, "velocity: 1 0 0 m/s, spin: 0 0 -10 rad/s", times, "it.position", "it.energy", "it.kinetic")
    slows = GRAVITY * 0.005 / (1.4 * 0.1)
    now = np.minimum(times, 1 / slows)
    np.testing.assert_allclose([x[0] for x, *_ in rows], now - 0.5 * slows * now**2, atol=1e-10)
    np.testing.assert_allclose([energy for _, energy, _ in rows], 3.362, atol=1e-10)
    assert rows[-1][2] < 1e-25


def test_a_ball_spins_to_rest_by_the_moment_against_spinning(tmp_path):
    times = np.array([0.3, 0.6, 1])
    rows = rolls(tmp_path, "spin: 0 10 0 rad/s", times, "it.spin")
    slows = GRAVITY * 0.005 / (0.4 * 0.1**2)
    np.testing.assert_allclose([w[1] for (w,) in rows], np.maximum(0, 10 - slows * times), atol=1e-10)


def test_a_ball_slides_then_rolls_against_a_moment(tmp_path):
    times = np.array([0.2, 1, 2])
    rows = rolls(tmp_path, "velocity: 3 0 0 m/s", times, "it.position", "it.spin", friction=0.2)
    gains = (0.2 * GRAVITY * 0.1 - 0.005 * GRAVITY) / (0.4 * 0.1**2)
    until = 3 / (0.2 * GRAVITY + 0.1 * gains)
    slid, rolled = np.minimum(times, until), np.maximum(0, times - until)
    speed, slows = 3 - 0.2 * GRAVITY * until, GRAVITY * 0.005 / (1.4 * 0.1)
    places = 3 * slid - 0.1 * GRAVITY * slid**2 + speed * rolled - 0.5 * slows * rolled**2
    np.testing.assert_allclose([x[0] for x, _ in rows], places, atol=1e-9)
    assert rows[0][1][2] == pytest.approx(-0.2 * gains, abs=1e-10)


@pytest.mark.parametrize("named", ["arm", "load", "arm, load"])
def test_a_stop_takes_energy_from_bodies_that_no_contact_names_too(tmp_path, named):
    """Of an arm that is stopped and of what hangs from it; 43 of 191 J were of no account."""
    script = f"""
clock: {{end: 2 s}}
objects:
  floor: plane
  beam: {{box: {{size: 2 0.15 0.15 m, position: 1 1.5 0 m}}}}
  block: {{box: {{size: 0.3 0.3 0.3 m, position: 2 1.2 0 m}}}}
models:
  arm: {{rigid: {{of: beam, mass: 5 kg}}}}
  load: {{rigid: {{of: block, mass: 10 kg}}}}
ties:
  axle: {{hinge: {{between: [arm, world], at: 0 1.5 0 m, axis: 0 0 1, limits: -30 30 deg}}}}
  hanger: {{hinge: {{between: [load, arm], at: 2 1.5 0 m, axis: 0 0 1}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{between: [{named}, floor], mode: exact}}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-10}}}}}}
"""
    rows = runs.watch(tmp_path, script, [0, 1, 2], "arm.energy", "load.energy", "load.dissipated", pruned=False)
    energy = np.array([a + b for a, b, _ in rows])
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
    assert rows[-1][2] > 40


@pytest.mark.parametrize(("part", "stays"), [(0.999, True), (1.001, False)])
def test_a_ball_stays_on_a_slope_up_to_rolling_over_its_radius(tmp_path, part, stays):
    angle = float(np.arctan(part * 0.05))
    normal = np.array([np.sin(angle), np.cos(angle), 0])
    ball = f"sphere: {{radius: 0.1 m, position: {' '.join(map(str, 0.1 * normal))} m}}"
    floor = f"{{plane: {{normal: {' '.join(map(str, normal))}}}}}"
    ((x,),) = rolls(tmp_path, "spin: 0 0 0 rad/s", [4], "it.position", ball=ball, floor=floor)
    pull = 0.0 if stays else GRAVITY * (np.sin(angle) - 0.05 * np.cos(angle)) / 1.4
    np.testing.assert_allclose(x, 0.1 * normal + 8 * pull * np.array([normal[1], -normal[0], 0]), atol=1e-10)


@pytest.mark.parametrize("radius", ["0 m", "5 cm"])
@pytest.mark.parametrize(("height", "friction"), [(0, 0), (0.05, 0), (0.05, 0.4), (-0.03, 3)])
def test_a_mass_strikes_a_box_as_the_laws_of_impact_say(tmp_path, radius, height, friction):
    script = f"""
clock: {{end: 1 s}}
objects: {{o: {{box: {{size: 0.2 0.2 0.2 m, position: 0 0 0 m}}}}}}
models:
  it: {{rigid: {{of: o, mass: 1 kg}}}}
  net:
    mass_spring:
      radius: {radius}
      masses: {{a: {{position: 1 {height} 0 m, mass: 2 kg, velocity: -2 0 0 m/s}}}}
contacts: {{touch: {{collision: {{mode: exact, between: [it, net], restitution: 1, friction: {friction}}}}}}}
"""
    outputs = ("it.velocity", "it.spin", "net.a.velocity", "touch.hits.count")
    ((v, w, u, hits),) = runs.watch(tmp_path, script, [1], *outputs, pruned=False)
    arm = np.array([0.1 + (0.05 if radius != "0 m" else 0), height, 0])
    inertia = 0.2**2 / 6
    pushed, turned = np.array([-1.0, 0, 0]), np.cross(arm, [-1, 0, 0])[2]
    rubbed, across = np.array([0, 1.0, 0]), np.cross(arm, [0, 1, 0])[2]
    # Impulses n along x and f along y on the box: relative speeds along x reversed, along y 0 or |f| = friction n.
    w_nn, w_nf, w_ff = 1.5 + turned**2 / inertia, turned * across / inertia, 1.5 + across**2 / inertia
    n, f = np.linalg.solve([[w_nn, w_nf], [w_nf, w_ff]], [4, 0])
    if abs(f) > friction * n:
        sign = np.sign(f)
        n = 4 / (w_nn + sign * friction * w_nf)
        f = sign * friction * n
    np.testing.assert_allclose(v, n * pushed + f * rubbed, atol=1e-12)
    np.testing.assert_allclose(w, [0, 0, (n * turned + f * across) / inertia], atol=1e-11)
    np.testing.assert_allclose(u, [-2 + n / 2, -f / 2, 0], atol=1e-12)
    assert hits == 1


def test_masses_come_to_rest_on_a_body_that_rests_on_the_floor(tmp_path):
    script = """
clock: {end: 4 s}
objects: {o: {box: {size: 1 0.2 1 m, position: 0 0.1 0 m}}, floor: plane}
models:
  it: {rigid: {of: o, mass: 30 kg}}
  net:
    mass_spring:
      radius: 5 cm
      masses: {a: {position: 0.1 1 0 m, mass: 2 kg, velocity: 0.3 0 0 m/s}, b: {position: 1.1 1 0 m, mass: 1 kg}}
forces: [gravity]
contacts: {touch: {collision: {restitution: 0.3, friction: 0.3}}}
"""
    rows = runs.watch(tmp_path, script, [0, 4], "it.energy", "net.energy", "net.positions", "it.position", pruned=False)
    assert sum(rows[1][:2]) == pytest.approx(sum(rows[0][:2]), abs=1e-6)
    np.testing.assert_allclose(rows[1][2][:, 1], [0.25, 0.05], atol=1e-9)
    assert rows[1][3][1] == pytest.approx(0.1, abs=1e-9)


def test_explain_tells_that_stops_and_motors_are_exact(tmp_path):
    path = tmp_path / "scene.yaml"
    for mode, told in (
        ("auto", "by mode exact"),
        ("local", "on the velocities at the end of a step (mode local)"),
    ):
        drive = "limits: -60 10 deg, motor: {speed: 1 rad/s, torque: 1 N*m}"
        path.write_text(scene(drive, "gravity", mode) + "outputs: {t: {record: {of: [h.angle]}}}\n")
        assert f"stops and its motor act {told}" in text(explain(load(path)))


@pytest.mark.parametrize("solver", ["auto", "radau", "rodas5p"])
def test_a_cart_on_a_rail_and_on_the_floor_moves_by_every_solver(tmp_path, solver):
    """Rail and floor bear it both. Its pendulum is that of Lagrange's equations until the cart meets the stop."""
    script = f"""
clock: {{end: 0.25 s}}
objects:
  box: {{box: {{size: 0.4 0.2 0.3 m, position: 0 0.1 0 m}}}}
  bob: {{sphere: {{radius: 0.1 m, position: 0.5 0.6 0 m}}}}
  floor: plane
models: {{it: {{rigid: {{of: box, mass: 2 kg}}}}, pendulum: {{rigid: {{of: bob, mass: 1 kg}}}}}}
ties:
  rail: {{slider: {{between: [it, world], axis: 1 0 0, limits: -0.3 0.3 m}}}}
  pin: {{hinge: {{between: [pendulum, it], at: 0 0.6 0 m, axis: 0 0 1}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{mode: exact, between: [it, pendulum, floor], restitution: 0, friction: 0}}}}}}
solvers: {{main: {solver}}}
"""
    rows = runs.watch(tmp_path, script, [0.1, 0.25], "it.position", "pin.angle", pruned=False)

    def rate(t, y):
        _, angle, v, w = y
        sine, cosine, moment = np.sin(angle), np.cos(angle), 0.4 * 0.1**2 + 0.5**2
        matrix = [[3, -0.5 * sine], [-0.5 * sine, moment]]
        return v, w, *np.linalg.solve(matrix, [0.5 * cosine * w**2, -GRAVITY * 0.5 * cosine])

    exact = solve_ivp(rate, (0, 0.25), [0, 0, 0, 0], t_eval=[0.1, 0.25], rtol=1e-12, atol=1e-13, method="DOP853").y
    np.testing.assert_allclose([x for x, _ in rows], np.column_stack([exact[0], [0.1, 0.1], [0, 0]]), atol=1e-6)
    np.testing.assert_allclose([angle for _, angle in rows], exact[1], atol=1e-5)


@pytest.mark.parametrize("solver", ["radau", "rodas5p"])
def test_a_motor_that_cannot_brake_a_rod_turns_against_it_by_implicit_steps(tmp_path, solver):
    """The rod falls past the motor's speed while a cart rests against its stop: the sign of the torque changes there,
    where implicit steps know the speed to some 1e-9 only."""
    script = """
clock: {end: 0.9 s}
objects:
  floor: plane
  table: {box: {size: 6 0.1 2 m, position: 1.5 0.5 0 m}}
  rod: {box: {size: 0.6 0.1 0.1 m, position: 0 1.2 0 m}}
  block: {box: {size: 0.3 0.2 0.25 m, position: 1.5 0.65 0 m}}
  wheel: {cylinder: {radius: 0.1 m, height: 0.1 m, rotation: {about: x, angle: 90 deg}, position: 3 0.7 0 m}}
models:
  it:
    rigid:
      bodies:
        rod: {of: rod, mass: 1 kg}
        cart: {of: block, mass: 1.24 kg}
        wheel: {of: wheel, mass: 0.71 kg, velocity: -0.86 0 0 m/s}
ties:
  h: {hinge: {between: [it.rod, world], at: -0.3 1.2 0 m, axis: 0 0 1, motor: {speed: 2 rad/s, torque: 1.05 N*m}}}
  rail: {slider: {between: [it.cart, world], axis: 1 0 0, limits: -0.3 0.3 m, motor: {speed: 1 m/s, force: 4.1 N}}}
forces: [gravity]
contacts: {touch: {collision: {mode: exact, restitution: 0.3, friction: 0.2}}}
solvers: {main: SOLVER}
"""
    rows = runs.watch(
        tmp_path, script.replace("SOLVER", solver), [0.82, 0.84, 0.9], "h.angle", "h.speed", "h.effort", pruned=False
    )
    inertia = (0.6**2 + 0.1**2) / 12 + 0.3**2

    def rate(t, y, torque):
        return y[1], (-GRAVITY * 0.3 * np.cos(y[0]) + torque) / inertia

    def too_fast(t, y, torque):
        return y[1] - 2

    too_fast.terminal, too_fast.direction = True, 1
    tight = {"rtol": 1e-12, "atol": 1e-13, "method": "DOP853", "dense_output": True}
    pushed = solve_ivp(rate, (0, 0.9), (0, 0), events=too_fast, args=(1.05,), **tight)
    braked = solve_ivp(rate, (pushed.t[-1], 0.9), pushed.y[:, -1], args=(-1.05,), **tight)
    expected = [pushed.sol(0.82), braked.sol(0.84), braked.sol(0.9)]
    np.testing.assert_allclose([row[:2] for row in rows], expected, atol=5e-5)
    np.testing.assert_allclose([row[2] for row in rows], [1.05, -1.05, -1.05], atol=1e-9)


@pytest.mark.parametrize(
    ("motor", "solver", "said"),
    [
        ("speed: 2 rad/s", "dop853", "exact, chosen for up to 8 bodies"),
        ("speed: 2 rad/s", "rk4", "local, `exact` locates events in steps that a tolerance chooses"),
        (
            "speed: '(1 rad/s)*floor(time/(0.5 s))'",
            "dop853",
            "local, it cannot be told how what the motor of 'h' follows changes: its",
        ),
    ],
)
def test_explain_says_why_a_motor_acts_as_it_does(tmp_path, motor, solver, said):
    written = tmp_path / "scene.yaml"
    drive = f"motor: {{torque: 5 N*m, {motor}}}"
    script = scene(drive=drive, forces="gravity", solver=solver)
    written.write_text("".join(line for line in script.splitlines(True) if not line.startswith("contacts:")))
    assert f"stops, motors and friction of h: {said}" in text(explain(load(written, pruned=False)))
