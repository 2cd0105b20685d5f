"""What the program is doing, in words: said where the work is done, shown by a progress bar on a thread of its own."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

LONG = 0.5
"""Seconds after which it is worth showing: what takes less flickers."""
MINUTES, HOURS = 100.0, 6000.0
"""Seconds from which on a time is told in minutes, in hours."""


class Deed:
    """What is being done; ``what`` may tell more while it goes on."""

    def __init__(self, what: str) -> None:
        self.what, self.since = what, time.monotonic()


_deeds: list[Deed] = []


@contextmanager
def doing(what: str) -> Iterator[Deed]:
    """Say what the block does, as ``filling bone``. Blocks may lie within one another, and on several threads."""
    deed = Deed(what)
    _deeds.append(deed)
    try:
        yield deed
    finally:
        _deeds.remove(deed)


def now(longer: float | None = None) -> str:
    """The innermost of what has been done for longer than so many seconds, by default LONG; empty where nothing has."""
    begun = time.monotonic() - (LONG if longer is None else longer)
    return next((deed.what for deed in reversed([*_deeds]) if deed.since <= begun), "")


def chain(longer: float) -> str:
    """All that is being done, outermost first, if that has lasted for so many seconds: ``running ahead: filling``."""
    deeds = [*_deeds]
    return ": ".join(deed.what for deed in deeds) if deeds and deeds[0].since <= time.monotonic() - longer else ""


def duration(seconds: float) -> str:
    """A time in words: `40 s`, `12 min`, `2.5 h`."""
    if seconds < MINUTES:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < HOURS else f"{seconds / 3600.0:.3g} h"
