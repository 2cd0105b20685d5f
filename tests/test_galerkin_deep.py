"""Diffusion by finite elements in space: orders in a torus, patches in a box, what is kept."""

from __future__ import annotations

import math

import numpy as np
import pytest

from element_heat import Heat

RING = {"objects": "ring: {torus: {radius: 1 m, tube: 0.4 m}}", "domain": "ring"}


@pytest.mark.parametrize(("element", "cells", "order"), [("p1", (0.25, 0.1), 1.9), ("p2", (0.25, 0.2), 2.9)])
def test_a_field_in_a_torus_is_met_with_the_order(tmp_path, element, cells, order):
    """Coarser elements than these are few across the tube, and of orders from 1.5 to 7; of finer ones it is 3.26."""

    def exact(places):
        x, y, z = places.T
        return np.sin(2 * x) * np.cos(y) + z**3

    field, errors = '"sin(2*x)*cos(y) + z^3"', []
    for cell in cells:
        more = {"source": '"5*sin(2*x)*cos(y) - 6*z"', "boundary": f"{{rest: {{value: {field}}}}}"}
        heat = Heat(tmp_path, "{implicit_euler: {step: 1e4 s}}", 1e4, **RING, element=element, cell=f"{cell} m",
                    initial=field, **more)  # fmt: skip
        errors.append(heat.at(1e4).error(exact))
    assert math.log(errors[0] / errors[1]) / math.log(cells[0] / cells[1]) > order


@pytest.mark.parametrize("element", ["p1", "p2"])
def test_insulated_heat_in_a_torus_is_kept(tmp_path, element):
    cell = "0.2 m" if element == "p1" else "0.35 m"
    heat = Heat(tmp_path, "{bdf2: {step: 10 ms}}", 0.1, **RING, element=element, cell=cell, initial="300 + 40*x*z")
    start = heat.read("mass")
    assert abs(heat.at(0.1).read("mass") / start - 1.0) < 1e-12


@pytest.mark.parametrize(
    ("element", "field", "out"), [("p1", "1 + 2*x - y + z", "1"), ("p2", "1 + x*y - z^2 + x^2", "-2*z")]
)
def test_fields_of_the_elements_own_degree_are_kept_in_a_box(tmp_path, element, field, out):
    """The patch test: given values, and the flux through the front, whose normal is +z."""
    boundary = f'{{front: {{flux: "{out}"}}, rest: {{value: "{field}"}}}}'
    heat = Heat(tmp_path, "{implicit_euler: {step: 10 s, newton: 1e-13}}", 100, element=element, cell="0.4 m",
                size="1 0.7 0.8 m", initial=f'"{field}"', boundary=boundary)  # fmt: skip
    start = heat.read("concentration").copy()
    assert np.abs(heat.at(100).read("concentration") - start).max() < 1e-12


def test_sides_across_are_one_where_a_box_is_periodic(tmp_path):
    heat = Heat(tmp_path, "{crank_nicolson: {step: 1 ms}}", 0.01, cell="0.125 m", size="1 1 1 m",
                initial='"cos(2*pi*(x + z))"', boundary="{left: {periodic: yes}, front: {periodic: yes}}",
                probes="{a: 0.1 0.5 1 m, b: 0.1 0.5 0 m, c: 0.6 0.5 0.5 m}")  # fmt: skip
    assert heat.mesh.count == 16 * 17 * 16
    heat.at(0.01)
    assert heat.read("a") == pytest.approx(heat.read("b"), rel=1e-13)
    assert heat.read("c") == pytest.approx(heat.read("a"), rel=1e-10)
    assert heat.read("c") / math.cos(2 * math.pi * 1.1) == pytest.approx(math.exp(-8 * math.pi**2 * 0.01), rel=0.01)
