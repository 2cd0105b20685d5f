"""Volume, area, edges and topology of triangle meshes. Imports numpy, and numba where triangles are gone through."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

BEND = 0.5
"""Cosine of 60 degrees, the largest angle between a triangle's normal and its vertex normals on a smooth surface."""


def volume(vertices: Floats, triangles: Ints) -> float:
    """Volume [m^3] of a closed mesh, triangles counterclockwise seen from outside: the sum of signed tetrahedra."""
    return volume_and_area(vertices, triangles)[0]


def volume_and_area(vertices: Floats, triangles: Ints) -> tuple[float, float]:
    """Volume [m^3] of a closed mesh as ``volume``, and the sum of its triangles' areas [m^2]."""
    import numpy as np

    if not len(triangles):
        return 0.0, 0.0
    from sceneql.mesh.cubes.triangle_kernels import sum_up

    found = np.zeros(2)
    places = np.require(vertices, np.float64, ["C", "W"])  # kernels take no array that is read-only
    sum_up(places, np.require(triangles, np.int32, ["C", "W"]), found)
    return float(found[0] / 6.0), float(0.5 * found[1])


def curved_volume(vertices: Floats, triangles: Ints, normals: Floats) -> float:
    """Volume [m^3] inside a surface, from a mesh with vertices and unit normals (v, 3) on it; of fourth order.

    Over each triangle the surface is a quadratic whose slope changes along each edge by as much as the normals at its
    ends say. A triangle with a vertex normal beyond BEND, as at an edge of the solid, counts as flat.
    """
    import numpy as np

    corners, slopes = vertices[triangles], normals[triangles]
    a, b, c = corners.transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    doubled = np.linalg.norm(across, axis=1)
    face = np.divide(across, doubled[:, None], out=np.zeros_like(across), where=doubled[:, None] > 0.0)
    facing = np.einsum("tkj,tj->tk", slopes, face)
    smooth = (facing > BEND).all(axis=1)
    corners, slopes, facing = corners[smooth], slopes[smooth], facing[smooth]
    # At parameter t of an edge the surface lies q t (1 - t) above it; above the triangle, q times the product of two
    # barycentric coordinates, whose mean is 1/12.
    rise = np.zeros(len(corners))
    for k in range(3):
        following = (k + 1) % 3
        edge = corners[:, following] - corners[:, k]
        first, last = (np.einsum("tj,tj->t", slopes[:, end], edge) / facing[:, end] for end in (k, following))
        rise += 0.5 * (last - first)
    return volume(vertices, triangles) + float((0.5 * doubled[smooth] * rise).sum() / 12.0)


def area(vertices: Floats, triangles: Ints) -> float:
    """Sum of the triangles' areas [m^2]."""
    return volume_and_area(vertices, triangles)[1]


def edge_counts(triangles: Ints) -> tuple[int, int, int]:
    """Numbers of edges: (all, those of only one triangle, those of more than two)."""
    edges, single, several, _ = _counted(triangles)
    return edges, single, several


def euler_and_open_edges(triangles: Ints) -> tuple[int, int]:
    """(``euler_characteristic``, number of edges of only one triangle)."""
    edges, single, _, vertices = _counted(triangles)
    return vertices - edges + len(triangles), single


def euler_characteristic(triangles: Ints) -> int:
    """Vertices - edges + triangles; 2 for a sphere, 0 for a torus, 2 less for each further handle."""
    return euler_and_open_edges(triangles)[0]


def _counted(triangles: Ints) -> tuple[int, int, int, int]:
    """Numbers of edges as ``edge_counts`` has them, and of vertices that triangles have."""
    import numpy as np

    from sceneql.mesh.cubes.triangle_kernels import count_edges

    found, most = np.zeros(4, dtype=np.int64), int(triangles.max(initial=-1)) + 1
    count_edges(
        np.ascontiguousarray(triangles, dtype=np.int32), np.zeros(most + 1, dtype=np.int64),
        np.empty(3 * len(triangles), dtype=np.int32), np.zeros(most, dtype=np.uint8), found,
    )  # fmt: skip
    edges, single, several, vertices = found.tolist()
    return edges, single, several, vertices


def euler_by_piece(triangles: Ints) -> list[int]:
    """Euler characteristics of the connected components of a closed 2-manifold, ascending: they tell its topology."""
    import numpy as np
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(triangles):
        return []
    used, corners = np.unique(triangles, return_inverse=True)
    a, b, c = corners.reshape(-1, 3).T
    ends = np.concatenate([a, b]), np.concatenate([b, c])
    count, piece = connected_components(
        coo_array((np.ones(len(ends[0])), ends), shape=(len(used),) * 2), directed=False
    )
    # A triangle has three edges, an edge two triangles: V - E + F = V - F / 2.
    found: list[int] = sorted((np.bincount(piece) - np.bincount(piece[a], minlength=count) // 2).tolist())
    return found


def pieces(triangles: Ints) -> int:
    """Number of connected components, by propagating the least vertex number of each until nothing changes."""
    import numpy as np

    if not len(triangles):
        return 0
    _, corners = np.unique(triangles, return_inverse=True)
    corners = corners.reshape(-1, 3)
    label = np.arange(int(corners.max()) + 1)
    while True:
        least = label[corners].min(axis=1)
        new = label.copy()
        for k in range(3):
            np.minimum.at(new, corners[:, k], least)
        new = new[new]
        if (new == label).all():
            return len(np.unique(label))
        label = new
