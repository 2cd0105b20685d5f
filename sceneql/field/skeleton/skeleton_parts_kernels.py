# mypy: ignore-errors
"""What the rows of a skeleton's parts mean, and how far they reach.

A part takes two rows of the tape's parts: end a (3), end b (3), radius at a, weight; corner or control point c (3),
radius at b, kernel, group, shape; and for triangles how much more than a segment's their distance suffers from
rounding, for curves the radius at c. A NODE is a box (low, high) and the number of rows behind it that reach no
farther.
"""

from sceneql.compiled.kernels import inlined

RADIUS, WEIGHT = 6, 7
RADIUS_B, KERNEL, GROUP, SHAPE, CONDITION = 3, 4, 5, 6, 7
"""Columns of a part's second row."""
MIDDLE = CONDITION
SEGMENT, TRIANGLE, NODE, CURVE = range(4)
STRIDE = 2
"""Rows of a part."""
CURVED = 4.0
"""How much more than a segment's the distance of a curve suffers from rounding."""


@inlined
def least_radius(parts, i):
    """The radius of the part at row i is nowhere less."""
    least = min(parts[i, RADIUS], parts[i + 1, RADIUS_B])
    return min(least, parts[i + 1, MIDDLE]) if parts[i + 1, SHAPE] == CURVE else least


@inlined
def largest_radius(parts, i):
    """The radius of the part at row i is nowhere more."""
    largest = max(parts[i, RADIUS], parts[i + 1, RADIUS_B])
    return max(largest, parts[i + 1, MIDDLE]) if parts[i + 1, SHAPE] == CURVE else largest


@inlined
def condition(parts, i):
    """How much more than a segment's the distance of the part at row i suffers from rounding."""
    return CURVED if parts[i + 1, SHAPE] == CURVE else parts[i + 1, CONDITION]


@inlined
def convex(parts, i):
    """Whether s of the part at row i is convex: its points are a convex set, and R is the same all over."""
    return parts[i, RADIUS] == parts[i + 1, RADIUS_B] and parts[i + 1, SHAPE] != CURVE
