# mypy: ignore-errors
"""An island's values that vary, brought up to date by an interpreter that is compiled where there is such a value."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.island import layout
from sceneql.system.signatures_kernels import A, F, I

refresh = lazy("sceneql.island.inputs_kernels:refresh", types.void(F, A, A, I))


@lean_inlined
def values_at(t, y, floats, ints):
    """Evaluate an island's values that vary (layout.py): none, as a rule."""
    table = ints[layout.TABLE_AT]
    if ints[table] < ints[table + 1]:
        refresh(t, y, floats, ints[ints[table] : ints[table + 1]])
