# mypy: ignore-errors
"""What an impact does to a velocity, and the tally of impacts."""

import math

from sceneql.compiled.kernels import lean_inlined

POSITION, VELOCITY, WORK, MASS, INVERSE, RADIUS, BODIES = range(7)
RESTITUTION, FRICTION, THICKNESS, TALLY, PAIRS, LAST, OBJECTS = range(7, 14)
HEAD = 14
"""The integers of a contact: offsets of the bodies, of its numbers and its memory; the objects follow."""

INSTANT = 7
"""Floats of a body's memory in `exact` mode: the last accepted instant, its place and velocity then."""

HITS, FIRST_TIME, LAST_TIME, LAST_SPEED, REST_TIME, TALLIES = range(6)
"""The tally in the floats; times are NaN before there was one."""

MOST_CUTS = 16
"""Times that one step is cut. Where it stands from the beginning with an END that never comes, none is (collision)."""

STILL = 1e-9
"""Speed [m/s] that counts as none."""


@lean_inlined
def bounce(vx, vy, vz, nx, ny, nz, restitution, friction):
    """The velocity after an impact with velocity v relative to the surface of normal n, approaching (v.n < 0).

    Newton's restitution along n; across it Coulomb's friction: the impulse is at most friction times the normal one
    and never turns the slip around.
    """
    vn = vx * nx + vy * ny + vz * nz
    tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    slip = math.sqrt(tx * tx + ty * ty + tz * tz)
    keep = 1.0
    if slip > 0.0:
        keep = max(0.0, 1.0 + friction * (1.0 + restitution) * vn / slip)
    vn = -restitution * vn
    return keep * tx + vn * nx, keep * ty + vn * ny, keep * tz + vn * nz


@lean_inlined
def count_hit(floats, at, t, speed):
    """Enter an impact at time t with this speed of approach into the tally."""
    floats[at + HITS] += 1.0
    if math.isnan(floats[at + FIRST_TIME]):
        floats[at + FIRST_TIME] = t
    floats[at + LAST_TIME] = t
    floats[at + LAST_SPEED] = speed
    floats[at + REST_TIME] = math.nan


@lean_inlined
def scale_of(x, y, z):
    """Size of the coordinates [m], at least 1: what rounding errors of distances grow with."""
    return max(1.0, max(abs(x), max(abs(y), abs(z))))
