"""What float32 enclosures in lanes claim, beside values."""

import numpy as np

from sceneql.field.packets.packets import enclosures
from sceneql.field.tape.tape_ops import NOWHERE, WHOLE
from sceneql.field.tape.tape_solid import field_values


def check_enclosures(tape, origin, direction, t0, t1):
    """Many segments of a ray at once: all of [t0, t1] and its halves, quarters, eighths."""
    pieces = [(k / n, (k + 1) / n) for n in (1, 2, 4, 8, 64) for k in range(n)]
    ends = t0 + (t1 - t0) * np.array(pieces)
    origins, directions = np.tile(origin, (len(ends), 1)), np.tile(direction, (len(ends), 1))
    found = enclosures(tape, origins, directions, np.ascontiguousarray(ends[:, 0]), np.ascontiguousarray(ends[:, 1]))
    tau = np.linspace(-1.0, 1.0, 17)
    t = ends.mean(axis=1)[:, None] + 0.5 * (ends[:, 1] - ends[:, 0])[:, None] * tau
    f = field_values(tape, (origin + t[:, :, None] * direction).reshape(-1, 3)).reshape(t.shape)
    c0, c1, e, status = found
    claimed = np.isfinite(found[:3]).all(axis=0)
    assert (e[claimed] >= 0.0).all()
    defined = ~np.isnan(f)
    assert defined[claimed & (status == WHOLE)].all()
    assert not defined[status == NOWHERE].any()
    with np.errstate(invalid="ignore", over="ignore"):
        off = np.abs(f - (c0[:, None] + c1[:, None] * tau))
    # The point's own value is rounded in float64.
    wrong = defined & (claimed & (status != NOWHERE))[:, None] & ~(off <= e[:, None] * (1 + 1e-12) + 1e-300)
    assert not wrong.any(), (found[:, wrong.any(axis=1)].T[:3], f[wrong][:3])
