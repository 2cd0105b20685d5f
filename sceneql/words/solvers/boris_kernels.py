# mypy: ignore-errors
"""One step of Boris' method: half a drift, half a kick, the turn about the magnetic field, half a kick, half a drift.

``work``: the state of the forces; the rate with all bodies at rest, later the kick's; the rates with all at
1 m/s along x, later the angular velocities of the turn; and along y.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.island import layout
from sceneql.system.signatures_kernels import STEP


@lean_inlined
def turned(time, wx, wy, wz, x, y, z):
    """The vector (x, y, z) turned for a time by the angular velocity (wx, wy, wz) (Rodrigues 1840)."""
    speed = math.sqrt(wx * wx + wy * wy + wz * wz)
    if speed == 0.0:
        return x, y, z
    ax, ay, az = wx / speed, wy / speed, wz / speed
    once, half = math.sin(time * speed), math.sin(0.5 * time * speed)
    twice = 2.0 * half * half
    px, py, pz = ay * z - az * y, az * x - ax * z, ax * y - ay * x
    dx = once * px + twice * (ay * pz - az * py)
    dy = once * py + twice * (az * px - ax * pz)
    dz = once * pz + twice * (ax * py - ay * px)
    square = x * x + y * y + z * z
    if square == 0.0:
        return x, y, z
    # Rounding errors of sine and axis are the same in every step: uncorrected, the length would drift.
    longer = -(dx * (x + 0.5 * dx) + dy * (y + 0.5 * dy) + dz * (z + 0.5 * dz)) / square
    return x + (dx + longer * x), y + (dy + longer * y), z + (dz + longer * z)


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after the step; a body has three entries."""
    rate = rate_at(functions[AT_RATE])
    n = y0.size
    half = 0.5 * h
    middle = t + half
    seen, kick, turn, other = work[:n], work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 4 * n]
    for k in range(n):
        seen[k] = y0[k] + half * rate0[k]
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        x, v = ints[at + layout.POSITION], ints[at + layout.VELOCITY]
        for k in range(ints[at + layout.COUNT]):
            seen[x + k] = y0[x + k] + half * y0[v + k]
            seen[v + k] = 0.0
    rate(middle, seen, kick, floats, ints)
    for axis in range(2):
        for pair in range(ints[layout.TRIPLES]):
            at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
            v = ints[at + layout.VELOCITY]
            if ints[at + layout.COUNT] % 3 == 0:
                for k in range(v, v + ints[at + layout.COUNT], 3):
                    seen[k] = 1.0 - axis
                    seen[k + 1] = 1.0 * axis
        rate(middle, seen, other if axis else turn, floats, ints)
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        v, count = ints[at + layout.VELOCITY], ints[at + layout.COUNT]
        if count % 3 == 0:
            for k in range(v, v + count, 3):
                wx, wy = other[k + 2] - kick[k + 2], kick[k + 2] - turn[k + 2]
                wz = 0.5 * ((turn[k + 1] - kick[k + 1]) - (other[k] - kick[k]))
                turn[k], turn[k + 1], turn[k + 2] = wx, wy, wz
                ux, uy, uz = y0[k], y0[k + 1], y0[k + 2]
                ux += half * (rate0[k] - (wy * y0[k + 2] - wz * y0[k + 1]))
                uy += half * (rate0[k + 1] - (wz * y0[k] - wx * y0[k + 2]))
                uz += half * (rate0[k + 2] - (wx * y0[k + 1] - wy * y0[k]))
                seen[k], seen[k + 1], seen[k + 2] = turned(half, wx, wy, wz, ux, uy, uz)
        else:
            for k in range(v, v + count):
                seen[k] = y0[k] + half * rate0[k]
    rate(middle, seen, kick, floats, ints)
    for k in range(n):
        y1[k] = y0[k] + h * kick[k]
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        x, v, count = ints[at + layout.POSITION], ints[at + layout.VELOCITY], ints[at + layout.COUNT]
        if count % 3 == 0:
            for k in range(v, v + count, 3):
                wx, wy, wz = turn[k], turn[k + 1], turn[k + 2]
                gx = half * (kick[k] - (wy * seen[k + 2] - wz * seen[k + 1]))
                gy = half * (kick[k + 1] - (wz * seen[k] - wx * seen[k + 2]))
                gz = half * (kick[k + 2] - (wx * seen[k + 1] - wy * seen[k]))
                ux, uy, uz = turned(h, wx, wy, wz, y0[k] + gx, y0[k + 1] + gy, y0[k + 2] + gz)
                y1[k], y1[k + 1], y1[k + 2] = ux + gx, uy + gy, uz + gz
        for k in range(count):
            y1[x + k] = seen[x + k] + half * y1[v + k]
    return 0.0
