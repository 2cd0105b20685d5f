"""Grids on irregular domains: geometry, the disk's exact mode, shores with pieces and islands, the explicit limit."""

from __future__ import annotations

import math
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sceneql.failure import RunFailure
from sceneql.grids.domain import sides
from sceneql.grids.domain.cut import CROWDED, below, cut, frame
from sceneql.grids.domain.polygon import Polygon
from sceneql.grids.domain.sides import crossing
from sceneql.march.stability import stability
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

ROOT = 3.0542369282271403
"""The first zero of J2' (Abramowitz & Stegun 1964, table 9.5)."""
LAKE = "[0 0 m, 2 -0.3 m, 3 0.4 m, 2.7 1.5 m, 1.6 1.2 m, 0.9 1.9 m, -0.2 1.1 m]"
SHORE = f"shore: {{outline: {{points: {LAKE}, islands: {{rock: [1 0.5 m, 1.4 0.5 m, 1.2 0.9 m]}}, "
SHORE += "pieces: {inlet: {first: 6, last: 0}, outlet: {first: 2, last: 3}}}}"


class Basin:
    """A diffusion model in an object."""

    def __init__(self, folder, domain, solver, end=0.1, **fields):
        name = domain.partition(":")[0]
        fields = {"domain": name, "of": "number", "coefficient": "1", **fields}
        lines = "\n".join(f"      {key}: {value}" for key, value in fields.items())
        path = folder / "scene.yaml"
        head = f"clock: {{end: {end} s, fps: 10}}\nobjects: {{{domain}}}\n"
        path.write_text(
            f"{head}models:\n  lake:\n    diffusion:\n{lines}\nsolvers: {{main: {solver}}}\n", encoding="utf-8"
        )
        graph = load(path, pruned=False)
        self.model = graph.tasks["lake"].kind
        self.run = IslandRun(graph, graph.islands[0])
        self.run.advance(0.0)
        self.layout = self.model.layout(self.run.state("lake"))
        first = self.layout.volumes_at
        self.volumes = self.run.march.floats[first : first + self.layout.count]

    def at(self, time):
        self.run.advance(time)
        return self

    def read(self, output):
        return self.model.read(output, self.run.state("lake"))


def mode(points):
    """J2(root r) cos 2 theta by its power series."""
    x, y = points[:, 0], points[:, 1]
    square = ROOT * ROOT * (x * x + y * y) / 4
    series = sum((-square) ** k / (math.factorial(k) * math.factorial(k + 2)) for k in range(20))
    return ROOT * ROOT / 4 * (x * x - y * y) * series


def disk_errors(folder, cells, edges, end=0.1):
    """Largest and mean square error of the disk's mode with zero flux, and the drift of the mass."""
    basin = Basin(folder, "ball: {sphere: {radius: 1 m}}", f"{{tr_bdf2: {{step: {end / 100} s}}}}", end,
                  flat="yes", cell=f"2/{cells} m", edges=edges)  # fmt: skip
    inside = basin.volumes > 0
    exact = mode(basin.layout.centers())
    basin.run.march._y1[: basin.layout.count] = np.where(inside, 1 + exact, 0.0)
    basin.run.march._started = False
    start = basin.volumes @ np.where(inside, 1 + exact, 0.0)
    basin.at(end)
    error = basin.read("concentration") - 1 - exact[inside] * math.exp(-ROOT * ROOT * end)
    square = np.sqrt(basin.volumes[inside] @ error**2 / math.pi)
    return np.abs(error).max(), square, basin.read("mass") / start - 1


def test_cut_cells_are_of_second_order_and_stairs_of_first(tmp_path):
    counts = (24, 48, 96)
    cut_cells = [disk_errors(tmp_path, n, "cut_cell") for n in counts]
    stairs = [disk_errors(tmp_path, n, "staircase") for n in counts]
    assert math.log2(cut_cells[0][1] / cut_cells[2][1]) / 2 > 1.85
    for n, (largest, _, _) in zip(counts, cut_cells, strict=True):
        assert largest < 0.25 * (2 / n) ** 2
    assert 0.7 < math.log2(stairs[0][1] / stairs[2][1]) / 2 < 1.4
    assert stairs[2][0] > 20 * cut_cells[2][0]
    assert max(abs(drift) for *_, drift in cut_cells + stairs) < 1e-14


def test_no_sliver_at_the_boundary_spoils_its_neighbor(tmp_path):
    """On 128 cells the circle leaves 6e-4 of some: where they are left out, what flows through their faces is lost."""
    largest, _, _ = disk_errors(tmp_path, 128, "cut_cell", 0.05)
    assert largest < 0.3 * (2 / 128) ** 2


@pytest.mark.parametrize("edges", ["cut_cell", "staircase"])
def test_the_mass_of_a_lake_stays(tmp_path, edges):
    basin = Basin(tmp_path, SHORE, "{implicit_euler: {step: 1 ms}}", 2, cell="0.1 m", edges=edges, initial="exp(-x*x)")
    start = basin.read("mass")
    assert abs(basin.at(2).read("mass") / start - 1) < 1e-13


def test_the_cells_of_a_polygon_have_its_area(tmp_path):
    basin = Basin(tmp_path, SHORE, "auto", cell="0.02 m")
    corners = np.array([[0, 0], [2, -0.3], [3, 0.4], [2.7, 1.5], [1.6, 1.2], [0.9, 1.9], [-0.2, 1.1]])
    x, y = corners.T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) - 0.5 * 0.4 * 0.4
    assert basin.volumes.sum() == pytest.approx(area, rel=1e-4)


def test_what_comes_in_through_a_piece_is_its_length_times_the_flux(tmp_path):
    parts = "{inlet: {flux: 2}, rock: {flux: -1}}"
    basin = Basin(tmp_path, SHORE, "{tr_bdf2: {step: 10 ms}}", cell="0.02 m", boundary=parts).at(0.1)
    length = 2 * math.hypot(0.2, 1.1) - (0.4 + 2 * math.hypot(0.2, 0.4))
    assert basin.read("inflow") == pytest.approx(0.1 * length, abs=0.1 * 3 * 0.02)
    assert basin.read("mass") == pytest.approx(basin.read("inflow"), abs=1e-13)


def test_a_ball_whose_surface_is_held_cools_as_fourier_says(tmp_path):
    """sin(pi r)/r times exp(-pi^2 t) in the unit ball (Carslaw & Jaeger 1959, 9.3)."""
    errors = []
    for n in (8, 16):
        basin = Basin(tmp_path, "ball: {sphere: {radius: 1 m}}", "{tr_bdf2: {step: 1 ms}}", 0.05, cell=f"2/{n} m",
                      initial="where(x*x+y*y+z*z>1e-9, sin(pi*sqrt(x*x+y*y+z*z))/sqrt(x*x+y*y+z*z+1e-30), pi)",
                      boundary="{ball: {value: 0}}").at(0.05)  # fmt: skip
        r = np.linalg.norm(basin.read("centers"), axis=1)
        exact = np.sin(np.pi * r) / r * math.exp(-(np.pi**2) * 0.05)
        errors.append(np.sqrt(np.mean((basin.read("concentration") - exact)[r < 0.8] ** 2)))
    assert errors[1] < 0.01
    assert errors[0] / errors[1] > 3


def test_a_lake_between_its_shores_stays_between_them(tmp_path):
    parts = "{inlet: {value: 1}, outlet: {robin: {coefficient: 2 m/s}}, rock: {value: 0.5}}"
    basin = Basin(tmp_path, SHORE, "{tr_bdf2: {step: 5 ms}}", 1, cell="0.1 m", boundary=parts)
    for time in (0.01, 0.1, 1.0):
        assert basin.at(time).read("min") > -1e-9
        assert basin.read("max") < 1 + 1e-9


@pytest.mark.parametrize("edges", ["cut_cell", "staircase"])
def test_the_explicit_limit_holds_on_a_lake(tmp_path, edges):
    rough = {"initial": "where(sin(50*x)*sin(61*y+1)>0, 1, 0)", "cell": "0.1 m", "edges": edges}
    run = Basin(tmp_path, SHORE, "{ftcs: {step: 1 ms}}", 4, **rough).run
    limit = stability(run.march, run.solver).step
    whole = 0.01 / 4
    assert (0.8 * CROWDED if edges == "cut_cell" else 0.9) * whole < limit < 1.05 * whole
    assert Basin(tmp_path, SHORE, f"{{ftcs: {{step: {0.9 * limit} s}}}}", 4, **rough).at(4).read("max") < 1
    with pytest.raises(RunFailure) as failure:
        Basin(tmp_path, SHORE, f"{{ftcs: {{step: {1.1 * limit} s}}}}", 4, **rough).at(4)
    assert failure.value.part == "lake"
    assert "unstable" in failure.value.message


# --- geometry ---


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3), st.floats(-1.5, 1.5))
@example([0.0, 0.0, 2.225073858507e-311], 0.0)
@example([0.0, 0.0, 5e-324], 0.0)
@settings(max_examples=60)
def test_what_lies_below_a_plane_is_what_is_counted_there(slopes, phi):
    points = (np.stack(np.meshgrid(*[np.arange(40)] * 3), axis=-1).reshape(-1, 3) + 0.5) / 40 - 0.5
    largest = max(abs(phi), *map(abs, slopes)) or 1.0  # by which the count is scaled, or products would underflow
    counted = np.mean(phi / largest + points @ np.divide(slopes, largest) < 0)
    found = below(np.array([phi]), np.array([slopes]), np.ones(3))[0]
    assert found == pytest.approx(counted, abs=0.03)


def test_a_cell_is_closed_by_its_boundary():
    ring = np.array([[0.05, 0.03], [1.9, 0.2], [1.1, 1.7]])
    cells = cut(Polygon({"shore": ring}, {}), frame(np.array([0.05, 0.03, 0]), np.array([1.9, 1.7, 0]), 0.1, 1.0, True))
    faces = cells.boundary
    assert np.abs((faces.areas[:, None] * faces.outward).sum(axis=0)).max() < 1e-9


class Circle:
    """A disk about (0.013, 0.027) m."""

    names = ("shore",)

    def values(self, points):
        return np.hypot(points[:, 0] - 0.013, points[:, 1] - 0.027) - 1.0

    def pieces(self, points):
        return np.zeros(len(points), dtype=np.int64)


def test_a_flux_by_formula_is_read_where_the_boundary_is():
    def flux(x, y):
        return 1.0 + x + 2.0 * x**2 + 3.0 * x**2 * y**2

    turn = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
    exact, errors = 2.0 * np.pi * flux(np.cos(turn) + 0.013, np.sin(turn) + 0.027).mean(), []
    for count in (20, 40, 80):
        faces = cut(
            Circle(), frame(np.array([-1.1, -1.1, 0]), np.array([1.1, 1.1, 0]), 2.2 / count, 1.0, True)
        ).boundary
        errors.append(abs((faces.areas * flux(*faces.points.T[:2])).sum() - exact))
    assert errors[0] < 0.01
    assert errors[2] < errors[0] / 2.0 ** (1.7 * 2)


def first_crossing(rings):
    """By all pairs, in order of their left ends."""
    them = [
        sides.Side(name, k, ring[k], ring[(k + 1) % len(ring)], len(ring))
        for name, ring in rings.items()
        for k in range(len(ring))
    ]
    them.sort(key=lambda side: min(side.first[0], side.last[0]))
    for one, other in combinations(them, 2):
        if one.wrongly_meets(other):
            return one.place, other.place
    return None


@given(st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30)), min_size=3, max_size=40), st.booleans())
@settings(max_examples=60)
def test_sides_by_boxes_are_found_to_cross_as_by_all_pairs(corners, hatched):
    if hatched:  # 20 strips over one another
        corners = [(float(40 * (k % 2)), k + 0.3 * (k % 2)) for k in range(40)] + corners[:1]
    rings = {"shore": tuple(corners), "isle": ((50, 50), (51, 50), (50, 51))}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sides, "MANY", -1)
        assert crossing(rings) == first_crossing(rings)


def test_sides_that_overlap_along_x_are_not_compared_pair_by_pair(monkeypatch):
    ring = [(float(100 * (k % 2)), k + 0.3 * (k % 2)) for k in range(2000)]
    asked, meet = [], sides.Side.wrongly_meets
    monkeypatch.setattr(sides.Side, "wrongly_meets", lambda one, other: asked.append(0) or meet(one, other))
    assert crossing({"shore": (*ring, (-1.0, 2000.0), (-1.0, 0.0))}) is None
    assert len(asked) < 20 * len(ring)


@given(st.permutations(range(6)))
@settings(max_examples=40)
def test_a_polygon_crosses_itself_where_two_of_its_sides_meet(order):
    circle = [(math.cos(k), math.sin(k)) for k in range(6)]
    ring = tuple(circle[k] for k in order)
    # On a convex polygon the order that goes round is the only one without a crossing.
    round_ = all((b - a) % 6 == (order[1] - order[0]) % 6 for a, b in pairwise([*order, order[0]]))
    goes_round = round_ and (order[1] - order[0]) % 6 in (1, 5)
    assert (crossing({"ring": ring}) is None) == goes_round
