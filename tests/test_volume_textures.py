"""Colors that stick to the material of solids of elements, and solids cut open: at rest, deformed, at a pixel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import stage
from renderers.rastering.triangles import triangles
from renderers.tracing.layout import ITEMS
from renderers.tracing.pack import pack
from renderers.tracing.scratch import scratch
from renderers.tracing.solids.surface_kernels import normal_at
from sceneql.bodies.elements.element import elements
from sceneql.bodies.elements.element_mesh import meshed
from sceneql.bodies.elements.skin import Inside, Skin
from sceneql.bodies.filling.block import Block
from sceneql.failure import RunFailure
from sceneql.field.tape.builder import TapeBuilder
from sceneql.frame import Mesh, is_held
from sceneql.pipeline import load
from sceneql.run.run import Run
from sceneql.shapes.color import linear
from sceneql.shapes.cut_open import Plane, clipped, cut_open
from stage import WHITE, frame
from test_ray_packets import SKY, pictures

BLOCK = Block(size=(1.0, 0.4, 0.6), cells=(4, 2, 3))
SCENE = """
clock: {end: 1 s}
models:
  bar:
    elastic:
      of: shape
      spacing: 0.2 m
      law: {neo_hookean: {modulus: 10 kPa}}
      position: 3 0 0 m
      rotation: {about: z, angle: 90 deg}
      velocity: 0 1 0 m/s
objects:
  shape: {cylinder: {radius: 0.3 m, height: 1 m, hidden: yes}}
  seen: {surface: {of: bar, paint: {by: "0.5 + y", colors: [red, white, blue]}, CUT}}
solvers: {main: {rk4: {step: 5 ms}}}
outputs: {film: image}
"""


def shapes(folder, script, times):
    path = folder / "scene.yaml"
    path.write_text(script)
    return [moment.lower(["seen"]) for moment in Run(load(path)).moments(times)]


def solid(element="p2"):
    points, tetrahedra = BLOCK.made()
    return meshed(elements()[element], points, tetrahedra)


def bent(points):
    """Rolled up about an axis along z, by a quarter of a turn."""
    angle, radius = np.pi / 2 * points[:, 0], 2 / np.pi - points[:, 1]
    return np.column_stack([radius * np.sin(angle), -radius * np.cos(angle), points[:, 2]])


def volume(meshes):
    corners = np.concatenate([mesh.vertices[mesh.triangles] for mesh in meshes])
    return np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])) / 6


def area(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def test_a_painted_mesh_has_at_a_point_the_color_of_its_material_there():
    random = np.random.default_rng(3)
    rest = random.uniform(-1, 1, (4, 3))
    b = TapeBuilder()
    paint = b.finish(
        b.op("square", b.op("sin", b.op("mul", b.constant(9.0), b.x))), b.op("abs", b.y), b.op("sqrt", b.z)
    )
    place = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5]])
    order = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
    mesh = Mesh("skin", WHITE, place, order, None, None, rest, paint)
    scene, rows = pack(frame(stage.implicit_sphere(WHITE), mesh, replace(mesh, vertices=place + 5, paint=None)))
    memory, seen = scratch(rows), 0
    for item, row in enumerate(scene.ints[ITEMS : ITEMS + 4 * 5].reshape(5, 4)):
        if row[3] == 0:
            continue
        k = int(row[1])
        start, one, two = scene.reals[k : k + 9].reshape(3, 3)
        which = int(np.argmin([np.abs(place[t[0]] + 5 * (row[3] == 2) - start).max() for t in order]))
        for v, w in random.uniform(0, 0.5, (8, 2)):
            at = start + v * one + w * two
            *_, r, g, blue = normal_at(scene, memory, item, *at)
            seen += 1
            if row[3] == 2:
                assert np.isnan([r, g, blue]).all()
                continue
            x, y, z = rest[order[which]].T @ [1 - v - w, v, w]
            wanted = [np.sin(9 * x) ** 2, abs(y), np.sqrt(z) if z >= 0 else np.nan]
            assert [r, g, blue] == pytest.approx(wanted, abs=1e-12, nan_ok=True)
    assert seen == 32


def test_a_mesh_has_its_surface_s_color_where_its_paint_is_undefined():
    b = TapeBuilder()
    paint = b.finish(b.x, b.y, b.op("sqrt", b.z))
    place = np.array([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]])
    plain = Mesh("skin", WHITE, place, np.array([[0, 1, 2]], dtype=np.int32))
    rest = np.column_stack([place[:, :2], [-1.0, -2.0, -3.0]])
    pairs = [
        pictures(shape, lights=(SKY,), seen=stage.view(size=(24, 24)))
        for shape in (plain, replace(plain, rest=rest, paint=paint))
    ]
    np.testing.assert_array_equal(pairs[0], pairs[1])
    seen, _ = pictures(replace(plain, rest=-rest, paint=paint), lights=(SKY,), seen=stage.view(size=(24, 24)))
    assert np.abs(seen - pairs[0][0]).max() > 0.1


def test_what_raster_draws_is_painted_at_vertices():
    b = TapeBuilder()
    rest = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]])
    mesh = Mesh(
        "skin", WHITE, rest + 2, np.array([[0, 1, 2]], dtype=np.int32), None, None, rest, b.finish(b.z, b.y, b.x)
    )
    (made,) = triangles(mesh, 8)
    np.testing.assert_allclose(made.colors, rest[:, ::-1])


def test_paint_sticks_to_the_material_which_is_one_array_over_the_film(tmp_path):
    before, after = shapes(tmp_path, SCENE.replace(", CUT", ""), [0.0, 0.5])
    (one,), (two,) = before, after
    assert one.rest is two.rest
    assert is_held(one.rest)
    turned = np.column_stack([3 - one.rest[:, 1], one.rest[:, 0], one.rest[:, 2]])
    np.testing.assert_allclose(one.vertices, turned, atol=1e-9)
    np.testing.assert_allclose(two.vertices - one.vertices, np.broadcast_to([0, 0.5, 0], turned.shape), atol=1e-6)
    from sceneql.field.tape.tape_solid import paint_values

    red, white, blue = (np.array(linear(c)) for c in ((1, 0, 0), (1, 1, 1), (0, 0, 1)))
    points = np.array([[0, -0.7, 0], [0, -0.5, 0], [0.1, -0.25, 0], [0, 0, 0], [0, 0.4, 9], [0, 0.6, 0]])
    wanted = [red, red, (red + white) / 2, white, 0.2 * white + 0.8 * blue, blue]
    np.testing.assert_allclose(paint_values(one.paint, points), wanted, atol=1e-12)


def test_a_color_by_three_formulas_is_decoded_as_colors_are(tmp_path):
    from sceneql.field.tape.tape_solid import paint_values

    script = SCENE.replace('by: "0.5 + y", colors: [red, white, blue]', 'color: [x, "mix(0.02, y, t)", 1 + z]')
    ((mesh,),) = shapes(tmp_path, script.replace(", CUT", ""), [0.0])
    points = np.random.default_rng(1).uniform(-0.2, 1.2, (50, 3))
    wanted = [linear(np.clip([x, 0.02, 1 + z], 0, 1)) for x, _, z in points]
    np.testing.assert_allclose(paint_values(mesh.paint, points), wanted, atol=1e-8)


@pytest.mark.parametrize("element", ["p1", "p2"])
def test_a_bent_solid_cut_open_is_closed_and_its_inside_is_where_it_came_from(element):
    mesh = solid(element)
    places = bent(mesh.points)
    skin = Skin.of(mesh).drawn("bar", WHITE, places)
    planes = [Plane(np.array([0.0, 0.0, 0.05]), np.array([0.0, 0.0, 1.0]))]
    values = places[:, 2].copy()
    pieces = list(cut_open(skin, Skin.of(mesh).at_vertices(values), Inside(mesh, places, values), planes))
    whole = volume([skin])
    outer, face = (mesh for mesh, _ in pieces)
    assert volume([outer, face]) == pytest.approx(whole * 0.35 / 0.6, rel=1e-8)
    assert area(face) == pytest.approx(whole / 0.6, rel=1e-8)
    np.testing.assert_allclose(face.vertices[:, 2], 0.05, atol=1e-9)
    assert outer.vertices[:, 2].max() < 0.05 + 1e-8
    np.testing.assert_array_equal(face.normals, np.broadcast_to([0, 0, 1.0], face.normals.shape))
    inside = face.rest
    off = np.abs(bent(inside) - face.vertices).max()
    assert off < (0.05 if element == "p1" else 4e-3)  # as far as elements follow the bend
    np.testing.assert_allclose(pieces[1][1], 0.05, atol=1e-9)
    np.testing.assert_allclose(pieces[0][1], outer.vertices[:, 2], atol=1e-9)


def test_only_what_lies_before_all_planes_is_away():
    mesh = solid()
    skin = Skin.of(mesh).drawn("bar", WHITE, mesh.points)
    normals = np.array([[0, 0, 1.0], [1.0, 0, 0], [0.6, 0.8, 0]])
    for count, away in ((1, 0.5), (2, 0.25)):
        planes = [Plane(np.zeros(3), normal) for normal in normals[:count]]
        pieces = [mesh for mesh, _ in cut_open(skin, None, Inside(mesh, mesh.points, None), planes)]
        assert len(pieces) == 1 + count
        assert volume(pieces) == pytest.approx(0.24 * (1 - away), rel=1e-6)
        for piece in pieces:
            np.testing.assert_allclose(piece.rest, piece.vertices, atol=1e-6)
    aside = [Plane(np.array([0.0, 0.0, 2.0]), normals[0])]
    assert volume([m for m, _ in cut_open(skin, None, Inside(mesh, mesh.points, None), aside)]) == pytest.approx(0.24)


def test_triangles_are_clipped_to_what_is_below():
    random = np.random.default_rng(0)
    corners = random.normal(size=(200, 3, 3))
    heights = corners[..., 2] - 0.2
    low, high = clipped(corners, heights), clipped(corners, -heights)
    assert low[..., 2].max() <= 0.2 + 1e-12
    assert high[..., 2].min() >= 0.2 - 1e-12

    def size(some):
        return np.cross(some[:, 1] - some[:, 0], some[:, 2] - some[:, 0]).sum(axis=0)

    np.testing.assert_allclose(size(low) + size(high), size(corners), atol=1e-9)


def test_a_round_solid_is_cut_open_without_gaps_and_drawn_where_it_is(tmp_path):
    ((outer, face),) = shapes(tmp_path, SCENE.replace("CUT", "cut: [{through: 3 0.1 0 m, normal: 0 1 1}]"), [0.2])
    assert face.paint is outer.paint is not None
    height = (face.vertices - [3, 0.1, 0]) @ np.array([0, 1, 1]) / np.sqrt(2)
    assert np.abs(height).max() < 1e-9
    ((whole,),) = shapes(tmp_path, SCENE.replace(", CUT", ""), [0.2])
    other = "cut: [{through: 3 0.1 0 m, normal: 0 -1 -1}]"
    rest = volume(shapes(tmp_path, SCENE.replace("CUT", other), [0.2])[0])
    assert volume([outer, face]) + rest == pytest.approx(volume([whole]), rel=1e-8)
    np.testing.assert_allclose(np.hypot(*face.rest[:, [0, 2]].T).max(), 0.3, atol=5e-3)


def test_only_elastic_solids_are_painted_and_cut_open(tmp_path):
    for field, what in (("paint: {by: x, colors: [red, blue]}", "painted"), ("cut: {normal: 0 0 1}", "cut open")):
        script = f"models: {{flag: {{cloth: {{cells: 4 4}}}}}}\nobjects: {{seen: {{surface: {{of: flag, {field}}}}}}}"
        with pytest.raises(RunFailure, match=what):
            shapes(tmp_path, script, [0.0])


def test_both_sides_of_a_crease_are_shaded_by_their_own_slope(tmp_path):
    script = SCENE.replace(", CUT", "").replace(
        "cylinder: {", "difference: {of: [rod, hole], hidden: yes}}\n  rod: {cylinder: {"
    )
    script = script.replace("seen:", "hole: {sphere: {radius: 0.2 m, position: 0 0.5 0 m, hidden: yes}}\n  seen:")
    ((mesh,),) = shapes(tmp_path, script, [0.0])
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    assert np.einsum("ti,tki->tk", across, mesh.normals[mesh.triangles]).min() > 0.8
