# mypy: ignore-errors
"""One step of any kick-drift-kick method: the shares are data.

``numbers`` = (drifts s,). ``settings`` = (kicks (s + 1), drifts (s)). ``work``: the rate at the step's end, handed on
to the next step; the state that the forces see; the rates of what moves freely at the step's end. What has a free
motion (Assembly.free_motion) drifts by it; where a step has one drift, it ends where ties hold.
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import (
    AT_FREE_MOTION,
    AT_RATE,
    AT_TIED_DRIFT,
    free_motion_at,
    rate_at,
    tied_drift_at,
)
from sceneql.island import layout
from sceneql.system.signatures_kernels import STEP

DRIFTS, KICKS = 0, 0


@lean_inlined
def keep_positions(slope, ints):
    """Zero the rates of positions that have velocities, and of what moves freely: they change by the drifts."""
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        position, count = ints[at + layout.POSITION], ints[at + layout.COUNT]
        for k in range(position, position + count):
            slope[k] = 0.0
    for free in range(ints[layout.FREES]):
        at = ints[layout.FREES_AT] + 2 * free
        for k in range(ints[at], ints[at] + ints[at + 1]):
            slope[k] = 0.0


@lean_inlined
def drift(free_motion, h, y, floats, ints):
    """Positions move by their velocities over h, and what has a free motion by that."""
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        position, velocity = ints[at + layout.POSITION], ints[at + layout.VELOCITY]
        for k in range(ints[at + layout.COUNT]):
            y[position + k] += h * y[velocity + k]
    free_motion(h, y, floats, ints)


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after kicks and drifts (splitting.py)."""
    rate, free_motion = rate_at(functions[AT_RATE]), free_motion_at(functions[AT_FREE_MOTION])
    n = y0.size
    drifts = numbers[DRIFTS]
    slope, seen, last = work[:n], work[n : 2 * n], work[2 * n : 3 * n]
    for k in range(n):
        slope[k] = rate0[k]
    keep_positions(slope, ints)
    kick = h * settings[KICKS]
    for k in range(n):
        y1[k] = y0[k] + kick * slope[k]
    passed = 0.0
    for i in range(drifts):
        share = settings[drifts + 1 + i]
        passed += share
        if ints[layout.TIED] != 0 and drifts == 1:
            for k in range(n):
                last[k] = y1[k]
        drift(free_motion, h * share, y1, floats, ints)
        if ints[layout.TIED] != 0 and drifts == 1:
            tied_drift_at(functions[AT_TIED_DRIFT])(functions, h, y0, last, y1, floats, ints)
        kick = h * settings[i + 1]
        lead = kick if i == drifts - 1 else 0.5 * kick
        for k in range(n):
            seen[k] = y1[k] + lead * slope[k]
        rate(t + passed * h, seen, slope, floats, ints)
        if i == drifts - 1:
            for free in range(ints[layout.FREES]):
                at = ints[layout.FREES_AT] + 2 * free
                for k in range(ints[at], ints[at] + ints[at + 1]):
                    last[k] = slope[k]
        keep_positions(slope, ints)
        for k in range(n):
            y1[k] += kick * slope[k]
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        position, velocity = ints[at + layout.POSITION], ints[at + layout.VELOCITY]
        for k in range(ints[at + layout.COUNT]):
            slope[position + k] = y1[velocity + k]
    for free in range(ints[layout.FREES]):
        at = ints[layout.FREES_AT] + 2 * free
        for k in range(ints[at], ints[at] + ints[at + 1]):
            slope[k] = last[k]
    return 0.0
