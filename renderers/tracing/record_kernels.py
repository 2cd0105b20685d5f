# mypy: ignore-errors
"""Records: all data that lighting a surface point needs. A pixel has two.

The first is of the surface that the camera sees, the second of the first one mirrored or refracted in it. Light and
shadow are found for whole pictures of records and filtered there, before anything is shaded.
"""

from renderers.tracing.scene_kernels import part

PLACE, NORMAL, VIEW, TINT, WEIGHT, SURFACE, OWNER, RADIUS, LIFT, TRACED, ITEM = 0, 3, 6, 9, 12, 15, 16, 17, 18, 19, 20
UNSURE, IMAGED = 21, 22
"""Columns: point, shading normal, direction to the viewer, color, weight in the pixel, place of the surface, shape
index + 1 (0: no record), radius of the pixel's cone there, lift of shadow rays, share of the reflection that is traced,
item; whether a root on the pixel's path is undecided, or below 0 the path passes a thin capsule (in the first record
only, even if it is empty); share of the lamps that the traced reflection shows."""
COLUMNS = 23
FLATTEST = 0.9
"""Cosine between normals from which on two records may lie on one smooth surface."""


@part
def put(record, px, py, pz, nx, ny, nz, vx, vy, vz, r, g, b):
    """Write the vectors of a record, but for its weight."""
    record[PLACE], record[PLACE + 1], record[PLACE + 2] = px, py, pz
    record[NORMAL], record[NORMAL + 1], record[NORMAL + 2] = nx, ny, nz
    record[VIEW], record[VIEW + 1], record[VIEW + 2] = vx, vy, vz
    record[TINT], record[TINT + 1], record[TINT + 2] = r, g, b


@part
def alike(a, b, reach):
    """Whether two records lie on one smooth surface, at most ``reach`` pixel radii off its tangent planes."""
    if a[OWNER] != b[OWNER]:
        return False
    if a[NORMAL] * b[NORMAL] + a[NORMAL + 1] * b[NORMAL + 1] + a[NORMAL + 2] * b[NORMAL + 2] < FLATTEST:
        return False
    off = (
        (b[PLACE] - a[PLACE]) * a[NORMAL]
        + (b[PLACE + 1] - a[PLACE + 1]) * a[NORMAL + 1]
        + (b[PLACE + 2] - a[PLACE + 2]) * a[NORMAL + 2]
    )
    return abs(off) < reach * a[RADIUS]


@part
def start_of(record):
    """Origin of a record's shadow rays: off the surface, by far less than a pixel."""
    size = abs(record[PLACE]) + abs(record[PLACE + 1]) + abs(record[PLACE + 2])
    off = max(0.05 * record[RADIUS], 1e-6 * size) + record[LIFT]
    return (
        record[PLACE] + off * record[NORMAL],
        record[PLACE + 1] + off * record[NORMAL + 1],
        record[PLACE + 2] + off * record[NORMAL + 2],
    )


@part
def erase(record):
    """Empty a record, so that it is alike to none; only the columns that are read of empty records are reset."""
    record[OWNER] = record[TRACED] = record[UNSURE] = 0.0
    record[NORMAL] = record[NORMAL + 1] = record[NORMAL + 2] = 0.0


@part
def copy_record(source, target):
    """Copy a record."""
    for column in range(COLUMNS):
        target[column] = source[column]


@part
def enough(record, most):
    """How many of ``most`` samples, a power of two, a record is worth by its weight in the pixel; at least one.

    Numbers of pixels are about square roots of light. A reflection of weight w adds noise of w / sqrt(samples) to light
    of w or more: in these steps sqrt(w / samples), the same for samples in proportion to w.
    """
    weight = max(record[WEIGHT], max(record[WEIGHT + 1], record[WEIGHT + 2]))
    samples = most
    while samples > 1 and 0.5 * samples >= weight * most:
        samples //= 2
    return samples
