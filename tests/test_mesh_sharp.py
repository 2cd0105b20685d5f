"""Laws of meshes with sharp edges: features kept, closed, on the surface."""

import math

import numpy as np
import pytest

from meshes import (
    TURN,
    TURNED,
    assert_closed_manifold,
    cut_sharp,
)
from sceneql.mesh.measures import euler_characteristic, volume


@pytest.mark.parametrize("cells", [20, 33, 50, 51, 56])
def test_sharp_cubes_have_their_corners_edges_and_faces(cells):
    found = cut_sharp(TURNED, 1.3, cells)
    assert_closed_manifold(found)
    assert euler_characteristic(found.triangles) == 2
    own = found.vertices @ TURN.T
    corners = np.array([[x, y, z] for x in (-0.7, 0.7) for y in (-0.7, 0.7) for z in (-0.7, 0.7)])
    assert np.linalg.norm(own[:, None] - corners, axis=2).min(axis=0).max() < 1e-6
    on = (np.abs(np.abs(own) - 0.7) < 1e-6).sum(axis=1)
    assert (on >= 1).all()
    assert ((on >= 2) == (found.normals == 0.0).all(axis=1)).all()
    sides = own[found.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)]
    for axis in range(3):
        for signs in ([-1, -1], [-1, 1], [1, -1], [1, 1]):
            across = sides[:, :, [(axis + 1) % 3, (axis + 2) % 3]]
            along = np.sort(sides[(np.abs(across - 0.7 * np.array(signs)) < 1e-6).all(axis=(1, 2)), :, axis], axis=1)
            reach = -0.7 + 1e-6
            for low, high in along[np.argsort(along[:, 0])]:
                reach = max(reach, high) if low <= reach else reach
            assert reach > 0.7 - 2e-6
    assert volume(found.vertices, found.triangles) == pytest.approx(1.4**3, abs=1e-9)


def test_the_rim_of_a_sharp_cylinder_is_on_the_rim():
    for cells in (16, 32):
        found = cut_sharp("max(sqrt(x^2 + y^2) - 0.6, abs(z) - 0.5)", 1.0, cells)
        rim = found.vertices[(found.normals == 0.0).all(axis=1)]
        assert len(rim) > 2 * cells
        assert np.abs(np.linalg.norm(rim[:, :2], axis=1) - 0.6).max() < 1e-6
        assert np.abs(np.abs(rim[:, 2]) - 0.5).max() < 1e-6
        assert volume(found.vertices, found.triangles) == pytest.approx(math.pi * 0.36, rel=1.5 / cells**2)


def test_sheets_that_meet_in_one_face_are_parted():
    # Waves as long as a cell: many cubes join both curves of a face, so that four polygons would share one side.
    rng = np.random.default_rng(1)
    for _ in range(4):
        waves = [f"{a:.3f}*sin({b:.3f}*x + {c:.3f}*y + {d:.3f}*z)" for a, b, c, d in rng.uniform(-22.0, 22.0, (6, 4))]
        assert_closed_manifold(cut_sharp(" + ".join(waves), 1.0, 10))
