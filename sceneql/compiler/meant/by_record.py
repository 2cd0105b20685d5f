"""Help for unknown fields that the whole record, and the parts that they name, tell: a scale, entries by name, balls.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the record.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler.annotations import unwrap
from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.meant.by_value import by_value
from sceneql.compiler.meant.chained import swept
from sceneql.compiler.meant.going_along import carried
from sceneql.compiler.meant.own_values import in_si
from sceneql.compiler.meant.under_names import equated
from sceneql.compiler.meant.unwrapped import unwrapped
from sceneql.compiler.meant.values_elsewhere import quantities_fitting
from sceneql.compiler.names import Names
from sceneql.kinds import Kind
from sceneql.language.in_group import in_group
from sceneql.language.one_line import one_line
from sceneql.language.scope import Entry
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import STRONG, nearest, same_as

LOOKS = ("radius", "material", "color")
"""Fields of an object that masses have themselves."""
CONSTANTS = ("params", "parameters", "constants", "args", "coefficients")
"""Fields of other programs for the constants of a system of equations."""
ANGLES = ("angle", "launch_angle", "elevation", "theta")
"""Fields of other programs for the angle of a throw."""
SEVERAL = 2
"""Least number of fields that tell the field that they stand in."""
ANOTHER = "the word says the shape, and its fields stand in it"
"""Beginning of a help that writes another word in place of the record's."""
USUAL_MODEL = "particles"
"""The model of what moves as a whole, in examples."""
PUSH = "push"
"""Name of a force in examples."""
SHOWN = 300
"""Longest value that a message repeats."""


def by_record(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for an unknown field of a record, by its other fields and the parts that it names."""
    known = [kinds.written_name(key) for key in cls.model_fields]
    sweep = node.entries.get("sweep")
    if "sweep" in known and isinstance(sweep, Scalar) and (path := swept(reader, node.entries, sweep.text)) is not None:
        return path
    if (told := by_value(reader, cls, name, node)) is not None:
        return told
    if (carrier := carried(reader, cls, name, node)) is not None:
        return carrier
    if not issubclass(cls, kinds.Kind):
        return None
    if issubclass(cls, kinds.Object):
        if name == "scale" and "position" in known:
            word = cls.__module__.rpartition(".")[2]
            return f"write its sizes as they shall be, or let a group scale it: `{in_group(word, node.entries)}`"
        if (model := _of_model(reader, name, node.entries[name])) is not None:
            return model
        if (moved := _moving(reader, cls, name, node)) is not None:
            return moved
        if (around := _around(reader, cls, name, node)) is not None:
            return around
        plain = unwrapped(node, cls.family, reader.names.catalogue)
        if plain is not None:
            return f"{ANOTHER}: write `{plain}`"
        named = node.entries[name].span.text.removesuffix(".positions") in reader.names.parts
        return balls_of(reader.names, node) if named else None
    told = _by_names(reader, cls, name, node) or _inside_one(cls, name, node) or _of_force(reader, cls, name, node)
    return told or _of_one(reader, cls, name, node) or _system(known, name, node) or _thrown(known, name, node)


def balls_of(names: Names, node: Node | None) -> str | None:
    """The help for the fields of an object at all masses of a model, which are balls by themselves: of which radius."""
    fields = node.entries if isinstance(node, Mapping) else {}
    for one in fields.values() if {*LOOKS} & fields.keys() else ():
        model = one.text.removesuffix(".positions") if isinstance(one, Scalar) else ""
        entry = names.parts.get(model)
        if entry is None or "positions" not in (names.outputs_of(model) or ()):
            continue
        look = ", ".join(f"{key}: {fields[key].span.text}" for key in LOOKS if key in fields)
        own = f"write `{look}` among the fields of `{model}`, the {entry.word}"
        return f"its masses are balls by themselves: {own}; soft discs are `{{sprites: {{points: {model}.positions}}}}`"
    return None


def judged_as(entry: Entry, family: str, catalogue: Catalogue, names: Names, help: str) -> type[Kind] | None:
    """The class of the word nearest to an unknown one, whose fields the entry's are judged by; None for none.

    It has to have most of them; all of them where the ``help`` for the word writes the entry anew.
    """
    fields, near = entry.fields, nearest(entry.word, words := catalogue.choices(family))
    cls = None if near is None else catalogue.load(family, near)
    if cls is None or not isinstance(fields, Mapping) or (family == "objects" and balls_of(names, fields) is not None):
        return None
    known = {kinds.written_name(name): info for name, info in cls.model_fields.items()}
    required = {name for name, info in known.items() if info.is_required()}
    fits = known.keys() >= fields.entries.keys() and (fields.partial or required <= fields.entries.keys())
    matched = [one for one in (nearest(name, known, STRONG) for name in fields.entries) if one is not None]
    like = nearest(entry.word, words, STRONG) == near and 2 * len(matched) >= len(fields.entries)
    like = like and "write `{" not in help
    return cls if fits or (like and bool(matched) and required <= {*matched}) else None


def _by_names(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for entries by name whose fields are those of the entries that another field holds."""
    table = node.entries[name]
    if not isinstance(table, Mapping) or not table.entries:
        return None
    for field, record in _tables(cls):
        inner = {kinds.written_name(key) for key in record.model_fields}
        held = [one.entries.keys() for one in table.entries.values() if isinstance(one, Mapping) and one.entries]
        text = one_line(table)
        if field not in node.entries and len(held) == len(table.entries) and all(keys <= inner for keys in held):
            text = text if len(text) <= SHOWN else f"{{{next(iter(table.entries))}: {{...}}, ...}}"
            of_one = f"{reader.owner}.{next(iter(table.entries))}"
            return f"write `{field}: {text}`; one of them is then `{of_one}.position`"
    return None


def _inside_one(cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for several unknown fields that stand together inside of one that is not written: ``count, within``."""
    known = [kinds.written_name(key) for key in cls.model_fields]
    unknown = [one for one in node.entries if one not in known]
    for key, info in cls.model_fields.items():
        records = [one for one in get_args(info.annotation) if isinstance(one, type) and issubclass(one, BaseModel)]
        field = kinds.written_name(key)
        if len(records) != 1 or issubclass(records[0], kinds.Kind) or field in node.entries:
            continue
        inner = [kinds.written_name(each) for each in records[0].model_fields]
        needed = {kinds.written_name(each) for each, one in records[0].model_fields.items() if one.is_required()}
        meant = {one: one if one in inner else same_as(one, inner) for one in unknown}
        found = {
            one: ours for one, ours in meant.items() if ours is not None and "\n" not in node.entries[one].span.text
        }
        if name in found and len(found) >= SEVERAL and needed and needed <= {*found.values()}:
            text = ", ".join(f"{ours}: {_hidden(records[0], ours, node.entries[one])}" for one, ours in found.items())
            return f"write `{field}: {{{text}}}`"
    return None


def _hidden(record: type[BaseModel], field: str, value: Node) -> str:
    """The text of a value; an object made in place is hidden where the field's line of the manual says so."""
    info = next(info for key, info in record.model_fields.items() if kinds.written_name(key) == field)
    text = value.span.text
    usual = "a hidden one" in (info.description or "") and isinstance(value, Mapping) and text.endswith("}}")
    if not usual or "hidden" in text:
        return text
    return f"{text[:-2]}{'' if text[:-2].endswith('{') else ', '}hidden: yes}}}}"


def _of_one(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for a field of the only one of what another field holds by name: the position of a particle."""
    known = {kinds.written_name(key) for key in cls.model_fields}
    for field, record in _tables(cls):
        inner = {kinds.written_name(key) for key in record.model_fields}
        own = {one: value.span.text for one, value in node.entries.items() if one in inner}
        alone = name in inner and not {field, "of"} & node.entries.keys() and len(own) > 1
        if alone and not any("\n" in text for text in own.values()) and name not in known:
            text = ", ".join(f"{one}: {value}" for one, value in own.items())
            place = f"{reader.owner}.one.position"
            return f"it is told of each: write `{field}: {{one: {{{text}}}}}`; its place is then `{place}`"
    return None


def _of_model(reader: Any, name: str, value: Node) -> str | None:
    """The help for a model's word as a group in the object that it moves: ``Rigidbody: {mass: 2 kg}``."""
    words = reader.names.catalogue.words("models")
    word = name if name in words else same_as(name, words)
    if word is None or not isinstance(value, Mapping) or "." in reader.owner:
        return None
    cls = reader.names.catalogue.load("models", word)
    if cls is None or not {"of", "domain"} & {*cls.model_fields}:
        return None
    field = "of" if "of" in cls.model_fields else "domain"
    fields = "".join(f", {one}: {inner.span.text}" for one, inner in value.entries.items() if one != field)
    told = f"{{my_{word}: {{{word}: {{{field}: {reader.owner}{fields}}}}}}}"
    return f"a model is a part of its own, that names the object: write `models: {told}`"


def _moving(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for fields of a model, ``mass``, ``velocity``, in the object that it moves."""
    model, owner = reader.names.catalogue.load("models", USUAL_MODEL), reader.owner
    known = [kinds.written_name(key) for key in cls.model_fields]
    mine = {"mass", "velocity"} & {*model.model_fields} if model is not None else set()
    told = {one: value.span.text for one, value in node.entries.items() if one in mine and one not in known}
    if name not in told or "." in owner or any("\n" in text for text in told.values()):
        return None
    fields = ", ".join(f"{one}: {text}" for one, text in told.items())
    if mover := reader.names.mover(owner):
        return f"'{mover}' moves it: write `{fields}` among the fields of that"
    whole = f"models: {{my_{owner}: {{{USUAL_MODEL}: {{of: {owner}, {fields}}}}}}}"
    return f"an object moves by a model: write `{whole}`: `sceneql words {USUAL_MODEL}`"


def _around(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for an object's word that takes another one, as a field of that: ``twist: 90 deg`` of a box."""
    word, value = cls.__module__.rpartition(".")[2], node.entries[name]
    other = reader.names.catalogue.load("objects", name)
    if other is None or "of" not in other.model_fields or not isinstance(value, Scalar):
        return None
    fields = list(quantities_fitting(reader, value, other.model_fields))
    rest = ", ".join(f"{key}: {one.span.text}" for key, one in node.entries.items() if key != name)
    if not fields or "\n" in rest or len(rest) > SHOWN:
        return None
    inner = f"{{{word}: {{{rest}}}}}"
    told = f"{{{name}: {{of: {inner}, {kinds.written_name(fields[0])}: {value.span.text}}}}}"
    return f"it is an object around another: write `{told}`"


def _of_force(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for a force's word, or one that means it, as a field of a model: ``torque: 0 3 0 N*m``.

    With the value where the force has one field for it; of a torque's size alone, about y.
    """
    catalogue, value = reader.names.catalogue, node.entries[name]
    word = same_as(name, catalogue.words("forces")) if issubclass(cls, kinds.Model) else None
    force = None if word is None else catalogue.load("forces", word)
    if force is None or not isinstance(value, Scalar) or "." in reader.owner:
        return None
    fields = list(quantities_fitting(reader, value, force.model_fields))
    components = dict(force.model_fields).get("components")
    text = value.span.text
    if components is not None and len(size := in_si(text)) in (1, 3):
        fields, many = ["components"], [f"{number:g}" for number in size]
        text = f"[{', '.join(many if len(many) > 1 else ['0', many[0], '0'])}]"
    if len(fields) != 1:
        return None
    told = f"{{{word}: {{{kinds.written_name(fields[0])}: {text}, on: [{reader.owner}]}}}}"
    others = {one: entry for one, entry in reader.names.parts.items() if catalogue.load("forces", entry.word)}
    listed = all(one == entry.word and entry.fields is None for one, entry in others.items())
    section = f"[{', '.join([*others, told])}]" if listed else f"{{..., {PUSH}: {told}}}"
    return f"forces are a section of their own: write `forces: {section}`"


def _system(known: Collection[str], name: str, node: Mapping) -> str | None:
    """The help for equations as a book writes them, and for their constants, in a system of them."""
    value = node.entries[name]
    if not {"start", "rate"} <= {*known}:
        return None
    if name in CONSTANTS and isinstance(value, Mapping) and "\n" not in value.span.text:
        return f"constants stand at the left margin: write `define: {value.span.text}`"
    items = value.items if isinstance(value, Sequence) else [value]
    rates = equated([one.text for one in items if isinstance(one, Scalar)])
    return None if rates is None else f"write `rate: {{{rates}}}`"


def _thrown(known: Collection[str], name: str, node: Mapping) -> str | None:
    """The help for a speed and its angle in place of a velocity."""
    speed = next((node.entries[one].span.text for one in ("velocity", "speed", "v0") if one in node.entries), "")
    if name not in ANGLES or "velocity" not in known or not re.fullmatch(r"[\d.]+ *[a-z]+/[a-z]+", speed):
        return None
    angle = node.entries[name].span.text
    angle = angle if angle[-1:].isalpha() else f"{angle} deg"
    return f"write `velocity: [{speed}*cos({angle}), {speed}*sin({angle}), 0 m/s]`"


def _tables(cls: type[BaseModel]) -> Iterator[tuple[str, type[BaseModel]]]:
    """The fields that hold records by name, and the class of these."""
    for key, info in cls.model_fields.items():
        for arm in (info.annotation, *get_args(info.annotation)):
            base, _ = unwrap(arm)
            held = get_args(base)[1] if get_origin(base) is dict else None
            if isinstance(held, type) and issubclass(held, BaseModel) and "position" in held.model_fields:
                yield kinds.written_name(key), held
