# mypy: ignore-errors
"""Impulses of two masses in `exact` mode, compiled at the first impact (sphere_events_kernels)."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.contacts.impulse_kernels import count_hit
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import impulse, of
from sceneql.system.signatures_kernels import IMPACT


@kernel(IMPACT, inner=True)
def hit(t, y, pair, floats, ints):
    """The impulse of a pair that approaches."""
    i = 0
    while pair >= ints[spheres.COUNT] - 1 - i:
        pair -= ints[spheres.COUNT] - 1 - i
        i += 1
    j = i + 1 + pair
    r, v = np.empty(3), np.empty(3)
    vn = 0.0
    for c in range(3):
        r[c] = y[of(ints, i, spheres.X) + c] - y[of(ints, j, spheres.X) + c]
        v[c] = y[of(ints, i, spheres.V) + c] - y[of(ints, j, spheres.V) + c]
        vn += r[c] * v[c]
    if vn >= 0.0:
        return
    px, py, pz, speed = impulse(i, j, r, v, floats, ints)
    count_hit(floats, ints[spheres.TALLY], t, speed)
    for c in range(3):
        p = px if c == 0 else (py if c == 1 else pz)
        a, b = floats[of(ints, i, spheres.INVERSE)] * p, floats[of(ints, j, spheres.INVERSE)] * p
        u, w = y[of(ints, i, spheres.V) + c], y[of(ints, j, spheres.V) + c]
        mi, mj = floats[of(ints, i, spheres.MASS)], floats[of(ints, j, spheres.MASS)]
        lost = -mi * a * (u + 0.5 * a) + mj * b * (w - 0.5 * b)
        y[of(ints, i, spheres.WORK)] += 0.5 * lost
        y[of(ints, j, spheres.WORK)] += 0.5 * lost
        y[of(ints, i, spheres.V) + c] = u + a
        y[of(ints, j, spheres.V) + c] = w - b
