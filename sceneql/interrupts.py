"""Ctrl-C, SIGTERM, SIGHUP and a limit of time: one way out of the program, at any instant without a traceback.

While a command runs they raise KeyboardInterrupt, which keeps what was made; before and after there is nothing to keep,
and they end the process at once. A signal that the caller has switched off (nohup) stays off.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


AT_LOCKS = ("__enter__", "__exit__", "acquire", "release")
"""Functions between whose lines a lock is taken or given back: broken off there, it would stay taken for ever."""
LATER, LATEST = 5e-3, 400
"""Seconds after which a signal is raised that comes in one of these, and how often; one that waits ends then."""


class _Received:
    first = 0
    """The number of the first signal; 0 before one has come."""
    count = 0
    late = 0
    """How often in a row it has come in one of AT_LOCKS."""
    held = 0
    """How many blocks are open that no signal may break off."""
    raising = 0


def _handle(handler: Callable[[int, FrameType | None], Any]) -> dict[int, Any]:
    """Set a handler where the caller has not switched the signal off; returns those before."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    before = {number: known for number, known in before.items() if known not in (signal.SIG_IGN, None)}
    for number in before:
        signal.signal(number, handler)
    return before


def end_at_once(code: int | None = None) -> None:
    """From here on a signal ends the process at once, with this exit code; by default with 128 and its number."""

    def end(number: int, frame: FrameType | None) -> None:
        os._exit(128 + number if code is None else code)

    _handle(end)


@contextmanager
def raised() -> Iterator[Callable[[], bool]]:
    """Signals raise KeyboardInterrupt inside the block; gives a function that says whether one has come.

    An exception in a callback of a C library (the compiler, say) is dropped there: then that function alone tells of
    the signal, and no message is printed of the exception.
    """
    if _Received.raising:
        yield lambda: _Received.first != 0
        return
    tell = sys.unraisablehook

    def forgotten(what: sys.UnraisableHookArgs) -> None:
        if what.exc_type is not KeyboardInterrupt:
            tell(what)

    _Received.first = _Received.count = 0
    before = _handle(_press)
    sys.unraisablehook = forgotten
    _Received.raising += 1
    try:
        yield lambda: _Received.first != 0
    finally:
        _Received.raising -= 1
        sys.unraisablehook = tell
        for number, handler in before.items():
            signal.signal(number, handler)


def _press(number: int, frame: FrameType | None) -> None:
    if frame is not None and frame.f_code.co_name in AT_LOCKS and _Received.late < LATEST:
        _Received.late += 1
        again = threading.Timer(LATER, _thread.interrupt_main, (number,))
        again.daemon = True
        with suppress(RuntimeError):  # no thread can be started: better a lock that stays taken than no end
            again.start()
            return
    _Received.late = 0
    _Received.first = _Received.first or number
    _Received.count += 1
    if not _Received.held:
        raise KeyboardInterrupt
    if _Received.count > 2:  # somebody will not wait
        os._exit(exit_code())


@contextmanager
def held() -> Iterator[None]:
    """A block that no signal breaks off, as of finishing a file; one that has come is raised at its end."""
    before = _Received.count
    _Received.held += 1
    try:
        yield
    finally:
        _Received.held -= 1
    if _Received.count > before and not _Received.held:
        raise KeyboardInterrupt


def exit_code() -> int:
    """128 and the number of the signal that has come first."""
    return 128 + (_Received.first or int(signal.SIGINT))


class Limit:
    """A limit of time: whether it has passed, and what was being done then."""

    passed = False
    doing = ""


@contextmanager
def within(seconds: float | None, doing: Callable[[], str]) -> Iterator[Limit]:
    """When the block has taken so many seconds KeyboardInterrupt is raised in it, as by a signal; None: never.

    ``doing`` tells what is done then. Signals are handled on the main thread alone.
    """
    limit = Limit()
    if seconds is None:
        yield limit
        return
    number = getattr(signal, "SIGALRM", signal.SIGINT)

    def end() -> None:
        limit.passed, limit.doing = True, doing()
        _thread.interrupt_main(number)

    timer = threading.Timer(min(seconds, threading.TIMEOUT_MAX), end)
    timer.daemon = True
    with raised():
        before = signal.signal(number, _press)
        timer.start()
        try:
            yield limit
        finally:
            timer.cancel()
            signal.signal(number, before)
            if limit.passed and _Received.first == number:
                _Received.first = 0  # nobody has ended the program
