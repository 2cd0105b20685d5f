# mypy: ignore-errors
"""Velocities after mass and momentum have moved, and viscosity implicit beside masses that differ."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows import layout as flow
from sceneql.flows.advection_kernels import sides
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.stress_kernels import DRAWS, HELD, WITH_WALLS, stress
from sceneql.system.signatures_kernels import A, F, I

ROUNDED = 1e-10
"""Of a face's mass, what it has too much or too little because velocities are not free of divergence to the last digit:
that stays where it is."""
SMALL = 1e-12
"""Residual of the viscous system, in parts of its right side."""
MOST = 2000


@lean(types.float64(A, A, A, F, A, A, I))
def bring(u0, before, u, h, after, floats, ints):
    """Velocities u and masses ``after`` by face, when MOMENTUM and MASS have come in for h from masses ``before``.

    Each velocity is then a mean of those around it. The largest part of its mass that a cell loses, which may be more
    than all; infinite where that is no number.
    """
    one = ints[ints[own.FLOW] :]
    least = 1.0
    for f in range(u.size):
        u[f], after[f] = u0[f], before[f]
        if floats[one[flow.INVERSES] + f] > 0.0:
            after[f] = before[f] + h * floats[ints[own.MASS] + f]
            left = after[f] / before[f]
            if not left > -math.inf:
                return math.inf
            least = min(least, left)
            u[f] = (before[f] * u0[f] + h * floats[ints[own.MOMENTUM] + f]) / after[f]
    return 1.0 - least


@lean(types.void(A, A, A, A, I))
def hand_over(u, had, more, floats, ints):
    """Take the masses of the skin's place for those that have moved (``had``): momentum stays, but for walls.

    What mass a face has too much or too little keeps its velocity less the mean, as momentum of the faces around it, to
    all of them alike: a small part of the heavy ones'. ``more``: room, an entry a face.
    """
    one = ints[ints[own.FLOW] :]
    masses = floats[ints[own.MASSES] : ints[own.MASSES] + u.size]
    for f in range(u.size):
        more[f] = 0.0
    for component in range(one[flow.AXES]):
        mx, my, mz = sides(component, one)
        start = one[flow.STARTS + component]
        end = start + mx * my * mz
        momentum = mass = held = 0.0
        for f in range(start, end):
            momentum += had[f] * u[f]
            mass += had[f]
            held += floats[one[flow.INVERSES] + f] == 0.0
        whole = momentum / mass
        px, py = one[flow.PERIODIC] == 1, one[flow.PERIODIC + 1] == 1
        pz = one[flow.PERIODIC + 2] == 1 and mz > 1
        for k in range(mz):
            for j in range(my):
                for i in range(mx):
                    f = start + i + mx * (j + my * k)
                    excess = had[f] - masses[f]
                    if abs(excess) <= ROUNDED * masses[f] or floats[one[flow.INVERSES] + f] == 0.0:
                        continue
                    excess *= u[f] - whole
                    around = 0.0
                    for turn in range(2):
                        for c in range(-1, 2):
                            z = k + c
                            if (mz == 1 and c != 0) or (not pz and (z < 0 or z >= mz)):
                                continue
                            for b in range(-1, 2):
                                y = j + b
                                if not py and (y < 0 or y >= my):
                                    continue
                                for a in range(-1, 2):
                                    x = i + a
                                    if not px and (x < 0 or x >= mx):
                                        continue
                                    g = start + x % mx + mx * (y % my + my * (z % mz))
                                    if floats[one[flow.INVERSES] + g] == 0.0:
                                        continue
                                    if turn == 0:
                                        around += masses[g]
                                    else:
                                        more[g] += excess / around
        left = momentum
        mass = 0.0
        for f in range(start, end):
            u[f] += more[f]
            left -= masses[f] * u[f]
            mass += masses[f]
        for f in range(start, end if held == 0.0 else start):
            u[f] += left / mass


@lean(types.boolean(F, A, A, A, A, A, A, A, A, I))
def rub(a, wanted, u, r, z, p, q, own_entries, floats, ints):
    """Solve m u - a stress(u) = wanted [kg m/s] for the free velocities, from those in u; whether it was reached.

    By conjugate gradients with each face's own entry as preconditioner, which takes what is light or thin for itself.
    """
    one = ints[ints[own.FLOW] :]
    masses = floats[ints[own.MASSES] : ints[own.MASSES] + u.size]
    inverses = floats[one[flow.INVERSES] : one[flow.INVERSES] + u.size]
    stress(u, q, WITH_WALLS, floats, ints)
    stress(u, own_entries, DRAWS, floats, ints)
    target = before = 0.0
    for f in range(u.size):
        own_entries[f] = masses[f] + a * own_entries[f]
        r[f] = wanted[f] - masses[f] * u[f] + a * q[f] if inverses[f] > 0.0 else 0.0
        target += wanted[f] * wanted[f] / own_entries[f]
        p[f] = 0.0
    for count in range(MOST):
        now = 0.0
        for f in range(u.size):
            z[f] = r[f] / own_entries[f]
            now += r[f] * z[f]
        if not now > SMALL * SMALL * target:
            return now >= 0.0
        if not math.isfinite(now):
            return False
        part = now / before if count > 0 else 0.0
        for f in range(u.size):
            p[f] = z[f] + part * p[f]
        stress(p, q, HELD, floats, ints)
        product = 0.0
        for f in range(u.size):
            q[f] = masses[f] * p[f] - a * q[f] if inverses[f] > 0.0 else 0.0
            product += p[f] * q[f]
        length = now / product
        for f in range(u.size):
            u[f] += length * p[f]
            r[f] -= length * q[f]
        before = now
    return False
