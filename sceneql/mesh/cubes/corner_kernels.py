# mypy: ignore-errors
"""f at the corners of the cubes of a block: where it is nearest to zero."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.mesh.cubes.sample_kernels import NODES


@inlined
def of_corners(values, nodes, x, y, z, wide):
    """(whether f < 0 at a cube's first corner, least |f| at its corners); infinite where their signs differ.

    Of the cube of ``wide`` steps from node (x, y, z) on, among ``nodes`` along each axis.
    """
    p = (z * nodes + y) * nodes + x
    negative = values[p] < 0.0
    least = np.inf
    for c in range(8):
        v = values[p + ((c & 1) + (c >> 1 & 1) * nodes + (c >> 2) * nodes * nodes) * wide]
        if (v < 0.0) != negative:
            return negative, np.inf
        least = min(least, abs(v) if v == v else 0.0)
    return negative, least


@inlined
def least_at_corners(values, nearest):
    """f at the corner of each cube of a block where it is nearest to zero; infinite where signs differ.

    ``values`` (2 NODES^3,) holds f at the nodes, then the greatest f at the corners of each cube; both arrays are laid
    out by the cubes' first nodes. Where f is undefined it counts as zero.
    """
    last = NODES**3
    for p in range(last):
        nearest[p] = values[p] if values[p] == values[p] else 0.0
        values[last + p] = nearest[p]
    for axis in range(3):
        step = NODES**axis
        for p in range(last - step):
            v, w = nearest[p], nearest[p + step]
            nearest[p] = v if v < w else w
            v, w = values[last + p], values[last + p + step]
            values[last + p] = v if v > w else w
    for p in range(last):
        most = values[last + p]
        nearest[p] = most if most < 0.0 else nearest[p] if nearest[p] >= 0.0 else np.inf


@inlined
def in_doubt(nearest, x0, y0, z0, wide, outer, inner):
    """Whether of the cubes from (x0, y0, z0) on, ``wide`` along each axis, one with corners of one sign is not proved
    by ``outer`` and ``inner``, as ``enough`` gives them.
    """
    some = False
    for row in range(wide * wide):
        p = ((z0 + row // wide) * NODES + y0 + row % wide) * NODES + x0
        for x in range(wide):
            some |= -inner <= nearest[p + x] <= outer
    return some
