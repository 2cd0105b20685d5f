# mypy: ignore-errors
"""Contacts of rigid bodies as rows of a cone program: their velocities, their impulses, the matrix of Newton's method.

A contact has a frame of three rows: its normal over the coefficient of friction, and two tangents (without friction the
normal alone). In these, with u its velocity and r its impulse, s = (u_N / mu, u_T) and x = (mu r_N, r_T): Coulomb's
cone and its dual are both x_0 >= |x_T|, and s . x = u . r.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.multifrontal_general_kernels import factor_general, solve_general
from sceneql.system.signatures_kernels import A, F, I, N

BODIES, CONTACTS, PAIRS_AT, CONTACT_INTS_AT, DIAGONAL_AT, PLAN_AT, PLAN, BODIES_AT, CONTACTS_AT, VALUES_AT = range(10)
VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, RESULT_AT, TRIES, ITERATIONS, FINISHES, HEAD = range(10, 21)
"""Integers of a program: numbers of bodies and (to be written) of contacts; where its pairs, its contacts' pairs (to be
written), the places of the diagonal's blocks and the plan begin; offsets into the floats, and sizes; how many
factorizations may be tried from the guess (to be written); then what a solution took: iterations of the interior-point
method, and factorizations of Newton's method besides."""

PAIR_A, PAIR_B, PAIR_AB, PAIR_BA, PAIR = range(5)
"""Integers of a pair: its bodies (-1: one that is fixed or led), the places of its two blocks beside the diagonal."""

AT_MASS, AT_INERTIA, AT_FREE, AT_V, AT_D, AT_LEFT, AT_FORCE, AT_TORQUE, AT_INVERSE, AT_OLD, BODY = (
    0, 1, 10, 16, 22, 28, 34, 35, 36, 45, 51
)  # fmt: skip
"""Floats of a body. Given: mass, inertia about its center in the world's axes (3, 3), velocity and angular velocity
without contacts. Found: both with contacts (given: a guess). Scratch: a direction, what is left of the momenta's
equations, sizes of the momenta and angular momenta in these, the inverse inertia, velocities to come back to."""

AT_NORMAL, AT_ARM_A, AT_ARM_B, AT_FRICTION, AT_GIVEN, AT_IMPULSE, AT_VELOCITY, AT_FRAME, AT_X, AT_S = (
    0, 3, 6, 9, 10, 13, 16, 19, 28, 31
)  # fmt: skip
AT_DX, AT_DS, AT_Q, AT_LAMBDA, AT_W, AT_ETA, AT_H, AT_B, AT_R, AT_HEAVY = 34, 37, 40, 43, 46, 49, 50, 59, 62, 65
AT_SIZE, AT_OLD_X, AT_SLIDE, AT_SLIP, AT_SLOPE, CONTACT = 66, 67, 73, 75, 76, 77
"""Floats of a contact. Given: normal from b to a, arms from the bodies' centers, coefficient of friction, what is added
to the velocity of a against b: the gap over the step along the normal (or the velocity after a bounce, reversed), less
the velocity of a led body. Found, in the world: impulse on a (given: a guess) and velocity with what was added.
Scratch: frame (3, 3), x, s, their changes, right hand side, scaled point, scaling (3, 1), matrix (3, 3), given velocity
in the frame, what is left of s, effective mass, size of the velocities, x and s to come back to, direction of slip (2),
slip, its change."""

RESIDUAL, OVERLAP, BALANCE, RESULT = range(4)
"""Floats that are found: what is left of the equations, of the size of the numbers in them; the largest velocity with
which a contact still closes [m/s]; what is left with each contact's power in place of its law."""

USUAL_TRIES = 4
"""Factorizations that are tried from the guess, by default."""

OTHERS = 1e-2
"""Part of the largest velocity below which one counts as 0 when sizes are compared."""

PRODUCT = types.void(A, I, N, N)


@lean_inlined
def cross(ax, ay, az, bx, by, bz):
    """The vector product."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@lean_inlined
def turned(floats, at, x, y, z):
    """The 3x3 matrix at floats[at:] times a vector."""
    return (
        floats[at] * x + floats[at + 1] * y + floats[at + 2] * z,
        floats[at + 3] * x + floats[at + 4] * y + floats[at + 5] * z,
        floats[at + 6] * x + floats[at + 7] * y + floats[at + 8] * z,
    )


@lean_inlined
def put(floats, at, x, y, z):
    """Write a vector."""
    floats[at], floats[at + 1], floats[at + 2] = x, y, z


@lean_inlined
def add(floats, at, sign, x, y, z):
    """Add or subtract a vector."""
    floats[at] += sign * x
    floats[at + 1] += sign * y
    floats[at + 2] += sign * z


@lean_inlined
def pair_of(ints, k):
    """Where the integers of a contact's pair are."""
    return ints[PAIRS_AT] + PAIR * ints[ints[CONTACT_INTS_AT] + k]


@lean_inlined
def point_speed(floats, ints, body, at, arm):
    """Velocity of a point of a body by the six numbers ``at``; 0 for one that is fixed."""
    if body < 0:
        return 0.0, 0.0, 0.0
    to = ints[BODIES_AT] + BODY * body + at
    x, y, z = cross(floats[to + 3], floats[to + 4], floats[to + 5], floats[arm], floats[arm + 1], floats[arm + 2])
    return floats[to] + x, floats[to + 1] + y, floats[to + 2] + z


@lean(PRODUCT)
def to_contacts(floats, ints, of, at):
    """J times the bodies' six numbers ``of``, in the contacts' frames, to ``at``."""
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        ax, ay, az = point_speed(floats, ints, ints[pair + PAIR_A], of, c + AT_ARM_A)
        bx, by, bz = point_speed(floats, ints, ints[pair + PAIR_B], of, c + AT_ARM_B)
        put(floats, c + at, *turned(floats, c + AT_FRAME, ax - bx, ay - by, az - bz))


@lean_inlined
def in_world(floats, frame, x, y, z):
    """A vector of a contact's frame (its rows) in the world."""
    return (
        floats[frame] * x + floats[frame + 3] * y + floats[frame + 6] * z,
        floats[frame + 1] * x + floats[frame + 4] * y + floats[frame + 7] * z,
        floats[frame + 2] * x + floats[frame + 5] * y + floats[frame + 8] * z,
    )


@lean(types.void(A, I, N, N, F))
def to_bodies(floats, ints, of, at, sign):
    """Adds sign J^T times the contacts' three numbers ``of`` to the bodies' six ``at``."""
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        x, y, z = floats[c + of], floats[c + of + 1], floats[c + of + 2]
        if x == 0.0 and y == 0.0 and z == 0.0:
            continue
        fx, fy, fz = in_world(floats, c + AT_FRAME, x, y, z)
        for side in range(2):
            body = ints[pair + side]
            if body >= 0:
                to, arm = ints[BODIES_AT] + BODY * body + at, c + AT_ARM_A + 3 * side
                way = sign if side == 0 else -sign
                add(floats, to, way, fx, fy, fz)
                add(floats, to + 3, way, *cross(floats[arm], floats[arm + 1], floats[arm + 2], fx, fy, fz))


@lean(types.void(A, I))
def momenta_left(floats, ints):
    """What is left of M (v - v_free) = J^T x, reversed, to AT_LEFT; the sizes of what that is a sum of."""
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        mass, force, torque = floats[at + AT_MASS], 0.0, 0.0
        for c in range(3):
            v, free = floats[at + AT_V + c], floats[at + AT_FREE + c]
            floats[at + AT_LEFT + c] = mass * (free - v)
            force += mass * (abs(free) + abs(v))
            whole = 0.0
            for j in range(3):
                w, loose = floats[at + AT_V + 3 + j], floats[at + AT_FREE + 3 + j]
                inertia = floats[at + AT_INERTIA + 3 * c + j]
                whole += inertia * (loose - w)
                torque += abs(inertia) * (abs(loose) + abs(w))
            floats[at + AT_LEFT + 3 + c] = whole
        floats[at + AT_FORCE], floats[at + AT_TORQUE] = force, torque
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        x, y, z = in_world(floats, c + AT_FRAME, floats[c + AT_X], floats[c + AT_X + 1], floats[c + AT_X + 2])
        size = abs(x) + abs(y) + abs(z)
        for side in range(2):
            body = ints[pair + side]
            if body >= 0:
                at, arm = ints[BODIES_AT] + BODY * body, c + AT_ARM_A + 3 * side
                floats[at + AT_FORCE] += size
                floats[at + AT_TORQUE] += size * (abs(floats[arm]) + abs(floats[arm + 1]) + abs(floats[arm + 2]))
    to_bodies(floats, ints, AT_X, AT_LEFT, 1.0)


@lean(types.void(A, N))
def invert(floats, at):
    """The inverse of a body's inertia; 0 where it has none."""
    i = at + AT_INERTIA
    scale = max(floats[i], floats[i + 4], floats[i + 8])
    by = 1.0 / scale if scale > 0.0 else 0.0
    a, b, c = floats[i] * by, floats[i + 4] * by, floats[i + 8] * by
    d, e, f = floats[i + 5] * by, floats[i + 2] * by, floats[i + 1] * by
    u, v, w = b * c - d * d, d * e - f * c, f * d - b * e
    whole = a * u + f * v + e * w
    by = by / whole if whole > 0.0 else 0.0
    put(floats, at + AT_INVERSE, u * by, v * by, w * by)
    put(floats, at + AT_INVERSE + 3, v * by, (a * c - e * e) * by, (e * f - a * d) * by)
    put(floats, at + AT_INVERSE + 6, w * by, (e * f - a * d) * by, (a * b - f * f) * by)


@lean_inlined
def lightness(floats, at, arm, x, y, z):
    """Velocity of a body's point along a direction by an impulse of 1 along it."""
    u, v, w = cross(floats[arm], floats[arm + 1], floats[arm + 2], x, y, z)
    p, q, r = turned(floats, at + AT_INVERSE, u, v, w)
    return 1.0 / floats[at + AT_MASS] + u * p + v * q + w * r


@lean(types.void(A, I))
def prepare(floats, ints):
    """Write the frames, the given velocities and guessed impulses in them, the effective masses."""
    for body in range(ints[BODIES]):
        invert(floats, ints[BODIES_AT] + BODY * body)
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        nx, ny, nz = floats[c + AT_NORMAL], floats[c + AT_NORMAL + 1], floats[c + AT_NORMAL + 2]
        if abs(nx) <= abs(ny) and abs(nx) <= abs(nz):
            tx, ty, tz = 0.0, nz, -ny
        elif abs(ny) <= abs(nz):
            tx, ty, tz = -nz, 0.0, nx
        else:
            tx, ty, tz = ny, -nx, 0.0
        by = 1.0 / math.sqrt(tx * tx + ty * ty + tz * tz)
        tx, ty, tz = tx * by, ty * by, tz * by
        ox, oy, oz = cross(nx, ny, nz, tx, ty, tz)
        light = 0.0
        for side in range(2):
            if ints[pair + side] >= 0:
                at, arm = ints[BODIES_AT] + BODY * ints[pair + side], c + AT_ARM_A + 3 * side
                light += lightness(floats, at, arm, nx, ny, nz)
                light += lightness(floats, at, arm, tx, ty, tz) + lightness(floats, at, arm, ox, oy, oz)
        floats[c + AT_HEAVY] = 3.0 / light
        friction = floats[c + AT_FRICTION]
        rough = 1.0 if friction > 0.0 else 0.0
        mu = friction if friction > 0.0 else 1.0
        frame = c + AT_FRAME
        put(floats, frame, nx / mu, ny / mu, nz / mu)
        put(floats, frame + 3, rough * tx, rough * ty, rough * tz)
        put(floats, frame + 6, rough * ox, rough * oy, rough * oz)
        for given, to in ((c + AT_GIVEN, c + AT_B), (c + AT_IMPULSE, c + AT_X)):
            put(floats, to, *turned(floats, frame, floats[given], floats[given + 1], floats[given + 2]))
        floats[c + AT_X] *= mu * mu


@lean(types.void(A, N, N, N, F, A, N))
def add_block(values, to, one, other, sign, floats, weight):
    """Add the 6x6 block sign J^T H J' of a contact's arms, with H the 3x3 matrix at floats[weight:]."""
    rx, ry, rz = floats[one], floats[one + 1], floats[one + 2]
    qx, qy, qz = floats[other], floats[other + 1], floats[other + 2]
    for i in range(3):
        a, b, c = sign * floats[weight + 3 * i], sign * floats[weight + 3 * i + 1], sign * floats[weight + 3 * i + 2]
        d, e, f = cross(qx, qy, qz, a, b, c)
        row = to + 6 * i
        values[row] += a
        values[row + 1] += b
        values[row + 2] += c
        values[row + 3] += d
        values[row + 4] += e
        values[row + 5] += f
        # (r x .) by the rows: row i of H adds to the two others.
        if i == 0:
            p, q, up, down = to + 24, to + 30, rz, -ry
        elif i == 1:
            p, q, up, down = to + 30, to + 18, rx, -rz
        else:
            p, q, up, down = to + 18, to + 24, ry, -rx
        values[p] += up * a
        values[p + 1] += up * b
        values[p + 2] += up * c
        values[p + 3] += up * d
        values[p + 4] += up * e
        values[p + 5] += up * f
        values[q] += down * a
        values[q + 1] += down * b
        values[q + 2] += down * c
        values[q + 3] += down * d
        values[q + 4] += down * e
        values[q + 5] += down * f


@lean(types.void(A, I))
def assemble(floats, ints):
    """M + J^T H J, with the contacts' matrices H at AT_H; DX and DS are overwritten."""
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    for k in range(values.size):
        values[k] = 0.0
    for body in range(ints[BODIES]):
        at, to = ints[BODIES_AT] + BODY * body, ints[ints[DIAGONAL_AT] + body]
        for i in range(3):
            values[to + 7 * i] = floats[at + AT_MASS]
            for j in range(3):
                values[to + 21 + 6 * i + j] = floats[at + AT_INERTIA + 3 * i + j]
    # Nine numbers that no one reads any more: DX, DS and Q of the contact.
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        h, frame, world = c + AT_H, c + AT_FRAME, c + AT_DX
        a, b = ints[pair + PAIR_A], ints[pair + PAIR_B]
        for i in range(3):
            x, y, z = floats[frame + i], floats[frame + 3 + i], floats[frame + 6 + i]
            p = x * floats[h] + y * floats[h + 3] + z * floats[h + 6]
            q = x * floats[h + 1] + y * floats[h + 4] + z * floats[h + 7]
            r = x * floats[h + 2] + y * floats[h + 5] + z * floats[h + 8]
            put(floats, world + 3 * i, *in_world(floats, frame, p, q, r))
        if a >= 0:
            add_block(values, ints[ints[DIAGONAL_AT] + a], c + AT_ARM_A, c + AT_ARM_A, 1.0, floats, world)
        if b >= 0:
            add_block(values, ints[ints[DIAGONAL_AT] + b], c + AT_ARM_B, c + AT_ARM_B, 1.0, floats, world)
        if a >= 0 and b >= 0:
            add_block(values, ints[pair + PAIR_AB], c + AT_ARM_A, c + AT_ARM_B, -1.0, floats, world)
            add_block(values, ints[pair + PAIR_BA], c + AT_ARM_B, c + AT_ARM_A, -1.0, floats, world)


@lean(types.boolean(A, I))
def factor(floats, ints):
    """Assemble and factor the matrix of Newton's method, which is symmetric where nothing slides, at most."""
    assemble(floats, ints)
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    return factor_general(plan, values, factors, work)


@lean(types.void(A, I, N))
def step(floats, ints, left):
    """Solve for the bodies' D by the factors, with J^T DX (and their numbers ``left``) on the right; DS = J D."""
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for c in range(6):
            floats[at + AT_D + c] = floats[at + left + c] if left > 0 else 0.0
    to_bodies(floats, ints, AT_DX, AT_D, 1.0)
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + 6 * ints[BODIES]]
    for body in range(ints[BODIES]):
        for c in range(6):
            right[6 * body + c] = floats[ints[BODIES_AT] + BODY * body + AT_D + c]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    solve_general(plan, factors, right, work)
    for body in range(ints[BODIES]):
        for c in range(6):
            floats[ints[BODIES_AT] + BODY * body + AT_D + c] = right[6 * body + c]
    to_contacts(floats, ints, AT_D, AT_DS)


@lean(types.void(A, I))
def keep(floats, ints):
    """Keep v, x and s."""
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for c in range(6):
            floats[at + AT_OLD + c] = floats[at + AT_V + c]
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        for j in range(6):
            floats[c + AT_OLD_X + j] = floats[c + AT_X + j]


@lean(types.void(A, I))
def fetch(floats, ints):
    """Take v, x and s back as they were kept."""
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for c in range(6):
            floats[at + AT_V + c] = floats[at + AT_OLD + c]
    for k in range(ints[CONTACTS]):
        c = ints[CONTACTS_AT] + CONTACT * k
        for j in range(6):
            floats[c + AT_X + j] = floats[c + AT_OLD_X + j]


@lean_inlined
def fastness(floats, ints, body, at, arm):
    """Size of the velocity of a body's point by the six numbers ``at``."""
    if body < 0:
        return 0.0
    to = ints[BODIES_AT] + BODY * body + at
    long = abs(floats[arm]) + abs(floats[arm + 1]) + abs(floats[arm + 2])
    straight = abs(floats[to]) + abs(floats[to + 1]) + abs(floats[to + 2])
    return straight + long * (abs(floats[to + 3]) + abs(floats[to + 4]) + abs(floats[to + 5]))


@lean(types.void(A, I))
def sizes(floats, ints):
    """Write the size of each contact's velocities: what they are sums of, and OTHERS of the largest one."""
    fastest = 1e-300
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        size = abs(floats[c + AT_GIVEN]) + abs(floats[c + AT_GIVEN + 1]) + abs(floats[c + AT_GIVEN + 2])
        for side in range(2):
            body, arm = ints[pair + side], c + AT_ARM_A + 3 * side
            size += fastness(floats, ints, body, AT_FREE, arm) + fastness(floats, ints, body, AT_V, arm)
        floats[c + AT_SIZE] = size
        fastest = max(fastest, size)
    for k in range(ints[CONTACTS]):
        floats[ints[CONTACTS_AT] + CONTACT * k + AT_SIZE] += OTHERS * fastest
