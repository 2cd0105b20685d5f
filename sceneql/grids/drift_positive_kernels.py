# mypy: ignore-errors
"""The derivatives of advection by a flow without its limiter, whose kinks can keep Newton's method from converging."""

from sceneql.compiled.kernels import lean
from sceneql.grids.drift_slopes_kernels import add
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def carry(t, y, entries, floats, ints):
    """Entries as of drift_slopes_kernels.carry."""
    add(y, entries, floats, ints, False)
