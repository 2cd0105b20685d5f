"""Gaps between solids that stand in a flow: one narrower than a cell is no passage, as no cell of it is whole."""

from __future__ import annotations

from itertools import combinations, product
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sceneql.frame import Floats
    from sceneql.kinds import Ref

TOUCHING = 0.02
"""Cells between solids up to which they touch."""
PROJECTIONS = 200
"""How often a place is moved onto the two surfaces, so that it ends where they are nearest."""
OPPOSITE = -0.7
"""Cosine of the angle between two surfaces' normals from which on they face each other."""
SLOPES = 1e-3
"""Cells over which a level set's gradient is read."""


def must_leave_cells(
    refs: Sequence[Ref], levels: Sequence[Any], shape: Sequence[int], centers: Floats, cell: Floats
) -> None:
    """Raise ScriptError for two solids that do not touch and have less than one cell between them.

    ``levels``: of each solid, positive in the fluid; ``shape``: cells along z, y, x; ``centers`` (cells, 3); ``cell``
    (3,): its sides.
    """
    near = [_beside_surface(level.values(centers).reshape(shape)) for level in levels]
    axes = [axis for axis in range(3) if shape[2 - axis] > 1]
    offsets = np.zeros((2 ** len(axes), 3))
    offsets[:, axes] = list(product((-0.25, 0.25), repeat=len(axes)))
    side = float(cell[axes].min())
    for (first, one), (second, other) in combinations(enumerate(levels), 2):
        places = centers[(near[first] & near[second]).ravel()]
        if not len(places):
            continue
        points = (places[:, None] + offsets * cell).reshape(-1, 3)
        a, to_a = _distances(one.values, points, axes, side)
        b, to_b = _distances(other.values, points, axes, side)
        wide = np.where((to_a * to_b).sum(axis=1) < OPPOSITE, a + b, np.inf)
        point, gap = points[int(np.argmin(wide))][None], float(wide.min())
        for number in range(PROJECTIONS if gap < side else 0):  # onto one and the other in turn
            d, normal = _distances((one, other)[number % 2].values, point, axes, side)
            point, gap = point - d[:, None] * normal, float(d[0])
        if TOUCHING * side < gap < side:
            x, y, z = point[0]
            text = f"'{refs[first].name}' and '{refs[second].name}' leave {gap:.3g} m between them, near "
            text += f"({x:.4g}, {y:.4g}, {z:.4g}) m: less than a cell of {side:.3g} m"
            help = f"take a `cell` of {gap / 3:.2g} m, so that fluid flows there, or let them touch"
            raise ScriptError([Diagnostic("no-cell", text, refs[second].span or refs[first].span, help)])


def _beside_surface(values: Floats) -> Any:
    """Of each cell whether the surface is within two cells of it."""
    from scipy.ndimage import binary_dilation, binary_erosion

    inside = values < 0.0
    return binary_dilation(inside, iterations=2) & ~binary_erosion(inside, iterations=2, border_value=1)


def _distances(
    values: Callable[[Floats], Floats], points: Floats, axes: Sequence[int], side: float
) -> tuple[Floats, Floats]:
    """Distance (k,) from the surface, below 0 inside, of first order in it, and the unit normal (k, 3)."""
    slopes = np.zeros((len(points), 3))
    for axis in axes:
        shift = np.zeros(3)
        shift[axis] = SLOPES * side
        slopes[:, axis] = (values(points + shift) - values(points - shift)) / (2.0 * SLOPES * side)
    steep = np.linalg.norm(slopes, axis=1)
    steep[~(steep > 0.0)] = np.inf
    return values(points) / steep, slopes / steep[:, None]
