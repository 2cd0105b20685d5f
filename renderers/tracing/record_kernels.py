# mypy: ignore-errors
"""A record: all that lighting a surface point needs, once rays have found it. One pixel has two.

The first is what the camera sees, the second what is seen in it (by reflection or refraction) first. Light and shadow
are found for whole pictures of records and filtered there, before anything is shaded.
"""

from renderers.tracing.scene_kernels import part

PLACE, NORMAL, VIEW, TINT, WEIGHT, SURFACE, OWNER, RADIUS, LIFT, TRACED, ITEM = 0, 3, 6, 9, 12, 15, 16, 17, 18, 19, 20
UNSURE = 21
"""Columns: point, shading normal, direction to the viewer, color, weight in the pixel, place of the surface, shape
index + 1 (0: no record), radius of the pixel's cone there, lift of shadow rays, share of the reflection that is
traced, item; whether a root on the pixel's path is undecided (of the first record alone, be there one or not)."""
COLUMNS = 22
FLATTEST = 0.9
"""Cosine between normals from which on two records may lie on one smooth piece of surface."""


@part
def put(record, px, py, pz, nx, ny, nz, vx, vy, vz, r, g, b):
    """Write the vectors of a record, but for its weight."""
    record[PLACE], record[PLACE + 1], record[PLACE + 2] = px, py, pz
    record[NORMAL], record[NORMAL + 1], record[NORMAL + 2] = nx, ny, nz
    record[VIEW], record[VIEW + 1], record[VIEW + 2] = vx, vy, vz
    record[TINT], record[TINT + 1], record[TINT + 2] = r, g, b


@part
def alike(a, b, reach):
    """Whether two records lie on one smooth piece of surface, ``reach`` pixel radii apart at the most off its plane."""
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
    """Where shadow rays of a record begin: off the surface, by far less than a pixel."""
    size = abs(record[PLACE]) + abs(record[PLACE + 1]) + abs(record[PLACE + 2])
    off = max(0.05 * record[RADIUS], 1e-6 * size) + record[LIFT]
    return (
        record[PLACE] + off * record[NORMAL],
        record[PLACE + 1] + off * record[NORMAL + 1],
        record[PLACE + 2] + off * record[NORMAL + 2],
    )


@part
def erase(record):
    """No record, and like none: the columns that are asked where there is none; the others stay as they were."""
    record[OWNER] = record[TRACED] = record[UNSURE] = 0.0
    record[NORMAL] = record[NORMAL + 1] = record[NORMAL + 2] = 0.0


@part
def copy_record(source, target):
    """Copy a record."""
    for column in range(COLUMNS):
        target[column] = source[column]
