# mypy: ignore-errors
"""The local contacts of any island, whose kernels stand in its integers (island/layout.py)."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import back_off_at
from sceneql.island import layout
from sceneql.island.varying_kernels import values_at
from sceneql.system.signatures_kernels import BACK_OFF


@lean(BACK_OFF)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """The local contacts, one after another."""
    values_at(t1, y1, floats, ints)
    for g in range(ints[layout.LOCAL], ints[layout.AFTER]):
        contact = back_off_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            contact(t0, t1, y0, rate0, y1, floats, ints[ints[b] : ints[b + 1]])
