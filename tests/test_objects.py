"""Laws of objects: their fields say where they are, their boxes hold them, and what is drawn is what the field says."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from moment import IDENTITY, FakeMoment, capsule, const, drawn, fields_of, formula, link
from sceneql.failure import RunFailure
from sceneql.field.skeleton.skeleton import Skeleton
from sceneql.kinds import Ref
from sceneql.shapes.density import reaches
from sceneql.shapes.placement import affine, apply, compose, inverse, mapped_box, rotation_matrix
from sceneql.words.objects.blobby import Blobby
from sceneql.words.objects.box import Box
from sceneql.words.objects.cylinder import Cylinder
from sceneql.words.objects.difference import Difference
from sceneql.words.objects.group import Group
from sceneql.words.objects.implicit import Implicit, Within
from sceneql.words.objects.intersection import Intersection
from sceneql.words.objects.plane import Plane
from sceneql.words.objects.sphere import Sphere
from sceneql.words.objects.torus import Torus
from sceneql.words.objects.tube import Tube
from sceneql.words.objects.union import Union

TURN = (0.8, 0.3, -0.4, 0.33)
AT = (0.2, -0.1, 0.3)
PLACED = {"position": const(AT), "rotation": const(TURN)}


def own(points):
    """Points in the coordinates of an object placed by PLACED."""
    return apply(inverse(affine(AT, TURN)), points)


def column(p, radius, height):
    return (np.hypot(p[:, 0], p[:, 2]) < radius) & (np.abs(p[:, 1]) < height / 2)


PATH = np.array([[-0.8, 0.0, 0.1], [0.1, 0.5, 0.0], [0.6, -0.3, 0.2], [0.6, -0.3, 0.2]])
GYROID = "abs(sin(4*x)*cos(4*y) + sin(4*y)*cos(4*z) + sin(4*z)*cos(4*x))"


def gyroid(p):
    x, y, z = 4 * p.T
    value = np.abs(np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x))
    return (value < 0.5) & (np.linalg.norm(p, axis=1) < 1.2)


def blob_density(p, points, pairs, radii, weights):
    parts = [(points[i], points[j], (radii[i] + radii[j]) / 2, (weights[i] + weights[j]) / 2) for i, j in pairs]
    used = {k for pair in pairs for k in pair}
    parts += [(points[k], points[k], radii[k], weights[k]) for k in range(len(points)) if k not in used]
    total = np.zeros(len(p))
    for a, b, radius, weight in parts:
        total += weight * np.maximum(0, 1 - (capsule(p, a, b) / radius) ** 2) ** 3
    return total


SKELETON = np.array([[-0.5, 0, 0], [0.4, 0.1, 0], [0.5, 0.6, 0.1], [0.0, 0.1, 0.4]])
RADII, WEIGHTS = np.array([0.5, 0.6, 0.4, 0.35]), np.array([1.0, 1.2, 1.0, -0.7])

SOLIDS = {
    "sphere": (Sphere(radius=const(0.7), **PLACED), lambda p: np.linalg.norm(own(p), axis=1) < 0.7),
    "box": (
        Box(size=const([1.0, 0.6, 1.4]), **PLACED),
        lambda p: (np.abs(own(p)) < [0.5, 0.3, 0.7]).all(axis=1),
    ),
    "cylinder": (Cylinder(radius=const(0.4), height=const(0.9), **PLACED), lambda p: column(own(p), 0.4, 0.9)),
    "torus": (
        Torus(radius=const(0.7), tube=const(0.25), **PLACED),
        lambda p: _near_circle(own(p), 0.7) < 0.25,
    ),
    "implicit": (
        Implicit(field=formula(GYROID), level=0.5, unit=0.7, bounds=Within(ball=1.2), **PLACED),
        lambda p: gyroid(own(p) / 0.7),
    ),
    "blobby": (
        Blobby(
            points=const(SKELETON), segments=((0, 1), (1, 2)), radius=const(RADII), weight=const(WEIGHTS), threshold=0.2
        ),
        lambda p: blob_density(p, SKELETON, [(0, 1), (1, 2)], RADII, WEIGHTS) > 0.2,
    ),
    "tube": (
        Tube(through=const(PATH), radius=const(0.2)),
        lambda p: np.min([capsule(p, a, b) for a, b in pairwise(PATH)], axis=0) < 0.2,
    ),
}


def _near_circle(p, radius):
    angle = np.arctan2(p[:, 2], p[:, 0])
    nearest = radius * np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
    return np.linalg.norm(p - nearest, axis=1)


def cloud(count=4000, seed=1, half=1.6):
    return np.random.default_rng(seed).uniform(-half, half, (count, 3))


@pytest.mark.parametrize("word", SOLIDS)
def test_field_is_negative_inside_and_positive_outside(word):
    thing, inside = SOLIDS[word]
    points = cloud()
    expected = inside(points)
    assert 20 < expected.sum() < len(points) - 20
    np.testing.assert_array_equal(fields_of(thing, FakeMoment(), points) < 0, expected)


@pytest.mark.parametrize("word", ["sphere", "box", "cylinder", "torus", "blobby", "tube"])
def test_field_rises_through_the_surface_about_as_a_distance_does(word):
    thing, _ = SOLIDS[word]
    moment, points = FakeMoment(), cloud(20000)
    value = fields_of(thing, moment, points)
    points = points[np.abs(value) < 0.03]
    step = 1e-5
    gradient = np.column_stack(
        [(fields_of(thing, moment, points + step * e) - fields_of(thing, moment, points - step * e)) for e in np.eye(3)]
    ) / (2 * step)
    slope = np.linalg.norm(gradient, axis=1)
    assert len(slope) > 50
    if word == "blobby":
        assert (slope > 0.2).mean() > 0.97
        assert (slope < 3).all()
    else:
        np.testing.assert_allclose(slope, 1.0, rtol=1e-6)


@pytest.mark.parametrize("word", SOLIDS)
def test_extent_contains_the_solid_and_is_near_it(word):
    thing, inside = SOLIDS[word]
    place = affine((0.3, 0.1, -0.2), (0.5, -0.5, 0.2, 0.6), 1.3)
    low, high = thing.extent(place, FakeMoment())
    points = cloud(20000)
    solid = apply(place, points[inside(points)])
    assert (solid >= low).all()
    assert (solid <= high).all()
    # A box of a box may be larger than the solid, but not by much more than the turning costs.
    assert ((high - low) < 2.2 * np.ptp(solid, axis=0)).all()


UNEVEN = (1.3, 0.7, 0.9)


@pytest.mark.parametrize(
    ("word", "scale"), [(w, s) for w in SOLIDS for s in (1.0, 0.6, UNEVEN) if (w, s) != ("tube", UNEVEN)]
)
def test_what_a_group_draws_is_the_child_under_the_groups_matrix(word, scale):
    thing, inside = SOLIDS[word]
    position, turn = (0.5, 0.2, -0.4), (0.9, 0.1, 0.5, -0.2)
    group = Group(children=(Ref("thing"),), position=const(position), rotation=const(turn), scale=const(scale))
    moment, place = FakeMoment(parts={"thing": thing}), affine((0.1, 0, 0), (1, 0, 0.2, 0), 1.1)
    points = cloud(6000, seed=3)
    matrix = np.vstack([compose(place, affine(position, turn, scale)), [0, 0, 0, 1]])
    inner = (np.linalg.inv(matrix) @ np.column_stack([points, np.ones(len(points))]).T).T[:, :3]
    assert inside(inner).sum() > 10
    np.testing.assert_array_equal(drawn(group.lower("group", place, moment), points), inside(inner))
    field = fields_of(group, moment, apply(inverse(place), points))
    np.testing.assert_array_equal(field < 0, inside(inner))


def test_a_stretched_tube_is_refused():
    thing, _ = SOLIDS["tube"]
    with pytest.raises(ValueError, match="unevenly"):
        list(thing.lower("tube", affine((0, 0, 0), (1, 0, 0, 0), (1, 2, 1)), FakeMoment()))


@pytest.mark.parametrize(
    ("kind", "rule"),
    [(Union, np.any), (Intersection, np.all), (Difference, lambda m, axis: m[0] & ~m[1:].any(axis=axis))],
)
def test_set_operations_are_the_boolean_ones_of_their_members(kind, rule):
    parts = {"a": SOLIDS["sphere"][0], "b": SOLIDS["box"][0], "c": SOLIDS["torus"][0]}
    if kind is Intersection:
        parts["c"] = Plane(height=const(0.1), normal=const([0.3, 1.0, 0.1]))
    thing = kind(of={name: Ref(name) for name in parts}, **PLACED)
    moment, points = FakeMoment(parts=parts), cloud(6000)
    members = np.array([fields_of(part, moment, own(points)) < 0 for part in parts.values()])
    expected = rule(members, axis=0)
    assert 20 < expected.sum() < 5900
    np.testing.assert_array_equal(fields_of(thing, moment, points) < 0, expected)
    np.testing.assert_array_equal(drawn(thing.lower("csg", IDENTITY, moment), points), expected)
    low, high = thing.extent(IDENTITY, moment)
    assert ((points[expected] >= low) & (points[expected] <= high)).all()


def test_an_empty_intersection_draws_nothing_and_an_unbounded_one_is_refused():
    far = {"a": Sphere(position=const([5, 0, 0])), "b": Sphere()}
    both = Intersection(of=(Ref("a"), Ref("b")))
    assert not list(both.lower("both", IDENTITY, FakeMoment(parts=far)))
    with pytest.raises(TypeError, match="unbounded"):
        list(Union(of=(Ref("a"), Ref("b"))).lower("both", IDENTITY, FakeMoment(parts={"a": Plane(), "b": Sphere()})))


def test_set_operations_need_two_members():
    with pytest.raises(ValueError, match="at least two"):
        Union(of=(Ref("a"),))


def test_plane_is_the_half_space_below_it():
    plane = Plane(height=const(0.2), position=const([0, 0.3, 0]), normal=const([0, 2.0, 0]))
    points = cloud()
    np.testing.assert_allclose(fields_of(plane, FakeMoment(), points), points[:, 1] - 0.5, atol=1e-12)
    place = affine((0, 0.4, 0), TURN, (1.0, 1.5, 0.8))
    shapes = list(plane.lower("floor", place, FakeMoment()))
    np.testing.assert_array_equal(drawn(shapes, points), apply(inverse(place), points)[:, 1] < 0.5)
    low, high = plane.extent(affine((0, 0.4, 0), (1, 0, 0, 0), 2.0), FakeMoment())
    assert high[1] == pytest.approx(1.4)
    assert np.isinf(low).all()


def test_formula_depends_on_time_links_and_keeps_outside_what_is_undefined():
    ball = Implicit(field=formula("x^2 + y^2 + z^2 - t"), bounds=Within(ball=2.0))
    points = cloud()
    np.testing.assert_array_equal(fields_of(ball, FakeMoment(time=0.6), points) < 0, (points**2).sum(axis=1) < 0.6)
    dome = Implicit(field=formula("sqrt(y) - 1"), bounds=Within(box=((-1, -1, -1), (1, 1, 1))))
    expected = (np.abs(points) < 1).all(axis=1) & (points[:, 1] > 0)
    np.testing.assert_array_equal(fields_of(dome, FakeMoment(), points) < 0, expected)


def test_a_formula_that_is_no_number_is_refused_when_checked():
    with pytest.raises(ValueError, match="one number"):
        Implicit(field=formula("2*[x, y, z]"))


def test_vectors_may_stand_inside_a_formula():
    thing = Implicit(
        field=formula("length([x, 2*y, z]) + dot([x, y, z], [0.1, 0, 0])"), level=0.8, bounds=Within(ball=2)
    )
    x, y, z = (points := cloud()).T
    expected = np.sqrt(x * x + 4 * y * y + z * z) + 0.1 * x < 0.8
    np.testing.assert_array_equal(fields_of(thing, FakeMoment(), points) < 0, expected)


def radius_along_x(thing):
    """Where the field changes its sign on the positive x-axis."""
    low, high = 0.0, 2.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if fields_of(thing, FakeMoment(), [[middle, 0, 0]])[0] < 0 else (low, middle)
    return low


def test_lone_blob_has_the_known_radius_and_a_tight_box():
    thing = Blobby(points=const([[0, 0, 0]]), radius=const(1.0), threshold=0.3)
    assert radius_along_x(thing) == pytest.approx(0.5749496064, abs=2e-10)
    _, high = thing.extent(IDENTITY, FakeMoment())
    np.testing.assert_allclose(high, 0.5749496064, atol=2e-10)


def test_two_blobs_merge_at_the_known_distance():
    def middle(apart):
        thing = Blobby(points=const([[-apart / 2, 0, 0], [apart / 2, 0, 0]]), radius=const(1.0), threshold=0.3)
        return fields_of(thing, FakeMoment(), [[0.0, 0, 0]])[0]

    assert middle(1.3691905863 - 1e-9) < 0 < middle(1.3691905863 + 1e-9)


@settings(max_examples=60)
@given(
    st.lists(st.tuples(*[st.floats(-1, 1)] * 3, st.floats(0.1, 0.8), st.floats(-1, 2)), min_size=1, max_size=7),
    st.floats(0.02, 0.98),
    st.integers(0, 2**32 - 1),
)
def test_density_above_the_threshold_lies_within_reach_of_a_part(balls, threshold, seed):
    rows = np.array(balls)
    ends = np.roll(rows[:, :3], 1, axis=0) * 0.3 + rows[:, :3] * 0.7
    parts = np.column_stack([rows[:, :3], ends, rows[:, 3:]])
    around = np.random.default_rng(seed).normal(size=(400, 3))
    points = np.concatenate([around * 0.8, *(p[:3] + 0.5 * p[6] * around for p in parts)])
    distances = np.array([capsule(points, p[:3], p[3:6]) for p in parts])
    density = (parts[:, 7, None] * np.maximum(0, 1 - (distances / parts[:, 6, None]) ** 2) ** 3).sum(axis=0)
    corners = parts[:, [0, 1, 2, 3, 4, 5, 0, 1, 2]].reshape(-1, 3, 3)
    reach = reaches(Skeleton(corners, parts[:, [6, 6]], parts[:, 7], np.arange(len(parts), dtype=float)), threshold)
    solid = density > threshold
    assert (distances[:, solid] <= reach[:, None] + 1e-12).any(axis=0).all()
    assert (reach <= parts[:, 6]).all()


def test_blobby_says_which_numbers_do_not_fit():
    points = const([[0, 0, 0], [1, 0, 0]])
    with pytest.raises(RunFailure, match="no point 2"):
        Blobby(points=points, segments=((0, 2),)).parts(FakeMoment())
    with pytest.raises(RunFailure, match="2 points, but 3 values"):
        Blobby(points=points, radius=const([0.1, 0.2, 0.3])).parts(FakeMoment())
    with pytest.raises(RunFailure, match="above 0"):
        Blobby(points=points, radius=const([0.1, -0.2])).parts(FakeMoment())


def test_blobby_of_linked_points_follows_them():
    thing = Blobby(points=link("cage", "positions", (None, 3)), radius=const(0.5))
    moment = FakeMoment(given={("cage", "positions"): np.array([[0.0, 1, 0], [3, 1, 0]])})
    low, high = thing.extent(IDENTITY, moment)
    np.testing.assert_allclose((low + high) / 2, [1.5, 1, 0])


def test_a_child_without_material_takes_the_groups():
    color = const([0.1, 0.2, 0.3])
    group = Group(children=(Ref("plain"), Ref("own"), Ref("gone")), color=color)
    parts = {"plain": Sphere(), "own": Sphere(color=const([1, 1, 1])), "gone": Sphere(hidden=True)}
    shapes = {shape.name: shape.surface.color for shape in group.lower("group", IDENTITY, FakeMoment(parts=parts))}
    assert shapes == {"plain": (0.1, 0.2, 0.3), "own": (1.0, 1.0, 1.0)}


def test_a_size_that_varies_below_zero_fails_at_its_time():
    with pytest.raises(RunFailure, match=r"at 2 s, radius"):
        list(Sphere(radius=link("m", "r")).lower("ball", IDENTITY, FakeMoment(time=2.0, given={("m", "r"): -0.1})))


@settings(max_examples=50)
@given(st.tuples(*[st.floats(-1, 1)] * 4), st.tuples(*[st.floats(-3, 3)] * 3))
def test_rotations_keep_lengths_and_boxes_hold_their_corners(turn, point):
    assume(np.linalg.norm(turn) > 1e-3)
    matrix = rotation_matrix(turn)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1.0)
    place = affine(point, turn, (1.0, 2.0, 0.3))
    np.testing.assert_allclose(apply(compose(inverse(place), place), point), point, atol=1e-9)
    low, high = mapped_box(place, (-1, -1, -1), (1, 1, 1))
    corners = apply(place, [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    np.testing.assert_allclose([low, high], [corners.min(axis=0), corners.max(axis=0)], atol=1e-9)


class _Assembly:
    def __init__(self):
        self.numbers = []

    def floats(self, values):
        self.numbers += [float(v) for v in np.ravel(values)]
        return len(self.numbers) - np.size(values)

    def value(self, value):
        return self.floats(FakeMoment().at(value))


@pytest.mark.parametrize(
    ("thing", "shape", "position", "size"),
    [
        (Sphere(radius=const(0.3), position=const(AT)), "sphere", AT, (0.3,)),
        (Box(size=const([1, 2, 4]), position=const(AT)), "box", AT, (0.5, 1, 2)),
        (Plane(height=const(0.5), position=const([1, 2, 3]), normal=const([0, 1, 0])), "plane", (1, 2.5, 3), (0, 1, 0)),
    ],
)
def test_colliders_store_place_and_size(thing, shape, position, size):
    assembly = _Assembly()
    found = thing.collider(assembly)
    assert found.kernels == f"sceneql.contacts.shapes.{shape}_kernels"
    np.testing.assert_allclose(assembly.numbers[found.position_at : found.position_at + 3], position)
    np.testing.assert_allclose(assembly.numbers[found.rotation_at : found.rotation_at + 4], (1, 0, 0, 0))
    np.testing.assert_allclose(assembly.numbers[found.size_at : found.size_at + len(size)], size)
