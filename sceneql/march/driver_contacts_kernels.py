# mypy: ignore-errors
"""The contacts of any island, whose kernels stand in its integers (island/layout.py)."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import back_off_at, gap_at, impact_at, limit_at
from sceneql.island import layout
from sceneql.island.inputs_kernels import values_at
from sceneql.system.signatures_kernels import BACK_OFF, GAP, IMPACT, LIMIT


@lean(GAP)
def gap(t, y, gaps, floats, ints):
    """The gaps of all pairs of exact contacts."""
    values_at(t, y, floats, ints)
    ranges = ints[layout.RANGES_AT] - ints[layout.GROUPS_AT + ints[layout.EXACT]]
    for g in range(ints[layout.EXACT], ints[layout.LOCAL]):
        measure = gap_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            measure(t, y, gaps[ints[ranges + b] : ints[ranges + b + 1]], floats, ints[ints[b] : ints[b + 1]])


@lean(IMPACT)
def impact(t, y, pair, floats, ints):
    """The impact of a pair, or, if that is negative, what exact contacts do at the end of a step."""
    values_at(t, y, floats, ints)
    ranges = ints[layout.RANGES_AT] - ints[layout.GROUPS_AT + ints[layout.EXACT]]
    for g in range(ints[layout.EXACT], ints[layout.LOCAL]):
        meet = impact_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g + 1])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            first, last = ints[ranges + b], ints[ranges + b + 1]
            if pair < 0 or first <= pair < last:
                meet(t, y, pair if pair < 0 else pair - first, floats, ints[ints[b] : ints[b + 1]])


@lean(BACK_OFF)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """The local contacts, one after another."""
    values_at(t1, y1, floats, ints)
    for g in range(ints[layout.LOCAL], ints[layout.AFTER]):
        contact = back_off_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            contact(t0, t1, y0, rate0, y1, floats, ints[ints[b] : ints[b + 1]])


@lean(LIMIT)
def limit(t, y, changed, floats, ints):
    """The largest part of a change that all that keeps surfaces apart lets pass."""
    values_at(t, changed, floats, ints)
    part = 1.0
    for g in range(ints[layout.LIMITS], ints[layout.GROUPS]):
        most = limit_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            part = min(part, most(t, y, changed, floats, ints[ints[b] : ints[b + 1]]))
    return part
