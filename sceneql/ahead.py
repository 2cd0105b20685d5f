"""Compiling on a second core: a process beside this one imports modules of kernels, and this one loads what it made.

Compiling holds the interpreter's lock, so a second core can only help from a second process.
"""

from __future__ import annotations

import atexit
import subprocess
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from importlib import import_module
from typing import IO, cast

from sceneql.kernels import OURS, cache_folder, compiled, compiles, thread_count

BESIDE = """
import signal, sys
from importlib import import_module
from pathlib import Path
signal.signal(signal.SIGINT, signal.SIG_IGN)
for line in sys.stdin:
    module, mark = line.rstrip("\\n").split(" ", 1)
    import_module(module)
    Path(mark).touch()
"""
"""Ctrl-C is for the process that says what was kept; it takes this one with it."""


def compile_ahead(modules: Iterable[str]) -> Callable[[], None]:
    """Have modules' kernels compiled beside, in this order, unless they were before; call the result to have them all.

    The call imports the modules from the last one on, and counts as compilation. Generated modules are left out.
    """
    ours = [module for module in modules if module.partition(".")[0] in OURS[:2]]
    marks = {module: cache_folder(module) / "all.compiled" for module in ours}
    due = [module for module, mark in marks.items() if not mark.exists()]
    if not due or not compiles():
        return lambda: None
    for module in due:
        marks[module].parent.mkdir(parents=True, exist_ok=True)
    if thread_count() > 1:
        with suppress(BrokenPipeError):  # what ended it will be said where the module is imported here
            names = _beside()
            names.write("".join(f"{module} {marks[module]}\n" for module in due))
            names.flush()

    def wait() -> None:
        with compiled.whole_block():
            for module in reversed(due):
                import_module(module)
        for module in due:
            marks[module].touch()

    return cache(wait)


@cache
def _beside() -> IO[str]:
    """Where to write names for the process, which ends with this one."""
    process = subprocess.Popen([sys.executable, "-c", BESIDE], stdin=subprocess.PIPE, text=True)
    atexit.register(process.terminate)
    return cast("IO[str]", process.stdin)
