"""Layout of the parts of a tape for packets, in float32: a column for each row of ``Tape.parts``."""

AX, AY, AZ, SX, SY, SZ, INVERSE, WEIGHT, SHRINK, RADIUS, BLUR, LOW_X, HIGH_X, LOW_Y, HIGH_Y, LOW_Z, HIGH_Z, REACH = (
    range(18)
)
"""End a, axis b - a, 1/R^2, weight, 1/|axis|^2 (0: a point), R, rounding of the place; the bounding box of the part and
the squared distance from it beyond which the density is 0. R is the least radius of a part that has several."""
ANCHOR_X, ANCHOR_Y, ANCHOR_Z, ANCHORED, AWAY = range(18, 23)
"""A point of a skeleton's part, 1/R there, and the radius of the part about it."""
PART = 23
CX, CY, CZ, KERNEL, GROUP, SHAPE, FAR = range(7)
"""Second column of a skeleton's part: c - a; kernel, group and shape (skeleton_parts_kernels); the root of REACH."""
RADIUS_A, RADIUS_B, RADIUS_C, CUBE, EVEN, CONE, VX, VY, VZ = range(7, 16)
"""Of a cone or curve, in that column: radii, 1/R^3 of the least, deviation from a segment of that radius, deviation of
a curve from a cone, and a - 2 c + b of a curve."""
GX, GY, GZ, HX, HY, HZ, NX, NY, NZ = range(7, 16)
"""Of a triangle: vectors g, h whose products with x - a are the barycentric coordinates of b and c; unit normal."""
