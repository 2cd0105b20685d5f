"""Expansion of `repeat` inside the fields of a part: map entries by name, or list items, written out as copies.

A copy's number is looked up where its values are read (`Mapping.index`). In braces it is replaced in names: ``bead.{i +
1}``, also in the fields of a part that is a copy itself. Where copies go over names, ``repeat: {leg: [left, right]}``,
the word stands for one of them, alone or before a dot.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Mapping as Table
from dataclasses import dataclass, replace
from typing import Final

from sceneql.language.one_line import one_line
from sceneql.language.repeat import MOST_COPIES, Repeat, read_repeat
from sceneql.language.scope import Broken, Scope
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, hole
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.expression import Expr, Number
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Source, Span

KEY: Final = "repeat"
_BRACES = re.compile(r"\{([\w\s+*/()-]+)\}")


@dataclass(slots=True)
class Copies:
    """Expander of copies inside the fields of parts. ``define``, ``lost``: as for `read_repeat`."""

    define: Table[str, Node]
    lost: Broken
    found: Diagnostics
    any: bool = True
    """Whether any file or patch of the script contains the word `repeat`."""
    count: int = 0

    def written_out(self, fields: Node | None, scope: Scope | None) -> Node | None:
        """The fields of a part with all copies written out; the same node where there are none."""
        return self._walked(fields, scope) if self.any and fields is not None else fields

    def _walked(self, node: Node, scope: Scope | None) -> Node:
        if isinstance(node, Sequence):
            items = [made for item in node.items for _, made in self._made("", item, scope)]
            return replace(node, items=items)
        if not isinstance(node, Mapping):
            return node
        entries: dict[str, Node] = {}
        keys: dict[str, Scalar] = {}
        for name, item in node.entries.items():
            for full, made in self._made(name, item, scope):
                if full != name and (full in entries or full in node.entries):
                    message = f"a copy of '{name}' is called '{full}', and so is another entry"
                    self.found.error("duplicate-key", message, node.keys[name].span, help="give one another name")
                    continue
                entries[full], keys[full] = made, node.keys[name]
        return node.holding(entries, keys)

    def _made(self, name: str, item: Node, scope: Scope | None) -> Iterator[tuple[str, Node]]:
        """(name, node) of an entry or item, or of each of its copies."""
        keyed = isinstance(item, Mapping) and "keys" in item.entries and isinstance(item.entries.get(KEY), Scalar)
        if keyed or not (isinstance(item, Mapping) and KEY in item.entries and len(item.entries) > 1):
            yield name, self._walked(item, scope)
            return
        for key in item.entries:
            if _BRACES.search(key):  # `masses: {repeat: ..., "m{i}": {...}}`
                message = f"'{key}' cannot be a name: `repeat` stands inside of what it repeats"
                self.found.error("part-name", message, item.keys[key].span, help=_inside_each(name, item))
                yield name, hole(item.span)
                return
        times = read_repeat(item.entries[KEY], scope, self.define, self.lost, self.found, names=True)
        if times is None:
            yield name, hole(item.span)
            return
        self.count += times.count
        if self.count > MOST_COPIES:
            message = f"copies inside fields are more than {MOST_COPIES:,}"
            help = "a net such as `lattice`, `cloth` or `rope`, or points in a list hold more"
            self.found.error("limit-refused", message, item.entries[KEY].span, help=help)
            yield name, hole(item.span)
            return
        rest = {key: value for key, value in item.entries.items() if key != KEY}
        for number in range(times.count):
            index = None if times.names else (times.symbol, times.number(number))
            inner = self._walked(item.holding(rest), scope if index is None else Scope({}, dict([index]), scope))
            copy = _numbered(inner, times, number)
            assert isinstance(copy, Mapping)
            copy.index = index
            yield f"{name}.{number}", copy


def _inside_each(field: str, item: Mapping) -> str:
    """The help for names with numbers in braces, beside a `repeat` that should stand within each of their entries."""
    repeat, entries, copies = one_line(item.entries[KEY]), [], ""
    for key, fields in item.entries.items():
        if key == KEY:
            continue
        plain = _BRACES.sub("", key).strip("_-.") or "one"
        copies = copies or f'the copies are {plain}.0, {plain}.1, ..., by their number `"{plain}.{{i}}"`'
        inner = one_line(fields).removeprefix("{").removesuffix("}") if isinstance(fields, Mapping) else "..."
        entries.append(f"{plain}: {{{', '.join(one for one in (f'repeat: {repeat}', inner) if one)}}}")
    line = f"{{{', '.join(entries)}}}"
    return f"write `{f'{field}: {line}' if field else line}`; {copies}"


def in_braces(node: Node, scope: Scope) -> Node:
    """The fields of a copied part, with its number in place of expressions in braces.

    ``scope`` holds the number as its only field.
    """
    if not _BRACES.search(node.source.text, node.start, node.end):
        return node
    ((symbol, written),) = scope.fields.items()
    assert isinstance(written, Scalar)
    return _numbered(node, Repeat(1, symbol, written), int(written.text))


def _numbered(node: Node, times: Repeat, number: int) -> Node:
    """A copy's node, with its name in place of the symbol, or with numbers in place of expressions in braces."""
    if isinstance(node, Scalar):
        if times.names:
            word = rf"(?<![\w.'\"]){re.escape(times.symbol)}(?![\w'])"
            text = re.sub(word, lambda _: times.names[number], node.text)
        else:
            text = _BRACES.sub(lambda found: _value(found, times.symbol, number), node.text)
        return node if text == node.text else replace(node, text=text)
    if isinstance(node, Sequence):
        return replace(node, items=[_numbered(item, times, number) for item in node.items])
    return node.holding({key: _numbered(item, times, number) for key, item in node.entries.items()})


def _value(braces: re.Match[str], symbol: str, number: int) -> str:
    """The whole number of an expression in braces; the braces themselves where it contains other names."""

    def meaning(parts: tuple[str, ...], span: Span) -> Expr | Diagnostic:
        return Number(float(number)) if parts == (symbol,) else Diagnostic("unknown-name", "another name", span)

    text = braces[1]
    try:
        value = bind(parse_expression(text, Span(Source("braces", text), 0, len(text))), meaning, Diagnostics())
    except ScriptError:
        return braces[0]
    return f"{value.value:.0f}" if isinstance(value, Number) and value.value.is_integer() else braces[0]
