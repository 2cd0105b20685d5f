"""Reading of `repeat`: the number of copies of an entry, and the name of a copy's index."""

from __future__ import annotations

import re
from collections.abc import Collection
from collections.abc import Mapping as Table
from dataclasses import dataclass
from math import inf
from typing import Final

from sceneql.language.scope import Broken, Scope
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, unsure
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.expression import Expr, Number
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Span

MOST_COPIES: Final = 10_000
_MOST_HOPS: Final = 64
_Known = dict[int, float | None]
_NUMBERED = re.compile(r"(\w*?)_?[{[(<$%]+(\w+)[}\])>]*\w*?((?:[{[(<$%]+\w+[}\])>]*\w*)*)")
_RATE = re.compile(r"(?:der|ddt|diff|deriv|derivative|dot|Dt|D)\((\w+)(?:, *t)?\)")
_RANGE = re.compile(r"\b(?:range|linspace|arange)\(.*?(\w+)\W*\)")
_APART: Final = {"spacing", "offset", "distance", "shift", "gap", "step"}
_COPY = re.compile(r"(.+?)[._\[]\{?([^\W\d]\w*)\}?\]?\s*([-+]\s*\d+)?\]?")
_LOOP = re.compile(r"for(?:each)?\s+\(?(?:int |let |var )?\s*(\w+)\b.*")


@dataclass(frozen=True, slots=True)
class Repeat:
    """``count`` copies; ``symbol``: the name of a copy's index, from 0, written at ``node``.

    Where copies go over ``names``, the symbol stands for one of these.
    """

    count: int
    symbol: str
    node: Node
    names: tuple[str, ...] = ()

    def number(self, copy: int) -> Scalar:
        """The index of a copy as a node."""
        return Scalar(str(copy), "integer", False, self.node.source, self.node.start, self.node.end)


def numbered(name: str) -> str | None:
    """The help for a name with an index in it, ``hook_{i}``, or a loop, ``for i in``; None for other names."""
    if (rate := _RATE.fullmatch(name)) is not None:
        return f"a rate stands under the name of its state: write `{rate[1]}` in its place, for d{rate[1]}/dt"
    if (found := _NUMBERED.fullmatch(name)) is not None:
        plain, index = found[1].rstrip("_") or "name", found[2]
        if found[3]:
            copies = f"one number counts rows and columns, as `floor({index}/3)` and `mod({index}, 3)` of it"
            return f"write `{plain}: {{repeat: {{count: 12, as: {index}}}, ...}}`; {copies}: `sceneql words repeat`"
    elif (loop := _LOOP.fullmatch(name)) is not None:
        plain, index = "name", loop[1]
    else:
        return None
    copies = f"the copies are {plain}.0, {plain}.1, ..."
    return f"write `{plain}: {{repeat: {{count: 5, as: {index}}}, ...}}`, {copies}: `sceneql words repeat`"


def copy_meant(name: str, known: Collection[str]) -> str | None:
    """The help for the name of a copy whose number is not in braces: ``link.i+1`` where there is ``link.0``."""
    found = _COPY.fullmatch(name)
    if found is None or f"{found[1]}.0" not in known:
        return None
    number = found[2] if found[3] is None else f"{found[2]} {found[3][0]} {found[3][1:].strip()}"
    return f'the number of a copy stands in braces, in quotes: write `"{found[1]}.{{{number}}}"`'


_COUNTS, _COUNTERS = ("count", "n", "times", "number", "to", "stop", "end"), (
    "as", "index", "var", "variable", "name", "for", "each", "counter",
)  # fmt: skip
"""Fields of other programs for how many copies there are, and for the name of their number."""


def read_repeat(
    node: Node, scope: Scope | None, define: Table[str, Node], lost: Broken, found: Diagnostics, *, names: bool = False
) -> Repeat | None:
    """The value of `repeat`; None after reporting errors. ``names``: whether it may go over names."""
    if unsure(node):
        return None
    if names and isinstance(node, Mapping) and len(node.entries) == 1 and "count" not in node.entries:
        (symbol, over), (key,) = next(iter(node.entries.items())), node.keys.values()
        if symbol.isidentifier() and isinstance(over, Sequence) and all(isinstance(one, Scalar) for one in over.items):
            texts = tuple(one.text for one in over.items if isinstance(one, Scalar))
            return Repeat(len(texts), symbol, key, texts)
    if not isinstance(node, Mapping) or "count" not in node.entries or node.entries.keys() - {"count", "as"}:
        given = node.text if isinstance(node, Scalar) and node.kind in ("integer", "text") else "5"
        if (loop := _RANGE.search(given)) is not None:
            given = loop[1]
        counter = "i"
        first = "0"
        if isinstance(node, Mapping):
            told = {key: one.text for key, one in node.entries.items() if isinstance(one, Scalar)}
            given = next((told[key] for key in _COUNTS if told.get(key, "").isdecimal()), given)
            given = next((loop[1] for text in told.values() if (loop := _RANGE.search(text)) is not None), given)
            first = told.get("from", told.get("start", "0"))
            if "to" in told and first.isdecimal() and told["to"].isdecimal() and first != "0":
                given = str(int(told["to"]) - int(first) + 1)
            counter = next((told[key] for key in _COUNTERS if told.get(key, "").isidentifier()), counter)
            if len(told) == len(node.entries) == 1 and {*told}.isdisjoint((*_COUNTS, *_COUNTERS)):
                counter, given = next(((name, text) for name, text in told.items()))  # `{k: range(5)}`
                given = loop[1] if (loop := _RANGE.search(given)) is not None else given
        help = f"write `repeat: {{count: {given}, as: {counter}}}`"
        if first.isdecimal() and first != "0":
            help += f", and `{counter} + {first}` for `{counter}` in its fields, for copies are numbered from 0"
        if isinstance(node, Sequence):
            help = f"all are one count: {_rows(node, None, 'repeat: ')}"
        if isinstance(node, Mapping) and node.entries.keys() & _APART:
            help += ", and say where each is: `position: [i*(0.5 m), 1 m, 0 m]`"
        found.error("repeat-shape", "`repeat` takes a count, and a name for the number", node.span, help=help)
        return None
    index = node.entries.get("as")
    if index is not None and not (isinstance(index, Scalar) and index.text.isidentifier()):
        rows = f"rows and columns are one count: {_rows(node.entries['count'], index)}"
        help = rows if isinstance(index, Sequence) else "write `as: i`"
        found.error("repeat-shape", "`as` takes a name", index.span, help=help)
        return None
    count = _whole(node.entries["count"], scope, define, lost, found)
    if count is None:
        return None
    return Repeat(count, "i", node) if index is None else Repeat(count, index.text, index)


def _rows(counts: Node, names: Node | None, before: str = "") -> str:
    """What is written for copies in rows and columns, with the counts and the names of their numbers that are given."""
    given = [one.text for one in counts.items if isinstance(one, Scalar)] if isinstance(counts, Sequence) else []
    sides = [int(one) for one in given if one.isdecimal()]
    sides = sides if len(sides) == 2 else [3, 3]
    both = [one.text for one in names.items if isinstance(one, Scalar)] if isinstance(names, Sequence) else []
    number = both[0] if len(both) == 2 else "k" if names is None else "i"
    first, second = f"mod({number}, {sides[0]})", f"floor({number}/{sides[0]})"
    of = [f" for `{one}`" for one in both] if len(both) == 2 else ["", ""]
    told = f"`{first}`{of[0]} and `{second}`{of[1]} in its fields"
    return f"write `{before}{{count: {sides[0] * sides[1]}, as: {number}}}`, and {told}"


class _LostError(Exception):
    """A name whose value was reported as unreadable."""


def _whole(node: Node, scope: Scope | None, define: Table[str, Node], lost: Broken, found: Diagnostics) -> int | None:
    """A count: a whole number, the name of a field or define that holds one, or a formula of these."""
    try:
        number = _number(node, scope, define, lost, _MOST_HOPS, {})
    except _LostError:
        return None
    if number is None:
        help = "write a number, or the name of a define that is one"
        found.error("repeat-count", "a count is a whole number, 0 or more", node.span, help=help)
        return None
    if number > MOST_COPIES:
        message = f"{number:,.0f} copies are more than {MOST_COPIES:,}"
        help = "a model such as `particles` holds many bodies in one part"
        found.error("limit-refused", message, node.span, help=help)
        return None
    return int(number)


def _number(
    node: Node | None, scope: Scope | None, define: Table[str, Node], lost: Broken, hops: int, known: _Known
) -> float | None:
    """The whole number that a node stands for; None where it is none. Raises _LostError.

    ``hops``: largest number of names that may still lead to it; ``known``: cache of numbers, by id of nodes.
    """
    if node is not None and unsure(node):
        raise _LostError
    if not isinstance(node, Scalar) or hops == 0:
        return None
    if node.kind != "text":
        return _count(node)

    def named(name: str) -> float | None:
        inner = scope
        while inner is not None and name not in inner.fields:
            inner = inner.outer
        if inner is None and name not in define and name in lost:
            raise _LostError
        value, outer = (define.get(name), None) if inner is None else (inner.fields[name], inner.outer)
        if id(value) not in known:
            known[id(value)] = None  # for a name that leads back to itself
            known[id(value)] = _number(value, outer, define, lost, hops - 1, known)
        return known[id(value)]

    if node.text.isidentifier():
        return named(node.text)

    def lookup(parts: tuple[str, ...], span: Span) -> Expr | Diagnostic:
        number = named(parts[0]) if len(parts) == 1 else None
        return Diagnostic("repeat-count", "", span) if number is None else Number(number, span=span)

    try:
        formula = bind(parse_expression(node.text, node.content), lookup, Diagnostics())
    except ScriptError:
        return None
    whole = isinstance(formula, Number) and formula.bare and formula.value >= 0 and formula.value.is_integer()
    return formula.value if whole and isinstance(formula, Number) else None


def _count(value: Scalar) -> float | None:
    """The number of a text such as ``5`` or ``1e3``; None where it is not whole, or below 0."""
    if value.kind not in ("integer", "number") or len(value.text) > 40:
        return None
    try:
        number = float(value.text)
    except ValueError:  # hexadecimal, octal
        return None
    return number if number >= 0 and (number == inf or number.is_integer()) else None
