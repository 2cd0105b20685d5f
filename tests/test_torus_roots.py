"""Roots of tori along rays beside those of their quartic in exact arithmetic."""

from __future__ import annotations

import numpy as np
import pytest
from flint import fmpq_poly

from common_scenes import OUTCOMES, TOLERANCE, check
from exact_rays import exact, first_entry, roots_of
from moment import IDENTITY, FakeMoment, const
from sceneql.field.roots.isolation_kernels import exit_root
from sceneql.field.tape.tape_solid import cast, scratch
from sceneql.words.objects.torus import Torus


def torus_rays(radius, tube, kind, count=200):
    """(origins, directions, t0, t1) of rays at a torus about the y axis."""
    generator = np.random.default_rng(11)
    angle, around = generator.uniform(0.0, 2.0 * np.pi, (2, count))
    outward = np.stack([np.cos(angle), np.zeros(count), np.sin(angle)], axis=-1)
    up = np.array([0.0, 1.0, 0.0])
    normal = np.cos(around)[:, None] * outward + np.sin(around)[:, None] * up
    place = radius * outward + tube * normal
    side = generator.normal(size=(count, 3))
    if kind == "grazing":  # in the tangent plane, moved by little along the normal
        tangent = np.cross(normal, side)
        off = tube * generator.choice([-1.0, 1.0], count) * 10.0 ** -generator.uniform(1, 9, count)
        aims = place + off[:, None] * normal
        origins = aims + 3.0 * tangent / np.linalg.norm(tangent, axis=1)[:, None]
    elif kind == "inside":
        origins = radius * outward + 0.5 * tube * normal
        aims = origins + side
    else:
        aims = place - tube * generator.uniform(0.0, 3.0, count)[:, None] * normal
        origins = aims + (1e4 if kind == "far" else 3.0) * side / np.linalg.norm(side, axis=1)[:, None]
    directions = aims - origins
    lengths = np.linalg.norm(directions, axis=1)
    reach = 2.0 * (radius + tube)
    starts = np.zeros(count) if kind == "inside" else lengths - min(2.9, reach)
    return origins, directions / lengths[:, None], starts, np.where(kind == "inside", 0.0, lengths) + reach


@pytest.mark.parametrize("kind", ["random", "grazing", "far", "inside"])
@pytest.mark.parametrize(("radius", "tube"), [(1.0, 0.4), (1.0, 1e-3), (0.3, 0.29)])
def test_roots_of_a_torus_are_those_of_its_quartic(radius, tube, kind):
    (shape,) = Torus(radius=const(radius), tube=const(tube)).lower("a", IDENTITY, FakeMoment())
    segments = torus_rays(radius, tube, kind)
    big, small = exact(radius), exact(tube)
    expected = []
    for o, d, a, b in zip(*segments, strict=True):
        x, y, z = (fmpq_poly([exact(p), exact(q)]) for p, q in zip(o, d, strict=True))
        flat = x * x + z * z
        total = flat + y * y + big * big - small * small
        quartic = total * total - 4 * big * big * flat
        expected.append(first_entry(lambda t, q=quartic: q(t) < 0, roots_of(quartic), a, b))
    outcomes = {outcome for outcome, _ in expected}
    assert outcomes == ({"inside"} if kind == "inside" else {"hit", "miss"})
    assert check(*cast(shape.tape, *segments, TOLERANCE), expected, *segments[2:]) == 0
    if kind == "inside":
        check_exits(shape.tape, *segments, big, small)


def check_exits(tape, origins, directions, t0, t1, big, small):
    """The ways out are the first places where the quartic is not negative."""
    program = tape.code, tape.constants, tape.parts, scratch(tape)
    for o, d, a, b in zip(origins, directions, t0, t1, strict=True):
        x, y, z = (fmpq_poly([exact(p), exact(q)]) for p, q in zip(o, d, strict=True))
        flat = x * x + z * z
        total = flat + y * y + big * big - small * small
        quartic = total * total - 4 * big * big * flat
        outcome, place = first_entry(lambda t, q=quartic: q(t) > 0, roots_of(quartic), a, b)
        status, t = exit_root(*program, *o, *d, a, b, TOLERANCE)
        assert (OUTCOMES[status], outcome) == ("hit", "hit")
        assert abs(t - place) <= TOLERANCE * (b - a)
