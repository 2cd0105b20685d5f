# mypy: ignore-errors
"""Vectors of states, compared."""

from sceneql.compiled.kernels import lean_inlined


@lean_inlined
def same(x, y):
    """Whether all entries are equal."""
    for k in range(x.size):
        if x[k] != y[k]:
            return False
    return True
