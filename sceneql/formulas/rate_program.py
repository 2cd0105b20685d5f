"""A system of ordinary differential equations as compiled kernels: its rate and its symbolic Jacobian.

Both kernels have the signature of a term, ``(t, y, out, floats, ints)``, with ints = (offset of the constants in
``floats``, offset of the states in ``y``, number of copies, offset of each input in ``floats``); a copy's m states
stand together in ``y``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from sceneql.compiled.printer import Constants, Printer, write_term
from sceneql.quantities.derivative import components, differentiate, simplify
from sceneql.quantities.expression import TIME_SYMBOL, Call, Expr, Number, Symbol, walk

ZERO = Number(0.0)


@dataclass(frozen=True)
class RateSystem:
    """dy/dt of one copy: ``rows[k]`` is the rate of ``states[k]``.

    The rows are scalar expressions of the states, the time, the copy's number (symbol ``index``) and the ``where``
    quantities, which may use one another but not in a circle.
    """

    states: tuple[str, ...]
    rows: tuple[Expr, ...]
    where: Mapping[str, Expr]
    index: str | None = None


@dataclass(frozen=True)
class Kernel:
    """A generated kernel: its name ``"package.module:function"``, and the numbers that it reads from ``floats``."""

    name: str
    constants: tuple[float, ...]
    inputs: tuple[Expr, ...]
    """Values read from other parts; the offset of each follows in ``ints``."""
    places: tuple[int, ...] = ()
    """For a Jacobian with m columns: m * row + column of each entry, ascending."""


def rate_kernel(system: RateSystem) -> Kernel:
    """Kernel that adds dy/dt to ``out`` (n,)."""
    constants = Constants()
    meanings, rows = lifted(system, constants)
    printer = _printer(system, meanings, constants)
    rates = [printer.name(row) for row in rows]
    return _kernel("rate", system, printer, [f"out[first + {k}] += {rate}" for k, rate in enumerate(rates)])


def jacobian_kernel(system: RateSystem) -> Kernel:
    """Kernel that adds each copy's d(dy/dt)/dy to ``out`` (copies * k,): the k entries that are not structurally zero.

    By the chain rule over the helper quantities w, df/dy = ∂f/∂y + Σ ∂f/∂w · dw/dy; each dw/dy is derived and evaluated
    once however often w is used. Raises TypeError for an operation without a derivative.
    """
    return _jacobian_kernel(system.states, system.rows, tuple(system.where.items()), system.index)


@lru_cache(maxsize=64)
def _jacobian_kernel(
    states: tuple[str, ...], rows: tuple[Expr, ...], where: tuple[tuple[str, Expr], ...], index: str | None
) -> Kernel:
    """The Jacobian kernel by the contents of a system, cached: `auto` asks anew in each run that becomes stiff."""
    system = RateSystem(states, rows, dict(where), index)
    constants = Constants()
    meanings, lifted_rows = lifted(system, constants)
    entries, derived = derivatives(states, meanings, lifted_rows)
    printer = _printer(system, {**meanings, **derived}, constants)
    places = tuple(place for place, entry in enumerate(entries) if entry != ZERO)
    lines = [f"out[block + {k}] += {printer.name(entries[place])}" for k, place in enumerate(places)]
    return _kernel("jacobian", system, printer, lines, places)


def derivatives(
    states: Sequence[str], meanings: Mapping[str, Expr], rows: Sequence[Expr]
) -> tuple[list[Expr], dict[str, Expr]]:
    """The entries of the Jacobian, row by row, and the expressions of the symbols in them that stand for dw/dy."""
    slopes: dict[tuple[str, str], Expr] = {}
    derived: dict[str, Expr] = {}

    def symbols(expr: Expr) -> dict[str, None]:
        return dict.fromkeys(node.name for node in walk(expr) if isinstance(node, Symbol))

    def total(expr: Expr, state: str) -> Expr:
        names = symbols(expr)
        result = differentiate(expr, Symbol(state)) if state in names else ZERO
        for name in names:
            if name in meanings:
                part = Call("mul", (differentiate(expr, Symbol(name)), slope(name, state)))
                result = simplify(Call("add", (result, part)))
        return result

    def slope(name: str, state: str) -> Expr:
        """A symbol for dw/dy, or zero; iterative, so that chains of helper quantities may be long."""
        left = [name]
        while left:
            each = left[-1]
            known = (each, state) in slopes
            needed = [] if known else [other for other in symbols(meanings[each]) if other in meanings]
            needed = [other for other in needed if (other, state) not in slopes]
            if not needed and not known:
                expr = total(meanings[each], state)
                symbol = Symbol(f"d {each} d {state}")
                derived[symbol.name] = expr
                slopes[each, state] = ZERO if expr == ZERO else symbol
            left = [*left, *needed] if needed else left[:-1]
        return slopes[name, state]

    return [total(row, state) for row in rows for state in states], derived


def lifted(system: RateSystem, constants: Constants) -> tuple[dict[str, Expr], list[Expr]]:
    """Helper quantities and rows as scalar trees with constants and links lifted out."""
    meanings = {name: constants.lift(components(expr)[0]) for name, expr in system.where.items()}
    return meanings, [constants.lift(components(row)[0]) for row in system.rows]


def _printer(system: RateSystem, meanings: Mapping[str, Expr], constants: Constants) -> Printer:
    names = {name: f"s{k}" for k, name in enumerate(system.states)}
    names |= {TIME_SYMBOL: "t", "t": "t"}
    if system.index is not None:
        names[system.index] = "number"
    return Printer(names, meanings, constants)


def _kernel(
    function: str, system: RateSystem, printer: Printer, outputs: Sequence[str], places: tuple[int, ...] = ()
) -> Kernel:
    size = len(system.states)
    constants = printer.constants
    lines = [
        "    for copy in range(ints[2]):",
        "        number = float(copy)",
        f"        first = ints[1] + copy * {size}",
        *([f"        block = copy * {len(places)}"] if places else []),
        *(f"        s{k} = y[first + {k}]" for k in range(size)),
        *(f"        {line}" for line in (*printer.lines, *outputs)),
    ]
    kernel = write_term(function, constants, 3, lines)
    return Kernel(kernel, tuple(constants.values), tuple(constants.inputs), places)
