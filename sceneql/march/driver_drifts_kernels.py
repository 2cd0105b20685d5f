# mypy: ignore-errors
"""What lets the drifts of splittings end where the ties of an island hold; their kernels stand in its integers."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import brought
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.island import layout
from sceneql.system.signatures_kernels import TIED_DRIFT, TIED_DRIFT_OF

part_of_drift_at = kernel_at(TIED_DRIFT_OF)


@lean(TIED_DRIFT)
def tied_drift(functions, h, y0, kicked, y1, floats, ints):
    """What lets drifts end where ties hold."""
    for g in range(ints[layout.DRIFTS], ints[layout.LIMITS]):
        hold = part_of_drift_at(brought(ints[ints[layout.CALLS_AT] + layout.CALLS * g]))
        for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
            hold(functions, h, y0, kicked, y1, floats, ints, ints[ints[b] : ints[b + 1]])
