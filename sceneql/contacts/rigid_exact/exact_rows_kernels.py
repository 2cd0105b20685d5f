# mypy: ignore-errors
"""The rows of an island's exact contacts and ties together, as one dense system (exact_law_kernels)."""

from numba import types

from sceneql.bodies.rigid.ties.tie_kernels import survey
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_A,
    AT_BIAS,
    AT_C,
    AT_INVERSE,
    AT_J,
    AT_MASS,
    AT_SPEED,
    AT_TWIST,
    AT_V,
    AT_W,
    AT_X,
    MOMENTUM,
    MOVED,
    MOVER,
    POSITION,
    ROTATION,
    TURN,
    VELOCITY,
    put,
    see,
    turned,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.core_kernels import KIND as CORE_KIND
from sceneql.contacts.rigid_exact.contact_kernels import (
    AIMED,
    BIAS,
    FORCE,
    GAP,
    KIND,
    POINT,
    PUSHES,
    RECORD,
    ROWS,
    SHAPE_A,
    SHAPE_B,
    SLIDE,
    SLIDES,
    SPEED,
    TURN_AIMED,
    dot,
    pace,
    three,
)
from sceneql.contacts.rigid_exact.curved import CURVED
from sceneql.contacts.rigid_exact.curved_contact_kernels import follow
from sceneql.contacts.rigid_exact.exact_law_kernels import ACROSS, ALONG, BILATERAL, UNILATERAL, VECTORS
from sceneql.contacts.rigid_exact.exact_law_kernels import NORMAL as CONE
from sceneql.contacts.rigid_exact.stop_kernels import DRIVEN, STOP
from sceneql.system.signatures_kernels import A, F, I, N

see_motion = lazy("sceneql.contacts.rigid_exact.motion_kernels:see_motion", types.void(A, A, I, N))

MOVERS, SHAPES, BODIES, PAIRS, TIE_ROWS, MOST, TIES, ROOM = range(8)
SHAPES_AT, MOVERS_AT, PAIRS_AT, TIES_AT, TIED_AT, KINDS_AT, WORKS_AT = range(8, 15)
MOVED_AT, PLACES_AT, BEGUN_AT, ROOM_AT, RECORDS_AT, UNITS_AT, DENSE_AT, KEPT_AT, MEMORY_AT = range(15, 24)
RESTITUTION_AT, FRICTION_AT, ROLLING_AT, COUNT_AT, POINTS_AT, NORMALS_AT, FORCES_AT, TALLY_AT, WHO_AT = range(24, 33)
DRIVES, DRIVES_AT, DRIVEN_AT, ROWS_ROOM, HEAD = range(33, 38)
"""Integers of an island's exact contacts. Numbers of movers (the shapes in order, of which those that move come first,
then what else is tied), of shapes, of those that move, of pairs, of rows of ties; room for contacts; how many integers
the ties have; floats of working memory of distances. Where in the integers stand the shapes (convex.SHAPE), the movers
(tie_rows_kernels), two shapes a pair, the ties' own integers, of each of their rows both movers and its floats, room
for kinds of rows, pivots and which contacts are struck, where the energy taken from each mover counts. Offsets in the
floats: movers, places of shapes, those at the start of the step, working memory, contacts (twice), rows, the dense
system, how many contacts each pair keeps (then of each pair how crowded its events are, and when it had its latest; how
deep each may be), memory, coefficients, what outputs read. Where in the integers is room for a question about curved
shapes (curved_find_kernels). How many ties have stops, a motor or friction, where it stands where the integers of each
begin and end (motion_kernels), their floats (stop_kernels); room for rows. Behind the pairs are counted both stops of
each of these ties."""

(
    KEPT,
    UNDECIDED,
    SINCE,
    STARTED,
    BEGUN,
    LOOSE,
    CROWDED,
    LATEST,
    AGAIN,
    JAMMED,
    COUNTED,
    WORK,
    PASSED,
    SPARING,
    BOUNDED,
    MEMORY,
) = range(16)
"""Memory: how many contacts are kept; whether it is open which of them slide or leave; since when they are these [s];
whether it has begun; when the step began [s]; solutions that were not found to rounding, contacts without room;
when the latest event was [s], and how many there were at that instant before;
instants at which slip jammed, and those whose energy is counted; work done; whether the end of the step before was
left alone; whether a circle that lies flat has few points (rim_kernels); whether work is bounded."""
BEFOREHAND, A_SECOND = 1e9, 2e8
"""Work that is allowed at the start, and by the second: operations, about as many as nanoseconds of one processor. As
much as a few steps of mode `local` take in each 1/240 s."""
A_PAIR, A_COLUMN, A_ROW, AN_ADVANCE = 3000.0, 3e4, 100.0, 4000.0
"""Work of a pair that is looked at, of one of two curved bodies, of a row that is written; of an advance of a pair."""
PATIENCE, ENDURANCE = 20, 200
"""Events at one instant after which no contact is let go any more; after which there is no way on."""

PLACE, WATCHED = 7, 3
"""Floats of a place; events that each contact is watched for: it slips no more, it leaves its feature, it turns no
more."""
AT_ROW, AT_PUSH, AT_WEIGHED, AT_FIRST, AT_SECOND, AT_CONTACT, UNIT = 0, 12, 24, 36, 37, 38, 39
"""Floats of a row of the system: by velocities of both movers; by forces on both; these over the masses; both movers,
and the contact (-1: a tie's)."""

FORCES, SPEEDS, GAPS, IMPACTS = range(4)
"""What is solved for: forces by accelerations; what is left of speeds and of gaps; impulses of contacts that are
marked."""


@lean_inlined
def core_at(ints, b):
    """Where a shape begins as others meet it: of a column its axis with a radius (curved_meet_kernels)."""
    shape = ints[SHAPES_AT] + SHAPE * b
    return shape + SHAPE * ints[SHAPES] if ints[shape + CORE_KIND] == CURVED else shape


@lean_inlined
def spots(ints):
    """How many pairs and stops there are."""
    return ints[PAIRS] + 2 * ints[DRIVES]


@lean_inlined
def driven_at(ints, d):
    """Where the floats of the motion of a tie that has stops, a motor or friction begin."""
    return ints[DRIVEN_AT] + DRIVEN * d


@lean_inlined
def mover_at(ints, m):
    """Where the floats of a mover begin."""
    return ints[MOVED_AT] + MOVED * m


@lean_inlined
def pull_at(ints, m):
    """Where the accelerations of a mover stand by all forces but those of contacts, of the latest rate."""
    return ints[MOVED_AT] + MOVED * ints[MOVERS] + 6 * m


@lean_inlined
def answer_at(ints, m):
    """Where the accelerations of a mover stand by all forces (rim_kernels)."""
    return ints[MOVED_AT] + (MOVED + 6) * ints[MOVERS] + 6 * m


@lean_inlined
def look_at_motions(y, floats, ints):
    """Write what a state says of the motions of ties that have stops, a motor or friction."""
    for d in range(ints[DRIVES]):
        see_motion(y, floats, ints[ints[ints[DRIVES_AT] + d] : ints[ints[DRIVES_AT] + d + 1]], driven_at(ints, d))


@lean(types.void(F, A, A, I))
def look(t, y, floats, ints):
    """Write movers, and rows of ties, of a state."""
    for m in range(ints[MOVERS]):
        see(y, floats, mover_at(ints, m), ints, ints[MOVERS_AT] + MOVER * m)
    look_at_motions(y, floats, ints)
    if ints[TIES] > 0:
        survey(t, y, floats, ints[ints[TIES_AT] : ints[TIES_AT] + ints[TIES]])


@lean(types.void(A, A, I, N))
def put_places(y, floats, ints, to):
    """Write where the shapes are to floats[to:]."""
    for k in range(ints[SHAPES]):
        at = ints[MOVERS_AT] + MOVER * k
        put(floats, to + PLACE * k, *three(floats, mover_at(ints, k) + AT_X))
        x, q = ints[at + POSITION], ints[at + ROTATION]
        for c in range(4):
            given = floats[ints[at + TURN] + c] if x < 0 else (1.0 if c == 0 else 0.0)
            floats[to + PLACE * k + 3 + c] = y[q + c] if q >= 0 else given


@lean(types.void(A, I, N, N, N, N, N))
def weigh(floats, ints, row, a, b, of, contact):
    """Write what the masses make of the forces of a row, its movers, its contact."""
    at = ints[UNITS_AT] + UNIT * row
    floats[at + AT_FIRST], floats[at + AT_SECOND], floats[at + AT_CONTACT] = a, b, contact
    for side in range(2):
        mover, f, w = mover_at(ints, b if side == 1 else a), at + of + 6 * side, at + AT_WEIGHED + 6 * side
        inverse = floats[mover + AT_MASS]
        put(floats, w, inverse * floats[f], inverse * floats[f + 1], inverse * floats[f + 2])
        put(floats, w + 3, *turned(floats, mover + AT_INVERSE, *three(floats, f + 3)))


@lean_inlined
def pressed(floats, ints, row):
    """A row's speeds times the accelerations of its movers."""
    at, total = ints[UNITS_AT] + UNIT * row, 0.0
    for side in range(2):
        mover = mover_at(ints, int(floats[at + AT_FIRST + side]))
        for c in range(3):
            total += floats[at + AT_ROW + 6 * side + c] * floats[mover + AT_A + c]
            total += floats[at + AT_ROW + 6 * side + 3 + c] * floats[mover + AT_TWIST + c]
    return total


@lean_inlined
def rooms(ints):
    """Room for rows."""
    return ints[ROWS_ROOM]


@lean_inlined
def right_at(ints):
    """Where b begins, behind the matrix."""
    return ints[DENSE_AT] + rooms(ints) * rooms(ints)


@lean_inlined
def solution_at(ints):
    """Where x begins."""
    return right_at(ints) + rooms(ints)


@lean_inlined
def left_at(ints):
    """Where s begins."""
    return right_at(ints) + 2 * rooms(ints)


@lean_inlined
def diagonal_at(ints):
    """Where the diagonal of the matrix begins: what each row's own force does."""
    return right_at(ints) + 3 * rooms(ints)


@lean_inlined
def sizes_at(ints):
    """Where for each row stands the size of the numbers of its group."""
    return right_at(ints) + 4 * rooms(ints)


@lean_inlined
def bounds_at(ints):
    """Where the lower bounds of rows begin, and behind them the upper ones (exact_law_kernels)."""
    return ints[DENSE_AT] + 2 * rooms(ints) * rooms(ints) + (8 + VECTORS) * rooms(ints) + 2


@lean_inlined
def partners_at(ints):
    """Where of each row of a moment stands that of its normal force."""
    return ints[KINDS_AT] + 5 * rooms(ints)


@lean_inlined
def labels_at(ints):
    """Where the integers begin that say of each mover its group."""
    return ints[KINDS_AT] + 6 * rooms(ints)


@lean_inlined
def marked_at(ints):
    """Where the integers begin that say which contacts are struck."""
    return labels_at(ints) + ints[MOVERS]


@lean(N(A, I, N, F))
def write_rows(floats, ints, what, friction):
    """Write the rows for FORCES, SPEEDS, GAPS or IMPACTS, with the right hand side and a guess; how many they are."""
    kinds, n = ints[KINDS_AT], 0
    marked, right, guess, sizes = marked_at(ints), right_at(ints), solution_at(ints), sizes_at(ints)
    for r in range(ints[TIE_ROWS]):
        tied = ints[TIED_AT] + 3 * r
        at, to = ints[UNITS_AT] + UNIT * n, ints[tied + 2]
        for c in range(12):
            floats[at + AT_ROW + c] = floats[at + AT_PUSH + c] = floats[to + AT_J + c]
        weigh(floats, ints, n, ints[tied], ints[tied + 1], AT_PUSH, -1)
        ints[kinds + n] = BILATERAL
        if what == FORCES:
            floats[right + n] = floats[to + AT_BIAS] + pressed(floats, ints, n)
        elif what == GAPS:
            floats[right + n] = floats[to + AT_C]
        else:
            floats[right + n] = floats[to + AT_SPEED]
        floats[guess + n] = floats[sizes + n] = 0.0
        n += 1
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        a, b = int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B])
        slides, pushes = floats[rec + SLIDES] > 0.0, floats[rec + PUSHES] > 0.0
        if what == IMPACTS and ints[marked + k] == 0:
            continue
        if what == GAPS and not pushes and floats[rec + GAP] >= 0.0:
            continue
        if what == FORCES:
            slides = floats[rec + AIMED] != 0.0 or floats[rec + AIMED + 1] != 0.0 or floats[rec + AIMED + 2] != 0.0
        stop = floats[rec + KIND] == STOP
        rough = friction > 0.0 and what != GAPS and (what == IMPACTS or not slides) and not stop
        if what == SPEEDS and not pushes:
            rough = False
        rows = 3 if rough else 1
        speeds, extent = pace(floats, rec, mover_at(ints, a), mover_at(ints, b)), 0.0
        for c in range(3):
            for side in range(2):
                x = floats[mover_at(ints, b if side == 1 else a) + AT_X + c]
                extent += abs(x) + abs(floats[rec + POINT + c] - x)
        for j in range(rows):
            at = ints[UNITS_AT] + UNIT * n
            for c in range(12):
                floats[at + AT_ROW + c] = floats[at + AT_PUSH + c] = floats[rec + ROWS + 12 * j + c]
            if what == FORCES and slides and friction > 0.0:
                # Friction against the slip, in the parts of both tangents.
                sx, sy, sz = three(floats, rec + AIMED)
                for e in range(1, 3):
                    row = rec + ROWS + 12 * e
                    part = friction * dot(sx, sy, sz, floats[row], floats[row + 1], floats[row + 2])
                    for c in range(12):
                        floats[at + AT_PUSH + c] -= part * floats[row + c]
            if what == FORCES and j == 0:  # and a moment against the turning
                rolling = floats[ints[ROLLING_AT]]
                for c in range(3):
                    part = rolling * floats[rec + TURN_AIMED + c]
                    floats[at + AT_PUSH + 3 + c] -= part
                    floats[at + AT_PUSH + 9 + c] += part
            weigh(floats, ints, n, a, b, AT_PUSH, k)
            floats[sizes + n] = 0.0
            if what == FORCES:
                floats[right + n] = pressed(floats, ints, n) + floats[rec + BIAS + j]
                floats[guess + n] = floats[rec + FORCE + j]
            else:
                row = rec + ROWS + 12 * j
                sx, sy, sz = three(floats, rec + SLIDE)
                speed = floats[rec + SPEED] if j == 0 else dot(sx, sy, sz, *three(floats, row))
                floats[right + n] = floats[rec + GAP] if what == GAPS else speed
                floats[guess + n] = 0.0
                floats[sizes + n] = extent if what == GAPS else speeds
            kind = UNILATERAL if rows == 1 else (CONE if j == 0 else (ACROSS if j == 1 else ALONG))
            if pushes and (what == GAPS or what == SPEEDS):
                kind = BILATERAL
            ints[kinds + n] = kind
            n += 1
    return n


@lean(types.void(A, A, I, N))
def kick(y, floats, ints, n):
    """Change velocities and angular momenta by the impulses of the rows."""
    for i in range(n):
        at, impulse = ints[UNITS_AT] + UNIT * i, floats[solution_at(ints) + i]
        if impulse == 0.0:
            continue
        for side in range(2):
            mover = ints[MOVERS_AT] + MOVER * int(floats[at + AT_FIRST + side])
            if ints[mover + POSITION] < 0:
                continue
            for c in range(3):
                y[ints[mover + VELOCITY] + c] += impulse * floats[at + AT_WEIGHED + 6 * side + c]
                if ints[mover + ROTATION] >= 0:
                    y[ints[mover + MOMENTUM] + c] += impulse * floats[at + AT_PUSH + 6 * side + 3 + c]


@lean(types.void(A, I))
def follow_all(floats, ints):
    """Write the kept contacts for the state that was looked at."""
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        follow(
            floats, ints, rec, mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
        )


@lean(F(A, A, I, N))
def energy(y, floats, ints, m):
    """Kinetic energy of a mover."""
    at, mover = ints[MOVERS_AT] + MOVER * m, mover_at(ints, m)
    if ints[at + POSITION] < 0 or floats[mover + AT_MASS] == 0.0:
        return 0.0
    total = 0.0
    for c in range(3):
        total += floats[mover + AT_V + c] ** 2 / floats[mover + AT_MASS]
        if ints[at + ROTATION] >= 0:
            total += floats[mover + AT_W + c] * y[ints[at + MOMENTUM] + c]
    return 0.5 * total


@lean(types.void(A, A, I, F))
def count_energy(y, floats, ints, by):
    """Add the kinetic energy of each body, times ``by``, to what contacts have taken."""
    for m in range(ints[MOVERS]):
        work = ints[ints[WORKS_AT] + m]
        if work >= 0:
            y[work] += by * energy(y, floats, ints, m)
