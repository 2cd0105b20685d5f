"""Blocks of a grid that are extracted when they are first asked for. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.cubes.grid_extraction import Found, GridExtraction, beyond
from sceneql.mesh.cubes.kept_kernels import take

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Ints

    Rows = NDArray[np.int64]


class KeptBlocks:
    """The surface in blocks of one grid, with what was found in them so far."""

    def __init__(self, shop: GridExtraction) -> None:
        self._shop = shop
        self._found: Found | None = None

    def extracted(self, blocks: Ints) -> Found:
        """As ``GridExtraction.extracted``, but in blocks that were asked for before the surface is not sought again."""
        import numpy as np

        if self._found is None:
            self._found = self._shop.extracted(blocks)
            return self._found
        known = self._found
        size = self._shop.grid.blocks.astype(np.int64) + 2
        strides = np.array([1, size[0], size[0] * size[1]])
        keys, wanted = known.blocks @ strides, blocks @ strides
        new = blocks[~np.isin(wanted, keys)]
        if len(new):
            self._found = known = _joined(known, self._shop.extracted(new))
            keys = known.blocks @ strides
        order = np.argsort(keys)
        return _some(known, order[np.searchsorted(keys[order], wanted)])


def _joined(first: Found, other: Found) -> Found:
    """The blocks of two as one, those of ``first`` first; inner vertices and neighbors are left out."""
    import numpy as np

    v, w = len(first.keys), len(other.keys)
    return Found(
        np.concatenate([first.blocks, other.blocks]),
        first.beyond,
        _after(first.begin, other.begin),
        _after(first.cube_at, other.cube_at),
        _after(first.triangle_at, other.triangle_at),
        _after(first.own_at, other.own_at),
        np.concatenate([first.keys, other.keys]),
        np.concatenate([first.cubes, other.cubes]),
        np.concatenate([first.place[:v], other.place[:w]]),
        np.concatenate([first.normal[:v], other.normal[:w]]),
    )


def _after(first: Ints, other: Ints) -> Ints:
    """Where blocks begin, if those of ``other`` follow those of ``first``."""
    import numpy as np

    return np.concatenate([first, first[-1] + other[1:] - other[0]])


def _some(known: Found, rows: Rows) -> Found:
    """What was found in the blocks ``rows`` (n,) alone, in their order."""
    import numpy as np

    begin, cube_at = _begins(known.begin, rows), _begins(known.cube_at, rows)
    triangle_at, own_at = _begins(known.triangle_at, rows), begin[-1] + _begins(known.own_at, rows)
    place, normal = np.empty((2, int(own_at[-1]), 3))
    place[begin[-1] :] = normal[begin[-1] :] = 0.0
    keys, cubes = np.empty(int(begin[-1]), known.keys.dtype), np.empty((int(cube_at[-1]), 2), known.cubes.dtype)
    take(
        rows, known.begin, known.cube_at, known.keys, known.cubes, known.place, known.normal, begin, cube_at, keys,
        cubes, place, normal,
    )  # fmt: skip
    blocks = known.blocks[rows]
    return Found(blocks, beyond(blocks), begin, cube_at, triangle_at, own_at, keys, cubes, place, normal)


def _begins(at: Ints, rows: Rows) -> Ints:
    """(n + 1,) where each of the ``rows`` (n,) begins when they stand one after the other; row k held at[k] to
    at[k + 1].
    """
    import numpy as np

    begin: Ints = np.concatenate([[0], np.cumsum(np.diff(at)[rows])])
    return begin
