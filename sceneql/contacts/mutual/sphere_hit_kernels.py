# mypy: ignore-errors
"""Impulses of two masses in `exact` mode, compiled at the first impact (sphere_events_kernels)."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.contacts.impulse_kernels import count_hit
from sceneql.contacts.mutual.sphere_pair_kernels import COUNT, INVERSE, MASS, TALLY, WORK, V, X, impulse, of
from sceneql.system.signatures_kernels import IMPACT


@kernel(IMPACT, inner=True)
def hit(t, y, pair, floats, ints):
    """The impulse of a pair that approaches."""
    i = 0
    while pair >= ints[COUNT] - 1 - i:
        pair -= ints[COUNT] - 1 - i
        i += 1
    j = i + 1 + pair
    r, v = np.empty(3), np.empty(3)
    vn = 0.0
    for c in range(3):
        r[c] = y[of(ints, i, X) + c] - y[of(ints, j, X) + c]
        v[c] = y[of(ints, i, V) + c] - y[of(ints, j, V) + c]
        vn += r[c] * v[c]
    if vn >= 0.0:
        return
    px, py, pz, speed = impulse(i, j, r, v, floats, ints)
    count_hit(floats, ints[TALLY], t, speed)
    for c in range(3):
        p = px if c == 0 else (py if c == 1 else pz)
        a, b = floats[of(ints, i, INVERSE)] * p, floats[of(ints, j, INVERSE)] * p
        u, w = y[of(ints, i, V) + c], y[of(ints, j, V) + c]
        lost = -floats[of(ints, i, MASS)] * a * (u + 0.5 * a) + floats[of(ints, j, MASS)] * b * (w - 0.5 * b)
        y[of(ints, i, WORK)] += 0.5 * lost
        y[of(ints, j, WORK)] += 0.5 * lost
        y[of(ints, i, V) + c] = u + a
        y[of(ints, j, V) + c] = w - b
