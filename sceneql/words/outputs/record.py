"""record: a table of quantities over time."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from io import StringIO
from typing import TYPE_CHECKING, Any, Literal

from sceneql.files import beside, whole
from sceneql.kinds import Clock, FixedTime, Measured, Moment, Output, Sink, Tools, bounded_moments, field

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Record(Output):
    """A table of outputs over time, in SI: CSV (one column a component) or NPZ (one array an entry, (frames, ...)).

    A list that grows and shrinks has the places of its longest; those behind its end are NaN.

    For example `table: {record: {of: [swing.bob.position.y, swing.energy], every: 10 ms}}`.
    """

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
        self.record, self.path = record, tools.path(record.format)
        self.titles = [
            " ".join(v.span.text.split()) if v.span is not None else f"value {k}" for k, v in enumerate(record.of)
        ]
        self.rows: list[list[Any]] = []

    def take(self, moment: Moment) -> None:
        self.rows.append([moment.time, *(moment.measure(value) for value in self.record.of)])

    def close(self) -> Iterable[Any]:
        return [self._write(self.path)]

    def abort(self) -> Iterable[Any]:
        return [self._write(beside(self.path, "partial"))] if self.rows else []

    def _write(self, path: Any) -> Any:
        with whole(path) as stream:
            if self.record.format == "npz":
                import numpy as np

                arrays = dict(zip(("time", *self.titles), self._columns(), strict=True))
                np.savez(stream, **arrays)  # type: ignore[arg-type]
            else:
                stream.write(self._csv().encode())
        return path

    def _columns(self) -> list[Floats]:
        """Arrays (rows, ...) of the time and of each entry."""
        if not self.rows:
            import numpy as np

            return [np.empty(0)] * (1 + len(self.titles))
        return [_stacked(values) for values in zip(*self.rows, strict=True)]

    def _csv(self) -> str:
        import numpy as np

        text = StringIO()
        table = csv.writer(text, lineterminator="\n")
        columns = self._columns()
        head = []
        for title, column in zip(("time", *self.titles), columns, strict=True):
            head += [".".join((title, *map(str, index))) for index in np.ndindex(column.shape[1:])]
        table.writerow(head)
        flat = np.concatenate([column.reshape(len(self.rows), -1) for column in columns], axis=1)
        table.writerows(map(repr, row) for row in flat.tolist())
        return text.getvalue()


def _stacked(values: Sequence[Any]) -> Floats:
    """Stack (n, ...) of n arrays with the same number of axes, shorter ones padded with NaN."""
    import numpy as np

    shapes = [np.shape(value) for value in values]
    stack = np.full((len(values), *np.max(np.array(shapes, dtype=int), axis=0)), np.nan)
    for k, (value, shape) in enumerate(zip(values, shapes, strict=True)):
        within: tuple[int | slice, ...] = (k, *map(slice, shape))
        stack[within] = value
    return stack
