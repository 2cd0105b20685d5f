"""Warnings of elastic solids that are held all over or far from where it is said, and of loads that act on nothing."""

from __future__ import annotations

from itertools import product
from math import dist, hypot
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
FAR = 0.05
"""Distance from the box of a solid, relative to its size, from which on a place is hardly meant to be one of it."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of holds of a whole solid, of a line, and of places far outside; report each load that selects nothing."""
    start: Any = Beginning(facts.tasks)
    kinds: dict[str, Any] = {name: task.kind for name, task in facts.tasks.items()}
    resting = {name for one in facts.groups if getattr(kinds.get(one.solver), "static", False) for name in one.models}
    for task in facts.of(Model):
        kind: Any = task.kind
        if "loads" not in type(kind).model_fields or not (kind.hold or kind.loads) or kind.file is not None:
            continue
        box = kind.block.box() if kind.of is None else box_of(kind.of, start)
        if task.name in resting and (free := _may_turn(kind)):
            text = f"'{task.name}' is held at {free}, and there is no rest where forces turn it on and on"
            help = "hold a third point beside them, or a face, as `where: x < 0.1`"
            found.warning("nothing-holds", text, task.span, help=help)
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
        for name, part in (*kind.hold.items(), *kind.loads.items()):
            if part.near is None or part.within is not None:
                continue
            nearest = [min(max(x, a), b) for x, a, b in zip(part.near, low, high, strict=True)]
            away = dist(part.near, nearest)
            if away > FAR * max(b - a for a, b in zip(low, high, strict=True)):
                does = "holds" if name in kind.hold and part is kind.hold[name] else "acts on"
                text = f"'{name}' {does} the nearest point of '{task.name}', at least {away:.3g} m from there"
                help = f"its material goes in {ends} m: write `near: {' '.join(f'{x:.4g}' for x in nearest)} m`"
                found.warning("nothing-near", text, task.span, help=help)
        for name, load in kind.loads.items():
            if load.misses([a - room for a in low], [b + room for b in high]):
                text = f"'{name}' acts on no part of '{task.name}'"
                help = f"its material goes in {ends} m{reached(load.place(), low, high)}"
                found.error("no-mass", text, load.place() or task.span, help=help)


def _may_turn(kind: Any) -> str:
    """About what a solid is free to turn, which is held at points of one line alone; empty for another."""
    points = [one.near for one in kind.hold.values() if one.near is not None and one.within is None]
    if not points or len(points) < len(kind.hold):
        return ""
    first = points[0]
    far = max(points, key=lambda place: dist(place, first))
    if far == first:
        return "one point: it is free to turn about it"
    along = [b - a for a, b in zip(first, far, strict=True)]
    for place in points:
        x, y, z = (b - a for a, b in zip(first, place, strict=True))
        across = (y * along[2] - z * along[1], z * along[0] - x * along[2], x * along[1] - y * along[0])
        if hypot(*across) > ROOM * hypot(*along) ** 2:
            return ""
    one, two = (f"({', '.join(f'{x:.4g}' for x in place)})" for place in (first, far))
    return f"points of one line: it is free to turn about that through {one} and {two} m"
