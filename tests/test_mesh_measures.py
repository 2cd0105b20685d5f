"""Volumes and areas of meshes converge as theory tells."""

import math

import numpy as np
import pytest

from meshes import (
    BALL,
    CAPSULE,
    STEINER,
    TORUS,
    TURNED,
    cut,
    cut_finer,
    cut_sharp,
)
from sceneql.mesh.measures import area, curved_volume, edge_counts, volume

VOLUMES = [
    (BALL, 1.1, 4 * math.pi / 3),
    (TORUS, 1.5, 2 * math.pi**2 * 0.16),
    (CAPSULE, 1.0, math.pi * 0.4**2 * (1.0 + 4 * 0.4 / 3)),
    (STEINER, 0.6, 1 / 6),
]


@pytest.mark.parametrize(
    ("text", "half", "exact", "most"),
    [(*shape, most) for shape, most in zip(VOLUMES, (4e-5, 1.5e-4, 1.1e-4, 4.2e-4), strict=True)],
    ids=["ball", "torus", "capsule", "steiner"],
)
def test_volumes_converge_with_order_two_and_extrapolate(text, half, exact, most):
    errors = []
    for cells in (128, 256):
        found = cut(text, half, cells)
        errors.append(1.0 - volume(found.vertices, found.triangles) / exact)
    assert errors[-1] < most
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1 if text == STEINER else 0.02)
    # Of Steiner's solid a quarter of the error is that of its creases, which do not fall on the cells in any order.
    assert abs(4 * errors[1] - errors[0]) / 3 < (3e-6 if text == STEINER else 1e-6)


@pytest.mark.parametrize(("text", "half", "exact"), VOLUMES[:3], ids=["ball", "torus", "capsule"])
def test_curved_volumes_converge_with_order_four(text, half, exact):
    errors = []
    for cells in (64, 128):
        found = cut(text, half, cells)
        errors.append(1.0 - curved_volume(found.vertices, found.triangles, found.normals) / exact)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)
    assert abs(errors[1]) < 2e-7


@pytest.mark.long
def test_the_curved_volume_of_steiners_solid_extrapolates():
    errors = []
    for cells in (96, 192):
        found, _ = cut_finer(STEINER, 0.6, cells)
        errors.append(1.0 - curved_volume(found.vertices, found.triangles, found.normals) * 6.0)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert abs(4 * errors[1] - errors[0]) / 3 < 1e-6


def test_flat_faces_and_what_has_no_normals_are_not_curved():
    for made in (cut(TURNED, 1.3, 20), cut_sharp(TURNED, 1.3, 20)):
        flat = volume(made.vertices, made.triangles)
        assert curved_volume(made.vertices, made.triangles, 0.0 * made.normals) == flat
    assert curved_volume(made.vertices, made.triangles, made.normals) == pytest.approx(1.4**3, rel=1e-9)


def test_area_of_a_torus():
    found = cut(TORUS, 1.5, 128)
    assert area(found.vertices, found.triangles) == pytest.approx(15.7913670417, rel=1e-3)


def test_edges_are_counted_at_a_vertex_of_many_too():
    """At the apex of a fan its edges stand in the order of the triangles, here any."""
    rim = np.random.default_rng(5).permutation(np.arange(1, 2001))
    fan = np.stack([np.zeros(1999, dtype=int), rim[:-1], rim[1:]], axis=1)
    assert edge_counts(np.concatenate([fan, fan[:1]])) == (2000 + 1999, 2 + 1998 - 1, 1 + 0)


def test_meshes_that_are_read_only_are_measured():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    sides = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
    corners.flags.writeable = sides.flags.writeable = False
    assert volume(corners, sides) == pytest.approx(1 / 6)
