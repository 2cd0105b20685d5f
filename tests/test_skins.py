"""Gaps and contact points of curved and hollow shapes: formulas, support functions, other ways to compute them."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from sceneql.contacts.distance.rigid_shapes import Shapes
from sceneql.contacts.distance.skin_contact_kernels import MOST, POINT, touching
from sceneql.island.island import IslandAssembly
from sceneql.kinds import Ref
from sceneql.march.assembled import Setting
from sceneql.pipeline import load
from sceneql.shapes.placement import rotation_matrix

RING = "{torus: {radius: 0.5 m, tube: 0.15 m}}"
COLUMN = "{cylinder: {radius: 0.3 m, height: 1 m}}"
EGG = "{group: {children: [{sphere: {radius: 1 m}}], scale: [0.3, 0.5, 0.2]}}"
HALF = np.array([0.3, 0.5, 0.2])
FLOOR = "plane"


def turn(axis, angle):
    axis = np.asarray(axis, dtype=float)
    return np.concatenate([[math.cos(angle / 2)], math.sin(angle / 2) * axis / np.linalg.norm(axis)])


class Pair:
    """Two objects of a script as skins."""

    def __init__(self, folder, first, second):
        path = folder / "scene.yaml"
        path.write_text(f"objects:\n  a: {first}\n  b: {second}\n")
        graph = load(path, pruned=False)
        assembly = IslandAssembly(Setting(graph.tasks, 1.0))
        shapes = Shapes(assembly)
        self.shapes = [shapes.of(Ref(name), np.zeros(3)) for name in "ab"]
        self.ints = np.array(shapes.written(self.shapes, 0), dtype=np.int64)
        self.floats = assembly.numbers()

    def points(self, at_a, turn_a=(1, 0, 0, 0), at_b=(0, 0, 0), turn_b=(1, 0, 0, 0), margin=0.2):
        """Points (n, 10) of a pair, the one with the least gap first."""
        places = np.concatenate([at_a, turn_a, at_b, turn_b]).astype(float)
        points, size = np.zeros(MOST * POINT), min(shape.reach for shape in self.shapes)
        a, b = self.ints[:2]
        count, least = touching(
            self.floats, self.ints, a, b, places, 0, 7, np.zeros(6), 0, 0, 0.0, 1.0, margin, size, points
        )
        found = points.reshape(-1, POINT)[:count]
        assert least == min(found[:, 6], default=math.inf)
        np.testing.assert_allclose(found[:, :3] - found[:, 3:6], found[:, 6, None] * found[:, 7:], atol=1e-9)
        np.testing.assert_allclose(np.linalg.norm(found[:, 7:], axis=1), 1, atol=1e-12)
        return found

    def gap(self, *places, **more):
        return self.points(*places, **more)[0, 6]


TILTS = [0.0, 1e-6, 0.3, 1.0, math.pi / 2]


@pytest.mark.parametrize("height", [0.02, 0.0, -1e-5])
def test_gaps_over_a_plane_are_those_of_formulas(tmp_path, height):
    ring, column, egg = (Pair(tmp_path, shape, FLOOR) for shape in (RING, COLUMN, EGG))
    for tilt in TILTS:
        q = turn([1, 0, 0.3], tilt)
        axis = rotation_matrix(q)[:, 1]
        across = math.hypot(axis[0], axis[2])
        for pair, low in (
            (ring, 0.5 * across + 0.15),
            (column, 0.3 * across + 0.5 * abs(axis[1])),
            (egg, np.linalg.norm(HALF * rotation_matrix(q)[1])),
        ):
            at = [0.3, low + height, -0.2]
            found = pair.points(at, q)
            # The least place of a ring that is all but flat is anywhere around it.
            exact = 2e-9 if pair is not ring or tilt != 1e-6 else 5e-7
            assert found[0, 6] == pytest.approx(height, abs=exact)
            np.testing.assert_allclose(found[:, 8], 1, atol=1e-12)
            assert found[:, 1].min() == pytest.approx(height, abs=exact)


def test_a_standing_column_and_a_lying_one_have_points_enough(tmp_path):
    pair = Pair(tmp_path, COLUMN, FLOOR)
    standing = pair.points([0, 0.5, 0], margin=1e-4)
    assert np.abs(standing[:, 6]).max() < 1e-12
    angles = np.sort(np.arctan2(standing[:, 0], standing[:, 2]))
    assert np.diff([*angles, angles[0] + 2 * np.pi]).max() < np.pi / 3
    lying = pair.points([0, 0.3, 0], turn([0, 0, 1], np.pi / 2), margin=1e-4)
    flat = lying[lying[:, 6] < 1e-9]
    assert np.ptp(flat[:, 0]) == pytest.approx(1, abs=1e-9)
    assert np.abs(flat[:, 2]).max() < 1e-4


def ellipsoid_gap(at, matrix):
    """Distance of two ellipsoids of HALF, b at the origin, by its dual (Boyd & Vandenberghe 2004): the largest
    separation along any direction."""

    def separation(u):
        u = u / np.linalg.norm(u)
        return -(u @ at - np.linalg.norm(HALF * (matrix.T @ u)) - np.linalg.norm(HALF * u))

    starts = [at, *np.random.default_rng(1).normal(size=(3, 3))]
    return -min(minimize(separation, start, method="BFGS", options={"gtol": 1e-10}).fun for start in starts)


def test_gaps_of_ellipsoids_are_the_largest_separation(tmp_path):
    pair, random = Pair(tmp_path, EGG, EGG), np.random.default_rng(5)
    for _ in range(12):
        q = turn(random.normal(size=3), random.uniform(0, 3))
        away = random.normal(size=3)
        away /= np.linalg.norm(away)
        far = 0.02 - ellipsoid_gap(away, rotation_matrix(q))
        at = (1 + far) * away
        exact = ellipsoid_gap(at, rotation_matrix(q))
        assert pair.gap(at, q, margin=exact + 0.1) == pytest.approx(exact, abs=1e-7)


@pytest.mark.parametrize("angle", [0.2, 0.9, math.pi / 2])
def test_crossed_columns_touch_at_their_sides(tmp_path, angle):
    pair = Pair(tmp_path, COLUMN, COLUMN)
    (x, y, z, *_, gap, nx, ny, nz) = pair.points([0.61, 0.01, 0.02], turn([1, 0, 0], angle))[0]
    assert gap == pytest.approx(0.01, abs=1e-9)
    np.testing.assert_allclose([x, nx, ny, nz], [0.31, 1, 0, 0], atol=1e-7)
    assert abs(y) + abs(z) < 0.1


def test_a_ring_hangs_in_another(tmp_path):
    pair = Pair(tmp_path, RING, RING)
    # The middle of each tube runs through the middle of the other's hole.
    assert pair.gap([0.5, 0, 0], turn([1, 0, 0], np.pi / 2), margin=0.3) == pytest.approx(0.2, abs=1e-7)
    # Inside the hole one tube is met by the other, whose circle it crosses at a right angle.
    found = pair.points([0.69, 0, 0], turn([1, 0, 0], np.pi / 2))
    assert found[0, 6] == pytest.approx(0.31 - 0.3, abs=1e-7)
    np.testing.assert_allclose(np.abs(found[0, 7:]), [1, 0, 0], atol=1e-6)


@pytest.mark.parametrize("other", [EGG, RING, "{box: {size: 0.6 1 0.4 m}}", "{sphere: {radius: 0.4 m}}"])
def test_gaps_do_not_change_with_the_axes_nor_with_the_order(tmp_path, other):
    pair, swapped, random = Pair(tmp_path, RING, other), Pair(tmp_path, other, RING), np.random.default_rng(2)
    seen = 0
    for _ in range(8):
        qa, qb = (turn(random.normal(size=3), 2.0) for _ in range(2))
        away = random.normal(size=3)
        at = 1.1 * away / np.linalg.norm(away)
        found = pair.points(at, qa, turn_b=qb, margin=0.5)
        if found[:, 6].min(initial=1) < 0 or not len(found):
            continue
        seen += 1
        back = swapped.points(np.zeros(3), qb, at, qa, margin=0.5)
        assert back[0, 6] == pytest.approx(found[0, 6], abs=1e-8)
        np.testing.assert_allclose(back[0, 7:], -found[0, 7:], atol=1e-5)
        whole = turn([1, 2, 3], 0.7)
        matrix, shift = rotation_matrix(whole), np.array([3.0, -2.0, 1.0])

        def times(p, q):
            w, v = p[0] * q[0] - p[1:] @ q[1:], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
            return np.concatenate([[w], v])

        moved = pair.points(matrix @ at + shift, times(whole, qa), shift, times(whole, qb), margin=0.5)
        assert moved[0, 6] == pytest.approx(found[0, 6], abs=1e-8)
    assert seen > 2
