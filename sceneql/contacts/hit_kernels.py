# mypy: ignore-errors
"""Impulses of impacts in `exact` mode, compiled at the first impact (collision_kernels)."""

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import STILL, bounce, count_hit, scale_of
from sceneql.contacts.pair_kernels import body_of
from sceneql.contacts.resting_kernels import come_to_rest, set_velocity
from sceneql.contacts.shape_kernels import surface, velocity
from sceneql.system.signatures_kernels import IMPACT

LOWEST_FLIGHT = 4e-13
"""Height of a bounce, relative to the coordinates, below which rounding hides it and the body rests."""


@lean(IMPACT, inner=True)
def hit(t, y, pair, floats, ints):
    """The impulse of a pair at its impact, or the end of its sliding."""
    k, j = pair // ints[layout.OBJECTS], pair % ints[layout.OBJECTS]
    at = layout.HEAD + layout.OBJECT * j
    memory = ints[layout.PAIRS] + layout.PAIR * pair
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    vx, vy, vz = vx - ux, vy - uy, vz - uz
    vn = vx * nx + vy * ny + vz * nz
    press = floats[memory + layout.PRESS]
    if floats[memory] == layout.SLIDES:
        tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
        if tx * tx + ty * ty + tz * tz < 1e-12:
            set_velocity(k, ux + vn * nx, uy + vn * ny, uz + vn * nz, y, floats, ints)
            floats[memory] = layout.STICKS
        else:
            come_to_rest(t, memory, vx, vy, vz, nx, ny, nz, floats, ints)
    elif vn < -STILL:
        e = floats[ints[layout.RESTITUTION]]
        up = -e * vn
        count_hit(floats, ints[layout.TALLY], t, -vn)
        vx, vy, vz = bounce(vx, vy, vz, nx, ny, nz, e, floats[ints[layout.FRICTION]])
        if up <= STILL or (press < 0.0 and up * up < -2.0 * press * LOWEST_FLIGHT * scale_of(px, py, pz)):
            vx, vy, vz = vx - up * nx, vy - up * ny, vz - up * nz
            # The remaining bounces are a geometric series of flights.
            left = 2.0 * up / (-press * (1.0 - e)) if press < 0.0 and e < 1.0 else 0.0
            come_to_rest(t + left, memory, vx, vy, vz, nx, ny, nz, floats, ints)
        set_velocity(k, vx + ux, vy + uy, vz + uz, y, floats, ints)
    elif vn <= STILL:
        # Also without a load yet: a body that is pulled off is released at the end of the step.
        vx, vy, vz = vx - vn * nx, vy - vn * ny, vz - vn * nz
        come_to_rest(t, memory, vx, vy, vz, nx, ny, nz, floats, ints)
        set_velocity(k, vx + ux, vy + uy, vz + uz, y, floats, ints)
