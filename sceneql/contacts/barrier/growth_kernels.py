# mypy: ignore-errors
"""Distances of the pairs that are listed."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.distance_kernels import edge_edge, point_triangle
from sceneql.contacts.barrier.pair_weights_kernels import listed, node
from sceneql.system.signatures_kernels import A, I


@lean(types.void(A, I, A))
def measure(floats, ints, found):
    """Fill found (points + edges, 5) with the distance when pairs were looked for, and the four vertices."""
    at, row = ints[layout.MEMORY] + layout.AT, 0
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            for k in range(4):
                found[5 * row + 1 + k] = node(floats, ints, m, edges, k)
            a, b = at + 3 * int(found[5 * row + 1]), at + 3 * int(found[5 * row + 2])
            c, d = at + 3 * int(found[5 * row + 3]), at + 3 * int(found[5 * row + 4])
            found[5 * row] = edge_edge(floats, a, b, c, d)[0] if edges else point_triangle(floats, a, b, c, d)[0]
            row += 1
