"""What a triangle mesh encloses and how it hangs together. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints


def volume(vertices: Floats, triangles: Ints) -> float:
    """Volume [m^3] that triangles enclose, counted counterclockwise from outside: a sum of tetrahedra."""
    import numpy as np

    middle = vertices.mean(axis=0) if len(vertices) else np.zeros(3)
    a, b, c = (vertices[triangles[:, k]] - middle for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def area(vertices: Floats, triangles: Ints) -> float:
    """Sum of the triangles' areas [m^2]."""
    import numpy as np

    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def edge_counts(triangles: Ints) -> tuple[int, int, int]:
    """(edges, edges of one triangle, edges of more than two)."""
    import numpy as np

    if not len(triangles):
        return 0, 0, 0
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64), axis=1)
    keys = np.sort(ends[:, 0] * (int(triangles.max()) + 1) + ends[:, 1])
    starts = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    uses = np.diff(np.append(starts, len(keys)))
    return len(starts), int((uses == 1).sum()), int((uses > 2).sum())


def euler_characteristic(triangles: Ints) -> int:
    """Vertices - edges + triangles; 2 for a sphere, 0 for a torus, 2 less for each further handle."""
    import numpy as np

    return len(np.unique(triangles)) - edge_counts(triangles)[0] + len(triangles)


def pieces(triangles: Ints) -> int:
    """How many pieces hang together by vertices: the least number of each is handed on until it is everywhere."""
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
