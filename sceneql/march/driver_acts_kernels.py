# mypy: ignore-errors
"""What acts between the steps of any island, and its free motion; their kernels stand in its integers."""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import brought
from sceneql.compiled.pointers_kernels import after_step_at, free_motion_at
from sceneql.island import layout
from sceneql.island.varying_kernels import values_at
from sceneql.system.signatures_kernels import AFTER_STEP, FREE_MOTION


@lean_inlined
def act(first, last, t0, t1, y0, rate0, y1, floats, ints):
    """Let the kernels of groups act, all of them; whether one has changed something."""
    values_at(t1, y1, floats, ints)
    changed = False
    for g in range(first, last):
        one = after_step_at(ints[ints[layout.CALLS_AT] + layout.CALLS * g])
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            changed |= one(t0, t1, y0, rate0, y1, floats, ints[ints[b] : ints[b + 1]])
    return changed


@lean(AFTER_STEP)
def after_step(t0, t1, y0, rate0, y1, floats, ints):
    """What acts at the end of steps."""
    return act(ints[layout.AFTER], ints[layout.SETTLING], t0, t1, y0, rate0, y1, floats, ints)


@lean(AFTER_STEP)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """What acts on samples, too."""
    return act(ints[layout.SETTLING], ints[layout.MOTIONS], t0, t1, y0, rate0, y1, floats, ints)


@lean(FREE_MOTION)
def free_motion(h, y, floats, ints):
    """The exact motion without forces."""
    for g in range(ints[layout.MOTIONS], ints[layout.DRIFTS]):
        move = free_motion_at(brought(ints[ints[layout.CALLS_AT] + layout.CALLS * g]))
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            move(h, y, floats, ints[ints[b] : ints[b + 1]])
