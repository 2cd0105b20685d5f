"""Warnings of parts of the boundary of a box that are nowhere on it: `where: x > 2` of one that ends at 1 m."""

from __future__ import annotations

from math import hypot
from typing import Any

from sceneql.compiler.meaning.box_values import box
from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.passes.empty_holds import reached
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.intervals import range_of

AXES = ("x", "y", "z")


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such part, by its own formula's bounds over the box."""
    for task in facts.of(Model):
        ends = box(task.kind)
        boundary = getattr(task.kind, "boundary", None)
        if ends is None or not isinstance(boundary, dict) or task.span is None:
            continue
        known: Any = dict(zip(AXES, [*ends, *[(0.0, 0.0)] * (len(AXES) - len(ends))], strict=True))
        for name, part in boundary.items():
            if part.where is not None:
                bounds = range_of(part.where.expr, known)
                nowhere, place = bounds is not None and bounds[1] <= 0.0, part.where.span
            else:
                near = part.near or ()
                away = [max(a - c, c - b, 0.0) for c, (a, b) in zip(near, ends, strict=False)]
                nowhere, place = bool(near) and part.within is not None and hypot(*away) > part.within, part.span
            if nowhere:
                low, high = zip(*ends, *[(0.0, 0.0)] * (len(AXES) - len(ends)), strict=True)
                sides = [f"{axis} from {a:.4g} to {b:.4g}" for axis, (a, b) in zip("xyz", ends, strict=False)]
                text = f"'{name}' is nowhere on the boundary of '{task.name}'"
                help = f"its box goes in {', '.join(sides)} m{reached(place, low, high)}"
                found.warning("no-side", text, place or task.span, help=help)
