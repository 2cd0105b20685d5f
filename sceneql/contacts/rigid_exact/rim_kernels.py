# mypy: ignore-errors
"""Circles of rings and columns that lie flat on a face: a few of their points stand for them, and follow the pressure.

The distance of the circle's points from the face changes as an affine function of the place, and so do its two
derivatives. Where that is least beside the points that are there, and below 0, a point is put: by this exchange (as of
Gilbert, Johnson & Keerthi 1988) the circle stands, tips and is struck as if all of it were there. Friction is that of
the points.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import put, turned
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.rigid_exact.contact_kernels import (
    BIAS,
    CORNER_FACE,
    FORCE,
    GAP,
    KIND,
    LINE_A,
    LINE_B,
    OWN_A,
    PAIR,
    PUSHES,
    RECORD,
    ROWS,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    SPEED,
    follow,
    pace,
    three,
)
from sceneql.contacts.rigid_exact.curved import CENTER, COLUMN, ELLIPSOID, FORM, SIZES
from sceneql.contacts.rigid_exact.curved_contact_kernels import ON_FACE, own
from sceneql.contacts.rigid_exact.curved_surface_kernels import into, out_of
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    AT_CONTACT,
    AT_FIRST,
    AT_WEIGHED,
    KEPT,
    MEMORY_AT,
    MOST,
    MOVERS,
    RECORDS_AT,
    SPARING,
    UNIT,
    UNITS_AT,
    answer_at,
    left_at,
    mover_at,
    pull_at,
    sizes_at,
    solution_at,
)
from sceneql.contacts.rigid_exact.features_kernels import LIMIT, extent, smaller
from sceneql.system.signatures_kernels import A, F, I, N

SINKS = 1e-10
"""Acceleration into the face, in parts of the numbers that it is a sum of, from which a point is put there."""
APPROACHES = 1e-13
"""Speed of approach, in parts of the speeds that it is a sum of, from which one is."""
STILL = 1e-12
"""And this speed [m/s]."""
LEAVES, OPEN = 1e-5, 1e-6
"""Speed, in parts of the speeds that it is a sum of, and gap, in parts of the smaller body, from which a place of the
circle leaves the face, or has left it."""
SAME = 1e-3
"""Distance of two points, in parts of the smaller body, up to which they are one: a circle tips at its true moment to
an eighth of its square."""
STEEP = 0.5
"""Sine of the angle of a face and a circle from which on it is far from lying there."""
LANDS = 1e-11
"""Sine up to which it lies there at an event."""
FEW = 6
"""Most points of a circle."""


@lean_inlined
def is_rim(floats, rec):
    """Whether a contact is that of a point of a circle that lies flat."""
    return floats[rec + KIND] == CORNER_FACE and floats[rec + LINE_A] > 0.0


@lean_inlined
def same_circle(floats, rec, other):
    """Whether a contact is of a point of the circle of another one."""
    same = floats[other + PAIR] == floats[rec + PAIR] and floats[other + SIGN] == floats[rec + SIGN]
    return same and is_rim(floats, other)


@lean(types.boolean(A, I, N))
def first_of_circle(floats, ints, k):
    """Whether contact k is the first one of its circle."""
    for j in range(k):
        if same_circle(floats, ints[RECORDS_AT] + RECORD * k, ints[RECORDS_AT] + RECORD * j):
            return False
    return True


@lean(types.boolean(A, I))
def any_rim(floats, ints):
    """Whether a circle lies flat."""
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        if is_rim(floats, ints[RECORDS_AT] + RECORD * k):
            return True
    return False


@lean(types.UniTuple(F, 3)(A, N, F, F, F))
def on_circle(floats, f, sign, u, w):
    """The point of the circle of a ring, or of a rim of a column, in a direction of the shape's axes x and z; for
    (0, 0) the circle's middle."""
    a, b = floats[f + SIZES], floats[f + SIZES + 1]
    px, py, pz = out_of(floats, f, a * u, sign * b if floats[f + FORM] == COLUMN else 0.0, a * w)
    return floats[f + CENTER] + px, floats[f + CENTER + 1] + py, floats[f + CENTER + 2] + pz


@lean_inlined
def probe_at(ints):
    """Where a contact stands that is asked about, and not kept."""
    return ints[RECORDS_AT] + 2 * RECORD * ints[MOST]


@lean(types.void(A, I, N, N, F, F))
def put_point(floats, ints, rec, to, u, w):
    """Write to ``to`` the contact of another point of the circle of a contact."""
    if to != rec:
        for c in range(RECORD):
            floats[to + c] = floats[rec + c]
    put(floats, to + OWN_A, *on_circle(floats, int(floats[rec + LINE_A]), floats[rec + SIGN], u, w))
    a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
    follow(floats, to, a, b)


@lean(types.void(A, I, N))
def answer(floats, ints, n):
    """Write the accelerations of all movers by all forces, those of the rows, too."""
    for m in range(ints[MOVERS]):
        for c in range(6):
            floats[answer_at(ints, m) + c] = floats[pull_at(ints, m) + c]
    for i in range(n):
        unit, force = ints[UNITS_AT] + UNIT * i, floats[solution_at(ints) + i]
        for side in range(2):
            to = answer_at(ints, int(floats[unit + AT_FIRST + side]))
            for c in range(6):
                floats[to + c] += force * floats[unit + AT_WEIGHED + 6 * side + c]


@lean(F(A, I, N, types.boolean))
def opening(floats, ints, rec, pressed):
    """How fast the gap of a contact grows; ``pressed``: how fast this does by the accelerations that were written."""
    if not pressed:
        return floats[rec + SPEED]
    total = floats[rec + BIAS]
    for side in range(2):
        at = answer_at(ints, int(floats[rec + SHAPE_A + side]))
        for c in range(6):
            total += floats[rec + ROWS + 6 * side + c] * floats[at + c]
    return total


@lean(types.UniTuple(F, 3)(A, I, N, types.boolean))
def lowest(floats, ints, rec, pressed):
    """Where on its circle the gap of a contact opens most slowly, as a direction of the shape's axes x and z, and how
    fast."""
    to = probe_at(ints)
    put_point(floats, ints, rec, to, 0.0, 0.0)
    middle = opening(floats, ints, to, pressed)
    put_point(floats, ints, rec, to, 1.0, 0.0)
    u = opening(floats, ints, to, pressed) - middle
    put_point(floats, ints, rec, to, 0.0, 1.0)
    w = opening(floats, ints, to, pressed) - middle
    slope = math.sqrt(u * u + w * w)
    if slope == 0.0:
        return 0.0, 0.0, middle
    return -u / slope, -w / slope, middle - slope


@lean(N(A, I, N, N))
def row_of(floats, ints, n, k):
    """The first row of a contact."""
    for i in range(n):
        if floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT] == k:
            return i
    return -1


@lean_inlined
def area(floats, f, a, b, c):
    """Twice the area of the triangle of three points of a circle, as seen along its axis."""
    ax, _, az = into(floats, f, *three(floats, a + OWN_A))
    bx, _, bz = into(floats, f, *three(floats, b + OWN_A))
    cx, _, cz = into(floats, f, *three(floats, c + OWN_A))
    return (bx - ax) * (cz - az) - (bz - az) * (cx - ax)


@lean(N(A, I, N, N, N))
def spare(floats, ints, n, k, to):
    """One of four points of the circle of contact k that push, without which the other three can push as much and with
    the same moment (Caratheodory 1911); -1 where not four push. Of two such points the farther from that at ``to``."""
    rec, memory = ints[RECORDS_AT] + RECORD * k, ints[MEMORY_AT]
    f, found, four = int(floats[rec + LINE_A]), solution_at(ints), 0
    a0 = a1 = a2 = a3 = 0
    for j in range(int(floats[memory + KEPT])):
        other = ints[RECORDS_AT] + RECORD * j
        if not same_circle(floats, rec, other) or not floats[found + row_of(floats, ints, n, j)] > 0.0:
            continue
        a0, a1, a2, a3 = a1, a2, a3, j
        four += 1
    if four < 4:
        return -1
    those = (a0, a1, a2, a3)
    # What can be added to their forces without force and moment: of each the area of the other three's triangle.
    best, most = -1, -1.0
    for way in range(2):
        least, which = math.inf, -1
        for i in range(4):
            q, r, u = those[(i + 1) % 4], those[(i + 2) % 4], those[(i + 3) % 4]
            first = ints[RECORDS_AT]
            change = area(floats, f, first + RECORD * q, first + RECORD * r, first + RECORD * u)
            change *= 1.0 if i % 2 == way else -1.0
            if change < 0.0:
                ratio = floats[found + row_of(floats, ints, n, those[i])] / -change
                if ratio < least:
                    least, which = ratio, those[i]
        if which < 0:
            continue
        at, away = ints[RECORDS_AT] + RECORD * which + OWN_A, 0.0
        for c in range(3):
            away += (floats[at + c] - floats[to + OWN_A + c]) ** 2
        if away > most:
            best, most = which, away
    return best


@lean(types.boolean(A, I, N, N, types.boolean))
def exchange(floats, ints, n, k, pressed):
    """Put a point of the circle of contact k where it would sink in; whether it did.

    It is for one of the circle's points that do not push, where there is one.
    """
    rec, memory = ints[RECORDS_AT] + RECORD * k, ints[MEMORY_AT]
    u, w, worst = lowest(floats, ints, rec, pressed)
    if pressed:
        row = row_of(floats, ints, n, k)
        bound = SINKS * floats[sizes_at(ints) + row]
    else:
        a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
        bound = APPROACHES * (STILL + pace(floats, rec, a, b))
    if not worst < -bound or (u == 0.0 and w == 0.0):
        return False
    to = probe_at(ints)
    put_point(floats, ints, rec, to, u, w)
    size = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
    if extent(floats, ints, to) < -LIMIT * size:
        return False
    if pressed:
        a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
        if floats[to + SPEED] > LEAVES * pace(floats, to, a, b) or floats[to + GAP] > OPEN * size:
            return False
    count, slot, most = 0, -1, 0.0
    for j in range(int(floats[memory + KEPT])):
        other = ints[RECORDS_AT] + RECORD * j
        if not same_circle(floats, rec, other):
            continue
        away = 0.0
        for c in range(3):
            away = max(away, abs(floats[other + OWN_A + c] - floats[to + OWN_A + c]))
        if away <= SAME * size:
            return False
        count += 1
        row = row_of(floats, ints, n, j) if pressed else 0
        opens = floats[left_at(ints) + row] if pressed else floats[other + SPEED]
        if opens > most and not (pressed and floats[solution_at(ints) + row] > 0.0):
            slot, most = j, opens
    if slot < 0 and pressed and floats[memory + SPARING] > 0.0:
        slot = spare(floats, ints, n, k, to)
    if slot < 0:
        if count >= FEW or floats[memory + KEPT] >= ints[MOST]:
            return False
        slot = int(floats[memory + KEPT])
        floats[memory + KEPT] += 1.0
    there = ints[RECORDS_AT] + RECORD * slot
    for c in range(RECORD):
        floats[there + c] = floats[to + c]
    put(floats, there + FORCE, 0.0, 0.0, 0.0)
    return True


@lean(types.boolean(A, I, N, types.boolean))
def exchange_all(floats, ints, n, pressed):
    """Put points of all circles where they would sink in; whether there was one.

    ``pressed``: by the accelerations of a solution of n rows, else by the speeds of the kept contacts.
    """
    count, some, asked = int(floats[ints[MEMORY_AT] + KEPT]), False, False
    for k in range(count):
        rec = ints[RECORDS_AT] + RECORD * k
        if not is_rim(floats, rec) or not first_of_circle(floats, ints, k):
            continue
        if pressed and not asked:
            answer(floats, ints, n)
            asked = True
        some = exchange(floats, ints, n, k, pressed) or some
    return some


@lean(types.void(A, I, types.boolean))
def save(floats, ints, back):
    """Copy the kept contacts aside; ``back``: from there, with how many they were."""
    memory, most = ints[MEMORY_AT], ints[MOST]
    count_at = probe_at(ints) + RECORD
    if back:
        floats[memory + KEPT] = floats[count_at]
    else:
        floats[count_at] = floats[memory + KEPT]
    mine, other = ints[RECORDS_AT], ints[RECORDS_AT] + RECORD * most
    for c in range(RECORD * int(floats[memory + KEPT])):
        if back:
            floats[mine + c] = floats[other + c]
        else:
            floats[other + c] = floats[mine + c]


@lean_inlined
def movers_of(floats, ints, rec):
    """Where the movers of a contact begin."""
    return mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))


@lean(types.UniTuple(F, 3)(A, I, N))
def tilt(floats, ints, rec):
    """How a ring or column, of which a contact touches a face, is tilted there: as a vector of its own axes, across the
    axis, which is 0 where it lies flat."""
    f, (a, b) = int(floats[rec + LINE_A]), movers_of(floats, ints, rec)
    nx, ny, nz = turned(floats, b + AT_TURN, *three(floats, rec + LINE_B))
    x, _, z = into(floats, f, *own(floats, a, -nx, -ny, -nz))
    return x, 0.0, z


@lean(F(A, I, N))
def lying(floats, ints, rec):
    """How far a contact is from lying flat [m]: below 0 once its place on the circle has turned by 60 degrees.

    One that falls through the flat is on the other side of its circle at once. One that falls past it runs round its
    circle, the faster the nearer it is to the flat: it is followed by such events.
    """
    tilted = floats[rec + OWN_A] != 0.0 or floats[rec + OWN_A + 2] != 0.0
    if floats[rec + KIND] != ON_FACE or not tilted:
        return math.inf
    size = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
    x, _, z = tilt(floats, ints, rec)
    return size * (x * floats[rec + OWN_A] + z * floats[rec + OWN_A + 2] - 0.5 * math.sqrt(x * x + z * z))


@lean(types.boolean(A, I, N))
def lands(floats, ints, rec):
    """Whether a contact comes to lie flat now: an event, which is due."""
    size = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
    return lying(floats, ints, rec) <= LANDS * size


@lean(types.void(A, I, N))
def begin_tilt(floats, ints, rec):
    """Keep how a contact is tilted, so that its lying flat is seen."""
    if (
        floats[rec + KIND] != ON_FACE
        or floats[int(floats[rec + LINE_A]) + FORM] == ELLIPSOID
        or lands(floats, ints, rec)
    ):
        return
    x, y, z = tilt(floats, ints, rec)
    size = math.sqrt(x * x + z * z)
    by = 1.0 / size if 0.0 < size < STEEP else 0.0
    put(floats, rec + OWN_A, by * x, by * y, by * z)


@lean(types.boolean(A, I, N, N))
def lies(floats, ints, pair, before):
    """Whether a circle of a pair lay flat at the end of the step before, held by three points or more, and does so; or
    comes to lie now, which is an event."""
    pushed = 0
    for j in range(before):
        rec = ints[RECORDS_AT] + RECORD * j
        if floats[rec + PAIR] != pair:
            continue
        if floats[rec + KIND] == ON_FACE and lands(floats, ints, rec):
            return True
        if not is_rim(floats, rec):
            return False
        size = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
        if extent(floats, ints, rec) < LIMIT * size:
            return False
        pushed += floats[rec + PUSHES] > 0.0
    return pushed >= 3
