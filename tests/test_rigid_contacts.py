"""Rigid bodies in contact, mode `local`: what rests, slides, rolls, leans over and is thrown, against exact values."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import cube_pile
import rigid_scenes
import runs
from runs import complaint
from sceneql.cli import cli
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run
from sceneql.run.watch import Watch

SOLVER = "semi_implicit_euler: {step: 5 ms}"


def watch(*where, law="restitution: 0, friction: 0.5", solver=SOLVER, **how):
    """Outputs of the model `it` of these bodies over a floor, unless the objects have one."""
    return rigid_scenes.watch(*where, law=law, solver=solver, **how)


def stack(masses, gap=0.0):
    """Objects and bodies of unit cubes on one another."""
    objects = {f"o{k}": f"{{box: {{position: 0 {k + 0.5 + gap * (k + 1)} 0 m}}}}" for k in range(len(masses))}
    bodies = {f"b{k}": f"{{of: o{k}, mass: {mass} kg}}" for k, mass in enumerate(masses)}
    return {**objects, "floor": "plane"}, bodies


@pytest.mark.parametrize("solver", [SOLVER, "auto", "radau: {tolerance: 1e-6}", "verlet: {step: 5 ms}"])
@pytest.mark.parametrize(
    "masses", [[1] * 10, [1, 1000], [1, 10_000], [1] * 5 + [1000]], ids=["ten", "1:1000", "1:10000", "five under 1000"]
)
def test_what_stands_on_one_another_stays_to_rounding(tmp_path, masses, solver):
    objects, bodies = stack(masses)
    ((places, kinetic),) = watch(tmp_path, objects, bodies, [2], "it.positions", "it.kinetic", solver=solver)
    exact = np.array([[0, k + 0.5, 0] for k in range(len(masses))])
    assert np.abs(places - exact).max() < 1e-9
    assert kinetic < 1e-9


def test_cubes_that_fall_come_to_rest_on_one_another(tmp_path):
    objects, bodies = stack([1, 5, 2], gap=0.03)
    ((places, kinetic, energy),) = watch(tmp_path, objects, bodies, [1.5], "it.positions", "it.kinetic", "it.energy")
    np.testing.assert_allclose(places, [[0, k + 0.5, 0] for k in range(3)], atol=1e-12)
    assert kinetic < 1e-20
    start = 9.81 * (0.53 + 5 * 1.56 + 2 * 2.59)
    assert energy <= start + 1e-9


@pytest.mark.parametrize("friction", [0.4, 0.49, 0.51, 0.6])
def test_a_block_on_an_incline_slides_or_sticks(tmp_path, friction):
    normal = np.array([-0.5, 1, 0]) / np.hypot(0.5, 1)
    place = 0.25 * normal
    turn = f"rotation: {{about: z, angle: {np.degrees(np.arctan(0.5))} deg}}"
    objects = {
        "block": f"{{box: {{size: 1 0.5 1 m, position: [{place[0]} m, {place[1]} m, 0 m], {turn}}}}}",
        "ramp": "{plane: {normal: [-0.5, 1, 0]}}",
    }
    found = {}
    for step in (5, 2.5):
        law, solver = f"restitution: 0, friction: {friction}", f"semi_implicit_euler: {{step: {step} ms}}"
        rows = watch(
            tmp_path, objects, {"b": "{of: block, mass: 1 kg}"}, [1, 2], "it.b.position", law=law, solver=solver
        )
        for (x,) in rows:
            assert abs((x - place) @ normal) < 1e-9
        found[step] = np.linalg.norm(rows[-1][0] - place)
    exact = max(0.0, 9.81 * 4 * (0.5 - friction) / np.sqrt(5))
    if exact:  # the place is of order 1 in the step
        assert abs(found[5] - exact) / abs(found[2.5] - exact) == pytest.approx(2, abs=0.1)
        assert 2 * found[2.5] - found[5] == pytest.approx(exact, abs=1e-6)
    else:
        assert max(found.values()) < 1e-9


@pytest.mark.parametrize(("part", "stands"), [(0.999, True), (1.001, False)])
def test_blocks_stand_up_to_the_harmonic_overhang(tmp_path, part, stands):
    places = [0.0]
    for k in range(1, 4):
        places.insert(0, places[0] - part * 0.5 / k)
    edge = places[0] - part * 0.5 / 4 + 0.5
    objects = {
        f"o{k}": f"{{box: {{size: 1 0.25 0.5 m, position: {x} {0.25 * k + 0.125} 0 m}}}}" for k, x in enumerate(places)
    }
    objects["table"] = f"{{box: {{size: 2 1 2 m, position: {edge - 1} -0.5 0 m}}}}"
    bodies = {f"b{k}": f"{{of: o{k}, mass: 1 kg}}" for k in range(4)}
    law = "restitution: 0, friction: 0.6"
    ((found,),) = watch(tmp_path, objects, bodies, [4], "it.positions", law=law)
    moved = np.abs(found - [[x, 0.25 * k + 0.125, 0] for k, x in enumerate(places)]).max()
    assert (moved < 1e-9) == stands
    assert stands or moved > 0.1


@pytest.mark.parametrize(
    ("mode", "thick", "stands"),
    [("local", 0.107, True), ("local", 0.103, False), ("exact", 0.1047, True), ("exact", 0.1042, False)],
)
def test_an_arch_of_eleven_stones_stands_by_its_thickness_alone(tmp_path, mode, thick, stands):
    """The limit is 0.10491 of the mean radius, by the line of thrust (linear program; Milankovitch 1907).

    Of these stones, whose inner and outer faces are flat, it is 0.10459, by the same program.
    """
    half = np.pi / 22
    ring = [(r * np.cos(a), r * np.sin(a), z) for z in (-0.2, 0.2) for r in (1 - thick / 2, 1 + thick / 2)
            for a in (-half, half)]  # fmt: skip
    sides = ["1 2 4 3", "5 7 8 6", "1 3 7 5", "2 6 8 4", "1 5 6 2", "3 4 8 7"]
    lines = ["v " + " ".join(f"{x:.17g}" for x in corner) for corner in ring] + [f"f {side}" for side in sides]
    (tmp_path / "stone.obj").write_text("\n".join(lines))
    objects = {
        f"o{k}": f"{{mesh: {{file: stone.obj, rotation: {{about: z, angle: {(k + 0.5) * 180 / 11} deg}}}}}}"
        for k in range(11)
    }
    objects["floor"] = "plane"
    bodies = {f"s{k}": f"{{of: o{k}, density: 2400 kg/m^3}}" for k in range(11)}
    solver = "semi_implicit_euler: {step: 5 ms}" if mode == "local" else "dop853: {tolerance: 1e-9}"
    law, times = f"mode: {mode}, restitution: 0, friction: 0.8", [0, 0.8 if mode == "local" else 0.5]
    (start,), (end,) = watch(tmp_path, objects, bodies, times, "it.s5.position", law=law, solver=solver)
    assert start[1] - end[1] < 1e-9 if stands else start[1] - end[1] > 0.01


@pytest.mark.parametrize("spin", ["0 0 0", "100 30 0"])
def test_a_small_box_of_500_m_a_second_stops_at_a_thin_wall(tmp_path, spin):
    objects = {"o": "{box: {size: 0.01 0.01 0.01 m, position: -1 0 0 m}}", "wall": "{box: {size: 0.001 2 2 m}}"}
    bodies = {"b": f"{{of: o, mass: 1 kg, velocity: 500 0 0 m/s, spin: {spin} rad/s}}"}
    for step in (0.5, 5, 20):
        solver = f"semi_implicit_euler: {{step: {step} ms}}"
        ((x,),) = watch(tmp_path, objects, bodies, [0.06], "it.b.position", solver=solver)
        assert -0.015 < x[0] < -0.0054


def test_a_ball_slides_and_then_rolls(tmp_path):
    objects = {"o": "{sphere: {radius: 0.5 m, position: 0 0.5 0 m}}", "floor": "plane"}
    bodies = {"b": "{of: o, velocity: 3 0 0 m/s}"}
    law = "restitution: 0, friction: 0.2"
    start = 2 * 3 / (7 * 0.2 * 9.81)
    exact = 12 * 9 / (49 * 0.2 * 9.81) + 5 / 7 * 3 * (2 - start)
    errors = []
    for step in (4, 2):
        solver = f"semi_implicit_euler: {{step: {step} ms}}"
        rows = watch(
            tmp_path, objects, bodies, [2], "it.b.velocity", "it.b.spin", "it.b.position", law=law, solver=solver
        )
        velocity, spin, place = rows[0]
        np.testing.assert_allclose(velocity, [5 / 7 * 3, 0, 0], atol=1e-12)
        np.testing.assert_allclose(spin, [0, 0, -5 / 7 * 6], atol=1e-11)
        errors.append(abs(place[0] - exact))
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.2)


def test_a_ball_bounces_by_its_restitution(tmp_path):
    objects = {"o": "{sphere: {radius: 0.1 m, position: 0 1.1 0 m}}", "floor": "plane"}
    heights = [
        row[0][1] - 0.1
        for row in watch(
            tmp_path,
            objects,
            {"b": "{of: o}"},
            np.arange(0, 1.6, 0.002),
            "it.b.position",
            law="restitution: 0.8",
            solver="semi_implicit_euler: {step: 0.5 ms}",
        )
    ]
    highest = max(heights[300:600])
    assert highest == pytest.approx(0.64, abs=0.01)


def test_bodies_hand_momentum_on_and_rest_tells_its_forces(tmp_path):
    objects, bodies = stack([2, 3])
    outputs = ("touch.points", "touch.forces", "touch.normals")
    ((points, forces, normals),) = watch(tmp_path, objects, bodies, [0.5], *outputs)
    assert len(points) == 8
    low = points[:, 1] < 0.5
    assert forces[low].sum(axis=0)[1] == pytest.approx(5 * 9.81, rel=1e-9)
    assert abs(forces[~low].sum(axis=0)[1]) == pytest.approx(3 * 9.81, rel=1e-9)
    np.testing.assert_allclose(np.abs(normals[:, 1]), 1, atol=1e-12)


def test_what_is_not_covered_is_told_at_its_place(tmp_path):
    head = "models: {a: {rigid: {of: o}}}\nforces: [gravity]\noutputs: {t: {record: {of: [a.energy]}}}\n"
    endless = "objects: {o: {box: {position: 0 3 0 m}}, floor: {union: {of: [plane, sphere]}}}\ncontacts: [collision]\n"
    hollow = "{difference: {of: [sphere, {sphere: {radius: 0.4 m}}], position: 0 3 0 m}}"
    exact = f"objects: {{o: {hollow}, floor: plane}}\ncontacts: {{c: {{collision: {{mode: exact}}}}}}\n"
    for script, words in ((endless, "does not collide with rigid bodies"), (exact, "mode `local`")):
        path = tmp_path / "scene.yaml"
        path.write_text(head + script)
        assert not complaint(tmp_path, head + script)
        with pytest.raises(Exception, match=words):
            runs.watch(tmp_path, head + script, [0], "a.energy")


@pytest.mark.parametrize("solver", ["semi_implicit_euler: {step: 8 ms}", "verlet: {step: 8 ms}"])
def test_what_rests_is_read_where_it_is_held_between_steps_too(tmp_path, solver):
    objects, bodies = stack([1])
    times = [0.2, 0.202, 0.204, 0.2075]
    seen = watch(tmp_path, objects, bodies, times, "it.positions", "it.velocities", "it.energy", solver=solver)
    for places, velocities, energy in seen:
        np.testing.assert_allclose(places, [[0, 0.5, 0]], rtol=0, atol=1e-14)
        np.testing.assert_allclose(velocities, 0, atol=1e-14)
        assert energy == pytest.approx(0.5 * 9.81, rel=1e-14)


def test_more_contacts_than_outputs_have_room_for_all_act_and_are_told(tmp_path):
    tiles = "".join(
        f"  t{i}_{j}: {{box: {{size: 0.1 0.1 0.1 m, position: {0.1 * i - 0.45:.2f} -0.05 {0.1 * j - 0.45:.2f} m}}}}\n"
        for i in range(10)
        for j in range(10)
    )
    path = tmp_path / "scene.yaml"
    path.write_text(f"""
clock: {{end: 0.1 s}}
objects:
  cube: {{box: {{position: 0 0.5 0 m}}}}
{tiles}
models: {{it: {{rigid: {{of: cube}}}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{restitution: 0}}}}}}
solvers: {{main: {{{SOLVER}}}}}
outputs: {{table: {{record: {{of: [it.energy]}}}}}}
""")
    done = CliRunner().invoke(cli, ["render", str(path), "-o", str(tmp_path / "out")])
    assert "more contacts than outputs have room for: all acted" in done.output
    last = (tmp_path / "out.csv").read_text().split()[-1].split(",")
    assert float(last[-1]) == pytest.approx(1000 * 9.81 * 0.5, rel=1e-14)


def test_cubes_thrown_into_a_bin_are_never_in_each_other(tmp_path):
    times = np.arange(1, 161) * 5e-3
    turns = [f"pile.c.{k}.rotation" for k in range(8)]
    rows = runs.watch(tmp_path, cube_pile.script(2, 5, 0.8), times, "pile.positions", *turns, pruned=False)
    assert max(cube_pile.deepest(2, row[0], np.array(row[1:])) for row in rows) < 1e-6 * cube_pile.SIDE


def test_threads_do_not_change_a_bit_of_a_pile(tmp_path, monkeypatch):
    seen = []
    for threads in ("1", "2"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        outputs = ("pile.positions", "pile.velocities", "touch.forces")
        rows = runs.watch(tmp_path, cube_pile.script(3, 5, 0.4), [0.2, 0.4], *outputs, pruned=False)
        seen.append([value.tobytes() for row in rows for value in row])
    assert len(seen[0][-1]) > 0
    assert seen[0] == seen[1]


def test_groups_that_do_not_touch_move_as_if_each_were_alone(tmp_path):
    """A tower and, far off, a cube that slides: together as apart, to the last bit."""
    objects, bodies = stack([1, 4, 2], gap=0.01)
    slider = {"s": "{box: {position: 40 0.5 0 m}}"}
    moved = {"t": "{of: s, mass: 3 kg, velocity: 2 0 0.5 m/s}"}
    ((tower,),) = watch(tmp_path, objects, bodies, [0.7], "it.positions")
    ((alone,),) = watch(tmp_path, {**slider, "floor": "plane"}, moved, [0.7], "it.positions")
    ((both,),) = watch(tmp_path, {**objects, **slider}, {**bodies, **moved}, [0.7], "it.positions")
    assert both.tobytes() == np.concatenate([tower, alone]).tobytes()


def test_more_bodies_than_pairs_could_be_planned_for_rest_on_a_floor(tmp_path):
    script = """
clock: {end: 0.2 s}
objects:
  stone:
    repeat: {count: 300, as: i}
    box: {size: 0.1 0.1 0.1 m, position: ["0.1 m*mod(i, 20)", 0.05 m, "0.12 m*floor(i/20)"]}
  floor: plane
models: {it: {rigid: {bodies: {b: {repeat: {count: 300, as: i}, of: "stone.{i}"}}}}}
forces: [gravity]
contacts: {touch: {collision: {restitution: 0, friction: 0.4}}}
solvers: {main: {semi_implicit_euler: {step: 5 ms}}}
"""
    ((start,), (end,)) = runs.watch(tmp_path, script, [0, 0.2], "it.positions", pruned=False)
    assert len(start) == 300
    assert np.abs(end - start).max() < 1e-12


def test_a_body_may_be_named_by_its_object_too(tmp_path):
    objects, bodies = stack([1])
    ((places,),) = watch(
        tmp_path, objects, bodies, [0.1], "it.positions", law="restitution: 0, between: [it, o0, floor]"
    )
    np.testing.assert_allclose(places, [[0, 0.5, 0]], atol=1e-12)


def test_what_is_read_within_the_step_of_an_impact_has_the_energy_of_its_end(tmp_path):
    """A body moves over the whole of that step by its velocity afterwards: between the two it had next to no energy."""
    objects = {"o": "{box: {size: 0.2 0.2 0.2 m, position: 0 0.3 0 m}}", "floor": "plane"}
    bodies = {"b": "{of: o, mass: 1 kg, velocity: 0.3 -2 0 m/s, spin: 1 2 3 rad/s}"}
    law, times = "restitution: 0.8, friction: 0.3", np.linspace(0, 0.3, 301)
    rows = watch(tmp_path, objects, bodies, times, "it.energy", law=law, solver="rk4: {step: 5 ms}")
    energy = np.array(rows)[:, 0]
    assert np.abs(energy - energy[0]).max() < 0.05 * energy[0]


@pytest.mark.parametrize("ground", ["plane", "{box: {size: 4 0.2 4 m, position: 0 -0.1 0 m}}"])
@pytest.mark.parametrize("turned", [0, 20])
@pytest.mark.parametrize("step", [5, 2])
def test_no_elastic_bounce_makes_energy(tmp_path, ground, turned, step):
    """Each takes m (g h)^2 / 2 in a step h; 5 ms once made 2 % of all, told as less than none dissipated."""
    script = f"""
clock: {{end: 1 s}}
objects:
  ground: {ground}
  cube: {{box: {{size: 0.2 0.2 0.2 m, position: 0.5 0.6 0 m, rotation: {{about: 1 1 0.3, angle: {turned} deg}}}}}}
models: {{it: {{rigid: {{of: cube, mass: 1 kg}}}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{between: [it, ground], restitution: 1, friction: 0, mode: local}}}}}}
solvers: {{main: {{rk4: {{step: {step} ms}}}}}}
"""
    rows = runs.watch(tmp_path, script, np.linspace(0, 1, 51), "it.energy", "it.dissipated", pruned=False)
    energy, dissipated = np.array(rows).T
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)
    taken = np.diff(dissipated)
    assert taken.min() > -1e-12
    assert 0 < taken.max() < 2.01 * 0.5 * (9.81e-3 * step) ** 2  # (Two may come between frames.)


@pytest.mark.parametrize("mode", ["exact", "local"])
def test_a_ball_laid_a_little_too_deep_on_a_ramp_is_told_how_far_to_move(tmp_path, mode):
    script = f"""
clock: {{end: 0.1 s}}
objects:
  ramp: {{box: {{size: 6 0.2 2 m, rotation: {{about: z, angle: -20 deg}}}}}}
  ball: {{sphere: {{radius: 0.2 m, position: -2 1.04 0 m}}}}
models: {{roller: {{rigid: {{of: ball, density: 800 kg/m^3}}}}}}
contacts: {{roll: {{collision: {{between: [roller, ramp], mode: {mode}}}}}}}
"""
    with pytest.raises(ScriptError) as told:
        runs.watch(tmp_path, script, [0.0], pruned=False)
    assert told.value.diagnostics[0].help == "move 'ball' by 0.00232 0.00636 0 m"
    moved = script.replace("-2 1.04 0 m", "-1.99768 1.04636 0 m")
    runs.watch(tmp_path, moved, [0.0], pruned=False)


def test_energy_that_contacts_make_in_long_steps_is_told(tmp_path):
    (tmp_path / "scene.yaml").write_text("""
clock: {end: 6 s}
objects: {floor: plane, b: {box: {size: 0.2 1 0.3 m, position: 0 2 0 m}}}
models: {m: {rigid: {of: b, density: 500 kg/m^3, velocity: 1 0 0 m/s, spin: 0 0 30 rad/s}}}
forces: [gravity]
contacts: {c: {collision: {restitution: 0.9, friction: 0, mode: local}}}
solvers: {main: {rk4: {step: 50 ms}}}
""")
    run = Run(load(tmp_path / "scene.yaml", pruned=False))
    watch = Watch(run, always=True)
    for time in np.arange(121) / 20:
        watch.look(run.at(time))
    assert 0.05 < max(watch.balances[0].drifts) < 0.5
    (told,) = watch.warnings()
    assert (told.code, told.help) == (
        "energy-gained",
        "contacts made it: take shorter steps, or `mode: exact` where it can be",
    )


def test_a_body_that_is_led_down_to_the_floor_is_not_inside(tmp_path):
    """One that is led on into it is told: errors/bodies-cross."""
    script = (Path(__file__).parent / "errors" / "bodies-cross.yaml").read_text().replace("end: 0.6 s", "end: 0.48 s")
    (tmp_path / "scene.yaml").write_text(script)
    run = Run(load(tmp_path / "scene.yaml", pruned=False))
    watch = Watch(run, always=True)
    for time in (0.0, 0.48):
        watch.look(run.at(time))
    assert watch.warnings() == ()
