"""Rims of cylinders that meet sharp edges, other rims and flat ends in mode `exact`."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rigid_scenes
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R, AT_V, AT_W, AT_X, MOVED
from sceneql.contacts.distance import convex
from sceneql.contacts.rigid_exact import contact_kernels as contact
from sceneql.contacts.rigid_exact.curved import column
from sceneql.contacts.rigid_exact.curved_contact_kernels import ON_RIM, ON_RIMS, follow
from sceneql.contacts.rigid_exact.exact_shapes import gap_of


@pytest.mark.parametrize("kind", [ON_RIM, ON_RIMS])
@pytest.mark.parametrize("seed", [0, 1, 3])
def test_gap_and_speed_of_crossing_curves_change_as_they_are_told(kind, seed):
    """Against central differences of a motion of constant velocities and spins."""
    chance = np.random.default_rng(seed)
    first = column(0.3, 0.2).shape(0.05 * chance.normal(size=3)).floats
    second = column(0.25, 0.15).shape(0.05 * chance.normal(size=3)).floats
    a, b = 64, 64 + MOVED
    at = b + MOVED
    floats = np.zeros(at + contact.RECORD)
    floats[: len(first)], floats[32 : 32 + len(second)] = first, second
    angle, s = chance.normal(), 0.1
    end, along = 0.2 * chance.normal(size=3), chance.normal(size=3)
    along /= np.linalg.norm(along)

    def rim(shape, turn):
        place = [shape[15] * np.cos(turn), shape[16], shape[15] * np.sin(turn)]
        return shape[3:6] + shape[6:15].reshape(3, 3).T @ place

    turns = Rotation.random(2, rng=chance)
    x = chance.normal(size=(2, 3))
    on_b = end + s * along if kind == ON_RIM else rim(second, s)
    x[1] = x[0] + turns[0].apply(rim(first, angle)) - turns[1].apply(on_b)
    v, w = chance.normal(size=(2, 2, 3))

    def told(t):
        for side, mover in enumerate((a, b)):
            turn = Rotation.from_rotvec(t * w[side]) * turns[side]
            floats[mover + AT_X : mover + AT_X + 3] = x[side] + t * v[side]
            floats[mover + AT_R : mover + AT_R + 9] = turn.as_matrix().ravel()
            floats[mover + AT_V : mover + AT_V + 3], floats[mover + AT_W : mover + AT_W + 3] = v[side], w[side]
        floats[at + contact.KIND], floats[at + contact.SIGN] = kind, 1.0
        floats[at + contact.LINE_A : at + contact.LINE_A + 3] = 0, s, angle
        floats[at + contact.OWN_B : at + contact.OWN_B + 3] = end if kind == ON_RIM else (32, s, 1)
        floats[at + contact.LINE_B : at + contact.LINE_B + 3] = along
        follow(floats, np.zeros(1, dtype=np.int64), at, a, b)
        return floats[at + contact.GAP], floats[at + contact.SPEED], floats[at + contact.BIAS]

    h = 1e-5
    gap, speed, bias = told(0)
    after, before = told(h), told(-h)
    assert abs(gap) < 1e-15
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), speed, rtol=1e-6)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), bias, rtol=1e-5)


NORMAL = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
ACROSS = np.array([0.0, 0.0, 1.0])
RADIUS, HALF = 0.2, 0.15
DRUM = "cylinder: {radius: 0.2 m, height: 0.3 m}"


def turned(axes):
    """The rotation of a body whose axes are these rows, as it is written."""
    vector = Rotation.from_matrix(np.transpose(axes)).as_rotvec()
    angle = np.linalg.norm(vector)
    return f"rotation: {{about: {' '.join(map(repr, (vector / angle).tolist()))}, angle: {angle} rad}}"


def strikes(what):
    """What strikes a drum at rest at its upper rim: its object, center, the place and the normal, and its inertia."""
    place = np.array([RADIUS, HALF, 0.0])
    if what == "edge":
        side = 0.3
        up, out = (NORMAL + ACROSS) / np.sqrt(2), (NORMAL - ACROSS) / np.sqrt(2)
        center = place + 0.5 * side * (up + out) + 0.04 * np.cross(up, out)
        shape = f"size: {side} {side} {side} m"
        return f"box: {{{shape}, {turned([np.cross(up, out), up, out])}", center, place, NORMAL, np.eye(3) * side**2 / 6
    if what == "rim":
        out, axis = (ACROSS - NORMAL) / np.sqrt(2), (-ACROSS - NORMAL) / np.sqrt(2)
        center = place - RADIUS * out - HALF * axis
        shape, normal = "radius: 0.2 m, height: 0.3 m", NORMAL
    else:
        place, normal = np.array([0.05, HALF, 0.03]), np.array([0.0, 1.0, 0.0])
        axis = np.array([0.3, -0.9, 0.1]) / np.linalg.norm([0.3, -0.9, 0.1])
        out = -normal - np.dot(-normal, axis) * axis
        out /= np.linalg.norm(out)
        center = place - RADIUS * out - HALF * axis
        shape = "radius: 0.2 m, height: 0.3 m"
    axes = [out, axis, np.cross(out, axis)]
    own = np.diag([(3 * RADIUS**2 + 4 * HALF**2) / 12, RADIUS**2 / 2, (3 * RADIUS**2 + 4 * HALF**2) / 12])
    return f"cylinder: {{{shape}, {turned(axes)}", center, place, normal, np.transpose(axes) @ own @ axes


@pytest.mark.parametrize("what", ["edge", "rim", "end"])
def test_what_strikes_a_rim_has_the_impulse_of_its_normal(tmp_path, what):
    """Without friction: J = (1 + e) v / (n . W n), at the place where the curves cross."""
    shape, center, place, normal, inertia = strikes(what)
    speed, restitution = 2.0, 0.5
    start, v = center + 0.2 * speed * normal, -speed * normal
    objects = {
        "floor": "none",  # on which the drum would stand
        "drum": f"{{{DRUM}}}",
        "other": f"{{{shape}, position: {' '.join(map(repr, start.tolist()))} m}}}}",
    }
    bodies = {
        "drum": "{of: drum, mass: 2 kg}",
        "other": f"{{of: other, mass: 1 kg, velocity: {' '.join(map(repr, v.tolist()))} m/s}}",
    }
    law = f"mode: exact, restitution: {restitution}, friction: 0"
    asked = ("it.velocities", "it.drum.spin", "it.other.spin", "touch.hits.count")
    ((after, spin, turn, hits),) = rigid_scenes.watch(
        tmp_path, objects, bodies, [0.2 + 1e-8], *asked, law=law, forces="[]"
    )
    flat = (3 * RADIUS**2 + 4 * HALF**2) / 12
    below = 2 * np.diag([flat, RADIUS**2 / 2, flat])
    one, two = np.cross(place - center, normal), np.cross(place, normal)
    pushed = 1 / 1 + 1 / 2 + one @ np.linalg.solve(inertia, one) + two @ np.linalg.solve(below, two)
    impulse = (1 + restitution) * speed / pushed
    assert hits == 1
    np.testing.assert_allclose(after, [-impulse / 2 * normal, v + impulse * normal], atol=1e-10)
    np.testing.assert_allclose(spin, -impulse * np.linalg.solve(below, two), atol=1e-6)
    np.testing.assert_allclose(turn, impulse * np.linalg.solve(inertia, one), atol=1e-6)


def test_a_box_whose_edge_is_in_a_cylinder_overlaps_it():
    """In any pose: also where no corner, edge or face is the nearest of what is around it."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = 0.5 * np.array([0.216, 0.162, 0.216]) * signs
    box, drum = convex.box(corners[-1].tolist()), column(0.125, 0.2155).shape(np.zeros(3))
    chance, upright, deep = np.random.default_rng(5), np.array([0, 0, 0, 1.0, 0, 0, 0]), 0
    for _ in range(300):
        turn = Rotation.random(rng=chance)
        place = chance.normal(size=3)
        place *= chance.uniform(0.1, 0.35) / np.linalg.norm(place)
        ends = turn.apply(corners) + place
        edges = [(i, j) for i in range(8) for j in range(i) if np.abs(signs[i] - signs[j]).sum() == 2]
        points = np.concatenate([np.linspace(ends[i], ends[j], 41) for i, j in edges])
        inside = np.minimum(0.125 - np.hypot(points[:, 0], points[:, 2]), 0.2155 - np.abs(points[:, 1])).max()
        x, y, z, w = turn.as_quat()
        gap, _ = gap_of(drum, upright, box, np.array([*place, w, x, y, z]), np.zeros(0))
        if inside > 1e-3:
            deep += 1
            assert gap < 0
    assert deep > 50
