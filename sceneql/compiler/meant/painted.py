"""Help for a color in place of a group of fields that has none: the color of the part around it.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from sceneql.compiler import paint
from sceneql.language.tree import Scalar
from sceneql.quantities.diagnostic import Diagnostics


def colored(reader: Any, node: Scalar, cls: type[BaseModel]) -> str | None:
    """The help for ``fill: tomato``; None where the value is no color, or the part around has none."""
    outer: type[BaseModel] | None = reader.outer
    if outer is None or "color" not in outer.model_fields or "color" in cls.model_fields:
        return None
    if node.text in reader.names.parts or node.text in reader.names.defines:
        return None
    nothing = Diagnostics()
    if paint.read_color(node, replace(reader.names, found=nothing), nothing) is None or nothing.errors:
        return None
    return f"a color has a field of its own: write `color: {node.span.text}` in place of this"
