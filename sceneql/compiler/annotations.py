"""What the type of a field tells of the nodes that it is read from."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel

from sceneql import kinds
from sceneql.language.tree import Mapping, Node, Scalar, Sequence


def unwrap(annotation: Any) -> tuple[Any, tuple[Any, ...]]:
    """The type under its marks, and these."""
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
    """The quantities that a field's type tells of."""
    return [mark for mark in marks_of(info) if isinstance(mark, kinds.Quantity)]


def is_fixed(annotation: Any) -> bool:
    """Whether a type is a tuple of a certain length."""
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
    if origin is Literal:
        return isinstance(node, Scalar) and node.text in [str(c) for c in get_args(base)]
    return isinstance(node, Scalar)
