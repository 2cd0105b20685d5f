"""Rows of the parts of a tape as packets read them, in float32: a column for each row of ``Tape.parts``."""

AX, AY, AZ, SX, SY, SZ, INVERSE, WEIGHT, SHRINK, RADIUS, BLUR, LOW_X, HIGH_X, LOW_Y, HIGH_Y, LOW_Z, HIGH_Z, REACH = (
    range(18)
)
"""End a, axis b - a, 1/R^2, weight, 1/|axis|^2 (0: a point), R, rounding of the place; the box around the part and the
square of the distance from it beyond which there is no density. R is the least radius of a part that has several."""
ANCHOR_X, ANCHOR_Y, ANCHOR_Z, ANCHORED, AWAY = range(18, 23)
"""A point of a skeleton's part, 1/R there, and how far the part goes from it."""
PART = 23
CX, CY, CZ, KERNEL, GROUP, SHAPE, FAR = range(7)
"""Of the second column of a skeleton's part: c - a, what skeleton_parts_kernels has, and the root of REACH."""
RADIUS_A, RADIUS_B, RADIUS_C, CUBE, EVEN, CONE, VX, VY, VZ = range(7, 16)
"""Of a cone and a curve there: radii, 1/R^3 of the least, how far it is off a segment of that radius and, a curve, off
a cone; of a curve a - 2 c + b."""
GX, GY, GZ, HX, HY, HZ, NX, NY, NZ = range(7, 16)
"""Of a triangle there: two vectors g, h whose products with x - a are the shares of b and c, and the unit normal."""
