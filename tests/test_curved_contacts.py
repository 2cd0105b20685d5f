"""Curved rigid bodies in contact, mode `exact`: how contacts wander over them, and what rolls, against exact values."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import runs
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R, AT_V, AT_W, AT_X, MOVED
from sceneql.contacts.rigid_exact import contact_kernels as records
from sceneql.contacts.rigid_exact.curved import column, ellipsoid, ring
from sceneql.contacts.rigid_exact.curved_contact_kernels import ON_CORNER, ON_EDGE, ON_FACE, follow
from sceneql.contacts.rigid_exact.curved_surface_kernels import away

A_AT = np.array([1.1, 0.4, 1.3])
NO_FIELD = np.zeros(1, dtype=np.int64)
TIGHT = "dop853: {tolerance: 1e-12}"


def mover(x, turn, v, w):
    found = np.zeros(MOVED)
    found[AT_X : AT_X + 3], found[AT_V : AT_V + 3], found[AT_W : AT_W + 3] = x, v, w
    found[AT_R : AT_R + 9] = turn.as_matrix().ravel()
    return found


@pytest.mark.parametrize("shape", [ellipsoid((0.3, 0.5, 0.9)), ring(0.6, 0.2), column(0.5, 0.4)], ids=lambda s: s.form)
@pytest.mark.parametrize("kind", [ON_FACE, ON_EDGE, ON_CORNER])
def test_the_gap_of_a_curved_body_changes_as_its_row_says(shape, kind):
    """Both move freely: the gap's two derivatives are what its row tells at no acceleration."""
    random = np.random.default_rng(kind)
    whole = shape.mapped(np.column_stack([Rotation.random(random_state=1).as_matrix(), [0.1, -0.2, 0.05]]))
    numbers = whole.shape(np.array([0.03, 0.02, -0.01])).floats
    for _ in range(5):
        motions = random.normal(size=(2, 6))
        turns = Rotation.random(2, random_state=random)
        line = random.normal(size=3)
        record = np.zeros(records.RECORD)
        record[records.KIND], record[records.SIGN], record[records.RADIUS_B] = kind, 1, 0.1
        record[records.LINE_A] = records.RECORD
        record[records.OWN_B : records.OWN_B + 3] = 0.2, -0.1, 0.3
        record[records.LINE_B : records.LINE_B + 3] = line = line / np.linalg.norm(line)
        # Where along the line the body is nearest, roughly.
        start, along = np.array([0.2, -0.1, 0.3]), np.linspace(-4, 4, 4001)
        places = turns[1].apply(start + along[:, None] * line)
        gaps = [away(numbers, NO_FIELD, 0, *place)[0] for place in turns[0].inv().apply(places - A_AT)]
        record[records.LINE_A + 1] = along[np.argmin(gaps)]

        def told(t, record=record, turns=turns, motions=motions):
            begins = records.RECORD + len(numbers)
            both = [
                mover(x + t * m[:3], Rotation.from_rotvec(t * m[3:]) * turn, m[:3], m[3:])
                for x, turn, m in zip((A_AT, np.zeros(3)), turns, motions, strict=True)
            ]
            floats = np.concatenate([record, numbers, *both])
            follow(floats, NO_FIELD, 0, begins, begins + MOVED)
            return floats[[records.GAP, records.SPEED, records.BIAS]]

        h = 1e-4
        early, now, late = told(-h), told(0.0), told(h)
        assert (late[0] - early[0]) / (2 * h) == pytest.approx(now[1], abs=3e-6)
        assert (late[1] - early[1]) / (2 * h) == pytest.approx(now[2], abs=3e-5 * (1 + abs(now[2])))


def watch(folder, objects, model, times, *outputs, law, more="", forces="[gravity]", solver=TIGHT):
    """Outputs of the rigid body `it`, and of its contacts `touch`, among these objects."""
    lines = "\n".join(f"  {name}: {what}" for name, what in objects.items())
    script = f"""
clock: {{end: {float(max(times))} s}}
objects:
{lines}
models: {{it: {{rigid: {{{model}}}}}}}
forces: {forces}
contacts: {{touch: {{collision: {{{law}}}}}}}
solvers: {{main: {{{solver}}}}}
{more}
"""
    return runs.watch(folder, script, times, *outputs, pruned=False)


EXACT = "mode: exact, restitution: 0, friction: 1"


@pytest.mark.parametrize(
    ("radius", "half", "tilt", "solver", "bound"),
    [
        (0.1, 0.005, 30, TIGHT, 1e-8),
        (0.02, 0.0, 70, TIGHT, 1e-8),
        (0.5, 0.1, 12, TIGHT, 1e-8),
        (0.1, 0.005, 30, "dopri5: {tolerance: 1e-11}", 1e-6),
    ],
)
def test_a_coin_in_steady_precession_rolls_twenty_turns(tmp_path, radius, half, tilt, solver, bound):
    """The contact runs round at W^2 = g (a cos - b sin)/(sin (I1 cos - I3 b/a sin)): without b 4 g/(a sin)."""
    half = half or 1e-9 * radius
    alpha, aspect = np.radians(tilt), half / radius
    first, axial = radius**2 / 4 + half**2 / 3, radius**2 / 2
    rise = radius * np.cos(alpha) - half * np.sin(alpha)
    rate = np.sqrt(9.81 * rise / (np.sin(alpha) * (first * np.cos(alpha) - axial * aspect * np.sin(alpha))))
    axis = np.array([-np.sin(alpha), np.cos(alpha), 0])
    down = -np.array([0, 1, 0]) + axis[1] * axis
    rim = radius * down / np.linalg.norm(down) - half * axis
    spin = -rate * np.sin(alpha) * np.sqrt(1 + aspect**2) * rim / np.linalg.norm(rim)
    place = f"position: 0 {float(-rim[1])} 0 m, rotation: {{about: z, angle: {float(alpha)} rad}}"
    objects = {"coin": f"{{cylinder: {{radius: {radius} m, height: {2 * half} m, {place}}}}}", "floor": "plane"}
    turn = 2 * np.pi / rate
    model = f"of: coin, mass: 1 kg, spin: {' '.join(str(float(x)) for x in spin)} rad/s"
    rows = watch(
        tmp_path, objects, model, [20 * turn, 20.25 * turn], "it.rotation", "it.position", law=EXACT, solver=solver
    )
    for (q, x), quarters in zip(rows, (0, 1), strict=True):
        now = Rotation.from_quat(q, scalar_first=True).apply([0, 1, 0])
        sense = np.sign(np.cross(axis, now)[1] or 1) if quarters else 1
        expected = Rotation.from_rotvec([0, sense * quarters * np.pi / 2, 0]).apply(axis)
        assert np.abs(now - expected).max() < bound
        assert np.abs(x - [0, -rim[1], 0]).max() < bound * radius


def test_a_rattleback_turns_back_and_goes_on_the_other_way(tmp_path):
    stone = "{group: {scale: 20 3 2, position: 0 0 0.02 m, children: [{sphere: {radius: 1 cm}}]}}"
    objects = {"stone": stone, "floor": "{plane: {normal: 0 0 1}}"}
    forces = "[{gravity: {acceleration: 0 0 -9.81 m/s^2}}]"
    for spin, after in ((-5, 2.681865483), (5, 5.000028249)):
        v = np.cross([0.01, 0.02, spin], [0, 0, 0.02])
        model = "of: stone, mass: 1 kg, inertia: 2e-4 1.6e-3 1.7e-3 kg*m^2, axes: {about: z, angle: 0.03 rad}, "
        model += f"spin: 0.01 0.02 {spin} rad/s, velocity: {' '.join(str(float(x)) for x in v)} m/s"
        ((w, points),) = watch(tmp_path, objects, model, [3], "it.spin", "touch.points", law=EXACT, forces=forces)
        assert w[2] == pytest.approx(after, abs=1e-8)
        assert len(points) == 1


@pytest.mark.parametrize("shape", ["cylinder: {radius: 3 m, height: 0.2 m,", "box: {size: 6 0.2 6 m,"])
def test_a_ball_rolls_in_a_circle_on_a_table_that_turns_by_a_formula(tmp_path, shape):
    table = f"{{{shape} position: 0 -0.1 0 m, rotation: {{about: y, angle: 3 rad/s * time}}}}}}"
    objects = {"table": table, "ball": "{sphere: {radius: 0.1 m, position: 1 0.1 0 m}}"}
    model = "of: ball, mass: 1 kg, velocity: 0 0 -0.3 m/s, spin: 27 0 0 rad/s"
    ((x, v),) = watch(tmp_path, objects, model, [4], "it.position", "it.velocity", law=EXACT)
    k = 6 / 7
    angle = 4 * k
    assert np.hypot(x[0] - 1 + 0.3 / k, x[2]) == pytest.approx(0.3 / k, abs=1e-8)
    np.testing.assert_allclose(x, [1 + 0.3 / k * (np.cos(angle) - 1), 0.1, -0.3 / k * np.sin(angle)], atol=1e-8)
    np.testing.assert_allclose(v, [-0.3 * np.sin(angle), 0, -0.3 * np.cos(angle)], atol=1e-8)


def test_a_lift_that_starts_and_stops_carries_a_ring_without_a_gap(tmp_path):
    objects = {
        "lift": '{box: {size: 2 0.2 2 m, position: [0 m, "0.2 m * sin(3 rad/s * time) - 0.1 m", 0 m]}}',
        "ring": "{torus: {radius: 0.3 m, tube: 0.1 m, position: 0 0.4 0 m, rotation: {about: z, angle: 90 deg}}}",
    }
    rows = watch(tmp_path, objects, "of: ring, mass: 1 kg", [0.5, 1, 2], "it.position", law=EXACT)
    for (x,), t in zip(rows, [0.5, 1, 2], strict=True):
        np.testing.assert_allclose(x, [0, 0.4 + 0.2 * np.sin(3 * t), 0], atol=1e-10)


BETWEEN = "between: [it, ring], mode: exact, restitution: 1"


def test_a_ball_bounces_on_an_implicit_torus_as_on_a_torus(tmp_path):
    place = "position: 0 -0.1 0 m, rotation: {about: y, angle: 30 deg}"
    field = '{field: "(x^2 + y^2 + z^2 + 0.84)^2 - 4*(x^2 + z^2)", bounds: {ball: 2}'
    found = []
    for what in (f"{{torus: {{radius: 1 m, tube: 0.4 m, {place}}}}}", f"{{implicit: {field}, {place}}}}}"):
        objects = {"ring": what, "ball": "{sphere: {radius: 0.2 m, position: 0.997 0.8 0 m}}"}
        outputs = ("it.position", "it.energy", "touch.hits.count")
        model = "of: ball, mass: 1 kg, spin: 0.1 0.2 0.3 rad/s"
        rows = watch(tmp_path, objects, model, np.linspace(0, 1.5, 16)[1:], *outputs, law=f"{BETWEEN}, friction: 0.3")
        assert rows[-1][2] > 2
        assert np.ptp([row[1] for row in rows]) < 1e-9
        found.append(rows[-1][0])
    np.testing.assert_allclose(found[1], found[0], atol=1e-7)


@pytest.mark.parametrize(
    ("size", "place"),
    [
        ((1.7, 0.3, 1.7), "0.02 1.2 0.01 m, rotation: {about: 1 2 1, angle: 4 deg}"),
        ((0.3, 0.3, 0.3), "0.95 1 0.1 m, rotation: {about: 1 2 1, angle: 20 deg}"),
    ],
    ids=["plate", "cube"],
)
def test_a_block_bounces_elastically_on_a_torus_and_stays_outside(tmp_path, size, place):
    block = f"{{box: {{size: {' '.join(map(str, size))} m, position: {place}}}}}"
    objects = {"ring": "{torus: {radius: 1 m, tube: 0.4 m}}", "block": block}
    model = "of: block, mass: 1 kg, spin: 0.1 0.2 0.05 rad/s"
    outputs = ("it.energy", "it.position", "it.rotation", "touch.hits.count")
    rows = watch(tmp_path, objects, model, np.linspace(0, 1.5, 61)[1:], *outputs, law=BETWEEN)
    assert rows[-1][3] > 1
    assert np.ptp([row[0] for row in rows]) < 1e-9
    grid = np.linspace(-0.5, 0.5, 31)
    inside = np.stack(np.meshgrid(grid, grid, grid), axis=-1).reshape(-1, 3)
    surface = inside[np.abs(inside).max(axis=1) == 0.5] * size
    for _, x, q, _ in rows:
        p = x + Rotation.from_quat(q, scalar_first=True).apply(surface)
        assert (np.hypot(np.hypot(p[:, 0], p[:, 2]) - 1, p[:, 1]) - 0.4).min() > -1e-9


def test_a_coin_at_any_speed_does_not_pass_a_thin_wall(tmp_path):
    objects = {
        "coin": "{cylinder: {radius: 1 cm, height: 2 mm, position: 0 0 0 m, rotation: {about: z, angle: 40 deg}}}",
        "wall": "{box: {size: 1e-3 1 1 m, position: 1 0 0 m}}",
    }
    model = "of: coin, mass: 5 g, velocity: 500 0 0 m/s, spin: 10 20 30 rad/s"
    ((x, hits),) = watch(
        tmp_path, objects, model, [0.1], "it.position", "touch.hits.count", law="mode: exact", forces="[]"
    )
    assert hits > 0
    assert x[0] < 1


ROLLING = "mode: local, restitution: 0, friction: 1, rolling: {} m"


@pytest.mark.parametrize(("radius", "speed", "length"), [(0.1, 1, 0.002), (0.3, 2, 0.03)])
def test_a_ball_rolls_to_rest_by_its_moment(tmp_path, radius, speed, length):
    """v falls at 5/7 g f, f = rolling / radius; places are of order 1 in the step."""
    objects = {"ball": f"{{sphere: {{radius: {radius} m, position: 0 {radius} 0 m}}}}", "floor": "plane"}
    fall = 5 / 7 * 9.81 * length / radius
    stop = speed / fall
    model = f"of: ball, mass: 2 kg, velocity: {speed} 0 0 m/s, spin: 0 0 {-speed / radius} rad/s"
    errors = []
    for step in (4, 2):
        rows = watch(
            tmp_path, objects, model, [stop / 2, 1.1 * stop], "it.velocity", "it.position", "it.spin",
            law=ROLLING.format(length), solver=f"dopri5: {{largest_step: {step} ms}}",
        )  # fmt: skip
        assert rows[0][0][0] == pytest.approx(speed / 2, abs=1e-9)
        assert np.abs(rows[1][0]).max() < 1e-9
        assert np.abs(rows[1][2]).max() < 1e-9
        errors.append(abs(rows[1][1][0] - speed**2 / (2 * fall)))
    assert errors[1] < 0.55 * errors[0] < 0.55 * speed * 4e-3


def test_a_ball_that_spins_upright_slows_and_rests(tmp_path):
    objects = {"ball": "{sphere: {radius: 0.1 m, position: 0 0.1 0 m}}", "floor": "plane"}
    model = "of: ball, mass: 2 kg, spin: 0 5 0 rad/s"
    rate = 9.81 * 0.01 / (0.4 * 0.1**2)
    stop = 5 / rate
    rows = watch(tmp_path, objects, model, [0.04 * round(stop / 0.08), 2 * stop], "it.spin", law=ROLLING.format(0.01))
    assert rows[1][0] == pytest.approx([0, 0, 0], abs=1e-9)
    assert rows[0][0][1] == pytest.approx(5 - rate * 0.04 * round(stop / 0.08), abs=1e-6)


@pytest.mark.parametrize(("part", "stays"), [(0.99, True), (1.01, False)])
def test_a_ball_on_a_slope_stays_up_to_rolling_over_radius(tmp_path, part, stays):
    slope = part * 0.05
    across = np.array([-slope, 1]) / np.hypot(slope, 1)
    place = f"position: {float(0.1 * across[0])} {float(0.1 * across[1])} 0 m"
    objects = {"ball": f"{{sphere: {{radius: 0.1 m, {place}}}}}", "floor": f"{{plane: {{normal: {-slope} 1 0}}}}"}
    ((v,),) = watch(tmp_path, objects, "of: ball, mass: 2 kg", [1], "it.velocity", law=ROLLING.format(0.005))
    pull = 5 / 7 * 9.81 * (slope - 0.05) / np.hypot(slope, 1)
    assert np.linalg.norm(v) == pytest.approx(0 if stays else pull, abs=1e-9)
