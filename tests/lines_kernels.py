# mypy: ignore-errors
"""The equation of a flat box solved by transforms along rows and elimination across them, for Python."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows.lines_kernels import through_lines
from sceneql.system.signatures_kernels import A, I, N


@lean(types.void(A, N, N, A, A, I, A, N, N, types.boolean, types.boolean))
def solved_by_lines(x, nx, ny, tables, scratch, plan, store, first, last, from_few, to_few):
    """`through_lines` of x (ny nx,), in place."""
    through_lines(x, nx, ny, tables, scratch, plan, store, (first, last), from_few, to_few)
