# mypy: ignore-errors
"""One use of every operation on lanes, for test_lanes."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import (
    below,
    bits_below,
    first_bit,
    fma,
    folded,
    guess,
    least,
    load,
    most,
    root,
    spread,
    store,
    turn_over,
)

S = types.float32[::1]
A = types.float64[::1]


@lean_inlined
def calculated(a, b, number, out, width):
    x, y = load(a, 0), load(b, 0)
    results = x + y, x - y, x * y, number - x, x * number, x / y, root(x), fma(x, y, number), spread(number), guess(x)
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


@lean_inlined
def compared(a, b, out, single):
    x, y = load(a, 0), load(b, 0)
    store(out, 0, below(x, y, x, 2.0))
    store(out, len(a), abs(x - y))
    store(single, 0, x)
    return bits_below(x, y), least(x), most(x)


@lean(types.Tuple((types.int64, types.float64, types.float64))(A, A, A, S))
def doubles_compared(a, b, out, single):
    return compared(a, b, out, single)


@lean(types.Tuple((types.int64, types.float32, types.float32))(S, S, S, S))
def singles_compared(a, b, out, single):
    return compared(a, b, out, single)


@lean("int64(int64)")
def first_of(bits):
    return first_bit(bits)


@lean("void(float64[::1], float64[::1])")
def doubles_turned(source, target):
    """A square whose rows begin at 3 and stand 11 apart, to 5 and 9 apart."""
    turn_over(source, 3, 11, target, 5, 9)


@lean("void(float32[::1], float32[::1])")
def singles_turned(source, target):
    turn_over(source, 3, 19, target, 5, 17)
