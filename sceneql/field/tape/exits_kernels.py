# mypy: ignore-errors
"""Where segments leave the solid {f < 0} of a tape: brackets that values of f make short."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.tape_kernels import value

HALVINGS = 48
"""Brackets are at last as short as after so many halvings of the segment."""
SLACK = 1
"""Evaluations that it may take more than halving would."""
NEARER = 0.2
"""Part of the bracket's length, times itself, by which the secant's root is moved towards its middle."""


@kernel(f"void({ops.TAPE}, float64[:, ::1], float64[:, ::1], float64[::1])", _nrt=False)
def leave(code, constants, parts, scratch, inner, outer, out):
    """Fractions (0..1) into ``out`` (n,) at which segments from ``inner`` to ``outer`` (n, 3) [m] leave.

    The root of the secant, moved towards the middle of the bracket and no farther from it than lets halvings catch up:
    about ten evaluations in place of fifty where f is smooth, never more than one beyond these (Oliveira & Takahashi
    2020, ACM TOMS 47, 5). Where f has no value is outside.
    """
    shortest = 0.5 ** (HALVINGS + 1)
    for i in range(inner.shape[0]):
        x, y, z = inner[i, 0], inner[i, 1], inner[i, 2]
        dx, dy, dz = outer[i, 0] - x, outer[i, 1] - y, outer[i, 2] - z
        below = value(code, constants, parts, scratch, x, y, z)
        above = value(code, constants, parts, scratch, x + dx, y + dy, z + dz)
        low, high = 0.0, 1.0
        halved = shortest * 2.0 ** (HALVINGS + SLACK)
        while high - low > 2.0 * shortest:
            length, middle = high - low, 0.5 * (low + high)
            secant = (above * low - below * high) / (above - below)
            if not low <= secant <= high:  # nor where an end has no value
                secant = middle
            off, near = middle - secant, NEARER * length * length + 0.5 * shortest  # beyond the root, though rounded
            at = secant + math.copysign(near, off) if near <= abs(off) else middle
            allowed = halved - 0.5 * length
            if abs(at - middle) > allowed:
                at = middle - math.copysign(allowed, off)
            found = value(code, constants, parts, scratch, x + at * dx, y + at * dy, z + at * dz)
            if found < 0.0:
                low, below = at, found
            else:
                high, above = at, found
            halved *= 0.5
        out[i] = 0.5 * (low + high)
