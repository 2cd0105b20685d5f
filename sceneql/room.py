"""Memory asked for ahead of what ends the process where it gets none: LLVM and OpenBLAS cannot fail in another way.

Address space is what is asked for, which a limit of the process bounds; none of it is touched.
"""

from __future__ import annotations

import mmap
import os
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

MIB = 2**20
TO_COMPILE = 160 * MIB
"""What compiling one function has taken at most, and the arena of malloc that a thread begins."""
TO_LOAD = 16 * MIB
"""The same of a function that is loaded from the cache."""
BLAS, BLAS_THREAD = 80 * MIB, 48 * MIB
"""What a library with OpenBLAS maps as it is loaded, and for each of its threads."""
MOST_THREADS = 64
"""That its builds for Python take."""
WITH_BLAS = ("numpy", "scipy.linalg")


def ask_for(size: int, why: str) -> None:
    """Raise MemoryError where so many bytes are not to be had."""
    try:
        mmap.mmap(-1, size).close()
    except OSError:
        raise MemoryError(f"Unable to allocate {size // MIB} MiB {why}") from None


class _Libraries(MetaPathFinder):
    """Asks for the memory of libraries with OpenBLAS before they are loaded, and has them take it at once.

    Else OpenBLAS takes its buffer at the first product of matrices, and ends the process where none is left.
    """

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name not in WITH_BLAS:
            return None
        asked = os.environ.get("OPENBLAS_NUM_THREADS", "")
        threads = min(int(asked) if asked.isdecimal() else os.cpu_count() or 1, MOST_THREADS)
        ask_for(BLAS + BLAS_THREAD * threads, f"to load {name.partition('.')[0]}")
        spec = PathFinder.find_spec(name, path, target)
        loader: Any = None if spec is None else spec.loader
        if loader is not None:
            load = loader.exec_module

            def load_and_take(module: Any) -> None:
                load(module)
                del loader.exec_module
                _take_buffer(module)

            loader.exec_module = load_and_take
        return spec


def _take_buffer(library: Any) -> None:
    """Have the OpenBLAS of numpy, or of scipy.linalg, take the buffer of this thread, as any factorization does."""
    if library.__name__ == "numpy":
        library.linalg.inv(library.eye(2))
    else:
        library.lapack.dgetrf(sys.modules["numpy"].eye(2))


def ask_before_imports() -> None:
    """From here on the import of a library with OpenBLAS raises MemoryError where there is too little for it."""
    sys.meta_path.insert(0, _Libraries())
