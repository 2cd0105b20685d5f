"""Rays that go apart among the points of a large skeleton: each is searched by itself, and so are normals."""

from __future__ import annotations

import numpy as np
import pytest

from renderers.tracing import layout
from renderers.tracing.pack import pack
from renderers.tracing.solids.bundles import Packets
from sceneql.field.packets.packets import Memory
from sceneql.field.skeleton.skeleton import Skeleton
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_ops import HIT, MISS
from sceneql.field.tape.tape_solid import cast, field_gradients, field_values
from sceneql.frame import Implicit
from stage import WHITE, frame

THRESHOLD = 0.3


def crowd(count, at=0.0, least=1.0, wider=1.0, heaviest=1.0):
    """The tape of ``count`` points in a ball of radius 1 around (at, 0, 0), of weights from ``least`` to ``heaviest``.

    The reach of each is ``wider`` times about the distance of neighbors.
    """
    rng = np.random.default_rng(count)
    centers = rng.normal(size=(count, 3))
    centers *= rng.uniform(size=(count, 1)) ** (1 / 3) / np.linalg.norm(centers, axis=1)[:, None]
    centers[:, 0] += at
    radii = rng.uniform(0.8, 1.2, count) * 1.1 * wider * count ** (-1 / 3)
    corners, both = np.repeat(centers[:, None], 3, axis=1), np.stack([radii, radii], axis=1)
    points = Skeleton(corners, both, rng.uniform(least, heaviest, count), np.arange(count, dtype=float))
    build = TapeBuilder()
    depth = build.op("sub", build.constant(THRESHOLD), build.skeleton(points, build.x, build.y, build.z))
    return build.finish(build.op("mul", depth, build.constant(0.07)))


def rays(tape, at, seed, count=256):
    """Origins outside of the solid among the points, and directions all around."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(-0.9, 0.9, (20 * count, 3)) + np.array([at, 0.0, 0.0])
    origins = places[field_values(tape, places) > 1e-3][:count]
    ways = rng.normal(size=origins.shape)
    return origins, ways / np.linalg.norm(ways, axis=1)[:, None]


def settled(tape, origins, ways, length, anywhere):
    """(status, t, rays left to the certified routine)."""
    memory = Memory(tape, 256)
    n = len(origins)
    memory.rays[:3, :n], memory.rays[3:6, :n], memory.rays[6], memory.rays[7] = origins.T, ways.T, 0.0, length
    _, certified = memory.settle(n, anywhere)
    return memory.found[0, :n].copy(), memory.found[3, :n].copy(), certified


@pytest.mark.parametrize("anywhere", [False, True])
@pytest.mark.parametrize(
    ("count", "at", "least", "speed"),
    [(129, 0.0, 1.0, 1.0), (700, 0.0, 1.0, 0.3), (5000, 0.0, 1.0, 1.0), (2000, 300.0, 1.0, 1.0), (900, 0.0, -0.6, 2.0)],
)
def test_rays_that_go_apart_find_what_the_certified_routine_finds(count, at, least, speed, anywhere):
    tape = crowd(count, at, least)
    origins, ways = rays(tape, at, count)
    ends = np.full(len(origins), 2.2 / speed)
    status, t, certified = settled(tape, origins, speed * ways, 2.2 / speed, anywhere)
    known, roots = cast(tape, origins, speed * ways, np.zeros(len(origins)), ends)
    assert ((known == HIT) | (known == MISS)).all()
    assert (status == known).all()
    assert 50 < (known == HIT).sum() < len(origins)
    assert certified <= 0.05 * len(origins)
    hit = known == HIT
    if not anywhere:
        assert t[hit] == pytest.approx(roots[hit], abs=1e-8 / speed)


@pytest.mark.parametrize(("at", "wide"), [(0.0, 0.1), (0.0, 0.7), (300.0, 0.1)])
def test_a_beam_of_rays_in_any_order_finds_what_the_certified_routine_finds(at, wide):
    """Their packets are made of neighbors across the beam, by all points that reach into it."""
    tape = crowd(3000, at)
    rng = np.random.default_rng(5)
    way = np.array([0.48, 0.6, 0.64])
    across = np.array([[0.8, -0.64, 0.0], [0.0, 0.64, -0.6]])
    origins = np.array([at, 0.0, 0.0]) - 1.2 * way + rng.uniform(-wide, wide, (256, 2)) @ across
    origins += rng.uniform(-0.2, 0.2, (256, 1)) * way
    ways = np.repeat([way], len(origins), axis=0)
    known, _ = cast(tape, origins, ways, np.zeros(len(origins)), np.full(len(origins), 2.6))
    for turn in (np.arange(256), rng.permutation(256), np.argsort(origins[:, 0])):
        status, _, certified = settled(tape, origins[turn], ways, 2.6, True)
        assert (status == known[turn]).all()
        assert certified <= 2
    assert (known == HIT).any()
    assert wide < 0.5 or (known == MISS).any()


@pytest.mark.parametrize("anywhere", [False, True])
def test_parallel_rays_from_scattered_places_find_what_the_certified_routine_finds(anywhere):
    """Shadow rays of light from around: their bundle reaches thousands of points, each of them a few."""
    tape = crowd(3000)
    origins, _ = rays(tape, 0.0, 7)
    ways = np.repeat([[0.48, 0.6, 0.64]], len(origins), axis=0)
    status, t, certified = settled(tape, origins, ways, 2.2, anywhere)
    known, roots = cast(tape, origins, ways, np.zeros(len(origins)), np.full(len(origins), 2.2))
    assert (status == known).all()
    assert certified <= 0.05 * len(origins)
    assert anywhere or t[known == HIT] == pytest.approx(roots[known == HIT], abs=1e-8)


@pytest.mark.parametrize("anywhere", [False, True])
def test_rays_among_hundreds_of_points_at_each_place_are_searched_as_well(anywhere):
    tape = crowd(900, 0.0, 0.002, 6.0, 0.012)
    origins, ways = rays(tape, 0.0, 3)
    status, t, _ = settled(tape, origins, ways, 2.2, anywhere)
    known, roots = cast(tape, origins, ways, np.zeros(len(origins)), np.full(len(origins), 2.2))
    assert (status == known).all()
    assert 20 < (known == HIT).sum() < len(origins)
    assert anywhere or t[known == HIT] == pytest.approx(roots[known == HIT], abs=1e-7)


def test_a_bundle_of_any_size_is_searched_to_its_last_ray():
    tape = crowd(1500)
    origins, ways = rays(tape, 0.0, 1)
    whole, _, _ = settled(tape, origins, ways, 2.2, False)
    for n in (1, 15, 17, 33, 250):
        some, _, _ = settled(tape, origins[:n], ways[:n], 2.2, False)
        assert (some == whole[:n]).all()


@pytest.mark.parametrize("counts", [(129,), (4096, 130), (5000, 300, 150)])
def test_normals_among_many_points_have_the_bits_of_single_ones(counts):
    """Of several skeletons in a frame each by its own points; where these are few, places have them together."""
    solids = tuple(Implicit("", WHITE, crowd(count, least=-0.5), (-2.0,) * 3, (2.0,) * 3) for count in counts)
    packets = Packets(solids, list(range(len(solids))))
    scene, _ = pack(frame(*solids))
    items = scene.ints[layout.ITEMS : layout.ITEMS + 4 * len(solids)].reshape(-1, 4)
    rng = np.random.default_rng(2)
    places = rng.uniform(-1.2, 1.2, (600, 3))
    places[300:] = np.repeat(0.7 * places[:10], 30, axis=0) + rng.uniform(-0.04, 0.04, (300, 3))  # close together
    met, skins = np.zeros((600, 5)), np.zeros((600, 6))
    met[:, 1], met[:, 2:] = np.arange(600) % len(solids), places
    packets.skin(scene, np.arange(600), met, skins)
    for item, shape in enumerate(items[:, layout.SHAPE]):
        own = met[:, 1] == item
        gradient = field_gradients(solids[shape].tape, places[own])
        length = np.sqrt((gradient * gradient)[:, 0] + (gradient * gradient)[:, 1] + (gradient * gradient)[:, 2])
        known = length > 0.0
        assert known.sum() > 10
        assert (skins[own, :3][known] == gradient[known] / length[known, None]).all()
