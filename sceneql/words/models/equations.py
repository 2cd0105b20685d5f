"""`equations`: any system of ordinary differential equations, written in the script."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.formulas.formula_rows import TIMES, Rows, derived, states
from sceneql.island.static_rates import told_slope
from sceneql.kinds import Clock, Doubt, FixedLength, Formula, Gives, Model, Problem, Record, Value, field, quantity_type
from sceneql.kinds.stable_step import Oscillation, StaticScene, oscillations
from sceneql.quantities import dimension as dim
from sceneql.quantities.derivative import components
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Link, Number, Symbol, each_once, walk

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.formulas.rate_program import RateSystem
    from sceneql.frame import Floats
    from sceneql.system import Assembly, ModelState, Slopes


MOST_STATES = 32
"""Largest number of states for which `check` computes the modes of a system."""


class Copies(Record):
    """The same system several times, side by side."""

    count: int = field("How many.", at_least=1, at_most=1_000_000)
    as_: str = field("Name of a copy's number in the formulas: 0, 1, ..., count - 1.", "i")


TURN, DEGREES = 6.3, 360.0
"""Angles [rad] between which most likely degrees are meant."""


class Equations(Model):
    """A system of ordinary differential equations, dy/dt = f(t, y), as a textbook writes it.

    States, `t` (or `time`, [s]), helper quantities and defines are plain numbers inside the formulas, in SI. A row
    ``a'': f`` is the second-order equation d²a/dt² = f; it stands for da/dt = a' and da'/dt = f, and solvers that
    treat positions and velocities apart (semi-implicit Euler) see a as a position and a' as its velocity. The rate is
    compiled by its form: other numbers or more copies compile nothing. The Jacobian is derived symbolically.

    Outputs: every state, invariant and entry of `gives` under its own name; with `copies`, lists of them.
    """

    has_bodies = False
    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("dx/dt", "dy/dt", "dz/dt"), "write `start: {x: 1, y: 1}` and `rate: {x: ..., y: ...}`"
    )

    start: dict[str, Formula] = field("State at the start: `{a: 90 deg, a': 0}`.")
    rate: dict[str, Formula] = field("Rates: `y: ...` is dy/dt, `a'': ...` is d²a/dt² (then a and a' are states).")
    where: dict[str, Formula] = field("Quantities that the formulas use, each evaluated once.", {})
    invariants: dict[str, Formula] = field("What the exact solution conserves: outputs, for `relative_drift`.", {})
    gives_: dict[str, Formula] = field("Outputs made of the states: numbers, or points for objects to link to.", {})
    unit: FixedLength = field("Length that 1 stands for in the vectors that it gives.", "1 m")
    copies: Copies | None = field("The same system several times; its number may stand in every formula.", None)

    @classmethod
    def formula_symbols(cls, written: Mapping[str, Any]) -> tuple[str, ...]:
        """The free symbols of its formulas, from its fields as plain nested dicts and texts."""
        rate, start = _mapping(written.get("rate")), _mapping(written.get("start"))
        meant = [*states(rate), *(row.rstrip("'") for row in rate), *start]  # their problems are reported later
        return tuple(dict.fromkeys([*meant, *_mapping(written.get("where")), *TIMES, *_index(written)]))

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """The states, the invariants, what `gives` says, and the numbers of the copies."""
        copies = _index(written)
        many: tuple[None, ...] = (None,) if copies else ()
        plain = quantity_type(dim.PLAIN, many)
        vector = quantity_type(dim.LENGTH, (*many, 3))
        result = {state: Gives(plain, f"The state {state}.") for state in states(_mapping(written.get("rate")))}
        result |= {name: Gives(plain, "A state whose rate is called otherwise.") for name in _misnamed(written)}
        result |= {name: Gives(plain, f"The invariant {name}.") for name in _mapping(written.get("invariants"))}
        for name, item in _mapping(written.get("gives")).items():
            result[name] = Gives(
                vector if isinstance(item, list) or "[" in str(item) else plain, "Given by the script."
            )
        return result | {name: Gives(plain, "The number of each copy.") for name in copies}

    @cached_property
    def rows(self) -> Rows:
        """Its formulas without their places in the script."""

        def exprs(formulas: Mapping[str, Formula]) -> dict[str, Expr]:
            return {name: formula.expr for name, formula in formulas.items()}

        return Rows(
            start=exprs(self.start),
            rate=exprs(self.rate),
            where=exprs(self.where),
            invariants=exprs(self.invariants),
            gives=exprs(self.gives_),
            index=None if self.copies is None else self.copies.as_,
        )

    @property
    def count(self) -> int:
        """Number of copies."""
        return 1 if self.copies is None else self.copies.count

    def doubts(self, clock: Clock) -> Iterator[Doubt]:
        """Angles at the start that are most likely degrees: states whose sine is taken, beyond a turn in radians."""
        turned = {
            arg.name
            for formula in (*self.rate.values(), *self.gives_.values())
            for node in walk(formula.expr)
            if isinstance(node, Call) and node.op in ("sin", "cos")
            for arg in node.args
            if isinstance(arg, Symbol)
        }
        for name in sorted(turned & self.start.keys()):
            formula = self.start[name]
            if isinstance(formula.expr, Number) and formula.expr.bare and TURN < abs(formula.expr.value) <= DEGREES:
                number = f"{formula.expr.value:g}"
                text = f"the angle {name} starts at {number} rad, which are turns"
                yield Doubt("radians", text, formula.span, f"in degrees write `{name}: {number} deg`")

    def problems(self) -> list[Problem]:
        """Rows that make no system, or one without a finite rate at the start."""
        return self.rows.problems() or self._first_rates()

    def _first_rates(self) -> list[Problem]:
        """Problems of rates not finite at the start of the first copy; none for a system that reads other parts."""
        rows = self.rows
        if rows.links():
            return []
        known = {**dict.fromkeys(TIMES, 0.0), **({} if rows.index is None else {rows.index: 0.0})}
        look_up = rows.look_up(known, _no_link)
        known |= {state: evaluate(rows.start[state], look_up) for state in rows.states}
        rates = zip(rows.states, rows.rates(), strict=True)
        return [
            Problem(f"the rate of {state} has no finite value at the start", ("rate", rows.row_of(state)))
            for state, expr in rates
            if not isfinite(evaluate(expr, look_up))
        ]

    def conserves(self) -> tuple[str, ...]:
        """Its invariants."""
        return tuple(self.invariants)

    def fastest(self, name: str, scene: StaticScene) -> Iterator[Oscillation]:
        """The modes at the start of the first copy, where nothing is read from other parts."""
        from sceneql.formulas.rate_program import derivatives

        rows = self.rows
        size = len(rows.states)
        if rows.links() or size > MOST_STATES:
            return
        known = {**dict.fromkeys(TIMES, 0.0), **({} if rows.index is None else {rows.index: 0.0})}
        look_up = rows.look_up(known, _no_link)
        known |= {state: float(evaluate(rows.start[state], look_up)) for state in rows.states}
        meanings = {helper: components(expr)[0] for helper, expr in rows.where.items()}
        entries, derived = derivatives(rows.states, meanings, [components(row)[0] for row in rows.rates()])
        look_up = replace(rows, where=meanings | derived).look_up(known, _no_link)
        slopes = [told_slope(float(evaluate(entry, look_up))) for entry in entries]
        matrix = [slopes[k : k + size] for k in range(0, len(slopes), size)]
        half = size // 2
        if all(row.endswith("''") for row in rows.rate) and not any(any(row[half:]) for row in matrix[half:]):
            yield from oscillations([row[:half] for row in matrix[half:]], f"'{name}'", ("rate",), paired=True)
        else:
            yield from oscillations(matrix, f"'{name}'", ("rate",))

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve the states of all copies and add their compiled rate. Raises ScriptError for one not finite."""
        from sceneql.formulas.rate_program import RateSystem, rate_kernel

        rows = self.rows
        start = self._start(assembly)
        names = [rows.row_of(state) for state in rows.states]
        at = assembly.state(start, [self.rate[row].span for row in names] * self.count, self._name)
        positions = sum(row.endswith("''") for row in rows.rate)
        for copy in range(self.count if positions else 0):
            first = at + copy * len(names)
            assembly.pair(first, first + positions, positions)
        system = RateSystem(tuple(rows.states), tuple(rows.rates()), rows.where, rows.index)
        kernel = rate_kernel(system)
        inputs = [assembly.value(Value(expr)) for expr in kernel.inputs]
        for expr in (*rows.rates(), *rows.where.values()):
            assembly.stop_at_breakpoints(expr)
        ints = (assembly.floats(kernel.constants), at, self.count, *inputs)
        assembly.term("internal", kernel.name, ints, lambda: _slopes(system, at, self.count, assembly))
        links = [assembly.value(Value(link)) for link in rows.links()]
        assembly.remember(at, *links)

    def _name(self, entry: int) -> str:
        """Name of the state at an entry, with the number of its copy."""
        copy, number = divmod(entry, len(self.rows.states))
        return self.rows.states[number] + ("" if self.copies is None else f" of copy {copy}")

    def _start(self, assembly: Assembly) -> Floats:
        """Start values (count * states,). Raises ScriptError for a rate that is not finite there."""
        import numpy as np

        rows = self.rows
        known: dict[str, Any] = dict.fromkeys(TIMES, 0.0)
        if rows.index is not None:
            known[rows.index] = np.arange(self.count, dtype=np.float64)
        look_up = rows.look_up(known, lambda link: assembly.initial(Value(link)), arrays=True)

        def column(expr: Expr) -> Floats:
            return np.broadcast_to(np.asarray(evaluate(expr, look_up, arrays=True), dtype=np.float64), self.count)

        values = {state: column(rows.start[state]) for state in rows.states}
        known |= values
        for state, expr in zip(rows.states, rows.rates(), strict=True):
            try:
                bad = np.flatnonzero(~np.isfinite(column(expr)))
            except ScriptError:  # it reads states of the same island without a place yet: the run checks the start
                continue
            if len(bad):
                copy = "" if rows.index is None else f" of copy {bad[0]}"
                message = f"the rate of {state}{copy} has no finite value at the start"
                raise ScriptError([Diagnostic("not-finite", message, self.rate[rows.row_of(state)].span)])
        return np.stack(list(values.values()), axis=1).ravel()

    def read(self, output: str, state: ModelState) -> Any:
        """An output: float or (3,); with copies (count,) or (count, 3)."""
        import numpy as np

        rows, column = self.rows, self._columns(state)
        if output in rows.gives:
            expr = rows.gives[output]
            parts = [column(part) for part in components(expr)]
            result = np.stack(parts, axis=1) * self.unit if expr.type.shape else parts[0]
        else:
            result = column(rows.invariants[output] if output in rows.invariants else Symbol(output))
        return result if self.copies is not None else result[0]

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the states, and of outputs that are made of nothing else."""
        import numpy as np

        rows = self.rows
        expr = rows.gives.get(output, rows.invariants.get(output, Symbol(output)))
        parts = [part.name if isinstance(part, Symbol) else "" for part in components(expr)]
        if not set(parts) <= set(rows.states) or (expr.type.shape and self.unit != 1.0):
            return None
        first = state.ints[0] + len(rows.states) * np.arange(self.count)
        found: NDArray[int64] = np.add.outer(first, [rows.states.index(part) for part in parts])
        found = found if expr.type.shape else found[:, 0]
        return found if self.copies is not None else np.array(found[0])

    def size_of(self, output: str, state: ModelState) -> Any:
        """The sum of the magnitudes of the terms of an invariant's formula."""
        column = self._columns(state)
        return sum(count * abs(column(term)) for term, count in _terms(self.rows.invariants[output]))

    def _columns(self, state: ModelState) -> Callable[[Expr], Floats]:
        """Function that evaluates a formula for every copy, (count,), at a state."""
        import numpy as np

        rows = self.rows
        at, *links = state.ints
        size = len(rows.states)
        y = state.y[at : at + self.count * size].reshape(self.count, size)
        known: dict[str, Any] = dict.fromkeys(TIMES, state.t)
        known |= {name: y[:, k] for k, name in enumerate(rows.states)}
        if rows.index is not None:
            known[rows.index] = np.arange(self.count, dtype=np.float64)
        offsets = dict(zip(rows.links(), links, strict=True))

        def linked(link: Link) -> Any:
            first = offsets[link]
            return state.floats[first : first + 3] if link.type.shape else state.floats[first]

        look_up = rows.look_up(known, linked, arrays=True)
        return lambda expr: np.array(np.broadcast_to(evaluate(expr, look_up, arrays=True), self.count))


def _terms(expr: Expr) -> Iterator[tuple[Expr, float]]:
    """Terms of a formula that is a sum or difference, and how often each occurs."""

    def added(node: Expr) -> tuple[Expr, ...]:
        return node.args if isinstance(node, Call) and node.op in ("add", "sub", "neg") else ()

    order = each_once(expr, below=added)
    counts = {id(expr): 1.0}
    for node in reversed(order):
        for arg in added(node):
            counts[id(arg)] = counts.get(id(arg), 0.0) + counts[id(node)]
    yield from ((node, counts[id(node)]) for node in order if not added(node))


def _slopes(system: RateSystem, at: int, count: int, assembly: Assembly) -> Slopes | None:
    """Symbolic Jacobian of each copy; None if an operation has no derivative."""
    import numpy as np

    from sceneql.formulas.rate_program import jacobian_kernel
    from sceneql.system import Slopes

    try:
        kernel = jacobian_kernel(system)
    except TypeError:
        return None
    rows, columns = np.divmod(np.array(kernel.places, dtype=np.int64), len(system.states))
    first = at + len(system.states) * np.arange(count)[:, None]
    inputs = [assembly.value(Value(expr)) for expr in kernel.inputs]
    ints = (assembly.floats(kernel.constants), at, count, *inputs)
    return Slopes(kernel.name, (first + rows).ravel(), (first + columns).ravel(), ints)


def _no_link(link: Link) -> Any:
    raise LookupError(link)


def _misnamed(written: Mapping[str, Any]) -> list[str]:
    """States whose rates other notations call ``da/dt``: an error of its own, so that reading them is none."""
    start = _mapping(written.get("start"))
    return [name for row in _mapping(written.get("rate")) if row not in start and (name := derived(row, start))]


def _mapping(item: Any) -> Mapping[str, Any]:
    return item if isinstance(item, Mapping) else {}


def _index(written: Mapping[str, Any]) -> list[str]:
    """Symbol of a copy's number, in a list; empty without copies."""
    copies = written.get("copies")
    return [str(copies.get("as", "i"))] if isinstance(copies, Mapping) else []
