# mypy: ignore-errors
"""The solid {f < 0} of a tape in its own coordinates; size: its order of magnitude [m].

Distances are to the nearest point of the surface, found by Newton's method where the field is smooth; where that fails
(in front of the sharp edges of combined solids, far away) they are f / |grad f|. Balls are proved to be clear of the
solid by interval arithmetic, which needs no Lipschitz bound.

Further integers: offset and number of the tape's constants, of its parts and of its rows of scratch in the floats, rows
of code, and the code, two integers a row.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.rows_kernels import rows_of
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import BEND_TYPE, CLEAR_TYPE, FOUR, SURFACE_TYPE, inward, turn
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape.tape_ops import NOWHERE
from sceneql.system.signatures_kernels import A, F, I, N

nearest = lazy("sceneql.contacts.shapes.nearest_kernels:nearest", FOUR(A, I, N, F, F, F))

CONSTANTS, PARTS, SCRATCH, CODE = 0, 2, 4, 6
HEAD = CODE + 1
as_code, as_rows = rows_of(types.int32, 4), rows_of(types.float64, 8)
"""A tape's operations; its parts, and its registers (SCRATCH_COLUMNS)."""


@lean_inlined
def tape_of(floats, ints, at):
    """The four arrays of the tape."""
    d = ints[at + layout.DATA]
    rows, parts, scratch = ints[d + CODE], ints[d + PARTS + 1], ints[d + SCRATCH + 1]
    code = as_code(ints[d + HEAD : d + HEAD + 2 * rows])
    constants = floats[ints[d + CONSTANTS] : ints[d + CONSTANTS] + ints[d + CONSTANTS + 1]]
    first = ints[d + PARTS]
    skeleton = as_rows(floats[first : first + 8 * parts])
    first = ints[d + SCRATCH]
    room = as_rows(floats[first : first + 8 * scratch])
    return code, constants, skeleton, room


@lean(SURFACE_TYPE, inner=True)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal; where the field is not defined it is far away."""
    x, y, z = inward(floats, ints, at, x, y, z)
    d, x, y, z = nearest(floats, ints, at, x, y, z)
    x, y, z = turn(floats, ints[at + layout.ROTATION], x, y, z)
    return d, x, y, z


@lean(BEND_TYPE, inner=True)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """By a difference of normals along v."""
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    if speed == 0.0:
        return 0.0
    apart = 1e-5 * floats[ints[at + layout.SIZE]] / speed
    ex, ey, ez = apart * vx, apart * vy, apart * vz
    _, a, b, c = surface(floats, ints, at, x - ex, y - ey, z - ez)
    _, p, q, r = surface(floats, ints, at, x + ex, y + ey, z + ez)
    return (vx * (p - a) + vy * (q - b) + vz * (r - c)) / (2.0 * apart)


@lean(CLEAR_TYPE, inner=True)
def clear(floats, ints, at, x, y, z, radius):
    """By a lower bound of f in the box around the ball."""
    x, y, z = inward(floats, ints, at, x, y, z)
    code, constants, parts, room = tape_of(floats, ints, at)
    least, _, status = box(
        code, constants, parts, room, x - radius, x + radius, y - radius, y + radius, z - radius, z + radius
    )
    return status == NOWHERE or least > 0.0
