"""Domains of fields from files: SVG paths against their definitions, picture masks, closed meshes, initial pictures."""

from __future__ import annotations

import cmath
import math

import imageio.v3 as imageio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sceneql.grids.domain import svg
from sceneql.grids.domain.mesh import MeshLevel
from sceneql.grids.domain.polygon import Polygon
from sceneql.grids.domain.svg_path import curves
from sceneql.pipeline import load, simulate
from sceneql.quantities.diagnostic import ScriptError
from test_grids import Basin

HEAD = '<svg xmlns="http://www.w3.org/2000/svg">'
OCTAHEDRON = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


def drawn(folder, inner, name="shape.svg"):
    path = folder / name
    path.write_text(f"{HEAD}{inner}</svg>", encoding="utf-8")
    return path


def octahedron(folder):
    lines = [f"v {x} {y} {z}" for x, y, z in OCTAHEDRON] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES]
    (folder / "octahedron.obj").write_text("\n".join(lines), encoding="utf-8")
    return "solid: {mesh: {file: octahedron.obj}}"


# --- path data ---


@given(
    st.tuples(st.floats(0.1, 5), st.floats(0.1, 5), st.floats(0, 180)),
    st.floats(-180, 180),
    st.floats(3, 357),
    st.booleans(),
)
@settings(max_examples=100)
def test_an_arc_lies_on_its_ellipse(ellipse, first, turned, positive):
    """An arc made from its center, told by its ends and flags as SVG does, is found again."""
    rx, ry, tilt = ellipse
    way = turned if positive else -turned

    def point(angle):
        z = cmath.rect(1, math.radians(angle))
        return 3 - 2j + cmath.rect(1, math.radians(tilt)) * complex(rx * z.real, ry * z.imag)

    a, b = point(first), point(first + way)
    flags = f"{int(turned > 180)}{int(positive)}"
    found = curves(f"M{a.real!r},{a.imag!r} A{rx!r} {ry!r} {tilt!r} {flags}{b.real!r} {b.imag!r}")[0][:-1]
    size = max(rx, ry)
    for k, (start, c, d, end) in enumerate(found):
        middle = (start + 3 * c + 3 * d + end) / 8
        assert abs(middle - point(first + way * (k + 0.5) / len(found))) < 1e-4 * size / min(1.0, abs(a - b) / size)
    assert found[-1][3] == b


@pytest.mark.parametrize(
    ("short", "long"),
    [
        ("m1 2l3 4 5-6h2v-1z", "M1,2 L4,6 L9,0 L11,0 L11,-1 Z"),
        ("M0 0C1 1 2 1 3 0S5-1 6 0", "M0 0 C1 1 2 1 3 0 C4 -1 5 -1 6 0"),
        ("M0 0q1 2 2 0t2 0", "M0 0 Q1 2 2 0 Q3 -2 4 0"),
        ("M.5.5 1.5.5 1e0 2", "M0.5 0.5 L1.5 0.5 L1 2"),
        ("M1 1h1v1zm3 3h1v1z", "M1 1 L2 1 L2 2 Z M4 4 L5 4 L5 5 Z"),
    ],
)
def test_short_and_long_forms_are_the_same(short, long):
    flat = [
        np.array([[p for curve in row for p in curve] for row in curves(text) if row]).ravel() for text in (short, long)
    ]
    np.testing.assert_allclose(*flat, atol=1e-14)


def test_a_quadratic_curve_is_its_cubic():
    (curve, _), t = curves("M0 0Q1 2 4 1")[0], 0.3
    a, b, c, d = curve
    cubic = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t * t * c + t**3 * d
    assert abs(cubic - (2 * (1 - t) * t * (1 + 2j) + t * t * (4 + 1j))) < 1e-15


@pytest.mark.parametrize("bad", ["L1 1", "M0 0 L1", "M0 0 A1 1 0 2 0 1 1", "M0 0 X", "M0 0 Z 5 5", "M1e999 0 L1 1"])
def test_bad_path_data_is_told(bad):
    with pytest.raises(ValueError, match="path data"):
        curves(bad)


# --- SVG files ---


def test_shapes_keep_their_area_under_transforms(tmp_path):
    inner = (
        '<g transform="translate(3,4) rotate(30) scale(2 1)"><g transform="matrix(1 0 .5 1 0 0)">'
        '<circle id="c" r="2"/><rect id="r" x="-.5" y="-.25" width="1" height=".5"/></g></g>'
        '<defs><circle id="no" r="9"/></defs>'
    )
    found = svg.rings(str(drawn(tmp_path, inner)))
    assert list(found) == ["c", "r"]
    # Chords lie within 5e-5 of the size, here about 9, of the ellipse.
    assert abs(svg.area(found["c"])) == pytest.approx(8 * math.pi, rel=5e-4)
    assert abs(svg.area(found["r"])) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize(
    ("inner", "said"),
    [
        ("<text>no</text>", "no path"),
        ('<path d="M0 0 L1 1"/>', "no path with an inside"),
        ('<rect width="1" height="1" transform="warp(3)"/>', "transform"),
        ("<path", "no SVG"),
    ],
)
def test_bad_files_are_told(tmp_path, inner, said):
    path = tmp_path / "bad.svg"
    path.write_text(f"{HEAD}{inner}</svg>", encoding="utf-8")
    with pytest.raises(ValueError, match=f"bad.svg.*{said}"):
        svg.rings(str(path))


def test_entities_are_refused(tmp_path):
    path = tmp_path / "bomb.svg"
    path.write_text('<!DOCTYPE svg [<!ENTITY a "aaaa">]><svg>&a;</svg>', encoding="utf-8")
    with pytest.raises(ValueError, match="entities"):
        svg.rings(str(path))


def test_a_lake_of_an_svg_has_its_area_islands_and_place(tmp_path):
    drawn(tmp_path, '<circle id="big" cx="50" cy="40" r="10"/><path id="rock" d="M48 38h4v4h-4z"/>', "lake.svg")
    shore = "shore: {outline: {file: lake.svg, width: 2 m, corner: 1 3 m}}"
    parts = "{rock: {flux: 1}, mouth: {flux: 2, near: 3 4 m, within: 0.3 m}}"
    basin = Basin(tmp_path, shore, "{tr_bdf2: {step: 10 ms}}", cell="0.02 m", boundary=parts).at(0.1)
    assert basin.volumes.sum() == pytest.approx(math.pi - 0.16, rel=2e-3)
    center = basin.volumes @ basin.layout.centers()[:, :2] / basin.volumes.sum()
    np.testing.assert_allclose(center, (2, 4), atol=1e-3)
    # The rock has a shore of 1.6 m; a circle of 0.3 m holds 4 asin(0.15) m of the lake's.
    assert basin.read("inflow") == pytest.approx(0.1 * (1.6 + 2 * 4 * math.asin(0.15)), rel=0.03)


def test_an_island_has_a_name_of_its_own(tmp_path):
    drawn(tmp_path, '<circle id="big" cx="50" cy="40" r="10"/><path id="rock" d="M48 38h4v4h-4z"/>', "lake.svg")
    corner = "[[1 m, 1 m], [2 m, 1 m], [1 m, 2 m]]"
    for source, name, said in (
        ("file: lake.svg, width: 2 m", "rock", "an island is named rock, which the file has, too"),
        ("points: [[0 m, 0 m], [4 m, 0 m], [0 m, 4 m]]", "shore", "named shore, which is the outline itself"),
    ):
        shore = f"shore: {{outline: {{{source}, islands: {{{name}: {corner}}}}}}}"
        with pytest.raises(ScriptError, match=said):
            Basin(tmp_path, shore, "auto", cell="0.1 m")


# --- pictures ---


def test_a_mask_has_the_area_of_what_is_bright(tmp_path):
    y, x = np.mgrid[0:200, 0:300]
    disk = np.hypot(x - 149.5, y - 99.5) - 80
    light = np.clip(0.5 - disk, 0, 1)
    light[90:110, 140:160] = 0
    imageio.imwrite(tmp_path / "mask.png", np.round(255 * light).astype(np.uint8))
    basin = Basin(tmp_path, "pond: {outline: {file: mask.png, width: 1.6 m}}", "auto", cell="0.02 m")
    assert basin.volumes.sum() == pytest.approx(math.pi * 0.8**2 - 0.2**2, rel=2e-3)
    dark = "pond: {outline: {file: mask.png, width: 3 m, inside: dark}}"
    area = Basin(tmp_path, dark, "auto", cell="0.02 m").volumes.sum()
    assert area == pytest.approx(6 - math.pi * 0.8**2 + 0.2**2, rel=4e-3)


def test_a_transparent_picture_is_outside_where_it_is_clear(tmp_path):
    rgba = np.full((40, 60, 4), 255, dtype=np.uint8)
    rgba[:, 30:, 3] = 0
    imageio.imwrite(tmp_path / "half.png", rgba)
    basin = Basin(tmp_path, "pond: {outline: {file: half.png, width: 3 m}}", "auto", cell="0.1 m")
    assert basin.volumes.sum() == pytest.approx(3 * 4, rel=0.04)


def test_a_picture_is_the_field_at_the_start(tmp_path):
    slope = np.round(np.linspace(0, 65535, 64)).astype(np.uint16)
    imageio.imwrite(tmp_path / "ramp.png", np.tile(slope, (8, 1)))
    square = "plate: {outline: {points: [1 1 m, 3 1 m, 3 2 m, 1 2 m]}}"
    basin = Basin(tmp_path, square, "auto", cell="0.05 m", initial="{file: ramp.png, black: 2, white: 4}")
    x = basin.read("centers")[:, 0]
    pixel = np.clip((x - 1) / 2 * 64 - 0.5, 0, 63)
    np.testing.assert_allclose(basin.read("concentration"), 2 + 2 * pixel / 63, atol=1e-4)


# --- meshes ---


def test_the_distance_from_a_mesh_is_that_of_its_planes():
    corners = np.array([[OCTAHEDRON[k] for k in face] for face in FACES], dtype=float)
    points = np.random.Generator(np.random.Philox(1)).uniform(-0.6, 0.6, (500, 3))
    inside = np.abs(points).sum(axis=1) < 1
    found = MeshLevel(corners, "solid").values(points)
    assert ((found < 0) == inside).all()
    np.testing.assert_allclose(found[inside], (np.abs(points[inside]).sum(axis=1) - 1) / math.sqrt(3), atol=1e-14)


def test_a_mesh_is_a_domain(tmp_path):
    basin = Basin(tmp_path, octahedron(tmp_path), "{implicit_euler: {step: 10 ms}}", cell="0.1 m", initial="1+x*x")
    assert basin.volumes.sum() == pytest.approx(4 / 3, rel=0.02)
    start = basin.read("mass")
    assert basin.at(0.1).read("mass") == pytest.approx(start, rel=1e-14)
    section = Basin(tmp_path, octahedron(tmp_path), "auto", cell="0.05 m", flat="yes")
    assert section.volumes.sum() == pytest.approx(2, rel=0.01)


# --- polygons ---


@given(st.integers(3, 80), st.integers(0, 1000))
@settings(max_examples=50)
def test_a_polygon_knows_its_nearest_side(count, seed):
    draw = np.random.Generator(np.random.Philox(seed))
    angle = 2 * np.pi * np.arange(count) / count
    radius = draw.uniform(0.4, 1, count)
    ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    points = np.column_stack([draw.uniform(-1.2, 1.2, (200, 2)), np.zeros(200)])
    found = Polygon({"shore": ring}, {}).values(points)
    a, b = ring, np.roll(ring, -1, axis=0)
    reach = points[:, None, :2] - a
    t = np.clip((reach * (b - a)).sum(axis=2) / ((b - a) ** 2).sum(axis=1), 0, 1)
    away = np.linalg.norm(reach - t[:, :, None] * (b - a), axis=2).min(axis=1)
    # A ring around the origin: how often it winds around a point is the sum of its angles.
    turns = np.angle((b - points[:, None, :2]) @ [1, 1j] / ((a - points[:, None, :2]) @ [1, 1j])).sum(axis=1)
    np.testing.assert_allclose(found, np.where(np.abs(turns) > np.pi, -away, away), atol=1e-12)


def test_a_plate_thinner_than_a_cell_is_a_flat_domain_with_values_on_its_sides(tmp_path):
    """Across its faces alone its field has a slope there."""
    (tmp_path / "scene.yaml").write_text("""
objects: {sheet: {box: {size: 1 0.6 0.02 m}}}
models:
  plate:
    diffusion:
      domain: sheet
      flat: yes
      cell: 5 cm
      coefficient: 1 m^2/s
      boundary: {left: {value: 3, where: x < -0.49}, right: {value: 1, where: x > 0.49}}
clock: {end: 9 s}
outputs: {data: {record: {of: [plate.concentration, plate.centers]}}}
""")
    with np.errstate(divide="raise", invalid="raise"):
        *_, end = simulate(load(tmp_path / "scene.yaml"), [0.0, 9.0])
    x = end.read("plate", "centers")[:, 0]
    assert end.read("plate", "concentration") == pytest.approx(2 - 2 * x, abs=1e-6)
