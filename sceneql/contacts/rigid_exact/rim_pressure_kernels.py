# mypy: ignore-errors
"""The first points of a circle that comes to lie still on a face: turned so that they enclose the center of pressure.

Where a body stands near the angle at which it tips, four points anywhere on the circle may have its center of pressure
outside: no forces of theirs hold it, and the exchange of points (rim_kernels) would begin from a body that falls.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_MASS, AT_X, cross, put
from sceneql.bodies.rigid.velocity_step_kernels import spin_by
from sceneql.compiled.kernels import lean
from sceneql.contacts.rigid_exact.contact_kernels import (
    FORCE,
    LINE_A,
    NORMAL,
    PAIR,
    POINT,
    PUSHES,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SLIDES,
    SPEED,
    dot,
    pace,
    three,
)
from sceneql.contacts.rigid_exact.curved import SIZES
from sceneql.contacts.rigid_exact.curved_contact_kernels import own
from sceneql.contacts.rigid_exact.curved_surface_kernels import into
from sceneql.contacts.rigid_exact.exact_rows_kernels import KEPT, MEMORY_AT, RECORDS_AT, mover_at, pull_at
from sceneql.contacts.rigid_exact.exact_solve_kernels import moves
from sceneql.contacts.rigid_exact.features_kernels import LIMIT, extent, smaller
from sceneql.contacts.rigid_exact.rim_kernels import (
    APPROACHES,
    STILL,
    first_of_circle,
    is_rim,
    probe_at,
    put_point,
    same_circle,
)
from sceneql.system.signatures_kernels import A, F, I, N

CENTRAL = 1e-6
"""Distance of the center of pressure from the middle of the circle, in radii, from which it has a direction."""


@lean(types.UniTuple(F, 2)(A, I, N))
def toward_pressure(floats, ints, rec):
    """The direction, of the shape's axes x and z, from the circle's middle to where what pulls one of the bodies onto
    the other has no moment along the face; (0, 0) where none is pulled so, or that place is the middle."""
    a, f, middle = mover_at(ints, int(floats[rec + SHAPE_A])), int(floats[rec + LINE_A]), probe_at(ints)
    put_point(floats, ints, rec, middle, 0.0, 0.0)
    for side in range(2):
        m = int(floats[rec + SHAPE_A + side])
        mover, pull = mover_at(ints, m), pull_at(ints, m)
        if not moves(floats, ints, m) or floats[mover + AT_MASS] == 0.0:
            continue
        way = 1.0 if side == 0 else -1.0
        nx, ny, nz = way * floats[rec + NORMAL], way * floats[rec + NORMAL + 1], way * floats[rec + NORMAL + 2]
        ax, ay, az = three(floats, pull)
        down = -dot(ax, ay, az, nx, ny, nz)
        if not down > 0.0:
            continue
        # The torque over the mass: the inverse of the inverse inertia times the angular acceleration.
        tx, ty, tz = three(floats, pull + 3)
        if tx != 0.0 or ty != 0.0 or tz != 0.0:
            tx, ty, tz = spin_by(floats, mover + AT_INVERSE, tx, ty, tz)
        by = floats[mover + AT_MASS]
        tx, ty, tz = cross(nx, ny, nz, by * tx, by * ty, by * tz)
        x, y, z = three(floats, middle + POINT)
        high = dot(floats[mover + AT_X] - x, floats[mover + AT_X + 1] - y, floats[mover + AT_X + 2] - z, nx, ny, nz)
        x = floats[mover + AT_X] + (high * ax - tx) / down - x
        y = floats[mover + AT_X + 1] + (high * ay - ty) / down - y
        z = floats[mover + AT_X + 2] + (high * az - tz) / down - z
        u, _, w = into(floats, f, *own(floats, a, x, y, z))
        size = math.sqrt(u * u + w * w)
        if size > CENTRAL * floats[f + SIZES]:
            return u / size, w / size
        break
    return 0.0, 0.0


@lean(types.boolean(A, I, N))
def fresh(floats, ints, rec):
    """Whether all points of a contact's circle stick, and none has pushed yet."""
    for j in range(int(floats[ints[MEMORY_AT] + KEPT])):
        other = ints[RECORDS_AT] + RECORD * j
        used = floats[other + PUSHES] > 0.0 or floats[other + SLIDES] > 0.0
        if floats[other + PAIR] == floats[rec + PAIR] and (used or not is_rim(floats, other)):
            return False
    return True


@lean(types.boolean(A, I, N, F, F))
def lies_still(floats, ints, rec, u, w):
    """Whether a point of a contact's circle is over the face, and neither comes nearer nor leaves."""
    to = probe_at(ints)
    a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
    put_point(floats, ints, rec, to, u, w)
    size = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
    slow = abs(floats[to + SPEED]) <= APPROACHES * (STILL + pace(floats, to, a, b))
    return slow and extent(floats, ints, to) >= -LIMIT * size


@lean(types.void(A, I))
def enclose_pressure(floats, ints):
    """Turn the points of all circles that have come to lie still, evenly, the first toward the center of pressure."""
    kept = int(floats[ints[MEMORY_AT] + KEPT])
    for k in range(kept):
        rec = ints[RECORDS_AT] + RECORD * k
        if not is_rim(floats, rec) or not first_of_circle(floats, ints, k) or not fresh(floats, ints, rec):
            continue
        u, w = toward_pressure(floats, ints, rec)
        if u == 0.0 and w == 0.0:
            continue
        count = 0
        for j in range(k, kept):
            count += same_circle(floats, rec, ints[RECORDS_AT] + RECORD * j)
        good = count > 2
        for number in range(count):
            c, s = math.cos(2.0 * math.pi * number / count), math.sin(2.0 * math.pi * number / count)
            good = good and lies_still(floats, ints, rec, c * u - s * w, s * u + c * w)
        number = 0
        for j in range(k, kept if good else k):
            other = ints[RECORDS_AT] + RECORD * j
            if same_circle(floats, rec, other):
                c, s = math.cos(2.0 * math.pi * number / count), math.sin(2.0 * math.pi * number / count)
                put_point(floats, ints, other, other, c * u - s * w, s * u + c * w)
                put(floats, other + FORCE, 0.0, 0.0, 0.0)
                number += 1
