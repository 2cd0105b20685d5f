# mypy: ignore-errors
"""The rate of any island: its integers say which kernels act, on which of them, in which order (island/layout.py)."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import rate_at
from sceneql.island import layout
from sceneql.island.varying_kernels import values_at
from sceneql.system import channels
from sceneql.system.signatures_kernels import TERM


@lean(TERM)
def rate(t, y, rate, floats, ints):
    """The terms, stage by stage, from values at this time and state."""
    floats[channels.RATES] += 1.0
    values_at(t, y, floats, ints)
    for k in range(rate.size):
        rate[k] = 0.0
    for g in range(ints[layout.TERMS], ints[layout.EXACT]):
        term = rate_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            term(t, y, rate, floats, ints[ints[b] : ints[b + 1]])
