"""Check of the defaults of a word's fields, when the word is loaded: a script must be able to write each of them.

Errors point into the word's own file, as errors of scripts point into the script.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, get_args

from pydantic import BaseModel

from sceneql.compiler.limits import check_limits
from sceneql.compiler.values import fits
from sceneql.kinds import GRAMMAR, Paint, Turn, Value, grammar_of, literal, written_name
from sceneql.kinds.word import Item, items_of, read_default, text_of
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.span import Source, Span


@cache
def check_defaults(cls: type[BaseModel]) -> None:
    """Read the defaults of a word and of the records in its fields. Raises ScriptError with all errors."""
    found = Diagnostics()
    for record in _with_records(cls):
        for name, info in record.model_fields.items():
            if _mistakes(name, info, None):
                found.extend(_mistakes(name, info, partial(_place, record, name)))
    found.raise_errors()


def _mistakes(
    name: str, info: Any, place: Callable[[tuple[int, ...]], Span] | None, path: tuple[int, ...] = ()
) -> tuple[Any, ...]:
    """The errors of a field's default, or of an item at ``path`` in it.

    ``place`` gives the span in the word's file by the path; None: spans are in the default's own text.
    """
    default, what, found = info.default, written_name(name), Diagnostics()
    mark, kind = grammar_of(info)
    span = Span(Source("default", str(default)), 0, len(str(default))) if place is None else place(path)
    if (text := text_of(default)) is not None and mark is None:
        if isinstance(default, str):
            return ()  # a text or a choice
        for k, item in enumerate(items_of(info)):
            found.extend(_mistakes(name, item, place, (*path, k)))
        if found.errors:
            return found.errors
        default = read_default(info)
    elif text is not None and mark is not None:
        quantity = GRAMMAR[type(mark)] if isinstance(mark, Paint | Turn) else mark
        try:
            value = literal(text, span if isinstance(default, str) else None)
        except ScriptError as error:
            return tuple(one if isinstance(default, str) else replace(one, span=span) for one in error.diagnostics)
        if not fits(value.expr, quantity, what, span, found):
            return found.errors
        default = value if kind is Value else value.number()
    if isinstance(info, Item):
        return found.errors
    limits = (info.json_schema_extra or {}).get("limits", {})
    annotation = Annotated[(info.annotation, *info.metadata)] if info.metadata else info.annotation
    check_limits(default, limits, what, annotation, span, found)
    return found.errors


def _place(record: type[BaseModel], name: str, steps: tuple[int, ...]) -> Span:
    """The span, in the file of its class, of a field's default or of an item in it, without quotes.

    The span of the whole class where the file has no text for the field.
    """
    owner = next(one for one in record.__mro__ if name in vars(one).get("__annotations__", {}))
    path = Path(sys.modules[owner.__module__].__file__ or "")
    text = path.read_text(encoding="utf-8")
    source = Source(str(path), text)
    of_class = next(
        node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef) and node.name == owner.__name__
    )
    for node in of_class.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.target.id == name:
            return _default_of(node, source, steps)
    return _span(of_class, source)


def _default_of(node: ast.AnnAssign, source: Source, steps: tuple[int, ...]) -> Span:
    """The span of the second argument of ``field(...)``, or of the item at a path in it."""
    call = node.value
    if isinstance(call, ast.Call):
        named = [keyword.value for keyword in call.keywords if keyword.arg == "default"]
        for default in (*call.args[1:2], *named):
            for k in steps:
                default = default.elts[k] if isinstance(default, ast.Tuple) else default
            whole = _span(default, source)
            inside = whole.part(1, len(whole.text) - 1)
            return inside if isinstance(default, ast.Constant) and default.value == inside.text else whole
    return _span(node, source)


def _span(node: ast.stmt | ast.expr, source: Source) -> Span:
    """The span of a syntax node; Python's columns count bytes of a line."""

    def offset(line: int, column: int) -> int:
        return source.line_starts[line - 1] + len(source.line(line).encode()[:column].decode())

    end = (node.end_lineno or node.lineno, node.end_col_offset or node.col_offset)
    return Span(source, offset(node.lineno, node.col_offset), offset(*end))


def _with_records(cls: type[BaseModel]) -> list[type[BaseModel]]:
    """A class and the records that its fields hold, at any depth."""
    found: list[type[BaseModel]] = []
    todo = [cls]
    while todo:
        one = todo.pop()
        if one not in found:
            found.append(one)
            todo += [record for info in one.model_fields.values() for record in _records(info.annotation)]
    return found


def _records(annotation: Any) -> Iterator[type[BaseModel]]:
    """The records that a type names."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _records(part)
