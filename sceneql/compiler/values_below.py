"""Search for the time-varying values in a part."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from sceneql.kinds import Text, Value
from sceneql.quantities.expression import Link, walk


def values_of(part: Any) -> list[Value]:
    """All Values in a kind, record, list or dict, at any depth; formulas with links count as Values."""
    if isinstance(part, Value):
        return [part]
    if isinstance(part, Text):
        return part.values
    if isinstance(part, BaseModel):
        return [value for name in type(part).model_fields for value in values_of(getattr(part, name))]
    if isinstance(part, dict):
        return [value for item in part.values() for value in values_of(item)]
    if isinstance(part, list | tuple):
        return [value for item in part for value in values_of(item)]
    expr = getattr(part, "expr", None)
    if expr is not None and any(isinstance(node, Link) for node in walk(expr)):
        return [Value(expr)]
    return []
