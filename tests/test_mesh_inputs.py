"""Meshes from files: every format, what OBJ allows, shading across creases, and what is refused before it is read."""

from __future__ import annotations

import json
import os
import re
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from mesh_mutants import embedded
from moment import IDENTITY, FakeMoment
from sceneql.cli import cli
from sceneql.failure import LimitRefused
from sceneql.kinds import Exceeds
from sceneql.shapes.creases import creased
from sceneql.shapes.mesh_header import declared
from sceneql.shapes.raw_mesh import RawMesh
from sceneql.shapes.read_mesh import load
from sceneql.shapes.read_obj import BLOCK, read_obj
from sceneql.words.objects.mesh import Mesh

SMOOTH = np.radians(40)
MEASURE = """
import resource, sys
from pathlib import Path
from sceneql.shapes import read_mesh
small = Path(sys.argv[1]).with_name("small.obj")
small.write_text("v 0 0 0\\nv 1 0 0\\nv 0 1 0.1234567890123456789\\nv 0 0 1\\nf 1 2 3 4\\n")
read_mesh.load(str(small), 0.7)
in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (in_use + 300 * 2**20, -1))
print(len(read_mesh.load(sys.argv[1], 0.7).triangles))
"""


def within_memory(path):
    """Triangles of a file that is read in a process of its own, which gets 300 MB more than it has at the start."""
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, str(path)], capture_output=True, text=True, check=False, timeout=100
    )
    assert done.returncode == 0, done.stderr
    return int(done.stdout)


def test_many_faces_about_one_vertex_take_memory_as_they_are_many(tmp_path):
    count = 60_000
    turn = 2 * np.pi * np.arange(count) / count
    rows = ["v 0 0 1", *(f"v {x:.9g} {y:.9g} 0" for x, y in zip(np.cos(turn), np.sin(turn), strict=True))]
    rows += [f"f 1 {k + 2} {(k + 1) % count + 2}" for k in range(count)]
    path = tmp_path / "fan.obj"
    path.write_text("\n".join(rows))
    assert within_memory(path) == count


def test_a_text_of_64_mb_is_read_a_block_at_a_time(tmp_path):
    path = tmp_path / "large.obj"
    with path.open("wb") as stream:
        for k in range(64):
            stream.write(b"".join(b"v %d %d %d.5\n" % (k, j, j * j) for j in range(300)))
            stream.write(b"vn 0 0.1234567 1\n" * 58_000)
            stream.write(b"f -1 -2 -3\n" * 300)
    assert path.stat().st_size > 63e6
    assert within_memory(path) == 64 * 300


def test_a_file_may_have_four_million_triangles_and_no_more(tmp_path):
    path = tmp_path / "fans.obj"
    one = b"f" + b" 1 2 3 4" * 250_000 + b"\n"  # a polygon of a million corners, that of none is farther than three
    path.write_bytes(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + 4 * one)
    assert len(read_obj(path).triangles) == 4 * 999_998
    path.write_bytes(path.read_bytes() + b"f 1 2 3\n" * 9)
    scene = tmp_path / "s.yaml"
    scene.write_text("objects: {pot: {mesh: {file: fans.obj}}}\noutputs: {still: {image: {size: 16 9}}}\n")
    result = CliRunner().invoke(cli, ["render", str(scene)])
    assert "fans.obj has more than 4,000,000 triangles" in str(result.exception)
    assert "s.yaml:1:11" in str(result.exception)
    with path.open("r+b") as stream:
        stream.truncate(1_000 * 2**20)  # what a scan of as many triangles takes with all its digits
    assert declared(str(path)).format == "obj"


def test_a_file_that_is_written_anew_is_read_anew(tmp_path):
    path = tmp_path / "one.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    before = load(str(path), SMOOTH)
    assert load(str(path), SMOOTH) is before
    word = Mesh(file=str(path))
    assert word.extent(IDENTITY, FakeMoment())[1][0] == 1
    path.write_text("v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n")
    os.utime(path, ns=(0, path.stat().st_mtime_ns + 10**6))
    assert load(str(path), SMOOTH).vertices.max() == 2
    assert word.extent(IDENTITY, FakeMoment())[1][0] == 1  # a run has the same mesh from its first frame to its last
    assert Mesh(file=str(path)).extent(IDENTITY, FakeMoment())[1][0] == 2


# --- what an OBJ may say ---


def triangles_of(tmp_path, text):
    """Corners (m, 3, 3) of the triangles of an OBJ."""
    path = tmp_path / "some.obj"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    raw = read_obj(path)
    return raw.vertices[raw.triangles]


SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
WAYS = {
    "corners with textures": "f 1/1 2/2 3/3 4/4",
    "with normals": "f 1//1 2//1 3//1 4//1",
    "with both": "f 1/1/1 2/2/1 3/3/1 4/4/1",
    "counted back": "f -4 -3 -2 -1",
    "a line joined by a backslash": "f 1 2 \\\n  3 4",
    "the same with returns": "f 1 2\\\r\n 3 4\r\n",
    "tabs and a comment": "f\t1 2\t3 4 # all of it",
    "two triangles": "f 1 2 3\nf 1 3 4",
    "of groups": "# f 1 1 1\no a\ng b c\nusemtl d\\\ns off\nfo 1 2 3\nf +1 2 3 4\nl 1 2\n",
}


@pytest.mark.parametrize("way", WAYS)
def test_a_square_is_written_in_many_ways(tmp_path, way):
    corners = triangles_of(tmp_path, SQUARE + WAYS[way])
    np.testing.assert_array_equal(corners[:, :, :2], [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]])
    again = triangles_of(tmp_path, "\ufeff" + (SQUARE + WAYS[way]).replace("\r\n", "\n").replace("\n", "\r\n"))
    np.testing.assert_array_equal(again, corners)


def test_a_face_may_name_vertices_that_follow_and_lines_may_end_in_a_return(tmp_path):
    corners = triangles_of(tmp_path, "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0 1.0\n")
    np.testing.assert_array_equal(triangles_of(tmp_path, b"f 1 2 3\rv 0 0 0\rv 1 0 0\rv 1 1 0\r"), corners)


NUMBER = st.one_of(
    st.floats(-1e99, 1e99).map(repr),
    st.from_regex(r"[-+]?[0-9]{1,25}\.[0-9]{0,25}(e[-+]?[0-9]{1,2})?", fullmatch=True),
    st.from_regex(r"[-+]?\.[0-9]{1,20}(E[-+]?[0-9]{1,3})?", fullmatch=True),
)


@settings(max_examples=10)
@given(st.lists(st.tuples(NUMBER, NUMBER, NUMBER), min_size=3, max_size=20))
def test_numbers_are_those_that_python_reads(tmp_path_factory, rows):
    path = tmp_path_factory.mktemp("numbers") / "some.obj"
    path.write_text("".join(f"v {' '.join(row)}\n" for row in rows) + "f 1 2 3\n")
    np.testing.assert_array_equal(read_obj(path).vertices, np.array(rows, dtype=float))


def test_blocks_are_joined_where_lines_are(tmp_path):
    filler = b"#" * 61 + b"\\\n"  # comments that end in a backslash join nothing
    text = b"v 0 0 0\nv 1 0 0\n" + filler * (BLOCK // 63) + b"v 0 1 \\\n 0\nf 1 2 3\n" + filler * (BLOCK // 63)
    for shift in (0, 3, 7, 12, 60):
        corners = triangles_of(tmp_path, b"\n" * shift + text + b"#\n" + b"f 1 2 3\n")
        np.testing.assert_array_equal(corners, 2 * [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])


@settings(max_examples=40)
@given(st.integers(4, 60), st.integers(0, 5), st.integers(0, 2**32 - 1))
def test_a_polygon_is_filled_where_it_is_concave(tmp_path_factory, count, axis, seed):
    chance = np.random.default_rng(seed)
    turn = 2 * np.pi * np.arange(count) / count
    radius = chance.uniform(0.2, 1, count)
    flat = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(count)])
    places = np.roll(flat, axis, axis=1) if axis < 3 else np.roll(flat, axis, axis=1)[:, ::-1]
    path = tmp_path_factory.mktemp("polygon") / "some.obj"
    path.write_text("".join("v {!r} {!r} {!r}\n".format(*row) for row in places.tolist()) + "f " + " ".join(
        str(k + 1) for k in range(count)
    ))  # fmt: skip
    raw = read_obj(path)
    a, b, c = raw.vertices[raw.triangles].transpose(1, 0, 2)
    areas = np.cross(b - a, c - a)
    expected = np.cross(places, np.roll(places, -1, axis=0)).sum(axis=0)
    assert (areas @ expected >= -1e-12).all()  # none is folded over
    np.testing.assert_allclose(areas.sum(axis=0), expected, atol=1e-12)


def test_jagged_polygons_that_would_take_minutes_are_refused(tmp_path):
    places = np.random.default_rng(1).random((15_000, 2))
    path = tmp_path / "jagged.obj"
    rows = "".join(f"v {x:.6f} {y:.6f} 0\n" for x, y in places)
    path.write_text(rows + "f " + " ".join(str(k + 1) for k in range(len(places))))
    with pytest.raises(LimitRefused, match="polygons of too many corners"):
        load(str(path), SMOOTH)


# --- shading ---


def corner_normals(vertices, triangles, crease=SMOOTH):
    """(m, 3, 3) normals of the corners of triangles."""
    _, index, normals, _ = creased(RawMesh(np.array(vertices, dtype=float), np.array(triangles), None), crease)
    return normals[index]


def test_normals_of_a_cylinder_do_not_lean_to_the_diagonals_of_its_sides():
    mesh = trimesh.creation.cylinder(1, 2, sections=24)
    triangles = np.asarray(mesh.faces)
    found = corner_normals(mesh.vertices, triangles)
    side = np.abs(mesh.face_normals[:, 2]) < 0.5
    exact = mesh.vertices[triangles[side]] * [1, 1, 0]
    np.testing.assert_allclose(found[side], exact, atol=1e-7)
    np.testing.assert_allclose(found[~side], np.repeat(mesh.face_normals[~side][:, None], 3, axis=1), atol=1e-12)


def test_normals_of_a_ball_are_those_of_the_sphere():
    mesh = trimesh.creation.icosphere(3)
    assert np.abs(corner_normals(mesh.vertices, mesh.faces) - mesh.vertices[mesh.faces]).max() < 0.006


FLAPS = [[0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, -1, 0.1], [0.5, 1, 2], [0.5, -1, 2]]


def test_two_sheets_that_touch_at_a_vertex_are_shaded_apart():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0.2], [0, -1, 0.2]]
    found = corner_normals(vertices, [[0, 1, 2], [0, 3, 4]])
    assert (found[0] == [0, 0, 1]).all()
    assert np.ptp(found[1], axis=0).max() < 1e-12
    assert found[1, 0, 2] < 0.99


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 1, 0, 2], [2, 0, 3, 1]])
def test_of_many_faces_at_an_edge_those_are_one_surface_that_turn_little(order):
    up, down, steep, back = [0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]
    faces = [up, down, steep, back]
    found = dict(zip(order, corner_normals(FLAPS, [faces[k] for k in order]), strict=True))
    np.testing.assert_allclose(found[0][0], found[1][1], atol=1e-12)  # nearly flat: one normal at their edge
    for k in (2, 3):
        assert np.ptp(found[k], axis=0).max() < 1e-12  # faces that stand up from it have their own
    every = corner_normals(FLAPS, faces, crease=np.pi)
    assert np.ptp(np.array([every[0][0], every[1][1], every[2][0], every[3][1]]), axis=0).max() < 1e-12


def test_a_surface_that_is_there_twice_is_shaded_as_if_once():
    mesh = trimesh.creation.icosphere(1)
    twice = np.concatenate([mesh.faces, mesh.faces[:, [1, 2, 0]], mesh.faces[:, ::-1]])
    once = corner_normals(mesh.vertices, mesh.faces)
    found = corner_normals(mesh.vertices, twice).reshape(3, -1, 3, 3)
    np.testing.assert_allclose(found[0], once, atol=1e-12)
    np.testing.assert_allclose(found[1], once[:, [1, 2, 0]], atol=1e-12)
    np.testing.assert_allclose(found[2], -once[:, ::-1], atol=1e-12)


@pytest.mark.parametrize("size", [1e-200, 1e-30, 1.0, 1e90])
def test_shading_is_the_same_at_any_size(size):
    mesh = trimesh.creation.icosphere(1)
    expected = corner_normals(mesh.vertices, mesh.faces)
    np.testing.assert_allclose(corner_normals(size * mesh.vertices, mesh.faces), expected, atol=1e-9)


# --- other formats ---


def ball():
    """A sphere whose vertices have colors."""
    mesh = trimesh.creation.icosphere(1)
    mesh.visual.vertex_colors = np.column_stack([np.abs(255 * mesh.vertices), np.full(len(mesh.vertices), 255)]).astype(
        np.uint8
    )
    return mesh


FORMS = {
    "ball.ply": lambda mesh: mesh.export(file_type="ply"),
    "text.ply": lambda mesh: mesh.export(file_type="ply", encoding="ascii"),
    "ball.STL": lambda mesh: mesh.export(file_type="stl"),
    "text.stl": lambda mesh: mesh.export(file_type="stl_ascii").encode(),
    "ball.off": lambda mesh: mesh.export(file_type="off").encode(),
    "ball.glb": lambda mesh: mesh.export(file_type="glb"),
    "ball.gltf": lambda mesh: embedded(mesh.scene()),
    "ball.obj": lambda mesh: mesh.export(file_type="obj").encode(),
}


@pytest.mark.parametrize("name", FORMS)
def test_a_ball_is_read_from_every_format(tmp_path, name):
    mesh = ball()
    (tmp_path / name).write_bytes(FORMS[name](mesh))
    (drawn,) = Mesh(file=str(tmp_path / name)).lower("ball", IDENTITY, FakeMoment())
    assert len(drawn.triangles) == len(mesh.faces)
    assert len(drawn.vertices) == len(mesh.vertices)  # the corners of an STL are merged
    np.testing.assert_allclose(drawn.vertices[drawn.triangles], mesh.vertices[mesh.faces], atol=1e-6)
    assert (np.einsum("ij,ij->i", drawn.vertices, drawn.normals) > 0.99).all()
    if name.lower().endswith(("stl", "off")):
        assert drawn.colors is None
        return
    shown = mesh.visual.vertex_colors[:, :3] / 255
    light = shown if "gl" in name else np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(drawn.colors[drawn.triangles], light[mesh.faces], atol=1e-6)


def test_colors_of_the_script_go_before_those_of_the_file(tmp_path):
    from moment import const

    (tmp_path / "ball.ply").write_bytes(FORMS["ball.ply"](ball()))
    word = Mesh(file=str(tmp_path / "ball.ply"), color=const([1.0, 0.0, 0.0]))
    assert next(iter(word.lower("ball", IDENTITY, FakeMoment()))).colors is None


def test_a_vertex_of_two_colors_is_shaded_as_one(tmp_path):
    text = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nf 1 2 3\n"
    text += "v 0 0 0 0 0 1\nv 1 1 0 0 0 1\nv 0 1 .2 0 0 1\nf 4 5 6\n"
    (tmp_path / "two.obj").write_text(text)
    found = load(str(tmp_path / "two.obj"), SMOOTH)
    assert len(found.vertices) == 6
    first, second = found.triangles
    np.testing.assert_array_equal(found.colors[first], [[1, 0, 0]] * 3)
    np.testing.assert_array_equal(found.colors[second], [[0, 0, 1]] * 3)
    np.testing.assert_array_equal(found.normals[first[[0, 2]]], found.normals[second[[0, 1]]])


@pytest.mark.parametrize("order", ["<", ">"])
def test_both_orders_of_bytes_of_a_ply_are_read(tmp_path, order):
    name = {"<": "little", ">": "big"}[order]
    head = f"ply\nformat binary_{name}_endian 1.0\ncomment by hand\nelement vertex 3\nproperty double x\n"
    head += "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
    rows = b"".join(struct.pack(f"{order}dff", *row) for row in ([0, 0, 0], [2, 0, 0], [0, 3, 0]))
    (tmp_path / "one.ply").write_bytes(head.encode() + rows + struct.pack(f"{order}Biii", 3, 0, 1, 2))
    np.testing.assert_array_equal(load(str(tmp_path / "one.ply"), SMOOTH).vertices.max(axis=0), [2, 3, 0])


def test_the_nodes_of_a_glb_stand_where_they_are_placed(tmp_path):
    scene = trimesh.Scene()
    away = trimesh.transformations.translation_matrix([5, 0, 0])
    scene.add_geometry(trimesh.creation.icosphere(1), node_name="a", transform=away)
    mirror = np.diag([-2.0, 4.0, 6.0, 1.0])
    scene.add_geometry(trimesh.creation.box(), node_name="b", parent_node_name="a", transform=mirror)
    (tmp_path / "tree.glb").write_bytes(scene.export(file_type="glb"))
    found = load(str(tmp_path / "tree.glb"), SMOOTH)
    np.testing.assert_allclose([found.vertices.min(axis=0), found.vertices.max(axis=0)], [[4, -2, -3], [6, 2, 3]])
    whole = trimesh.Trimesh(found.vertices, found.triangles)
    parts = sorted(whole.split(), key=lambda part: part.volume)
    assert [part.volume > 0 for part in parts] == [True, True]  # one that is mirrored faces outwards, too
    assert parts[1].volume == pytest.approx(48)


# --- what is refused, and when ---

TRIANGLE = np.array([0, 0, 0, 1, 0, 0, 0, 1, 0], "<f4").tobytes()
DESCRIPTION = {
    "asset": {"version": "2.0"},
    "buffers": [{"byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}],
    "scenes": [{"nodes": [0]}],
}


def glb(length=None, **changes):
    """A GLB of one triangle, with a description that is changed."""
    text = json.dumps(DESCRIPTION | changes).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", 36, 0x004E4942) + TRIANGLE
    return struct.pack("<III", 0x46546C67, 2, length or 12 + len(chunks)) + chunks


def gltf(uri):
    """A glTF of one triangle whose numbers are elsewhere."""
    return json.dumps(DESCRIPTION | {"buffers": [{"byteLength": 36, "uri": uri}]}).encode()


def ply(rows=b"", form="ascii", vertices="3", faces="1", more=""):
    """A PLY of triangles."""
    head = f"ply\nformat {form} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n"
    return f"{head}element face {faces}\nproperty list uchar int vertex_indices\n{more}end_header\n".encode() + rows


LITTLE = "binary_little_endian"
ALL = {"children": [1]}
ZEROS = {"componentType": 5126, "count": 10**11, "type": "VEC3"}
REFUSED = {
    "no mesh": ("pot.xyz", b"1 2 3", "the name of one ends in .obj, .ply"),
    "bytes in an OBJ": ("a.obj", b"glTF\0\0\0", "it is not text"),
    "a PLY of a million millions": ("a.ply", ply(b"", LITTLE, vertices="1" + 12 * "0"), "rows of 12,000,000,000,001"),
    "one that is text": ("a.ply", ply(b"0 0 0\n", vertices="1000"), "rows of 6,002 bytes or more, and 6 follow"),
    "a negative number of rows": ("a.ply", ply(vertices="-3"), "declares '-3' rows of 'vertex'"),
    "a PLY without an end": ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "no header from 'ply'"),
    "a PLY of lines": ("a.ply", ply(more="element edge 1\nproperty int vertex1\n"), "edges beside its faces"),
    "an unknown type": ("a.ply", ply(more="property quad q\n"), "has the line 'property quad q'"),
    "an STL of other bytes": ("a.stl", b"\0" * 80 + b"\xff" * 4 + b"\0" * 50, "declares 4,294,967,295 triangles"),
    "an OFF that declares more": ("a.off", b"OFF\n1000000 1000000 0\n0 0 0\n", "declares 1,000,000 vertices"),
    "an OFF of another kind": ("a.off", b"4OFF\n1 1 1\n", "does not begin with OFF"),
    "a GLB that lies": ("a.glb", glb(length=10**9), "declares 1,000,000,000 bytes"),
    "an OBJ named GLB": ("a.glb", b"v 0 0 0\n", "does not begin as a GLB"),
    "a file of the system": ("a.gltf", gltf("../../../etc/passwd"), "reads another file, '../../../etc/passwd'"),
    "a file of the net": ("a.gltf", gltf("http://localhost/a"), "reads another file, 'http://localhost/a'"),
    "a file that looks embedded": ("a.gltf", gltf("/etc/base64,AAAA"), "reads another file"),
    "a file named by a GLB": ("a.glb", glb(buffers=[{"byteLength": 36, "uri": "b.bin"}]), "reads another file"),
    "numbers of no buffer": ("a.glb", glb(accessors=[ZEROS]), "sparse or compressed"),
    "numbers beyond it": ("a.glb", glb(accessors=[{**ZEROS, "bufferView": 0}]), "that its buffer has not"),
    "a description of anything": ("a.glb", glb(meshes=3, nodes={"a": None}), "its description is no glTF"),
    "nodes in a circle": ("a.glb", glb(nodes=[{"mesh": 0, "children": [0]}]), "nodes are no trees"),
    "nodes without an end": ("a.glb", glb(nodes=[{"children": [k + 1]} for k in range(999)]), "nodes are no trees"),
    "an extension": ("a.glb", glb(extensionsRequired=["KHR_draco_mesh_compression"]), "needs the extension KHR_draco"),
}  # fmt: skip
EXCEEDS = {
    "many nodes": ("a.glb", glb(nodes=[{"mesh": 0}] * 20_000), "20,000 nodes, more than 10,000"),
    "many parts": ("a.glb", glb(extras=[[]] * 600_000), "description of 1,200,"),
    "many triangles of an STL": ("a.stl", None, "5,000,000 triangles, more than the 4,000,000"),
    "a long text": ("a.off", 65 * 2**20, "as OBJ or binary it may be larger"),
    "a long file": ("a.glb", 2**30, "more than the 536,870,912 that a mesh may have"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_file_that_cannot_be_read_is_refused_by_its_first_bytes(tmp_path, case):
    name, data, text = REFUSED[case]
    (tmp_path / name).write_bytes(data)
    for refuse in (lambda path: declared(path), lambda path: load(path, SMOOTH)):
        with pytest.raises(OSError, match=re.escape(text)):
            refuse(str(tmp_path / name))


@pytest.mark.parametrize("case", EXCEEDS)
def test_a_file_that_would_take_too_much_is_refused_by_its_first_bytes(tmp_path, case):
    name, data, text = EXCEEDS[case]
    with (tmp_path / name).open("wb") as stream:
        if isinstance(data, bytes):
            stream.write(data)
        elif data is None:
            stream.write(b"\0" * 80 + struct.pack("<I", 5_000_000))
        stream.truncate(84 + 50 * 5_000_000 if data is None else len(data) if isinstance(data, bytes) else data)
    with pytest.raises(Exceeds, match=re.escape(text)):
        declared(str(tmp_path / name))
    with pytest.raises(LimitRefused, match=re.escape(text)):
        load(str(tmp_path / name), SMOOTH)


INSIDE = {
    "a number": ("a.obj", b"v 0 0 0\nv 1 0 0\n\\\n\nv 0 1e 0\n", "line 5: '1e' is no number"),
    "two numbers": ("a.obj", b"v 0 0 # 0\n", "line 1: a vertex has three numbers"),
    "a corner": ("a.obj", b"f 1 2 a/3\n", "line 1: 'a/3' is no corner"),
    "vertex 0": ("a.obj", b"v 0 0 0\nf 0 1 2\n", "line 2: vertices are counted from 1"),
    "far back": ("a.obj", b"v 0 0 0\nf 1 1 -2\n", "line 2: '-2' counts back beyond the first"),
    "two corners": ("a.obj", b"f 1 2\n", "line 1: a face has three corners"),
    "a vertex that is not there": ("a.obj", b"v 0 0 0\nf 1 1 2\n\nf 1 1 1", "line 2: a face names vertex 2, of 1"),
    "far away": ("a.obj", b"v 0 0 0\nv 1e200 0 0\nv 0 1 0\nf 1 2 3\n", "farther away than 1e+100 m"),
    "no area": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangle of any area"),
    "other rows of a PLY": ("a.ply", ply(b"0 0 0\n1 0 0\n0 1 0\n3 0 1 two\n"), "no PLY mesh that can be read"),
    "rows that are missing": ("a.ply", ply(b"0 0 0\n1 0 0.000000000000\n3 0 1 1\n"), "no PLY mesh that can be read"),
    "a vertex of a PLY": ("a.ply", ply(b"0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n"), "a vertex that is not there"),
    "parts of an STL": ("a.stl", b"solid a endsolid a\n" * 20_000, "20,000 solids"),
}


@pytest.mark.parametrize("case", INSIDE)
def test_what_is_wrong_inside_a_file_is_told(tmp_path, case):
    name, data, text = INSIDE[case]
    (tmp_path / name).write_bytes(data)
    declared(str(tmp_path / name))
    with pytest.raises(OSError, match=re.escape(text)):
        load(str(tmp_path / name), SMOOTH)


def test_check_finds_what_render_would_die_of(tmp_path):
    scene = tmp_path / "s.yaml"
    scene.write_text("objects: {pot: {mesh: {file: pot.glb}}}\noutputs: {still: {image: {size: 16 9}}}\n")
    for data, code in [(glb()[:60], 1), (b"\x93\xff\xfe", 1), (glb(), 0)]:
        Path(tmp_path / "pot.glb").write_bytes(data)
        results = [CliRunner().invoke(cli, [command, str(scene)]) for command in ("check", "render")]
        assert [bool(result.exit_code) for result in results] == [bool(code)] * 2
        if code:
            assert ":1:30" in str(results[0].exception)
            assert "pot.glb is no GLB mesh" in str(results[0].exception)
