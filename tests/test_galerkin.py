"""Diffusion by finite elements in the plane: orders, patches, what is kept, slopes, meshes, what is told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import jv

from element_heat import Heat
from sceneql.galerkin import plane_quality
from sceneql.galerkin.field_mesh import sized
from sceneql.galerkin.plane_mesh import TooCoarse, outlined
from sceneql.galerkin.simplex import Simplex
from sceneql.linear.newton_kernels import FACTORIZATIONS, ITERATIONS
from sceneql.march.driver import jacobian
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError

ROOT = 3.0542369282271403
"""The first zero of J2' (Abramowitz & Stegun 1964, table 9.5)."""
BALL = "ball: {sphere: {radius: 1 m}}"
ROOM = "ball: {outline: {points: [0 0 m, 1.1 0.1 m, 1.3 0.8 m, 0.4 1 m, 0.6 0.5 m, 0.1 0.6 m]}}"
DISK = {"objects": BALL, "domain": "ball", "flat": "yes"}
ELEMENTS = ("p1", "p2")


def mode(time):
    """1 + J2(root r) cos 2 theta, which decays with zero flux through the unit circle."""

    def values(places):
        x, y = places[:, 0], places[:, 1]
        around = 2.0 * np.arctan2(y, x)
        return 1.0 + jv(2, ROOT * np.hypot(x, y)) * np.cos(around) * math.exp(-ROOT * ROOT * time)

    return values


@pytest.mark.parametrize(("element", "order", "largest"), [("p1", 1.9, 4e-4), ("p2", 2.9, 4e-6)])
def test_the_exact_mode_of_the_disk_is_met_with_the_elements_order_and_its_heat_is_kept(
    tmp_path, element, order, largest
):
    errors = []
    for cell in (0.1, 0.05):
        heat = Heat(tmp_path, "{radau: {tolerance: 1e-9}}", 0.02, **DISK, element=element, cell=f"{cell} m")
        heat.start_with(mode(0.0))
        weights = heat.model._solved.form.volumes
        start = weights @ mode(0.0)(heat.mesh.places)
        heat.at(0.02)
        errors.append(heat.error(mode(0.02)))
        assert abs(heat.read("mass") / start - 1.0) < 1e-12
        assert heat.read("inflow") == 0.0
    assert math.log2(errors[0] / errors[1]) > order
    assert errors[1] < largest


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("solver", ["implicit_euler", "crank_nicolson", "bdf2", "tr_bdf2", "implicit_midpoint"])
def test_insulated_heat_is_kept_by_implicit_solvers(tmp_path, element, solver):
    heat = Heat(tmp_path, f"{{{solver}: {{step: 2 ms}}}}", 0.1, **DISK, element=element, cell="0.2 m",
                initial="300 + 40*x + sin(5*y)")  # fmt: skip
    start = heat.read("mass")
    assert abs(heat.at(0.1).read("mass") / start - 1.0) < 1e-12


@pytest.mark.parametrize(("element", "field", "slope"), [
    ("p1", "1 + 2*x - y", "2, -1"),
    ("p2", "1 + 2*x - y + x^2 - y^2 + 3*x*y", "2 + 2*x + 3*y, -1 - 2*y + 3*x"),
])  # fmt: skip
def test_fields_of_the_elements_own_degree_are_kept_on_straight_sides(tmp_path, element, field, slope):
    """The patch test, with values given on an outline with corners, one of them inwards."""
    solver, kept = "{implicit_euler: {step: 10 s, newton: 1e-13}}", {"element": element, "initial": f'"{field}"'}
    held = f'{{rest: {{value: "{field}"}}}}'
    heat = Heat(tmp_path, solver, 100, objects=ROOM, domain="ball", cell="0.17 m", boundary=held, **kept)
    start = heat.read("concentration").copy()
    assert np.abs(heat.at(100).read("concentration") - start).max() < 1e-12
    # The same with the flux through two sides of a box, and an exchange through the third.
    x, y = slope.split(", ")
    top = f'{{robin: {{coefficient: 3 m/s, outside: "{field} + ({y})/3"}}}}'
    sides = f'{{left: {{flux: "-({x})"}}, right: {{flux: "{x}"}}, top: {top}, bottom: {{flux: "-({y})"}}}}'
    heat = Heat(tmp_path, solver, 100, cell="0.3 m", size="1 0.7 m", boundary=sides, **kept)
    start = heat.read("concentration").copy()
    assert np.abs(heat.at(100).read("concentration") - start).max() < 1e-12


@pytest.mark.parametrize("boundary", [
    '{rest: {value: "sin(2*x)*cos(y)"}}',
    '{rest: {robin: {coefficient: 1 m/s, outside: "sin(2*x)*cos(y) + 2*x*cos(2*x)*cos(y) - y*sin(2*x)*sin(y)"}}}',
])  # fmt: skip
@pytest.mark.parametrize(("element", "order"), [("p1", 1.9), ("p2", 2.9)])
def test_a_field_at_rest_with_sources_is_met_with_the_order(tmp_path, boundary, element, order):
    def exact(places):
        return np.sin(2 * places[:, 0]) * np.cos(places[:, 1])

    errors = []
    for cell in (0.2, 0.1):
        heat = Heat(tmp_path, "{implicit_euler: {step: 1e4 s}}", 1e4, **DISK, element=element, cell=f"{cell} m",
                    initial='"sin(2*x)*cos(y)"', source='"5*sin(2*x)*cos(y)"', boundary=boundary)  # fmt: skip
        errors.append(heat.at(1e4).error(exact))
    assert math.log2(errors[0] / errors[1]) > order


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("fields", [
    {"coefficient": '"1 + 0.3*c^2 + sin(t)*x"', "boundary": '{rest: {value: "c^2/5 + x"}}'},
    {"coefficient": '"1 + t"', "boundary": "{rest: {value: 0}}"},
    {
        "source": '"c*(1 - c)"',
        "boundary": '{a: {flux: "-0.1*c^4", where: x}, rest: {robin: {coefficient: 2 m/s, outside: "c/2 + t"}}}',
    },
], ids=["coefficient", "time", "source"])  # fmt: skip
def test_slopes_are_those_of_differences_and_what_comes_in_is_told(tmp_path, element, fields):
    heat = Heat(tmp_path, "{implicit_euler: {step: 10 ms, newton: 1e-13}}", 0.1, **DISK, element=element, cell="0.35 m",
                initial='"1 + x*y"', **fields)  # fmt: skip
    start = heat.read("mass")
    march = heat.run.march
    system, n = march.system, heat.mesh.count
    random = np.random.default_rng(1)
    y, way = march._y1.copy(), random.standard_normal(n)
    y[:n] += 0.1 * random.standard_normal(n)
    values = np.zeros(system.pattern.room)
    march.rate(0.03, y)
    jacobian(system)(march._engaged.functions, 0.03, y, values, march.floats, system.ints)
    matrix = np.zeros((n + 1, n + 1))
    np.add.at(matrix, (system.pattern.rows, system.pattern.columns), values[: system.pattern.count])
    rates = []
    for sign in (1.0, -1.0):
        moved = y.copy()
        moved[:n] += sign * 1e-5 * way
        rates.append(march.rate(0.03, moved)[:n].copy())
    change = system.inertia[0][1] @ (rates[0] - rates[1]) / 2e-5
    assert np.abs(matrix[:n, :n] @ way - change).max() < 1e-8 * np.abs(change).max()
    heat.at(0.1)
    assert abs(heat.read("mass") - start - heat.read("inflow")) < 1e-11
    assert abs(heat.read("inflow")) > 1e-3


@pytest.mark.parametrize("element", ELEMENTS)
def test_explicit_and_implicit_solvers_agree(tmp_path, element):
    found = []
    for solver in ("{dop853: {tolerance: 1e-9}}", "{radau: {tolerance: 1e-9}}", "{rodas5p: {tolerance: 1e-9}}", "auto"):
        heat = Heat(tmp_path, solver, 0.1, **DISK, element=element, cell="0.3 m", initial='"1 + x"',
                    boundary='{rest: {value: "sin(3*t)*x"}}', probes="{a: 0.2 0.3 m}")  # fmt: skip
        found.append(heat.at(0.1).read("a"))
    assert max(found[:3]) - min(found[:3]) < 1e-7
    assert abs(found[3] - found[0]) < 1e-3


def test_p1_on_a_box_keeps_the_range_of_its_start(tmp_path):
    """No side is across from angles of more than 180 degrees, and the mass is lumped: the maximum principle holds."""
    heat = Heat(tmp_path, "{implicit_euler: {step: 1 ms}}", 0.01, element="p1", cell="0.1 m", size="1 1 m",
                initial='"where(x > 0.5, 1, 0)"')  # fmt: skip
    heat.at(0.01)
    assert heat.run.march._settings[FACTORIZATIONS] == 1, "lengths of steps differ by rounding alone"
    assert heat.run.march._settings[ITERATIONS] == 10, "a linear stage is solved by one update"
    assert heat.read("min") > -1e-13
    assert heat.read("max") < 1.0 + 1e-13


@pytest.mark.parametrize("element", ELEMENTS)
def test_periodic_sides_are_one(tmp_path, element):
    """cos(2 pi x) decays alike on a ring."""
    heat = Heat(tmp_path, "{radau: {tolerance: 1e-8}}", 0.02, element=element, cell="0.05 m", size="1 0.2 m",
                initial='"cos(2*pi*x)"', boundary="{left: {periodic: yes}}",
                probes="{a: 0 0.1 m, b: 1 0.1 m}")  # fmt: skip
    heat.at(0.02)
    assert heat.read("a") == pytest.approx(heat.read("b"), rel=1e-14)
    error = abs(heat.read("a") / math.exp(-4 * math.pi**2 * 0.02) - 1)
    assert error < (2e-2 if element == "p1" else 1e-3)


class Level:
    """An outline by a function of x and y, below 0 inside."""

    names = ("edge",)

    def __init__(self, function):
        self.function = function

    def values(self, points):
        return self.function(points[:, 0], points[:, 1])

    def pieces(self, points):
        return np.zeros(len(points), dtype=np.int64)


def square(x, y):
    u, v = 0.8 * x + 0.6 * y, 0.8 * y - 0.6 * x
    return np.maximum(np.abs(u) - 0.63, np.abs(v) - 0.51)


def notched(x, y):
    return np.maximum(np.maximum(np.abs(x) - 0.8, np.abs(y) - 0.8), -np.maximum(0.03 - x, 0.01 - y))


def ring(x, y):
    return np.abs(np.hypot(x, y) - 0.7) - 0.2


@pytest.mark.parametrize("cell", [0.2, 0.12, 0.05])
@pytest.mark.parametrize(("function", "area", "within"), [
    (square, 4 * 0.63 * 0.51, 1e-12),
    (notched, 1.6**2 - 0.77 * 0.79, 1e-12),
    (ring, math.pi * (0.9**2 - 0.5**2), 0.02),
])  # fmt: skip
def test_meshes_fill_outlines_with_corners_and_without_slivers(function, area, within, cell):
    corner = np.array([1.0, 1.0, 0.0])
    mesh = outlined(-corner, corner, cell, Level(function), Simplex(2, 2))
    places, weights = mesh.element.rule
    sizes = sized(mesh.element, mesh.points[mesh.cells], places)
    assert sizes.min() > 0.0
    assert abs((sizes @ weights).sum() / area - 1.0) < (within if within < 1e-6 else within * cell**3 + 1e-12)
    assert math.degrees(mesh.worst[0]) > 20.0
    assert mesh.worst == plane_quality.angles(mesh.points, mesh.cells[:, :3])


def test_any_disk_is_filled_with_angles_above_17_degrees():
    random = np.random.default_rng(5)
    for _ in range(40):
        x0, y0, radius = *random.uniform(-1, 1, 2), random.uniform(0.3, 2.0)
        corner = np.array([x0, y0, 0.0])
        level = Level(lambda x, y, x0=x0, y0=y0, radius=radius: np.hypot(x - x0, y - y0) - radius)
        mesh = outlined(corner - radius, corner + radius, 0.2, level, Simplex(2, 1))
        assert math.degrees(mesh.worst[0]) > 17.0


def test_thin_parts_and_gaps_are_refused():
    corner = np.array([1.0, 1.0, 0.0])
    thin = Level(lambda x, y: np.minimum(np.hypot(x, y) - 0.5, np.maximum(np.abs(y) - 0.02, np.abs(x) - 0.9)))
    slit = Level(lambda x, y: np.maximum(np.hypot(x, y) - 0.9, 0.01 - np.maximum(np.abs(x), -y - 0.3)))
    for level, text in ((thin, "thinner"), (slit, "narrower")):
        with pytest.raises(TooCoarse, match=text):
            outlined(-corner, corner, 0.1, level, Simplex(2, 1))


def test_pictures_see_the_elements_own_functions(tmp_path):
    heat = Heat(tmp_path, "{tr_bdf2: {step: 1 ms}}", 0.1, objects=ROOM, domain="ball", cell="0.1 m",
                initial='"1 + 2*x - y + x*y"')  # fmt: skip
    state = heat.run.state("heat")
    between = heat.model.between(heat.model.layout(state), state)
    random = np.random.default_rng(2)
    places = np.column_stack([random.uniform(0.15, 0.4, 50), random.uniform(0.1, 0.4, 50), np.zeros(50)])
    exact = 1 + 2 * places[:, 0] - places[:, 1] + places[:, 0] * places[:, 1]
    assert np.abs(between.at(between.filled(heat.read("concentration")), places) - exact).max() < 1e-13
    grid = between.gridded(heat.read("concentration"))
    assert grid.shape == between.known.shape
    assert np.isfinite(grid).all()


def test_what_it_is_made_of_is_told(tmp_path):
    heat = Heat(tmp_path, "auto", 0.1, **DISK, cell="0.2 m")
    told = heat.model.remark(heat.run.state("heat"))
    rate = heat.model._solved.fastest()
    assert "triangles p2" in told
    assert f"forward steps up to {2 / rate:.3g} s" in told
    solved = heat.model._solved
    dense = np.linalg.eigvals(np.linalg.solve(solved.form.mass().toarray(), solved.form.stiffness(np.ones(
        solved.form.points.shape[:2])).toarray()))  # fmt: skip
    assert rate == pytest.approx(dense.real.max(), rel=2e-2)


@pytest.mark.parametrize(("fields", "text"), [
    ("element: p1", "say `method: elements`"),
    ("method: elements, drift: {stream_function: x}", "elements carry nothing"),
    ("method: elements, edges: staircase", "`edges` is for cells"),
    ("method: elements, boundary: {left: {open: yes}}", "`open` lets a drift through"),
])  # fmt: skip
def test_what_elements_cannot_do_is_refused_at_its_place(tmp_path, fields, text):
    path = tmp_path / "scene.yaml"
    path.write_text(f"models: {{heat: {{diffusion: {{size: 1 1 m, cell: 0.1 m, coefficient: 1, {fields}}}}}}}\n")
    with pytest.raises(ScriptError, match=text) as error:
        load(path, pruned=False)
    assert all(one.span is not None for one in error.value.diagnostics)
