# mypy: ignore-errors
"""How near skins start to one another."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.skins.touch import touch_pairs_layout as layout
from sceneql.skins.touch.touch_pairs_search_kernels import lay, look
from sceneql.system.signatures_kernels import A, F, I, N


@lean(types.Tuple((F, N, N))(A, A, I, F))
def least(y, floats, ints, reach):
    """(least distance of a vertex from a skin [m], that vertex, that skin); infinite where none is below ``reach``."""
    nearest, vertex, skin = math.inf, -1, -1
    lay(y, floats, ints, reach)
    for p in range(ints[layout.VERTICES]):
        look(y, y[:0], floats, ints, p, reach)
        for s in range(ints[layout.SKINS]):
            d = floats[ints[layout.BEST] + layout.FOUND * s]
            if d < nearest:
                nearest, vertex, skin = d, p, s
    return nearest, vertex, skin
