"""Where compiled code begins: the one decorator, the cache folder, the compile account and the thread pool.

Imports numba; only ``*_kernels.py`` files and those that run them import this module.
"""

from __future__ import annotations

import ast
import gc
import hashlib
import os
import re
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from importlib import import_module
from importlib.util import find_spec, resolve_name
from itertools import accumulate
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, NamedTuple

import numba
from numba import types
from numba.core.event import Listener
from numba.extending import intrinsic

from sceneql.compiled import variables
from sceneql.compiled.numba.collecting import collecting_later
from sceneql.compiled.numba.kernel_cache import cached
from sceneql.compiled.store import Store
from sceneql.room import TO_COMPILE, TO_LOAD, ask_for

config: Any = numba.config


def _mode() -> str:
    """How kernels run: by numba with our shortcuts, by numba as it is, or as Python functions (NUMBA_DISABLE_JIT)."""
    asked = "plain" if variables.plain() else "shortcuts"
    return "uncompiled" if config.DISABLE_JIT else asked


MODE = _mode()
"""``"shortcuts"``, ``"plain"`` or ``"uncompiled"``; only the first imports what replaces parts of numba."""
if MODE == "shortcuts":
    from sceneql.compiled.numba.kernel_compiler import PIPELINES, call_by_name, take_all

    take_all()
    PIPELINE, HELPER_PIPELINE, ENTRY_PIPELINE = PIPELINES
else:
    PIPELINE = HELPER_PIPELINE = {}

njit: Any = numba.njit
cgutils: Any = import_module("numba.core.cgutils")
numba_event: Any = import_module("numba.core.event")
register_dispatcher: Any = import_module("numba.core.typeinfer").register_dispatcher

OURS = ("sceneql", "renderers", "sceneql_generated")
_IMPORTS = re.compile(r"^[ \t]*((?:from\b[^\n(]*\bimport|import)\b[^\n(]*(?:\([^)]*\))?)", re.MULTILINE)
"""Import statements, and lines of text that look like them."""
_HIDDEN_IMPORTS = re.compile(r"[;:][ \t]*(?:from\b[^\n]*\bimport|import)\b|\\\n")
"""Imports that the pattern above would miss: in the middle of a line, or over lines without brackets."""


gc.freeze()  # what numba has made at its import lives on, and is not looked over in every collection

_home = variables.cache_home()
CACHE = Store(_home / "sceneql" / f"numba-{numba.__version__}-{MODE}" if _home else None)
"""All compiled code of this version of numba and of this mode."""


def _spec(module: str) -> Any:
    """The import spec of a module; None where there is none of this name, or a package that was made at run time."""
    try:
        return find_spec(module)
    except (ImportError, ValueError):
        return None


def _has_modules(name: str) -> bool:
    """Whether the name is a package's."""
    if name in sys.modules:
        return hasattr(sys.modules[name], "__path__")
    spec = _spec(name)
    return spec is not None and spec.submodule_search_locations is not None


def _imported(text: str, package: str) -> frozenset[str]:
    """Names of the modules that a file may import: of ``from a import b`` both ``a`` and ``a.b``."""
    try:  # the statements alone are parsed in a tenth of the time of all
        tree = ast.parse(text if _HIDDEN_IMPORTS.search(text) else "\n".join(_IMPORTS.findall(text)))
    except SyntaxError:  # prose that looks like an import, or one that the pattern cuts
        tree = ast.parse(text)
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                found |= {alias.name} if alias.asname else set(accumulate(alias.name.split("."), "{}.{}".format))
        elif isinstance(node, ast.ImportFrom):
            name = f"{'.' * node.level}{node.module or ''}"
            source = resolve_name(name, package) if node.level else name
            found |= {source, *(f"{source}.{alias.name}" for alias in node.names)}
            if node.names[0].name == "*" and _has_modules(source):
                found |= {f"{source}.{one.name}" for one in iter_modules(_spec(source).submodule_search_locations)}
    return frozenset(found)


class _Source(NamedTuple):
    """A module's file as it is now."""

    path: Path
    digest: str
    imports: frozenset[str]


def _source(name: str) -> _Source | None:
    """The file of a module; None where the name is none's, or that of something that a module defines."""
    package = name.rpartition(".")[0]
    spec = None if package and not _has_modules(package) else _spec(name)
    if spec is None or not spec.has_location:
        return None
    data = spec.loader.get_data(spec.origin)
    return _Source(Path(spec.origin), hashlib.sha256(data).hexdigest(), _imported(data.decode(), spec.parent))


_source_of_ours = cache(_source)
"""Files of ours do not change while a process runs; those of a ``--words`` folder may."""


def _sources(module: str) -> dict[str, _Source]:
    """By module the files that its compiled code depends on: its own, and those of ours that it imports, transitively.

    In the order of their names.
    """
    found: dict[str, _Source | None] = {}
    tops = {*OURS, module.partition(".")[0]}
    todo = [module]
    while todo:
        name = todo.pop()
        top = name.partition(".")[0]
        if name not in found and top in tops:
            source = found[name] = _source_of_ours(name) if top in OURS else _source(name)
            todo += source.imports if source is not None else ()
    return {name: source for name, source in sorted(found.items()) if source is not None}


def cache_folder(module: str) -> str:
    """Name of the folder of a module's compiled code in the cache, by a hash of all the source that it depends on.

    numba's own cache does not notice a change in a function imported from another file; the hash does.
    """
    return _folder_of_ours(module) if module.partition(".")[0] in OURS else _folder(module)


@cache
def _folder_of_ours(module: str) -> str:
    return _folder(module)


def _folder(module: str) -> str:
    digest = hashlib.sha256()
    for name, source in _sources(module).items():
        digest.update(f"{name} {source.digest}\n".encode())
    return f"{module.rpartition('.')[2]}-{digest.hexdigest()[:16]}"


class CompileAccount(Listener):
    """Counts numba's compilations (not loads from the cache) and their seconds, nested ones once."""

    def __init__(self) -> None:
        self.count = 0
        self.seconds = 0.0
        self._depth = 0
        self._block = 0
        self._started = 0.0

    def on_start(self, event: Any) -> None:
        """A compilation starts. Raises MemoryError where it is sure to have too little."""
        ask_for(TO_COMPILE, "to compile")
        if self._depth == 0:
            self._started = time.perf_counter()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """A compilation ends."""
        self._depth -= 1
        if self._depth == self._block:
            self.count += 1
        self._leave()

    def _leave(self) -> None:
        if self._depth == 0:
            self.seconds += time.perf_counter() - self._started

    @contextmanager
    def whole_block(self) -> Iterator[None]:
        """Count all the seconds of a block as compilation."""
        self.on_start(None)
        self._block += 1
        try:
            yield
        finally:
            self._block -= 1
            self._depth -= 1
            self._leave()


compiled = CompileAccount()
numba_event.register("numba:compile", compiled)


def kernel(signature: Any, *, inner: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function for one explicit signature, cached on disk, without the GIL, NaN and inf as in numpy.

    Fastmath stays off, so that the bits do not depend on the machine. An ``inner`` kernel is called by kernels alone,
    by its name or address. The entry for calls from Python is compiled at the first such call.
    """
    options |= COMMON | UNWRAPPED

    def compile(function: Callable[..., Any]) -> Any:
        def made(part: str, pipeline: dict[str, Any]) -> Any:
            dispatcher = njit(**pipeline, **options)(function)
            with kept(dispatcher, function, part), register_dispatcher(dispatcher), collecting_later():
                ask_for(TO_LOAD, "to load what is compiled")
                dispatcher.compile(signature)
            dispatcher.disable_compile()
            return dispatcher

        if MODE == "uncompiled":
            return function
        whole = made("", PIPELINE)
        if MODE == "shortcuts":
            call_by_name(whole, None if inner else lambda: made(".from_python", ENTRY_PIPELINE))
        return whole

    return compile


def kept(made: Any, function: Callable[..., Any], part: str = "") -> AbstractContextManager[None]:
    """Inside the block numba's dispatcher of a function loads its code from the cache, or keeps it there.

    ``part``: which of several codes of one function.
    """
    return cached(made, function, f"{cache_folder(function.__module__)}/{function.__qualname__}{part}", CACHE)


COMMON = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
UNWRAPPED = {"no_cpython_wrapper": MODE == "shortcuts"}
"""numba as it is makes a Python entry for every function, and would crash without it."""
HELPER = {**COMMON, **UNWRAPPED, **HELPER_PIPELINE}

inlined = njit(**HELPER)
"""A helper of kernels: compiled with its caller, for the types it is called with; not callable from Python."""

woven = njit(inline="always", **COMMON)
"""Inlined in its caller before compilation: for small functions around a large one, whose code they would repeat."""


def lean(signature: Any, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """A kernel that makes no arrays (slices may be taken): it counts no references, which saves some 100 ns a call."""
    return kernel(signature, _nrt=False, **options)


lean_inlined = njit(_nrt=False, **HELPER)
"""A helper of lean kernels."""


_uncompiled: list[Any] = [None]
"""Where numba is switched off, the functions whose numbers stand for addresses."""


def address(function: Any, kind: Any) -> int:
    """Address of a compiled kernel of FunctionType ``kind``, for ``function_at``; never 0."""
    return _number_of(function) if config.DISABLE_JIT else address_of(function, kind.signature.args)


@cache
def _number_of(function: Any) -> int:
    """What stands for an address where numba is switched off."""
    _uncompiled.append(function)
    return len(_uncompiled) - 1


@cache
def address_of(function: Any, arguments: Any) -> int:
    """Address of a compiled kernel that takes such arguments, which lives on; to ask LLVM takes 50 us."""
    compiled = function.overloads[arguments]
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))


def function_at(kind: Any) -> Any:
    """An intrinsic that gives kernels a callable function for an ``address``.

    numba can take functions as arguments, but asks Python for their addresses at every call (50 us each). Kernels call
    a function that is always the same by its name instead.
    """
    if config.DISABLE_JIT:
        return lambda number: _uncompiled[number]

    @intrinsic
    def at(typing: Any, address: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            value = cgutils.create_struct_proxy(kind)(context, builder)
            pointer = builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))
            # The address is never null, so LLVM drops the code for Python functions.
            builder.assume(cgutils.is_not_null(builder, pointer))
            value.jit_addr = pointer
            value.c_addr = value.py_addr = context.get_constant_null(types.voidptr)
            return value._getvalue()

        return kind(types.int64), code

    return at


def compiles() -> bool:
    """Whether kernels are compiled; NUMBA_DISABLE_JIT=1 lets Python run them as they are written."""
    return not config.DISABLE_JIT


def thread_count() -> int:
    """Threads to use: SCENEQL_THREADS, else the processors this process may run on."""
    return variables.threads() or max(1, len(os.sched_getaffinity(0)))


HANDED = 1e-4
"""Seconds after which a thread in Python gives way to one that waits; by default 5e-3, a third of a small frame."""


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    sys.setswitchinterval(min(HANDED, sys.getswitchinterval()))
    return ThreadPoolExecutor(threads, thread_name_prefix="sceneql")


def over_tiles(count: int, work: Callable[[int], object]) -> None:
    """Call ``work(tile)`` for every tile 0..count-1 here and on the pool; tiles must write to places of their own.

    Which thread takes which tile does not matter to the result, so the bytes are the same for any thread count.
    The first exception is raised after all threads have stopped, and after it no tile is begun.
    """
    upcoming = iter(range(count))
    lock = threading.Lock()

    def drain() -> None:
        try:
            while True:
                with lock:
                    tile = next(upcoming, None)
                if tile is None:
                    return
                work(tile)
        except BaseException:
            with lock:
                deque(upcoming, maxlen=0)
            raise

    # This thread takes tiles, too: if it slept, the threads that it wakes would have to find its core idle first.
    others = min(thread_count(), count) - 1
    futures = [_pool(others).submit(drain) for _ in range(others)]
    try:
        drain()
    finally:
        errors = [error for error in (future.exception() for future in futures) if error is not None]
    if errors:
        raise errors[0]
