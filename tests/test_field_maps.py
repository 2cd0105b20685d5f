"""Fields in pictures: interpolated, cut along boundaries, in colors, with lines and surfaces of one value."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from renderers.tracing.draw import draw
from runs import complaint
from sceneql.failure import RunFailure
from sceneql.frame import Mesh, Segments
from sceneql.grids.maps.colors import CONTROLS, colored, from_oklab, oklab, table
from sceneql.grids.maps.domains import cut_open, flat, outside, section
from sceneql.grids.maps.interpolation import Interpolation
from sceneql.grids.maps.iso import iso_sheet
from sceneql.grids.maps.iso_mesh import meshed
from sceneql.grids.maps.sheets import Sheet, contour, kept, lattice
from sceneql.grids.medium import FieldLayout
from sceneql.mesh.measures import area, pieces, volume
from sceneql.pipeline import frame_of, load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.dimension import TEMPERATURE
from sceneql.report.explain import explain
from sceneql.run.run import Run
from sceneql.shapes.color import linear

FLAT = FieldLayout((12, 9, 1), 0, 0, (-1.0, 0.5, -0.5), (0.25, 0.2, 1.0))
DEEP = FieldLayout((6, 5, 4), 0, 0, (-1.0, 0.5, 2.0), (0.25, 0.2, 0.3))


class Ball:
    """A disk or ball as a domain (grids.cut.Level)."""

    def __init__(self, center, radius):
        self.center, self.radius = np.array(center), radius

    def values(self, points):
        return np.linalg.norm(points - self.center, axis=1) - self.radius


def inside_of(layout, ball):
    return ball.values(layout.centers()) < 0.0


def somewhere(layout, count=200):
    low, spacing = np.array(layout.low), np.array(layout.spacing)
    points = low + np.random.default_rng(1).random((count, 3)) * spacing * layout.shape
    points[:, 2] *= layout.shape[2] > 1
    return points


# --- between the centers of cells ---


@pytest.mark.parametrize("layout", [FLAT, DEEP])
def test_linear_fields_are_themselves_up_to_the_walls(layout):
    between = Interpolation(layout, np.ones(layout.count, dtype=bool))
    plane = np.array([1.5, -2.0, 0.7 if layout is DEEP else 0.0])
    points = somewhere(layout)
    found = between.at(between.filled(layout.centers() @ plane + 3.0), points)
    np.testing.assert_allclose(found, points @ plane + 3.0, atol=1e-12)


def test_linear_fields_are_themselves_up_to_a_curved_shore():
    ball = Ball((0.4, 1.4, 0.0), 0.8)
    inside = inside_of(FLAT, ball)
    between = Interpolation(FLAT, inside)
    points = somewhere(FLAT)
    points = points[ball.values(points) < 0.0]
    found = between.at(between.filled(FLAT.centers()[inside] @ [0.0, 1.0, 0.0]), points)
    np.testing.assert_allclose(found, points[:, 1], atol=1e-12)


@given(st.lists(st.sampled_from([0.0, 1.0]), min_size=FLAT.count, max_size=FLAT.count))
@settings(max_examples=30)
def test_no_value_is_made_that_a_field_of_steps_does_not_have(values):
    inside = inside_of(FLAT, Ball((0.4, 1.4, 0.0), 0.9))
    between = Interpolation(FLAT, inside)
    found = between.at(between.filled(np.array(values)[inside]), somewhere(FLAT))
    assert found.min() >= 0.0
    assert found.max() <= 1.0


# --- sheets ---


def test_a_flat_domain_ends_on_its_shore():
    ball = Ball((0.4, 1.4, 0.0), 0.75)
    sheet = flat(FLAT, ball)
    away = ball.values(sheet.vertices)
    assert away.max() < 1e-9
    assert area(sheet.vertices, sheet.triangles) == pytest.approx(np.pi * 0.75**2, rel=2e-3)
    assert (np.abs(away) < 1e-9).sum() > 60


def test_a_section_of_a_ball_is_a_disk_across_any_direction():
    ball = Ball((-0.2, 1.0, 2.6), 0.45)
    normal = np.array([2.0, -1.0, 0.5]) / np.linalg.norm([2.0, -1.0, 0.5])
    found = section(DEEP, ball, (ball.center + 0.2 * normal, normal))
    np.testing.assert_allclose((found.vertices - ball.center) @ normal, 0.2, atol=1e-12)
    assert area(found.vertices, found.triangles) == pytest.approx(np.pi * (0.45**2 - 0.2**2), rel=0.01)


def test_a_box_that_is_cut_open_has_lost_what_lies_before_both_planes():
    middle = np.array(DEEP.low) + 0.5 * np.array(DEEP.spacing) * DEEP.shape
    planes = [(middle, np.eye(3)[0]), (middle, np.eye(3)[2])]
    whole = outside(DEEP, None)
    box = float(np.prod(np.array(DEEP.spacing) * DEEP.shape))
    assert volume(whole.vertices, whole.triangles) == pytest.approx(box, rel=1e-12)
    opened = cut_open(whole, [section(DEEP, None, plane) for plane in planes], planes)
    assert volume(opened.vertices, opened.triangles) == pytest.approx(0.75 * box, rel=1e-12)


@given(*[st.floats(-most, most).map(lambda number: round(number, 6)) for most in (2.0, 2.0, 1.0)])
@settings(max_examples=40)
def test_what_a_half_plane_keeps_and_what_it_takes_are_all(a, b, c):
    sheet = lattice((0, 0, 0), (1, 0, 0), (0, 1, 0), (7, 5))

    def side(points):
        return points @ [a, b, 0.0] + c

    parts = kept(sheet, side), kept(sheet, lambda points: -side(points))
    both = sum(area(part.vertices, part.triangles) for part in parts)
    assert both == pytest.approx(1.0 if (a, b) != (0.0, 0.0) or c else 0.0, rel=1e-9)


def test_the_line_of_a_value_is_straight_on_a_plane_and_round_on_a_cone():
    sheet = lattice((-1, -1, 0), (2, 0, 0), (0, 2, 0), (40, 40))
    x, y, _ = sheet.vertices.T
    line = contour(sheet, 2 * x - y, 0.3)
    np.testing.assert_allclose(2 * line[..., 0] - line[..., 1], 0.3, atol=1e-12)
    assert np.linalg.norm(line[:, 1] - line[:, 0], axis=1).sum() == pytest.approx(np.sqrt(5), rel=1e-9)
    ring = contour(sheet, np.hypot(x, y), 0.6)
    assert abs(np.hypot(ring[..., 0], ring[..., 1]) - 0.6).max() < 0.05**2 / 0.6  # h^2/8 of the second derivative
    assert np.linalg.norm(ring[:, 1] - ring[:, 0], axis=1).sum() == pytest.approx(1.2 * np.pi, rel=2e-3)


# --- surfaces of one value ---


def nodes(n, low=-1.0, high=1.0):
    axis = np.linspace(low, high, n)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    return (axis, axis, axis), x, y, z


def test_the_surface_of_a_ball_is_of_second_order_and_faces_outwards():
    errors = []
    for n in (12, 23, 45):
        axes, x, y, z = nodes(n)
        sheet = iso_sheet(axes, np.sqrt(x * x + y * y + z * z) - 0.7)
        assert pieces(sheet.triangles) == 1
        errors.append(abs(volume(sheet.vertices, sheet.triangles) / (4 / 3 * np.pi * 0.7**3) - 1))
    orders = np.log2(errors[:-1]) - np.log2(errors[1:])
    assert orders.min() > 1.8


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=25)
def test_surfaces_of_any_values_are_closed(seed):
    axes, *_ = nodes(6)
    values = np.pad(np.random.default_rng(seed).standard_normal((4, 4, 4)), 1, constant_values=1.0)
    sheet = iso_sheet(axes, values)
    edges = np.concatenate([sheet.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    forth = {(a, b) for a, b in edges.tolist()}
    assert len(forth) == len(edges)
    assert forth == {(b, a) for a, b in forth}


# --- colors ---


def test_oklab_is_as_published():
    np.testing.assert_allclose(oklab([1.0, 1.0, 1.0]), [1.0, 0.0, 0.0], atol=1e-4)
    np.testing.assert_allclose(oklab([1.0, 0.0, 0.0]), [0.627955, 0.224863, 0.125846], atol=1e-5)
    np.testing.assert_allclose(from_oklab(oklab([0.2, 0.5, 0.1])), [0.2, 0.5, 0.1], atol=1e-9)


@pytest.mark.parametrize("name", list(CONTROLS))
def test_maps_pass_through_their_control_colors(name):
    hexes = CONTROLS[name].split()
    wanted = [linear(int(text[k : k + 2], 16) / 255 for k in (0, 2, 4)) for text in hexes]
    found = colored(np.linspace(-3.0, 5.0, len(hexes)), (-3.0, 5.0), name)
    np.testing.assert_allclose(found, wanted, atol=2e-3)
    np.testing.assert_allclose(colored(np.array([-9.0, 99.0]), (-3.0, 5.0), name), [wanted[0], wanted[-1]], atol=1e-6)


@pytest.mark.parametrize("name", ["viridis", "inferno", "gray"])
def test_maps_from_dark_to_light_grow_lighter_evenly(name):
    lightness = oklab(table(name))[:, 0]
    rise = np.diff(lightness)
    assert rise.min() > 0.0
    assert rise.max() < 4.0 * rise.mean()


def test_the_map_with_a_middle_is_lightest_there_and_falls_to_both_sides():
    lightness = oklab(table("coolwarm"))[:, 0]
    assert abs(int(np.argmax(lightness)) - len(lightness) / 2) < 0.02 * len(lightness)
    assert lightness[0] == pytest.approx(lightness[-1], abs=0.06)


# --- the word ---

PLATE = """
clock: {{end: 1 s, fps: 10}}
models:
  plate: {{diffusion: {{size: 2 1 m, cell: 0.05 m, of: number, coefficient: "0.001", initial: "x"}}}}
objects:
  map: {{field_map: {{of: plate.concentration, {fields}}}}}
solvers: {{main: {{ftcs: {{step: 0.1 s}}}}}}
lights: {{even: {{sky: {{color: white}}}}}}
cameras: {{plan: {{orthographic: {{height: 0.5 m, look_at: 1 0.5 0 m}}}}}}
outputs: {{film: {{image: {{size: 64 32}}}}}}
"""


def shapes(folder, fields, time=0.0):
    path = folder / "scene.yaml"
    path.write_text(PLATE.format(fields=fields), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([time])
    return frame_of(graph, "film", (64, 32), moment, 0)


def test_under_an_even_sky_a_picture_has_the_colors_of_the_map(tmp_path):
    frame = shapes(tmp_path, "range: 0 2")
    picture = draw(frame, samples=1).linear
    x = 1.0 + (np.arange(64) + 0.5 - 32) / 64
    np.testing.assert_allclose(picture[10], colored(x, (0.0, 2.0), "viridis"), atol=3e-3)


def test_the_range_is_that_of_the_start_at_any_time(tmp_path):
    for time in (0.0, 0.7):
        mesh = next(shape for shape in shapes(tmp_path, "colors: gray", time).shapes if isinstance(shape, Mesh))
        near = np.abs(mesh.vertices[:, 0] - 1.0) < 1e-9
        assert near.any()
        wanted = colored(np.ones(near.sum()), (0.025, 1.975), "gray")
        np.testing.assert_allclose(mesh.colors[near], wanted, atol=1e-9)


def test_contours_and_heights_are_where_the_field_has_the_value(tmp_path):
    frame = shapes(tmp_path, "range: 0 2, contours: 0.5 1.25, height: 0.1 m, contour_radius: 2 mm")
    mesh = next(shape for shape in frame.shapes if isinstance(shape, Mesh))
    lines = next(shape for shape in frame.shapes if isinstance(shape, Segments))
    np.testing.assert_allclose(mesh.vertices[:, 2], 0.1 * mesh.vertices[:, 0], atol=1e-12)
    places = np.unique(np.round(lines.ends[..., 0], 9))
    np.testing.assert_allclose(places, [0.5, 1.25], atol=1e-9)
    assert set(lines.radii) == {0.002}


def test_a_relief_without_measure_is_told_and_a_high_one_is_drawn(tmp_path):
    mesh = next(shape for shape in shapes(tmp_path, "height: 1e9 m").shapes if isinstance(shape, Mesh))
    assert mesh.vertices[:, 2].max() > 1e9
    with pytest.raises(RunFailure, match=r"map.height: the field is lifted by 2e\+62 m, over a side of 2 m") as told:
        shapes(tmp_path, "height: 1e62 m")
    assert told.value.span.text == "1e62 m"


def test_what_cannot_be_drawn_is_told_with_its_place(tmp_path):
    for fields, told in (
        ("range: 0 1 kg", "the field as a plain number"),
        ("height: 1 s", "a height is a length for a unit of the field"),
        ("cut: [{normal: 0 0 0}]", "normal gives a direction, which 0 0 0 does not have"),
    ):
        assert told.removeprefix("the field as ") in complaint(tmp_path, PLATE.format(fields=fields)), fields
    path = tmp_path / "scene.yaml"
    path.write_text(PLATE.format(fields="cut: [{normal: 0 0 1}]"), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.0])
    with pytest.raises(Exception, match="a flat field has no inside"):
        frame_of(graph, "film", (64, 32), moment, 0)


def test_a_field_is_one_parts(tmp_path):
    told = complaint(tmp_path, PLATE.format(fields="range: 0 1").replace("plate.concentration,", "'[1, 2]',"))
    assert "a field is one part's" in told


def test_an_empty_sheet_stays_empty():
    empty = kept(Sheet(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32)), lambda points: points[:, 0])
    assert len(empty.triangles) == 0


# --- surfaces of a value, as a word ---

ROOM = """
clock: {{end: 1 s, fps: 10}}
models:
  room:
    diffusion: {{size: 1 1 1 m, corner: -0.5 -0.5 -0.5 m, cell: "1/{n} m", of: number, coefficient: "1e-9",
                 initial: "sqrt(x^2 + y^2 + z^2)"}}
objects:
  skin: {{iso_surface: {{of: room.concentration, {fields}}}}}
solvers: {{main: {{ftcs: {{step: 0.1 s}}}}}}
outputs: {{film: {{image: {{size: 64 32}}}}}}
"""


def skins(folder, n, fields):
    path = folder / "scene.yaml"
    path.write_text(ROOM.format(n=n, fields=fields), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.0])
    return moment.lower(["skin"])


def meshes(folder, n, fields):
    return [meshed(shape) for shape in skins(folder, n, fields)]


def test_a_surface_of_a_value_is_the_ball_it_should_be_of_second_order(tmp_path):
    errors = []
    for n in (10, 20, 40):
        (mesh,) = meshes(tmp_path, n, "at: 0.4")
        radii = np.linalg.norm(mesh.vertices, axis=1)
        inward = -(mesh.normals * mesh.vertices).sum(axis=1) / radii  # the front faces lower values
        errors.append(abs(radii - 0.4).max())
        assert inward.min() > 1 - 0.2 / n
        assert -volume(mesh.vertices, mesh.triangles) == pytest.approx(4 / 3 * np.pi * 0.4**3, rel=4 / n**2)
    assert np.log2(errors[1] / errors[2]) > 1.8


def test_surfaces_of_values_end_on_the_walls_and_have_the_colors_of_a_map(tmp_path):
    inner, outer = meshes(tmp_path, 16, "at: 0.3 0.6, colors: inferno")
    assert abs(outer.vertices).max() == pytest.approx(0.5, abs=1e-12)
    assert abs(inner.vertices).max() < 0.31
    np.testing.assert_allclose([inner.surface.color, outer.surface.color], table("inferno")[[0, -1]], atol=1e-12)


ALONE = """
clock: {end: 1 s, fps: 10}
models: {plate: {diffusion: {size: 2 1 m, cell: 0.1 m, of: number, coefficient: "0.001", initial: "x"}}}
"""


def test_a_field_that_nothing_shows_is_shown_in_colors(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(ALONE, encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.5])
    (mesh,) = moment.lower(graph.drawn["film"])
    assert mesh.colors is not None
    np.testing.assert_allclose(mesh.vertices.max(axis=0), [2.0, 1.0, 0.0], atol=1e-12)
    path.write_text(ALONE + "objects: {map: {field_map: {of: plate.concentration, hidden: yes}}}\n", encoding="utf-8")
    assert load(path).drawn["film"] == ()


def test_a_field_is_seen_on_an_object_that_stands_in_it(tmp_path):
    path = tmp_path / "scene.yaml"
    room = ROOM.format(n=12, fields="at: 0.4")
    room += "cameras: {plan: {orthographic: {height: 1 m}}}\n"
    for solid in ("ball: {sphere: {radius: 0.2 m, position: 0.1 0 0 m}}", "ball: {box: {size: 0.3 0.3 0.3 m}}"):
        shown = "map: {field_map: {of: room.concentration, on: ball, range: 0 1}}"
        path.write_text(room.replace("objects:", f"objects:\n  {solid}\n  {shown}"), encoding="utf-8")
        graph = load(path)
        assert "ball" not in graph.drawn["film"]
        (moment,) = Run(graph).moments([0.0])
        np.testing.assert_array_equal(moment.place("ball"), np.eye(3, 4))  # what holds it has no place of its own
        (mesh,) = moment.lower(["map"])
        exact = {"sphere": 4 / 3 * np.pi * 0.2**3, "box": 0.3**3}["sphere" if "sphere" in solid else "box"]
        assert volume(mesh.vertices, mesh.triangles) == pytest.approx(exact, rel=5e-3)
        radii = np.linalg.norm(mesh.vertices, axis=1)
        wrong = abs(mesh.colors - colored(radii, (0.0, 1.0), "viridis")).max(axis=1)
        assert wrong[radii > 0.1].max() < 0.03
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)


SPECIES = """
clock: {end: 1 s, fps: 10}
models:
  dish:
    reaction_diffusion:
      size: 1 1 m
      cell: 0.1 m
      species: {u: {coefficient: 1e-3, initial: "x"}, v: {coefficient: 1e-3, initial: "2*y"}}
objects: {map: {field_map: {of: dish.v - dish.u, range: -1 2}}}
solvers: {main: {rk4: {step: 0.1 s}}}
"""


def test_species_of_a_reaction_are_fields_as_well_and_so_is_their_difference(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SPECIES, encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.0])
    (mesh,) = moment.lower(["map"])
    x, y, _ = mesh.vertices.T
    np.testing.assert_allclose(mesh.colors, colored(2 * y - x, (-1.0, 2.0), "viridis"), atol=1e-9)


HEAT = """
clock: {end: 1 s, fps: 5}
models: {rod: {diffusion: {size: 1 0.2 m, cell: 5 cm, coefficient: 0.05 m^2/s, INITIAL, boundary: {left: {value: 1}}}}}
objects: {map: {field_map: {of: rod.concentration}}}
outputs: {film: {video: {size: 64 36}}}
"""


@pytest.mark.parametrize(
    ("initial", "low", "high"),
    [("initial: 0", 0.0, 0.936), ("initial: x", 0.025, 0.975), ("initial: 1", 1.0, 2.0)],
)
def test_colors_mean_the_same_in_every_frame(tmp_path, initial, low, high):
    """The range is the start's; of a field that is even then, that of the whole run (0.936 at the wall's cell)."""
    (tmp_path / "scene.yaml").write_text(HEAT.replace("INITIAL", initial))
    graph = load(tmp_path / "scene.yaml")
    shown = graph.tasks["map"].kind
    scales = [shown.scale(moment) for moment in Run(graph).moments([0.0, 0.4, 0.8])]
    assert scales == [scales[0]] * 3
    assert scales[0] == pytest.approx((low, high), abs=1e-3)


def test_a_range_that_takes_a_run_ahead_is_told(tmp_path):
    told = {}
    for initial in ("initial: 0", "initial: x"):
        (tmp_path / "scene.yaml").write_text(HEAT.replace("INITIAL", initial))
        told[initial] = explain(load(tmp_path / "scene.yaml"))["ranges"]
    assert told == {"initial: 0": ["map"], "initial: x": []}


def test_a_field_of_temperature_is_called_so(tmp_path):
    script = """
models: {plate: {diffusion: {of: temperature, size: 1 1 m, cell: 0.25 m, coefficient: 1 m^2/s, initial: 20 °C}}}
objects: {map: {field_map: {of: plate.NAME}}}
expect: {start: {of: initial(plate.max), value: 293.15, tolerance: 1e-9, because: given}}
"""
    path = tmp_path / "scene.yaml"
    path.write_text(script.replace("plate.NAME", "plate.temperature"))
    assert load(path).tasks["map"].kind.of.links[0].output == "temperature"
    path.write_text(script.replace("plate.NAME", "plate.heat"))
    with pytest.raises(ScriptError, match="'plate' gives no 'heat'"):
        load(path)
    path.write_text(script.replace("plate.NAME", "plate.concentration"))  # its name before
    (link,) = load(path).tasks["map"].kind.of.links
    assert (link.output, link.type.dimension) == ("concentration", TEMPERATURE)


def test_a_field_that_draws_itself_is_seen_in_place_of_its_domain(tmp_path):
    (tmp_path / "scene.yaml").write_text("""
objects:
  sheet: {box: {size: 1 0.6 0.02 m}}
  hole: {sphere: {radius: 0.12 m}}
  holed: {difference: {of: [sheet, hole]}}
models: {plate: {diffusion: {domain: holed, flat: yes, cell: 2 cm, coefficient: 1e-4 m^2/s, initial: x}}}
outputs: {still: {image: {size: 64 36, time: 0 s}}}
""")
    assert load(tmp_path / "scene.yaml").drawn["still"] == ("plate_map",)


@pytest.mark.parametrize(
    ("look", "drawn"), [("", ("map",)), (", color: red", ("disc", "map")), (", hidden: no", ("disc", "map"))]
)
def test_a_map_is_seen_in_place_of_its_domain_of_which_no_look_is_said(tmp_path, look, drawn):
    disc = f"disc: {{cylinder: {{radius: 0.5 m, height: 1 cm, rotation: {{about: x, angle: 90 deg}}{look}}}}}"
    (tmp_path / "scene.yaml").write_text(f"""
objects:
  {disc}
  map: {{field_map: {{of: drum.height, height: 1}}}}
models: {{drum: {{wave: {{domain: disc, flat: yes, cell: 5 cm, speed: 1 m/s}}}}}}
outputs: {{still: {{image: {{size: 64 36, time: 0 s}}}}}}
""")
    assert load(tmp_path / "scene.yaml").drawn["still"] == drawn


SKIN = """
models: {{skin: {{wave: {{size: 1 1 m, cell: 0.25 m, speed: 1 m/s, initial: 0.2*x - 0.05}}}}}}
objects: {{sheet: {{field_map: {{of: skin.height, {fields}}}}}}}
cameras: {{above: {{perspective: {{position: 0.5 0.5 3 m, look_at: 0.5 0.5 0 m, up: 0 1 0}}}}}}
outputs: {{film: {{image: {{size: 64 32}}}}}}
"""


def test_what_swings_about_zero_has_the_middle_of_its_map_there(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SKIN.format(fields=""), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.0])
    (mesh,) = [shape for shape in frame_of(graph, "film", (64, 32), moment, 0).shapes if isinstance(shape, Mesh)]
    most = 0.2 * 0.875 - 0.05
    inner = np.abs(mesh.vertices[:, :2] - 0.5).max(axis=1) < 0.3
    heights = 0.2 * mesh.vertices[inner, 0] - 0.05
    np.testing.assert_allclose(mesh.colors[inner], colored(heights, (-most, most), "coolwarm"), atol=1e-9)


def test_a_map_of_no_colors_has_those_of_its_material(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SKIN.format(fields="colors: none, height: 1, material: {mirror: {}}"), encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.0])
    (mesh,) = [shape for shape in frame_of(graph, "film", (64, 32), moment, 0).shapes if isinstance(shape, Mesh)]
    assert mesh.colors is None
    assert mesh.vertices[:, 2].max() > 0.1
