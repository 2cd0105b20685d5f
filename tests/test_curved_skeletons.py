"""Laws of curves in skeletons: their best points, every evaluator over them, and how smooth a spline's skin is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from lane_checks import check_enclosures
from sceneql.field.skeleton.skeleton import KERNELS, Skeleton
from sceneql.field.tape.batch_gradient_kernels import differentiate
from sceneql.field.tape.batch_kernels import LANES, evaluate
from sceneql.field.tape.tape_solid import field_gradients, field_values
from sceneql.shapes.spline import OFF, smooth
from test_skeletons import FALLOFF, POINTS, check_box, check_segment, tape_of

CURVES = {
    "gentle": [[-0.6, 0.1, 0.2], [0.7, 0.3, -0.1], [0.0, 0.5, 0.3]],
    "hairpin": [[-0.5, 0.0, 0.1], [-0.5, 0.1, 0.1], [1.3, 0.1, -0.2]],
    "straight": [[-0.5, 0.1, 0.2], [0.7, 0.3, -0.1], [0.1, 0.2, 0.05]],
    "to and fro": [[-0.3, 0.1, 0.2], [-0.3, 0.1, 0.2], [0.9, 0.1, 0.2]],
    "short": [[0.2, 0.2, 0.2], [0.2001, 0.2001, 0.2], [0.2001, 0.2, 0.2]],
    "no length": [[0.2, 0.2, 0.2]] * 3,
}
RADII = [(0.9, 0.9, 0.9), (0.9, 0.4, 0.5), (0.3, 0.3, 0.9), (0.9, 0.8, 0.2)]
"""At a, b and the control point c."""


def curves(corners, radii, weight=1.0, kernel="wyvill"):
    corners, radii = np.array(corners, dtype=float), np.array(radii, dtype=float)
    n = len(corners)
    return Skeleton(corners, radii[:, :2].copy(), np.full(n, weight), np.zeros(n), KERNELS.index(kernel), radii[:, 2])


def along(corners, radii, q):
    """(places, radii) at q (n,) of one curve."""
    (a, b, c), (ra, rb, rc) = np.array(corners), radii
    basis = np.stack([(1 - q) ** 2, q**2, 2 * q * (1 - q)], axis=1)
    return basis @ np.array([a, b, c]), basis @ np.array([ra, rb, rc])


def farness(corners, radii, points, n=4001):
    """Least |x - p|/R(p) of points over samples of a curve."""
    places, sizes = along(corners, radii, np.linspace(0.0, 1.0, n))
    return (np.linalg.norm(points[:, None] - places, axis=2) / sizes).min(axis=1)


@pytest.mark.parametrize("radii", RADII)
@pytest.mark.parametrize("kind", CURVES)
def test_density_is_the_kernel_of_the_best_point(kind, radii):
    points = np.random.default_rng(5).uniform(-1.4, 1.4, (150, 3))
    for kernel in ("wyvill", "metaball"):
        r = farness(CURVES[kind], radii, points)
        expected = np.where(r < 1, FALLOFF[kernel](np.minimum(r, 1.0)), 0.0)
        found = field_values(tape_of(curves([CURVES[kind]], [radii], kernel=kernel)), points)
        assert found == pytest.approx(expected, abs=1e-6)
        assert (found >= expected - 1e-13).all()  # no sample is better than the best point
    on, _ = along(CURVES[kind], radii, np.linspace(0.0, 1.0, 40))
    assert field_values(tape_of(curves([CURVES[kind]], [radii])), on) == pytest.approx(1.0, abs=1e-12)


@settings(max_examples=examples(150))
@given(
    corners=st.tuples(POINTS, POINTS, POINTS), radii=st.tuples(*[st.sampled_from([0.2, 0.5, 0.9, 2.0])] * 3), x=POINTS
)
def test_no_sample_of_any_curve_is_better_than_the_best_point(corners, radii, x):
    value = field_values(tape_of(curves([corners], [radii])), np.array([x]))[0]
    r = farness(corners, radii, np.array([x]), 1001)[0]
    assert value >= FALLOFF["wyvill"](min(r, 1.0)) - 1e-12


def test_a_point_at_the_center_of_curvature_has_a_best_point():
    # All of the polynomial's roots come together: y = x^2 about (0, 1/2).
    parabola = [[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, -1.0, 0.0]]
    for height in (0.5 - 1e-6, 0.5, 0.5 + 1e-9, 0.6):
        least = 0.5 if height <= 0.5 else np.sqrt(height - 0.25)
        least = height if height <= 0.5 else least
        value = field_values(tape_of(curves([parabola], [(2.0, 2.0, 2.0)])), np.array([[0.0, height, 0.0]]))[0]
        assert value == pytest.approx((1 - (least / 2.0) ** 2) ** 3, abs=1e-12)


@pytest.mark.parametrize("kind", CURVES)
@settings(max_examples=25)
@given(
    origin=POINTS,
    direction=POINTS,
    size=st.sampled_from([0.0, 1e-7, 1e-3, 0.1, 1.0, 8.0]),
    radii=st.sampled_from([*RADII, (1e-6, 1e-6, 2e-6)]),
    weight=st.sampled_from([1.0, -0.7]),
    kernel=st.sampled_from(KERNELS),
)
def test_enclosures_contain_every_value(kind, origin, direction, size, radii, weight, kernel):
    tape = tape_of(curves([CURVES[kind]], [radii], weight, kernel))
    origin, direction = np.array(origin), np.array(direction)
    check_segment(tape, origin, direction, -size, size)
    check_enclosures(tape, origin, direction, -size, size)
    check_box(tape, origin, origin + size * np.abs(direction))


@pytest.mark.parametrize("radii", RADII)
@pytest.mark.parametrize("kind", ["gentle", "hairpin", "straight"])
def test_gradient_is_that_of_differences(kind, radii):
    tape, h = tape_of(curves([CURVES[kind]], [radii])), 1e-6
    points = np.random.default_rng(3).uniform(-0.9, 0.9, (60, 3))
    steps = [field_values(tape, points + h * axis) - field_values(tape, points - h * axis) for axis in np.eye(3)]
    wide = [field_values(tape, points + 9 * h * axis) - field_values(tape, points - 9 * h * axis) for axis in np.eye(3)]
    central, wider = np.array(steps).T / (2 * h), np.array(wide).T / (18 * h)
    even = np.abs(central - wider).max(axis=1) < 1e-5
    assert even.mean() > 0.8
    assert field_gradients(tape, points)[even] == pytest.approx(central[even], abs=1e-7, rel=1e-7)


def spline(n=7, seed=1):
    """Corners and radii of a spline through random points."""
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.uniform([0.2, -0.15, -0.15], [0.4, 0.15, 0.15], (n, 3)), axis=0) - [1.0, 0.0, 0.0]
    return points, *smooth(points, rng.uniform(0.2, 0.4, n), False)


def test_many_points_have_the_bits_of_one():
    _, corners, radii = spline()
    tape = tape_of(curves(corners, radii))
    points = np.random.default_rng(4).uniform(-1.3, 1.3, (LANES, 3))
    registers, slope = np.empty((len(tape.code), LANES)), np.empty((len(tape.code), 3, LANES))
    program = (tape.code, tape.constants, tape.parts, registers)
    evaluate(*program, np.ascontiguousarray(points.T), LANES)
    assert (registers[-1] == field_values(tape, points)).all()
    differentiate(*program, slope, LANES)
    assert (field_gradients(tape, points) == slope[-1].T).all()


@settings(max_examples=40)
@given(origin=POINTS, direction=POINTS, size=st.sampled_from([1e-4, 0.05, 0.5, 4.0]))
def test_enclosures_of_a_spline_contain_every_value(origin, direction, size):
    _, corners, radii = spline()
    tape = tape_of(curves(corners, radii))
    origin, direction = np.array(origin), np.array(direction)
    check_segment(tape, origin, direction, -size, size)
    check_enclosures(tape, origin, direction, -size, size)
    check_box(tape, origin, origin + size * np.abs(direction))


def test_normals_do_not_jump_where_the_curves_of_a_spline_meet():
    _, corners, radii = spline()
    tape = tape_of(curves(corners, radii))
    tangents = corners[:-1, 1] - corners[:-1, 2]
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    aside = np.cross(tangents, [0.3, -0.5, 0.8])
    aside /= np.linalg.norm(aside, axis=1)[:, None]
    for turn in np.linspace(0.0, 2 * np.pi, 12):
        off = np.cos(turn) * aside + np.sin(turn) * np.cross(tangents, aside)
        places = corners[:-1, 1] + 0.55 * radii[:-1, 1:2] * off
        sides = []
        for step in (-1e-7, 1e-7):
            slopes = field_gradients(tape, places + step * tangents)
            sides.append(slopes / np.linalg.norm(slopes, axis=1)[:, None])
        turned = np.linalg.norm(sides[1] - sides[0], axis=1)
        assert turned.max() < 1e-5  # radians over 2e-7 m, of a surface whose curvature is some 10/m


@settings(max_examples=40)
@given(st.lists(st.tuples(*[st.floats(-2, 2)] * 3), min_size=3, max_size=6, unique=True), st.booleans())
def test_a_spline_is_a_smooth_line_through_its_points(points, closed):
    points = np.array(points)
    path = np.concatenate([points, points[:1]]) if closed else points
    if np.linalg.norm(np.diff(path, axis=0), axis=1).min() < 1e-3:
        return
    sizes = np.linspace(0.2, 0.4, len(points))
    corners, radii = smooth(path, np.concatenate([sizes, sizes[:1]]) if closed else sizes, closed)
    assert max(np.linalg.norm(corners[:, :2] - point, axis=2).min() for point in points) < 1e-12
    assert radii.min() > 0.09
    assert np.array_equal(corners[1:, 0], corners[:-1, 1])
    whole = np.concatenate([corners, radii[:, :, None]], axis=2)
    leaving, entering = whole[:, 1] - whole[:, 2], whole[:, 2] - whole[:, 0]
    meet = zip(leaving if closed else leaving[:-1], np.roll(entering, -1, axis=0), strict=False)
    for one, other in meet:
        longer = max(np.linalg.norm(one), np.linalg.norm(other))
        across = one * np.linalg.norm(other) - other * np.linalg.norm(one)
        assert np.linalg.norm(across) <= 1e-9 * longer * longer + 1e-12


def test_a_spline_keeps_to_the_cubic_with_the_slopes_of_chords():
    from scipy.interpolate import CubicHermiteSpline

    points, corners, radii = spline()
    t = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    slopes = np.empty_like(points)
    slopes[1:-1] = (points[2:] - points[:-2]) / (t[2:] - t[:-2])[:, None]
    slopes[0], slopes[-1] = ((points[k + 1] - points[k]) / (t[k + 1] - t[k]) for k in (0, -2))
    cubic = CubicHermiteSpline(t, points, slopes)(np.linspace(0.0, t[-1], 20_001))
    q = np.linspace(0.0, 1.0, 20)
    on = np.concatenate([along(c, r, q)[0] for c, r in zip(corners, radii, strict=True)])
    off = [np.linalg.norm(cubic - place, axis=1).min() for place in on]
    assert max(off) < OFF * radii.max() + 1e-4
