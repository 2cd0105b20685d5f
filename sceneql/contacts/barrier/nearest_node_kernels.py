# mypy: ignore-errors
"""Whether a skin starts apart from objects."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.objects_kernels import distance, place
from sceneql.system.signatures_kernels import A, F, I, N


@lean(types.Tuple((F, N, N))(A, A, I))
def nearest(y, floats, ints):
    """(least distance of a node [m], its place in the list, object)."""
    least, node, other = 1e300, -1, -1
    for p in range(ints[layout.NODES]):
        px, py, pz = place(y, floats, ints, p)
        for j in range(ints[layout.OBJECTS]):
            d = distance(floats, ints, p, j, px, py, pz, 0.0)[0]
            if d < least:
                least, node, other = d, p, j
    return least, node, other
