"""The word `record`."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from io import StringIO
from typing import Any, Literal

from sceneql.files import beside, whole
from sceneql.kinds import Clock, FixedTime, Measured, Moment, Output, Sink, Tools, bounded_moments, field


class Record(Output):
    """A table of outputs over time, in SI: CSV (one column a component) or NPZ (one array an entry, (frames, ...))."""

    of: tuple[Measured, ...] = field("What is measured: outputs or expressions of them.")
    every: FixedTime | Literal["frame"] = field("Time between two rows, or `frame` for the film's.", "frame", above=0)
    format: Literal["csv", "npz"] = field("Kind of file.", "csv")

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] that it wants."""
        if isinstance(self.every, str):
            return clock.frames(clock.fps)
        count = int(bounded_moments(clock.end / self.every * (1 + 1e-12))) + 1
        return [min(k * self.every, clock.end) for k in range(count)]

    def open(self, tools: Tools) -> Sink:
        """Start it."""
        return _Table(self, tools)


class _Table:
    def __init__(self, record: Record, tools: Tools) -> None:
        self.record, self.tools = record, tools
        self.titles = [
            " ".join(v.span.text.split()) if v.span is not None else f"value {k}" for k, v in enumerate(record.of)
        ]
        self.rows: list[list[Any]] = []

    def take(self, moment: Moment) -> None:
        self.rows.append([moment.time, *(moment.measure(value) for value in self.record.of)])

    def close(self) -> Iterable[Any]:
        return [self._write(self.tools.path(self.record.format))]

    def abort(self) -> Iterable[Any]:
        return [self._write(beside(self.tools.path(self.record.format), "partial"))] if self.rows else []

    def _write(self, path: Any) -> Any:
        with whole(path) as stream:
            if self.record.format == "npz":
                import numpy as np

                columns = zip(*self.rows, strict=True)
                arrays = {t: np.array(c) for t, c in zip(("time", *self.titles), columns, strict=True)}
                np.savez(stream, **arrays)  # type: ignore[arg-type]
            else:
                stream.write(self._csv().encode())
        return path

    def _csv(self) -> str:
        from numpy import ndindex, shape

        text = StringIO()
        table = csv.writer(text, lineterminator="\n")
        first = self.rows[0] if self.rows else [0.0] * (1 + len(self.titles))
        head = []
        for title, value in zip(("time", *self.titles), first, strict=True):
            head += [".".join((title, *map(str, index))) for index in ndindex(shape(value))]
        table.writerow(head)
        for row in self.rows:
            table.writerow([repr(float(x)) for value in row for x in _flat(value)])
        return text.getvalue()


def _flat(value: Any) -> Any:
    from numpy import ravel

    return ravel(value)
