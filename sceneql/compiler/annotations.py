"""Inspection of field types: marks, quantities, and which nodes of a script suit a type."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel

from sceneql import kinds
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.dimension import DENSITY, LENGTH, PRESSURE
from sceneql.quantities.units import format_quantity

_USUAL = {PRESSURE: "10 kPa", DENSITY: "1000 kg/m^3", LENGTH: "0.1 m"}
"""Examples where 1 in SI is far from what things have."""
_CALLED = {"torque": "1 N*m"}
"""Examples of fields by name where their dimension has another unit: 1 J is no torque."""
SPACE = ("x", "y", "z", "t")
COMPONENTS = ("x", "y", "z")
_SHOWN = re.compile(r"`([^`]*[\[{.\d\"][^`]*)`")


def unwrap(annotation: Any) -> tuple[Any, tuple[Any, ...]]:
    """A type without its ``Annotated`` marks, and the marks."""
    if get_origin(annotation) is Annotated:
        base, *marks = get_args(annotation)
        inner, more = unwrap(base)
        return inner, (*marks, *more)
    return annotation, ()


def marks_of(info: Any) -> list[Any]:
    """The marks of a field's type and of its members."""
    arms = [info.annotation, *get_args(info.annotation)]
    return [*info.metadata, *(mark for arm in arms for mark in unwrap(arm)[1])]


def quantities(info: Any) -> list[kinds.Quantity]:
    """The Quantity marks of a field's type."""
    return [mark for mark in marks_of(info) if isinstance(mark, kinds.Quantity)]


def is_fixed(annotation: Any) -> bool:
    """Whether a type is a tuple of fixed length."""
    return get_origin(annotation) is tuple and get_args(annotation)[-1] is not Ellipsis


def could_be(annotation: Any, node: Node) -> bool:
    """Whether a node's shape suits a type, to choose among the members of a union."""
    base, marks = unwrap(annotation)
    origin = get_origin(base)
    if any(isinstance(mark, kinds.Quantity | kinds.Paint | kinds.Turn | kinds.Refers) for mark in marks):
        return True
    if origin is dict or (isinstance(base, type) and issubclass(base, BaseModel)):
        return isinstance(node, Mapping)
    if origin in (list, tuple):
        return isinstance(node, Sequence)
    if base is kinds.Formula:
        return isinstance(node, Scalar | Sequence)
    if origin is Literal:
        return isinstance(node, Scalar) and node.text in [str(c) for c in get_args(base)]
    return isinstance(node, Scalar)


def example_of(cls: type[BaseModel], name: str) -> str:
    """An example of what may stand behind a field of a record, for messages: a quantity in its unit, or fields."""
    (info,) = [info for key, info in cls.model_fields.items() if kinds.written_name(key) == name]
    extra: Any = info.json_schema_extra or {}
    default = extra.get("default")
    if any(isinstance(mark, kinds.Turn) for mark in marks_of(info)):
        return "{about: y, angle: 30 deg}"
    if isinstance(default, str) and default and any(character.isdigit() and character != "0" for character in default):
        return default
    if info.annotation is bool:
        return "yes"
    dimensions = (mark.dimension for mark in quantities(info) if not mark.shape and mark.dimension is not None)
    if (one := next(dimensions, None)) is not None:
        return _CALLED.get(name) or _USUAL.get(one, format_quantity(1.0, one))
    if (vector := _vector(quantities(info))) is not None:
        return vector
    refers = any(isinstance(mark, kinds.Refers) for mark in marks_of(info))
    if (shown := _SHOWN.search(info.description or "")) is not None and not refers:
        return f"{{{shown[1]}}}" if ": " in shown[1] and shown[1][0] not in "[{" else shown[1]
    if any(isinstance(mark, kinds.Symbols) and mark.names == SPACE for mark in marks_of(info)):
        return "x^2 + y^2 + z^2 - 1"
    formula = next((mark.dimension for mark in marks_of(info) if isinstance(mark, kinds.Symbols)), None)
    if formula is not None:
        return _USUAL.get(formula, format_quantity(1.0, formula))
    records = [arm for arm in get_args(info.annotation) if isinstance(arm, type) and issubclass(arm, BaseModel)]
    if not records:
        return "..."
    needed = [kinds.written_name(key) for key, one in records[0].model_fields.items() if one.is_required()]
    return f"{{{', '.join(f'{key}: {example_of(records[0], key)}' for key in needed)}}}"


def _vector(marks: list[kinds.Quantity]) -> str | None:
    """An example of a vector: ``0 1 0 m``."""
    size = next((mark.shape[0] for mark in marks if mark.shape is not None and len(mark.shape) == 1), None)
    dimension = next((mark.dimension for mark in marks if mark.shape), None)
    if size is None or dimension is None:
        return None
    number, _, unit = format_quantity(1.0, dimension).partition(" ")
    return f"{' '.join('0' if size == len(COMPONENTS) and k != 1 else number for k in range(size))} {unit}".rstrip()


def first_field(cls: type[BaseModel]) -> str:
    """The fields of a record that has to have some, else its first field, with examples: ``{mass: 1 kg}``."""
    needed = [kinds.written_name(name) for name, info in cls.model_fields.items() if info.is_required()]
    names = needed or [kinds.written_name(next(iter(cls.model_fields)))]
    return f"{{{', '.join(f'{name}: {example_of(cls, name)}' for name in names)}}}"
