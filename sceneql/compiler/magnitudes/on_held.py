"""Warnings of loads that act on nothing but what is held: the same part of a solid under `loads` and `hold`."""

from __future__ import annotations

from typing import Any

from sceneql.compiler.meaning.facts import Facts
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each load of a solid on just the places that a hold has, in all directions."""
    for task in facts.of(Model):
        kind: Any = task.kind
        loads, holds = getattr(kind, "loads", None), getattr(kind, "hold", None)
        if not isinstance(loads, dict) or not isinstance(holds, dict) or task.span is None:
            continue
        held = {place: name for name, hold in holds.items() if hold.components == "xyz" and (place := _place(hold))}
        for name, load in loads.items():
            if (place := _place(load)) in held:
                text = f"'{name}' acts on just what '{held[place]}' holds: it moves nothing"
                help = "let it act elsewhere, as on the other end"
                found.warning("nothing-moves", text, load.place() or task.span, help=help)


def _place(part: Any) -> tuple[Any, ...] | None:
    """What tells where a part is: its formula as it is written, or its place and distance; None for others."""
    if part.where is not None:
        return None if part.where.span is None else ("".join(part.where.span.text.split()),)
    return None if part.near is None else (*part.near, part.within)
