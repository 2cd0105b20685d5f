"""Distances, contact points and first touches of convex bodies: formulas, laws, other ways to compute them."""

from __future__ import annotations

import math
import os
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

from sceneql.contacts.distance import convex
from sceneql.contacts.distance.first_touch_kernels import first_touch
from sceneql.contacts.distance.gap_kernels import gap
from sceneql.contacts.distance.manifold_kernels import MOST, NAME, POINT, TWO_LINES, manifold
from sceneql.contacts.distance.swept_boxes_kernels import BOX, near_pairs, swept_box
from sceneql.shapes.placement import rotation_matrix

COUNT = min(int(os.environ.get("SCENEQL_FUZZ", "150")), 20_000)
EPS = 2.0**-52
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
SEEDS = st.integers(0, 2**32 - 1)
CUBE = convex.box([0.5] * 3)
FLOOR = convex.half_space([0, 1, 0], 0.0)


def turn(axis, angle):
    axis = np.asarray(axis, dtype=float)
    return np.concatenate([[math.cos(angle / 2)], math.sin(angle / 2) * axis / np.linalg.norm(axis)])


class Pair(NamedTuple):
    """Two shapes and where their bodies are."""

    a: convex.Convex
    at_a: object
    turn_a: object
    b: convex.Convex
    at_b: object = (0.0, 0.0, 0.0)
    turn_b: object = UPRIGHT

    @property
    def arguments(self):
        shapes = [self.a, self.b]
        places = np.concatenate([self.at_a, self.turn_a, self.at_b, self.turn_b]).astype(float)
        room = np.full(convex.room_length(shapes), np.nan)
        return *convex.joined(shapes), 0, convex.SHAPE, places, 0, 7, room

    @property
    def size(self):
        reach = [shape.floats[1] for shape in (self.a, self.b) if np.isfinite(shape.floats[1])]
        return sum(reach) + np.abs(self.at_a).max() + np.abs(self.at_b).max()

    def gap(self):
        """Gap, normal, point of a, point of b."""
        found = np.array(gap(*self.arguments))
        return found[0], found[1:4], found[4:7], found[7:]

    def manifold(self, margin):
        """Gap, normal, points (n, 7) and names (n, 2)."""
        *given, room = self.arguments
        points, names = np.full(MOST * POINT, np.nan), np.zeros(MOST * NAME, dtype=np.int64)
        count, least, *normal = manifold(*given, margin, points, names, room)
        return least, np.array(normal), points.reshape(-1, POINT)[:count], names.reshape(-1, NAME)[:count]

    def swapped(self):
        return Pair(self.b, self.at_b, self.turn_b, self.a, self.at_a, self.turn_a)


def corners(shape, at, rotation):
    """Vertices, loops of faces, edges, placed, in long numbers."""
    v, f, _, n = shape.ints[:4]
    starts, loops = shape.ints[4 : 5 + f], shape.ints[5 + f : 5 + f + n]
    w, x, y, z = np.array(rotation, dtype=np.longdouble)
    s = 2 / (w * w + x * x + y * y + z * z)
    matrix = np.eye(3) + s * np.array(
        [
            [-y * y - z * z, x * y - w * z, x * z + w * y],
            [x * y + w * z, -x * x - z * z, y * z - w * x],
            [x * z - w * y, y * z + w * x, -x * x - y * y],
        ]
    )
    points = shape.floats[2 : 2 + 3 * v].reshape(-1, 3).astype(np.longdouble) @ matrix.T
    faces = [loops[starts[k] : starts[k + 1]] for k in range(f)]
    return points + np.array(at, dtype=np.longdouble), faces, shape.ints[5 + f + n :].reshape(-1, 4)[:, :2]


def largest_separation(pair):
    """The signed distance as the largest separation along any direction that features can have, in long numbers."""
    origin = np.array(pair.at_a, dtype=np.longdouble)
    first = corners(pair.a, np.zeros(3), pair.turn_a)
    second = corners(pair.b, np.array(pair.at_b, dtype=np.longdouble) - origin, pair.turn_b)
    rays = []
    for (points, faces, _), sign in ((first, -1), (second, 1)):
        rays += [sign * np.cross(points[k[1]] - points[k[0]], points[k[2]] - points[k[0]])[None] for k in faces]
    u, v = (points[edges[:, 1]] - points[edges[:, 0]] for points, _, edges in (first, second))
    across = np.cross(u[:, None], v[None])
    real = (across**2).sum(2) > 1e-26 * (u**2).sum(1)[:, None] * (v**2).sum(1)
    rays += [across[real], -across[real]]
    for (points, _, _), (others, _, edges), sign in ((first, second, 1), (second, first, -1)):
        start, along = others[edges[:, 0]], others[edges[:, 1]] - others[edges[:, 0]]
        square = np.maximum((along**2).sum(1), np.finfo(np.longdouble).tiny)
        away = points[:, None] - start
        where = np.clip((away * along).sum(2) / square, 0, 1)
        away = away - where[..., None] * along
        part = np.where((where > 0) & (where < 1), (away * along).sum(2) / square, 0)
        rays.append(sign * (away - part[..., None] * along).reshape(-1, 3))
    rays = np.concatenate(rays)
    length = np.sqrt((rays**2).sum(1))
    rays = rays[length > 0] / length[length > 0, None]
    found = (first[0] @ rays.T).min(0) - (second[0] @ rays.T).max(0)
    return float(found.max(initial=-np.inf) - pair.a.floats[0] - pair.b.floats[0])


def by_difference(pair):
    """The signed distance of the origin from the hull of all differences of vertices: by its facets (Qhull), or by
    least squares (Lawson & Hanson 1974, least distance programming), which are not precise near 0: None."""
    first = corners(pair.a, pair.at_a, pair.turn_a)[0].astype(float)
    second = corners(pair.b, pair.at_b, pair.turn_b)[0].astype(float)
    differences = (first[:, None] - second).reshape(-1, 3)
    depth = ConvexHull(differences).equations[:, 3].max()
    if 0 < depth < 1e-4 * pair.size:
        return None
    if depth > 0:
        size = np.abs(differences).max()
        rows = np.vstack([differences.T / size, np.ones(len(differences))])
        weights, _ = nnls(rows, np.array([0, 0, 0, 1.0]), maxiter=1000)
        away = rows @ weights - np.array([0, 0, 0, 1.0])
        depth = size * abs(away[3]) / np.linalg.norm(away[:3])
    return depth - pair.a.floats[0] - pair.b.floats[0]


def shape_of(random, size):
    """A ball, capsule, block or polyhedron, rounded or not."""
    radius = size * 0.1 * random.random() if random.random() < 0.3 else 0.0
    kind = random.integers(5)
    if kind == 0:
        return convex.ball(size * random.random())
    if kind == 1:
        return convex.capsule(size * random.normal(size=3), size * random.normal(size=3), radius)
    if kind < 4:
        return convex.box(size * (0.1 + random.random(3)), radius)
    return convex.hull(size * random.normal(size=(random.integers(4, 14), 3)), radius)


def pair_of(seed, solid=False):
    """Two shapes of any size: turned alike, almost alike or not; overlapping, apart, or moved to any small gap."""
    random = np.random.default_rng(seed)
    size = 10.0 ** random.uniform(-3, 3)
    a, b = shape_of(random, size), shape_of(random, size * 10.0 ** random.uniform(-0.5, 0.5))
    while solid and min(a.ints[1], b.ints[1]) == 0:
        a, b = shape_of(random, size), shape_of(random, size * 10.0 ** random.uniform(-0.5, 0.5))
    first, alike = random.normal(size=4), random.integers(4)
    second = first if alike == 0 else first + 10.0 ** random.uniform(-16, -2) * random.normal(size=4)
    if alike > 1:
        second = random.normal(size=4)
    if random.random() < 0.3:
        first = second = np.array(UPRIGHT)
    away = random.normal(size=3)
    away = np.round(away) if random.random() < 0.4 and np.round(away).any() else away
    if alike < 2 and random.random() < 0.4:
        away = rotation_matrix(first) @ away
    at = size * random.normal(size=3)
    apart = (a.floats[1] + b.floats[1]) * random.uniform(0, 1.3) / np.linalg.norm(away)
    pair = Pair(a, at, first, b, at + apart * away, second)
    if random.random() < 0.5:
        wanted = size * 10.0 ** random.uniform(-16, -1) * random.choice([-1, 0, 1])
        for _ in range(6):
            found, normal, _, _ = pair.gap()
            pair = pair._replace(at_b=pair.at_b + normal * (found - wanted))
    return pair


SQRT2, SQRT3 = math.sqrt(2.0), math.sqrt(3.0)
LONG = convex.capsule([-1, 0, 0], [1, 0, 0], 0.1)
BALL = convex.ball(0.5)
FORMULAS = {
    "balls": (Pair(BALL, (3, 4, 0), UPRIGHT, convex.ball(1.5)), 3.0, (0.6, 0.8, 0)),
    "balls that overlap": (Pair(BALL, (0.3, 0.4, 0), UPRIGHT, BALL), -0.5, (0.6, 0.8, 0)),
    "ball over a face": (Pair(BALL, (0.2, 1.5, 0.1), UPRIGHT, CUBE), 0.5, (0, 1, 0)),
    "ball over an edge": (Pair(BALL, (1.5, 1.5, 0.1), UPRIGHT, CUBE), SQRT2 - 0.5, (SQRT2 / 2, SQRT2 / 2, 0)),
    "ball over a vertex": (Pair(BALL, (1.5, 1.5, 1.5), UPRIGHT, CUBE), SQRT3 - 0.5, (SQRT3 / 3,) * 3),
    "ball within": (Pair(BALL, (0.1, 0.3, 0), UPRIGHT, CUBE), -0.7, (0, 1, 0)),
    "faces": (Pair(CUBE, (0.3, 1.25, -0.2), UPRIGHT, CUBE), 0.25, (0, 1, 0)),
    "faces that touch": (Pair(CUBE, (0.3, 1, -0.2), UPRIGHT, CUBE), 0.0, (0, 1, 0)),
    "faces that overlap": (Pair(CUBE, (0.3, 0.75, -0.2), UPRIGHT, CUBE), -0.25, (0, 1, 0)),
    "crossed planks": (
        Pair(convex.box([2, 0.1, 0.2]), (0, 0.5, 0), UPRIGHT, convex.box([0.2, 0.1, 2])),
        0.3,
        (0, 1, 0),
    ),
    "parallel edges": (Pair(CUBE, (1.5, 1.5, 0.3), UPRIGHT, CUBE), SQRT2 / 2, (SQRT2 / 2, SQRT2 / 2, 0)),
    "vertices": (Pair(CUBE, (1.5, 1.5, 1.5), UPRIGHT, CUBE), SQRT3 / 2, (SQRT3 / 3,) * 3),
    "crossed edges": (
        Pair(CUBE, (0, 1.5, 0), turn([0, 0, 1], math.pi / 4), CUBE, (0, 0, 0), turn([1, 0, 0], math.pi / 4)),
        1.5 - SQRT2,
        (0, 1, 0),
    ),
    "crossed edges that overlap": (
        Pair(CUBE, (0, 1.25, 0), turn([0, 0, 1], math.pi / 4), CUBE, (0, 0, 0), turn([1, 0, 0], math.pi / 4)),
        1.25 - SQRT2,
        (0, 1, 0),
    ),
    "vertex over a face": (
        Pair(CUBE, (0.1, 1.5, 0.2), turn([1, 0, -1], math.atan(SQRT2)), CUBE),
        1.0 - SQRT3 / 2,
        (0, 1, 0),
    ),
    "capsule along a face": (Pair(LONG, (0, 0.75, 0), UPRIGHT, CUBE), 0.15, (0, 1, 0)),
    "crossed capsules": (Pair(LONG, (0, 0.75, 0), turn([0, 1, 0], 1.0), LONG), 0.55, (0, 1, 0)),
    "parallel capsules": (Pair(LONG, (0.5, 0.75, 0), UPRIGHT, LONG), 0.55, (0, 1, 0)),
    "capsules in a line": (Pair(LONG, (2.5, 0, 0), UPRIGHT, LONG), 0.3, (1, 0, 0)),
    "cube over the floor": (Pair(CUBE, (7, 0.75, 3), UPRIGHT, FLOOR), 0.25, (0, 1, 0)),
    "edge in the floor": (Pair(CUBE, (7, 0.5, 3), turn([0, 0, 1], math.pi / 4), FLOOR), 0.5 - SQRT2 / 2, (0, 1, 0)),
    "rounded cubes": (
        Pair(convex.box([0.4] * 3, 0.1), (1.5, 1.5, 1.5), UPRIGHT, convex.box([0.4] * 3, 0.1)),
        0.7 * SQRT3 - 0.2,
        (SQRT3 / 3,) * 3,
    ),
}


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("name", FORMULAS)
def test_gaps_are_those_of_formulas(name, scale):
    pair, expected, normal = FORMULAS[name]
    shapes = []
    for shape in (pair.a, pair.b):
        floats = shape.floats.copy()
        lengths = 2 + 3 * shape.ints[0] if shape.kind == convex.CORE else 2
        floats[:lengths] *= scale
        shapes.append(convex.Convex(shape.kind, floats, shape.ints))
    scaled = Pair(shapes[0], scale * np.array(pair.at_a), pair.turn_a, shapes[1], pair.at_b, pair.turn_b)
    for one, sign in ((scaled, 1), (scaled.swapped(), -1)):
        found, along, on_a, on_b = one.gap()
        assert abs(found - scale * expected) <= 4 * EPS * scaled.size
        np.testing.assert_allclose(along, sign * np.array(normal), rtol=0, atol=1e-15)
        np.testing.assert_allclose(on_a - on_b, found * along, rtol=0, atol=8 * EPS * scaled.size)


def test_of_lines_and_points_at_one_place_the_gap_is_minus_the_radii():
    for first, second in product((BALL, LONG), repeat=2):
        for rotation in (UPRIGHT, turn([0, 1, 0], 0.4)):
            found, normal, on_a, on_b = Pair(first, (0, 0, 0), rotation, second).gap()
            assert found == -first.floats[0] - second.floats[0]
            assert np.linalg.norm(normal) == pytest.approx(1.0, abs=4 * EPS)
            np.testing.assert_allclose(on_a - on_b, found * normal, atol=4 * EPS)


@settings(max_examples=COUNT)
@given(SEEDS)
@example(17992)
def test_gaps_are_the_largest_separation_of_all_directions_of_features(seed):
    pair = pair_of(seed)
    found, normal, on_a, on_b = pair.gap()
    assert abs(found - largest_separation(pair)) <= 8 * EPS * pair.size
    assert abs(np.linalg.norm(normal) - 1) <= 8 * EPS
    assert abs(pair.swapped().gap()[0] - found) <= 8 * EPS * pair.size
    if found + pair.a.floats[0] + pair.b.floats[0] > 1e-13 * pair.size:
        np.testing.assert_allclose(on_a - on_b, found * normal, rtol=0, atol=1e-13 * pair.size)


@settings(max_examples=COUNT)
@given(SEEDS)
@example(1686209987)
def test_gaps_are_right_where_features_are_parallel_or_at_one_place(seed):
    random = np.random.default_rng(seed)

    def shape():
        half = random.integers(1, 4, size=3) / 4
        kind = random.integers(5)
        if kind == 0:
            return convex.capsule(-half, half * random.integers(0, 2, size=3), 0.0)
        if kind == 1:
            return convex.hull(np.vstack([np.diag(half), -np.diag(half)]))
        return convex.ball(0.0) if kind == 2 else convex.box(half)

    def rotation():
        axis = random.integers(-1, 2, size=3)
        return turn(axis if axis.any() else [0, 0, 1], math.pi / 4 * random.integers(-4, 5))

    a, b, first, second = shape(), shape(), rotation(), rotation()
    away = random.integers(-6, 7, size=3) / 4
    pair = Pair(a, (0, 0, 0), first, b, away, second if random.random() < 0.6 else first)
    found, normal, on_a, on_b = pair.gap()
    expected = largest_separation(pair)
    # Cores of no thickness that meet are not apart along any of these directions.
    if np.isfinite(expected) and (min(a.ints[1], b.ints[1]) > 0 or expected > 0):
        assert abs(found - expected) <= 8 * EPS * pair.size
    if found > -1e-12:
        np.testing.assert_allclose(on_a - on_b, found * normal, rtol=0, atol=8 * EPS * pair.size)
    least, _, points, names = pair.manifold(found + 0.1)
    assert least == found
    assert len(np.unique(names, axis=0)) == len(points)
    assert abs(points[:, 6].min() - found) <= 16 * EPS * pair.size


@settings(max_examples=COUNT)
@given(SEEDS)
def test_gaps_are_the_distance_of_the_origin_from_the_hull_of_differences(seed):
    pair = pair_of(seed, solid=True)
    expected = by_difference(pair)
    assume(expected is not None)
    assert abs(pair.gap()[0] - expected) <= 1e-8 * pair.size


@settings(max_examples=COUNT)
@given(SEEDS)
def test_a_common_motion_changes_nothing_and_a_shift_changes_the_gap_by_no_more_than_its_length(seed):
    pair, random = pair_of(seed), np.random.default_rng([seed, 1])
    found, normal, _, _ = pair.gap()
    quaternion, shift = random.normal(size=4), pair.size * random.normal(size=3)
    matrix = rotation_matrix(quaternion)

    def turned(q):
        (a, *u), (b, *v) = quaternion, q
        return np.array([a * b - np.dot(u, v), *(a * np.array(v) + b * np.array(u) + np.cross(u, v))])

    at_a, at_b = (matrix @ at + shift for at in (pair.at_a, pair.at_b))
    moved = Pair(pair.a, at_a, turned(pair.turn_a), pair.b, at_b, turned(pair.turn_b))
    assert abs(moved.gap()[0] - found) <= 64 * EPS * moved.size
    way = random.normal(size=3) * pair.size * 10.0 ** random.uniform(-14, 0)
    shifted = pair._replace(at_b=pair.at_b + way)
    change, along = found - shifted.gap()[0], way @ normal
    assert abs(change) <= np.linalg.norm(way) + 16 * EPS * shifted.size
    # Apart, the distance is a convex function: it stays above its tangent.
    if found + pair.a.floats[0] + pair.b.floats[0] > 1e-6 * pair.size:
        assert change <= along + 1e-9 * shifted.size


def test_a_hull_joins_the_triangles_of_a_plane_and_drops_points_on_edges():
    grid = np.array(list(product([-1.0, 0.0, 1.0], repeat=3)))
    matrix = rotation_matrix([0.3, 0.5, -0.2, 0.9])
    for points in (grid, grid @ matrix.T):
        shape = convex.hull(points)
        assert list(shape.ints[:4]) == [8, 6, 12, 24]
        assert shape.floats[1] == pytest.approx(SQRT3)
        pair = Pair(shape, (0, 5, 0), UPRIGHT, convex.box([1, 1, 1]))
        assert pair.gap()[0] == pytest.approx(4 + points[:, 1].min(), abs=4 * EPS * pair.size)
    with pytest.raises(ValueError, match="lie in a plane"):
        convex.hull(grid[:9])


@pytest.mark.parametrize("rotation", [UPRIGHT, (0.3, 0.5, -0.2, 0.9)], ids=["upright", "turned"])
def test_cubes_of_a_stack_touch_at_four_points_each_with_no_gap(rotation):
    up, bound = rotation_matrix(rotation) @ [0, 1, 0], 1e-15 if rotation is UPRIGHT else 8e-15
    for level in range(10):
        pair = Pair(CUBE, up * (level + 1.5), rotation, CUBE, up * (level + 0.5), rotation)
        least, normal, points, names = pair.manifold(1e-3)
        assert len(points) == 4
        assert len(np.unique(names, axis=0)) == 4
        assert max(abs(least), np.abs(points[:, 6]).max()) <= bound
        np.testing.assert_allclose(normal, up, atol=4e-16)
        spread = (points[:, :3] - up * (level + 1)) @ rotation_matrix(rotation)
        np.testing.assert_allclose(np.abs(spread), [[0.5, 0, 0.5]] * 4, atol=bound + 1e-14)
    least, normal, points, _ = Pair(CUBE, up / 2, rotation, convex.half_space(up, 0.0)).manifold(1e-3)
    assert len(points) == 4
    assert np.abs(points[:, 6]).max() <= bound


COUNTS = {
    "twisted cubes": (Pair(CUBE, (0, 1, 0), turn([0, 1, 0], math.pi / 4), CUBE), 8),
    "cubes that overlap in part": (Pair(CUBE, (0.75, 1, 0.5), UPRIGHT, CUBE), 4),
    "crossed planks": (FORMULAS["crossed planks"][0]._replace(at_a=(0, 0.2, 0)), 4),
    "edge over a face": (Pair(CUBE, (0, 0.5 + SQRT2 / 2, 0), turn([0, 0, 1], math.pi / 4), CUBE), 2),
    "capsule along a face": (Pair(LONG, (0, 0.6, 0), UPRIGHT, CUBE), 2),
    "capsule on the floor": (Pair(LONG, (0, 0.1, 0), UPRIGHT, FLOOR), 2),
    "parallel capsules": (Pair(LONG, (0.5, 0.2, 0), UPRIGHT, LONG), 2),
    "ridge on ridge": (
        Pair(
            CUBE,
            (0.25, SQRT2, 0.0),
            turn([1, 0, 0], math.pi / 4),
            convex.capsule([-1, SQRT2 / 2, 0], [1, SQRT2 / 2, 0], 0.0),
        ),
        2,
    ),
    "crossed edges": (FORMULAS["crossed edges"][0]._replace(at_a=(0, SQRT2, 0)), 1),
    "crossed capsules": (Pair(LONG, (0, 0.2, 0), turn([0, 1, 0], 1.0), LONG), 1),
    "ball on a face": (Pair(BALL, (0.1, 1, 0.2), UPRIGHT, CUBE), 1),
    "balls": (Pair(BALL, (0, 1, 0), UPRIGHT, BALL), 1),
    "vertex over a face": (FORMULAS["vertex over a face"][0]._replace(at_a=(0.1, 0.5 + SQRT3 / 2, 0.2)), 1),
}


@pytest.mark.parametrize("name", COUNTS)
def test_the_points_of_a_pair_are_as_many_as_its_features_have_corners(name):
    pair, count = COUNTS[name]
    for one in (pair, pair.swapped()):
        least, _, points, names = one.manifold(1e-6)
        assert len(points) == count
        assert len(np.unique(names, axis=0)) == count
        assert abs(least) <= 8 * EPS * one.size
        assert np.abs(points[:, 6]).max() <= 16 * EPS * one.size


def test_of_many_corners_eight_are_kept_that_span_the_rest_and_the_lowest():
    angles = 2 * math.pi * np.arange(40) / 40
    rim = np.column_stack([np.cos(angles), 0 * angles, np.sin(angles)])
    drum = convex.hull(np.concatenate([rim + np.array([0, 0.3, 0]), rim - np.array([0, 0.3, 0])]))
    for b, top in ((FLOOR, 0.0), (drum, 0.3)):
        least, _, points, names = Pair(drum, (0, top + 0.3 + 1e-5, 0), turn([0.3, 0, 1], 1e-5), b).manifold(1e-3)
        assert len(points) == len(np.unique(names, axis=0)) == MOST
        assert points[:, 6].min() == pytest.approx(least, abs=1e-15)
        assert ConvexHull(points[:, [0, 2]]).volume > 2.5


@settings(max_examples=COUNT)
@given(SEEDS)
@example(1812)
def test_points_of_a_pair_lie_on_both_bodies_and_the_least_gap_is_among_them(seed):
    pair, random = pair_of(seed), np.random.default_rng([seed, 2])
    found, normal, _, _ = pair.gap()
    margin = found + pair.size * 10.0 ** random.uniform(-12, -1)
    least, along, points, names = pair.manifold(margin)
    assert least == found
    np.testing.assert_array_equal(along, normal)
    assert 1 <= len(points) <= MOST
    assert len(np.unique(names, axis=0)) == len(points)
    assert abs(points[:, 6].min() - found) <= 1e-13 * pair.size
    assert points[:, 6].max() <= margin + 1e-15 * pair.size
    np.testing.assert_allclose(
        points[:, :3] - points[:, 3:6], points[:, 6:] * normal, rtol=0, atol=16 * EPS * pair.size
    )
    # Edges that are almost parallel share their ends.
    within = 1e-6 if (names[:, 0] >> 60 == TWO_LINES).any() else 1e-13
    # Of rounded bodies the points are those of their cores, shifted along the normal.
    for shape, at, rotation, on, sign in (
        (pair.a, pair.at_a, pair.turn_a, points[:, :3], 1),
        (pair.b, pair.at_b, pair.turn_b, points[:, 3:6], -1),
    ):
        core = convex.Convex(shape.kind, np.concatenate([[0.0], shape.floats[1:]]), shape.ints)
        for point in on + sign * shape.floats[0] * normal:
            assert Pair(core, at, rotation, convex.ball(0.0), point).gap()[0] <= within * pair.size
    assert len(pair.manifold(found - 1e-6 * pair.size)[2]) == 0


def test_points_keep_their_names_while_a_body_slides_and_rocks():
    known = None
    for k in range(50):
        at = (0.2 + 1e-3 * k, 1 + 1e-7 * math.sin(k), 0.1)
        pair = Pair(CUBE, at, turn([0.3, 1, 0.1], 0.3), CUBE, (0, 0, 0), turn([0.3, 1, 0.1], 0.3))
        names = pair.manifold(0.1)[3]
        if known is not None:
            assert names.tolist() == known
        known = names.tolist()


def touch(pair, motion_a, motion_b, h, margin=0.0, tolerance=1e-12):
    floats, ints, a, b, places, at_a, at_b, room = pair.arguments
    motions = np.concatenate([motion_a, motion_b]).astype(float)
    return first_touch(floats, ints, a, b, places, at_a, at_b, motions, 0, 6, h, margin, tolerance, room)


STILL = (0,) * 6
WALL = convex.box([5e-4, 5, 5])


@pytest.mark.parametrize("start", [-0.3, -0.987654, -5.0])
def test_a_ball_of_5_cm_at_500_m_s_never_misses_a_wall_of_1_mm(start):
    pair = Pair(convex.ball(0.05), (start, 0.1, 0.2), UPRIGHT, WALL)
    expected = (-start - 0.05 - 5e-4) / 500
    for h in (0.02, 1.0, 1e3):
        assert touch(pair, (500, 0, 0, 0, 0, 0), STILL, h) == pytest.approx(expected, rel=1e-12)
    assert touch(pair, (500, 0, 0, 0, 0, 0), STILL, 0.99 * expected) == math.inf
    assert touch(pair, (-500, 0, 0, 0, 0, 0), STILL, 1e3) == math.inf
    fast = touch(pair, (500, 1, -2, 40, 3, 900), (20, 1, -2, 0, 0, 0), 1.0)
    assert fast == pytest.approx(expected * 500 / 480, rel=1e-9)


@pytest.mark.parametrize("spin", [(0, 0, 0), (3e3, -2e3, 1e3)], ids=["straight", "spinning"])
def test_a_box_of_1_cm_at_500_m_s_never_misses_a_wall_of_1_mm(spin):
    pair = Pair(convex.box([0.005] * 3), (-0.4, 0.1, 0.2), UPRIGHT, WALL)
    found = touch(pair, (500, 0, 0, *spin), STILL, 1.0)
    rotation = turn(spin, np.linalg.norm(spin) * found) if any(spin) else UPRIGHT
    assert abs(pair._replace(at_a=(-0.4 + 500 * found, 0.1, 0.2), turn_a=rotation).gap()[0]) <= 2e-12
    reach = 0.005 * SQRT3 if any(spin) else 0.005
    assert (0.4 - 5e-4 - reach) / 500 <= found * (1 + 1e-12) <= (0.4 - 5e-4 - 0.005) / 500 * (1 + 1e-11)


def test_a_cube_that_spins_past_a_wall_touches_it_with_its_edge_when_it_is_turned_so():
    # The face is 0.6 m from the wall, and the edge reaches 0.707 m out: at cos(angle - 45 degrees) = 0.6 sqrt(2).
    pair = Pair(CUBE, (0, 0, 0), UPRIGHT, FLOOR, (0, -0.6, 0))
    expected = (math.pi / 4 - math.acos(0.6 * SQRT2)) / 30
    found = touch(pair, (200, 0, 0, 0, 0, 30), STILL, 1.0)
    assert found <= expected
    assert found == pytest.approx(expected, rel=1e-10)
    pair = pair._replace(at_b=(0, -SQRT2 / 2 - 1e-6, 0))
    assert touch(pair, (200, 0, 0, 0, 0, 30), STILL, 1.0) == math.inf
    assert touch(pair, (200, 0, 0, 0, 0, 30), STILL, 1.0, margin=2e-6, tolerance=1e-9) < 0.03


@pytest.mark.parametrize("end", [0.02, 0.05])
def test_a_crate_that_leaves_a_plank_with_which_it_turns_does_not_touch_it(end):
    # Along a direction that stands, the plank's far end comes nearer by 0.2 m/s: it takes a thousand advances.
    spin, away = 0.07244348367272054, 2.4851e-3
    pair = Pair(convex.box([1.5, 0.04, 0.25]), (0, 0.55, 0), UPRIGHT, convex.box([0.15] * 3), (-1.3, 0.74, 0))
    motion = (-spin * 0.19, -spin * 1.3 + away, 0, 0, 0, spin)
    assert touch(pair, (0, 0, 0, 0, 0, spin), motion, end, -2.6e-10, 2.6e-11) == math.inf
    assert touch(pair, (0, 0, 0, 0, 0, spin), (*motion[:1], motion[1] - 2 * away, *motion[2:]), end) < 1e-12


@settings(max_examples=max(20, COUNT // 5))
@given(SEEDS)
@example(7)
def test_the_first_touch_is_never_later_than_dense_samples_tell(seed):
    random = np.random.default_rng(seed)
    a, b = shape_of(random, 1.0), shape_of(random, 1.0)
    away = 3 * random.normal(size=3)
    motions = [np.concatenate([random.normal(size=3), 5 * random.normal(size=3)]) for _ in range(2)]
    motions[1][:3] -= away * random.uniform(0.3, 1.2)
    pair, h, margin = Pair(a, (0, 0, 0), random.normal(size=4), b, away, random.normal(size=4)), 1.0, 0.01

    def at(t):
        def placed(x, q, motion):
            rate = np.linalg.norm(motion[3:])
            (c, *u), (d, *v) = turn(motion[3:], rate * t), q
            return np.array(x) + t * motion[:3], [
                c * d - np.dot(u, v),
                *(c * np.array(v) + d * np.array(u) + np.cross(u, v)),
            ]

        return Pair(
            a, *placed(pair.at_a, pair.turn_a, motions[0]), b, *placed(pair.at_b, pair.turn_b, motions[1])
        ).gap()[0]

    found = touch(pair, *motions, h, margin, 1e-10)
    if found < math.inf:
        assert 0 <= found <= h
        assert at(found) <= margin + 1e-9
    for t in np.linspace(0, min(found, h), 400, endpoint=False) if found > 0 else ():
        assert at(t) >= margin - 1e-12


@settings(max_examples=max(20, COUNT // 5))
@given(SEEDS)
def test_pairs_of_boxes_are_those_that_meet_in_ascending_order(seed):
    random = np.random.default_rng(seed)
    n = int(random.integers(0, 60))
    middle, half = random.integers(-4, 5, size=(n, 3)) * 1.0, random.integers(0, 3, size=(n, 3)) * 0.5
    boxes = np.hstack([middle - half, middle + half])
    boxes[random.random(n) < 0.05] = [-np.inf] * 3 + [np.inf] * 3
    expected = [
        [i, j]
        for i in range(n)
        for j in range(i + 1, n)
        if (boxes[i, :3] <= boxes[j, 3:]).all() and (boxes[j, :3] <= boxes[i, 3:]).all()
    ]
    pairs = np.full((len(expected), 2), -1)
    assert near_pairs(boxes.ravel(), pairs) == len(expected)
    assert pairs.tolist() == expected
    if expected:
        short = np.full((len(expected) - 1, 2), -1)
        assert near_pairs(boxes.ravel(), short) == len(expected)
        assert (short == -1).all()


@settings(max_examples=max(20, COUNT // 5))
@given(SEEDS)
def test_a_swept_box_holds_the_shape_at_all_times(seed):
    random = np.random.default_rng(seed)
    shape, motion, h = shape_of(random, 1.0), random.normal(size=6), random.uniform(0, 3)
    place = np.concatenate([random.normal(size=3), random.normal(size=4)])
    floats, ints = convex.joined([shape])
    box, room = np.empty(BOX), np.empty(convex.room_length([shape]))
    swept_box(floats, ints, 0, place, 0, motion, 0, h, 0.01, room, box, 0)
    radius = shape.floats[0] + 0.01
    for t in np.linspace(0, h, 50):
        (c, *u), (d, *v) = turn(motion[3:], np.linalg.norm(motion[3:]) * t), place[3:]
        turned = [c * d - np.dot(u, v), *(c * np.array(v) + d * np.array(u) + np.cross(u, v))]
        points = corners(shape, place[:3] + t * motion[:3], turned)[0]
        assert (points.min(0) - radius >= box[:3]).all()
        assert (points.max(0) + radius <= box[3:]).all()
