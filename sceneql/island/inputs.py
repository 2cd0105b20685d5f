"""Lowering of time-varying values of a script to programs for the interpreter of inputs_kernels.

A value may use the time, keyframes, outputs of kinematic models (formulas of time) and outputs of models that are
solved in the same island (entries of y).
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.island.lowering import LOWERINGS
from sceneql.kinds import Value
from sceneql.kinds.values import MOST_READ, unreadable
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import (
    TIME_SYMBOL,
    Call,
    Expr,
    Keys,
    Link,
    Number,
    Symbol,
    Vector,
    each_once,
    holders,
    recursive,
    walk,
)
from sceneql.quantities.key_tables import keys_table
from sceneql.quantities.simplify import ZERO

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

Register = int
Lowered = Any
"""A register, or a list of lowered components."""


Word = tuple[str, str | None]
"""(part of the scene, the model on which it acts if it is a force)."""
Stored = tuple[int, Value, Word]
"""A varying value: (offset of its first float, the value, the word that reads it)."""


class WithoutSlopes(Exception):
    """The derivatives of a part or value are not known; the text is its name."""


@dataclass(frozen=True, slots=True)
class ValueSlopes:
    """The derivatives of a value with respect to the state."""

    program: list[int]
    """The rows of the program that evaluates the derivatives."""
    readings: list[list[tuple[int, Register]]]
    """For each float of the value: (entry of y that it reads, offset of its derivative with respect to that entry)."""


class Inputs:
    """Lowers the values of one island to programs.

    ``formula`` returns a linked output as an expression, None where it is solved for; ``places``: the indices in y of
    such an output; ``start``: y at the start; ``store`` appends numbers to the floats and returns their offset.
    """

    def __init__(
        self,
        formula: Callable[[Link], Expr | None],
        places: Callable[[Link], NDArray[int64] | None],
        start: Callable[[], Floats],
        store: Callable[[Any], int],
    ) -> None:
        self._formula, self._places, self._start, self._store = formula, places, start, store
        self._known: dict[int, tuple[Expr, Lowered]] = {}
        self._varying: set[int] = set()
        """Ids of nodes of the expression being lowered that read the time or other parts."""
        self._at_start: dict[Link, Any] = {}
        self._rows: list[int] = []

    def at_start(self, value: Value) -> Any:
        """The value at time 0: float or float64 array.

        Raises ScriptError where it reads an output that is not stored in y.
        """
        self._at_start = {}
        return evaluate(value.expr, self._look_up, arrays=True)

    def reads_state(self, expr: Expr) -> bool:
        """Whether an expression reads the state, directly or through formulas."""
        stack, known = [expr], set[Link]()
        while stack:
            for link in dict.fromkeys(node for node in walk(stack.pop()) if isinstance(node, Link)):
                formula = self._formula(link)
                if formula is None:
                    return True
                if link not in known:
                    known.add(link)
                    stack.append(formula)
        return False

    def program(self, value: Value, first: int) -> list[int]:
        """The rows of a program that evaluates a value into floats[first:].

        Raises ScriptError for unsupported operations.
        """
        from sceneql.island.inputs_kernels import COPY

        self._rows = []
        self._known, self._varying = {}, set()
        for k, register in enumerate(_flat(self._lower(value.expr))):
            self._row(COPY, first + k, register)
        return self._rows

    def reading(self, values: Sequence[Stored]) -> list[Stored]:
        """Those of ``values`` that read the state."""
        return [one for one in values if self.reads_state(one[1].expr)]

    def slopes(self, value: Value) -> ValueSlopes:
        """The derivatives of a value that reads the state, with respect to it. Raises WithoutSlopes."""
        self._rows = []
        self._known, self._varying = {}, set()
        readings = []
        try:
            parts = components(value.expr, self._meaning)
            read = [{node for node in each_once(part) if isinstance(node, Symbol)} for part in parts]
            count = sum(_place(symbol) >= 0 for symbol in set().union(*read))
            if count > MOST_READ:
                raise WithoutSlopes(f"a value that reads {count} numbers of the state")
            for part, symbols in zip(parts, read, strict=True):
                entries = sorted((symbol for symbol in symbols if _place(symbol) >= 0), key=_place)
                slopes = [(_place(entry), differentiate(part, entry)) for entry in entries]
                readings.append([(at, self._lower(slope)) for at, slope in slopes if slope != ZERO])
        except TypeError:
            raise WithoutSlopes("a value that reads the state") from None
        return ValueSlopes(self._rows, readings)

    def _meaning(self, link: Link) -> Any:
        """The expression that a link stands for: a formula, or nested lists of symbols named by indices into y."""
        formula = self._formula(link)
        return _mapped(lambda place: Symbol(str(place)), self._found(link).tolist()) if formula is None else formula

    def _look_up(self, node: Symbol | Link) -> Any:
        if isinstance(node, Symbol):
            return {TIME_SYMBOL: 0.0}[node.name]
        if node not in self._at_start:
            formula = self._formula(node)
            self._at_start[node] = (
                self._start()[self._found(node)] if formula is None else evaluate(formula, self._look_up, arrays=True)
            )
        return self._at_start[node]

    def _found(self, link: Link) -> NDArray[int64]:
        places = self._places(link)
        if places is None:
            raise ScriptError([unreadable(link)])
        return places

    def _lower(self, expr: Expr) -> Lowered:
        self._varying |= holders(_varies, expr)
        return recursive(self._known_one, expr)

    def _known_one(self, expr: Expr) -> Generator[Expr, Lowered, Lowered]:
        if id(expr) not in self._known:
            self._known[id(expr)] = expr, (yield from self._one(expr))
        return self._known[id(expr)][1]

    def _one(self, expr: Expr) -> Generator[Expr, Lowered, Lowered]:
        from sceneql.island.inputs_kernels import STATE, TIME

        if id(expr) not in self._varying:
            return self._constant(evaluate(expr, {}, arrays=True))
        match expr:
            case Symbol():
                return self._emit(TIME) if _place(expr) < 0 else self._emit(STATE, _place(expr))
            case Link():
                formula = self._formula(expr)
                if formula is not None:
                    self._varying |= holders(_varies, formula)
                    return (yield formula)
                return _mapped(lambda place: self._emit(STATE, place), self._found(expr).tolist())
            case Vector(items=items):
                return (yield from _each(items))
            case Keys():
                return self._keys(expr, (yield expr.argument))
            case Call():
                return (yield from self._call(expr))
        raise TypeError(f"an unbound name cannot be lowered: {expr!r}")

    def _constant(self, value: Any) -> Lowered:
        return _mapped(lambda number: self._store([number]), np.asarray(value).tolist())

    def _keys(self, keys: Keys, argument: Register) -> Lowered:
        from sceneql.island.inputs_kernels import KEYS, ROTATION

        try:
            table = keys_table(keys)
        except KeyError:
            text = "keyframes inside a solved system need constant times and values"
            raise ScriptError([Diagnostic("varying-keys", text, keys.span)]) from None
        columns = (table.values, table.slopes_in, table.slopes_out)
        at = self._store([table.cycle, *table.times, *np.ravel(columns)])
        width = len(table.values[0])
        out = self._store(np.zeros(width))
        form = table.curve + (ROTATION if table.rotation else 0)
        self._row(KEYS, out, argument, at, width, len(table.times), form)
        return [out + k for k in range(width)] if keys.type.shape else out

    def _call(self, expr: Call) -> Generator[Expr, Lowered, Lowered]:
        from sceneql.island.inputs_kernels import CODES

        op, args = expr.op, expr.args
        if op == "component":
            assert isinstance(args[1], Number)
            return _component((yield args[0]), int(args[1].value))
        operands = yield from _each(args)
        if op in ("min", "max"):
            return reduce(partial(self._do, op), _flat(operands[0]) if len(operands) == 1 else operands)
        if op in CODES:
            return self._do(op, *operands)
        if op in LOWERINGS:
            return LOWERINGS[op](self._do, *operands)
        text = f"'{op}' cannot vary in time inside a solved system"
        raise ScriptError([Diagnostic("unsupported-operation", text, expr.span)])

    def _do(self, op: str, *operands: Any) -> Lowered:
        """Emit a scalar operation, component by component; floats among the operands are constants."""
        from sceneql.island.inputs_kernels import CODES

        depth = max(_depth(operand) for operand in operands)
        if depth == 0:
            registers = [self._store([x]) if isinstance(x, float) else x for x in operands]
            return self._emit(CODES[op], *registers)
        count = next(len(operand) for operand in operands if _depth(operand) == depth)
        return [self._do(op, *(x[k] if _depth(x) == depth else x for x in operands)) for k in range(count)]

    def _emit(self, code: int, *operands: Register) -> Register:
        out = self._store([0.0])
        self._row(code, out, *operands)
        return out

    def _row(self, code: int, out: int, *rest: int) -> None:
        self._rows += [code, out, *rest, *(0,) * (5 - len(rest))]


def _each(parts: Iterable[Expr]) -> Generator[Expr, Lowered, list[Lowered]]:
    """The results of lowering several expressions."""
    found = []
    for part in parts:
        found.append((yield part))
    return found


def _varies(node: Expr) -> bool:
    return isinstance(node, Symbol | Link)


def _place(symbol: Symbol) -> int:
    """The index into y that a symbol stands for; -1 for the time."""
    return int(symbol.name) if symbol.name.isdecimal() else -1


def _mapped(function: Callable[[Any], Any], value: Any) -> Any:
    """Apply a function to every number of nested lists."""
    return [_mapped(function, item) for item in value] if isinstance(value, list) else function(value)


def _flat(value: Lowered) -> list[Register]:
    return [register for item in value for register in _flat(item)] if isinstance(value, list) else [value]


def _depth(value: Lowered) -> int:
    return 1 + max((_depth(item) for item in value), default=0) if isinstance(value, list) else 0


def _component(value: Lowered, k: int) -> Lowered:
    """Component k of a vector, or of every vector of a list."""
    return [_component(item, k) for item in value] if _depth(value) > 1 else value[k]
