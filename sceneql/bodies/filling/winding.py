"""Whether points lie inside a mesh, closed or with holes, and where segments leave it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from sceneql.bodies.filling import winding_kernels
from sceneql.compiled.kernels import over_tiles
from sceneql.mesh.box_tree import box_tree
from sceneql.shapes.of_contents import OfContents

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats

LEAF = 8
TILE = 512
"""Points, segments or clusters of one task of a thread."""
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
        tree = box_tree(corners, LEAF)
        ordered = corners[tree.order]
        if _volume(ordered) < 0.0:
            ordered = ordered[:, ::-1]
        self._corners = np.ascontiguousarray(ordered.reshape(-1, 9))
        self._links = tree.links
        room = ROOM * float((tree.boxes[0, 3:] - tree.boxes[0, :3]).max())
        self._boxes = tree.boxes + room * np.repeat([-1.0, 1.0], 3)
        self._moments = np.empty((len(tree.links), winding_kernels.MOMENTS))
        _tiled(len(tree.links), lambda a, b: winding_kernels.gather(self._corners, self._links, self._moments, a, b))
        self._held: OfContents[NDArray[bool_]] = OfContents(1)
        self._left: OfContents[Floats] = OfContents(1)

    def holds(self, places: Floats) -> NDArray[bool_]:
        """(n,) whether places (n, 3) lie inside."""
        places = np.ascontiguousarray(places)

        def ask() -> NDArray[bool_]:
            held = np.empty(len(places), dtype=np.bool_)
            parts = self._corners, self._links, self._moments, places, held
            _tiled(len(places), lambda first, last: winding_kernels.hold(*parts, first, last))
            return held

        return self._held.get((places,), ask)

    def exits(self, inner: Floats, outer: Floats) -> Floats:
        """(n,) fractions (0..1) at which segments from places inside to places outside, each (n, 3), leave."""
        inner, outer = np.ascontiguousarray(inner), np.ascontiguousarray(outer)

        def ask() -> Floats:
            shares = np.empty(len(inner))
            parts = self._corners, self._links, self._moments, self._boxes, inner, outer, shares
            _tiled(len(inner), lambda first, last: winding_kernels.leave(*parts, first, last))
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


def _tiled(count: int, work: Callable[[int, int], object]) -> None:
    over_tiles(-(-count // TILE), lambda tile: work(tile * TILE, min(count, (tile + 1) * TILE)))
