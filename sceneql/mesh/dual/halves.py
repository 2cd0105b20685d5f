"""Dual contouring's quads, each cut into two triangles. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import field_values

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints, Tape


def halved(tape: Tape, places: Floats, quads: Ints, ways: Ints) -> Ints:
    """(2 n, 3) two triangles for each of the quads (n, 4), cut along the diagonal with which neither is turned over.

    A quad surrounds a grid edge; ``ways`` (n,) holds the edge's axis 1, 2 or 3, negative if outward is against it. Both
    triangles must face outward along that axis; with vertices in the four cells around the edge, at least one diagonal
    satisfies this. If both or neither does, the diagonal whose midpoint has the smaller |f| is taken, since it follows
    an edge of the solid.
    """
    import numpy as np

    corners = places[quads]
    with np.errstate(all="ignore"):
        off = [np.abs(field_values(tape, 0.5 * (corners[:, k] + corners[:, k + 2]))) for k in (0, 1)]
    # Twice the signed areas of the triangles that the diagonals cut off at each corner, projected along the grid edge.
    axes = np.abs(ways)
    across = [np.take_along_axis(corners, ((axes + k) % 3)[:, None, None], axis=2)[:, :, 0] for k in (0, 1)]
    x, y = (np.roll(seen, -1, axis=1) - seen for seen in across)
    areas = (np.roll(x, 1, axis=1) * y - np.roll(y, 1, axis=1) * x) * np.sign(ways)[:, None]
    outward = [(areas[:, k] >= 0.0) & (areas[:, k + 2] >= 0.0) for k in (1, 0)]
    turned = np.where(outward[0] == outward[1], off[1] < off[0], outward[1])
    turned_quads = np.where(turned[:, None], np.roll(quads, -1, axis=1), quads)
    return np.stack([turned_quads[:, [0, 1, 2]], turned_quads[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
