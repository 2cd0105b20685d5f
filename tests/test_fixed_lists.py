"""Lists of numbers that do not change are read once, and so is what is made of them."""

from __future__ import annotations

import numpy as np

from moment import FakeMoment, const, link
from sceneql.field.skeleton.skeleton import NODE, Skeleton
from sceneql.field.tape.builder import TapeBuilder
from sceneql.words.objects.blobby import Blobby

PLACES = np.random.default_rng(3).normal(size=(200, 3))


def rows(blobby, moment):
    build = TapeBuilder()
    return build.finish(blobby.implicit(build, build.x, build.y, build.z, moment)).parts


def test_a_skeleton_of_fixed_points_is_made_once_for_all_instants():
    blobby = Blobby(points=const(PLACES), radius=const(0.2))
    assert blobby.parts(FakeMoment(0.0)) is blobby.parts(FakeMoment(1.0))
    again = blobby.model_copy(update={"color": None})  # as a group gives its children its own looks
    assert again.parts(FakeMoment(2.0)) is blobby.parts(FakeMoment(0.0))
    assert np.array_equal(
        rows(again, FakeMoment()), rows(Blobby(points=const(PLACES), radius=const(0.2)), FakeMoment())
    )


def test_points_that_move_are_made_anew_and_other_radii_are_others():
    moving = Blobby(points=link("cage", "positions", (200, 3)), radius=const(0.2))
    parts = [moving.parts(FakeMoment(given={("cage", "positions"): PLACES + k})).corners for k in (0, 1)]
    assert np.array_equal(parts[0] + 1, parts[1])
    fixed = const(PLACES)
    one, two = (Blobby(points=fixed, radius=const(radius)) for radius in (0.2, 0.3))
    for _ in range(2):
        assert one.parts(FakeMoment()).radii[0, 0] == 0.2
        assert two.parts(FakeMoment()).radii[0, 0] == 0.3


def test_a_fixed_list_is_one_array_that_nobody_may_write_to():
    value = const(PLACES)
    assert value.fixed_list() is value.fixed_list()
    assert not value.fixed_list().flags.writeable
    assert const([1.0, 2.0, 3.0]).fixed_list() is None
    assert link("cage", "positions", (200, 3)).fixed_list() is None


def lexical(places, groups):
    """The order along Morton's curve, bit by bit."""
    low = places.min(axis=0)
    size = (places.max(axis=0) - low).max()
    cells = np.minimum((places - low) / size * 1024.0, 1023.0).astype(int)
    codes = [sum(int(c >> bit & 1) << 3 * bit + k for bit in range(10) for k, c in enumerate(row)) for row in cells]
    return np.lexsort([groups, codes])


def test_points_that_move_lie_along_the_curve_whether_or_not_they_are_alone_in_their_groups():
    alone, radii = np.arange(200.0), np.full((200, 2), 0.2)
    corners = np.repeat(PLACES[:, None], 3, axis=1)
    rows = Skeleton(corners, radii, np.ones(200), alone).rows()
    ends = rows[1::2, 6] != NODE
    assert np.array_equal(rows[::2][ends][:, :3], PLACES[lexical(PLACES, alone)])
    turned = Skeleton(corners[::-1], radii, np.ones(200), alone[::-1]).rows()  # sorted by groups as well
    assert np.array_equal(turned, rows)
