"""Checks of layouts and graphs: the variants that they show exist, and their panels can be filled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sceneql.graph import Task
from sceneql.kinds import EachVariant, Overlay, Picture
from sceneql.quantities.diagnostic import Diagnostics


def check_layouts(tasks: Mapping[str, Task], variants: Sequence[str] | None, found: Diagnostics) -> None:
    """Report layouts and graphs that show variants of a script without any, and panels that cannot be filled.

    ``variants`` is None where the script's variants are not known.
    """
    for task in tasks.values():
        kind = task.kind
        asks = isinstance(kind, Overlay) and kind.variants()
        if isinstance(kind, Picture):
            asks = any(isinstance(row, EachVariant) for row in kind.layout)
            for ref in kind.laid_out:
                part = tasks[ref.name].kind
                if isinstance(part, Overlay) and not part.fills:
                    message = f"'{ref.name}' is drawn on a picture and fills no panel; a graph does, and a camera"
                    found.error("not-a-panel", message, ref.span)
        if asks and variants is not None and not variants:
            help = "write `variants: {soft: {define.k: 10 N/m}, hard: {define.k: 1 kN/m}}`"
            found.error("no-variants", f"'{task.name}' asks for each variant, but there are none", task.span, help=help)
