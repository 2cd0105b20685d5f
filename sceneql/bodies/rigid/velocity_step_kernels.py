# mypy: ignore-errors
"""A step of rigid bodies by their velocities at its end, once a cone program has these (Moreau 1988)."""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import times_symmetric, to_body, to_world
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A, F, I, N

X_AT, V_AT, Q_AT, L_AT, MASS_AT, INERTIA_AT, WORK_AT, BODY_INTS = range(8)
"""Integers of a body: offsets of position, velocity, quaternion and angular momentum in y (-1: a mass, which has none),
of its mass and of its inertia (xx, yy, zz, yz, xz, xy) in the floats, of the work in y."""


@lean(types.void(A, N, A, N, A, N))
def inertia_of(y, q, floats, at, out, to):
    """Write the inertia in the world's axes (3, 3) to out[to:]."""
    for c in range(3):
        e = (1.0 * (c == 0), 1.0 * (c == 1), 1.0 * (c == 2))
        if q >= 0:
            column = to_world(y, q, *times_symmetric(floats, at, *to_body(y, q, *e)))
        else:
            column = times_symmetric(floats, at, *e)
        out[to + c], out[to + 3 + c], out[to + 6 + c] = column


@lean_inlined
def spin_by(inertia, at, x, y, z):
    """The angular velocity of an angular momentum, by the inertia (3, 3) at inertia[at:]."""
    a, b, c = inertia[at], inertia[at + 1], inertia[at + 2]
    d, e, f = inertia[at + 4], inertia[at + 5], inertia[at + 8]
    # The cofactors of a symmetric matrix.
    p, q, r = d * f - e * e, c * e - b * f, b * e - c * d
    s, t, u = a * f - c * c, b * c - a * e, a * d - b * b
    det = a * p + b * q + c * r
    return (p * x + q * y + r * z) / det, (q * x + s * y + t * z) / det, (r * x + t * y + u * z) / det


@lean(types.void(A, A, A, A, I, N, A, N, A, A, N))
def gather(y, y0, y1, floats, ints, own, masses, at, free, before, of):
    """Write mass and inertia in a state y of a body to masses[at:], its velocities at both ends of the step.

    All velocities are by that inertia: those at the start of the step, y0, go to before[of:], at the end to free[of:].
    """
    v, q, momentum = ints[own + V_AT], ints[own + Q_AT], ints[own + L_AT]
    masses[at] = floats[ints[own + MASS_AT]]
    inertia_of(y, q, floats, ints[own + INERTIA_AT], masses, at + 1)
    for state, to in ((y0, before), (y1, free)):
        for c in range(3):
            to[of + c], to[of + 3 + c] = state[v + c], 0.0
        if q >= 0:
            wx, wy, wz = spin_by(masses, at + 1, state[momentum], state[momentum + 1], state[momentum + 2])
            to[of + 3], to[of + 4], to[of + 5] = wx, wy, wz


@lean(types.void(A, N, F, F, F))
def turn(y, q, x, y_, z):
    """Turn a quaternion by a rotation vector of the world [rad]."""
    angle = math.sqrt(x * x + y_ * y_ + z * z)
    s = 0.5 * (math.sin(0.5 * angle) / (0.5 * angle) if angle > 1e-8 else 1.0)
    a, b, c, d = y[q], y[q + 1], y[q + 2], y[q + 3]
    e, f, g, k = math.cos(0.5 * angle), s * x, s * y_, s * z
    y[q] = e * a - f * b - g * c - k * d
    y[q + 1] = e * b + f * a + g * d - k * c
    y[q + 2] = e * c + g * a + k * b - f * d
    y[q + 3] = e * d + k * a + f * c - g * b


@lean(types.void(F, A, A, I, N, A, A, N, N))
def place(h, start, y1, ints, own, found, free, of, mean):
    """Write place and rotation of a body at the end of the step, from those in a state ``start``.

    By its velocities with impulses, from the start of the step; or (``mean`` 1) by half of what these change them, from
    the end of the step without them, as forces do that are the same throughout the step.
    """
    x, q = ints[own + X_AT], ints[own + Q_AT]
    by, less = (0.5 * h, 1.0) if mean == 1 else (h, 0.0)
    for c in range(3):
        y1[x + c] = start[x + c] + by * (found[of + c] - less * free[of + c])
    if q >= 0:
        for c in range(4):
            y1[q + c] = start[q + c]
        ux, uy, uz = less * free[of + 3], less * free[of + 4], less * free[of + 5]
        turn(y1, q, by * (found[of + 3] - ux), by * (found[of + 4] - uy), by * (found[of + 5] - uz))


@lean(types.void(A, A, I, N, A, N, A, A, N, F))
def move(y0, y1, ints, own, masses, at, found, before, of, part):
    """Write the motion of a body at the end of the step, and what the impulses took to the work.

    ``part``: of the velocity at the end of the step in that by which the body has moved; the rest is that in y0.
    """
    v, momentum, mass, inertia = ints[own + V_AT], ints[own + L_AT], masses[at], at + 1
    lost, rest = 0.0, 1.0 - part
    for c in range(3):
        u = found[of + c]
        lost += mass * (y1[v + c] - y0[v + c]) * (part * u + rest * y0[v + c])
        lost -= 0.5 * mass * (u * u - y0[v + c] ** 2)
        y1[v + c] = u
    if momentum >= 0:
        for c in range(3):
            w, new = found[of + 3 + c], 0.0
            for j in range(3):
                new += masses[inertia + 3 * c + j] * found[of + 3 + j]
            lost += (y1[momentum + c] - y0[momentum + c]) * (part * w + rest * before[of + 3 + c])
            lost -= 0.5 * (new * w - y0[momentum + c] * before[of + 3 + c])
            y1[momentum + c] = new
    y1[ints[own + WORK_AT]] += lost
