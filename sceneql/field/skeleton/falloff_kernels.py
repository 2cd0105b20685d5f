# mypy: ignore-errors
"""Kernels of densities: functions K of s = (distance/radius)^2 with K(0) = 1 and K = 0 from s = 1 on.

All are convex, do not increase, and have the slope 0 at s = 1; enclosures rely on nothing else. From the cut ones their
tangent at s = 1 is subtracted, so that no crease shows where a part's reach ends.
"""

import numpy as np

from sceneql.compiled.kernels import inlined

WYVILL, SOFT_OBJECT, METABALL, GAUSSIAN, INVERSE_SQUARE = range(5)

SHARPNESS = 4.0
"""k of the cut kernels exp(-k s) and 1/(1 + k s)."""
CUT = np.exp(-SHARPNESS)
WHOLE = 1.0 - CUT * (1.0 + SHARPNESS)


@inlined
def falloff(kind, s):
    """K(s), s >= 0.

    WYVILL (1 - s)^3 (Wyvill, McPheeters & Wyvill 1986, later form); SOFT_OBJECT 1 - 22/9 s + 17/9 s^2 - 4/9 s^3 (the
    same authors); METABALL 1 - 3 s up to d = R/3, then 3/2 (1 - d/R)^2 (Nishimura et al. 1985); GAUSSIAN exp(-4 s)
    (Blinn 1982) and INVERSE_SQUARE 1/(1 + 4 s), both cut.
    """
    if s >= 1.0:
        return 0.0
    u = 1.0 - s
    if kind == WYVILL:
        return u * u * u
    if kind == SOFT_OBJECT:
        return u * u * (1.0 - 4.0 / 9.0 * s)
    if kind == METABALL:
        if s <= 1.0 / 9.0:
            return 1.0 - 3.0 * s
        v = 1.0 - np.sqrt(s)
        return 1.5 * v * v
    if kind == GAUSSIAN:
        return max((np.exp(-SHARPNESS * s) - CUT * (1.0 + SHARPNESS * u)) / WHOLE, 0.0)
    return u * u / (1.0 + SHARPNESS * s)


@inlined
def falloff_slope(kind, s):
    """dK/ds, s >= 0: at most 0, and not decreasing."""
    if s >= 1.0:
        return 0.0
    u = 1.0 - s
    if kind == WYVILL:
        return -3.0 * u * u
    if kind == SOFT_OBJECT:
        return -u * (22.0 - 12.0 * s) / 9.0
    if kind == METABALL:
        return -3.0 if s <= 1.0 / 9.0 else 1.5 - 1.5 / np.sqrt(s)
    if kind == GAUSSIAN:
        return min(-SHARPNESS * (np.exp(-SHARPNESS * s) - CUT) / WHOLE, 0.0)
    below = 1.0 + SHARPNESS * s
    return -u * (2.0 * below + SHARPNESS * u) / (below * below)
