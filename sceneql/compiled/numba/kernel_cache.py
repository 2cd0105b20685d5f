# mypy: ignore-errors
"""The code of a kernel in our cache: one checked file for each signature and processor.

It stands where numba has its own cache, which keeps an index beside each kernel's code, loads both unchecked, tries
whether it may write at every load, and imports all that a compilation needs even where all code is there.
"""

import pickle
import sys
import warnings
from contextlib import ExitStack, contextmanager
from functools import cache
from hashlib import blake2b
from importlib import import_module

from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.errors import NumbaWarning
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps


@contextmanager
def cached(made, function, name, store):
    """Inside the block ``made``, numba's dispatcher or callback of a function, has its code under a name in a store."""
    with ExitStack() as waiting:
        made._cache = KernelCache(function, name, store, waiting)
        try:
            yield
        finally:
            made._cache = NullCache()


class KernelCache(NullCache):
    """What numba asks for compiled code, and hands it to. ``waiting`` holds the lock of what is not there."""

    def __init__(self, function, name, store, waiting):
        self.function, self.name, self.store, self.waiting = function, name, store, waiting

    def load_overload(self, signature, context):
        """The CompileResult of a signature; None where there is none: then no other process makes it meanwhile."""
        name = self._file(signature, context.codegen())
        data = self.store.read(name)
        if data is None:
            self.waiting.enter_context(self.store.alone(name))
            data = self.store.read(name)
        if data is None:
            return None
        _prepare(context)
        return CompileResult._rebuild(context, *pickle.loads(data))

    def save_overload(self, signature, made):
        """Keep a CompileResult."""
        if made.lifted or made.library.has_dynamic_globals:
            told = (
                f"{self.function.__qualname__} is compiled in every run: it has large arrays or pointers as constants"
            )
            code = self.function.__code__
            warnings.warn_explicit(told, NumbaWarning, code.co_filename, code.co_firstlineno)
        else:
            self.store.write(self._file(signature, made.codegen), dumps(made._reduce()))

    def _file(self, signature, codegen):
        """Named by a hash of all that the code depends on, but for the modules' sources: these name the folder."""
        code, closure = self.function.__code__, self.function.__closure__
        held = dumps(tuple(one.cell_contents for one in closure)) if closure else b""
        words = f"{signature} {_processor(codegen)} {sys.implementation.cache_tag} {code.co_firstlineno} "
        return f"{self.name}-{blake2b(words.encode() + code.co_code + held, digest_size=10).hexdigest()}.nbc"


@cache
def _processor(codegen):
    return codegen.magic_tuple()


@cache
def _prepare(context):
    """What loaded code calls: reference counts, and the numbers that numba hashes by."""
    rtsys.initialize(context)
    import_module("numba.cpython.hashing")
