"""A progress bar with the present activity, or lines on long runs without a terminal; raises interrupts that got lost.

Without a terminal there is a line a minute on an activity that takes long and the progress so far; otherwise, after 1,
2, 4, ... minutes, one with the number of frames and the remaining time.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sceneql import doing
from sceneql.interrupts import raised

if TYPE_CHECKING:
    from rich.progress import Progress

PATIENCE = 0.3
"""Time before the bar is drawn [s]; short tasks need none."""
LINES, LONG = 60.0, 30.0
"""Time between lines without a terminal, and age from which on an activity is told [s]."""


@contextmanager
def bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """Context manager: a function (done, total) that draws a bar on standard error while the block runs.

    It raises KeyboardInterrupt for a signal that was lost in a callback of a C library (`interrupts.raised`). An error
    caused by that callback's missing result is replaced by the interrupt, too.
    """
    with raised() as lost, _drawn(title) as draw:

        def step(done: int, total: int) -> None:
            if lost():
                raise KeyboardInterrupt
            draw(done, total)

        try:
            yield step
        except Exception as error:
            if lost():
                raise KeyboardInterrupt from error
            raise


@contextmanager
def _drawn(title: str) -> Iterator[Callable[[int, int], None]]:
    if not sys.stderr.isatty():
        with _lines(title) as step:
            yield step
        return
    shown = _Shown(title)
    waiting = threading.Timer(PATIENCE, shown.appear)
    waiting.daemon = True
    waiting.start()
    try:
        yield shown.step
    finally:
        waiting.cancel()
        waiting.join()
        shown.vanish()


@contextmanager
def _lines(title: str) -> Iterator[Callable[[int, int], None]]:
    ended, began = threading.Event(), time.monotonic()
    steps = [0, 0]

    def step(done: int, total: int) -> None:
        steps[:] = done, total

    def say() -> None:
        ticks = 0
        while not ended.wait(LINES):
            ticks += 1
            done, total = steps
            far = f"{done:,} of {total:,} ({100 * done // total} %), " if 0 < done < total else ""
            if what := doing.chain(LONG):
                print(f"{title}: {far}{what}", file=sys.stderr, flush=True)
            elif far and ticks & (ticks - 1) == 0:
                left = doing.duration((time.monotonic() - began) * (total - done) / done)
                print(f"{title}: {far}about {left} left", file=sys.stderr, flush=True)

    threading.Thread(target=say, daemon=True).start()
    try:
        yield step
    finally:
        ended.set()


class _Shown:
    """The bar and the present activity beside it, both also drawn between steps by the library's thread."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._progress: Progress | None = None
        self._steps: tuple[int, int | None] = (0, None)

    def appear(self) -> None:
        """Draw the bar from now on."""
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
        from rich.progress import TimeRemainingColumn as Remaining
        from rich.text import Text

        class Doing(ProgressColumn):
            def render(self, task: Task) -> Text:
                return Text(doing.now())

        columns = (TextColumn(self._title), BarColumn(), MofNCompleteColumn(), Remaining(), Doing())
        progress = Progress(*columns, console=Console(stderr=True), transient=True)
        done, total = self._steps
        progress.add_task(self._title, total=total, completed=done)
        progress.start()
        self._progress = progress

    def step(self, done: int, total: int) -> None:
        """Set the number of steps done, and of all."""
        self._steps = done, total
        if self._progress is not None:
            self._progress.update(self._progress.task_ids[0], completed=done, total=total)

    def vanish(self) -> None:
        """Leave the terminal as it was."""
        if self._progress is not None:
            self._progress.stop()
