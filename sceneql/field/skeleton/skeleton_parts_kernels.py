# mypy: ignore-errors
"""Layout of the rows of a skeleton's parts, and bounds of their radii.

A part takes two rows of the tape's parts: end a (3), end b (3), radius at a, weight; corner or control point c (3),
radius at b, kernel, group, shape; and for triangles the factor by which their distance suffers more from rounding than
a segment's, for curves the radius at c. A NODE is a box (low, high) and the number of rows after it whose reach it
contains.
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
"""Factor by which a curve's distance suffers more from rounding than a segment's."""


@inlined
def least_radius(parts, i):
    """A lower bound of the radius of the part at row i."""
    least = min(parts[i, RADIUS], parts[i + 1, RADIUS_B])
    return min(least, parts[i + 1, MIDDLE]) if parts[i + 1, SHAPE] == CURVE else least


@inlined
def largest_radius(parts, i):
    """An upper bound of the radius of the part at row i."""
    largest = max(parts[i, RADIUS], parts[i + 1, RADIUS_B])
    return max(largest, parts[i + 1, MIDDLE]) if parts[i + 1, SHAPE] == CURVE else largest


@inlined
def condition(parts, i):
    """Factor by which the distance of the part at row i suffers more from rounding than a segment's."""
    return CURVED if parts[i + 1, SHAPE] == CURVE else parts[i + 1, CONDITION]


@inlined
def convex(parts, i):
    """Whether s of the part at row i is convex: its points form a convex set, and R is constant."""
    return parts[i, RADIUS] == parts[i + 1, RADIUS_B] and parts[i + 1, SHAPE] != CURVE
