"""Warnings of elastic solids that are held all over, and of loads that act on nothing."""

from __future__ import annotations

from itertools import product
from typing import Any

from sceneql.compiler.meaning.box_values import value
from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.passes.empty_holds import reached
from sceneql.compiler.passes.fillings import Beginning, box_of
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics

PARTS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Places along each side of a solid's box at which a hold is asked for."""
ROOM = 1e-3
"""Tolerance around the box of an object, relative to its size; the corners of a block are exact."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each hold of a whole solid, and report each load that certainly selects no place."""
    start: Any = Beginning(facts.tasks)
    for task in facts.of(Model):
        kind: Any = task.kind
        if "loads" not in type(kind).model_fields or not (kind.hold or kind.loads) or kind.file is not None:
            continue
        box = kind.block.box() if kind.of is None else box_of(kind.of, start)
        if box is None:
            continue
        low, high = ([float(c) for c in corner] for corner in box)
        ends = ", ".join(f"{axis} from {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high, strict=True))
        for name, hold in kind.hold.items():
            still = hold.follows is None and hold.shift.constant and not any(hold.shift.number())
            if hold.where is None or not still or hold.components != "xyz":
                continue
            sides = [[a + part * (b - a) for part in PARTS] for a, b in zip(low, high, strict=True)]
            if all(value(hold.where, place, 0.0) for place in product(*sides)):
                text = f"'{name}' holds all of '{task.name}': nothing moves"
                length, axis, end = max((b - a, k, a) for k, a, b in zip("xyz", low, high, strict=True))
                help = f"its material goes in {ends} m: for its end write `where: {axis} < {end + 1e-3 * length:.4g}`"
                found.warning("nothing-moves", text, hold.where.span or task.span, help=help)
        exact = kind.of is None and kind.block.size is not None
        room = 0.0 if exact else ROOM * max(b - a for a, b in zip(low, high, strict=True))
        for name, load in kind.loads.items():
            if load.misses([a - room for a in low], [b + room for b in high]):
                text = f"'{name}' acts on no part of '{task.name}'"
                help = f"its material goes in {ends} m{reached(load.place(), low, high)}"
                found.error("no-mass", text, load.place() or task.span, help=help)
