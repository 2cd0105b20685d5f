# mypy: ignore-errors
"""Signed distances from a closed mesh (closed_mesh.ClosedMesh, laid out as for contacts/shapes/mesh_kernels)."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.shapes.mesh_kernels import NORMALS, dot, nearest
from sceneql.system.signatures_kernels import A, I, N


@lean(types.void(A, I, types.float64[:, ::1], A, N, N))
def distances(floats, ints, points, out, first, last):
    """out[k] = signed distance of points[k] (n, 3), below 0 inside, for first <= k < last.

    The sign follows from the normal of the nearest feature (Baerentzen & Aanaes 2005). ``ints``: the further integers
    of a contact's object.
    """
    for k in range(first, last):
        square, a, b, c, t, feature = nearest(floats, ints, 0, points[k, 0], points[k, 1], points[k, 2], math.inf)
        n = t + NORMALS + 3 * feature
        side = dot(a, b, c, floats[n], floats[n + 1], floats[n + 2])
        out[k] = math.copysign(math.sqrt(square), side)
