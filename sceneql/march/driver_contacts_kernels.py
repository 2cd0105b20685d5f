# mypy: ignore-errors
"""The exact contacts of any island, whose kernels stand in its integers (island/layout.py)."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import gap_at, impact_at
from sceneql.island import layout
from sceneql.island.varying_kernels import values_at
from sceneql.system.signatures_kernels import GAP, IMPACT


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
