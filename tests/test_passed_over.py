"""Cells that cutting anew passes over are those that are far from every solid, and no others."""

import numpy as np
import pytest

from flows import Air
from sceneql.flows.layout import LED
from sceneql.flows.obstacles.no_slip_numbers import LEAST

R = "sqrt(x^2 + y^2)"


@pytest.mark.parametrize(
    "field",
    [
        "sqrt(x^2 + y^2 + (z + 0.24)^2) - 0.26",
        f"{R} - 0.5*(0.2 - z)",
        "0.001*(x^2 + y^2 - 0.01)",
        f"where({R} > 0.3, 1e305, {R} - 0.1)",
        "min(sqrt(x^2 + y^2 + z^2) - 0.1, z + 0.05 - 0.06*x)",
    ],
    ids=["cap of a ball", "cone", "no distance", "far away", "post on a slope"],
)
def test_what_a_solid_that_moves_leaves_of_cells_is_what_is_outside_of_its_section(tmp_path, field):
    """A disc of 0.1 m in each, against points; the slope beneath one is nearer to most cells, and not in the plane."""
    before = (
        f'objects: {{solid: {{implicit: {{field: "{field}", position: [0.6 m + 0.1 m/s*time, 0.31 m, 0 m], '
        "bounds: {box: [[-0.8, -0.5, -0.5], [0.8, 0.5, 0.5]]}}}}\n"
    )
    air = Air(
        tmp_path, before=before, size="1 0.6 m", cell="1/40 m", around="[solid]",
        boundary="{right: {outflow: {}}}",
    ).at(0.005)  # fmt: skip
    system, places = air.run.march.system, air.read("centers")[:, :2]
    at = system.fields.flow.ints[LED]
    parts = system.floats[at : at + len(places)]
    apart = (np.arange(40) / 40 - 0.4875) / 40
    x, y = (places[:, k, None, None] for k in (0, 1))
    exact = (np.hypot(x - 0.6005 + apart, y - 0.31 + apart[:, None]) > 0.1).mean(axis=(1, 2))
    known = (exact == 0.0) | (exact > LEAST)  # smaller cells count as larger ones
    assert known.sum() > len(known) - 12
    assert (exact[known] == 0.0).sum() > 30
    assert np.abs(parts - exact)[known].max() < 0.03
