"""The JSON Schema of scripts (draft 2020-12), from the words' classes, for completion and hints in editors."""

from __future__ import annotations

import inspect
import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.check import NONE, OPTIONAL
from sceneql.compiler.meant.quantity_help import TRUE
from sceneql.compiler.read import COMPARISON, FALSE
from sceneql.kinds import Formula, Interpolated, Kind, Refers, SceneFile, Settings, written_name
from sceneql.report.manual import type_text

TEXT: dict[str, Any] = {"type": ["string", "number", "integer"]}
REPEAT: dict[str, Any] = {
    "type": "object",
    "properties": {"count": TEXT, "as": {"type": "string"}},
    "required": ["count"],
    "additionalProperties": False,
    "description": "Copies of the entry, numbered from 0 by the name given as `as`.",
}
USE: dict[str, Any] = {
    "type": "object",
    "properties": {"use": {"type": "string"}, "repeat": REPEAT},
    "required": ["use"],
    "description": "Another part of the section, with the fields that stand here in place of its own.",
}


def schema(catalogue: Catalogue) -> dict[str, Any]:
    """The schema of a whole script."""
    properties: dict[str, Any] = {
        "sceneql": {"const": 1, "description": "Version of the language."},
        "define": {"type": ["object", "null"], "description": "Names for values."},
        "include": {
            "anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
            "description": "Scripts of this folder to add.",
        },
        "templates": {"type": ["object", "null"], "description": "Parts with fields, to be used under `parts`."},
        "parts": {"type": ["object", "null"], "description": "Instances of templates."},
        "defaults": {"type": ["object", "null"], "description": "Fields by word, for all entries that leave them out."},
        "variants": {"type": ["object", "null"], "description": "Patches: dotted paths with values."},
    }
    properties |= _record(Settings, catalogue)["properties"]
    definitions = {}
    for family in catalogue.families:
        guests = [other for other, cls in catalogue.families.items() if cls.also_under == family]
        words = [word for name in (family, *guests) for word in catalogue.words(name)]
        kinds = {word: cls for word in words if (cls := catalogue.load(family, word)) is not None}
        definitions[family] = {
            "anyOf": [
                {"enum": words},
                {
                    "type": "object",
                    "properties": {"repeat": REPEAT, **{word: _kind(cls, catalogue) for word, cls in kinds.items()}},
                    "additionalProperties": False,
                },
                USE,
            ]
        }
        entry = {"$ref": f"#/$defs/{family}"}
        named = {"type": ["object", "null"], "additionalProperties": entry}
        if refused := {name: {"anyOf": [{"enum": [NONE]}, entry]} for name, word in OPTIONAL.items() if word in words}:
            named["properties"] = refused
        properties[family] = {"anyOf": [named, {"type": "array", "items": entry}]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "sceneql scene script",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "$defs": definitions,
    }


def _kind(cls: type[Kind], catalogue: Catalogue) -> dict[str, Any]:
    return {**_record(cls, catalogue), "description": inspect.cleandoc(cls.__doc__ or "")}


def _record(cls: type[BaseModel], catalogue: Catalogue) -> dict[str, Any]:
    properties = {}
    for name, info in cls.model_fields.items():
        annotation = Annotated[(info.annotation, *info.metadata)] if info.metadata else info.annotation
        text = f"{info.description} ({type_text(annotation)})"
        properties[written_name(name)] = {**_type(annotation, catalogue), "description": text}
    required = [written_name(name) for name, info in cls.model_fields.items() if info.is_required()]
    return {
        "type": ["object", "null"],
        "properties": properties,
        "additionalProperties": False,
        **({"required": required} if required else {}),
    }


def _type(annotation: Any, catalogue: Catalogue) -> dict[str, Any]:
    base = annotation
    if get_origin(annotation) is Annotated:
        base, *marks = get_args(annotation)
        for mark in marks:
            if isinstance(mark, SceneFile | Interpolated):
                return TEXT
            if isinstance(mark, Refers) and not mark.family:
                return {"type": "string"}
            if isinstance(mark, Refers):
                return {"anyOf": [{"type": "string"}, {"$ref": f"#/$defs/{mark.family}"}]}
        return {"type": ["string", "number", "integer", "array", "object"]}
    origin, arms = get_origin(base), get_args(base)
    if origin in (Union, types.UnionType):
        return {"anyOf": [{"type": "null"} if arm is type(None) else _type(arm, catalogue) for arm in arms]}
    if origin is Literal:
        return {"enum": list(arms)}
    if origin in (list, tuple):
        return {"anyOf": [{"type": "array", "items": _copied(arms[0], catalogue)}, TEXT, {"type": "object"}]}
    if origin is dict:
        return {"type": "object", "additionalProperties": _copied(arms[1], catalogue)}
    if isinstance(base, type) and issubclass(base, BaseModel):
        return _record(base, catalogue)
    if base is Any:
        return {}
    if base is Formula:
        return {"type": [*TEXT["type"], "array"]}
    if base is bool:
        said = [written for word in (*TRUE, *FALSE) for written in (word, word.capitalize(), word.upper())]
        return {"anyOf": [{"enum": [True, False, *said]}, {"type": "string", "pattern": COMPARISON.pattern}]}
    return TEXT


def _copied(annotation: Any, catalogue: Catalogue) -> dict[str, Any]:
    """The schema of a value of a map or list, where a group of fields may be repeated."""
    rule = _type(annotation, catalogue)
    if "properties" not in rule:
        return rule
    repeat = {"anyOf": [REPEAT, {"type": "object", "additionalProperties": {"type": "array"}}]}
    return {**rule, "properties": {**rule["properties"], "repeat": repeat}}
