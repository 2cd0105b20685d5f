"""Ties between bodies: exact motions, gaps that stay closed, redundant and singular ties, bodies led by objects."""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.spatial.transform import Rotation

import runs
from sceneql.compiler import check
from sceneql.language.tree import whole
from sceneql.pipeline import load
from sceneql.report.explain import explain, text
from sceneql.run.run import Run

watch = partial(runs.watch, pruned=False)
ROD = "inertia: 1e-4 0.083333333333333333 0.083333333333333333 kg*m^2"
RODS = f"""
clock: {{end: 2 s}}
models:
  rods:
    rigid:
      mass: 1 kg
      bodies:
        a: {{{ROD}, position: 0.5 0 0 m, points: {{end: 0.5 0 0 m, start: -0.5 0 0 m}}}}
        b: {{{ROD}, position: 1.5 0 0 m, points: {{start: -0.5 0 0 m}}}}
forces: [gravity]
ties:
  one: {{hinge: {{between: [rods.a, world], at: 0 0 0 m}}}}
  two: {{hinge: {{between: [rods.b, rods.a], at: 1 0 0 m}}}}
solvers: {{main: {{SOLVER}}}}
"""
ANGLES = [-0.082758306821, 0.407362074912, -0.961145444546, 11.898955053045]
"""Angles from the vertical and their rates at 2 s: the equations of two rods in their angles, integrated apart."""


def swung(folder, solver, *more):
    outputs = ("one.angle", "two.angle", "one.speed", "two.speed", *more)
    ((a, b, va, vb, *rest),) = watch(folder, RODS.replace("SOLVER", solver), [2], *outputs)
    found = np.array([a + np.pi / 2, a + b + np.pi / 2, va, va + vb])
    return np.abs(found - ANGLES).max(), rest


@pytest.mark.parametrize(
    ("solver", "good"),
    [
        ("dop853: {tolerance: 1e-12}", 1e-9),
        ("gauss_radau15", 1e-9),
        ("adams: {tolerance: 1e-12}", 1e-9),
        ("radau: {tolerance: 1e-9}", 1e-8),
        ("rodas5p: {tolerance: 1e-7}", 1e-4),
        ("auto", 1e-5),
    ],
)
def test_two_rods_on_hinges_swing_as_their_equations_say(tmp_path, solver, good):
    assert swung(tmp_path, solver)[0] < good


@pytest.mark.parametrize(
    ("word", "order"), [("rk4", 4), ("verlet", 2), ("bdf2", 2), ("implicit_midpoint", 2), ("semi_implicit_euler", 1)]
)
def test_methods_keep_their_order_on_ties(tmp_path, word, order):
    coarse, fine = (swung(tmp_path, f"{word}: {{step: {step} ms}}")[0] for step in (4, 2))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.45)


@pytest.mark.parametrize("solver", ["adams: {tolerance: 1e-6}", "rk4: {step: 10 ms}", "verlet: {step: 10 ms}"])
def test_joints_stay_closed_whatever_the_errors_are(tmp_path, solver):
    outputs = ("rods.a.start.position", "rods.a.end.position", "rods.b.start.position")
    speeds = ("rods.a.start.velocity", "rods.a.end.velocity", "rods.b.start.velocity")
    for row in watch(tmp_path, RODS.replace("SOLVER", solver), np.linspace(0, 2, 23), *outputs, *speeds):
        assert np.abs(row[0]).max() < 1e-13
        assert np.abs(row[1] - row[2]).max() < 1e-13
        assert np.abs(row[3]).max() < 1e-12
        assert np.abs(row[4] - row[5]).max() < 1e-12


def test_a_method_of_many_short_steps_closes_joints_in_few_of_them_and_on_every_frame(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(RODS.replace("SOLVER", "adams: {tolerance: 1e-10}"))
    run = Run(load(path, pruned=False))
    march, open_between = run.islands[0].march, 0
    for moment in run.moments(np.linspace(0, 2, 200)):
        assert np.abs(moment.read("rods", "a.start.position")).max() < 1e-13
        end = march.stopped().y
        opened = np.abs(end - march._settled(march.time, end)).max()
        assert opened < 1e-9
        open_between += opened > 1e-15
    assert open_between > 100
    assert march.statistics.evaluations == 2 * march.statistics.steps + march.statistics.rejected


def test_the_force_of_a_hinge_is_what_the_bodies_weigh_and_pull(tmp_path):
    ((force, speed, acceleration, other),) = watch(
        tmp_path,
        RODS.replace("SOLVER", "dop853: {tolerance: 1e-10}"),
        [0.7],
        "one.force",
        "one.speed",
        "rods.a.acceleration",
        "rods.b.acceleration",
    )
    assert speed != 0
    np.testing.assert_allclose(force, acceleration + other + [0, 2 * 9.81, 0], rtol=1e-10, atol=1e-10)


def test_a_heavy_top_turns_as_its_integrals_say(tmp_path):
    times = np.linspace(0, 5, 2001)
    rows = watch(tmp_path, TOP.replace("SOLVER", "dop853: {tolerance: 1e-13}"), times, "top.position", "top.velocity")
    places, speeds = (np.array([row[k] for row in rows]) / 0.5 for k in (0, 1))
    tilts = np.arccos(places[:, 1])
    assert tilts[-1] == pytest.approx(0.400012050557, abs=1e-9)
    assert -speeds[-1, 1] / np.sin(tilts[-1]) == pytest.approx(0.005306064876, abs=1e-9)
    angles = np.unwrap(np.arctan2(-places[:, 2], places[:, 0]))
    assert angles[-1] == pytest.approx(4.549154113092, abs=1e-9)
    k = int(np.argmax(tilts))
    highest = np.polynomial.Polynomial.fit(times[k - 3 : k + 4] - times[k], tilts[k - 3 : k + 4], 6)
    best = [r.real for r in highest.deriv().roots() if abs(r.imag) < 1e-9 and abs(r) < 2.6e-3]
    assert max(highest(r) for r in best) == pytest.approx(0.6978552374675282, abs=1e-10)


def test_verlet_finds_the_way_back_through_ties(tmp_path):
    """RATTLE is reversible in time: from the end, with all motions turned round, the run comes back to the start."""
    solver = "verlet: {step: 10 ms}"
    names = [f"rods.{body}.{output}" for body in "ab" for output in ("position", "rotation", "velocity", "spin")]
    (end,) = watch(tmp_path, RODS.replace("SOLVER", solver), [1.5], *names)
    written = [" ".join(repr(float(c)) for c in (-1 if k % 4 > 1 else 1) * value) for k, value in enumerate(end)]
    script = RODS.replace("SOLVER", solver).replace("at: 1 0 0 m", "at: rods.a.end")
    for k, place in ((0, "position: 0.5 0 0 m"), (4, "position: 1.5 0 0 m")):
        x, q, v, w = written[k : k + 4]
        moved = f"position: {x} m, rotation: [{q.replace(' ', ', ')}], velocity: {v} m/s, spin: {w} rad/s"
        script = script.replace(place, moved)
    (back,) = watch(tmp_path, script, [1.5], "rods.a.position", "rods.b.position")
    np.testing.assert_allclose(back[0], [0.5, 0, 0], atol=1e-10)
    np.testing.assert_allclose(back[1], [1.5, 0, 0], atol=1e-10)


def test_verlet_on_ties_keeps_the_error_of_the_energy_bounded(tmp_path):
    script = RODS.replace("SOLVER", "verlet: {step: 5 ms}").replace("end: 2 s", "end: 60 s")
    energies = [row[0] for row in watch(tmp_path, script, np.arange(0, 60, 0.05), "rods.energy")]
    assert np.abs(energies).max() < 0.1
    assert np.abs(energies[-100:]).min() < 1e-4  # back where they began: nothing adds up


TOP = """
clock: {end: 5 s}
models:
  top:
    rigid:
      mass: 1 kg
      inertia: 0.75 0.5 0.75 kg*m^2
      position: [0.5 m*sin(0.4), 0.5 m*cos(0.4), 0 m]
      rotation: {about: z, angle: -0.4 rad}
      spin: [8/s*sin(0.4), 8/s*cos(0.4), 0/s]
forces: {down: {gravity: {strength: 6 m/s^2}}}
ties: {foot: {ball: {between: [top, world], at: 0 0 0 m}}}
solvers: {main: {SOLVER}}
"""
"""About the point I1 = 1, I3 = 0.5 kg m^2, m g l = 3 N m, spin 8/s about its axis, which leans by 0.4 rad."""


@pytest.mark.parametrize(("word", "order", "step"), [("verlet", 2, 16), ("blanes_moan", 4, 80)])
def test_splittings_keep_their_order_on_a_heavy_top(tmp_path, word, order, step):
    def found(solver):
        script = TOP.replace("SOLVER", solver)
        return np.concatenate(watch(tmp_path, script, [5], "top.position", "top.velocity")[0])

    exact = found("dop853: {tolerance: 1e-13}")
    coarse, fine = (np.abs(found(f"{word}: {{step: {length} ms}}") - exact).max() for length in (step, step / 2))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("word", ["verlet", "blanes_moan"])
def test_a_heavy_top_does_not_drift_in_1e5_steps(tmp_path, word):
    script = TOP.replace("SOLVER", f"{word}: {{step: 10 ms}}").replace("end: 5 s", "end: 1000 s")
    energies = [row[0] for row in watch(tmp_path, script, np.arange(0, 1000, 0.5), "top.energy")]
    first, last = (np.abs(np.array(some) - energies[0]).max() for some in (energies[:200], energies[-200:]))
    assert last < 1.1 * first + 1e-11 * energies[0]  # the last is rounding


BOX = "objects: {box: {box: {size: 0.4 0.2 0.1 m}}, cube: {box: {size: 0.1 0.1 0.1 m, position: 0.25 0.02 0 m}}}"


def test_two_bodies_welded_move_as_one(tmp_path):
    script = f"""
clock: {{end: 2 s}}
{BOX}
models: {{whole: {{rigid: {{bodies: {{a: {{of: box, spin: 1 2 3 rad/s}}, b: {{of: cube, spin: 1 2 3 rad/s}}}}}}}}}}
ties: {{glue: {{weld: {{between: [whole.a, whole.b]}}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-12}}}}}}
"""
    start, end = watch(
        tmp_path,
        script,
        [0, 2],
        "whole.center",
        "whole.energy",
        "whole.a.rotation",
        "whole.b.rotation",
        "whole.angular_momentum",
        "whole.a.position",
        "whole.b.position",
        "whole.momentum",
    )
    np.testing.assert_allclose(end[4], start[4], rtol=1e-12)
    assert end[1] == pytest.approx(start[1], rel=1e-12)
    np.testing.assert_allclose(end[2], end[3], atol=1e-14)
    ma, mb = 8.0, 1.0
    a, b = np.array([0.0, 0, 0]), np.array([0.25, 0.02, 0])
    center = (ma * a + mb * b) / (ma + mb)
    inertia = np.zeros((3, 3))
    for mass, place, sides in ((ma, a, (0.4, 0.2, 0.1)), (mb, b, (0.1, 0.1, 0.1))):
        squares, arm = np.square(sides), place - center
        inertia += np.diag(mass / 12 * (squares.sum() - squares)) + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))

    def rate(t, q):
        w, u = q[0], q[1:]
        turn = Rotation.from_quat(q, scalar_first=True).as_matrix()
        spin = turn @ np.linalg.solve(inertia, turn.T @ start[4])
        return np.concatenate([[-0.5 * spin @ u], 0.5 * (w * spin + np.cross(spin, u))])

    q = solve_ivp(rate, (0, 2), [1, 0, 0, 0], "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    assert min(np.abs(q - end[2]).max(), np.abs(q + end[2]).max()) < 1e-9


def test_a_spring_along_a_slider_swings_as_a_mass_on_it(tmp_path):
    script = f"""
clock: {{end: 3 s}}
{BOX}
models: {{it: {{rigid: {{of: box, mass: 2 kg}}}}}}
forces: [gravity]
ties: {{rail: {{slider: {{between: [it, world], axis: 1 1 0, stiffness: 50 N/m, rest: 0.1 m, motor: {{force: 3 N}}}}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-12}}}}}}
"""
    rows = watch(tmp_path, script, [0, 1.3, 3], "rail.shift", "rail.speed", "it.position", "it.rotation", "it.energy")
    along = (3 - 2 * 9.81 / np.sqrt(2) + 50 * 0.1) / 50
    for time, row in zip((0, 1.3, 3), rows, strict=True):
        assert row[0] == pytest.approx(along * (1 - np.cos(5 * time)), abs=1e-10)
        assert row[1] == pytest.approx(5 * along * np.sin(5 * time), abs=1e-9)
        np.testing.assert_allclose(row[2], row[0] * np.array([1, 1, 0]) / np.sqrt(2), atol=1e-13)
        np.testing.assert_allclose(row[3], [1, 0, 0, 0], atol=1e-14)
        assert row[4] == pytest.approx(rows[0][4], abs=1e-10)


def test_a_damped_spring_about_a_hinge_swings_as_its_equation(tmp_path):
    script = f"""
clock: {{end: 2 s}}
{BOX}
models: {{it: {{rigid: {{of: box, mass: 3 kg, spin: 0 0 2 rad/s}}}}}}
ties: {{pivot: {{hinge: {{between: [it, world], at: 0 0 0 m, stiffness: 4 N*m, damping: 0.02 N*m*s}}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-12}}}}}}
"""
    inertia = 3 / 12 * (0.16 + 0.04)
    decay = 0.02 / (2 * inertia)
    frequency = np.sqrt(4 / inertia - decay**2)
    rows = watch(tmp_path, script, [0, 0.9, 2], "pivot.angle", "it.energy")
    for time, row in zip((0, 0.9, 2), rows, strict=True):
        assert row[0] == pytest.approx(2 / frequency * np.exp(-decay * time) * np.sin(frequency * time), abs=1e-10)
        assert row[1] == pytest.approx(rows[0][1], rel=1e-10)


def test_a_mass_on_a_rod_is_a_pendulum_in_space(tmp_path):
    script = """
clock: {end: 3 s}
models: {net: {particles: {list: {bob: {position: 1 0 0 m, velocity: 0 0 2 m/s}}}}}
forces: [gravity]
ties: {string: {rod: {between: [net.bob, world], to: 0 0 0 m}}}
solvers: {main: {dop853: {tolerance: 1e-12}}}
"""
    first, last = watch(tmp_path, script, [0, 3], "net.energy", "net.bob.position", "net.angular_momentum")
    assert last[0] == pytest.approx(first[0], abs=1e-10)
    assert np.linalg.norm(last[1]) == pytest.approx(1, abs=1e-13)
    assert last[2][1] == pytest.approx(first[2][1], abs=1e-11)


DOOR = """
clock: {end: 2 s}
objects: {leaf: {box: {size: 1 2 0.05 m, position: 0.5 1 0 m}}}
models: {door: {rigid: {of: leaf, mass: 20 kg, spin: 0 1 0 rad/s, velocity: 0 0 -0.5 m/s}}}
forces: [gravity]
ties:
TIES
solvers: {main: {dop853: {tolerance: 1e-11}}}
outputs: {table: {record: {of: [door.energy]}}}
"""
UPPER = "  upper: {hinge: {between: [door, world], at: 0 1.8 0 m, axis: 0 1 0}}"
LOWER = "  lower: {hinge: {between: [door, world], at: 0 0.2 0 m, axis: 0 1 0}}"


def test_two_hinges_of_one_door_share_its_weight_evenly(tmp_path):
    one = watch(tmp_path, DOOR.replace("TIES", UPPER), [2], "upper.angle", "door.energy")[0]
    both = watch(
        tmp_path,
        DOOR.replace("TIES", f"{UPPER}\n{LOWER}"),
        [2],
        "upper.angle",
        "door.energy",
        "upper.force",
        "lower.force",
    )[0]
    assert both[0] == pytest.approx(one[0], abs=1e-10)
    assert both[1] == pytest.approx(one[1], rel=1e-12)
    assert both[2][1] == pytest.approx(20 * 9.81 / 2, rel=1e-7)
    assert both[3][1] == pytest.approx(20 * 9.81 / 2, rel=1e-7)
    said = text(explain(load(tmp_path / "scene.yaml")))
    assert "ties: lower, upper, 10 conditions, of which the others imply 5" in said


def test_of_many_conditions_those_that_others_imply_are_counted(tmp_path):
    """Of a row of windows: its hinges leave one motion, in their plane, of all that the bodies have."""
    count = 40
    written = tmp_path / "scene.yaml"
    written.write_text(windows(count, 1) + "outputs: {table: {record: {of: [links.energy]}}}\n")
    said = text(explain(load(written)))
    rows = 5 * (3 * count + 1)
    implied = rows - (6 * (2 * count + 1) - 1)
    assert f"{rows} conditions, of which the others imply {implied}:" in said


def windows(count, end):
    """Cranks hinged to the ground a meter apart, upright, and couplers along their tops, which start at 1 m/s."""
    across = "inertia: 0.083333333333333333 1e-4 0.083333333333333333 kg*m^2"
    cranks = [
        f"        c{k}: {{mass: 1 kg, {across}, position: {k} 0.5 0 m, velocity: 0.5 0 0 m/s, spin: 0 0 -1 rad/s}}"
        for k in range(count + 1)
    ]
    bars = [
        f"        b{k}: {{mass: 1 kg, {ROD}, position: {k + 0.5} 1 0 m, velocity: 1 0 0 m/s}}" for k in range(count)
    ]
    ties = [f"  g{k}: {{hinge: {{between: [links.c{k}, world], at: {k} 0 0 m}}}}" for k in range(count + 1)]
    for k in range(count):
        ties.append(f"  l{k}: {{hinge: {{between: [links.b{k}, links.c{k}], at: {k} 1 0 m}}}}")
        ties.append(f"  r{k}: {{hinge: {{between: [links.b{k}, links.c{k + 1}], at: {k + 1} 1 0 m}}}}")
    lines = "\n".join([*cranks, *bars])
    joined = "\n".join(ties)
    return f"""
clock: {{end: {end} s}}
models:
  links:
    rigid:
      bodies:
{lines}
forces: [gravity]
ties:
{joined}
solvers: {{main: {{dop853: {{tolerance: 1e-11}}}}}}
"""


@pytest.mark.parametrize("count", [1, 3])
def test_four_bars_pass_through_the_places_where_all_links_lie_in_line(tmp_path, count):
    rows = watch(tmp_path, windows(count, 4), np.linspace(0, 4, 9), "links.energy", "links.c0.rotation")
    start = rows[0][0]
    turned = [2 * np.arctan2(row[1][3], row[1][0]) for row in rows]
    assert max(abs(row[0] - start) for row in rows) < 1e-8 * max(1, abs(start))
    assert np.ptp(np.unwrap(turned)) > np.pi / 2  # they have lain in line


def test_copies_are_tied_by_their_numbers_in_braces(tmp_path):
    rods = "\n".join(f"        p{k}: {{mass: 1 kg, {ROD}, position: {k + 0.5} 0 0 m}}" for k in range(3))
    ties = "\n".join(
        f"  j{k}: {{hinge: {{between: [rods.p{k}, {f'rods.p{k - 1}' if k else 'world'}], at: {k} 0 0 m}}}}"
        for k in range(3)
    )
    head, tail = "clock: {end: 1 s}\nforces: [gravity]\nmodels:\n  rods:\n    rigid:\n      bodies:\n", "\nties:\n"
    repeated = (
        f'        p: {{repeat: {{count: 3, as: i}}, mass: 1 kg, {ROD}, position: ["i*1 m + 0.5 m", 0 m, 0 m]}}{tail}'
        "  foot: {hinge: {between: [rods.p.0, world], at: 0 0 0 m}}\n"
        '  j: {repeat: {count: 2}, hinge: {between: ["rods.p.{i + 1}", "rods.p.{i}"], at: ["(i + 1)*1 m", 0 m, 0 m]}}'
    )
    ((by_hand,),) = watch(tmp_path, f"{head}{rods}{tail}{ties}\n", [1], "rods.p2.position")
    ((by_number,),) = watch(tmp_path, f"{head}{repeated}\n", [1], "rods.p.2.position")
    np.testing.assert_allclose(by_number, by_hand, atol=1e-12)


def test_a_model_is_looked_through_once_however_many_ties_name_its_bodies(tmp_path, monkeypatch):
    seen = []

    def counted(node):
        seen.append(node)
        return whole(node)

    monkeypatch.setattr(check, "whole", counted)
    path = tmp_path / "scene.yaml"
    path.write_text(windows(8, 1))
    load(path, pruned=False)
    assert len(seen) == 1


def test_a_rod_hangs_from_an_object_that_moves_by_a_formula(tmp_path):
    script = """
clock: {end: 2 s}
objects: {cart: {box: {size: 0.1 0.1 0.1 m, position: [0.3 m*sin(4*time/(1 s)), 0 m, 0 m]}}}
models:
  rod:
    rigid:
      mass: 1 kg
      inertia: 0.083333333333333333 1e-4 0.083333333333333333 kg*m^2
      position: 0 -0.5 0 m
      velocity: 1.2 0 0 m/s
forces: [gravity]
ties: {pin: {hinge: {between: [rod, cart], at: 0 0 0 m}}}
solvers: {main: {dop853: {tolerance: 1e-12}}}
"""
    ((angle, speed),) = watch(tmp_path, script, [2], "pin.angle", "pin.speed")

    def rate(t, state):
        push = -0.3 * 16 * np.sin(4 * t)
        return [state[1], -(1.5) * (9.81 * np.sin(state[0]) + push * np.cos(state[0]))]

    found = solve_ivp(rate, (0, 2), [0, 0], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose([angle, speed], found, atol=1e-8)


def test_velocities_that_a_tie_forbids_are_left_at_the_start(tmp_path):
    script = DOOR.replace("TIES", UPPER).replace("velocity: 0 0 -0.5 m/s", "velocity: 1 0 -0.5 m/s")
    ((velocity, spin),) = watch(tmp_path, script, [0], "door.velocity", "door.spin")
    np.testing.assert_allclose(velocity, [0, 0, -0.5], atol=1e-14)
    np.testing.assert_allclose(spin, [0, 1, 0], atol=1e-14)


def test_a_top_that_is_given_its_spin_alone_turns_about_its_tip(tmp_path):
    script = """
models: {top: {rigid: {mass: 2 kg, inertia: 1 2 1 kg*m^2, position: 0.3 0.4 0 m, spin: 3 4 0 rad/s}}}
ties: {tip: {ball: {between: [top, world], at: 0 0 0.1 m}}}
"""
    ((velocity, spin),) = watch(tmp_path, script, [0], "top.velocity", "top.spin")
    np.testing.assert_allclose(spin, [3, 4, 0], atol=1e-14)
    np.testing.assert_allclose(velocity, np.cross([3, 4, 0], [0.3, 0.4, -0.1]), atol=1e-14)


def test_what_is_welded_to_a_body_with_a_velocity_goes_with_it(tmp_path):
    script = """
models:
  rod: {rigid: {mass: 0.2 kg, inertia: 0.1 0.1 0.1 kg*m^2, position: 0 -0.5 0 m}}
  bob: {rigid: {mass: 1 kg, inertia: 0.1 0.1 0.1 kg*m^2, position: 0 -1 0 m, velocity: 0.6 0 0 m/s}}
ties: {pivot: {hinge: {between: [rod, world], at: 0 0 0 m}}, glue: {weld: {between: [rod, bob]}}}
"""
    ((place, spin, other),) = watch(tmp_path, script, [0], "rod.velocity", "rod.spin", "bob.velocity")
    np.testing.assert_allclose([place, spin, other], [[0.3, 0, 0], [0, 0, 0.6], [0.6, 0, 0]], atol=1e-14)


def test_a_scene_without_ties_loads_nothing_of_them(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("clock: {end: 1 s}\nmodels: {it: {particles: {list: {a: {}}}}}\nforces: [gravity]\n")
    structure = Run(load(path, pruned=False)).islands[0].march.system.structure
    assert not structure.settling
    assert not structure.free
    assert not any("tie" in name or "rigid" in name for name in structure.terms)


def test_a_rope_ties_two_bodies_both_ways(tmp_path):
    script = """
clock: {end: 1 s}
models:
  crate: {rigid: {mass: 2 kg, inertia: 0.1 0.2 0.15 kg*m^2, position: 1 1 0 m, points: {hook: 0 0.1 0 m}}}
  rope: {mass_spring: {rope: {from: 0 2 0 m, to: 1 1.1 0 m, count: 6}, mass: 0.02 kg, stiffness: 3000 N/m}}
  sheet: {cloth: {size: 1 1 m, cells: 3 3, center: 0.5 2.5 0 m, facing: 0 0 1, pins: [top]}}
forces: [gravity]
ties:
  knot: {ball: {between: [rope.end, crate]}}
  hem: {ball: {between: [rope.start, sheet.bottom_left]}}
solvers: {main: {dop853: {tolerance: 1e-9}}}
"""
    names = ("crate.energy", "rope.energy", "sheet.energy")
    places = ("rope.end.position", "crate.hook.position", "rope.start.position", "sheet.bottom_left.position")
    first, last = watch(tmp_path, script, [0, 1], *names, *places)
    assert sum(last[:3]) == pytest.approx(sum(first[:3]), abs=1e-5)
    np.testing.assert_allclose(last[3], last[4], atol=1e-13)
    np.testing.assert_allclose(last[5], last[6], atol=1e-13)
    assert np.linalg.norm(last[4] - first[4]) > 0.1


@pytest.mark.parametrize(
    ("solver", "good"),
    [("dop853: {tolerance: 1e-10}", 1e-7), ("auto", 1e-5), ("radau", 1e-6), ("rk4: {step: 1 ms}", 0.1)],
)
def test_a_tie_is_gone_once_its_force_is_too_large(tmp_path, solver, good):
    """A pendulum let go level: the pull of its rod is 3 m g sin(angle), and at 2 m g the mass flies off."""
    script = f"""
clock: {{end: 2 s}}
models: {{net: {{particles: {{list: {{bob: {{position: 1 0 0 m}}}}}}}}}}
forces: [gravity]
ties: {{string: {{rod: {{between: [net.bob, world], to: 0 0 0 m, breaks: 19.62 N}}}}}}
solvers: {{main: {{{solver}}}}}
"""
    times = np.arange(0, 2, 0.01)
    rows = watch(tmp_path, script, times, "net.bob.position", "string.broken", "net.energy", "string.force")
    gone = next(k for k, row in enumerate(rows) if row[1])
    place = rows[gone - 1][0]
    assert -place[1] == pytest.approx(2 / 3, abs=0.06)
    fallen, speed = 2 / 3, np.sqrt(4 / 3 * 9.81)
    swung = quad(lambda angle: 1 / np.sqrt(2 * 9.81 * np.sin(angle)), 0, np.arcsin(fallen))[0]
    after = times[-1] - swung
    flown = [np.sqrt(5) / 3 - speed * fallen * after, -fallen - speed * np.sqrt(5) / 3 * after - 4.905 * after**2, 0]
    np.testing.assert_allclose(rows[-1][0], flown, atol=good)
    assert all(abs(np.linalg.norm(row[0]) - 1) < 1e-9 for row in rows[:gone])
    assert not any(row[3].any() for row in rows[gone:])
    assert np.linalg.norm(rows[-1][0]) > 2
    assert abs(rows[-1][2]) < good


def test_what_rests_under_a_growing_load_goes_when_it_is_too_large(tmp_path):
    """A step as long as the clock went over the break: the weld was gone, and the body stood still to the end."""
    script = """
clock: {end: 4 s}
models: {b: {rigid: {mass: 10 kg, inertia: 1 1 1 kg*m^2}}}
ties: {glue: {weld: {between: [b, world], breaks: 150 N}}}
forces: [gravity, {force: {on: [b], components: ["0", "-20*t", "0"]}}]
"""
    gone = (150 - 98.1) / 20
    exact = 9.81 * (4 - gone) ** 2 / 2 + 2 * (4**3 / 6 - gone**2 * 4 / 2 + gone**3 / 3)
    ((fallen, fast),) = watch(tmp_path, script, [4.0], "b.center", "b.velocity")
    assert -fallen[1] == pytest.approx(exact, abs=abs(fast[1]) / 240)


@pytest.mark.parametrize(("inner", "sense"), [("no", -1), ("yes", 1)])
def test_gears_turn_by_as_many_teeth_over_many_turns(tmp_path, inner, sense):
    script = f"""
clock: {{end: 5 s}}
models:
  wheels:
    rigid:
      bodies:
        small: {{mass: 1 kg, inertia: 0.2 0.2 0.1 kg*m^2}}
        large: {{mass: 4 kg, inertia: 2 2 1.6 kg*m^2, position: 3 0 0 m}}
forces: {{crank: {{torque: {{components: ["0", "0", "where(m < 2, 3, 0)"]}}}}}}
ties:
  a: {{hinge: {{between: [wheels.small, world], at: 0 0 0 m}}}}
  b: {{hinge: {{between: [wheels.large, world], at: 3 0 0 m}}}}
  mesh: {{gear: {{between: [wheels.small, wheels.large], teeth: 12 30, inner: {inner}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-10}}}}}}
"""
    ((speed, other, torque, energy),) = watch(
        tmp_path, script, [5], "wheels.small.spin", "wheels.large.spin", "mesh.torque", "wheels.energy"
    )
    # Reduced to the small wheel: 0.1 + 1.6 (12/30)^2 kg m^2.
    rate = 3 / (0.1 + 1.6 * 0.16)
    assert speed[2] == pytest.approx(rate * 5, rel=1e-9)
    assert other[2] == pytest.approx(sense * 0.4 * rate * 5, rel=1e-9)
    assert torque[2] == pytest.approx(0.1 * rate - 3, rel=1e-9)
    assert abs(energy) < 1e-6


def test_the_spring_of_a_hinge_is_wound_up_over_full_turns(tmp_path):
    script = """
clock: {end: 4 s}
models:
  a: {rigid: {mass: 1 kg, inertia: 0.1 0.2 0.25 kg*m^2, position: 0.5 0 0 m, velocity: 0 5 0 m/s, spin: 0 0 10 rad/s}}
ties: {u: {hinge: {between: [a, world], at: 0 0 0 m, stiffness: 0.2 N*m, rest: 90 deg}}}
solvers: {main: {dop853: {tolerance: 1e-10}}}
"""
    rows = watch(tmp_path, script, np.linspace(0, 4, 41), "a.energy", "u.angle")
    assert np.ptp([row[0] for row in rows]) < 1e-7
    # 0.5 kg m^2 about the hinge, 25 J at the start and 0.1 (pi/2)^2 J in the spring.
    assert max(row[1] for row in rows) == pytest.approx(np.pi / 2 + np.sqrt(250 + (np.pi / 2) ** 2), abs=0.05)


def test_a_tie_tells_the_torque_about_where_it_is(tmp_path):
    script = DOOR.replace("TIES", "  upper: {ball: {between: [door, world], at: 0 1.8 0 m}}")
    ((torque, force),) = watch(tmp_path, script, [0.3], "upper.torque", "upper.force")
    assert np.linalg.norm(force) > 10
    np.testing.assert_allclose(torque, 0, atol=1e-9)


@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e8])
def test_a_light_body_holds_a_heavy_one(tmp_path, ratio):
    """A heavy bob on a light link is a pendulum by its mass alone: its angles at 0.5 s, integrated apart."""
    own = f"mass: {ratio} kg, inertia: {ratio / 100} {ratio / 100} {ratio / 100} kg*m^2"
    script = f"""
clock: {{end: 0.5 s}}
models:
  p:
    rigid:
      bodies:
        link: {{mass: 1 kg, inertia: 0.1 0.1 0.1 kg*m^2, position: 0.5 0 0 m}}
        bob: {{{own}, position: 1 0 0 m}}
forces: [gravity]
ties: {{pivot: {{hinge: {{between: [p.link, world], at: 0 0 0 m}}}}, glue: {{weld: {{between: [p.bob, p.link]}}}}}}
solvers: {{main: {{dop853: {{tolerance: 1e-10}}}}}}
"""
    ((angle,),) = watch(tmp_path, script, [0.5], "pivot.angle")
    inertia, pull = 0.1 + 0.25 + ratio * 1.01, 9.81 * (0.5 + ratio)
    found = solve_ivp(
        lambda t, y: [y[1], -pull / inertia * np.cos(y[0])], (0, 0.5), [0, 0], "DOP853", rtol=1e-12, atol=1e-13
    )
    assert angle == pytest.approx(found.y[0, -1], abs=1e-8)
