"""Inside tests for meshes, closed or with holes, by winding numbers; crossings of segments with the surface."""

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
"""Number of places in a call from which on precomputed cells (winding_cells) are faster."""
ROOM = 1e-8
"""Padding of boxes, relative to the mesh's size: more than the tolerance at triangles' edges."""


class Winding:
    """Generalized winding numbers of triangles around points: 1 inside a closed mesh, 0 outside, in between near holes.

    A point counts as inside where the number exceeds 1/2; a flat hole is thereby closed by its plane.
    """

    def __init__(self, corners: Floats) -> None:
        """``corners`` (m, 3, 3) [m], all counterclockwise seen from one side; reversed if this is the inside.

        Raises ValueError for no triangles.
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
        """Whether each (n,) of places (n, 3) [m] lies inside."""
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
        """Parameters (n,) in 0..1 at which segments from places inside to places outside, each (n, 3), leave."""
        inner, outer = np.ascontiguousarray(inner), np.ascontiguousarray(outer)

        def ask() -> Floats:
            shares = np.empty(len(inner))
            parts = *self._clusters.arrays, self._boxes, inner, outer, shares
            tiled(len(inner), lambda first, last: winding_kernels.leave(*parts, first, last))
            return shares

        return self._left.get((inner, outer), ask)


def winding(corners: Floats) -> Winding:
    """The Winding of triangles (m, 3, 3), cached by their contents. Raises ValueError for no triangles."""
    return _KNOWN.get((corners,), lambda: Winding(corners))


_KNOWN: OfContents[Winding] = OfContents()


def _volume(corners: Floats) -> float:
    """Six times the volume [m^3] enclosed by triangles (m, 3, 3), summed relative to the mean of their corners."""
    a, b, c = (corners[:, k] - corners.mean(axis=(0, 1)) for k in range(3))
    return float(np.einsum("ij,ij", a, np.cross(b, c)))
