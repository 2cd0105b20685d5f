"""Faces of a net of springs as a surface that a barrier keeps apart. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.system import Skin

if TYPE_CHECKING:
    from sceneql.bodies.nets import Net
    from sceneql.frame import Floats


def faces_of(net: Net, stiffnesses: Floats, radius: float) -> Skin | None:
    """The faces of a cloth or a solid; None for other nets.

    ``stiffnesses`` (m,) [N/m] of the springs, ``radius`` [m] of the masses. Springs of stiffness k along the faces'
    sides stand for a modulus of k over the thickness, twice the radius, of a sheet, and over their distance in a solid.
    Masses that are held have no inverse mass, so that none of their components is marked as held: a pin lets go.
    """
    if net.triangles is None or not len(net.triangles):
        return None
    triangles = np.asarray(net.triangles, dtype=np.int64)
    n = len(net.points)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1) @ [n, 1]
    along = np.isin(np.sort(net.pairs, axis=1) @ [n, 1], sides)
    thick = net.apart if net.tetrahedra is not None or radius == 0.0 else 2.0 * radius
    stiffness = float(np.median(stiffnesses[along])) / thick
    return Skin(triangles, np.zeros((n, 3), dtype=bool), stiffness)
