# mypy: ignore-errors
"""The scene as two flat arrays: what `pack` fills and every kernel of the tracer reads.

Two, since numba passes an array as seven numbers to every function, and compile time follows their count.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from sceneql.compiled.kernels import function_at, lean_inlined

part = lean_inlined
"""A function called by kernels alone: without reference counts, which threads would fight over."""


class Scene(NamedTuple):
    """A frame as arrays (lengths in meters, colors linear), and addresses of what only implicit objects need."""

    reals: np.ndarray
    """float64: sky, camera and lights where SKY, CAMERA and LIGHTS say; then nodes, surfaces and items of all kinds."""
    ints: np.ndarray
    """int32: the header; four for each item; links of nodes, ranges and cells of implicit objects, code of tapes."""
    solid: int
    """Of what finds a solid's crossing: implicit_kernels.crossing or what stands for it; 0 without implicit objects."""
    sheet: int
    """Of what finds a sheet's: sheet_kernels.crossing or what stands for it; 0 without sheets."""
    skin: int
    """Of skin_kernels.skin; 0 without implicit objects."""
    grid: int
    """Of grid_kernels.crossing; 0 without grids."""
    grid_skin: int
    """Of grid_kernels.skin; 0 without grids."""


_f, _i = types.float64, types.int64
ROW = types.float32[::1]
"""Type of a record, and of a row of visibility."""
SCRATCH = types.float64[:, ::1]
"""Working memory of one thread: what root isolation needs, a row for each shape, the last shape's first, and a last row
whose first entry counts the undecided. Where its entry TOLD is set, the rows of implicit shapes begin with their first
crossing on the ray at hand, or with NaN. TOLD may be KNOWN; PROBING: what has no formula of its own counts as met
where a ray reaches its box, and TOLD is REACHED then."""
ASKED = types.float64[:, ::1]
"""Rays that are to be met in packets, a row each: origin, direction, how far, WANT, from ANSWERS on where it first
meets the implicit solids that packets know (inf: nowhere; NaN: not told). Row 0 is the head: MODE, which row is NEXT,
whether one is still OPEN, from ANSWERS on the indices of those shapes. PLAIN: rays are traced where they arise; ASKING:
they are written down, and those that may reach what has no formula of its own are open, and meet nothing; TELLING: they
are traced with the answers, in the order in which they were asked."""
SCENE = types.NamedTuple((types.float64[::1], types.int32[::1], _i, _i, _i, _i, _i), Scene)
RAY = (_f,) * 8
"""Types of origin, direction, near and far."""
CROSSING = types.FunctionType(_f(SCENE, SCRATCH, _i, *RAY, types.boolean))
SKIN = types.FunctionType(types.UniTuple(_f, 6)(SCENE, SCRATCH, _i, _f, _f, _f))
crossing_at, skin_at = map(function_at, (CROSSING, SKIN))
"""Make functions of the addresses."""
