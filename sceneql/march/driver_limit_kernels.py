# mypy: ignore-errors
"""What keeps surfaces of any island apart, whose kernels stand in its integers (island/layout.py)."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import limit_at
from sceneql.island import layout
from sceneql.island.varying_kernels import values_at
from sceneql.system.signatures_kernels import LIMIT


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
