"""Compilation on a second core: a second process compiles modules of kernels, and this one loads them from the cache.

Compiling holds the interpreter's lock, so a second core can only help from a second process.
"""

from __future__ import annotations

import atexit
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cache
from importlib import import_module
from queue import SimpleQueue
from typing import IO, Any, NoReturn, cast

from numba.core.event import Listener

from sceneql.compiled.kernels import CACHE, OURS, cache_folder, compiled, compiles, numba_event, thread_count
from sceneql.doing import doing
from sceneql.interrupts import SIGNALS


def compile_beside(modules: Iterable[str]) -> Callable[..., None]:
    """Start compiling modules in a second process, in this order, if not compiled yet; call the result to load them.

    The call imports these modules, the last one first, except those whose names are its arguments; it counts as
    compilation time. Generated modules are left out.
    """
    ours = [module for module in modules if module.partition(".")[0] in OURS[:2]]
    marks = {module: f"{cache_folder(module)}/all.compiled" for module in ours}
    due = [module for module, mark in marks.items() if not CACHE.has(mark)]
    if not due or not compiles():
        return lambda *but: None
    CACHE.prove()
    if thread_count() > 1:
        with suppress(BrokenPipeError):  # the import here will report why it ended
            names = _beside()
            names.write("".join(f"{module} {marks[module]}\n" for module in due))
            names.flush()

    def wait(*but: str) -> None:
        wanted = [module for module in due if module not in but]
        with compiled.whole_block(), doing("compiling"):
            for module in reversed(wanted):
                import_module(module)
        for module in wanted:
            CACHE.mark(marks[module])

    return cache(wait)


def compile_named(names: Iterable[str]) -> NoReturn:
    """The second process's loop: import the module named by each line, then set the mark named behind it.

    It ends, even in the middle of a module, when the lines end: with the first process, however that ended. Ctrl-C is
    left to the first process, which reports what it has kept and then ends this one. Errors, as trouble with the cache,
    end this process silently: the first one meets them, too.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    CACHE.second = True
    lines: SimpleQueue[str] = SimpleQueue()

    def read() -> None:
        for line in names:
            lines.put(line)
        os._exit(0)

    try:
        threading.Thread(target=read, daemon=True).start()
        while True:
            module, mark = lines.get().split()
            import_module(module)
            CACHE.mark(mark)
    except BaseException:
        os._exit(1)


class _Told(Listener):
    """Listener that shows the progress text "compiling" while a function is compiled."""

    def __init__(self) -> None:
        self._open: list[AbstractContextManager[object]] = []

    def on_start(self, event: Any) -> None:
        """A compilation begins, perhaps within another one."""
        self._open.append(doing("compiling"))
        self._open[-1].__enter__()

    def on_end(self, event: Any) -> None:
        """A compilation ends."""
        self._open.pop().__exit__(None, None, None)


numba_event.register("numba:compile", _Told())


@cache
def _beside() -> IO[str]:
    """A pipe to the second process, which ends with this one.

    A fork need not import numba once more, but is only safe with one thread: locks of others would never be released.
    """
    with _no_signals():
        if sys.platform == "linux" and threading.active_count() == 1:
            return _copied()
        command = "import sys; from sceneql.compiled.compile_beside import compile_named; compile_named(sys.stdin)"
        process = subprocess.Popen([sys.executable, "-c", command], stdin=subprocess.PIPE, text=True)
    atexit.register(process.kill)
    return cast("IO[str]", process.stdin)


@contextmanager
def _no_signals() -> Iterator[None]:
    """Context manager: a process started inside ignores the signals that end this one, if there are signal masks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _copied() -> IO[str]:
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # about threads that are not Python's: BLAS ends its own
        process = os.fork()
    if process == 0:
        _work_and_end(reading)
    os.close(reading)

    def end() -> None:
        with suppress(ProcessLookupError, ChildProcessError):
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)

    atexit.register(end)
    return os.fdopen(writing, "w")


def _work_and_end(reading: int) -> NoReturn:
    """Compile the modules named in a pipe, without the first process's exit handlers and open files; never returns."""
    try:
        os.closerange(3, reading)
        os.closerange(reading + 1, os.sysconf("SC_OPEN_MAX"))
        compile_named(os.fdopen(reading))
    finally:
        os._exit(1)
