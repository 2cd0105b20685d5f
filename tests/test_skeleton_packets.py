"""Skeletons in packets of rays: their roots are the certified ones, whatever the parts and wherever they are moved."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from lane_checks import check_enclosures
from plain_tapes import implicit
from random_tapes import MIXED
from ray_bundles import agree_with_the_certified, bundle, cast_together
from sceneql.field.packets.packets import Memory, enclosures
from sceneql.field.roots.clips import clip_rows
from sceneql.field.skeleton.skeleton import KERNELS, Skeleton
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.field.tape.tape_solid import cast, field_values
from sceneql.shapes.spline import smooth
from test_curved_skeletons import curves
from test_skeletons import crowd

AFFINE = np.array([[0.8, -0.5, 0.2, 0.3], [0.4, 0.9, 0.1, -0.2], [-0.3, 0.1, 1.1, 0.1]])


def solid(skeleton, threshold=0.3, matrix=None):
    """Where a skeleton's density is more than a threshold, perhaps in other coordinates."""

    def formula(b, op, c):
        place = (b.x, b.y, b.z) if matrix is None else b.affine(matrix, b.x, b.y, b.z)
        return op("sub", c(threshold), b.skeleton(skeleton, *place))

    return implicit(formula)


def snake(n=9):
    """A spline whose radius changes."""
    t = np.linspace(-1.0, 1.0, n)
    points = np.column_stack([t, 0.3 * np.sin(3.0 * t), 0.2 * np.cos(2.0 * t)])
    return curves(*smooth(points, 0.25 + 0.1 * np.cos(4.0 * t), False))


def window(size=1.2, count=32):
    """Rays down on a square, in columns of neighbors."""
    x, y = np.meshgrid(np.linspace(-size, size, count), np.linspace(-size, size, count))
    origins = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 3.0)])
    return origins, np.tile([0.02, 0.01, -1.0], (x.size, 1)), np.zeros(x.size), np.full(x.size, 6.0)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("matrix", [None, AFFINE], ids=["at rest", "moved"])
def test_roots_of_crowds_are_the_certified_ones(kernel, matrix):
    tape = solid(crowd(kernel), matrix=matrix)
    assert ops.SKELETON in tape.code[:, 0]
    agree_with_the_certified(tape, *window(), within=1e-9)


def test_roots_of_moved_solids_that_are_cut_are_the_certified_ones():
    def formula(b, op, c):
        place = b.affine(AFFINE, b.x, b.y, b.z)
        ball = op("sub", op("add", op("add", *[op("square", p) for p in place[:2]]), op("square", place[2])), c(0.6))
        return op("max", op("sub", c(0.3), b.skeleton(crowd("metaball"), *place)), ball)

    tape = implicit(formula)
    own, _ = in_own_coordinates(tape)
    assert len(clip_rows(own)) == len(clip_rows(tape)) == 1
    agree_with_the_certified(tape, *window(), within=1e-9)
    agree_with_the_certified(own, *window(), within=1e-9)


def test_roots_of_splines_are_the_certified_ones():
    agree_with_the_certified(solid(snake()), *window(), within=1e-9)


@settings(max_examples=60)
@given(
    seed=st.integers(0, 999),
    spread=st.sampled_from([0.0, 0.1, 1.0]),
    kernel=st.sampled_from(range(len(KERNELS))),
    threshold=st.sampled_from([0.1, 0.5]),
)
@example(seed=144, spread=0.1, kernel=0, threshold=0.1)  # a part ends within a step of the root
@example(seed=25977, spread=0.0, kernel=4, threshold=0.5)
def test_no_root_of_any_skeleton_is_missed(seed, spread, kernel, threshold):
    generator = np.random.default_rng(seed)
    n = len(MIXED.weights)
    corners = MIXED.corners + generator.normal(size=(n, 1, 3)) * 0.3
    middles = np.where(np.isnan(MIXED.middles), np.nan, generator.uniform(0.2, 0.8, n))
    parts = Skeleton(corners, generator.uniform(0.2, 0.8, (n, 2)), MIXED.weights, MIXED.groups, kernel, middles)
    tape = solid(parts, threshold)
    origins, directions = bundle(np.array([0.1, 0.2, 2.5]), np.array([0.0, -0.1, -2.0]), generator, 200, spread)
    t0, t1 = np.full(200, 0.2), np.full(200, 2.2)
    agree_with_the_certified(tape, origins, directions, t0, t1, within=1e-8)
    status, _ = cast_together(tape, origins, directions, t0, t1)
    places = t0[:, None] + (t1 - t0)[:, None] * np.linspace(0.0, 1.0, 101)
    points = origins[:, None] + places[:, :, None] * directions[:, None]
    inside = field_values(tape, points.reshape(-1, 3)).reshape(places.shape) < 0.0
    assert not (inside.any(axis=1) & (status == ops.MISS)).any()


def test_long_segments_beside_a_short_one_claim_nothing_wrong():
    """Of kernels that are cut: what is left of their slope where they end is rounding."""
    for kernel in range(len(KERNELS)):
        tape = solid(Skeleton(np.zeros((1, 3, 3)), np.ones((1, 2)), np.ones(1), np.zeros(1), kernel))
        for length in np.geomspace(1.0, 3e4, 60):
            begins, ends = np.array([-0.1, -1.9 * length]), np.array([0.1, 0.1 * length])
            origins, ways = np.tile([0.0, 0.1, 0.0], (2, 1)), np.tile([1.0, 0.0, 0.0], (2, 1))
            c0, c1, e, _ = enclosures(tape, origins, ways, begins, ends)
            tau = np.linspace(-1.0, 1.0, 41)
            t = 0.5 * (begins + ends)[:, None] + 0.5 * (ends - begins)[:, None] * tau
            f = field_values(tape, (origins[:, None] + t[:, :, None] * ways[:, None]).reshape(-1, 3)).reshape(t.shape)
            assert (np.abs(f - c0[:, None] - c1[:, None] * tau) <= e[:, None]).all()


@pytest.mark.parametrize("size", [1e-17, 1e-12, 1e-6, 1e6, 1e10, 1e13, 1e14])
@pytest.mark.parametrize("kind", ["cone", "curve"])
def test_parts_of_any_size_claim_nothing_wrong(size, kind):
    """A part whose ends are nearer than its radii differ: products of four lengths leave float32's range."""
    a, b, c = np.zeros(3), np.array([0.1, 0.0, 0.0]), np.array([0.05, 0.05, 0.0]) * (kind == "curve")
    middles = np.array([1.1 * size]) if kind == "curve" else None
    for radii in ([1.0, 1.2], [1.0, 0.4]):
        tape = solid(
            Skeleton(size * np.array([[a, b, c]]), size * np.array([radii]), np.ones(1), np.zeros(1), 1, middles)
        )
        generator = np.random.default_rng(0)
        for _ in range(40):
            origin, direction = size * generator.normal(size=3), generator.normal(size=3)
            check_enclosures(tape, origin, direction, -0.1 * size, 0.1 * size)


def settle(tape, origins, directions, t0, t1, anywhere=False):
    """(segments looked at, rays left to the certified routine, outcomes) of one bundle."""
    memory = Memory(tape, 256)
    n = len(t0)
    memory.rays[:3, :n], memory.rays[3:6, :n], memory.rays[6, :n], memory.rays[7, :n] = origins.T, directions.T, t0, t1
    return *memory.settle(n, anywhere), memory.found[0, :n]


@pytest.mark.parametrize("skeleton", [snake(), crowd("wyvill"), crowd("gaussian")], ids=["spline", "crowd", "gaussian"])
def test_lanes_settle_what_passes_near_each_other(skeleton):
    origins, directions, t0, t1 = window(0.15, 16)
    _, certified, outcomes = settle(solid(skeleton), origins, directions, t0, t1)
    assert (outcomes != ops.UNDECIDED).all()
    assert certified < 0.05 * len(t0)


def test_rays_that_spread_over_far_more_parts_than_each_of_them_meets_are_certified_alone():
    generator = np.random.default_rng(4)
    centers = generator.uniform(-3, 3, (600, 1, 3)).repeat(3, axis=1)
    tape = solid(Skeleton(centers, np.full((600, 2), 0.2), np.ones(600), np.arange(600.0), KERNELS.index("metaball")))
    origins = np.tile([0.0, 0.0, 9.0], (256, 1))
    targets = np.column_stack([generator.uniform(-3, 3, (256, 2)), np.zeros(256)])
    t0, t1 = np.zeros(256), np.full(256, 2.0)
    segments, certified, outcomes = settle(tape, origins, targets - origins, t0, t1)
    assert certified == 256
    assert segments < 256
    exact, _ = cast(tape, origins, targets - origins, t0, t1)
    assert (outcomes == exact).all()
    *_, blocked = settle(tape, origins, targets - origins, t0, t1, anywhere=True)
    assert (blocked == exact).all()
    assert 20 < (outcomes == ops.HIT).sum() < 236


def test_a_moved_tape_is_looked_at_in_its_own_coordinates():
    tape = solid(snake(), matrix=AFFINE)
    own, matrix = in_own_coordinates(tape)
    points = np.random.default_rng(2).uniform(-1, 1, (200, 3))
    there = points @ matrix[:, :3].T + matrix[:, 3]
    assert field_values(own, there) == pytest.approx(field_values(tape, points), abs=1e-13)
    assert len(own.code) < len(tape.code) - 10
    assert np.isin(matrix, AFFINE).all()


@pytest.mark.parametrize(
    "formula",
    [
        lambda b, op, c: op("sub", op("square", b.x), op("add", b.y, op("square", b.z))),
        lambda b, op, c: op("max", op("sin", op("add", b.x, b.y)), op("add", b.x, op("mul", b.y, c(2.0)))),
        lambda b, op, c: op("add", b.x, c(1.0)),
        lambda b, op, c: op("square", op("add", b.x, b.y)),
    ],
    ids=["at rest", "two maps", "a plane", "flat"],
)
def test_a_tape_without_coordinates_of_its_own_stays(formula):
    tape = implicit(formula)
    own, matrix = in_own_coordinates(tape)
    assert own is tape
    assert (matrix == np.eye(3, 4)).all()
