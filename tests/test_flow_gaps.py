"""Gaps between solids in a flow that are narrower than a cell."""

import re

import numpy as np
import pytest

from flows import Air
from sceneql.quantities.diagnostic import ScriptError

CELL = 0.05


def between(folder, gap, turn, deep, first="sphere: {radius: 0.2 m, ", second="sphere: {radius: 0.2 m, "):
    """A flow around two spheres, or what else is said, whose centers are 0.4 m and a gap apart."""
    way = 0.5 * (0.4 + gap) * np.array([np.cos(turn), np.sin(turn)])
    places = [f"{0.5 + sign * way[0]!r} {0.5 + sign * way[1]!r} {0.5 if deep else 0}" for sign in (-1, 1)]
    places = [place.replace("np.float64(", "").replace(")", "") for place in places]
    bodies = f"objects:\n  a: {{{first}position: {places[0]} m}}}}\n  b: {{{second}position: {places[1]} m}}}}\n"
    size = "1 1 1 m" if deep else "1 1 m"
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
