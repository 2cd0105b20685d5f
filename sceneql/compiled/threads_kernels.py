# mypy: ignore-errors
"""Tiles of a large term on several threads, from inside compiled code.

A march is one compiled loop without the interpreter's lock, so its kernels cannot hand tiles to a pool of Python
threads. A term that is large enough starts threads of the system itself, some 20 us each, and waits for them. Tile k
goes to thread k modulo their number and writes to places of its own: the bytes do not depend on how many there are.
"""

from typing import Any

import numba
from numba import types

from sceneql.compiled.kernels import address, thread_count
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.system.signatures_kernels import A, F, I, N

TILE = types.void(N, F, A, A, A, I)
"""tile(number, t, y, rate, floats, ints): computes one tile of a term."""
TILE_FUNCTION = types.FunctionType(TILE)
OVER_THREADS = types.void(N, N, N, N, F, A, A, A, I)

over_threads = lazy("sceneql.compiled.start_threads_kernels:over_threads", OVER_THREADS)
"""over_threads(several, count, function, tiles, t, y, rate, floats, ints); small islands never call it."""


def tile_address(function: Any) -> int:
    """The address by which `over_threads` calls the kernel; keep the kernel alive."""
    return address(function, TILE_FUNCTION)


def threads() -> tuple[int, int]:
    """Two integers for `over_threads`: whether there are several threads, and how many."""
    count = 1 if numba.config.DISABLE_JIT else thread_count()
    return int(count > 1), count
