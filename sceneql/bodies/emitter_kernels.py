# mypy: ignore-errors
"""Births and deaths of emitted particles, at the end of every accepted step."""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import AFTER_STEP

RATE, START, TOTAL, LIFETIME, VARIATION, NARROW, MASS, RADIUS, SPEC = range(9)
"""Numbers of an emitter: births a second; the first one's time; their number; mean lifetime, largest relative deviation
of it and of the speed; 1 - cos of the cone's half angle; mass and radius of a particle."""

FIRST, BORN, BEFORE, MEMORY = 0, 1, 2, 9
"""Memory: births before the last step, births so far; time of the last step (below 0: none
is known), place and velocity (3 each) then."""

POSITION_AT, VELOCITY_AT, COUNT, MASS_AT, INVERSE_AT, RADIUS_AT = range(6)
SPEC_AT, FROM_AT, MEAN_AT, POOL_AT, POOL, MEMORY_AT, DEATH_AT, KEY, FIRST_SLOT, SLOTS = range(6, 16)
"""Places in the kernel's integers; at MEAN_AT a velocity, POOL the size of the pool, SLOTS those of all blocks."""

AZIMUTH, POLAR, SPEED, AGE, PLACE = range(5)
"""The draws of a birth."""

MULTIPLIER, WEYL, MASK = np.uint64(0xD256D193), np.uint64(0x9E3779B9), np.uint64(0xFFFFFFFF)
HIGH, LEFT, RIGHT = np.uint64(32), np.uint64(21), np.uint64(11)


@kernel(types.float64(types.int64, types.int64, types.int64))
def draw(birth, number, key):
    """Uniform in [0, 1): Philox2x32-10 of the counter (birth, number), as sceneql.quantities.chance has it."""
    first, second, word = np.uint64(birth) & MASK, np.uint64(number), np.uint64(key)
    for _ in range(10):
        product = first * MULTIPLIER
        first, second = (product >> HIGH) ^ word ^ second, product & MASK
        word = (word + WEYL) & MASK
    return ((first << LEFT) | (second >> RIGHT)) * 2.0**-53


@inlined
def birth_time(floats, spec, birth):
    """Time of a birth [s]."""
    return floats[spec + START] + birth / floats[spec + RATE]


@inlined
def born_until(floats, spec, t):
    """Number of births up to time t."""
    birth = max(0, int(min((t - floats[spec + START]) * floats[spec + RATE], floats[spec + TOTAL])))
    while birth > 0 and birth_time(floats, spec, birth - 1) > t:
        birth -= 1
    while birth < floats[spec + TOTAL] and birth_time(floats, spec, birth) <= t:
        birth += 1
    return birth


@inlined
def own_from(birth, ints):
    """The first birth, from ``birth`` on, whose slot belongs to this block."""
    slot, first = birth % ints[SLOTS], ints[FIRST_SLOT]
    if slot < first:
        return birth + first - slot
    return birth if slot < first + ints[COUNT] else birth + ints[SLOTS] - slot + first


@inlined
def lifetime(floats, spec, birth, key):
    """Lifetime of a particle [s]."""
    return floats[spec + LIFETIME] * (1.0 + floats[spec + VARIATION] * (2.0 * draw(birth, AGE, key) - 1.0))


@inlined
def thrown(floats, spec, birth, key, vx, vy, vz):
    """The mean velocity in a random direction, uniform over the cone's solid angle, with a random speed."""
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    if speed == 0.0:
        return vx, vy, vz
    vx, vy, vz = vx / speed, vy / speed, vz / speed
    cosine = 1.0 - floats[spec + NARROW] * draw(birth, POLAR, key)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    angle = 2.0 * math.pi * draw(birth, AZIMUTH, key)
    # Two axes across the direction (Duff et al. 2017).
    sign = math.copysign(1.0, vz)
    a = -1.0 / (sign + vz)
    b = vx * vy * a
    p, q = sine * math.cos(angle), sine * math.sin(angle)
    speed *= 1.0 + floats[spec + VARIATION] * (2.0 * draw(birth, SPEED, key) - 1.0)
    return (
        speed * (cosine * vx + p * (1.0 + sign * vx * vx * a) + q * b),
        speed * (cosine * vy + p * sign * b + q * (sign + vy * vy * a)),
        speed * (cosine * vz - p * sign * vx - q * vy),
    )


@inlined
def catch_up(t0, t1, y0, rate0, y1, floats, ints):
    """Add the acceleration since birth, known only now, to particles born in the last step; whether there are any."""
    position_at, velocity_at, spec, memory = ints[POSITION_AT], ints[VELOCITY_AT], ints[SPEC_AT], ints[MEMORY_AT]
    born = int(floats[memory + BORN])
    birth = own_from(max(int(floats[memory + FIRST]), born - ints[SLOTS]), ints)
    owed = birth < born
    while birth < born:
        slot = birth % ints[SLOTS] - ints[FIRST_SLOT]
        s = t0 - birth_time(floats, spec, birth) if floats[ints[INVERSE_AT] + slot] > 0.0 else 0.0
        for c in range(3 * slot, 3 * slot + 3):
            more = rate0[velocity_at + c] * s
            y0[position_at + c] += 0.5 * more * s
            y1[position_at + c] += 0.5 * more * s + more * (t1 - t0)
            y0[velocity_at + c] += more
            y1[velocity_at + c] += more
            rate0[position_at + c] += more
        birth = own_from(birth + 1, ints)
    return owed


@kernel(AFTER_STEP, inner=True)
def emit(t0, t1, y0, rate0, y1, floats, ints):
    """Births and deaths of a step; whether there were any, or corrections of births in the step before.

    Birth j takes slot j mod SLOTS and is handled by the block that owns the slot. A particle born inside the step moves
    straight to its end; the next step adds the acceleration at that end for the whole time since birth: exact under a
    uniform force, else with an error of third order. Particles that died in the step before are removed.
    """
    position_at, velocity_at, count = ints[POSITION_AT], ints[VELOCITY_AT], ints[COUNT]
    mass_at, inverse_at, radius_at = ints[MASS_AT], ints[INVERSE_AT], ints[RADIUS_AT]
    spec, place, mean, pool = ints[SPEC_AT], ints[FROM_AT], ints[MEAN_AT], ints[POOL_AT]
    memory, death, key = ints[MEMORY_AT], ints[DEATH_AT], ints[KEY]
    changed = catch_up(t0, t1, y0, rate0, y1, floats, ints)
    for slot in range(count):
        if floats[death + slot] <= t0:
            changed = True
            floats[death + slot] = math.inf
            floats[mass_at + slot] = 0.0
            floats[inverse_at + slot] = 0.0
            floats[radius_at + slot] = 0.0
            for c in range(3):
                y1[position_at + 3 * slot + c] = floats[place + c]
                y1[velocity_at + 3 * slot + c] = 0.0
    floats[memory + FIRST] = floats[memory + BORN]
    floats[memory + BORN] = born_until(floats, spec, t1)
    before = floats[memory + BEFORE]
    birth = own_from(int(floats[memory + FIRST]), ints)
    changed |= birth < floats[memory + BORN]
    while birth < floats[memory + BORN]:
        t = birth_time(floats, spec, birth)
        w = (t - before) / (t1 - before) if before >= 0.0 else 1.0
        slot = birth % ints[SLOTS] - ints[FIRST_SLOT]
        vx, vy, vz = thrown(
            floats, spec, birth, key,
            (1.0 - w) * floats[memory + 6] + w * floats[mean],
            (1.0 - w) * floats[memory + 7] + w * floats[mean + 1],
            (1.0 - w) * floats[memory + 8] + w * floats[mean + 2],
        )  # fmt: skip
        own = 3 * int(draw(birth, PLACE, key) * ints[POOL])
        for c in range(3):
            x = (1.0 - w) * floats[memory + 3 + c] + w * floats[place + c] + floats[pool + own + c]
            v = vx if c == 0 else (vy if c == 1 else vz)
            at, rate_at = position_at + 3 * slot + c, velocity_at + 3 * slot + c
            y0[at] = x + v * (t0 - t)
            y1[at] = x + v * (t1 - t)
            y0[rate_at] = v
            y1[rate_at] = v
            rate0[at] = v
            rate0[rate_at] = 0.0
        floats[mass_at + slot] = floats[spec + MASS]
        floats[inverse_at + slot] = 1.0 / floats[spec + MASS]
        floats[radius_at + slot] = floats[spec + RADIUS]
        floats[death + slot] = t + lifetime(floats, spec, birth, key)
        birth = own_from(birth + 1, ints)
    floats[memory + BEFORE] = t1
    for c in range(3):
        floats[memory + 3 + c] = floats[place + c]
        floats[memory + 6 + c] = floats[mean + c]
    return changed
