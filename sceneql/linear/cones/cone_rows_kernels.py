# mypy: ignore-errors
"""Contacts of rigid bodies as rows of a cone program: their velocities, their impulses, the matrix of Newton's method.

A contact has a frame of three rows: its normal over the coefficient of friction, and two tangents (without friction the
normal alone). In these, with u its velocity and r its impulse, s = (u_N / mu, u_T) and x = (mu r_N, r_T): Coulomb's
cone and its dual are both x_0 >= |x_T|, and s . x = u . r.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.cones.cone_layout_kernels import (
    AT_ARM_A,
    AT_ARM_B,
    AT_D,
    AT_DS,
    AT_DX,
    AT_FORCE,
    AT_FRAME,
    AT_FREE,
    AT_GIVEN,
    AT_H,
    AT_INERTIA,
    AT_LEFT,
    AT_MASS,
    AT_OLD,
    AT_OLD_X,
    AT_SIZE,
    AT_TORQUE,
    AT_V,
    AT_X,
    BODIES,
    BODIES_AT,
    BODY,
    CONTACT,
    CONTACT_INTS_AT,
    CONTACTS,
    CONTACTS_AT,
    DIAGONAL_AT,
    FACTORS,
    FACTORS_AT,
    FEW,
    OTHERS,
    PAIR,
    PAIR_A,
    PAIR_AB,
    PAIR_B,
    PAIR_BA,
    PAIRS_AT,
    PLAN,
    PLAN_AT,
    RIGHT_AT,
    ROW_DS,
    ROW_DX,
    ROWS,
    VALUES,
    VALUES_AT,
    WORK,
    WORK_AT,
    add_rows,
    fetch_rows,
    floor_sizes,
    from_rows,
    keep_rows,
    momenta_of_rows,
    sizes_of_rows,
    to_rows,
)
from sceneql.linear.multifrontal.entries_kernels import FACTOR_GENERAL, SOLVE_GENERAL
from sceneql.system.signatures_kernels import A, F, I, N

# Compiled at the first program of many bodies, or of few.
factor_many = lazy("sceneql.linear.multifrontal.general_kernels:factor_general", FACTOR_GENERAL)
solve_many = lazy("sceneql.linear.multifrontal.general_kernels:solve_general", SOLVE_GENERAL)
factor_few = lazy("sceneql.linear.cones.cone_few_kernels:factor_few", types.boolean(A, I, A))
solve_few = lazy("sceneql.linear.dense_kernels:solve", types.void(A, N, I, A))

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
    if ints[ROWS] > 0:
        momenta_of_rows(floats, ints)


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
    if ints[ROWS] > 0:
        add_rows(values, floats, ints)


@lean(types.boolean(A, I))
def factor(floats, ints):
    """Assemble and factor the matrix of Newton's method, which is symmetric where nothing slides, at most."""
    assemble(floats, ints)
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    if ints[BODIES] <= FEW:
        return factor_few(values, ints, factors)
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    return factor_many(ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]], values, factors, work)


@lean(types.void(A, I, N))
def step(floats, ints, left):
    """Solve for the bodies' D by the factors, with J^T DX (and their numbers ``left``) on the right; DS = J D."""
    for body in range(ints[BODIES]):
        at = ints[BODIES_AT] + BODY * body
        for c in range(6):
            floats[at + AT_D + c] = floats[at + left + c] if left > 0 else 0.0
    to_bodies(floats, ints, AT_DX, AT_D, 1.0)
    if ints[ROWS] > 0:
        from_rows(floats, ints, ROW_DX, AT_D)
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + 6 * ints[BODIES]]
    for body in range(ints[BODIES]):
        for c in range(6):
            right[6 * body + c] = floats[ints[BODIES_AT] + BODY * body + AT_D + c]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    if ints[BODIES] <= FEW:
        solve_few(factors, right.size, plan, right)
    else:
        solve_many(plan, factors, right, floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]])
    for body in range(ints[BODIES]):
        for c in range(6):
            floats[ints[BODIES_AT] + BODY * body + AT_D + c] = right[6 * body + c]
    to_contacts(floats, ints, AT_D, AT_DS)
    if ints[ROWS] > 0:
        to_rows(floats, ints, AT_D, ROW_DS)


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
    if ints[ROWS] > 0:
        keep_rows(floats, ints)


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
    if ints[ROWS] > 0:
        fetch_rows(floats, ints)


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
    fastest = max(1e-300, sizes_of_rows(floats, ints)) if ints[ROWS] > 0 else 1e-300
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
    if ints[ROWS] > 0:
        floor_sizes(floats, ints, OTHERS * fastest)
