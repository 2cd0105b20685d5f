"""Laws of skeletons: every evaluator over every kernel and kind of part, and what their surfaces are known to do."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_checks import check_enclosures
from sceneql.field.enclose.enclosure_kernels import segment
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.skeleton.skeleton import KERNELS, Skeleton
from sceneql.field.tape.batch_gradient_kernels import differentiate
from sceneql.field.tape.batch_kernels import LANES, evaluate
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.steepness_kernels import steepness
from sceneql.field.tape.tape_ops import HIT, WHOLE
from sceneql.field.tape.tape_solid import cast, field_gradients, field_values, scratch
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.measures import euler_characteristic

FALLOFF = {
    "wyvill": lambda r: (1 - r**2) ** 3,
    "soft_object": lambda r: 1 - 22 / 9 * r**2 + 17 / 9 * r**4 - 4 / 9 * r**6,
    "metaball": lambda r: np.where(r <= 1 / 3, 1 - 3 * r**2, 1.5 * (1 - r) ** 2),
    "gaussian": lambda r: (np.exp(-4 * r**2) - np.exp(-4) * (5 - 4 * r**2)) / (1 - 5 * np.exp(-4)),
    "inverse_square": lambda r: (1 - r**2) ** 2 / (1 + 4 * r**2),
}
"""As functions of d/R, as their authors write them, or less the tangent in d^2 where they are cut."""

KINDS = {
    "point": [[[0.1, -0.2, 0.3]] * 3],
    "segment": [[[-0.5, 0.1, 0.2], [0.7, 0.3, -0.1], [-0.5, 0.1, 0.2]]],
    "no length": [[[0.2, 0.2, 0.2], [0.2, 0.2, 0.2 + 1e-300], [0.2, 0.2, 0.2]]],
    "triangle": [[[-0.6, -0.3, 0.1], [0.7, -0.2, 0.0], [0.1, 0.6, -0.3]]],
    "sliver": [[[-0.6, -0.3, 0.1], [0.7, -0.2, 0.0], [0.1, -0.24, 0.0461]]],
    "collinear": [[[0.5, 0.5, 0.5], [-0.5, -0.5, -0.5], [0.1, 0.1, 0.1]]],
    "no area": [[[0.3, -0.1, 0.2]] * 2 + [[-0.4, 0.3, 0.1]]],
    "polyline": [[[x, x * x, 0], [x + 0.4, (x + 0.4) ** 2, 0.1], [x, x * x, 0]] for x in (-0.8, -0.4, 0.0, 0.4)],
}
POINTS = st.tuples(*[st.floats(-1.5, 1.5).map(lambda number: round(number, 5) + 0.0)] * 3)


def skeleton(corners, radii=0.9, weights=1.0, groups=0.0, kernel="wyvill"):
    corners = np.array(corners, dtype=float)
    n = len(corners)
    radii = np.broadcast_to(np.array(radii, dtype=float), (n, 2)).copy()
    return Skeleton(corners, radii, np.full(n, weights), np.broadcast_to(groups, n) * 1.0, KERNELS.index(kernel))


def tape_of(*skeletons, level=None):
    build = TapeBuilder()
    registers = [build.skeleton(one, build.x, build.y, build.z) for one in skeletons]
    value = registers[0]
    for register in registers[1:]:
        value = build.op("add", value, register)
    return build.finish(value if level is None else build.op("sub", build.constant(level), value))


def crowd(kernel, n=90, seed=2):
    """Points, segments of two radii and triangles, some hollow, some in groups."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (n, 1, 3)) + np.where(np.arange(n)[:, None, None] % 3 > 0, 0.3, 0.0) * rng.normal(
        size=(n, 3, 3)
    )
    corners[np.arange(n) % 3 < 2, 2] = corners[np.arange(n) % 3 < 2, 0]
    groups = np.minimum(np.arange(n), 70).astype(float)
    weights = np.where(groups % 5 == 4, -0.6, 1.0)
    return Skeleton(corners, rng.uniform(0.1, 0.5, (n, 2)), weights, groups, KERNELS.index(kernel))


CASES = [pytest.param(kernel, kind, id=f"{kernel}-{kind}") for kernel in KERNELS for kind in KINDS]


def arguments(tape):
    return tape.code, tape.constants, tape.parts, scratch(tape)


def distances(kind, points):
    """To the skeleton, by trimesh for triangles."""
    found = []
    for a, b, c in np.array(KINDS[kind]):
        near = np.array([a, b, c])
        if kind in ("triangle", "sliver"):
            closest = trimesh.triangles.closest_point(np.broadcast_to(near, (len(points), 3, 3)), points)
        else:
            ends = near[[0, 1]] if kind != "no area" else near[[0, 2]]
            side = ends[1] - ends[0]
            q = np.clip((points - ends[0]) @ side / max(side @ side, 1e-300), 0, 1)
            closest = ends[0] + q[:, None] * side
        found.append(np.linalg.norm(points - closest, axis=1))
    return np.min(found, axis=0)


@pytest.mark.parametrize(("kernel", "kind"), CASES)
def test_density_is_the_kernel_of_the_distance(kernel, kind):
    points = np.random.default_rng(0).uniform(-1.6, 1.6, (400, 3))
    r = distances(kind, points) / 0.9
    expected = np.where(r < 1, FALLOFF[kernel](np.minimum(r, 1.0)), 0.0)
    found = field_values(tape_of(skeleton(KINDS[kind], kernel=kernel)), points)
    assert found == pytest.approx(expected, abs=1e-12)
    share = np.random.default_rng(1).dirichlet([1, 1, 1], 30)
    on = np.concatenate([share @ np.array(part) for part in KINDS[kind]])
    assert field_values(tape_of(skeleton(KINDS[kind], kernel=kernel)), on) == pytest.approx(1.0, abs=1e-9)
    far = points[np.abs(r - 1) > 1e-9]
    assert (field_values(tape_of(skeleton(KINDS[kind], kernel=kernel)), far[distances(kind, far) > 0.9]) == 0).all()


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("radii", [[0.9, 0.3], [0.2, 0.8], [0.3, 2.5]])
def test_a_radius_that_changes_is_that_of_the_best_point(kernel, radii):
    a, b = np.array(KINDS["segment"][0][:2])
    points = np.random.default_rng(5).uniform(-1.6, 1.6, (200, 3))
    q = np.linspace(0.0, 1.0, 4001)
    away = np.linalg.norm(points[:, None] - (a + q[:, None] * (b - a)), axis=2)
    r = (away / (radii[0] + q * (radii[1] - radii[0]))).min(axis=1)
    expected = np.where(r < 1, FALLOFF[kernel](np.minimum(r, 1.0)), 0.0)
    assert field_values(tape_of(skeleton(KINDS["segment"], radii, kernel=kernel)), points) == pytest.approx(
        expected, abs=1e-6
    )


def check_segment(tape, origin, direction, t0, t1):
    room = arguments(tape)
    c0, c1, e, status = segment(*room, *origin, *direction, t0, t1, True)
    assert status == WHOLE
    # A piece looks at what was surveyed, or at what the piece before it looked at where it is one of that.
    for begin, end in ((0.0, 1.0), (0.3, 0.4), (0.32, 0.37), (0.37, 0.6), (0.33, 0.35), (0.05, 0.9), (0.8, 0.81)):
        low, high = t0 + begin * (t1 - t0), t0 + end * (t1 - t0)
        c0, c1, e, _ = segment(*room, *origin, *direction, low, high, end == 1.0)
        tau = np.linspace(-1.0, 1.0, 61)
        t = 0.5 * (low + high) + 0.5 * (high - low) * tau
        f = field_values(tape, origin + t[:, None] * direction)
        off = np.abs(f - (c0 + c1 * tau))
        assert (off <= e).all(), (off.max(), e)


def check_box(tape, low, high):
    room = arguments(tape)
    below, above, status = box(*room, low[0], high[0], low[1], high[1], low[2], high[2])
    slopes = np.array(steepness(*room))
    grid = np.stack(np.meshgrid(*[np.linspace(low[k], high[k], 5) for k in range(3)]), axis=-1).reshape(-1, 3)
    f = field_values(tape, grid)
    assert status == WHOLE
    assert ((f >= below) & (f <= above)).all()
    assert (np.abs(field_gradients(tape, grid)) <= slopes).all()
    short, near = np.empty_like(tape.code), np.empty_like(tape.parts)
    box(*room, low[0], high[0], low[1], high[1], low[2], high[2])
    rows, used = simplify(tape.code, tape.parts, room[3], True, short, near)
    lesser = type(tape)(short[:rows].copy(), tape.constants, near[:used].copy())
    assert (field_values(lesser, grid) == f).all()


@pytest.mark.parametrize(("kernel", "kind"), CASES)
@settings(max_examples=15)
@given(
    origin=POINTS,
    direction=POINTS,
    size=st.sampled_from([0.0, 1e-7, 1e-3, 0.1, 1.0, 8.0]),
    radii=st.sampled_from([0.9, [0.9, 0.3], 1e-6]),
    weight=st.sampled_from([1.0, -0.7]),
)
def test_enclosures_contain_every_value(kernel, kind, origin, direction, size, radii, weight):
    tape = tape_of(skeleton(KINDS[kind], radii, weight, kernel=kernel))
    origin, direction = np.array(origin), np.array(direction)
    check_segment(tape, origin, direction, -size, size)
    check_enclosures(tape, origin, direction, -size, size)
    check_box(tape, origin, origin + size * np.abs(direction))


@pytest.mark.parametrize("kernel", KERNELS)
@settings(max_examples=30)
@given(origin=POINTS, direction=POINTS, size=st.sampled_from([1e-4, 0.05, 0.5, 4.0]))
def test_enclosures_of_a_crowd_contain_every_value(kernel, origin, direction, size):
    tape = tape_of(crowd(kernel))
    origin, direction = np.array(origin), np.array(direction)
    check_segment(tape, origin, direction, -size, size)
    check_enclosures(tape, origin, direction, -size, size)
    check_box(tape, origin, origin + size * np.abs(direction))


@pytest.mark.parametrize(("kernel", "kind"), CASES)
@pytest.mark.parametrize("radii", [0.9, [0.9, 0.4]])
def test_gradient_is_that_of_differences(kernel, kind, radii):
    tape, h = tape_of(skeleton(KINDS[kind], radii, kernel=kernel)), 1e-6
    points = np.random.default_rng(3).uniform(-0.9, 0.9, (60, 3))
    steps = [field_values(tape, points + h * axis) - field_values(tape, points - h * axis) for axis in np.eye(3)]
    # A mean over both sides tells the kinks between the parts of a group, where there is no gradient.
    wide = [field_values(tape, points + 9 * h * axis) - field_values(tape, points - 9 * h * axis) for axis in np.eye(3)]
    central, wider = np.array(steps).T / (2 * h), np.array(wide).T / (18 * h)
    smooth = np.abs(central - wider).max(axis=1) < 1e-5
    assert smooth.mean() > 0.8
    assert field_gradients(tape, points)[smooth] == pytest.approx(central[smooth], abs=1e-7, rel=1e-7)


@pytest.mark.parametrize("kernel", KERNELS)
def test_many_points_have_the_bits_of_one(kernel):
    tape = tape_of(crowd(kernel))
    points = np.random.default_rng(4).uniform(-1.3, 1.3, (LANES, 3))
    registers, slope = np.empty((len(tape.code), LANES)), np.empty((len(tape.code), 3, LANES))
    program = (tape.code, tape.constants, tape.parts, registers)
    evaluate(*program, np.ascontiguousarray(points.T), LANES)
    assert (registers[-1] == field_values(tape, points)).all()
    differentiate(*program, slope, LANES)
    assert (field_gradients(tape, points) == slope[-1].T).all()


@pytest.mark.parametrize("n", [1, 8, 9, 64, 65, 700])
def test_the_hierarchy_changes_no_value(n):
    rng = np.random.default_rng(n)
    corners = rng.uniform(-1, 1, (n, 1, 3)) + 0.1 * rng.normal(size=(n, 3, 3))
    whole = Skeleton(corners, rng.uniform(0.1, 0.4, (n, 2)), np.ones(n), np.arange(n) // 3 * 1.0, 1)
    points = rng.uniform(-1.4, 1.4, (300, 3))
    total = np.zeros(len(points))
    for group in np.unique(whole.groups):
        each = [
            field_values(tape_of(whole.chosen(np.arange(n) == k)), points)
            for k in np.flatnonzero(whole.groups == group)
        ]
        total += np.max(each, axis=0)
    assert field_values(tape_of(whole), points) == pytest.approx(total, abs=1e-12)


def test_one_kernel_is_a_ball_of_the_radius_that_theory_tells():
    for extra in (0.0, 1e-9):  # by both operations: a second radius makes it no plain part
        tape = tape_of(skeleton(KINDS["point"], [1.0, 1.0 + extra]), level=0.3)
        center = np.array(KINDS["point"][0][0])
        status, t = cast(tape, center + np.array([3.0, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]), 0.0, 3.0)
        assert status[0] == HIT
        assert 3.0 - t[0] == pytest.approx(0.5749496064, abs=1e-8 if extra else 1e-10)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize(("shift", "euler"), [(-1e-3, 2), (1e-3, 4)])
def test_two_kernels_part_where_the_sum_between_them_falls_below_the_threshold(kernel, shift, euler):
    # Half way between two parts of distance 2 h the density is 2 K(h^2) = 0.3: by bisection on the kernel itself.
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 2 * FALLOFF[kernel](np.array(middle)) > 0.3 else (low, middle)
    if kernel == "wyvill":
        assert 2 * low == pytest.approx(1.3691905863, abs=1e-10)
    x = low + 0.5 * shift
    corners = [[[side * x, 0.013, 0.007]] * 3 for side in (-1, 1)]
    tape = tape_of(skeleton(corners, 1.0, groups=[0.0, 1.0], kernel=kernel), level=0.3)
    mesh = polygonise(tape, (-1.8, -1.1, -1.1), (1.8, 1.1, 1.1), 0.024)
    assert euler_characteristic(mesh.triangles) == euler


def test_a_polyline_does_not_bulge_at_its_joints():
    tape = tape_of(skeleton(KINDS["polyline"], 0.5))
    joint = np.array([[-0.4, 0.16, 0.1]])
    assert field_values(tape, joint)[0] == 1.0
    apart = tape_of(skeleton(KINDS["polyline"], 0.5, groups=np.arange(4.0)))
    assert field_values(apart, joint)[0] > 1.9


@pytest.mark.parametrize("kernel", KERNELS)
def test_no_root_of_a_crowd_is_missed(kernel):
    tape = tape_of(crowd(kernel), level=0.3)
    rng = np.random.default_rng(6)
    origins = rng.normal(size=(40, 3))
    origins *= 4 / np.linalg.norm(origins, axis=1)[:, None]
    directions = rng.uniform(-0.8, 0.8, (40, 3)) - origins
    status, t = cast(tape, origins, directions, 0.0, 2.0)
    places = np.linspace(0.0, 2.0, 4001)
    for k in range(len(origins)):
        inside = field_values(tape, origins[k] + places[:, None] * directions[k]) < 0.0
        assert (status[k] == HIT) == inside.any() or not inside.any()
        if inside.any():
            first = places[np.argmax(inside)]
            assert first - 0.0006 < t[k] <= first + 1e-9
            assert math.isfinite(t[k])
