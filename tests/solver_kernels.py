"""Small systems for the solver tests, as plain kernels."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import BACK_OFF, GAP, IMPACT, TERM


@kernel(TERM)
def linear(t, y, rate, floats, ints):
    """y' = lambda y on complex numbers (re, im) with lambda = floats[ints[0]] + i floats[ints[0] + 1]."""
    re, im = floats[ints[0]], floats[ints[0] + 1]
    for k in range(0, y.size, 2):
        rate[k] += re * y[k] - im * y[k + 1]
        rate[k + 1] += im * y[k] + re * y[k + 1]


@kernel(TERM)
def forced(t, y, rate, floats, ints):
    """y' = -y^2 cos t: y = 1/(1 + sin t) from 1."""
    rate[0] += -y[0] * y[0] * math.cos(t)


@kernel(TERM)
def oscillators(t, y, rate, floats, ints):
    """x'' = -w^2 x - d x', for n pairs: ints (n, position, velocity, at) with floats[at + 2k] = w^2, then d."""
    n, position, velocity, at = ints[0], ints[1], ints[2], ints[3]
    for k in range(n):
        rate[position + k] += y[velocity + k]
        rate[velocity + k] += -floats[at + 2 * k] * y[position + k] - floats[at + 2 * k + 1] * y[velocity + k]


@kernel(TERM)
def pendulum(t, y, rate, floats, ints):
    """x'' = -sin x."""
    rate[0] += y[1]
    rate[1] += -math.sin(y[0])


@kernel(TERM)
def double_pendulum(t, y, rate, floats, ints):
    """Two unit rods with unit masses: y = angle, angle, rate, rate; g = floats[ints[0]]."""
    g = floats[ints[0]]
    a, b, u, v = y[0], y[1], y[2], y[3]
    d = a - b
    below = 2.0 - math.cos(d) ** 2
    rate[0] += u
    rate[1] += v
    inner = u * u * math.sin(d) - g * math.sin(b)
    rate[2] += (-v * v * math.sin(d) - 2.0 * g * math.sin(a) - math.cos(d) * inner) / below
    rate[3] += (2.0 * inner + math.cos(d) * (v * v * math.sin(d) + 2.0 * g * math.sin(a))) / below


@kernel(TERM)
def heights(t, y, rate, floats, ints):
    """Balls (x, v) under g = floats[ints[0]]."""
    for k in range(0, y.size, 2):
        rate[k] += y[k + 1]
        rate[k + 1] -= floats[ints[0]]


@kernel(TERM)
def held(t, y, rate, floats, ints):
    """A resting ball (flag floats[ints[2] + ball]) does not move."""
    for k in range(0, y.size, 2):
        if floats[ints[2] + k // 2] != 0.0:
            rate[k] = 0.0
            rate[k + 1] = 0.0


@kernel(GAP)
def floor_gap(t, y, gaps, floats, ints):
    """Heights of the balls above 0; a resting ball meets nothing."""
    for k in range(gaps.size):
        gaps[k] = 1e300 if floats[ints[2] + k] != 0.0 else y[2 * k]


@kernel(IMPACT)
def floor_impact(t, y, pair, floats, ints):
    """ints: g, restitution, flags, times of rest, times of the first hit."""
    if pair < 0:
        return
    v = y[2 * pair + 1]
    if v > 0.0:
        return
    g, e = floats[ints[0]], floats[ints[1]]
    if floats[ints[4] + pair] == 0.0:
        floats[ints[4] + pair] = t
    after = -e * v
    left = 2.0 * after / (g * (1.0 - e))
    if left < 1e-9:
        floats[ints[2] + pair] = 1.0
        floats[ints[3] + pair] = t + left
        after = 0.0
    y[2 * pair + 1] = after


@kernel(BACK_OFF)
def floor_back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Mirrors balls that have gone below 0."""
    for k in range(0, y1.size, 2):
        if y1[k] < 0.0:
            y1[k] = -y1[k]
            y1[k + 1] = -y1[k + 1]


@kernel(TERM)
def blow_up(t, y, rate, floats, ints):
    """y' = y^2."""
    rate[0] += y[0] * y[0]
