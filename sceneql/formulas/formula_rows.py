"""The rows of a script's system of differential equations: its states, and errors in it."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import Any

from sceneql.compiled.printer import printable
from sceneql.kinds import Problem
from sceneql.quantities.derivative import components
from sceneql.quantities.diagnostic import suggestion
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Link, Symbol, walk

TIMES = ("t", "time")
_DERIVATIVES = tuple(map(re.compile, (r"d(\w+)/dt", r"d(\w+)", r"(\w+?)_?dot")))


_SECOND = re.compile(r"(?:d\^?2)?(\w+?)(?:_?(?:ddot|dotdot|dd|tt)|/dt\^?2)")


def _first_of(name: str, state: str) -> bool:
    """Whether a name is that of a state's rate in other notations, ``a_dot`` or ``v`` of ``x``."""
    return any((found := shape.fullmatch(name)) is not None and found[1] == state for shape in _DERIVATIVES)


def states(rows: Iterable[str]) -> list[str]:
    """The states of rows named ``y`` (first order) or ``a''`` (second order: a and a').

    All positions a stand first, then all velocities a' in the same order, then the states of first order.
    """
    rows = list(rows)
    second = [row.removesuffix("''") for row in rows if row.endswith("''")]
    return [*second, *(f"{name}'" for name in second), *(row for row in rows if not row.endswith("'"))]


def derived(row: str, start: Collection[str]) -> str:
    """The state whose rate other notations call so, ``da/dt``, ``da`` or ``a_dot``; empty for none."""
    named = (found[1] for shape in _DERIVATIVES if (found := shape.fullmatch(row)) is not None)
    return next((name for name in named if name in start), "")


@dataclass(frozen=True)
class Rows:
    """Bound formulas of one system; ``index``: the symbol of a copy's number, if any."""

    start: Mapping[str, Expr]
    rate: Mapping[str, Expr]
    where: Mapping[str, Expr]
    invariants: Mapping[str, Expr]
    gives: Mapping[str, Expr]
    index: str | None

    @property
    def states(self) -> list[str]:
        """The states, in their order in y."""
        return states(self.rate)

    def row_of(self, state: str) -> str:
        """The row that gives a state's rate: ``a''`` for both a and a'."""
        name = state.rstrip("'")
        return name if name in self.rate else f"{name}''"

    def rates(self) -> list[Expr]:
        """dy/dt of every state."""
        second = [row.removesuffix("''") for row in self.rate if row.endswith("''")]
        velocities: list[Expr] = [Symbol(f"{name}'") for name in second]
        return [
            *velocities,
            *(self.rate[f"{name}''"] for name in second),
            *(expr for row, expr in self.rate.items() if not row.endswith("'")),
        ]

    def everything(self) -> Iterator[Expr]:
        """All formulas."""
        for formulas in (self.start, self.rate, self.where, self.invariants, self.gives):
            yield from formulas.values()

    def links(self) -> list[Link]:
        """The outputs of other parts that the formulas read."""
        nodes = (node for expr in self.everything() for node in walk(expr))
        return list(dict.fromkeys(node for node in nodes if isinstance(node, Link)))

    def look_up(
        self, known: dict[str, Any], link: Callable[[Link], Any], *, arrays: bool = False
    ) -> Callable[[Symbol | Link], Any]:
        """Look-up function for `evaluate`.

        ``known`` has the states, times and index, and caches helper quantities; ``link`` evaluates links.
        """

        def find(node: Symbol | Link) -> Any:
            if isinstance(node, Link):
                return link(node)
            left = [node.name]
            while left:  # dependencies first; without recursion, as chains may be long
                name = left[-1]
                symbols = [] if name in known else [each for each in walk(self.where[name]) if isinstance(each, Symbol)]
                needed = [each.name for each in symbols if each.name in self.where and each.name not in known]
                if not needed and name not in known:
                    known[name] = evaluate(self.where[name], find, arrays=arrays)
                left = [*left, *needed] if needed else left[:-1]
            return known[node.name]

        return find

    def problems(self) -> list[Problem]:
        """Errors of the system."""
        found = [*self._row_problems(), *self._name_problems(), *self._scalar_problems()]
        return found or [*self._use_problems(), *self._circle_problems()]

    def _row_problems(self) -> Iterator[Problem]:
        if not self.rate:
            yield Problem("a system needs a rate: `y: ...` is dy/dt, `a'': ...` is d²a/dt²", ("rate",))
        if (dotted := self._dotted()) is not None:
            yield dotted
            return
        called = {row: name for row in self.rate if row not in self.start and (name := derived(row, self.start))}
        for row, name in called.items():
            help = None if (span := self.rate[row].span) is None else f"write `{name}: {span.text}`"
            yield Problem(f"the rate of {name} is written '{name}', without `{row}`", ("rate", row), True, help=help)
        if called:
            return
        primed = [row for row in self.rate if row[-1:] == "'" != row[-2:-1] and row[:-1] in self.start]
        for row in primed:
            name, span = row[:-1], self.rate[row].span
            help = (
                f"it is the rate already: write `{name}: {'...' if span is None else span.text}`, which is d{name}/dt"
            )
            yield Problem(f"the rate of {name} is written '{name}', without `{row}`", ("rate", row), True, help=help)
        if primed:
            return
        for row in self.rate:
            name = row.rstrip("'")
            order = len(row) - len(name)
            if order == 1:
                yield Problem(f"the rate of {name} is written '{name}'; of second order, '{name}'''", ("rate", row))
            if order > 2:
                yield Problem(f"'{row}' is of order {order}: write it as rows of first and second order", ("rate", row))
            if order == 2 and (name in self.rate or f"{name}'" in self.rate):
                yield Problem(f"{name} has rows of first and of second order", ("rate", row))
        known = self.states
        for state in known:
            if state not in self.start:
                text = f"{state} has a rate but no value at the start"
                yield Problem(text, ("rate", self.row_of(state)), help=f"write `{state}: 0` in `start`, or what it is")
        for name in self.start:
            if name not in known:
                hint = suggestion(name, known)
                yield Problem(
                    f"{name} has a value at the start but no rate{f': {hint}' if hint else ''}", ("start", name)
                )

    def _dotted(self) -> Problem | None:
        """The problem of derivatives that are written with letters, ``a_dot`` and ``a_ddot``, where strokes tell them.

        None where there are none of second order.
        """
        names = {row: found[1] for row in self.rate if (found := _SECOND.fullmatch(row)) is not None}
        first = {name: of for name in self.start for of in names.values() if _first_of(name, of)}
        if not names or not {*names.values()} <= {*self.start}:
            return None
        texts = {key: expr.span.text if expr.span else "..." for key, expr in self.start.items()}
        start = ", ".join(f"{first[key]}': {text}" if key in first else f"{key}: {text}" for key, text in texts.items())
        rates = []
        for row, expr in self.rate.items():
            if row in first:
                continue
            text = expr.span.text if expr.span else "..."
            for name, of in first.items():
                text = re.sub(rf"(?<![\w.]){name}\b", f"{of}'", text)
            rates.append(f"{names[row]}'': {text}" if row in names else f"{row}: {text}")
        row = next(iter(names))
        help = f"derivatives have strokes: write `start: {{{start}}}, rate: {{{', '.join(rates)}}}`"
        return Problem(f"'{row}' is no state: it is {names[row]}''", ("rate", row), True, help=help)

    def _name_problems(self) -> Iterator[Problem]:
        taken = dict.fromkeys(TIMES, "the time")
        if self.index is not None:
            taken[self.index] = "the number of a copy"
        for field, names, what in (
            ("start", self.states, "a state"),
            ("where", self.where, "a helper quantity"),
            ("invariants", self.invariants, "an invariant"),
            ("gives", self.gives, "an output"),
        ):
            for name in names:
                if name in taken:
                    yield Problem(f"'{name}' is the name of {taken[name]} already", (field, name))
                taken.setdefault(name, what)

    def _scalar_problems(self) -> Iterator[Problem]:
        for field, formulas in (("start", self.start), ("rate", self.rate), ("where", self.where)):
            for name, expr in formulas.items():
                if expr.type.shape != () or not printable(components(expr)[0]):
                    yield Problem(f"{name} must be one number, computed from numbers", (field, name))
        for name, expr in self.invariants.items():
            if expr.type.shape != ():
                yield Problem(f"the invariant {name} is one number", ("invariants", name))
        for name, expr in self.gives.items():
            if expr.type.shape not in ((), (3,)):
                yield Problem(f"{name} must be one number or a vector of 3", ("gives", name))

    def _use_problems(self) -> Iterator[Problem]:
        for name, expr in self.start.items():
            for node in walk(expr):
                if isinstance(node, Symbol) and node.name != self.index:
                    yield Problem(f"'{node.name}' has no value before the start", ("start", name))

    def _circle_problems(self) -> Iterator[Problem]:
        uses = {name: [n.name for n in walk(expr) if isinstance(n, Symbol)] for name, expr in self.where.items()}
        try:
            TopologicalSorter(uses).prepare()
        except CycleError as error:
            circle = list(reversed(error.args[1]))
            yield Problem(f"{circle[0]} is defined by itself: {' -> '.join(circle)}", ("where", circle[0]))
