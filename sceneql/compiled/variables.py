"""The variables of the environment that move the cache or choose how kernels run, read and checked.

Every kernel's machine code has this file in its key, and all that it imports: hence no error of ours, only ValueError.
"""

from __future__ import annotations

import os
from pathlib import Path

MOST_THREADS = 1024


def threads() -> int | None:
    """SCENEQL_THREADS; None where it is not set. Raises ValueError."""
    asked = os.environ.get("SCENEQL_THREADS")
    if not asked:
        return None
    if not (asked.isascii() and asked.isdigit() and len(asked) < 9 and 1 <= int(asked) <= MOST_THREADS):
        told = "it may be a whole number of threads"
        raise ValueError(f"SCENEQL_THREADS is {asked!r}: {told} from 1 to {MOST_THREADS}, or unset")
    return int(asked)


def plain() -> bool:
    """Whether SCENEQL_NUMBA asks for numba without our shortcuts. Raises ValueError."""
    asked = os.environ.get("SCENEQL_NUMBA")
    if asked and asked != "plain":
        raise ValueError(f"SCENEQL_NUMBA is {asked!r}: it may be 'plain', for numba without our shortcuts, or unset")
    return bool(asked)


def cache_home() -> Path | None:
    """The folder that ``sceneql/`` with all caches stands in; None where the user has no home."""
    asked = os.environ.get("SCENEQL_CACHE") or os.environ.get("XDG_CACHE_HOME")
    if asked:
        return Path(asked).absolute()
    try:
        return Path.home() / ".cache"
    except RuntimeError:
        return None


def check() -> None:
    """Raise ValueError where a variable has a value that it may not have."""
    threads()
    plain()
