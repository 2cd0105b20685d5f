# mypy: ignore-errors
"""The inverses of many small matrices."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, N


@lean(types.boolean(N, N, A), inner=True)
def invert_blocks(s, n, blocks):
    """Turn each of n matrices, (s, s, n) in all, into its inverse by Gauss and Jordan; False where a pivot is lost.

    Without exchanges of rows: a cell's own entry is the largest where the stage's step is one that can be solved.
    """
    for c in range(n):
        for p in range(s):
            own = (p * s + p) * n + c
            if not abs(blocks[own]) > 0.0:
                return False
            pivot = 1.0 / blocks[own]
            blocks[own] = 1.0
            for q in range(s):
                blocks[(p * s + q) * n + c] *= pivot
            for m in range(s):
                if m == p:
                    continue
                part = blocks[(m * s + p) * n + c]
                blocks[(m * s + p) * n + c] = 0.0
                for q in range(s):
                    blocks[(m * s + q) * n + c] -= part * blocks[(p * s + q) * n + c]
    return True
