"""What the program is doing, in words: said where the work is done, shown by a progress bar on a thread of its own."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

LONG = 0.5
"""Seconds after which it is worth showing: what takes less flickers."""


class _Deed:
    def __init__(self, what: str) -> None:
        self.what, self.since = what, time.monotonic()


_deeds: list[_Deed] = []


@contextmanager
def doing(what: str) -> Iterator[None]:
    """Say what the block does, as ``filling bone``. Blocks may lie within one another, and on several threads."""
    deed = _Deed(what)
    _deeds.append(deed)
    try:
        yield
    finally:
        _deeds.remove(deed)


def now() -> str:
    """The innermost of what has been done for longer than LONG; empty where nothing has."""
    begun = time.monotonic() - LONG
    return next((deed.what for deed in reversed([*_deeds]) if deed.since <= begun), "")
