"""Whether points lie inside a mesh, closed or with holes, and where segments leave it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sceneql.bodies.filling import winding_kernels
from sceneql.bodies.filling.clusters import Clusters, tiled
from sceneql.bodies.filling.winding_cells import Cells
from sceneql.shapes.of_contents import OfContents

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats

MANY = 20_000
"""Places that are asked for at once from which on it is sooner to know the cells around them."""
ROOM = 1e-8
"""What is added around boxes, in parts of the mesh's size: more than the tolerance at triangles' edges."""


class Winding:
    """Triangles, and how often they wind around points: 1 inside a closed mesh, 0 outside, near holes between.

    Where they wind by more than half is inside: the surface that closes a flat hole is the plane of it.
    """

    def __init__(self, corners: Floats) -> None:
        """``corners`` (m, 3, 3), counterclockwise from one side: if that is the inside they are turned.

        Raises ValueError where there are none.
        """
        if _volume(corners) < 0.0:
            corners = corners[:, ::-1]
        self._clusters = Clusters.of(corners)
        boxes = self._clusters.boxes
        room = ROOM * float((boxes[0, 3:] - boxes[0, :3]).max())
        self._boxes = boxes + room * np.repeat([-1.0, 1.0], 3)
        self._held: OfContents[NDArray[bool_]] = OfContents(1)
        self._left: OfContents[Floats] = OfContents(1)

    def holds(self, places: Floats) -> NDArray[bool_]:
        """(n,) whether places (n, 3) lie inside."""
        places = np.ascontiguousarray(places)

        def ask() -> NDArray[bool_]:
            held = np.empty(len(places), dtype=np.bool_)
            if len(places) >= MANY:
                around = *self._clusters.arrays, *self._cells.arrays
                tiled(len(places), lambda a, b: winding_kernels.hold_in_cells(*around, places, held, a, b))
            else:
                tiled(len(places), lambda a, b: winding_kernels.hold(*self._clusters.arrays, places, held, a, b))
            return held

        return self._held.get((places,), ask)

    @cached_property
    def _cells(self) -> Cells:
        return Cells.around(self._clusters)

    def exits(self, inner: Floats, outer: Floats) -> Floats:
        """(n,) fractions (0..1) at which segments from places inside to places outside, each (n, 3), leave."""
        inner, outer = np.ascontiguousarray(inner), np.ascontiguousarray(outer)

        def ask() -> Floats:
            shares = np.empty(len(inner))
            parts = *self._clusters.arrays, self._boxes, inner, outer, shares
            tiled(len(inner), lambda first, last: winding_kernels.leave(*parts, first, last))
            return shares

        return self._left.get((inner, outer), ask)


def winding(corners: Floats) -> Winding:
    """The winding numbers of triangles (m, 3, 3). Raises ValueError where there are none."""
    return _KNOWN.get((corners,), lambda: Winding(corners))


_KNOWN: OfContents[Winding] = OfContents()


def _volume(corners: Floats) -> float:
    """Six times what triangles (m, 3, 3) enclose, from the middle of their corners."""
    a, b, c = (corners[:, k] - corners.mean(axis=(0, 1)) for k in range(3))
    return float(np.einsum("ij,ij", a, np.cross(b, c)))
