"""Errors that end a run, with the part, the time and the line of the script."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager

from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.span import Span


class RunFailure(Exception):
    """A run that cannot go on. ``part``: the part or field that failed; ``time`` [s] of the simulation."""

    code = "run-failed"

    def __init__(self, message: str, *, part: str, time: float, span: Span | None, help: str | None = None) -> None:
        self.message, self.part, self.time, self.span, self.help = message, part, time, span, help
        self.diagnostic = Diagnostic(self.code, f"at {time:.6g} s, {part}: {message}", span, help)
        super().__init__(str(self.diagnostic))

    def within(self, name: str, span: Span | None) -> RunFailure:
        """The same failure as one of a part that holds the one that failed."""
        part = f"{name}.{self.part}" if self.part else name
        return type(self)(self.message, part=part, time=self.time, span=self.span or span, help=self.help)

    def helped(self, help: str) -> RunFailure:
        """The same failure, with what helps."""
        return type(self)(self.message, part=self.part, time=self.time, span=self.span, help=help)

    def giving_way(self) -> GivesWay:
        """The same failure, where there is another way for what is left."""
        return GivesWay(self.message, part=self.part, time=self.time, span=self.span, help=self.help)


class GivesWay(RunFailure):
    """A run that cannot go on as it does, where a word has another way for what is left of it."""


class OutOfMemory(RunFailure):
    """A run that cannot go on for want of memory."""

    code = "out-of-memory"


class OutOfTime(RunFailure):
    """A run that has taken longer than it may."""

    code = "out-of-time"


@contextmanager
def failing_as(name: str, time: float, span: Span | None) -> Iterator[None]:
    """Report failures inside as those of a part at a time [s]; words refuse values by TypeError and ValueError.

    What is refused for its size gets the part's place in the script.
    """
    try:
        yield
    except RunFailure as error:
        raise error.within(name, span) from error
    except MemoryError as error:
        raise OutOfMemory(want_of_memory(error), part=name, time=time, span=span) from error
    except EOFError as error:
        raise RunFailure(f"a file ends too soon: {error}", part=name, time=time, span=span) from error
    except (TypeError, ValueError) as error:
        raise RunFailure(str(error), part=name, time=time, span=span) from error
    except LimitRefused as error:
        raise error.at(span) from error.__cause__


_SIGNS = ("annot allocate memory", "failed to map segment", "can't start new thread")
"""What the loader of libraries says, and Python of threads, where there is no memory for them."""


def starved(error: BaseException | None) -> BaseException | None:
    """The want of memory that an error is, or comes from, whatever a library has made of it; else None."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        if isinstance(error, MemoryError | OutOfMemory) or getattr(error, "errno", None) == errno.ENOMEM:
            return error
        if isinstance(error, ImportError | OSError | RuntimeError) and any(sign in str(error) for sign in _SIGNS):
            return error
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return None


def want_of_memory(error: BaseException) -> str:
    """``out of memory``, with how much was asked for, and by whom, where the error or what it comes from tells."""
    told = str(starved(error) or error)
    asked = told.removeprefix("Unable to allocate ")
    if not asked:
        return "out of memory"
    return f"out of memory for {asked}" if asked != told else f"out of memory: {asked.splitlines()[0]}"


class LimitRefused(Exception):
    """Something that would need more memory or work than is allowed, refused before it starts."""

    def __init__(self, message: str, span: Span | None = None, help: str | None = None) -> None:
        self.diagnostic = Diagnostic("limit-refused", message, span, help)
        super().__init__(str(self.diagnostic))

    def at(self, span: Span | None) -> LimitRefused:
        """The same error with its place in the script, unless it has one."""
        told = self.diagnostic
        return self if told.span is not None else LimitRefused(told.message, span, told.help)


class Unsuitable(ValueError):
    """A request that does not suit the scene: one file for several outputs, a benchmark without physics."""


@contextmanager
def failing_itself(name: str, time: float, span: Span | None) -> Iterator[None]:
    """As `failing_as`, of an output: the parts that fail in it tell so themselves, and a refused request is none."""
    try:
        yield
    except (RunFailure, Unsuitable, MemoryError):
        raise
    except (EOFError, TypeError, ValueError):
        with failing_as(name, time, span):
            raise
