# mypy: ignore-errors
"""What solids leave of the light of a lamp at places in space."""

from numba import types

from renderers.tracing.scene_kernels import SCENE, SCRATCH
from renderers.tracing.solids.intersect_kernels import walk
from sceneql.compiled.kernels import kernel

_i = types.int64
_table = types.float64[:, ::1]


@kernel(types.void(SCENE, SCRATCH, _table, _table, types.float64[::1], _i, _i), _nrt=False)
def leave(scene, scratch, places, ways, shares, start, stop):
    """Write for ``start`` to ``stop`` of places (n, 3) [m] the share of light that solids leave on its way to a lamp.

    ``ways`` (n, 4): the unit vector to the lamp and its distance [m].
    """
    for k in range(start, stop):
        x, y, z = places[k, 0], places[k, 1], places[k, 2]
        _, _, light = walk(scene, scratch, x, y, z, ways[k, 0], ways[k, 1], ways[k, 2], 0.0, ways[k, 3], True)
        shares[k] = light
