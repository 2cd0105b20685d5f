# mypy: ignore-errors
"""The barrier of a gap, and smooth Coulomb friction (Li, Ferguson, Schneider et al. 2020, ACM Trans. Graph. 39, 49).

The energy over area is stiffness * gap * b(s) with b(s) = -(s - 1)^2 ln s, s the distance over the gap: 0 from s = 1
on, and without bound as s goes to 0.
"""

import math

from sceneql.compiled.kernels import lean_inlined


@lean_inlined
def barrier(s):
    """b(s); infinite where surfaces touch."""
    if s >= 1.0:
        return 0.0
    return math.inf if s <= 0.0 else -(s - 1.0) * (s - 1.0) * math.log(s)


@lean_inlined
def push(s):
    """-b'(s); NaN where surfaces touch."""
    if s >= 1.0:
        return 0.0
    return math.nan if s <= 0.0 else (s - 1.0) * (2.0 * math.log(s) + (s - 1.0) / s)


@lean_inlined
def steepness(s):
    """b''(s), which is above 0."""
    if s >= 1.0:
        return 0.0
    part = (s - 1.0) / s
    return math.nan if s <= 0.0 else -2.0 * math.log(s) - 4.0 * part + part * part


@lean_inlined
def mobilized(speed, slip):
    """The part of Coulomb's friction that acts, over the speed [s/m]: 1 / speed from the speed of slip on."""
    return 1.0 / speed if speed >= slip else (2.0 - speed / slip) / slip


@lean_inlined
def slowed(speed, most, slip):
    """The speed that friction leaves at the end of a step, which may take away ``most`` [m/s] of it."""
    if speed - most >= slip:
        return speed - most
    part = most / slip
    if part < 1e-12:
        return speed
    linear = 1.0 + 2.0 * part
    return 2.0 * speed / (linear + math.sqrt(linear * linear - 4.0 * part * speed / slip))


@lean_inlined
def friction_potential(speed, slip):
    """The integral of that part over the speed [m/s]."""
    if speed >= slip:
        return speed
    return speed * speed / slip * (1.0 - speed / (3.0 * slip)) + slip / 3.0
