"""Trilinear interpolation of a field between the centers of its cells, extrapolated beyond its domain's boundary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout

LAYERS = 3
"""Layers of cells outside the domain that get extrapolated values, so that all points of the domain are surrounded."""


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """For the cells of a layer (targets), the three next cells along one direction, to extrapolate from."""

    cells: tuple[Any, Any, Any]
    """Numbers (targets,) of the first, second and third cell."""
    sloped: NDArray[np.bool_]
    """(targets,) whether all three have values, so that a slope is known."""
    used: NDArray[np.bool_]
    """(targets,) whether this direction is used: if sloped or, where no direction is, if the first cell has a value."""


class Interpolation:
    """The trilinear interpolant on a grid with one more layer of cells around it; arrays have the axes z, y, x.

    A cell outside the domain gets the mean of extrapolations from its neighbors inside. Each uses the smaller of the
    last two slopes if these agree in sign, else no slope (minmod limiter: Roe 1986), so that jumps do not overshoot.
    """

    what = "cells"

    def __init__(self, layout: FieldLayout, inside: NDArray[np.bool_]) -> None:
        """``inside`` (cells,): whether each cell lies in the domain."""
        nx, ny, nz = layout.shape
        self.layout = layout
        self._around = 0 if nz == 1 else 1
        room = ((self._around,) * 2, (1, 1), (1, 1))
        known = np.pad(inside.reshape(nz, ny, nx), room)
        self.shape = known.shape
        self.known = known.copy()
        self._own = np.flatnonzero(known)
        self._layers = [layer for _ in range(LAYERS) if (layer := _layer(known)) is not None]

    @property
    def count(self) -> int:
        """Number of cells of the domain."""
        return len(self._own)

    def gridded(self, field: Floats) -> Floats:
        """The field itself, since `filled` returns it on its grid."""
        return field

    def filled(self, values: Floats) -> Floats:
        """The field with extrapolated surroundings, from the values (k,) in the domain's cells."""
        out = np.full(int(np.prod(self.shape)), values.mean())
        out[self._own] = values
        for targets, sources in self._layers:
            total, count = np.zeros(len(targets)), np.zeros(len(targets))
            for source in sources:
                a, b, c = (out[cells] for cells in source.cells)
                slope = np.where((a - b) * (b - c) > 0.0, np.where(abs(a - b) < abs(b - c), a - b, b - c), 0.0)
                total += np.where(source.used, a + np.where(source.sloped, slope, 0.0), 0.0)
                count += source.used
            out[targets] = total / count
        return out.reshape(self.shape)

    def at(self, field: Floats, points: Floats) -> Floats:
        """Interpolated values (k,) of a filled field (or any array of its shape) at points (k, 3) [m]."""
        layout = self.layout
        places = (points - layout.low) / layout.spacing + 0.5
        return trilinear(field, places)


def trilinear(values: Floats, places: Floats) -> Floats:
    """Interpolated values (k,) of ``values`` (nz, ny, nx) at places (k, 3) in node coordinates (x, y, z).

    Constant along an axis with one node. Places beyond the nodes have the values at the border.
    """
    index, part = [], []
    for axis in range(3):
        last = values.shape[2 - axis] - 1
        first = np.clip(np.floor(places[:, axis]), 0, max(last - 1, 0)).astype(np.int64)
        index.append(first)
        part.append(np.clip(places[:, axis] - first, 0.0, 1.0) if last else np.zeros(len(places)))
    total = np.zeros(len(places))
    for corner in range(8 if values.shape[0] > 1 else 4):
        dx, dy, dz = corner & 1, corner >> 1 & 1, corner >> 2
        weight = (part[0] if dx else 1.0 - part[0]) * (part[1] if dy else 1.0 - part[1])
        weight = weight * (part[2] if dz else 1.0 - part[2])
        total += weight * values[index[2] + dz, index[1] + dy, index[0] + dx]
    return total


def _layer(known: NDArray[np.bool_]) -> tuple[Any, list[Source]] | None:
    """The cells next to known ones, and the sources of their values; marks them known. None where there are none."""
    wide = known.copy()
    for axis in range(3):
        high, low = [slice(None)] * 3, [slice(None)] * 3
        high[axis], low[axis] = slice(1, None), slice(None, -1)
        wide[tuple(high)] |= known[tuple(low)]
        wide[tuple(low)] |= known[tuple(high)]
    targets = np.flatnonzero(wide & ~known)
    if not len(targets):
        return None
    places = np.unravel_index(targets, known.shape)
    found = []
    for axis in range(3):
        stride = int(np.prod(known.shape[axis + 1 :]))
        for way in (-1, 1):
            cells, told = [], []
            for step in (1, 2, 3):
                place = places[axis] + way * step
                there = (place >= 0) & (place < known.shape[axis])
                cells.append(np.where(there, targets + way * step * stride, 0))
                told.append(there & known.ravel()[cells[-1]])
            found.append((cells, told[0], told[0] & told[1] & told[2]))
    some = np.any([sloped for _, _, sloped in found], axis=0)
    sources = [
        Source((cells[0], cells[1], cells[2]), sloped, np.where(some, sloped, near)) for cells, near, sloped in found
    ]
    known |= wide
    return targets, sources


@lru_cache(maxsize=8)
def _kept(layout: FieldLayout, mask: bytes) -> Interpolation:
    inside = np.unpackbits(np.frombuffer(mask, dtype=np.uint8), count=layout.count).astype(bool)
    return Interpolation(layout, inside)


def interpolation(layout: FieldLayout, inside: NDArray[np.bool_]) -> Interpolation:
    """The interpolation of a grid, cached for all frames; ``inside`` (cells,): which cells lie in the domain."""
    return _kept(layout, np.packbits(inside).tobytes())
