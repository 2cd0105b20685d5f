"""Rigid bodies in contact, mode `exact`: impacts, rest, slip and rolling, against exact values."""

import numpy as np
import pytest

import rigid_scenes
import runs
from sceneql.pipeline import load
from sceneql.report.explain import explain, text

SOLVER = "dop853: {tolerance: 1e-12}"


def watch(*where, law="restitution: 0", **how):
    """Outputs of the model `it` of these bodies among these objects."""
    return rigid_scenes.watch(*where, law=f"mode: exact, {law}", **how)


def row(folder, speeds, masses=(1, 1, 1, 1, 1), restitution=1, more="", times=(1,)):
    """Speeds of five balls that touch; those that move come from the left."""
    objects, bodies = {}, {}
    for k, (speed, mass) in enumerate(zip(speeds, masses, strict=True)):
        x = 0.2 * k - (0.3 if speed else 0.0)
        objects[f"s{k}"] = f"{{sphere: {{radius: 0.1 m, position: {x} 0 0 m}}}}"
        bodies[f"s{k}"] = f"{{of: s{k}, mass: {mass} kg, velocity: {speed} 0 0 m/s}}"
    law = f"restitution: {restitution}"
    ((found,),) = watch(folder, objects, bodies, times, "it.velocities", law=law, forces="[]", more=more)
    assert np.abs(found[:, 1:]).max() < 1e-12
    return found[:, 0]


@pytest.mark.parametrize(
    ("speeds", "masses", "after"),
    [
        ((1, 0, 0, 0, 0), (1, 1, 1, 1, 1), (0, 0, 0, 0, 1)),
        ((1, 1, 0, 0, 0), (1, 1, 1, 1, 1), (0, 0, 0, 1, 1)),
        ((1, 0, 0, 0, 0), (0.5, 1, 1, 1, 1), (-1 / 3, 0, 0, 0, 2 / 3)),
        ((2, 0, 0, 0, 0), (3, 1, 1, 1, 1), None),
    ],
)
def test_balls_of_a_cradle_are_left_as_generalized_reflections_say(tmp_path, speeds, masses, after):
    found = row(tmp_path, speeds, masses)
    if after is not None:
        np.testing.assert_allclose(found, after, atol=1e-12)
    momentum, energy = np.dot(masses, speeds), np.dot(masses, np.square(speeds))
    np.testing.assert_allclose([np.dot(masses, found), np.dot(masses, found**2)], [momentum, energy], rtol=1e-13)
    assert np.all(np.diff(found) >= -1e-13)


def test_balls_without_restitution_go_on_together(tmp_path):
    np.testing.assert_allclose(row(tmp_path, (1, 0, 0, 0, 0), restitution=0), np.full(5, 0.2), atol=1e-14)


def test_a_ball_that_strikes_two_at_once_goes_back_as_bernoulli_found(tmp_path):
    spots = {"a": "-0.6 0 0", "b": "0 0.1 0", "c": "0 -0.1 0"}
    objects = {name: f"{{sphere: {{radius: 0.1 m, position: {at} m}}}}" for name, at in spots.items()}
    bodies = {name: f"{{of: {name}, mass: 1 kg}}" for name in "bc"}
    bodies["a"] = "{of: a, mass: 1 kg, velocity: 1 0 0 m/s}"
    law = "between: [it], restitution: 1"
    ((found,),) = watch(tmp_path, objects, bodies, [1], "it.velocities", law=law, forces="[]")
    across = np.sqrt(3) / 5
    np.testing.assert_allclose(found, [[0.6, across, 0], [0.6, -across, 0], [-0.2, 0, 0]], atol=1e-12)


def test_a_rod_that_falls_on_its_end_bounces_and_spins_off_a_smooth_floor(tmp_path):
    objects = {
        "rod": "{box: {size: 1 1e-11 1e-11 m, position: 0 0.35 0 m, rotation: {about: z, angle: 30 deg}}}",
        "floor": "plane",
    }
    bodies = {"rod": f"{{of: rod, mass: 1 kg, inertia: 0.01 {1 / 12!r} {1 / 12!r} kg*m^2, velocity: 0 -2 0 m/s}}"}
    law = "restitution: 0.8"
    ((v, spin),) = watch(tmp_path, objects, bodies, [0.1], "it.velocities", "it.rod.spin", law=law, forces="[]")
    impulse = 1.8 * 2 / (1 + 3 * np.cos(np.pi / 6) ** 2)
    assert v[0, 1] + 2 == pytest.approx(impulse, abs=1e-10)
    assert abs(spin[2]) == pytest.approx(impulse * 6 * np.cos(np.pi / 6), abs=1e-10)


def test_a_ball_bounces_to_rest_and_the_time_of_infinitely_many_bounces_is_told(tmp_path):
    objects = {"s": "{sphere: {radius: 0.1 m, position: 0 1.1 0 m}}", "floor": "plane"}
    fall = np.sqrt(2 / 9.81)
    times = [1.8 * fall, (1 + 1.6 + 0.64) * fall, 5]
    outputs = ("it.positions", "it.energy", "touch.rest.time")
    rows = watch(tmp_path, objects, {"s": "{of: s, mass: 1 kg}"}, times, *outputs, law="restitution: 0.8")
    np.testing.assert_allclose([x[0, 1] - 0.1 for x, _, _ in rows], [0.64, 0.4096, 0], atol=1e-12)
    np.testing.assert_allclose([energy for _, energy, _ in rows], 9.81 * 1.1, atol=1e-11)
    assert rows[-1][2] == pytest.approx(9 * fall, abs=2e-6)


@pytest.mark.parametrize("mu", [0.4, 0.49, 0.5, 0.51, 0.6])
def test_a_block_on_an_incline_slides_by_coulombs_law_or_stays(tmp_path, mu):
    angle = np.arctan(0.5)
    c, s = np.cos(angle), np.sin(angle)
    objects = {
        "box": f"{{box: {{size: 0.2 0.2 0.2 m, position: {-0.1 * s} {0.1 * c} 0 m, "
        f"rotation: {{about: z, angle: {float(angle)!r} rad}}}}}}",
        "floor": f"{{plane: {{normal: {-s} {c} 0}}}}",
    }
    law = f"restitution: 0, friction: {mu}"
    ((places,),) = watch(tmp_path, objects, {"box": "{of: box, mass: 3 kg}"}, [2], "it.positions", law=law)
    way = places[0] - [-0.1 * s, 0.1 * c, 0]
    exact = 9.81 * 4 * max(0.0, 0.5 - mu) / np.sqrt(5)
    np.testing.assert_allclose(way, [-exact * c, -exact * s, 0], atol=1e-9 if mu >= 0.5 else 1e-8)


@pytest.mark.parametrize("solver", ["rk4", "heun", "midpoint", "verlet"])
def test_a_ball_that_slides_in_fixed_steps_rolls_on_and_a_box_comes_to_rest(tmp_path, solver):
    """The slip ends within a step, whose stages beyond had friction the other way round: the step went back to where
    it began, and friction made energy for ever."""
    motion, law = "velocity: 1.0003 0 0.4 m/s", "restitution: 0, friction: 0.3"
    start, last = np.hypot(1.0003, 0.4), []
    for shape in ("sphere: {radius: 0.1 m, position: 0 0.1 0 m}", "box: {size: 0.2 0.1 0.2 m, position: 0 0.05 0 m}"):
        rows = watch(
            tmp_path, {"b": f"{{{shape}}}", "floor": "plane"}, {"b": f"{{of: b, mass: 1 kg, {motion}}}"}, [0, 0.7, 1.5],
            "it.energy", "it.b.velocity", law=law, solver=f"{solver}: {{step: 1 ms}}",
        )  # fmt: skip
        energy = np.array([e for e, _ in rows])
        np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
        last.append([np.linalg.norm(v) for _, v in rows[1:]])
    np.testing.assert_allclose(last[0], 5 / 7 * start, rtol=1e-9)
    np.testing.assert_allclose(last[1], 0, atol=1e-12)


@pytest.mark.parametrize("solver", ["rk4", "heun"])
def test_a_ball_comes_to_rest_by_rolling_in_fixed_steps(tmp_path, solver):
    rows = watch(
        tmp_path, {"b": "{sphere: {radius: 0.1 m, position: 0 0.1 0 m}}", "floor": "plane"},
        {"b": "{of: b, mass: 1 kg, velocity: 0.3003 0 0.04 m/s, spin: 0 1.3 0 rad/s}"}, [0, 1.2, 1.5], "it.energy",
        "it.b.velocity", law="restitution: 0, friction: 0.3, rolling: 5 mm", solver=f"{solver}: {{step: 1 ms}}",
    )  # fmt: skip
    np.testing.assert_allclose([e for e, _ in rows], rows[0][0], rtol=1e-8)
    np.testing.assert_allclose([v for _, v in rows[1:]], 0, atol=1e-12)


def test_a_ball_slides_then_rolls(tmp_path):
    objects = {"s": "{sphere: {radius: 0.1 m, position: 0 0.1 0 m}}", "floor": "plane"}
    bodies = {"s": "{of: s, mass: 1 kg, velocity: 3 0 0 m/s}"}
    t, x = 6 / (7 * 0.2 * 9.81), 108 / (49 * 0.2 * 9.81)
    law = "restitution: 0, friction: 0.2"
    rows = watch(tmp_path, objects, bodies, [t, 1], "it.positions", "it.velocities", "it.energy", law=law)
    for (places, speeds, energy), when in zip(rows, [t, 1], strict=True):
        assert speeds[0, 0] == pytest.approx(15 / 7, abs=1e-8)
        assert places[0, 0] == pytest.approx(x + (when - t) * 15 / 7, abs=1e-8)
        assert energy == pytest.approx(4.5 + 0.981, abs=1e-9)


def test_a_ball_on_a_turntable_rolls_in_a_circle(tmp_path):
    objects = {
        "table": "{box: {size: 6 0.2 6 m, position: 0 -0.1 0 m}}",
        "ball": "{sphere: {radius: 0.1 m, position: 1 0.1 0 m}}",
    }
    bodies = {
        "table": "{of: table, mass: 1e10 kg, spin: 0 3 0 rad/s}",
        "ball": "{of: ball, mass: 1 kg, velocity: 0 0 -0.3 m/s, spin: 27 0 0 rad/s}",
    }
    axle = "ties: {axle: {hinge: {between: [it.table, world], at: 0 0 0 m, axis: 0 1 0}}}"
    outputs = ("it.positions", "it.velocities")
    law = "between: [it], restitution: 0, friction: 1"
    ((places, speeds),) = watch(tmp_path, objects, bodies, [4], *outputs, law=law, more=axle)
    np.testing.assert_allclose(places[1], [0.3143138, 0.1, 0.09906955], atol=1e-7)
    np.testing.assert_allclose(speeds[1], [0.08491676, 0, 0.28773103], atol=1e-8)


@pytest.mark.parametrize(
    "masses", [[1] * 10, [1, 1000], [1, 10_000], [1] * 5 + [1000]], ids=["ten", "1:1000", "1:10000", "five under 1000"]
)
def test_what_stands_on_one_another_stays(tmp_path, masses):
    objects = {f"o{k}": f"{{box: {{position: 0 {k + 0.5} 0 m}}}}" for k in range(len(masses))}
    bodies = {f"b{k}": f"{{of: o{k}, mass: {mass} kg}}" for k, mass in enumerate(masses)}
    law = "restitution: 0, friction: 0.5"
    everything = {**objects, "floor": "plane"}
    ((places, forces),) = watch(tmp_path, everything, bodies, [5], "it.positions", "touch.forces", law=law)
    assert np.abs(places - [[0, k + 0.5, 0] for k in range(len(masses))]).max() < 1e-9
    weights = 9.81 * np.cumsum(masses[::-1])
    assert np.abs(forces[:, 1]).sum() == pytest.approx(weights.sum(), rel=1e-9)


@pytest.mark.parametrize(("part", "time"), [(0.999, 4), (1.001, 0.75)])
def test_blocks_that_lean_over_stand_up_to_the_edge_of_balance(tmp_path, part, time):
    ends = np.concatenate([[0.0], part * 0.5 * np.cumsum([1 / 3, 1 / 2, 1])])
    spots = [f"{x} {0.125 + 0.25 * k} 0 m" for k, x in enumerate(ends)]
    objects = {f"o{k}": f"{{box: {{size: 1 0.25 0.5 m, position: {spot}}}}}" for k, spot in enumerate(spots)}
    bodies = {f"b{k}": f"{{of: o{k}, mass: 1 kg}}" for k in range(4)}
    law = "restitution: 0, friction: 0.6"
    rows = watch(tmp_path, {**objects, "floor": "plane"}, bodies, [0, time], "it.positions", law=law)
    moved = np.abs(rows[1][0] - rows[0][0]).max()
    assert moved < 1e-9 if part < 1 else moved > 3e-3


@pytest.mark.parametrize("solver", [SOLVER, "rk4: {step: 5 ms}", "verlet: {step: 20 ms}"])
def test_a_fast_box_does_not_pass_a_thin_wall(tmp_path, solver):
    objects = {
        "box": "{box: {size: 0.01 0.01 0.01 m, position: -1.3 0.2 0.1 m, rotation: {about: z, angle: 20 deg}}}",
        "wall": "{box: {size: 0.001 4 4 m}}",
    }
    bodies = {"box": "{of: box, mass: 1 kg, velocity: 500 0 0 m/s}"}
    law = "restitution: 0.3, friction: 0.2"
    ((places, hits),) = watch(
        tmp_path, objects, bodies, [0.02], "it.positions", "touch.hits.count", law=law, solver=solver
    )
    assert places[0, 0] < 0
    assert hits >= 1


def test_balls_on_rods_swing_and_strike_as_a_cradle(tmp_path):
    objects, bodies, ties = {}, {}, []
    for k in range(5):
        objects[f"s{k}"] = f"{{sphere: {{radius: 0.1 m, position: {0.2 * k} 0 0 m}}}}"
        bodies[f"s{k}"] = f"{{of: s{k}, mass: 1 kg, velocity: {-1 if k == 0 else 0} 0 0 m/s}}"
        for side in (-1, 1):
            ties.append(f"  t{k}_{side + 1}: {{rod: {{between: [it.s{k}, world], to: {0.2 * k} 1 {0.5 * side} m}}}}")
    outputs = ("it.positions", "it.velocities", "it.energy", "touch.hits.count")
    more = "\n".join(["ties:", *ties])
    times = [0.1, 1.1, 1.2]
    rows = watch(tmp_path, objects, bodies, times, *outputs, law="restitution: 1", more=more)
    assert [hits for *_, hits in rows] == [0, 1, 1]
    for places, _, energy, _ in rows:
        assert energy == pytest.approx(0.5, abs=1e-10)
        lengths = np.linalg.norm(places - [[0.2 * k, 1, 0.5] for k in range(5)], axis=1)
        np.testing.assert_allclose(lengths, np.sqrt(1.25), atol=1e-12)
    moving = np.abs(rows[-1][1][:, 0]) > 1e-9
    assert moving.tolist() == [False, False, False, False, True]


def test_too_many_bodies_are_refused(tmp_path):
    objects = "\n".join(f"  o{k}: {{sphere: {{radius: 0.1 m, position: {k} 0 0 m}}}}" for k in range(25))
    bodies = "\n".join(f"        o{k}: {{of: o{k}, mass: 1 kg}}" for k in range(25))
    script = f"objects:\n{objects}\nmodels:\n  it:\n    rigid:\n      bodies:\n{bodies}\n"
    script += "contacts: {touch: {collision: {mode: exact}}}\n"
    with pytest.raises(Exception, match="25 rigid bodies are too many for contacts in mode `exact`: at most 24"):
        runs.watch(tmp_path, script, [0.1], "it.positions", pruned=False)


@pytest.mark.parametrize(
    ("mode", "why"), [("auto", "exact: chosen for up to 8 rigid bodies"), ("exact", "exact: asked for")]
)
def test_explain_tells_the_mode_of_rigid_bodies_and_why(tmp_path, mode, why):
    script = "objects: {s: {sphere: {position: 0 2 0 m}}, floor: plane}\nmodels: {a: {rigid: {of: s}}}\n"
    script += f"forces: [gravity]\ncontacts: {{touch: {{collision: {{mode: {mode}}}}}}}\n"
    script += "outputs: {t: {record: {of: [a.energy]}}}\n"
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    assert why in text(explain(load(path)))


THROWN = [
    # Balls of many masses on a box with walls: their steps leave gaps that tolerance allows.
    (0.1069, "-0.3 1.2 0.2", 0.69, "2.2 -0.3 -1.1"),
    (0.2310, "0.5 0.9 -0.4", 84.0, "-1.4 0.6 -1.9"),
    (0.1540, "0.1 1.9 0.6", 0.05, "0.3 1.2 2.4"),
]


@pytest.mark.parametrize("friction", [0.1, 1])
def test_balls_that_are_thrown_come_to_rest_and_keep_their_energy(tmp_path, friction):
    objects, bodies = {"floor": "{box: {size: 4 0.2 4 m, position: 0 -0.1 0 m}}"}, {}
    for k, (x, z) in enumerate([(-1.2, 0), (1.2, 0), (0, -1.2), (0, 1.2)]):
        objects[f"wall{k}"] = f"{{box: {{size: {'0.1 6 2.6' if x else '2.6 6 0.1'} m, position: {x} 3 {z} m}}}}"
    for k, (size, spot, mass, velocity) in enumerate(THROWN):
        objects[f"o{k}"] = f"{{sphere: {{radius: {size} m, position: {spot} m}}}}"
        spin = f"spin: {3 - k} 2 {k} rad/s"
        bodies[f"o{k}"] = f"{{of: o{k}, mass: {mass} kg, velocity: {velocity} m/s, {spin}}}"
    law = f"restitution: 0.5, friction: {friction}"
    rows = watch(tmp_path, objects, bodies, [0, 5], "it.energy", "it.positions", law=law, solver="auto")
    assert rows[1][0] == pytest.approx(rows[0][0], rel=1e-5)
    assert np.abs(rows[1][1][:, [0, 2]]).max() < 1.2
    assert rows[1][1][:, 1].min() > 0.04
