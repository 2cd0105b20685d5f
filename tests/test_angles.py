"""Angles in fields: their cut is a jump where whole turns matter, and none where they do not."""

from __future__ import annotations

import numpy as np
import pytest

from common_scenes import TOLERANCE, certified, tape_of
from ray_bundles import cast_together
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.packets.packets import tape_of_rows
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.simplify_kernels import simplify
from sceneql.field.tape.tape_solid import cast, field_values, scratch


def test_the_cut_of_an_angle_is_a_jump():
    """From pi to -pi: the mean value form must not reach over it."""
    for aside in (-1.0, -0.3, -1e-6):
        segments = [[aside, 1.0, 0.2]], [[0.0, -1.0, 0.1]], np.zeros(1), np.full(1, 2.5)
        for status, t in (
            cast(tape_of("atan2(y, x)"), *segments, TOLERANCE),
            certified(tape_of("atan2(y, x)"), *segments),
        ):
            assert status[0] == ops.HIT
            assert t[0] == pytest.approx(1.0, abs=1e-8)


ROUND = ["5*atan2(y, x)", "z - 3*atan2(y, x)", "8*hypot(x, y) + 2*atan2(y, x)", "3*acos(x/hypot(x, y))"]


def over_the_cut(count):
    """(origins, ways) of rays across the half plane y = 0 > x."""
    generator = np.random.default_rng(1)
    sides = generator.uniform(-1.0, -0.3, count), generator.uniform(-0.3, 0.3, count)
    origins = np.column_stack([*sides, np.ones(count)])
    return origins, np.column_stack([generator.uniform(-0.2, 0.2, count), -3.0 * sides[1], np.full(count, -0.3)])


@pytest.mark.parametrize("angle", ROUND)
def test_angles_in_waves_have_no_cut(angle):
    tape = tape_of(f"hypot(x, y) - 0.6 - 0.2*cos({angle})")
    origins, ways = over_the_cut(100)
    status, t = cast(tape, origins, ways, 0.0, 3.0, TOLERANCE)
    assert (status != ops.UNDECIDED).all()
    places = np.linspace(0.0, 3.0, 1001)
    inside = field_values(tape, (origins[:, None] + places[:, None] * ways[:, None]).reshape(-1, 3)) < -1e-9
    inside = inside.reshape(100, -1)
    assert not (inside.any(axis=1) & (status == ops.MISS)).any()
    assert not (inside & (places < t[:, None] - 1e-6)).any()
    program = tape.code, tape.constants, tape.parts, scratch(tape)
    for o, d in zip(origins[:20], ways[:20], strict=True):
        for t0, t1 in ((0.0, 3.0), (0.32, 0.35), (0.333333, 0.333334)):
            low, high, least, most, _ = on_ray(*program, *o, *d, t0, t1, 1.0)
            f = field_values(tape, o + np.linspace(t0, t1, 21)[:, None] * d)
            assert ((f >= low) & (f <= high)).all()
            assert (np.diff(f) >= least * (t1 - t0) / 20 - 1e-14).all()
            assert (np.diff(f) <= most * (t1 - t0) / 20 + 1e-14).all()


@pytest.mark.parametrize("angle", ROUND)
def test_angles_in_shorter_tapes_have_no_cut_either(angle):
    whole = tape_of(f"max(hypot(x, y) - 0.6 - 0.2*cos({angle}), z - 9)")
    origins, ways = over_the_cut(1000)
    order = np.argsort(origins[:, 0])
    status, _ = cast_together(whole, origins[order], ways[order], np.zeros(1000), np.full(1000, 3.0))
    assert (status != ops.UNDECIDED).all()
    room, place = scratch(whole), (-1.0, -0.99, -0.001, 0.001, 0.1, 0.101)
    expected = box(whole.code, whole.constants, whole.parts, room, *place)
    short = np.zeros_like(whole.code)
    rows, _ = simplify(whole.code, whole.parts, room, True, short, np.zeros((1, 8)))
    assert rows < len(whole.code)
    assert box(short[:rows], whole.constants, whole.parts, room, *place) == expected


def test_the_tape_of_a_row_knows_of_which_angles_whole_turns_do_not_matter():
    whole = tape_of("max(cos(5*atan2(z, y)), x)")
    wave = tape_of_rows(whole, [int(whole.code[-1, 1:3].max())])
    assert wave[wave[:, 0] == ops.ATAN2, 3].tolist() == [1]


@pytest.mark.parametrize(
    "formula", ["cos(2.5*atan2(y, x))", "atan2(y, x)", "atan2(y, x)*cos(atan2(y, x))", "atan2(y, x)^2"]
)
def test_angles_of_which_whole_turns_matter_keep_their_cut(formula):
    assert not (tape_of(formula).code[:, 3] * (tape_of(formula).code[:, 0] == ops.ATAN2)).any()
