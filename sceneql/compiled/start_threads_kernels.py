# mypy: ignore-errors
"""Threads of the system for the tiles of a term, compiled only for terms large enough for several (threads_kernels)."""

import numba
import numpy as np
from llvmlite import binding, ir
from numba import carray, types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from sceneql.compiled.arithmetic_kernels import bits, from_bits
from sceneql.compiled.kernels import PIPELINE, function_at, kept, kernel
from sceneql.compiled.threads_kernels import OVER_THREADS, TILE_FUNCTION
from sceneql.system.signatures_kernels import N

WORD = ir.IntType(64)
FUNCTION, FIRST, STRIDE, TILES, TIME, ARRAYS, WORDS = 0, 1, 2, 3, 4, 5, 13
"""Layout of a thread's 64-bit words; from ARRAYS on address and length of y, rate, floats, ints."""

tile_at = function_at(TILE_FUNCTION)


@intrinsic
def pointer(typing, number):
    """A float64 pointer from an address."""

    def code(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], ir.PointerType(ir.DoubleType()))

    return types.CPointer(types.float64)(types.int64), code


@intrinsic
def integer_pointer(typing, number):
    """An int64 pointer from an address."""

    def code(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], ir.PointerType(ir.IntType(64)))

    return types.CPointer(types.int64)(types.int64), code


pthread_create = types.ExternalFunction("pthread_create", types.int32(N, N, N, N))
pthread_join = types.ExternalFunction("pthread_join", types.int32(N, N))


def _entry(told):
    """The function of a thread: compute its tiles."""
    words = carray(told, WORDS)
    y = carray(pointer(words[ARRAYS]), words[ARRAYS + 1])
    rate = carray(pointer(words[ARRAYS + 2]), words[ARRAYS + 3])
    floats = carray(pointer(words[ARRAYS + 4]), words[ARRAYS + 5])
    ints = carray(integer_pointer(words[ARRAYS + 6]), words[ARRAYS + 7])
    tile = tile_at(words[FUNCTION])
    for k in range(words[FIRST], words[TILES], words[STRIDE]):
        tile(k, from_bits(words[TIME]), y, rate, floats, ints)
    return 0


if not numba.config.DISABLE_JIT:
    ENTRY = CFunc(_entry, ((types.CPointer(N),), N), {}, {}, **PIPELINE)
    with kept(ENTRY, _entry):
        ENTRY.compile()
    binding.add_symbol(f"{__name__}.entry", ENTRY.address)


@intrinsic
def entry(typing):
    """The address of `_entry`."""

    def code(context, builder, signature, arguments):
        kind = ir.FunctionType(WORD, [ir.PointerType(WORD)])
        return builder.ptrtoint(cgutils.get_or_insert_function(builder.module, kind, f"{__name__}.entry"), WORD)

    return N(), code


@kernel(OVER_THREADS, inner=True)
def over_threads(several, count, function, tiles, t, y, rate, floats, ints):
    """Call the tile function for tiles 0..tiles-1; ``several``, ``count`` from `threads`, ``function`` its address."""
    count = min(count, tiles)
    tile = tile_at(function)
    if count < 2 or several == 0:
        for k in range(tiles):
            tile(k, t, y, rate, floats, ints)
        return
    told = np.empty((count, WORDS), dtype=np.int64)
    handles = np.zeros(count, dtype=np.int64)
    for k in range(count):
        told[k, FUNCTION], told[k, FIRST], told[k, STRIDE], told[k, TILES] = function, k, count, tiles
        told[k, TIME] = bits(t)
        told[k, ARRAYS], told[k, ARRAYS + 1] = y.ctypes.data, y.size
        told[k, ARRAYS + 2], told[k, ARRAYS + 3] = rate.ctypes.data, rate.size
        told[k, ARRAYS + 4], told[k, ARRAYS + 5] = floats.ctypes.data, floats.size
        told[k, ARRAYS + 6], told[k, ARRAYS + 7] = ints.ctypes.data, ints.size
    started = np.zeros(count, dtype=np.int64)
    for k in range(1, count):
        at = told.ctypes.data + 8 * WORDS * k
        started[k] = pthread_create(handles.ctypes.data + 8 * k, 0, entry(), at) == 0
    for k in range(count):
        if started[k] == 0:
            for number in range(k, tiles, count):
                tile(number, t, y, rate, floats, ints)
    for k in range(1, count):
        if started[k] == 1:
            pthread_join(handles[k], 0)
