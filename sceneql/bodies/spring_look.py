"""Default shapes of masses and springs in pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.frame import Mesh, Points, Segments, Surface

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Shape

TURNS, PIECES = 9, 12
PARALLEL = 0.99
"""Least mean cosine, by area, between the normals of what a plate covers and the largest triangle's."""
HOLDER = Surface(color=(0.09, 0.095, 0.105), roughness=0.4)
"""Rails, plates and beads that hold masses: dark, whatever the color of what they hold."""
RAIL, THIN = 0.25, 0.012
"""Radius of a rail over its length between two masses; over the diagonal of all, its largest, half a plate's thickness,
and the least of beads on sheets and lines."""
LEAD = 0.12
"""Share of a coil's length that is straight at each end."""


def spheres(name: str, surface: Surface, places: Floats, radius: float) -> Points:
    """Spheres of one radius [m] at masses (n, 3) [m]."""
    import numpy as np

    return Points(name, surface, places, np.full(len(places), radius))


def plates(name: str, places: Floats, held: NDArray[Any], triangles: Ints) -> Iterator[Shape]:
    """Dark plates on those triangles (k, 3) of places (n, 3) [m] whose corners are held, by a mask (n,), if parallel.

    What is held all around, or on a curved part, is left as it is: a cap would hide its form.
    """
    import numpy as np

    found = triangles[held[triangles].all(axis=1)]
    a, b, c = (places[found[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    sizes = np.linalg.norm(areas, axis=1)
    whole = float(sizes.sum())
    if whole > 0 and float(np.abs(areas @ areas[sizes.argmax()]).sum()) > PARALLEL * whole * float(sizes.max()):
        used, corners = np.unique(found, return_inverse=True)
        half = THIN * float(np.linalg.norm(np.ptp(places, axis=0)))
        yield sheet(f"{name}.pins", HOLDER, places[used], corners.reshape(-1, 3).astype(np.int32), half)


def holders(name: str, places: Floats, held: NDArray[Any], triangles: Ints | None, radius: float) -> Iterator[Shape]:
    """What holds masses of places (n, 3) [m], by a mask (n,).

    Rails along the rim of an open sheet of ``triangles``, plates on flat parts of a closed one; beads of a ``radius``
    [m], at least THIN on those of sheets, on other masses.
    """
    import numpy as np

    if not held.any():
        return
    alone = held.copy()
    if triangles is not None and len(triangles):
        thin = THIN * float(np.linalg.norm(np.ptp(places, axis=0)))
        radius = max(radius, thin)
        rim = rim_edges(triangles)
        rails = rim[held[rim].all(axis=1)]
        alone[rails] = False
        ends = places[rails]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        if len(rails):
            yield Segments(f"{name}.pins", HOLDER, ends, np.minimum(RAIL * lengths, thin))
        if not len(rim):
            alone[triangles[held[triangles].all(axis=1)]] = False
            yield from plates(name, places, held, triangles)
    if alone.any():
        yield spheres(f"{name}.pins", HOLDER, places[alone], radius)


def lines(name: str, surface: Surface, ends: Floats, radius: float) -> Segments:
    """Straight rods of a radius [m] for springs with ends (m, 2, 3) [m]."""
    import numpy as np

    return Segments(f"{name}.springs", surface, ends, np.full(len(ends), radius))


def coils(name: str, surface: Surface, ends: Floats, rest: Floats, radius: float) -> Segments:
    """Coils with a fixed number of turns for springs with ends (m, 2, 3) [m] and rest lengths (m,) [m].

    ``radius`` [m]: of the masses, by which coil and wire are scaled.
    """
    import numpy as np

    pieces = [
        coil(a, b, min(0.6 * radius, 0.2 * length) if length > 0 else 0.6 * radius)
        for (a, b), length in zip(ends, rest, strict=True)
    ]
    wires = np.concatenate(pieces) if pieces else np.zeros((0, 2, 3))
    return Segments(f"{name}.springs", surface, wires, np.full(len(wires), 0.14 * radius))


def coil(start: Floats, end: Floats, radius: float) -> Floats:
    """A helix with straight leads from ``start`` to ``end`` (3,) [m], as segments (k, 2, 3)."""
    import numpy as np

    along = end - start
    length = float(np.linalg.norm(along))
    along = along / length if length > 0 else np.array([0.0, 1.0, 0.0])
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    other = np.cross(along, across)
    s = np.linspace(0.0, 1.0, TURNS * PIECES + 1)
    angle = 2 * np.pi * TURNS * s
    # The radius grows from 0 within the first half turn and shrinks to 0 within the last.
    wide = radius * np.minimum(1.0, np.minimum(s, 1 - s) * TURNS * 2)
    height = length * (LEAD + (1 - 2 * LEAD) * s)
    helix = start + height[:, None] * along
    helix += (wide * np.cos(angle))[:, None] * across + (wide * np.sin(angle))[:, None] * other
    path = np.concatenate([[start], helix, [end]])
    return np.stack([path[:-1], path[1:]], axis=1)


def skin(name: str, surface: Surface, places: Floats, triangles: Ints, half: float) -> Mesh:
    """The smooth mesh of triangles of masses (n, 3) [m] if closed; otherwise a sheet of thickness 2 ``half`` [m]."""
    if len(rim_edges(triangles)):
        return sheet(name, surface, places, triangles, half)
    return Mesh(name, surface, places, triangles, vertex_normals(places, triangles))


def sheet(name: str, surface: Surface, places: Floats, triangles: Ints, half: float) -> Mesh:
    """An open surface of masses (n, 3) [m] as a closed slab of thickness 2 ``half`` [m], smooth on both sides."""
    import numpy as np

    normals = vertex_normals(places, triangles)
    n = len(places)
    back = triangles[:, ::-1] + n
    rim = rim_edges(triangles)
    a, b = rim[:, 0], rim[:, 1]
    walls = [np.stack([b, a, a + n], axis=1), np.stack([b, a + n, b + n], axis=1)]
    return Mesh(
        name,
        surface,
        vertices=np.concatenate([places + half * normals, places - half * normals]),
        triangles=np.concatenate([triangles, back, *walls]).astype(np.int32),
        normals=np.concatenate([normals, -normals]),
    )


def vertex_normals(places: Floats, triangles: Ints) -> Floats:
    """Unit vertex normals (n, 3): area-weighted means of the adjacent triangles' normals; 0 without any triangle."""
    import numpy as np

    a, b, c = (places[triangles[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    normals = np.stack(
        [
            sum(np.bincount(triangles[:, corner], areas[:, axis], len(places)) for corner in range(3))
            for axis in range(3)
        ],
        axis=1,
    )
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Floats = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    return unit


def rim_edges(triangles: Ints) -> NDArray[Any]:
    """Directed boundary edges (r, 2), those of only one triangle."""
    import numpy as np

    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    rim: NDArray[Any] = edges[first[count == 1]]
    return rim
