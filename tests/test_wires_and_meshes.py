"""Laws of coils and of meshes from files."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from moment import IDENTITY, FakeMoment, const
from sceneql.shapes.placement import affine, apply
from sceneql.words.objects.coil import Coil
from sceneql.words.objects.mesh import Mesh

TURN = (0.8, 0.3, -0.4, 0.33)


@settings(max_examples=30)
@given(
    st.tuples(*[st.floats(-2, 2)] * 3),
    st.tuples(*[st.floats(-2, 2)] * 3),
    st.integers(1, 12),
    st.sampled_from([0.0, 0.1, 0.3]),
)
def test_coil_runs_from_its_start_to_its_end_with_its_turns_and_radius(start, end, turns, lead):
    far = np.linalg.norm(np.subtract(end, start))
    assume(far > 0.05)
    coil = Coil(from_=const(start), to=const(end), turns=float(turns), radius=const(0.1), wire=const(0.02), lead=lead)
    path, _ = coil.path(FakeMoment())
    np.testing.assert_allclose(path[0], start, atol=1e-12)
    np.testing.assert_allclose(path[-1], end, atol=1e-12)
    along = np.subtract(end, start) / far
    out = path - start - np.outer((path - start) @ along, along)
    reach = np.linalg.norm(out, axis=1)
    assert reach.max() == pytest.approx(0.1, rel=1e-6) or turns == 1
    across = np.linalg.svd(np.eye(3) - np.outer(along, along))[0][:, :2]
    wide = reach > 1e-6
    angle = np.unwrap(np.arctan2(out[wide] @ across[:, 1], out[wide] @ across[:, 0]))
    assert abs(angle[-1] - angle[0]) == pytest.approx(2 * np.pi * turns, abs=1.0)


def test_coil_mesh_is_a_closed_wire_with_outward_normals():
    import trimesh

    coil = Coil(from_=const([0.3, 0.2, 1]), to=const([0.1, 1.5, 0]), wire=const(0.03))
    (mesh,) = coil.lower("coil", IDENTITY, FakeMoment())
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=True)
    assert solid.is_watertight
    path = coil.path(FakeMoment())[0]
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    polygon = 5 * np.sin(2 * np.pi / 10) * 0.015**2
    assert solid.volume == pytest.approx(polygon * length, rel=0.03)
    corners = mesh.vertices[mesh.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ikj->ik", faces, mesh.normals[mesh.triangles]) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0)
    low, high = coil.extent(IDENTITY, FakeMoment())
    assert (mesh.vertices >= low - 1e-12).all()
    assert (mesh.vertices <= high + 1e-12).all()


def test_coil_pressed_to_nothing_still_has_finite_normals():
    coil = Coil(from_=const([0, 1, 0]), to=const([0, 1, 0]))
    (mesh,) = coil.lower("coil", IDENTITY, FakeMoment())
    assert np.isfinite(mesh.vertices).all()
    assert np.isfinite(mesh.normals).all()


CUBE = """mtllib nowhere.mtl
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
f 1 5 8 4
f 2 3 7 6
"""


def test_mesh_is_placed_and_its_edges_are_sharp_where_they_turn(tmp_path):
    path = tmp_path / "cube.obj"
    path.write_text(CUBE)
    place = affine((1, 2, 3), (1, 0, 0, 0), 1.0)
    scale = (1.0, 2.0, 0.5)
    sharp = Mesh(file=str(path), scale=const(scale), rotation=const(TURN))
    (mesh,) = sharp.lower("cube", place, FakeMoment())
    expected = apply(affine((1, 2, 3), TURN, scale), [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    found = np.unique(np.round(mesh.vertices, 9), axis=0)
    np.testing.assert_allclose(found, np.unique(np.round(expected, 9), axis=0))
    corners = mesh.vertices[mesh.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.normals[mesh.triangles], np.repeat(faces[:, None], 3, axis=1), atol=1e-9)
    (smooth,) = Mesh(file=str(path), crease=float(np.radians(100))).lower("cube", IDENTITY, FakeMoment())
    assert len(smooth.vertices) == 8
    outward = smooth.vertices / np.sqrt(3)
    assert (np.sum(outward * smooth.normals, axis=1) > 0.9).all()
    low, high = sharp.extent(place, FakeMoment())
    np.testing.assert_allclose([low, high], [expected.min(axis=0), expected.max(axis=0)])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "vertex|OBJ mesh"),
        ("# nothing\n", "mesh|triangles"),
        ("v 0 0\n\x00\xff", "mesh|triangles"),
    ],
)
def test_a_broken_mesh_file_is_refused(tmp_path, text, message):
    path = tmp_path / "broken.obj"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        list(Mesh(file=str(path)).lower("mesh", IDENTITY, FakeMoment()))


def test_a_binary_file_is_no_mesh(tmp_path):
    path = tmp_path / "ball.obj"
    path.write_bytes(b"ply\nformat binary_little_endian 1.0\n\x93\xff\xfe\x80")
    with pytest.raises(ValueError, match="no OBJ mesh"):
        list(Mesh(file=str(path)).lower("mesh", IDENTITY, FakeMoment()))


def test_a_huge_mesh_file_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "huge.obj"
    with path.open("wb") as stream:
        stream.truncate(2**30 + 1)  # the file has a hole: no byte of it is stored
    with pytest.raises(ValueError, match="bytes"):
        list(Mesh(file=str(path)).lower("mesh", IDENTITY, FakeMoment()))
