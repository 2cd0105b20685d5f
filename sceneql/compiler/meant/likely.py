"""Fields that a value of the wrong shape was likely meant for: what to write in its place.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Mapping as Naming
from collections.abc import Sequence as Sequenced
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler import paint
from sceneql.compiler.annotations import example_of, first_field, is_fixed, marks_of, quantities, unwrap
from sceneql.compiler.meant.by_record import ANOTHER, by_record
from sceneql.compiler.meant.by_side import part_at_side
from sceneql.compiler.meant.chained import mended
from sceneql.compiler.meant.other_parts import for_each_mass, of_contact
from sceneql.compiler.meant.own_examples import own_example
from sceneql.compiler.meant.own_values import in_si, with_own
from sceneql.compiler.meant.painted import colored
from sceneql.compiler.meant.quantity_help import NAME, TRUE, other_output
from sceneql.compiler.meant.together import together
from sceneql.compiler.meant.unknown import meant_field
from sceneql.compiler.meant.values_elsewhere import along_default, quantities_fitting
from sceneql.compiler.problems import Unreadable
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence, whole
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, suggestion
from sceneql.quantities.instead import instead

_NAMES = re.compile(rf"{NAME}(?:\s*[-+&|*/,]\s*{NAME})+")
_MEASURED = re.compile(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*[^\W\d].*")
__all__ = ["ANOTHER", "asked", "choice_meant", "example_line", "field_meant", "meant", "wrong_as"]
OF_FORM = (
    "file-missing",
    "file-outside",
    "dimension-mismatch",
    "missing-value",
    "rotation-shape",
    "syntax",
    "unit-needed",
    "unknown-choice",
    "unknown-color",
    "unknown-output",
    "unknown-unit",
    "wrong-count",
    "wrong-shape",
)
"""Codes of errors of a value that may be meant for a field though it does not take it so."""
SHOWN = 60
"""Longest value that a message repeats behind the field that is meant."""
EITHER = 3
"""Largest number of fields that a message offers for one value."""
LAW = "write `{neo_hookean: {modulus: 0 Pa, poisson: 0.45}}`"
"""The usual law of an elastic solid."""


def renamed(reader: Any, cls: type[BaseModel], name: str, node: Node) -> tuple[bool, str]:
    """Whether a field of a record takes a value, and the help that offers the field in place of the one written."""
    info = next(info for key, info in cls.model_fields.items() if kinds.written_name(key) == name)
    node = node.items[0] if isinstance(node, Sequence) and list(map(type, node.items)) == [Sequence] else node
    wrong, text = wrong_as(reader, node, info, name), node.span.text
    fits = wrong is None
    named = node.text if isinstance(node, Scalar) and wrong == () else ""
    lost = "." in named and reader.names.part_of(named)[0] in reader.names.parts  # it is reported there
    if (fits or lost) and "\n" not in text and len(text) <= SHOWN:
        return True, f"did you mean `{name}: {text}`?"
    helps = [one.help for one in wrong or () if one.help is not None and _of_its_kind(one)]
    if helps and (found := mended(reader, node, cls, name)) is not None:
        return False, f"did you mean `{name}: {found[0]}`?"
    if len(helps) == 1:
        return False, f"did you mean '{name}'? For its value {helps[0]}"
    example = "..." if fits else example_of(cls, name)
    shown = "" if example == "..." else f", as in `{name}: {example}`"
    return fits, f"did you mean '{name}'{shown}?"


def _of_its_kind(wrong: Diagnostic) -> bool:
    """Whether an error of a value tells that the field was meant, with another form of its value."""
    return wrong.code in OF_FORM or (wrong.code == "unknown-name" and "is a part" in wrong.message)


def wrong_as(reader: Any, node: Node, info: Any, name: str) -> tuple[Diagnostic, ...] | None:
    """The errors of a value as that of a field of any type; None where the field takes it."""
    nothing = Diagnostics()
    names = replace(reader.names, found=nothing)

    def refer(node: Node, mark: kinds.Refers, anonymous: str) -> kinds.Ref | None:
        return kinds.Ref(node.text, node.span) if isinstance(node, Scalar) and node.text in names.parts else None

    trial = replace(reader, found=nothing, names=names, refer=refer, files=[])
    with suppress(Unreadable):
        trial.field(node, info, name)
        return nothing.errors or None
    return nothing.errors


def asked(reader: Any, cls: type[BaseModel]) -> dict[str, Any]:
    """What `sceneql.compiler.meant.unknown.report_unknown` asks of a record whose fields a reader reads."""
    return {
        "said_by": cls.said_by if issubclass(cls, kinds.Record) else {},
        "family": cls.family if issubclass(cls, kinds.Kind) else "",
        "renamed": partial(renamed, reader, cls),
        "catalogue": reader.names.catalogue,
        "table": table_of(cls),
        "inside": partial(inside, reader, cls),
        "whole": partial(by_record, reader, cls),
    }


def taking_word(reader: Any, cls: type[BaseModel], name: str) -> str | None:
    """The only field of a record that takes a part made in place by a word, ``sphere``; None for other names."""
    families = [] if reader.names.catalogue is None else reader.names.catalogue.families_of(name)
    fields = [
        kinds.written_name(key)
        for key, info in cls.model_fields.items()
        if any(isinstance(mark, kinds.Refers) and mark.family in families for mark in marks_of(info))
    ]
    return fields[0] if len(fields) == 1 else None


def meant(reader: Any, cls: type[BaseModel], node: MappingNode) -> set[str | None]:
    """The fields of a record that its unknown names most likely stand for, by their letters or as words."""
    known = [kinds.written_name(name) for name in cls.model_fields]
    unknown = [name for name in node.entries if name not in known]
    found: set[str | None] = set()
    for name in unknown:
        told = together(name, unknown, node, known) or ""
        found |= {meant_field(name, known), taking_word(reader, cls, name)}
        found |= {one for one in known if f"`{one}: " in told or f", {one}: " in told}
        if issubclass(cls, kinds.Record) and cls.meant_by(node.entries[name].span.text) is not None:
            found.add(known[0])
    return found


def inside(
    reader: Any, cls: type[BaseModel], name: str, node: Node, written: Naming[str, Node] | None = None
) -> str | None:
    """The help for a field of a record in one of a record's fields, or of the record around it, or a part in place.

    That is meant first which takes the value. ``written``: the fields that are looked at, as they are written, where
    these are not all.
    """
    text = node.span.text if "\n" not in node.span.text and len(node.span.text) <= SHOWN else "..."
    for key, value in (written or {}).items():
        info = _known(cls, key)
        held = [] if info is None else [arm for arm in (info.annotation, *get_args(info.annotation)) if _is_record(arm)]
        if any(_known(arm, name) is not None for arm in held):
            own = [kinds.written_name(each) for each, field in held[0].model_fields.items() if field.is_required()]
            before = f"{own[0]}: {value.span.text}, " if isinstance(value, Scalar) and len(own) == 1 else "..., "
            return f"it stands inside `{key}`: write `{key}: {{{before}{name}: {text}}}`"
    if written is not None:
        return of_contact(reader, cls, name, text)
    plain = node.text if isinstance(node, Scalar) else ""
    if issubclass(cls, kinds.Record) and (told := cls.meant_by(plain)) is not None:
        return told
    if (field := taking_word(reader, cls, name)) is not None:
        return f"write `{field}: {{{name}: {text or '{}'}}}`"
    if (each := for_each_mass(reader, name)) is not None:
        return each
    found: list[tuple[bool, str]] = []
    for key, info in cls.model_fields.items():
        for arm in (info.annotation, *get_args(info.annotation)):
            if _is_record(arm) and (taken := _known(arm, name)) is not None:
                field, wrong = kinds.written_name(key), wrong_as(reader, node, taken, name)
                mended = re.fullmatch("write `([^`]+)`", wrong[0].help or "") if wrong and len(wrong) == 1 else None
                own_text = text if mended is None else mended[1]
                told = f"it stands inside `{field}`: write `{field}: {{{name}: {own_text}}}`"
                found.append((wrong is not None and mended is None, told))
    outer: type[BaseModel] | None = reader.outer
    if outer is not None and (taken := _known(outer, name)) is not None:
        told = f"it stands outside of these braces: write `{{..., {name}: {text}}}` around them"
        found.append((wrong_as(reader, node, taken, name) is not None, told))
    return min(found, key=lambda one: one[0])[1] if found else None


def _is_record(arm: Any) -> bool:
    """Whether an annotation is a record that is no word."""
    return isinstance(arm, type) and issubclass(arm, BaseModel) and not issubclass(arm, kinds.Kind)


def _known(cls: type[BaseModel], name: str) -> Any:
    """The field of a record by its name in scripts; None where it has none."""
    return next((info for key, info in cls.model_fields.items() if kinds.written_name(key) == name), None)


def table_of(cls: type[BaseModel]) -> str:
    """The field of a record that has to be given, if it is the only one, and holds entries by name; else empty."""
    required = [name for name, info in cls.model_fields.items() if info.is_required()]
    only = required[0] if len(required) == 1 else ""
    return kinds.written_name(only) if only and get_origin(cls.model_fields[only].annotation) is dict else ""


def example_line(reader: Any, cls: type[BaseModel], name: str, info: Any) -> str:
    """What a missing field is, with an example, where it can be of the script's own parts."""
    description, own = info.description or "", own_example(reader.names, info)
    example = own or ("..." if "`" in description else example_of(cls, name))
    more = "" if example in ("...", "{}") else f" For example `{name}: {example}`."
    return f"{name}: {description}{more}"


def field_meant(reader: Any, node: Node, cls: type[BaseModel]) -> str | None:
    """The help for a field without its colon, or for a value that suits one field of a record."""
    required = [kinds.written_name(name) for name, info in cls.model_fields.items() if info.is_required()]
    if isinstance(node, Sequence) and (dealt := _dealt(reader, node, cls, required)) is not None:
        return dealt
    if not isinstance(node, Scalar):
        found = required if len(required) == 1 else list(_taking(reader, node, cls))
        if len(found) == 1 and "\n" in node.span.text:
            return f"write `{found[0]}:` in a line of its own above it, and indent it below that"
        values = {name: (mended(reader, node, cls, name) or (node.span.text,))[0] for name in found}
        told = " or ".join(f"`{{{name}: {text}}}`" for name, text in values.items())
        return f"write {told}" if 1 <= len(found) <= 2 else None
    if issubclass(cls, kinds.Record) and (meant := cls.meant_by(node.text)) is not None:
        return meant
    if (side := colored(reader, node, cls) or part_at_side(reader, node, cls)) is not None:
        return side
    if node.text.lower() in TRUE and not required:
        return "write `{}`: all of its fields have defaults"
    if node.text.lower() in TRUE:
        return f"write `{first_field(cls)}`"
    if "neo_hookean" in cls.model_fields and (law := instead("bare.law", node.text)) is not None:
        return law
    if "neo_hookean" in cls.model_fields and (law := with_own(LAW, "modulus", node.text)) != LAW:
        return law
    ends = "bare" if "value" in cls.model_fields else "bare.wall" if "wall" in cls.model_fields else ""
    if (held := instead(ends, node.text)) is not None:
        return held
    if "value" in cls.model_fields and not required and _takes(reader, node, cls, "value"):
        return f"write `{{value: {node.span.text}}}`"
    name, _, rest = node.text.partition(" ")
    if name in map(kinds.written_name, cls.model_fields):
        rest = rest.strip().removeprefix("=").strip()
        (info,) = [info for key, info in cls.model_fields.items() if kinds.written_name(key) == name]
        if is_fixed(info.annotation) and not quantities(info) and len(items := rest.split()) > 1 and rest[0] != "[":
            rest = f"[{', '.join(one.strip(',') for one in items)}]"
        return f"write `{name}: {rest}`" if rest else f"write `{{{name}: {example_of(cls, name)}}}`"
    if list(cls.model_fields) == [only := next(iter(cls.model_fields), "")]:
        return f"write `{{{kinds.written_name(only)}: {node.span.text}}}`"
    fitting = list(quantities_fitting(reader, node, cls.model_fields)) or list(_formulas(reader, node, cls))
    alone = required if len(required) == 1 else []
    if alone and len(fitting) == 1 and fitting != alone:  # the value is another field's
        example = f"{alone[0]}: {example_of(cls, alone[0])}"
        return f"write `{{{example}, {kinds.written_name(fitting[0])}: {node.span.text}}}`"
    names = _NAMES.fullmatch(node.text.strip())
    lists = alone or [name for name in map(kinds.written_name, cls.model_fields) if _listing(cls, name)]
    if len(lists) == 1 and names is not None and _listing(cls, lists[0]):
        return f"write `{{{lists[0]}: [{', '.join(re.findall(NAME, node.text))}]}}`"
    number = _MEASURED.fullmatch(node.span.text)
    if not (fitting or alone) and number is not None:
        bare = replace(node, text=number[1], end=node.start + len(number[1]))
        plain = list(quantities_fitting(reader, bare, cls.model_fields))
        if len(plain) == 1:
            return f"it has no unit: write `{{{kinds.written_name(plain[0])}: {number[1]}}}`"
    if not fitting and not alone and (named := _named(reader, node, cls)) is not None:
        return named
    if not fitting and (along := _along(reader, node, cls)) is not None:
        return along
    likely = alone or [kinds.written_name(name) for name in fitting] or _paints(reader, node, cls)
    if not likely and "components" in cls.model_fields and len(size := in_si(node.text)) in (1, 3):
        size = size if len(size) > 1 else [0.0, *size, 0.0]
        return f"write `{{components: [{', '.join(f'{one:g}' for one in size)}]}}`"
    if 2 <= len(likely) <= EITHER and not alone:
        return f"write {' or '.join(f'`{{{name}: {node.span.text}}}`' for name in likely)}"
    if len(likely) != 1:
        return None
    text = node.span.text
    info = next(info for key, info in cls.model_fields.items() if kinds.written_name(key) == likely[0])
    extra: Any = info.json_schema_extra or {}
    above = {"above", "at_least"} & extra.get("limits", {}).keys()
    if text.startswith("-") and above and (why := instead("negative", likely[0])) is not None:
        return f"write `{{{likely[0]}: {text[1:].strip()}}}`: {why}"
    return f"write `{{{likely[0]}: {text}}}`"


def value_alone(reader: Any, node: Node, arms: tuple[Any, ...], what: str) -> str | None:
    """The help for a value under a name of another program where it stands alone: ``initial: {temperature: 300 K}``."""
    if not isinstance(node, MappingNode) or len(node.entries) != 1:
        return None
    (key, inner), records = next(iter(node.entries.items())), [arm for arm in arms if _is_record(arm)]
    named = any(get_origin(unwrap(arm)[0]) is dict for arm in arms)
    if named or not records or not isinstance(inner, Scalar) or any(_known(arm, key) is not None for arm in records):
        return None
    for arm in arms:
        if (
            arm not in records
            and arm is not type(None)
            and any(isinstance(mark, kinds.Quantity | kinds.Symbols) for mark in unwrap(arm)[1])
        ):
            nothing = Diagnostics()
            trial = replace(reader, found=nothing, names=replace(reader.names, found=nothing))
            with suppress(Unreadable):
                trial.read(inner, arm, what)
                return f"write `{what}: {inner.span.text}`"
    return None


def _named(reader: Any, node: Scalar, cls: type[BaseModel]) -> str | None:
    """The help for a part's name in place of a record that refers to a part, or reads one, in one field: a drift."""
    part = reader.names.part_of(node.text)[0]
    if part not in reader.names.parts:
        return None
    families, told = reader.names.catalogue.families_of(reader.names.parts[part].word), []
    for key, info in cls.model_fields.items():
        name = kinds.written_name(key)
        if any(isinstance(mark, kinds.Refers) and mark.family in families for mark in marks_of(info)):
            told.append(f"{{{name}: {part}}}")
        elif part == node.text and any(mark.dimension is None for mark in quantities(info)):
            other = other_output(reader, node, info, name)
            told += [] if other is None else [f"{{{name}: {other.split('`')[1]}}}"]
    return f"write `{told[0]}`" if len(told) == 1 else None


def _along(reader: Any, node: Scalar, cls: type[BaseModel]) -> str | None:
    """The help for one number in place of a record whose one vector of its dimension points along an axis: a wind."""
    found = [(key, text) for key, info in cls.model_fields.items() if (text := along_default(node, info)) is not None]
    if len(found) != 1:
        return None
    return f"write `{{{kinds.written_name(found[0][0])}: {found[0][1].split('`')[1]}}}`"


def _dealt(reader: Any, node: Sequence, cls: type[BaseModel], required: Sequenced[str]) -> str | None:
    """The help for a list of what several fields take: ``[a, b, 100 N/m]`` for a spring between a and b."""
    if len(required) != 1:
        return None
    info = next(info for key, info in cls.model_fields.items() if kinds.written_name(key) == required[0])
    size = len(get_args(info.annotation)) if is_fixed(info.annotation) else 0
    first, rest = node.items[:size], node.items[size:]
    if not size or not rest or not all(isinstance(one, Scalar) for one in node.items):
        return None
    told = [f"{required[0]}: [{', '.join(one.span.text for one in first)}]"]
    for one in rest:
        fitting = quantities_fitting(
            reader, one, {key: more for key, more in cls.model_fields.items() if more is not info}
        )
        if len(fitting) != 1:
            return None
        told.append(f"{kinds.written_name(*fitting)}: {one.span.text}")
    return f"write `{{{', '.join(told)}}}`"


def _listing(cls: type[BaseModel], name: str) -> bool:
    """Whether a field is a list of parts."""
    (info,) = [info for key, info in cls.model_fields.items() if kinds.written_name(key) == name]
    lists = [arm for arm in (info.annotation, *get_args(info.annotation)) if get_origin(arm) in (list, tuple)]
    return any(isinstance(mark, kinds.Refers) for arm in lists for mark in unwrap(get_args(arm)[0])[1])


def choice_meant(text: str, choices: Sequenced[str]) -> str | None:
    """The help for a choice that is written otherwise: its words in another order, or joined, `upper left`."""
    pieces = re.sub(r"[^a-z]+", " ", text.lower()).replace("upper", "top").replace("lower", "bottom").split()
    same = [one for one in choices if sorted(one.split()) == sorted(pieces)]
    return f"did you mean '{same[0]}'?" if len(same) == 1 else suggestion(text, choices)


def _taking(reader: Any, node: Node, cls: type[BaseModel]) -> Iterator[str]:
    """The names of fields that accept a list of values."""
    nothing = Diagnostics()
    names = replace(reader.names, found=nothing)
    trial = replace(reader, found=nothing, names=names, refer=lambda node, mark, name: None)
    for name, info in cls.model_fields.items() if whole(node) else ():
        with suppress(Unreadable):
            trial.field(node, info, name)
            if not nothing.errors:
                yield kinds.written_name(name)
        nothing.found.clear()


def _takes(reader: Any, node: Node, cls: type[BaseModel], name: str) -> bool:
    """Whether a field of a record, a formula or a quantity, accepts a value."""
    return name in _formulas(reader, node, cls) or name in quantities_fitting(
        reader, node, {name: cls.model_fields[name]}
    )


def _paints(reader: Any, node: Node, cls: type[BaseModel]) -> list[str]:
    """The field `color`, if there is one and the value is a color."""
    nothing = Diagnostics()
    fits = paint.read_color(node, replace(reader.names, found=nothing), nothing) is not None
    return ["color"] if fits and "color" in cls.model_fields else []


def _formulas(reader: Any, node: Node, cls: type[BaseModel]) -> Iterator[str]:
    """The names of formula fields that accept a value."""
    nothing = Diagnostics()
    trial = replace(reader, found=nothing, names=replace(reader.names, found=nothing))
    for name, info in cls.model_fields.items():
        for mark in marks_of(info):
            if isinstance(mark, kinds.Symbols) and mark.dimension is not None:
                with suppress(Unreadable):
                    trial.formula(node, mark, name)
                    yield name
