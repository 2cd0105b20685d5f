"""Ctrl-C, SIGTERM, SIGHUP and a limit of time: one way out of the program, at any instant without a traceback.

While a command runs they raise KeyboardInterrupt, which keeps what was made; before and after there is nothing to keep,
and they end the process at once. A signal that the caller has switched off (nohup) stays off.

The interpreter handles signals between its own instructions, so that none is heard while compiled code is in a step
that does not end. A thread keeps what was made then, and ends the process.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any, ClassVar

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


AT_LOCKS = ("__enter__", "__exit__", "acquire", "release")
"""Functions between whose lines a lock is taken or given back: broken off there, it would stay taken for ever."""
LATER, LATEST = 5e-3, 400
"""Seconds after which a signal is raised that comes in one of these, and how often; one that waits ends then."""


DEAF = 10.0
"""Seconds after a signal in which the main thread must handle one: if not, another thread ends the process."""
STACK = 2**18
"""Bytes of that thread's stack: where little memory is left, the usual eight megabytes are missed."""
CALL = getattr(signal, "SIGURG", None)
"""The signal by which that thread asks; systems ignore it."""


class _Received:
    first = 0
    """The number of the first signal; 0 before one has come."""
    count = 0
    late = 0
    """How often in a row it has come in one of AT_LOCKS."""
    held = 0
    """How many blocks are open that no signal may break off."""
    raising = 0
    alive = 0
    """How often the interpreter has answered on the main thread that it handles signals."""
    keep: ClassVar[list[Callable[[], list[Path]]]] = []
    """What keeps what was made, if no signal can be handled."""


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

    if threading.current_thread() is threading.main_thread():
        _handle(end)


@contextmanager
def raised(tell: Callable[[BaseException], int] = lambda error: exit_code()) -> Iterator[Callable[[], bool]]:
    """Signals raise KeyboardInterrupt inside the block; gives a function that says whether one has come.

    ``tell``: tells of a signal that could not be handled, what was kept as ``error.kept``; returns the exit code.
    An exception in a callback of a C library (the compiler, say) is dropped there: then that function alone tells of
    the signal, and no message is printed of the exception.
    """
    if _Received.raising:
        yield lambda: _Received.first != 0
        return
    hook = sys.unraisablehook

    def forgotten(what: sys.UnraisableHookArgs) -> None:
        if what.exc_type is not KeyboardInterrupt:
            hook(what)

    _Received.first = _Received.count = 0
    before = _handle(_press)
    sys.unraisablehook = forgotten
    _Received.raising += 1
    try:
        with _minded(tell):
            yield lambda: _Received.first != 0
    finally:
        _Received.raising -= 1
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _minded(tell: Callable[[BaseException], int]) -> Iterator[None]:
    """A thread minds that signals are handled inside the block."""
    if CALL is None:
        yield
        return
    read, write = os.pipe()
    os.set_blocking(write, False)
    ended = threading.Event()
    thread = threading.Thread(target=_mind, args=(read, threading.get_ident(), CALL, ended, tell), daemon=True)
    before, woken = signal.signal(CALL, _answer), signal.set_wakeup_fd(write, warn_on_full_buffer=False)
    whole = threading.stack_size(STACK)
    thread.start()
    threading.stack_size(whole)
    try:
        yield
    finally:
        ended.set()
        signal.set_wakeup_fd(woken)
        signal.signal(CALL, before)
        os.write(write, b"\0")
        thread.join()
        os.close(read)
        os.close(write)


def _answer(number: int, frame: FrameType | None) -> None:
    _Received.alive += 1


def _mind(read: int, main: int, call: int, ended: threading.Event, tell: Callable[[BaseException], int]) -> None:
    """End the process where a signal, whose number is read, meets a main thread that handles none for DEAF seconds."""
    while number := os.read(read, 1)[0]:
        if number not in SIGNALS:
            continue
        alive, end = _Received.alive, time.monotonic() + DEAF
        signal.pthread_kill(main, call)  # it also wakes a thread that waits
        while _Received.alive == alive and time.monotonic() < end and not ended.is_set():
            ended.wait(min(0.05, DEAF / 10))
        if _Received.alive == alive and not _Received.held and not ended.is_set():
            _Received.first = _Received.first or number
            error: Any = KeyboardInterrupt()
            error.kept = []
            with suppress(Exception):
                for keep in _Received.keep:
                    error.kept += keep()
                tell(error)
            os._exit(exit_code())


@contextmanager
def keeping(keep: Callable[[], list[Path]]) -> Iterator[None]:
    """A block of which ``keep`` keeps what was made, and returns its files, where a signal cannot be handled."""
    _Received.keep.append(keep)
    try:
        yield
    finally:
        _Received.keep.remove(keep)


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
    _told = False

    def __init__(self, timer: threading.Timer | None = None) -> None:
        self._timer = timer

    def begin(self) -> None:
        """Count from here on."""
        if self._timer is not None:
            self._timer.start()

    def look(self) -> None:
        """Raise KeyboardInterrupt if it has passed: once, so that its signal raises none after that."""
        if self.passed:
            self._told = True
            raise KeyboardInterrupt

    def press(self, number: int, frame: FrameType | None) -> None:
        """Handle its signal, which may come once after `look` has told."""
        late, self._told = self._told, False
        if not late:
            _press(number, frame)


@contextmanager
def within(seconds: float | None, doing: Callable[[], str]) -> Iterator[Limit]:
    """So many seconds after `Limit.begin` KeyboardInterrupt is raised in the block, as by a signal; None: never.

    ``doing`` tells what is done then. Signals are handled on the main thread alone.
    """
    if seconds is None:
        yield Limit()
        return
    number = getattr(signal, "SIGALRM", signal.SIGINT)

    def end() -> None:
        limit.passed, limit.doing = True, doing()
        _thread.interrupt_main(number)

    timer = threading.Timer(min(seconds, threading.TIMEOUT_MAX), end)
    timer.daemon = True
    limit = Limit(timer)
    with raised():
        before = signal.signal(number, limit.press)
        try:
            yield limit
        finally:
            timer.cancel()
            signal.signal(number, before)
            if limit.passed and _Received.first == number:
                _Received.first = 0  # nobody has ended the program
