"""Laws of packets: roots found in packets are the certified ones."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from campaigns import examples
from common_scenes import tape_of
from moment import IDENTITY, FakeMoment, const, formula
from plain_tapes import implicit, kernels
from random_tapes import PARTS, rays, tapes
from ray_bundles import agree_with_the_certified, bundle, cast_together
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packets import Memory, plan_of
from sceneql.field.roots.clips import clip_rows
from sceneql.field.skeleton.skeleton import Skeleton
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.tape_solid import cast, field_values
from sceneql.shapes.solid import traced
from sceneql.words.objects.blobby import Blobby
from sceneql.words.objects.implicit import Implicit as Formula
from sceneql.words.objects.implicit import Within


@settings(max_examples=examples(150))
@given(tape=tapes(), ray=rays(), spread=st.sampled_from([0.0, 1e-3, 0.5]), seed=st.integers(0, 99))
def test_no_crossing_of_any_tape_is_missed_in_packets(tape, ray, spread, seed):
    origin, direction, t0, t1 = ray
    origins, directions = bundle(origin, direction, np.random.default_rng(seed), 150, spread)
    t0, t1 = np.full(150, t0), np.full(150, t1)
    status, t = cast_together(tape, origins, directions, t0, t1)
    blocked, _ = cast_together(tape, origins, directions, t0, t1, anywhere=True)
    places = t0[:, None] + (t1 - t0)[:, None] * np.linspace(0.0, 1.0, 101)
    points = origins[:, None] + places[:, :, None] * directions[:, None]
    inside = field_values(tape, points.reshape(-1, 3)).reshape(places.shape) < 0.0
    met = inside.any(axis=1) & (t1 > t0)
    assert not (met & (status == ops.MISS)).any()
    assert not (met & (blocked == ops.MISS)).any()
    assert not ((status == ops.MISS) & (blocked == ops.HIT)).any()
    first = np.take_along_axis(places, inside.argmax(axis=1)[:, None], axis=1)[:, 0]
    assert (t[met] <= first[met] + 1e-6 * (t1 - t0)[met] + 1e-12).all()
    certified, _ = cast(tape, origins, directions, t0, t1)
    settled = (status != ops.UNDECIDED) & (certified != ops.UNDECIDED) & (t1 > t0)
    assert ((status == ops.HIT) == ((certified == ops.HIT) | (certified == ops.INSIDE)))[settled].all()


def test_rays_that_are_left_undecided_are_outside_up_to_their_place():
    code = np.array([[1, 0, 0, 0], [20, 0, 0, 0]], dtype=np.int32)  # the random tape that found it: inside from 0 on
    tape = replace(tape_of("x"), code=code, constants=np.zeros(0), parts=np.zeros((0, 8)))
    status, t = cast_together(tape, np.zeros((150, 3)), np.zeros((150, 3)), np.zeros(150), np.full(150, 1e-4))
    assert (status != ops.MISS).all()
    assert (t <= 1e-10 + 1e-12).all()


@pytest.mark.parametrize("count", [100, 150, 180, 205, 250])
def test_all_columns_of_a_bundle_are_searched_where_the_shortened_tape_holds(count):
    # Two bores, 0 < x < 3 and 2 < x < 6, in a slab: near the first root, x = 6, the first bore does not count.
    tape = tape_of("max(max(abs(x - 5) - 10, 1.5 - abs(x - 1.5)), 2 - abs(x - 4))")
    origins = np.column_stack([np.full(count, 0.5), np.linspace(-0.1, 0.1, count), np.zeros(count)])
    directions = np.tile([1.0, 0, 0], (count, 1))
    agree_with_the_certified(tape, origins, directions, np.zeros(count), np.full(count, 14.0), 1e-6)


def test_parts_about_a_place_that_is_not_everywhere_a_number_are_kept():
    # The density of (x, x, sqrt(1 - x^(2x))): the bundle's beam has places where that is enclosed by no numbers.
    code = [[ops.X, 0, 0, 0], [ops.POW, 0, 0, 0], [ops.CONSTANT, 0, 0, 0], [ops.SQUARE, 1, 1, 0]]
    code += [[ops.SUB, 2, 3, 0], [ops.SQRT, 4, 4, 0]]
    code += [[ops.COPY, 0, 0, 0], [ops.COPY, 0, 0, 0], [ops.COPY, 5, 5, 0], [ops.DENSITY, 0, 1, 6]]
    part = np.array([[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.5, -0.5]])
    tape = replace(tape_of("x"), code=np.array(code, dtype=np.int32), constants=np.array([1.0]), parts=part)
    generator = np.random.default_rng(0)
    origins, directions = bundle(np.zeros(3), np.zeros(3), generator, 150, 0.5)
    t0, t1 = np.zeros(150), np.full(150, 1e-9)
    status, _ = cast_together(tape, origins, directions, t0, t1)
    inside = field_values(tape, origins) < 0.0
    assert inside.sum() > 30
    assert (status[inside] != ops.MISS).all()


@pytest.mark.parametrize(("centers", "radius"), [(1, 1.0), (30, 0.6)])
def test_blobs_in_packets_have_the_certified_roots(centers, radius):
    generator = np.random.default_rng(3)
    tape = kernels(generator.uniform(-1, 1, (centers, 3)), 0.3, radius)
    x, y = np.meshgrid(np.linspace(-1.5, 1.5, 32), np.linspace(-1.5, 1.5, 32))
    origins = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 4.0)])
    directions = np.tile([0.02, 0.0, -1.0], (x.size, 1))
    near, far = np.full(x.size, 1.0), np.full(x.size, 7.0)
    status, t = cast_together(tape, origins, directions, near, far)
    exact, places = cast(tape, origins, directions, near, far)
    assert (status == exact).all()
    hit = status == ops.HIT
    assert hit.sum() > 100
    assert t[hit] == pytest.approx(places[hit], abs=1e-7)
    assert ((cast_together(tape, origins, directions, near, far, anywhere=True)[0] == ops.HIT) == hit).all()


@settings(max_examples=60)
@given(
    count=st.sampled_from([1, 3, 20, 200]),
    seed=st.integers(0, 999),
    below=st.booleans(),
    clipped=st.booleans(),
    spread=st.sampled_from([0.0, 0.1, 2.0]),
)
@example(count=3, seed=231, below=False, clipped=True, spread=2.0)  # shadow rays that begin inside, where g is not
def test_densities_of_points_are_met_where_the_certified_routine_meets_them(count, seed, below, clipped, spread):
    generator = np.random.default_rng(seed)
    centers = generator.uniform(-1, 1, (count, 3))
    radii = generator.uniform(0.5, 1.5, count) * 0.9 / count ** (1 / 3)
    weights = generator.choice([1.0, -0.5], count) if below else np.ones(count)
    points = Skeleton(centers[:, None].repeat(3, axis=1), radii[:, None].repeat(2, axis=1), weights, np.arange(count))

    def formula(b, op, c):
        field = op("sub", c(0.2), b.skeleton(points, b.x, b.y, b.z))
        return op("max", field, op("sub", b.x, c(0.3))) if clipped else field

    tape = implicit(formula)
    assert plan_of(tape)[0] >= 0
    origins, directions = bundle(np.array([0.1, 0.2, 3.0]), np.array([0.0, 0.1, -2.0]), generator, 200, spread)
    t0, t1 = np.full(200, 0.3), np.full(200, 2.5)
    agree_with_the_certified(tape, origins, directions, t0, t1, within=2e-6)


@pytest.mark.parametrize("height", [2e-6, -2e-6])
def test_shadow_rays_from_a_hair_off_a_density_need_no_certified_routine(height):
    generator = np.random.default_rng(8)
    centers = generator.uniform(-0.5, 0.5, (20, 3))
    tape = kernels(centers, 0.3, 0.5)
    memory = Memory(tape, 256)
    begins = 0.03 * generator.normal(size=(256, 3)) + [0.2, 0.3, 1.5]
    _, t = cast(tape, begins, np.array([-0.1, -0.15, -1.0]), np.zeros(256), np.full(256, 1.5))
    begins += t[:, None] * [-0.1, -0.15, -1.0]
    step = 1e-5 * np.eye(3)
    slopes = np.column_stack([field_values(tape, begins + e) - field_values(tape, begins - e) for e in step]) / 2e-5
    steep = np.linalg.norm(slopes, axis=1)[:, None]
    begins += height * slopes / steep**2
    assert field_values(tape, begins) == pytest.approx(height, abs=1e-8)
    ways = np.cross(slopes / steep, [0.0, 1.0, 0.0])
    ways = ways / np.linalg.norm(ways, axis=1)[:, None] + 0.1 * slopes / steep
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    memory.rays[:3], memory.rays[3:6], memory.rays[6], memory.rays[7] = begins.T, ways.T, 0.0, 2.0
    _, certified = memory.settle(256, anywhere=True)
    assert certified == 0
    status, _ = cast(tape, begins, ways, np.zeros(256), np.full(256, 2.0))
    hits = (status == ops.HIT) | (status == ops.INSIDE)
    assert ((memory.found[0] == ops.HIT) == hits).all()
    assert hits.all() if height < 0.0 else not hits.all()


POLYNOMIALS = {
    "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z": 4,
    "(x^2 + y^2 + z^2 - 1)^2*5 - 4*(3*x^2 - y^2)*(3*y^2 - z^2)*(3*z^2 - x^2)": 6,
    "x*y - z^3 + 0.1": 3,
    "x^2 + 2*y^2 + x*z - 0.3": 2,
    "x^5 - y^2*z + 0.05": 5,
    "(x^2 + y^2 - 0.3)^3*z + 0.01*x": 7,
    "1000*(x^2 - 0.25) + x*y*z": 3,
    "x^8 + y^8 + z^8 - 0.5": 8,
}


@pytest.mark.parametrize("text", POLYNOMIALS)
@settings(max_examples=8)
@given(seed=st.integers(0, 999), clip=st.sampled_from([0.0, 0.6, 1.1]), spread=st.sampled_from([0.02, 1.0]))
def test_polynomials_are_met_where_the_certified_routine_meets_them(text, seed, clip, spread):
    tape = tape_of(f"max({text}, sqrt(x^2 + y^2 + z^2) - {clip})" if clip else text)
    plan = plan_of(tape)
    assert plan[3] >= 0
    assert plan[4 + plan[3]] == POLYNOMIALS[text]
    generator = np.random.default_rng(seed)
    aim = generator.uniform(-0.5, 0.5, 3)
    way = generator.normal(size=3)
    origins, directions = bundle(aim - way, way, generator, 150, spread)
    t0, t1 = np.full(150, 0.1), np.full(150, 2.0)
    agree_with_the_certified(tape, origins, directions, t0, t1, within=1e-5)


WAVES = "sin(9*x)*cos(8*y) + sin(7*y)*cos(9*z) + 0.3"
BALL = "sqrt(x^2 + y^2 + z^2) - 1"
CUT = {
    f"max({WAVES}, {BALL})": 1,
    f"0.5*max(x^2 + y^2 + z^2 - 1, {WAVES})": 1,
    f"max(max({WAVES}, z - 0.3), max({BALL}, 0.2*(x + y)))": 3,
    f"max(min({WAVES}, {BALL}), max({BALL}, z - 0.3))": 2,
    f"max({WAVES}, 0.5 - sqrt(x^2 + y^2 + z^2))": 0,  # a hollow is not convex: rays are not cut by it
    f"min({WAVES}, {BALL})": 0,
    "max(z - x, x - 0.5)": 1,
}


@pytest.mark.parametrize("text", CUT)
@settings(max_examples=6)
@given(seed=st.integers(0, 999), spread=st.sampled_from([0.02, 1.0]))
def test_rows_that_rays_are_cut_by_are_looked_at_where_a_root_is_found(text, seed, spread):
    tape = tape_of(text)
    rows = clip_rows(tape)
    assert len(rows) == CUT[text]
    generator = np.random.default_rng(seed)
    origins, directions = bundle(np.array([0.1, 0.2, 3.0]), np.array([0.0, 0.1, -2.0]), generator, 200, spread)
    # Rays of all lengths: those that pass all of the solid, begin inside of it, and end before it.
    t0, t1 = generator.uniform(0.3, 1.2, 200), generator.uniform(1.3, 3.0, 200)
    agree_with_the_certified(tape, origins, directions, t0, t1, within=1e-5, cut=rows)


def test_rays_that_begin_where_they_are_cut_need_no_certified_routine():
    generator = np.random.default_rng(3)
    tape = tape_of(f"max(sin(x + 2*y) - 0.9 + z, {BALL})")
    memory = Memory(tape, 256, clip_rows(tape))
    origins, directions = bundle(np.array([0.1, 0.2, -3.0]), np.array([0.0, 0.05, 1.0]), generator, 256, 0.02)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    along = -(origins * directions).sum(axis=1)
    reach = np.sqrt(along**2 + 1.0 - (origins**2).sum(axis=1))
    memory.rays[:3], memory.rays[3:6] = origins.T, directions.T
    memory.rays[6], memory.rays[7] = along - reach, along + reach
    for anywhere in (False, True):
        _, certified = memory.settle(256, anywhere)
        assert certified == 0
        assert (memory.found[ray_rows.FOUND_STATUS] == ops.HIT).all()
        if not anywhere:
            assert memory.found[ray_rows.FOUND_ROOT] == pytest.approx(along - reach, abs=1e-9)


@pytest.mark.parametrize("text", ["max({}, sin(x) - 2)", "min(exp(x), {})", "-min(-({}), 2 - sin(x))*3"])
def test_branches_that_do_not_change_the_sign_cost_no_enclosures(text):
    spent = []
    for one in (WAVES, text.format(WAVES)):
        generator = np.random.default_rng(1)
        memory = Memory(tape_of(one), 256)
        origins, directions = bundle(np.array([0.1, 0.2, -3.0]), np.array([0.0, 0.05, 1.0]), generator, 256, 0.02)
        memory.rays[:3], memory.rays[3:6], memory.rays[6], memory.rays[7] = origins.T, directions.T, 0.1, 4.0
        spent.append((memory.settle(256, False), memory.found[ray_rows.FOUND_ROOT].copy()))
    assert spent[0][0] == spent[1][0]
    assert np.abs(spent[0][1] - spent[1][1]).max() < 1e-9


def test_shadow_rays_that_end_on_the_ball_inside_a_polynomial_need_no_certified_routine():
    generator = np.random.default_rng(5)
    tape = tape_of("max(x^2*y^2 + y^2*z^2 - 0.1 - z, sqrt(x^2 + y^2 + z^2) - 1)")
    memory = Memory(tape, 256)
    begins = generator.uniform(-0.6, 0.6, (256, 3)) - [0.0, 0.0, 0.1]
    ways = generator.normal(size=(256, 3)) * 0.1 + [0.3, 0.1, 1.0]
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    along = (begins * ways).sum(axis=1)
    ends = np.sqrt(along**2 + 1.0 - (begins**2).sum(axis=1)) - along
    memory.rays[:3], memory.rays[3:6], memory.rays[6], memory.rays[7] = begins.T, ways.T, 0.0, ends
    _, certified = memory.settle(256, anywhere=True)
    assert certified == 0
    status, _ = cast(tape, begins, ways, np.zeros(256), ends)
    hits = (status == ops.HIT) | (status == ops.INSIDE)
    assert ((memory.found[0] == ops.HIT) == hits).all()
    assert hits.sum() > 100


@settings(max_examples=30)
@given(seed=st.integers(0, 999), far=st.sampled_from([2.0, 30.0, 1e3]))
def test_roots_of_polynomials_are_polished_to_float64(seed, far):
    generator = np.random.default_rng(seed)
    ways = (
        np.array([0.0, 0.0, 1.0])
        + generator.uniform(-0.5, 0.5, 2) @ np.eye(3)[:2]
        + 1e-3 * generator.normal(size=(100, 3))
    )
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    centers = generator.uniform(-0.9, 0.9, (100, 3))
    origins = centers - far * ways
    along = -(centers * ways).sum(axis=1)
    left = along**2 - (centers**2).sum(axis=1) + 1.0
    middle = far + along
    status, t = cast_together(tape_of("x^2 + y^2 + z^2 - 1"), origins, ways, middle - 2.0, middle + 2.0)
    assert ((status == ops.HIT) == (left > 0.0))[abs(left) > 1e-9].all()
    clear = left > 0.01
    assert t[clear] == pytest.approx((middle - np.sqrt(np.maximum(left, 0.0)))[clear], abs=1e-14 * far)


LOWERED = {
    "blobby": Blobby(
        points=const(np.array([[-0.5, 0, 0], [0.4, 0.1, 0], [0.5, 0.6, 0.1]])), radius=const(0.6), threshold=0.2
    ),
    "formula": Formula(field=formula("x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z"), unit=0.7, bounds=Within(ball=0.9)),
}


@pytest.mark.parametrize(("word", "row"), [("blobby", 0), ("formula", 3)])
@settings(max_examples=8)
@given(seed=st.integers(0, 999))
def test_multiples_of_what_has_a_plan_have_one(word, row, seed):
    (shape,) = traced(LOWERED[word], word, IDENTITY, FakeMoment())
    assert plan_of(shape.tape)[row] >= 0
    generator = np.random.default_rng(seed)
    way = generator.normal(size=3)
    origins, directions = bundle(generator.uniform(-0.3, 0.3, 3) - way, way, generator, 150, 0.3)
    agree_with_the_certified(shape.tape, origins, directions, np.full(150, 0.1), np.full(150, 2.0), within=1e-5)


def test_other_fields_than_densities_of_points_have_no_plan():
    segment, point = PARTS[:1].copy(), PARTS[:1].copy()
    segment[0, 3:6] = segment[0, :3] + [0.1, 0.0, 0.0]
    point[0, 3:6] = point[0, :3]

    def minus(parts, scale=1.0, threshold=0.3):
        return implicit(lambda b, op, c: op("sub", c(threshold), b.density(parts, op("mul", b.x, c(scale)), b.y, b.z)))

    assert plan_of(minus(point))[0] >= 0
    assert plan_of(minus(point, threshold=-0.05))[0] < 0  # inside is what no part reaches, too
    assert plan_of(minus(segment))[0] < 0
    assert plan_of(minus(point, 2.0))[0] < 0
    turned = implicit(
        lambda b, op, c: op("mul", op("sub", c(0.3), b.density(point, b.x, b.y, b.z)), c(-2.0)),
    )
    assert plan_of(turned)[0] < 0
    assert (plan_of(tape_of("sin(x) + y^2"))[[0, 3]] < 0).all()
    assert plan_of(tape_of("x^9 + y"))[3] < 0
    assert plan_of(implicit(lambda b, op, c: op("sub", b.density(point, b.x, b.y, b.z), c(0.3))))[0] < 0
    corners = np.zeros((1, 3, 3))
    for kernel, groups in ((1, [0]), (0, [0, 0])):
        number = len(groups)
        other = Skeleton(
            corners.repeat(number, axis=0), np.ones((number, 2)), np.ones(number), np.array(groups), kernel
        )  # fmt: skip
        tape = implicit(lambda b, op, c, other=other: op("sub", c(0.3), b.skeleton(other, b.x, b.y, b.z)))
        assert plan_of(tape)[0] < 0


def test_a_thin_shell_has_no_holes_in_packets():
    tape = implicit(
        lambda b, op, c: op(
            "sub",
            op(
                "abs",
                op(
                    "sub",
                    op("sqrt", op("add", op("add", op("square", b.x), op("square", b.y)), op("square", b.z))),
                    c(0.7),
                ),
            ),
            c(1e-3 / 2),
        )
    )
    generator = np.random.default_rng(1)
    points = generator.uniform(-0.75, 0.75, (1000, 2))
    origins = np.column_stack([points, np.full(1000, 2.0)])
    status, t = cast_together(tape, origins, np.tile([0.0, 0, -1], (1000, 1)), np.zeros(1000), np.full(1000, 4.0))
    off = (points**2).sum(axis=1)
    assert ((status == ops.HIT) == (off < 0.7005**2)).all()
    hit = status == ops.HIT
    assert t[hit] == pytest.approx(2.0 - np.sqrt(0.7005**2 - off[hit]), abs=1e-6)
