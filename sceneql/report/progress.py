"""A progress bar, on a terminal only, which also raises interrupts that a library lost."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from sceneql.interrupts import raised


@contextmanager
def bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """A function of (done, total) that draws a bar on standard error while the block runs.

    It raises KeyboardInterrupt for a signal that was lost in a callback of a C library (`interrupts.raised`). An error
    for want of that callback's result becomes the interrupt, too.
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
        yield lambda done, total: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(title, total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)
