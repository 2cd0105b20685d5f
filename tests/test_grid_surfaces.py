"""Surfaces on grids as rays meet them: the roots of the trilinear interpolant, none missed and none made up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from renderers.tracing.pack import pack
from renderers.tracing.scratch import scratch
from renderers.tracing.solids.grids import met
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.surface_kernels import normal_at
from sceneql.failure import Unsuitable
from sceneql.frame import Grid, SeenFrame, Sky, Surface, View
from sceneql.grids.maps.interpolation import trilinear
from sceneql.grids.maps.iso_mesh import meshed
from sceneql.mesh.measures import euler_characteristic
from sceneql.pipeline import frame_of, load
from sceneql.report.mesh import mesh
from sceneql.run.run import Run
from sceneql.shapes.world_boxes import box_of

VIEW = View((0.0, 0.0, 6.0), np.eye(3), (8, 8), 0.5)
WHITE = Sky(zenith=(1, 1, 1), horizon=(1, 1, 1), ground=(1, 1, 1))
UNTURNED = np.eye(3, 4)


def grid(values, to_nodes=UNTURNED, low=None, high=None, bounds=None):
    """A surface in all of its grid, or in a box."""
    top = tuple(float(n - 1) for n in values.shape[::-1])
    return Grid("g", Surface(), to_nodes, values, low or (0.0, 0.0, 0.0), high or top, bounds)


class Rays:
    """What rays meet in a grid."""

    def __init__(self, shape):
        self.scene, rows = pack(SeenFrame(0, 0.0, (shape,), (WHITE,), VIEW))
        self.scratch = scratch(rows)

    def first(self, start, way, near=0.0):
        """t of the first place, or infinity."""
        return walk(self.scene, self.scratch, *map(float, start), *map(float, way), near, np.inf, False)[0]

    def normal(self, place):
        """(3,) at a place of the surface."""
        return np.array(normal_at(self.scene, self.scratch, 0, *map(float, place))[:3])


def box_span(start, way, low, high):
    with np.errstate(divide="ignore"):
        a, b = (np.array(low) - start) / way, (np.array(high) - start) / way
    return max(0.0, np.minimum(a, b).max()), np.maximum(a, b).min()


@given(st.integers(0, 2**32 - 1), st.booleans(), st.booleans())
@settings(max_examples=examples(150))
def test_a_ray_meets_the_first_change_of_sign_and_nothing_else(seed, cut, bounded):
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(2, 12, 3))
    values = rng.standard_normal(shape) + rng.choice([0.0, 1.5, -1.5])
    top = np.array(shape[::-1]) - 1.0
    low, high = (0.2 * top, 0.9 * top) if cut else (0.0 * top, top)
    bounds = rng.standard_normal(shape) if bounded else None
    rays = Rays(grid(values, low=tuple(low), high=tuple(high), bounds=bounds))
    start = 2.0 * top * rng.standard_normal(3)
    way = rng.random(3) * top - start
    enter, leave = box_span(start, way, low, high)
    if not enter < leave:
        assert rays.first(start, way) == np.inf
        return
    t = np.linspace(enter, leave, 4001)
    places = start + t[:, None] * way
    value = trilinear(values, places)
    inside = trilinear(bounds, places) < 0.0 if bounded else np.full(len(t), True)
    changes = np.flatnonzero(((value[1:] < 0.0) != (value[:-1] < 0.0)) & inside[1:] & inside[:-1])
    found = rays.first(start, way)
    if found < np.inf:
        place = (start + found * way)[None, :]
        assert abs(trilinear(values, place)[0]) < 1e-10
        assert enter <= found <= leave
        if bounded:
            assert trilinear(bounds, place)[0] < 1e-10
    if len(changes):
        assert found <= t[changes[0] + 1]


def test_all_crossings_of_a_ray_are_found_one_after_the_other_along_axes_and_through_nodes():
    values = np.fromfunction(lambda k, j, i: (-1.0) ** i * (1.0 + 0.1 * j), (9, 9, 9))
    rays = Rays(grid(values))
    for height in (2.0, 2.5, 4.0, 7.99):
        t, count = 0.0, 0
        while (t := rays.first((-1.0, height, 4.0), (1.0, 0.0, 0.0), near=t)) < np.inf:
            assert t == pytest.approx(1.5 + count, abs=1e-12)
            count += 1
        assert count == 8


def ball(n):
    """|p| - 0.7 m on n^3 nodes of the cube from -1 m to 1 m."""
    axis = np.linspace(-1.0, 1.0, n)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    cell = 2.0 / (n - 1)
    return grid(np.sqrt(x * x + y * y + z * z) - 0.7, np.column_stack([np.eye(3) / cell, np.full(3, 1.0 / cell)]))


def test_a_ball_has_the_outline_and_the_normals_that_it_should_of_second_order():
    outline = []
    angles = np.linspace(0.0, 2.0 * np.pi, 40)
    for n in (10, 20, 40):
        rays = Rays(ball(n))
        worst = lean = 0.0
        for a in angles:
            side = np.array([np.cos(a), np.sin(a), 0.0])
            low, high = 0.5, 0.9
            for _ in range(30):
                middle = 0.5 * (low + high)
                hit = rays.first(middle * side + [0.0, 0.0, 3.0], (0.0, 0.0, -1.0)) < np.inf
                low, high = (middle, high) if hit else (low, middle)
            worst = max(worst, abs(low - 0.7))
            aim = 0.6 * side
            place = np.array([aim[0], aim[1], 3.0 - rays.first([*aim[:2], 3.0], (0.0, 0.0, -1.0))])
            lean = max(lean, np.linalg.norm(rays.normal(place) - place / np.linalg.norm(place)))
        outline.append(worst)
        assert lean < 0.5 * (2.0 / (n - 1) / 0.7) ** 2
    assert outline[-1] < 1.01 * (2.0 / 39) ** 2 / 8 * 2 / 0.7  # of the interpolant: h^2/8 times the sum of curvatures
    assert np.log2(outline[1] / outline[2]) > 1.7


def test_normals_are_the_gradient_wherever_that_is_linear_also_where_the_grid_is_turned_and_stretched():
    rng = np.random.default_rng(5)
    bend, slope = rng.standard_normal(3), 3.0 * rng.standard_normal(3)
    k, j, i = np.indices((8, 9, 10)).astype(float)
    turned = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    to_nodes = np.column_stack([np.diag([2.0, 3.0, 4.0]) @ turned, [4.0, 4.0, 3.0]])
    values = sum(b * n * n + s * n for b, s, n in zip(bend, slope, (i, j, k), strict=True))
    rays = Rays(grid(values, to_nodes))
    for _ in range(20):
        node = np.array([1.0, 1.0, 1.0]) + rng.random(3) * [7.0, 6.0, 5.0]
        world = np.linalg.solve(to_nodes[:, :3], node - to_nodes[:, 3])
        exact = to_nodes[:, :3].T @ (2.0 * bend * node + slope)
        np.testing.assert_allclose(rays.normal(world), exact / np.linalg.norm(exact), atol=1e-9)


def test_blocks_are_passed_only_where_no_cell_of_theirs_has_both_signs():
    rng = np.random.default_rng(1)
    for shape in ((2, 2, 2), (5, 6, 7), (9, 13, 4)):
        values = np.where(rng.random(shape) < 0.03, -1.0, 1.0)
        found = met(values)
        for at in np.ndindex(found.shape):
            part = values[tuple(slice(4 * a, 4 * a + 5) for a in at)]
            assert found[at] == (part.min() < 0.0 < part.max())


def test_rays_and_triangles_meet_the_same_surface():
    shape = ball(16)
    triangles, rays = meshed(shape), Rays(shape)
    low, high = box_of(shape)
    np.testing.assert_allclose([low, high], [[-1.0] * 3, [1.0] * 3], atol=1e-12)
    assert euler_characteristic(triangles.triangles) == 2
    for place in triangles.vertices[::17]:  # vertices lie on edges of cells, where both are the same
        way = -place / np.linalg.norm(place)
        t = rays.first(place - 0.3 * way, way)
        assert t == pytest.approx(0.3, abs=1e-9)


SCENE = """
clock: {end: 1 s, fps: 10}
models:
  room:
    diffusion: {DOMAIN, cell: 0.1 m, of: number, coefficient: "1e-9", initial: "sqrt(x^2 + y^2 + z^2)"}
objects:
  ball: {sphere: {radius: 0.5 m, hidden: yes}}
  skin: {iso_surface: {of: room.concentration, at: 0.4}}
  flat: {polygonised: {of: part, edges: no}}
  part: {iso_surface: {of: room.concentration, at: 0.3, hidden: yes}}
solvers: {main: {ftcs: {step: 0.1 s}}}
outputs: {film: {image: {size: 64 32, show: [skin, flat]}}}
"""


def opened(folder, domain):
    path = folder / "scene.yaml"
    path.write_text(SCENE.replace("DOMAIN", domain), encoding="utf-8")
    return load(path)


def test_a_surface_of_a_value_is_met_by_rays_and_made_of_triangles_where_these_are_asked_for(tmp_path):
    graph = opened(tmp_path, "size: 1 1 1 m, corner: -0.5 -0.5 -0.5 m")
    (moment,) = Run(graph).moments([0.0])
    (shape,) = moment.lower(["skin"])
    assert isinstance(shape, Grid)
    t = Rays(shape).first((0.0, 0.0, 2.0), (0.0, 0.0, -1.0))
    assert 2.0 - t == pytest.approx(0.4, abs=0.01)
    (part,) = moment.lower(["flat"])
    assert part.normals is None
    assert abs(np.linalg.norm(part.vertices, axis=1) - 0.3).max() < 0.01
    assert frame_of(graph, "film", (64, 32), moment, 0).shapes[0].values.shape == (12, 12, 12)
    account = mesh(graph, "skin", tmp_path / "skin.ply")
    assert account.cell == pytest.approx(0.1)
    assert account.boundary_edges == 0
    assert -account.volume == pytest.approx(4 / 3 * np.pi * 0.4**3, rel=0.04)
    with pytest.raises(Unsuitable, match="between the cells of its field"):
        mesh(graph, "skin", tmp_path / "skin.ply", cell=0.1)


def test_a_surface_ends_where_its_domain_does(tmp_path):
    opened(tmp_path, "domain: ball")
    path = tmp_path / "scene.yaml"
    path.write_text(path.read_text().replace("sqrt(x^2 + y^2 + z^2)", "y"), encoding="utf-8")
    (moment,) = Run(load(path)).moments([0.0])
    (shape,) = moment.lower(["skin"])
    rays = Rays(shape)
    reach = np.sqrt(0.5**2 - 0.4**2)
    for a in np.linspace(0.0, 6.0, 13):
        for share, hit in ((0.93, True), (1.07, False)):
            x, z = share * reach * np.cos(a), share * reach * np.sin(a)
            assert (rays.first((x, 2.0, z), (0.0, -1.0, 0.0)) < np.inf) == hit
