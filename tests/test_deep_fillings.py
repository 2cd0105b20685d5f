"""Fluids of several densities in deep flows: `filling` of closed sheets."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from sceneql.flows.varying.deep_parts_kernels import ROOM, add_triangle
from skins import DEEP_WAVES, deep
from test_fillings import FALLING, WALLED, masses
from test_membranes import flow_ints

TETRAHEDRON = np.array([[1.3, 0.7, 2.2], [6.4, 1.9, 0.8], [3.1, 5.3, 1.4], [3.6, 2.4, 5.7]])


def clipped(low):
    """The volume that the tetrahedron has in the unit cube at a low corner, by half spaces."""
    if (TETRAHEDRON.min(axis=0) >= np.array(low) + 1).any() or (TETRAHEDRON.max(axis=0) <= low).any():
        return 0.0
    hull = ConvexHull(TETRAHEDRON)
    sides = np.vstack(
        [hull.equations, *([*s * np.eye(3)[k], -s * low[k] - (s > 0)] for k in range(3) for s in (1, -1))]
    )
    # A place well inside both, if there is one: the Chebyshev center.

    found = linprog(
        [0, 0, 0, -1], np.column_stack([sides[:, :3], np.ones(len(sides))]), -sides[:, 3], bounds=(None, None)
    )
    if found.status != 0 or found.x[3] < 1e-9:
        return 0.0
    return ConvexHull(HalfspaceIntersection(sides, found.x[:3]).intersections).volume


@pytest.mark.parametrize("periodic", [(0, 0, 0), (1, 1, 1)], ids=["walls", "periodic"])
def test_a_sheet_of_flat_triangles_cuts_off_exact_volumes(periodic):
    ints, _ = flow_ints((4, 4, 4), periodic)
    part, cover, room = np.zeros(512), np.zeros(512), np.zeros(ROOM)
    for corners in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)):
        room[:9] = TETRAHEDRON[list(corners)].ravel()
        add_triangle(room, part, cover, ints)
    shape = (8, 8, 8)
    before = np.cumsum(cover.reshape(shape), axis=2) - cover.reshape(shape)
    found = part.reshape(shape) + before
    exact = np.array([[[clipped((i, j, k)) for i in range(8)] for j in range(8)] for k in range(8)])
    assert exact.sum() == pytest.approx(ConvexHull(TETRAHEDRON).volume, rel=1e-9)
    assert np.abs(found - exact).max() < 1e-9


@pytest.mark.parametrize(("boundary", "at"), [(WALLED, "0.5 0.5 0.5"), (DEEP_WAVES, "0.95 0.9 0.1")])
def test_the_mass_in_cells_is_what_the_drawn_surface_cuts_off(tmp_path, boundary, at):
    law = "law: {tension: 1 N/m}, filling: {density: 11 kg/m^3, viscosity: 0.5 Pa*s}"
    air = deep(tmp_path, law, "x^2/0.09 + y^2/0.0625 + z^2/0.06 - 1", at, boundary=boundary, solver="{auto: {}}").at(
        0.0
    )
    volume = air.read("volume", "balloon")
    for mass in masses(air):
        assert mass.sum() == pytest.approx(1.0 + 10.0 * volume, rel=1e-13)
        assert mass.max() <= 11.0 / 14**3 * (1 + 1e-12)


@pytest.mark.parametrize("density", [3.0, 1000.0])
def test_a_heavy_ball_begins_to_fall_against_half_of_what_it_displaces(tmp_path, density):
    law = f"law: {{springs: {{stretch: 1e-3 N/m}}}}, filling: {{density: {density!r} kg/m^3, viscosity: 1e-5 Pa*s}}"
    found = []
    for cells in (12, 24):
        air = deep(
            tmp_path, law, "x^2 + y^2 + z^2 - 0.03", cells=cells, boundary=WALLED, viscosity="1e-5 Pa*s",
            forces=FALLING, solver="{imex_midpoint: {step: 2 ms}}", end=0.01,
        )  # fmt: skip
        before = air.at(0.0).read("center", "balloon")[1]
        found.append(2.0 * (air.at(0.01).read("center", "balloon")[1] - before) / 0.01**2)
    exact = -9.81 * (density - 1.0) / (density + 0.5)
    assert 2.0 * found[1] - found[0] == pytest.approx(exact, rel=0.05 if density < 10.0 else 2e-3)
    assert abs(found[1] - exact) < 0.6 * abs(found[0] - exact) + 2e-3 * abs(exact)


def test_momentum_and_what_is_drawn_stay(tmp_path):
    stream = '{velocity: "[0.3 + 0.1*sin(2*pi*y), 0.1 + 0.1*sin(2*pi*z), 0.2 + 0.1*sin(2*pi*x)]"}'
    law = "law: {springs: {stretch: 1 N/m}}, prestress: 0.3 N/m, filling: {density: 1000 kg/m^3, viscosity: 10 Pa*s}"
    air = deep(tmp_path, law, "x^2/0.09 + y^2/0.0625 + z^2/0.04 - 1", solver="{auto: {}}", initial=stream, end=0.1)
    air.at(0.0)
    momentum, volume = air.read("momentum"), air.read("volume", "balloon")
    air.at(0.1)
    assert air.read("momentum") == pytest.approx(momentum, abs=1e-10 * abs(momentum).max())
    assert air.read("volume", "balloon") == pytest.approx(volume, rel=1e-12)
