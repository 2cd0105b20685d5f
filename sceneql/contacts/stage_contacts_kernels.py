# mypy: ignore-errors
"""Local contacts within an implicit stage y = base + a f(t, y): normal forces and friction on masses that touch.

A listed mass (back_off_in_stages_kernels) is tied to the surface from the iterate that has it inside until the tie
pulls: its normal acceleration is the one with which it ends the stage on the surface. With the gap d of the present
iterate the condition is n . (v + dv) = n . v - d/a (Stewart & Trinkle 1996). Coulomb friction reduces the slip at the
stage's end as far as its bound allows, at most to zero (Moreau 1988).

The tie holds whatever the springs do, and slopes have to show that without losing their symmetry: so the residual of a
tie is multiplied by FIRM times the stiffness of inertia and springs, and so are its slopes (Baraff & Witkin 1998 change
the matrix instead). At the solution the residual is zero, and the factor changes nothing.
"""

import math

import numpy as np

import sceneql.system.channels as channels
from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.pair_kernels import HOLD, body_of, firmness
from sceneql.contacts.shape_kernels import surface, velocity

SWEEPS = 50
"""Most Gauss-Seidel sweeps over the objects that a mass touches at once."""
PATIENCE = 3
"""Evaluations in which a tie has to pull before its release: forces of iterates far from the solution say little."""
MOST_LET_GO = 2
"""Most releases of a pair in a stage; then it is left to the end of the step, so that the iteration ends."""


@lean_inlined
def change_tie(memory, gap, floats):
    """Tie a pair that is inside; release one that has been pulling."""
    tied = floats[memory + layout.TIED]
    if tied == 0.0:
        if gap < 0.0:
            floats[memory + layout.TIED] = 1.0
    elif floats[memory + layout.LOAD] >= 0.0:
        floats[memory + layout.TIED] = 1.0
    elif tied < PATIENCE or floats[memory + layout.LET_GO] >= MOST_LET_GO:
        floats[memory + layout.TIED] = tied + 1.0
    else:
        floats[memory + layout.TIED] = 0.0
        floats[memory + layout.LET_GO] += 1.0


@lean_inlined
def press(k, a, base, fresh, y, rate, seen, floats, ints):
    """Normal forces that close the gaps of ties, by Gauss-Seidel sweeps; ``fresh``: ties may change.

    ``seen`` (4 objects,): gap and normal of each.
    """
    objects = ints[layout.OBJECTS]
    at, to = ints[layout.POSITION] + 3 * k, ints[layout.VELOCITY] + 3 * k
    reach = floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
    ties = 0
    for j in range(objects):
        d, nx, ny, nz = surface(floats, ints, layout.HEAD + layout.OBJECT * j, y[at], y[at + 1], y[at + 2])
        seen[4 * j], seen[4 * j + 1], seen[4 * j + 2], seen[4 * j + 3] = d - reach, nx, ny, nz
        memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
        if fresh and floats[memory + layout.LISTED] != 0.0:
            change_tie(memory, d - reach, floats)
        ties += floats[memory + layout.TIED] > 0.0
        floats[memory + layout.LOAD] = floats[memory + layout.PULL] = 0.0
        floats[memory + layout.PRESS] = rate[to] * nx + rate[to + 1] * ny + rate[to + 2] * nz
    for _ in range(SWEEPS if ties > 1 else ties):
        change = 0.0
        for j in range(objects):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
            if floats[memory + layout.TIED] == 0.0:
                continue
            wanted = -seen[4 * j] / a
            for c in range(3):
                wanted += seen[4 * j + 1 + c] * (y[to + c] - floats[base + to + c] - a * rate[to + c])
            add = wanted / a
            floats[memory + layout.LOAD] += add
            for c in range(3):
                rate[to + c] += add * seen[4 * j + 1 + c]
            change = max(change, abs(add))
        if change < 1e-12:
            break
    return ties


@lean_inlined
def rub(k, j, a, base, firm, nx, ny, nz, y, rate, floats, ints):
    """Coulomb friction of a loaded pair: it sticks, or friction opposes the slip at the stage's end.

    The bound follows the load of the step before, where there was one, so that slopes are symmetric. A mass that only
    arrives has friction in its impact.
    """
    memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
    to = ints[layout.VELOCITY] + 3 * k
    earlier = floats[memory + layout.EARLIER]
    load = max(0.0, floats[memory + layout.LOAD]) if math.isnan(earlier) else earlier
    most = floats[ints[layout.FRICTION]] * load
    if floats[memory] == layout.FREE or not most > 0.0:
        return
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
    vx, vy, vz = vx - ux, vy - uy, vz - uz
    vn = vx * nx + vy * ny + vz * nz
    vx, vy, vz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    # The slip at the stage's end without friction.
    sx = floats[base + to] + a * rate[to] - ux
    sy = floats[base + to + 1] + a * rate[to + 1] - uy
    sz = floats[base + to + 2] + a * rate[to + 2] - uz
    sn = sx * nx + sy * ny + sz * nz
    sx, sy, sz = sx - sn * nx, sy - sn * ny, sz - sn * nz
    slip = math.sqrt(sx * sx + sy * sy + sz * sz)
    if slip <= a * most:
        part, tie = 1.0 / a, firm
        dx = dy = dz = 0.0
    else:
        part, tie = most / slip, min(firm, most / (slip - a * most))
        dx, dy, dz = sx / slip, sy / slip, sz / slip
    floats[memory + layout.PULL] = tie
    floats[memory + layout.ALONG], floats[memory + layout.ALONG + 1], floats[memory + layout.ALONG + 2] = dx, dy, dz
    along = vx * dx + vy * dy + vz * dz
    rate[to] -= part * sx + tie * (vx - along * dx)
    rate[to + 1] -= part * sy + tie * (vy - along * dy)
    rate[to + 2] -= part * sz + tie * (vz - along * dz)
    rate[ints[layout.WORK]] += floats[ints[layout.MASS] + k] * part * (sx * vx + sy * vy + sz * vz)


@lean_inlined
def begins(floats, ints):
    """Whether this is the first evaluation of a stage."""
    at = ints[layout.LAST] + layout.LIST + ints[layout.BODIES] + 1
    other = floats[at] != floats[channels.STAGES]
    floats[at] = floats[channels.STAGES]
    return other


@kernel(HOLD, inner=True)
def hold(y, rate, floats, ints):
    """Add normal and friction forces to the accelerations of listed masses within a stage."""
    a = floats[channels.STAGE]
    base = floats.size - channels.BASE * y.size
    firm = firmness(a, floats, ints)
    objects = ints[layout.OBJECTS]
    seen = np.empty(4 * objects)
    fresh = floats[channels.NEWTON] == 0.0  # ties must not change while slopes are evaluated
    first = begins(floats, ints)
    for i in range(int(floats[ints[layout.LAST] + layout.RESTING])):
        k = int(floats[ints[layout.LAST] + layout.LIST + i])
        if floats[ints[layout.INVERSE] + k] == 0.0:
            continue
        to = ints[layout.VELOCITY] + 3 * k
        for j in range(objects if first else 0):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
            # A mass stopped by an earlier stage stays tied to the end of the step, where it has its impact.
            stopped = floats[memory] == layout.FREE and floats[memory + layout.TIED] > 0.0
            floats[memory + layout.LET_GO] = MOST_LET_GO if stopped else 0.0
        if press(k, a, base, fresh, y, rate, seen, floats, ints) == 0:
            continue
        for j in range(objects):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
            if floats[memory + layout.TIED] > 0.0:
                gap, nx, ny, nz = seen[4 * j], seen[4 * j + 1], seen[4 * j + 2], seen[4 * j + 3]
                rub(k, j, a, base, firm, nx, ny, nz, y, rate, floats, ints)
                px, py, pz, vx, vy, vz = body_of(ints, k, y)
                ux, uy, uz = velocity(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
                speed = (vx - ux) * nx + (vy - uy) * ny + (vz - uz) * nz
                if floats[memory] != layout.FREE:  # the energy of an impact is counted at the end of the step
                    rate[ints[layout.WORK]] -= floats[ints[layout.MASS] + k] * floats[memory + layout.LOAD] * speed
                tie = firm * gap / a
                rate[to] -= tie * nx
                rate[to + 1] -= tie * ny
                rate[to + 2] -= tie * nz
