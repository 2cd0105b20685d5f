# mypy: ignore-errors
"""Resting contact: transitions to rest and sliding, and drift correction onto the surface.

The direction of Coulomb friction changes at a rate of friction / speed: infinitely stiff as the speed goes to 0. So a
body slower than CREEP sticks: friction there opposes the pull, not the velocity, and the remaining velocity is removed
once the pull is below friction's bound. Only a body that slides with little pull stops by itself.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import STILL, scale_of
from sceneql.contacts.pair_kernels import KEEP, body_of
from sceneql.contacts.shape_kernels import surface, velocity
from sceneql.system.signatures_kernels import A, F, I, N

CREEP = 1e-3
"""Speed along the surface [m/s] below which friction opposes the pull."""


@lean_inlined
def set_velocity(k, x, y, z, state, floats, ints):
    """Set the velocity of body k; the decrease of its kinetic energy is counted as dissipated."""
    at = ints[layout.VELOCITY] + 3 * k
    before = state[at] ** 2 + state[at + 1] ** 2 + state[at + 2] ** 2
    after = x * x + y * y + z * z
    state[ints[layout.WORK]] += 0.5 * floats[ints[layout.MASS] + k] * (before - after)
    state[at], state[at + 1], state[at + 2] = x, y, z


@lean(types.void(F, N, F, F, F, F, F, F, A, I), inner=True)
def come_to_rest(t, memory, vx, vy, vz, nx, ny, nz, floats, ints):
    """Mark a pair as resting from t on: sliding along v (relative to the surface), or sticking."""
    if math.isnan(floats[ints[layout.TALLY] + layout.REST_TIME]):
        floats[ints[layout.TALLY] + layout.REST_TIME] = t
    vn = vx * nx + vy * ny + vz * nz
    tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    slip = math.sqrt(tx * tx + ty * ty + tz * tz)
    slides = slip >= CREEP or floats[ints[layout.FRICTION]] == 0.0
    floats[memory] = layout.SLIDES if slides else layout.STICKS
    floats[memory + layout.EARLIER] = math.nan
    if slip > 0.0:
        floats[memory + layout.ALONG] = tx / slip
        floats[memory + layout.ALONG + 1] = ty / slip
        floats[memory + layout.ALONG + 2] = tz / slip


@lean(KEEP, inner=True)
def keep(t, k, j, y, floats, ints):
    """Correct a resting pair onto its surface, or release it when it has left: whether anything changed."""
    memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
    if floats[memory] == layout.FREE:
        return False
    at = layout.HEAD + layout.OBJECT * j
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
    d, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    d -= floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
    rx, ry, rz = vx - ux, vy - uy, vz - uz
    vn = rx * nx + ry * ny + rz * nz
    small = 1e-12 * scale_of(px, py, pz)
    if d > small and vn > STILL and floats[memory + layout.PRESS] >= 0.0:
        floats[memory] = layout.FREE
        return True
    changed = floats[memory + layout.PRESS] < 0.0 and (abs(d) > small or abs(vn) > small)
    if changed:
        to = ints[layout.POSITION] + 3 * k
        y[to], y[to + 1], y[to + 2] = px - d * nx, py - d * ny, pz - d * nz
        # The load does work on that distance.
        y[ints[layout.WORK]] -= floats[ints[layout.MASS] + k] * floats[memory + layout.PRESS] * d
        set_velocity(k, vx - vn * nx, vy - vn * ny, vz - vn * nz, y, floats, ints)
    if floats[memory] == layout.CREEPS:
        return changed
    rx, ry, rz = rx - vn * nx, ry - vn * ny, rz - vn * nz
    slip = math.sqrt(rx * rx + ry * ry + rz * rz)
    most = floats[ints[layout.FRICTION]] * floats[memory + layout.LOAD]
    if slip >= CREEP or (floats[memory] == layout.SLIDES and floats[memory + layout.PULL] > 0.5 * most):
        come_to_rest(t, memory, rx, ry, rz, nx, ny, nz, floats, ints)
    elif floats[memory] == layout.STICKS and floats[memory + layout.PULL] <= most and slip > 0.0:
        set_velocity(k, vx - vn * nx - rx, vy - vn * ny - ry, vz - vn * nz - rz, y, floats, ints)
        changed = True
    return changed


@lean_inlined
def lies(k, level, nx, ny, nz, y, floats, ints):
    """Whether body k is at rest on the plane n . x + level = 0, sticking or without friction, so that `keep` and
    `brake` would change nothing."""
    memory = ints[layout.PAIRS] + layout.PAIR * k
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    if floats[memory + layout.PRESS] >= 0.0:
        return False
    if floats[memory] == layout.STICKS:
        if vx != 0.0 or vy != 0.0 or vz != 0.0:
            return False
    elif floats[memory] != layout.SLIDES or floats[ints[layout.FRICTION]] != 0.0:
        return False
    d = level + (px * nx + py * ny + pz * nz) - floats[ints[layout.RADIUS] + k] - floats[ints[layout.THICKNESS]]
    small = 1e-12 * scale_of(px, py, pz)
    return abs(d) <= small and abs(vx * nx + vy * ny + vz * nz) <= small
