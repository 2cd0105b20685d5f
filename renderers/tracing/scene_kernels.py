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
TOLD = 1
KNOWN, PROBING, REACHED = 1.0, 2.0, 3.0
ASKED = types.float64[:, ::1]
"""Rays that are to be met in packets, a row each: origin, direction, how far, WANT, from ANSWERS on where it first
meets the implicit solids that packets know (inf: nowhere; NaN: not told). Row 0 is the head: MODE, which row is NEXT,
whether one is still OPEN, from ANSWERS on the indices of those shapes. PLAIN: rays are traced where they arise; ASKING:
they are written down, and those that may reach what has no formula of its own are open, and meet nothing; TELLING: they
are traced with the answers, in the order in which they were asked."""
FAR, WANT, ANSWERS = 6, 7, 8
FIRST, ANYWHERE, NOTHING = range(3)
"""What is wanted of a ray: what it meets first, whether it meets anything, or nothing: it passes all boxes by."""
MODE, NEXT, OPEN = range(3)
PLAIN, ASKING, TELLING = range(3)
SCENE = types.NamedTuple((types.float64[::1], types.int32[::1], _i, _i, _i, _i, _i), Scene)
RAY = (_f,) * 8
"""Types of origin, direction, near and far."""
CROSSING = types.FunctionType(_f(SCENE, SCRATCH, _i, *RAY, types.boolean))
SKIN = types.FunctionType(types.UniTuple(_f, 6)(SCENE, SCRATCH, _i, _f, _f, _f))
crossing_at, skin_at = map(function_at, (CROSSING, SKIN))
"""Make functions of the addresses."""

NODE_COUNT, ITEM_COUNT, ENDLESS_COUNT, LIGHT_COUNT, NODES_AT, LINKS_AT, SHAPE_COUNT = range(7)
"""The header. The first ENDLESS_COUNT items have no bounds; they stand in the first node, which has none either."""

ITEMS = 8
"""First of the items, by leaf: kind, place of its reals, place of its surface, index of its shape."""
KIND, REALS_AT, SURFACE_AT, SHAPE = range(4)
TRIANGLE, ROUND, QUADRIC, HALF_SPACE, IMPLICIT, SHEET, GRID = range(7)
"""Kinds. Their reals:
TRIANGLE: corner, edge, edge; normals at the corners, colors at the corners (a NaN first: there are none): 27.
ROUND (sphere or capsule): end, axis to the other end, radius, color (NaN: the surface's): 10.
QUADRIC: map to local (3, 4), squares, linear, constant, low, high: 25.
HALF_SPACE (a quadric that is nothing else): unit normal, height of its face along that: 4.
GRID: as grid_kernels says.
IMPLICIT and SHEET: low, high, place of its ranges: 7. The ranges, in ints: place of the code, its rows, place of the
constants, their number, place of the parts, their rows; place of the cells; the same six of its paint and of what a
sheet lies within (no rows: it has none); place of the plan for single rays (sceneql.field.tape.plans), its length."""
CELLS_AT, PAINT, WITHIN, PLAN, RANGES = 6, 7, 13, 19, 21
"""Columns of the ranges, and how many there are."""
CELLS = 32
"""Occupancy cells along each axis of an implicit object's box, by which single rays go."""

LINK = 3
"""Ints of a node: the node to go on with when this one is missed, first item, number of items (0: an inner node)."""

SKY = 0
"""Zenith, horizon, ground, visible; whether there is a sky, whether `visible` is given: 14."""
HAS_SKY, HAS_VISIBLE = 12, 13
TOLERANCE, SAMPLES = 14, 15
"""Of roots of implicit objects, relative to the searched piece of a ray; samples on it where they are only sampled."""
CAMERA = 16
"""Origin, right, up, back, half height, orthographic, width, height: 16."""
WIDTH, HEIGHT = CAMERA + 14, CAMERA + 15
LIGHTS = 32
"""First light."""
LIGHT = 9
"""Reals of a light: kind, direction to it or position, irradiance or intensity, angular diameter or radius; radius of
its disk, of a sun at distance 1."""
SUN, POINT = range(2)

COLOR, ROUGHNESS, METALLIC, SPECULAR, TRANSMISSION = 0, 3, 4, 5, 6
INDEX, EMISSION, CHECKER, CHECKER_COLOR = 7, 8, 11, 12
SURFACE_SIZE = 15
"""Reals of a surface, and how many there are."""

EMPTY, MIXED, FULL = range(3)
"""What an occupancy cell is proved to be: outside, nothing, inside."""
