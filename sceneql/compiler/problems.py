"""Errors in combinations of fields: the problems of a record, reported where they stand."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import Any

from pydantic import BaseModel, ValidationError

from sceneql import kinds
from sceneql.kinds.word import read_default
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.language.within import within
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span


class Unreadable(Exception):
    """A value was wrong and has been reported; the reader of the surrounding value goes on with the next."""


def validated(cls: type[BaseModel], got: dict[str, Any], node: Node | None, span: Span, found: Diagnostics) -> Any:
    """The record made of fields read from ``node``; None after reporting that they do not go together.

    A record that is no word is returned in spite of its problems, so that those of the record or word around it are
    found.
    """
    context: list[tuple[BaseModel, kinds.Problem]] = []
    try:
        result = cls.model_validate(got, context=context)
    except ValidationError as error:
        for problem in error.errors():
            exceeds = isinstance(problem.get("ctx", {}).get("error"), kinds.Exceeds)
            text = _text(problem)
            help = None if problem["loc"] else _with_field(cls, text, node)
            place = _place(problem["loc"], node, span)
            found.error("limit-refused" if exceeds else "invalid", text, place, help=help)
        return None
    problems = [problem for one, problem in context if one is result]  # those inside were reported
    for told in problems:
        place = _place(told.path, node, span, told.at_key, told.part)
        found.error(told.code, told.text, place, help=told.help)
    return None if problems and issubclass(cls, kinds.Kind) else result


def report_known(cls: type[BaseModel], got: dict[str, Any], node: Node | None, span: Span, found: Diagnostics) -> None:
    """Report the problems of a record of which some fields could not be read, as far as the others tell them.

    What asks for a field that was not read ends the search: it has no value.
    """
    if not issubclass(cls, kinds.Record) or cls.problems is kinds.Record.problems:
        return
    given = node.entries if isinstance(node, Mapping) else {}
    values = dict(got)
    for name, info in cls.model_fields.items():
        if name not in got and kinds.written_name(name) not in given and not info.is_required():
            values[name] = read_default(info)
    record = cls.model_construct({*got}, **values)
    for name in cls.model_fields:
        if name not in values:
            record.__dict__.pop(name, None)
    with suppress(AttributeError):  # of a field that was not read
        for told in record.problems():
            place = _place(told.path, node, span, told.at_key, told.part)
            found.error(told.code, told.text, place, help=told.help)


def _with_field(cls: type[BaseModel], text: str, node: Node | None) -> str | None:
    """The help for a word that needs a field, whose example stands first in the text: the word with it."""
    lacking = re.search(r" needs [^`]*`(\w+: [^`]+)`", text)
    if lacking is None or not issubclass(cls, kinds.Kind) or (node is not None and "\n" in node.span.text):
        return None
    word, fields = cls.__module__.rpartition(".")[2], node.entries if isinstance(node, Mapping) else {}
    inner = ", ".join([*(f"{name}: {one.span.text}" for name, one in fields.items()), lacking[1]])
    return f"write `{{{word}: {{{inner}}}}}`"


def _text(problem: Any) -> str:
    message: str = problem["msg"]
    return message.removeprefix("Value error, ").removeprefix("Assertion failed, ")


def _place(
    path: tuple[int | str, ...],
    node: Node | None,
    span: Span,
    at_key: bool = False,
    part: tuple[str, int, int] | None = None,
) -> Span:
    """The span of the deepest node on a validation error's path, of the last step's key, or of a part of its text."""
    for number, step in enumerate(path, 1):
        if isinstance(node, Mapping) and isinstance(step, str) and kinds.written_name(step) in node.entries:
            if at_key and number == len(path):
                return node.keys[kinds.written_name(step)].span
            node = node.entries[kinds.written_name(step)]
        elif isinstance(node, Sequence) and isinstance(step, int) and step < len(node.items):
            node = node.items[step]
        else:
            break
    if part is not None and isinstance(node, Scalar) and node.text == part[0]:
        return within(node, part[1], part[2])
    return span if node is None else node.span
