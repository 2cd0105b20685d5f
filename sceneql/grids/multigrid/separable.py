"""Separable diffusion operators on boxes, sums of one operator for each axis, and the eigenmodes of these.

On equal cells with a constant coefficient the modes along an axis are those of discrete transforms (Strang 1999, SIAM
Review 41, 135-147): cosines for zero flux at both ends, sines for given values, quarter waves for one of each, and
complex waves for a periodic axis. With an exchange (Robin) at an end, they are computed as eigenvectors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Grid

SAME = 1e-12
"""Relative difference of numbers that count as equal."""
MOST_DENSE = 2048
"""Most cells of an axis whose eigenvectors are computed."""

Transform = Callable[[Any, int], Any]
"""(values, axis) -> values."""
CLOSED, GIVEN = 0.0, 2.0
"""Sink at an end of an axis, in units of the rate between cells: for zero flux, and for a given value."""


@dataclass(frozen=True)
class Axis:
    """A row of cells with the equation dc/dt = rate (left + right - 2 c), and sinks at its ends."""

    count: int
    rate: float
    """[1/s] exchange rate between neighboring cells."""
    low: float
    """Sink at the low end (``high``: at the high end), in units of the rate."""
    high: float
    periodic: bool

    @cached_property
    def kind(self) -> str:
        """The name of its family of eigenmodes."""
        ends = {(CLOSED, CLOSED): "cosines", (GIVEN, GIVEN): "sines", (CLOSED, GIVEN): "quarter cosines",
                (GIVEN, CLOSED): "quarter sines"}  # fmt: skip
        if self.periodic:
            return "waves"
        return next((kind for (a, b), kind in ends.items() if _same(self.low, a) and _same(self.high, b)), "own modes")

    @cached_property
    def _eigen(self) -> tuple[Floats, Floats]:
        from scipy.linalg import eigh_tridiagonal

        diagonal = np.full(self.count, 2.0)
        diagonal[0] += self.low - 1.0
        diagonal[-1] += self.high - 1.0
        values, vectors = eigh_tridiagonal(diagonal, np.full(self.count - 1, -1.0))
        return values, vectors

    @cached_property
    def decays(self) -> Floats:
        """Decay rates (n,) [1/s] of the eigenmodes."""
        n = self.count
        if self.kind == "own modes":
            return self.rate * np.maximum(0.0, self._eigen[0])
        k = np.arange(n)
        number = {"cosines": 0.5 * k, "sines": 0.5 * (k + 1), "waves": np.minimum(k, n - k)}.get(
            self.kind, 0.5 * (k + 0.5)
        )
        decays: Floats = 4.0 * self.rate * np.sin(np.pi * number / n) ** 2
        return decays

    def forward(self, values: Any, axis: int) -> Any:
        """Coefficients of the eigenmodes along an axis of an array of values."""
        return self._transform(values, axis, True)

    def backward(self, weights: Any, axis: int) -> Any:
        """Values from the coefficients of the eigenmodes along an axis."""
        return self._transform(weights, axis, False)

    def _transform(self, values: Any, axis: int, forward: bool) -> Any:
        from scipy import fft

        match self.kind:
            case "waves":
                return (fft.fft if forward else fft.ifft)(values, axis=axis)
            case "cosines":
                return (fft.dct if forward else fft.idct)(values, 2, axis=axis, norm="ortho")
            case "sines":
                return (fft.dst if forward else fft.idst)(values, 2, axis=axis, norm="ortho")
            case "quarter cosines":
                return fft.dct(values, 4, axis=axis, norm="ortho")
            case "quarter sines":
                return fft.dst(values, 4, axis=axis, norm="ortho")
        vectors = self._eigen[1]
        return np.moveaxis(np.tensordot(vectors, values, axes=(0 if forward else 1, axis)), 0, axis)


def axes_of(grid: Grid, floats: Floats) -> tuple[Axis, ...] | None:
    """The axes (z,) y, x of a box, in the order of its arrays; None where the operator is not separable."""
    if grid.varying or grid.fed_at < 0 or grid.cells.outside.any():
        return None
    nx, ny, nz = grid.cells.shape
    n = nx * ny * nz

    def array(at: int) -> Floats:
        return floats[at : at + n].reshape(nz, ny, nx)

    volume, sink = array(grid.volumes_at), array(grid.sink_at)
    size = float(volume.flat[0])
    if not (np.abs(volume - size) <= SAME * size).all():
        return None
    found: list[Axis] = []
    sinks = np.zeros_like(sink)
    for axis in range(0 if nz > 1 else 1, 3):
        faces = np.moveaxis(array(grid.faces_at[2 - axis]), axis, 0)
        count, periodic = len(faces), grid.cells.periodic[2 - axis]
        rate = float(faces[-1].flat[0]) / size if count > 1 else 0.0
        between = faces if periodic else faces[1:]
        if not (np.abs(between - rate * size) <= SAME * rate * size).all() or not (periodic or not faces[0].any()):
            return None
        if count == 1 or rate == 0.0:
            return None
        # The sinks along this axis, at the middle of the other axes, away from their ends.
        ends = np.moveaxis(sink, axis, 0)[(slice(None), *(k // 2 for k in np.moveaxis(sink, axis, 0).shape[1:]))]
        middle = float(ends[count // 2]) if count > 2 else 0.0
        low, high = float(ends[0]) - middle, float(ends[-1]) - middle
        shape = [1, 1, 1]
        shape[axis] = count
        own = np.zeros(count)
        own[0] += low
        own[-1] += high
        sinks += own.reshape(shape)
        found.append(Axis(count, rate, low / (rate * size), high / (rate * size), periodic))
    if not (np.abs(sink - sinks) <= SAME * float(np.abs(sink).max(initial=0.0))).all():
        return None
    if any(axis.kind == "own modes" and axis.count > MOST_DENSE for axis in found):
        return None
    return tuple(found)


def _same(a: float, b: float) -> bool:
    return abs(a - b) <= 1e-9
