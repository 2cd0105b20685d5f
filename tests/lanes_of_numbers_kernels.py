# mypy: ignore-errors
"""One use of every operation on lanes, for test_lanes."""

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.lanes_kernels import fma, folded, guess, load, spread, store

S = types.float32[::1]
A = types.float64[::1]


@lean_inlined
def calculated(a, b, number, out, width):
    x, y = load(a, 0), load(b, 0)
    results = x + y, x - y, x * y, number - x, x * number, fma(x, y, number), spread(number), guess(x)
    at = 0
    for one in results:
        store(out, at, one)
        at += width
    return folded(x)


@lean(types.float64(A, A, types.float64, A))
def doubles(a, b, number, out):
    return calculated(a, b, number, out, 8)


@lean(types.float32(S, S, types.float32, S))
def singles(a, b, number, out):
    return calculated(a, b, number, out, 16)
