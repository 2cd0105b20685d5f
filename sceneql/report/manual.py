"""The manual of words, made from their classes, and of topics, from their pages."""

from __future__ import annotations

import inspect
import re
import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import Unsuitable
from sceneql.quantities.diagnostic import ScriptError, suggestion
from sceneql.quantities.instead import anywhere
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.units import unit_of
from sceneql.report.topics import page, topics


def listing(catalogue: Catalogue) -> str:
    """All words by family, and the topics of the language, each with the first line of its manual.

    Errors in words of a folder that cannot be used follow.
    """
    lines: list[str] = []
    wrong: list[str] = []
    for family in catalogue.families:
        lines += _family(catalogue, family, wrong)
    lines += ["topics:", *(f"  {topic:<22}{title}" for topic, title in topics().items())]
    return "\n\n".join(["\n".join(lines), *wrong])


def _family(catalogue: Catalogue, family: str, wrong: list[str]) -> list[str]:
    """The lines of a family's words; to ``wrong`` go the errors of those that cannot be used."""
    lines = [f"{family}:"]
    for word in catalogue.words(family):
        try:
            lines.append(f"  {word:<22}{_summary(catalogue.load(family, word))}")
        except ScriptError as error:
            lines.append(f"  {word:<22}cannot be used, as told below")
            wrong += [str(found) for found in error.diagnostics]
    return lines


def manual(catalogue: Catalogue, word: str) -> str:
    """The manual of a word (in every family that has it), of a topic, or of functions if it is one; a family's words.

    Raises Unsuitable if there is none.
    """
    families = [family for family in catalogue.families if word in catalogue.words(family)]
    classes = [(family, cls) for family in families if (cls := catalogue.load(family, word)) is not None]
    pages = [_page(family, word, cls) for family, cls in classes]
    if word in topics():
        pages.append(page(word, clock=_fields(kinds.Clock, "  ")))
    if not pages and word in OPERATIONS:
        pages.append(page("functions"))
    named = [family for family in catalogue.families if not pages and word in (family, family.removesuffix("s"))]
    for family in named:
        wrong: list[str] = []
        pages += ["\n".join(_family(catalogue, family, wrong)), *wrong]
    if not pages:
        every = [w for family in catalogue.families for w in catalogue.words(family)]
        topic = next((one for one in topics() if one.removesuffix("s") == word), None)
        hint = (
            f"did you mean '{topic}'?"
            if topic
            else anywhere(word) or suggestion(word, [*every, *topics(), *OPERATIONS])
        )
        raise Unsuitable(f"there is no word '{word}'" + (f"; {hint}" if hint else ""))
    return "\n\n".join(pages)


def _page(family: str, word: str, cls: type[kinds.Kind]) -> str:
    also = f"; may also stand under {cls.also_under}" if cls.also_under else ""
    lines = [f"{word} ({family}{also})", "", inspect.cleandoc(cls.__doc__ or ""), "", "fields:"]
    lines += _fields(cls, "  ")
    if cls.gives:
        lines += ["", "gives:"]
        for name, gives in cls.gives.items():
            unit = "" if gives.type.dimension is None else f" [{unit_of(gives.type.dimension)}]"
            lines.append(f"  {name}{_shape(gives.type.shape)}{unit}: {gives.doc}")
    if issubclass(cls, kinds.Object):
        lines += ["", "Quantities among its fields are outputs too: `name.position`."]
    return "\n".join(lines)


def _fields(cls: type[BaseModel], indent: str) -> list[str]:
    lines = []
    for name, info in cls.model_fields.items():
        annotation = Annotated[(info.annotation, *info.metadata)] if info.metadata else info.annotation
        extra: dict[str, Any] = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
        default = extra.get("default", kinds.REQUIRED)
        notes = [type_text(annotation)]
        notes += [f"{limit.replace('_', ' ')} {bound:.12g}" for limit, bound in extra.get("limits", {}).items()]
        if default is kinds.REQUIRED:
            notes.append("required")
        elif default not in (None, "", (), {}) and not isinstance(default, BaseModel):
            notes.append(f"default {_plain(default)}")
        lines.append(f"{indent}{kinds.written_name(name)} ({', '.join(notes)}): {info.description}")
        for record in _records(annotation):
            lines += _fields(record, indent + "  ")
    return lines


def _plain(default: Any) -> str:
    if isinstance(default, bool):
        return "yes" if default else "no"
    return " ".join(map(str, default)) if isinstance(default, tuple) else str(default)


def _records(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type):
        return [annotation] if issubclass(annotation, BaseModel) else []
    return [record for part in get_args(annotation) if not isinstance(part, str) for record in _records(part)]


def type_text(annotation: Any) -> str:
    """A field's type in the words of a script's author."""
    base: Any = annotation
    marks: tuple[Any, ...] = ()
    if get_origin(annotation) is Annotated:
        base, *rest = get_args(annotation)
        marks = tuple(rest)
    for mark in marks:
        if isinstance(mark, kinds.Quantity):
            unit = "any quantity" if mark.dimension is None else "angle" if mark.needs_unit else unit_of(mark.dimension)
            unit = "number" if unit == "1" else unit
            constant = "" if base is kinds.Value else "constant "
            return f"{constant}{unit}{_shape(mark.shape or ())}"
        if isinstance(mark, kinds.Paint):
            return "color"
        if isinstance(mark, kinds.Turn):
            return "rotation"
        if isinstance(mark, kinds.Refers):
            return f"one of {mark}"
        if isinstance(mark, kinds.Interpolated):
            return "text, values in {braces}"
        if isinstance(mark, kinds.SceneFile):
            return "path of a file"
    origin, arms = get_origin(base), get_args(base)
    if origin in (Union, types.UnionType):
        return " or ".join(type_text(arm) for arm in arms if arm is not type(None))
    if origin is Literal:
        return " | ".join(map(str, arms))
    if origin in (list, tuple):
        many = origin is list or (len(arms) == 2 and arms[1] is Ellipsis)
        return (
            f"list of {type_text(arms[0]).removeprefix('one of ')}"
            if many
            else f"{len(arms)} times {type_text(arms[0])}"
        )
    if origin is dict:
        keys = "names" if arms[0] is str else f"names of {get_args(arms[0])[1]}"
        return f"{keys} with {type_text(arms[1])}"
    if isinstance(base, type) and issubclass(base, BaseModel):
        return "fields"
    names = {bool: "yes or no", int: "whole number", float: "number", str: "text"}
    names |= {kinds.Formula: "formula", kinds.Ref: "a part"}
    return names.get(base, "value")


def _shape(shape: tuple[int | None, ...]) -> str:
    if not shape:
        return ""
    return "(" + ", ".join("n" if size is None else str(size) for size in shape) + ")"


def _summary(cls: type[kinds.Kind] | None) -> str:
    text = inspect.cleandoc((cls.__doc__ if cls is not None else "") or "")
    text = text.split("\n\n")[0].replace("\n", " ")
    return re.split(r"\.\s+(?=[A-Z])", text)[0].rstrip(".")
