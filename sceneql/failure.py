"""Errors that end a run, with the part, the time and the line of the script."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.span import Span


class RunFailure(Exception):
    """A run that cannot go on. ``part``: the part or field that failed; ``time`` [s] of the simulation."""

    def __init__(self, message: str, *, part: str, time: float, span: Span | None, help: str | None = None) -> None:
        self.message, self.part, self.time, self.span, self.help = message, part, time, span, help
        self.diagnostic = Diagnostic("run-failed", f"at {time:.6g} s, {part}: {message}", span, help)
        super().__init__(str(self.diagnostic))


@contextmanager
def failing_as(name: str, time: float, span: Span | None) -> Iterator[None]:
    """Report failures inside as those of a part at a time [s]; words refuse values by TypeError and ValueError."""
    try:
        yield
    except RunFailure as error:
        part = f"{name}.{error.part}" if error.part else name
        raise RunFailure(error.message, part=part, time=time, span=error.span or span, help=error.help) from error
    except (TypeError, ValueError) as error:
        raise RunFailure(str(error), part=name, time=time, span=span) from error


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
