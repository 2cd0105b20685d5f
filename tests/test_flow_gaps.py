"""Gaps between solids in a flow, and beside its walls, that are narrower than a cell."""

import re

import numpy as np
import pytest

from flows import Air
from sceneql.quantities.diagnostic import ScriptError

CELL = 0.05


def between(folder, gap, turn, deep, first="sphere: {radius: 0.2 m, ", second="sphere: {radius: 0.2 m, "):
    """A flow around two spheres, or what else is said, whose centers are 0.4 m and a gap apart."""
    way = 0.5 * (0.4 + gap) * np.array([np.cos(turn), np.sin(turn)])
    places = [f"{0.6 + sign * way[0]!r} {0.6 + sign * way[1]!r} {0.6 if deep else 0}" for sign in (-1, 1)]
    places = [place.replace("np.float64(", "").replace(")", "") for place in places]
    bodies = f"objects:\n  a: {{{first}position: {places[0]} m}}}}\n  b: {{{second}position: {places[1]} m}}}}\n"
    size = "1.2 1.2 1.2 m" if deep else "1.2 1.2 m"
    return Air(folder, "{auto: {}}", 0.1, before=bodies, size=size, cell=f"{CELL} m", around="[a, b]", boundary="{}")


@pytest.mark.parametrize("deep", [False, True], ids=["flat", "deep"])
@pytest.mark.parametrize("turn", [0.0, 0.3, 0.785])
def test_a_gap_narrower_than_a_cell_is_told_and_its_width(tmp_path, turn, deep):
    for gap in (0.04 * CELL, 0.3 * CELL, 0.95 * CELL):
        with pytest.raises(ScriptError, match=r"'a' and 'b' leave") as told:
            between(tmp_path, gap, turn, deep)
        assert float(re.search(r"leave (\S+) m", str(told.value))[1]) == pytest.approx(gap, abs=0.01 * CELL)
    for gap in (-0.5 * CELL, 0.0, 1.05 * CELL, 3.0 * CELL):  # they overlap, touch, or a cell fits between them
        between(tmp_path, gap, turn, deep)


def test_what_stands_on_something_leaves_no_gap(tmp_path):
    floor = "box: {size: 0.9 0.2 1 m, "
    with pytest.raises(ScriptError, match=r"leave 0\.02 m"):
        between(tmp_path, -0.1 + 0.02, np.pi / 2, False, floor)
    between(tmp_path, -0.1, np.pi / 2, False, floor)
    between(tmp_path, -0.1 - 0.02, np.pi / 2, False, floor)


def beside(folder, side, gap, boundary="{}"):
    """A flow around one sphere, at a gap from a side of the box."""
    axis, high = divmod(("left", "right", "bottom", "top").index(side), 2)
    place = [0.5, 0.5]
    place[axis] = 1.0 - 0.2 - gap if high else 0.2 + gap
    ball = f"objects: {{a: {{sphere: {{radius: 0.2 m, position: {place[0]!r} {place[1]!r} 0 m}}}}}}\n"
    return Air(folder, "{auto: {}}", 0.1, before=ball, size="1 1 m", cell=f"{CELL} m", around="[a]", boundary=boundary)


@pytest.mark.parametrize("side", ["left", "right", "bottom", "top"])
def test_a_gap_beside_a_wall_is_told_and_its_width(tmp_path, side):
    for gap in (0.04 * CELL, 0.3 * CELL, 0.95 * CELL):
        with pytest.raises(ScriptError, match=f"'a' and the wall '{side}' leave") as told:
            beside(tmp_path, side, gap)
        assert float(re.search(r"leave (\S+) m", str(told.value))[1]) == pytest.approx(gap, abs=0.01 * CELL)
    for gap in (-0.15, 0.0, 1.05 * CELL):  # it stands in the wall, touches it, or a cell fits between them
        beside(tmp_path, side, gap)


def test_sides_that_are_no_walls_ask_for_no_gap(tmp_path):
    beside(tmp_path, "right", 0.3 * CELL, "{right: {outflow: {}}}")
    beside(tmp_path, "bottom", 0.3 * CELL, "{bottom: {periodic: yes}}")
