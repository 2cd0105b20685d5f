"""Particles, springs and motions by exact solutions and conserved quantities."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runs import complaint, watch
from sceneql.bodies import spring_look
from sceneql.bodies.nets import Cloth, Lattice
from sceneql.frame import Mesh, Surface

SPRING = """
clock: {{end: 2 s}}
models:
  spring:
    mass_spring:
      masses: {{wall: {{fixed: yes}}, bob: {{position: 1.2 0 0 m, mass: 2 kg}}}}
      springs: [{{between: [wall, bob], rest: 1 m, stiffness: {k}, damping: {c}, name: tether}}]
solvers: {{main: {{dopri5: {{tolerance: 1e-12}}}}}}
"""


def test_a_spring_swings_harmonically(tmp_path):
    script = SPRING.format(k="50 N/m", c="0 N*s/m")
    names = ("spring.bob.position", "spring.bob.velocity", "spring.bob.acceleration", "spring.energy")
    more = ("spring.tether.tension", "spring.tether.length", "spring.stretch", "spring.wall.position")
    ((x, v, a, energy, tension, length, stretch, wall),) = watch(tmp_path, script, [1.7], *names, *more)
    shift = 0.2 * math.cos(5 * 1.7)
    assert x[0] == pytest.approx(1 + shift, abs=1e-9)
    assert v[0] == pytest.approx(-math.sin(5 * 1.7), abs=1e-9)
    assert a[0] == pytest.approx(-25 * shift, abs=1e-8)
    assert energy == pytest.approx(1.0, rel=1e-10)
    assert tension == pytest.approx(50 * shift, abs=1e-8)
    assert length == pytest.approx(x[0])
    assert stretch == pytest.approx(abs(shift))
    np.testing.assert_array_equal(wall, 0)


def test_a_damped_spring_decays_and_its_loss_is_counted(tmp_path):
    script = SPRING.format(k="50 N/m", c="2 N*s/m")
    ((x, lost, energy),) = watch(tmp_path, script, [1.1], "spring.bob.position", "spring.dissipated", "spring.energy")
    decay, omega = 0.5, math.sqrt(25 - 0.25)
    swing = math.cos(omega * 1.1) + decay / omega * math.sin(omega * 1.1)
    assert x[0] - 1 == pytest.approx(0.2 * math.exp(-decay * 1.1) * swing, abs=1e-9)
    assert 0 < lost < 1
    assert energy == pytest.approx(1.0, rel=1e-9)


def test_stiffness_that_varies_in_time_acts(tmp_path):
    script = """
clock: {end: 1 s}
models:
  spring:
    mass_spring:
      masses: {wall: {fixed: yes}, bob: {position: 1 0 0 m, mass: 1 kg}}
      springs: [{between: [wall, bob], rest: 0 m}]
      stiffness: {keys: {0 s: 4 N/m, 0.5 s: 0 N/m}, curve: step}
solvers: {main: {rk4: {step: 0.5 ms}}}
"""
    ((v,),) = watch(tmp_path, script, [1.0], "spring.bob.velocity")
    assert v[0] == pytest.approx(-2 * math.sin(1.0), abs=2e-3)  # free flight from t = 0.5 on


LATTICE = """
clock: {{end: 1 s}}
models:
  jelly:
    mass_spring:
      lattice: {{count: 2 3 2, spacing: 0.2 m, center: 0 1 0 m, rotation: {{about: z, angle: 30 deg}}}}
      mass: 0.3 kg
      stiffness: 200 N/m
      damping: {c} N*s/m
      velocity: 1 2 0 m/s
      spin: 0.5 -1 3 rad/s
solvers: {{main: {{dopri5: {{tolerance: 1e-10}}}}}}
"""


@pytest.mark.parametrize("c", [0, 0.7, 3])
def test_a_free_lattice_keeps_momentum_angular_momentum_and_counted_energy(c, tmp_path):
    names = ("jelly.momentum", "jelly.angular_momentum", "jelly.energy", "jelly.center", "jelly.dissipated")
    first, last = watch(tmp_path, LATTICE.format(c=c), [0, 1], *names)
    np.testing.assert_allclose(last[0], np.array([1, 2, 0]) * 0.3 * 12, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(last[1], first[1], rtol=1e-9, atol=1e-9)
    assert last[2] == pytest.approx(first[2], rel=1e-8)
    np.testing.assert_allclose(last[3], [1, 3, 0], rtol=0, atol=1e-9)
    assert (last[4] > 0) == (c > 0)


def test_spin_turns_a_lattice_rigidly_at_the_start(tmp_path):
    ((x, v),) = watch(tmp_path, LATTICE.format(c=0), [0], "jelly.positions", "jelly.velocities")
    away = x - [0, 1, 0]
    np.testing.assert_allclose(v, np.add(np.cross([0.5, -1, 3], away), [1, 2, 0]), atol=1e-12)
    # 30 degrees about z: the first axis of the lattice has turned by that.
    np.testing.assert_allclose(x[6] - x[0], 0.2 * np.array([math.cos(math.pi / 6), 0.5, 0]), atol=1e-12)


@given(count=st.tuples(*[st.integers(1, 4)] * 3), shear=st.sampled_from([0.0, 0.5, 1.0]))
def test_a_lattice_has_every_neighbor_once(count, shear):
    net = Lattice(count=count, spacing=0.5, shear=shear).net()
    expected = set()
    for i in range(len(net.points)):
        for j in range(i):
            steps = np.abs(net.points[i] - net.points[j]) / 0.5
            if steps.max() < 1.5 and (shear > 0 or steps.sum() < 1.5):
                expected.add((j, i))
    assert {tuple(sorted(pair)) for pair in net.pairs.tolist()} == expected
    assert len(net.pairs) == len(expected)


def test_a_cloth_faces_where_it_is_told_and_its_corners_have_names():
    for facing in ((0.0, 1.0, 0.0), (0.0, 0.0, 2.0), (1.0, 0.5, -0.3)):
        net = Cloth(size=(2.0, 1.0), cells=(4, 2), facing=facing, center=(1.0, 2.0, 3.0)).net()
        a, b, c = (net.points[net.triangles[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        assert np.all(normals @ facing > 0)
        assert 0.5 * np.linalg.norm(normals, axis=1).sum() == pytest.approx(2.0)
        np.testing.assert_allclose(net.points.mean(axis=0), [1, 2, 3])
        assert {name: int(mask.sum()) for name, mask in net.places.items() if "_" in name} == dict.fromkeys(
            ("bottom_left", "bottom_right", "top_left", "top_right"), 1
        )
    hanging = Cloth(facing=(0.0, 0.0, 1.0)).net()
    assert hanging.points[hanging.places["top"]][:, 1].min() == hanging.points[:, 1].max()


def test_a_hanging_rope_stretches_by_its_weight_and_its_pin_holds(tmp_path):
    script = """
clock: {end: 12 s}
models:
  rope:
    mass_spring:
      rope: {from: 0 3 0 m, to: 0 2 0 m, count: 5}
      mass: 0.2 kg
      stiffness: 400 N/m
      damping: 20 N*s/m
      pins: [start]
forces: [gravity]
solvers: {main: {rk4: {step: 2 ms}}}
"""
    ((x, energy), (_, start)) = reversed(watch(tmp_path, script, [0, 12], "rope.positions", "rope.energy"))
    below = np.arange(4, 0, -1)  # masses that hang on each spring
    lengths = 0.25 + below * 0.2 * 9.81 / 400
    np.testing.assert_allclose(x[:, 1], 3 - np.concatenate([[0], np.cumsum(lengths)]), atol=1e-7)
    assert energy == pytest.approx(start, abs=1e-7)


def test_zero_length_springs_give_no_nan(tmp_path):
    script = """
clock: {end: 0.5 s}
models:
  knot:
    mass_spring:
      masses: {a: {}, b: {}, c: {position: 1 0 0 m}}
      springs: [{between: [a, b], rest: 0.1 m}, {between: [b, c], rest: 0 m}]
solvers: {main: {rk4: {step: 1 ms}}}
"""
    ((x, stretch),) = watch(tmp_path, script, [0.5], "knot.positions", "knot.stretch")
    assert np.isfinite(x).all()
    assert np.isfinite(stretch)


def test_a_particle_drives_its_object_from_where_that_stands(tmp_path):
    script = """
clock: {end: 1 s}
objects: {ball: {sphere: {radius: 0.2 m, position: 0 5 1 m}}}
models: {fall: {particles: {of: ball, mass: 1 kg}}}
forces: [gravity]
solvers: {main: {rk4: {step: 10 ms}}}
"""
    ((place, own, radii, count),) = watch(
        tmp_path, script, [1], "ball.position", "fall.position", "fall.radii", "fall.count"
    )
    np.testing.assert_allclose(place, [0, 5 - 4.905, 1], rtol=1e-12)
    np.testing.assert_array_equal(place, own)
    np.testing.assert_array_equal(radii, [0.2])
    assert count == 1


def test_points_become_particles(tmp_path):
    script = """
clock: {end: 1 s}
models: {dust: {particles: {positions: [[0 m, 1 m, 0 m], [2 m, 1 m, 0 m], [4 m, 1 m, 0 m]], velocity: 1 0 0 m/s}}}
solvers: {main: {euler: {step: 0.1 s}}}
"""
    ((x, center),) = watch(tmp_path, script, [1], "dust.positions", "dust.center")
    np.testing.assert_allclose(x[:, 0], [1, 3, 5])
    np.testing.assert_allclose(center, [3, 1, 0])


def test_a_motion_gives_its_place_and_the_velocity_of_it(tmp_path):
    script = """
clock: {end: 1 s}
models:
  lift:
    motion:
      position: {x: sin(3*time/(1 s))*2 m, y: {keys: {0 s: 0 m, 1 s: 4 m}, curve: linear}, z: 0 m}
objects: {cabin: {sphere: {position: lift.position, radius: 0.1 m}}}
"""
    ((place, velocity, rotation, drawn),) = watch(
        tmp_path, script, [0.4], "lift.position", "lift.velocity", "lift.rotation", "cabin.position"
    )
    np.testing.assert_allclose(place, [2 * math.sin(1.2), 1.6, 0], rtol=1e-14)
    np.testing.assert_allclose(velocity, [6 * math.cos(1.2), 4, 0], rtol=0, atol=1e-6)
    np.testing.assert_array_equal(rotation, [1, 0, 0, 0])
    np.testing.assert_array_equal(drawn, place)


PATH = (
    "models: {{path: {{motion: {{along: {}, progress: {}}}}}}}\nclock: {{end: 4 s}}\n"
    "objects: {{ball: {{sphere: {{position: path.position}}}}}}\n"
)


def test_a_motion_along_a_straight_path_goes_by_the_share_of_its_length(tmp_path):
    script = PATH.format("[0 0 0 m, 1 0 2 m, 4 0 8 m]", "{keys: {0 s: 0, 4 s: 1}, curve: linear}")
    for time, (place, velocity) in zip(
        (1, 2, 3), watch(tmp_path, script, [1, 2, 3], "path.position", "path.velocity"), strict=True
    ):
        np.testing.assert_allclose(place, np.array([1, 0, 2]) * time, atol=1e-12)
        np.testing.assert_allclose(velocity, [1, 0, 2], atol=1e-6)


def test_a_motion_meets_the_points_of_its_path_and_stays_at_the_ends(tmp_path):
    points = [(-4, 0.15, 0), (0, 0.15, 0.4), (0, 3, 0.4)]
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    middle = lengths[0] / lengths.sum()
    script = PATH.format(f"{[list(p) for p in points]}", "2*(time/(1 s)) - 1")
    places = [place for (place,) in watch(tmp_path, script, [0, 0.5, (1 + middle) / 2, 1, 3], "path.position")]
    np.testing.assert_allclose(places, [points[k] for k in (0, 0, 1, 2, 2)], atol=1e-12)


def test_a_closed_path_is_smooth_where_laps_meet_and_goes_on(tmp_path):
    script = PATH.format("[1 0 0 m, 0 1 0 m, -1 0 0 m, 0 -1 0 m, 1 0 0 m]", "time/(2 s)")
    outputs = watch(tmp_path, script, [0.3, 1.999, 2.001, 2.3], "path.position", "path.velocity")
    (early, _), (before, up), (after, on), (late, _) = outputs
    np.testing.assert_allclose(late, early, atol=1e-12)
    np.testing.assert_allclose(up, on, atol=0.05)
    assert np.linalg.norm(after - before) < 0.01


def test_a_force_follows_a_path_inside_the_steps(tmp_path):
    """A pull that grows as the distance towards p(t) = t along x: x'' = t - x from rest, so x = t - sin t."""
    script = PATH.format("[0 0 0 m, 4 0 0 m, 10 0 0 m]", "{keys: {0 s: 0, 10 s: 1}, curve: linear}") + (
        "forces: {pull: {attractor: {position: path.position, exponent: -1}}}\nsolvers: {main: {rk4: {step: 20 ms}}}\n"
    )
    script = script.replace("models: {", "models: {dot: {particles: {list: {one: {position: 0 0 0 m}}}}, ")
    for time, (place,) in zip((1, 3, 4), watch(tmp_path, script, [1, 3, 4], "dot.one.position"), strict=True):
        np.testing.assert_allclose(place, [time - math.sin(time), 0, 0], atol=1e-7)


WRONG = {
    "{motion: {along: [0 0 0 m]}}": "two points or more",
    "{motion: {along: [0 0 0 m, 0 0 0 m, 1 0 0 m]}}": "another than the one before",
    "{motion: {along: [0 0 0 m, 1 0 0 m], position: 0 0 0 m}}": "either `position` or `along`",
    "{mass_spring: {masses: {a: {}, b: {}}, springs: [{between: [a, a]}]}}": "from 'a' to itself",
    "{mass_spring: {masses: {a: {}, b: {}}, springs: [{between: [a, bob]}]}}": "no mass is called 'bob'",
    "{mass_spring: {masses: {a: {mass: 0 kg}}}}": "above 0",
    "{mass_spring: {masses: {a: {velocity: 1 0 0 m/s, fixed: yes}}}}": "has no velocity",
    "{mass_spring: {}}": "has one of",
    "{mass_spring: {rope: {}, cloth: {}}}": "cloth and rope",
    "{mass_spring: {lattice: {count: 0 3 3}}}": "at least 1",
    "{mass_spring: {lattice: {count: 100000 10000 1000}}}": "1e+12 masses and 1.3e+13 springs need about 5.07e+06 GiB",
    "{mass_spring: {lattice: {}, pins: [lid]}}": "no mass is called 'lid'",
    '{mass_spring: {rope: {count: 4}, pins: ["4"]}}': "counted from 0",
    "{mass_spring: {rope: {}, stiffness: -1 N/m}}": "above 0",
    "{particles: {}}": "come from one of",
    "{particles: {list: {a: {}}, positions: [[0, 0, 0]]}}": "not from list and positions",
    "{particles: {list: {}}}": "empty",
}


@pytest.mark.parametrize("entry", WRONG)
def test_a_wrong_model_is_told_with_its_place(tmp_path, entry):
    said = complaint(tmp_path, f"models:\n  bad: {entry}\n")
    assert WRONG[entry] in said
    assert "scene.yaml:2:" in said


def test_a_slab_of_cloth_is_closed_and_smooth():
    net = Cloth(cells=(5, 3)).net()
    mesh = spring_look.sheet("cloth", Surface(), net.points, net.triangles, 0.01)
    assert isinstance(mesh, Mesh)
    edges = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    directed = {tuple(edge) for edge in edges.tolist()}
    assert len(directed) == len(edges)
    assert all((b, a) in directed for a, b in directed)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    volume = np.sum(a * np.cross(b, c)) / 6
    assert volume == pytest.approx(2 * 2 * 0.02, rel=1e-9)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, rtol=1e-12)


def test_a_coil_leads_from_end_to_end_in_one_piece():
    start, end = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.5, 3.0])
    pieces = spring_look.coil(start, end, 0.05)
    np.testing.assert_array_equal(pieces[0, 0], start)
    np.testing.assert_array_equal(pieces[-1, 1], end)
    np.testing.assert_array_equal(pieces[1:, 0], pieces[:-1, 1])
    off_axis = np.linalg.norm(pieces[:, 0, [0, 2]] - [1, 3], axis=1)
    assert off_axis.max() == pytest.approx(0.05)
    assert np.isfinite(spring_look.coil(start, start, 0.05)).all()
