"""Certified roots against exact rational arithmetic: nothing is missed, nothing is invented, in either mode."""

from __future__ import annotations

import numpy as np
import pytest
from flint import fmpq_poly
from hypothesis import example, given, settings

from campaigns import LONG, examples
from common_scenes import COMMON, RAYS, SCENES, TOLERANCE, certified, check, chords, rays, scene, tape_of
from exact_rays import along, blob_entry, exact, first_entry, real_roots, roots_of
from plain_tapes import implicit
from random_tapes import SMOOTH, tapes
from random_tapes import rays as some_rays
from sceneql.field.enclose.enclosure_kernels import segment
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.roots.isolation_kernels import any_root
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_solid import cast, field_values, scratch

POLYNOMIALS = ("barth_sextic", "kummer", "steiner", "double_root")


def solid_entries(tape, origins, directions, t0, t1):
    expected = []
    for o, d, a, b in zip(origins, directions, t0, t1, strict=True):
        f = along(tape, o, d)
        expected.append(first_entry(lambda t, f=f: f(t) < 0, roots_of(f), a, b))
    return expected


@pytest.mark.parametrize("name", POLYNOMIALS)
def test_first_roots_are_those_of_exact_arithmetic(name):
    tape, clip = scene(name)
    segments = rays(clip)
    expected = solid_entries(tape, *segments)
    assert len({outcome for outcome, _ in expected}) > 1 or name == "double_root"
    assert check(*cast(tape, *segments, TOLERANCE), expected, *segments[2:]) == 0
    assert check(*certified(tape, *segments), expected, *segments[2:], inside_is_hit=True) == 0


def test_first_roots_of_forty_blobs_are_those_of_exact_arithmetic():
    tape, clip = scene("blob40")
    found = SCENES["blob40"]
    segments = rays(clip, RAYS // (3 if LONG else 10))
    expected = [
        blob_entry(found["parts"], found["threshold"], (o, d), a, b) for o, d, a, b in zip(*segments, strict=True)
    ]
    assert check(*cast(tape, *segments, TOLERANCE), expected, *segments[2:]) == 0
    assert check(*certified(tape, *segments), expected, *segments[2:], inside_is_hit=True) == 0


def test_first_roots_of_the_thin_shell_are_those_of_exact_arithmetic():
    tape, clip = scene("shell")
    segments = rays(clip)
    expected = []
    for o, d, a, b in zip(*segments, strict=True):
        x, _, z = lines = [fmpq_poly([exact(p), exact(q)]) for p, q in zip(o, d, strict=True)]
        squared = sum((line * line for line in lines), fmpq_poly([0]))
        inner, outer = (squared - (exact(0.7) + sign * exact(0.0005)) ** 2 for sign in (-1, 1))
        plane = exact(0.6) * x + exact(0.8) * z - exact(0.2)
        faces = (inner, outer, plane)
        expected.append(
            first_entry(lambda t, f=faces: f[0](t) > 0 and f[1](t) < 0 and f[2](t) < 0, roots_of(*faces), a, b)
        )
    assert check(*cast(tape, *segments, TOLERANCE), expected, *segments[2:]) == 0
    assert check(*certified(tape, *segments), expected, *segments[2:], inside_is_hit=True) == 0


@pytest.mark.parametrize("name", POLYNOMIALS)
def test_surface_roots_are_those_of_exact_arithmetic(name):
    tape, clip = scene(name)
    segments = rays(clip, 400)
    expected = []
    for o, d, a, b in zip(*segments, strict=True):
        places = [float(place.mid()) for place, _ in real_roots(along(tape, o, d))]
        places = [place for place in places if a <= place <= b]
        expected.append(("hit", places[0]) if places else ("miss", None))
    assert check(*cast(tape, *segments, TOLERANCE, surface=True), expected, *segments[2:]) == 0
    assert check(*certified(tape, *segments, touching=True), expected, *segments[2:]) == 0


@pytest.mark.parametrize("text", ["abs(x)^2.5", "sqrt(abs(x))", "(x^2)^0.75", "sqrt(x^2)"])
def test_powers_and_roots_of_what_is_never_negative_are_defined_all_over(text):
    def enclosed(tape):
        room = scratch(tape)
        return segment(tape.code, tape.constants, tape.parts, room, -1.0, 0.1, 0.2, 1.0, 0.0, 0.0, 0.75, 1.5, True)

    c0, c1, e, status = enclosed(tape_of(text))
    assert status == ops.WHOLE
    assert c0 + abs(c1) + e >= 0.5**2.5
    assert enclosed(tape_of("x^2.5"))[3] != ops.WHOLE


PHI = (1 + 5**0.5) / 2
NODES = {
    "barth_sextic": [(1, 0, 0), np.array([1, PHI, PHI**2]) / np.sqrt(1 + PHI**2 + PHI**4)],
    "kummer": [(0, 0.3**0.5, 1), (0, 0.15 * 2**0.5, 0.15)],
    "steiner": [(0, 0, 0), (0.25, 0, 0)],
}


@pytest.mark.parametrize("name", sorted(NODES))
def test_the_double_points_are_some(name):
    tape, _ = scene(name)
    program = tape.code, tape.constants, tape.parts, scratch(tape)
    assert np.array([gradient(*program, *map(float, node)) for node in NODES[name]]) == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-8, 1e-5])
@pytest.mark.parametrize("name", sorted(NODES))
def test_no_crossing_is_invented_or_lost_near_double_points(name, off):
    tape, clip = scene(name)
    origins = rays(clip, 60, seed=5)[0]
    nodes = np.array(NODES[name], dtype=float)
    aims = nodes[np.arange(60) % len(nodes)] + off * np.random.default_rng(7).normal(size=(60, 3))
    segments = (origins, *chords(origins, aims - origins, clip))
    check(*cast(tape, *segments, TOLERANCE), solid_entries(tape, *segments), *segments[2:])


@pytest.mark.parametrize("formula", ["x^2 + y^2 + z^2 - 0.49", "(x^2 + y^2 + z^2 - 0.49)^3", "x^3 - 0.3*x + y^2 + z"])
def test_grazing_rays_are_told_apart_or_left_undecided(formula):
    tape = tape_of(formula)
    off = np.concatenate([[0.0], 10.0 ** -np.arange(2.0, 17.0)])
    heights = 0.7 + np.concatenate([off, -off])
    origins = np.column_stack([heights, np.zeros(len(heights)), np.full(len(heights), 2.0)])
    directions = np.tile([0.0, 0.0, -1.0], (len(heights), 1))
    segments = origins, directions, np.zeros(len(heights)), np.full(len(heights), 4.0)
    status, t = cast(tape, *segments, TOLERANCE)
    assert check(status, t, solid_entries(tape, *segments), *segments[2:]) <= 8


@pytest.mark.parametrize(
    "formula",
    [
        "(x^2 + y^2 + z^2 - 0.49)^2",
        "(x^2 + y^2 + z^2)^2 - 0.98*(x^2 + y^2 + z^2) + 0.2401",
        "(x^2 + y^2 + z^2 - 0.49)^4",
        "abs(x^2 + y^2 + z^2 - 0.49)",
        "(x^2 + y^2 + z^2 - 0.49)^3",
        "-(x^2 + y^2 + z^2 - 0.49)^2",
    ],
)
def test_every_pixel_of_a_multiple_root_is_found(formula):
    tape = tape_of(formula)
    ticks = np.linspace(-0.99, 0.99, 41)
    x, y = (c.ravel() for c in np.meshgrid(ticks, ticks))
    origins = np.column_stack([x, y, np.full(len(x), 2.0)])
    status, t = cast(tape, origins, [[0.0, 0.0, -1.0]], 0.0, 4.0, TOLERANCE, surface=True)
    depth = 0.49 - x * x - y * y
    assert (status == np.where(depth > 0.0, ops.HIT, ops.MISS)).all()
    # At a root of multiplicity m rounding leaves a place uncertain by the m-th root of it, but for that of df/dt.
    assert t[depth > 0.0] == pytest.approx(2.0 - np.sqrt(depth[depth > 0.0]), abs=1e-5)


def test_poles_and_jumps_are_no_part_of_a_surface():
    for formula, places in [("1/z", []), ("1/z - 2", [0.5]), ("tan(z)", [0.0])]:
        status, t = cast(tape_of(formula), [[0.1, 0.2, 1.0]], [[0.0, 0.0, -1.0]], 0.0, 2.5, surface=True)
        assert status[0] == (ops.HIT if places else ops.MISS)
        if places:
            assert t[0] == pytest.approx(1.0 - places[0], abs=1e-9)


@pytest.mark.parametrize(
    "formula",
    [
        "2 - tanh(1000*x)",
        "exp(1000*x) + 1",
        "1/(1 + exp(1000*x)) + 0.1",
        "exp(-1/x^2) + 0.01",
        "log(1 + exp(1000*x)) + 0.1",
        "1/x^2 + 1",
        "1/sqrt(x^2 + y^2) + 1",
        "abs(x)^abs(x) + y^2 + 0.01",
        "cosh(800*x) - 0.5",
        "x^200 + 0.1",
    ],
)
def test_what_overflows_or_has_a_pole_is_told_from_zero(formula):
    tape = tape_of(formula)
    origins = np.column_stack([np.full(9, -2.0), np.linspace(-0.8, 0.8, 9), np.full(9, 0.1)])
    segments = origins, np.array([[1.0, 0.0, 0.05]]).repeat(9, axis=0), np.zeros(9), np.full(9, 4.0)
    assert (cast(tape, *segments, TOLERANCE)[0] == ops.MISS).all()
    assert (cast(tape, *segments, TOLERANCE, surface=True)[0] == ops.MISS).all()


@pytest.mark.parametrize(("formula", "begin"), [("1.5 - floor(y) + x", 0.25), ("1.5 - floor(y) - x", -0.25)])
def test_a_ray_in_a_plane_of_jumps_misses_nothing(formula, begin):
    """Of floor(2) rounding makes 1 or 2: what is inside must not be proved to be outside."""
    segments = [[begin, 2.0, 0.0]], [[1.0, 0.0, 0.0]], np.zeros(1), np.full(1, 0.6)
    assert field_values(tape_of(formula), np.array(segments[0]))[0] < 0.0
    assert cast(tape_of(formula), *segments, TOLERANCE)[0][0] != ops.MISS


def test_what_is_zero_all_along_is_undecided():
    """A polynomial that is zero but for its rounding."""
    tape = tape_of("(x + 1)^4 - x^4 - 4*x^3 - 6*x^2 - 4*x - 1")
    for surface in (False, True):
        assert cast(tape, [[0.3, 0.2, 1.0]], [[0.1, 0.2, -1.0]], 0.0, 2.0, surface=surface)[0][0] == ops.UNDECIDED


def test_a_ray_that_begins_on_a_surface_does_not_meet_it_there():
    for formula in ("x^2 + y^2 + z^2 - 0.49", "(x^2 + y^2 + z^2 - 0.49)^2"):
        tape = tape_of(formula)
        status, t = cast(tape, [[0.0, 0.0, 0.7]], [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], 0.0, 2.0, surface=True)
        assert status.tolist() == [ops.HIT, ops.MISS]
        assert t[0] == pytest.approx(1.4, abs=1e-9)


@settings(max_examples=examples(300))
@given(tape=tapes(), ray=some_rays())
@example(
    tape=implicit(lambda b, op, c: op("sin", op("pow", b.y, b.z))),
    ray=(np.array([0.0, 0.484375, -1.0]), np.array([0.0, 0.0, 2.0]), -2.0, -1.999999999),
)
@example(
    tape=implicit(lambda b, op, c: op("sin", op("pow", b.y, b.z))),
    ray=(np.array([0.0, 0.5, 0.0]), np.array([0.0, 0.0625, 2.0]), -2.0, -1.999999999),
)
def test_bounds_on_a_ray_contain_values_and_slopes(tape, ray):
    origin, direction, t0, t1 = ray
    program = tape.code, tape.constants, tape.parts, scratch(tape)
    low, high, least, most, status = on_ray(*program, *origin, *direction, t0, t1, -1.0)
    t = np.linspace(t0, t1, 41)
    f = -field_values(tape, origin + t[:, None] * direction)
    if status == ops.NOWHERE:
        assert np.isnan(f).all()
        return
    known = ~np.isnan(f)
    assert known.all() or status != ops.WHOLE
    assert ((f >= low) & (f <= high))[known].all()
    if np.isfinite([least, most]).all() and t1 > t0:
        # What the slopes bound is the change between any two places, but for the rounding of values at these: what is
        # made of large numbers is off by more than its own size tells.
        alone = np.array([on_ray(*program, *origin, *direction, place, place, -1.0)[:2] for place in t])
        blur = 1e-14 * (1.0 + np.abs(f).max()) + np.ptp(alone, axis=1).max()
        change = np.diff(f)
        assert (change >= least * np.diff(t) - blur).all()
        assert (change <= most * np.diff(t) + blur).all()


@settings(max_examples=examples(200))
@given(tape=tapes(names=SMOOTH), ray=some_rays())
def test_no_root_of_a_surface_is_missed(tape, ray):
    origin, direction, t0, t1 = ray
    status, t = cast(tape, origin, direction, t0, t1, TOLERANCE, surface=True)
    places = np.linspace(t0, t1, 401)
    f = field_values(tape, origin + places[:, None] * direction)
    sure = np.abs(f) > 1e-12 * (1.0 + np.abs(f).max())
    places, signs = places[sure], np.sign(f[sure])
    changes = np.flatnonzero(signs[1:] != signs[:-1])
    if len(changes):
        assert status[0] != ops.MISS
        assert t[0] <= places[changes[0] + 1] + TOLERANCE * (t1 - t0)
    if status[0] == ops.HIT:
        around = t[0] + TOLERANCE * (t1 - t0) * np.array([-1.0, 1.0])
        low, high, *_ = on_ray(tape.code, tape.constants, tape.parts, scratch(tape), *origin, *direction, *around, 1.0)
        assert low <= 0.0 <= high


@pytest.mark.parametrize("name", sorted(SCENES))
def test_no_pixel_of_a_common_scene_is_wrong(name):
    tape, clip = scene(name)
    view, (width, height) = COMMON["view"], (96, 54)
    pitch, yaw = np.radians([view["pitch_deg"], view["yaw_deg"]])
    about_x = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]])
    about_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    axes = about_x @ about_y
    tall = 0.5 * view["window_height_over_clip"] * clip
    u = (2.0 * (np.arange(width) + 0.5) - width) / height * tall
    v = (1.0 - 2.0 * (np.arange(height) + 0.5) / height) * tall
    places = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    places = places[np.hypot(*places.T) < 0.9999 * clip]
    origins = np.column_stack([places, np.full(len(places), 2.0 * clip)]) @ axes
    segments = (origins, *chords(origins, np.tile(-axes[2], (len(places), 1)), clip))
    surface = SCENES[name].get("mode") == "surface"
    status, t = cast(tape, *segments, TOLERANCE, surface=surface)
    assert (status != ops.UNDECIDED).all()
    truth, place = certified(tape, *segments, touching=surface)
    assert (np.where(status == ops.INSIDE, ops.HIT, status) == truth).all()
    assert (np.abs(t - place) <= TOLERANCE * (segments[3] - segments[2])).all()
    if not surface:
        program = tape.code, tape.constants, tape.parts, scratch(tape)
        some = range(0, len(origins), 7)
        blocked = [
            any_root(*program, *origins[k], *segments[1][k], segments[2][k], segments[3][k], TOLERANCE) for k in some
        ]
        assert all((found == ops.MISS) == (truth[k] == ops.MISS) for found, k in zip(blocked, some, strict=True))
