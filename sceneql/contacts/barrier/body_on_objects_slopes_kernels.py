# mypy: ignore-errors
"""The derivatives of a barrier between a rigid body and objects, by the chain rule; else as objects_slopes_kernels.

ROWS of the body by its COLUMNS (place_slopes_kernels), row by row.
"""

import numpy as np

import sceneql.system.channels as channels
from sceneql.bodies.rigid.place_kernels import arm
from sceneql.bodies.rigid.place_slopes_kernels import COLUMNS, ROWS, moved_by
from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.objects_slopes_kernels import pressing, rubbed
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def add(entries, moved, row, r, weight, xx, xy, xz, yy, yz, zz):
    """Add the derivatives of a force of a point with the arm ``r``: a symmetric 3x3 by the motion from ``row`` on."""
    for c in range(COLUMNS):
        a, b, d = weight * moved[row, c], weight * moved[row + 1, c], weight * moved[row + 2, c]
        fx, fy, fz = xx * a + xy * b + xz * d, xy * a + yy * b + yz * d, xz * a + yz * b + zz * d
        entries[c] += fx
        entries[COLUMNS + c] += fy
        entries[2 * COLUMNS + c] += fz
        entries[3 * COLUMNS + c] += r[1] * fz - r[2] * fy
        entries[4 * COLUMNS + c] += r[2] * fx - r[0] * fz
        entries[5 * COLUMNS + c] += r[0] * fy - r[1] * fx


@kernel(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """The entries of the body."""
    friction, slip = floats[ints[layout.FRICTION]], floats[ints[layout.NUMBERS] + layout.SLIP]
    lagged = friction > 0.0 and floats[channels.STAGE] > 0.0
    before, after = floats.size - channels.BEFORE * y.size, floats.size - channels.AFTER * y.size
    if not lagged:
        before = after = 0
    old, new = floats[before : before + y.size], floats[after : after + y.size]
    moved = np.zeros((ROWS, COLUMNS))
    for p in range(ints[layout.NODES]):
        at, known = ints[layout.ARMS] + 8 * p, False
        for j in range(ints[layout.OBJECTS]):
            pressed, a, b, c, steep, x, y_, z = pressing(y, floats, ints, p, j, lagged)
            rubs = friction > 0.0 and pressed > 0.0
            if not rubs and steep == 0.0:
                continue
            if not known:
                moved_by(y, floats, ints, at, moved)
                known = True
            r = arm(y, floats, ints, at)
            if steep != 0.0:
                add(entries, moved, 0, r, steep, x * x, x * y_, x * z, y_ * y_, y_ * z, z * z)
            if rubs:
                xx, xy, xz, yy, yz, zz = rubbed(y, old, new, floats, ints, p, j, a, b, c, lagged, slip)
                add(entries, moved, 3, r, -friction * pressed, xx, xy, xz, yy, yz, zz)
