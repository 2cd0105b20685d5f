# mypy: ignore-errors
"""The scene of the tracer's kernels: two flat arrays, filled by `pack` and laid out as in layout.py, and their types.

Two, since numba passes an array as seven numbers to every function, and compile time follows their count.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from sceneql.compiled.kernels import HELPER, function_at, lean_inlined, njit

part = lean_inlined
"""Decorator of functions called by kernels alone: no reference counts, for which threads would compete."""
part_in_place = njit(_nrt=False, forceinline=True, **HELPER)
"""The same for large ones that are called once for each pixel: a call hands over each number of a scene's arrays."""


class Scene(NamedTuple):
    """A frame as arrays (lengths in meters, colors linear), and addresses of kernels that only some frames need."""

    reals: np.ndarray
    """float64: sky, camera and lights where SKY, CAMERA and LIGHTS say; then nodes, surfaces and items of all kinds."""
    ints: np.ndarray
    """int32: the header; four for each item; links of nodes, ranges and cells of implicit objects, code of tapes."""
    solid: int
    """Of the kernel for a ray and a solid: implicit_kernels.crossing or another method; 0 without implicit objects."""
    sheet: int
    """Of the kernel for a ray and a sheet: sheet_kernels.crossing or another method; 0 without sheets."""
    skin: int
    """Of skin_kernels.skin; 0 without implicit objects."""
    grid: int
    """Of grid_kernels.crossing; 0 without grids."""
    grid_skin: int
    """Of grid_kernels.skin; 0 without grids."""
    texture: int
    """Of texture_kernels.texture; 0 without meshes that are painted."""
    mist: int
    """Of mist_kernels.mists_along; 0 without mists."""


_f, _i = types.float64, types.int64
ROW = types.float32[::1]
"""Type of a record, and of a row of visibility."""
SCRATCH = types.float64[:, ::1]
"""Working memory of one thread: rows for root isolation, a row for each shape, the last shape's first, and a last row
whose first entry counts undecided roots. While its entry TOLD is KNOWN, the rows of implicit shapes begin with their
first crossing on the current ray, or with NaN, followed by their items. While it is PROBING, implicit shapes and grids
are passed, and where a ray reaches the box of one TOLD becomes REACHED, or BEYOND for one that packets do not know."""
ASKED = types.float64[:, ::1]
"""Rays to be intersected in packets, a row each: origin, direction, length, WANT; the walk past all that packets know,
as REST_AT, REST_ITEM and REST_LIGHT; and from ANSWERS on the first crossings with the implicit solids that they know
(inf: none; NaN: undecided). Row 0 is the head: MODE, the NEXT row, whether a ray is OPEN, the number of WAYS of light
listed, whether packets know all of the scene (they are ALONE), and from ANSWERS on the indices of those shapes. PLAIN:
rays are traced at once; ASKING: rays are written down, and those that reach boxes of implicit shapes or grids are open,
and miss everything; TELLING: rays are traced with the answers, in the order in which they were written; ENDING: no rays
are traced, and what ways of light have brought is summed up, in their order, in which NEXT is the next one."""
SCENE = types.NamedTuple((types.float64[::1], types.int32[::1], _i, _i, _i, _i, _i, _i, _i), Scene)
RAY = (_f,) * 8
"""Types of origin, direction, near and far."""
CROSSING = types.FunctionType(_f(SCENE, SCRATCH, _i, *RAY, types.boolean))
SKIN = types.FunctionType(types.UniTuple(_f, 6)(SCENE, SCRATCH, _i, _f, _f, _f))
TEXTURE = types.FunctionType(types.UniTuple(_f, 3)(SCENE, SCRATCH, _i, _f, _f, _f))
MIST = types.FunctionType(types.UniTuple(_f, 4)(SCENE, *RAY, _i))
crossing_at, skin_at, texture_at, mists_at = map(function_at, (CROSSING, SKIN, TEXTURE, MIST))
"""Turn addresses into functions."""
