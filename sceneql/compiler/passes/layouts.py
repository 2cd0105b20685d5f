"""Layouts and graphs ask for variants that the script has, and for what can fill a panel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sceneql.graph import Task
from sceneql.kinds import EachVariant, Overlay, Picture
from sceneql.quantities.diagnostic import Diagnostics


def check_layouts(tasks: Mapping[str, Task], variants: Sequence[str] | None, found: Diagnostics) -> None:
    """Report what asks for variants of a script that has none, and what cannot fill a panel.

    ``variants`` is None where it is not known which there are.
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
