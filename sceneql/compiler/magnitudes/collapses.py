"""Warnings of solids and nets that are crushed by their own weight: a modulus in Pa for kPa, masses in kg for g."""

from __future__ import annotations

import re
from math import hypot
from typing import Any, cast

from sceneql.compiler.meaning.box_values import value
from sceneql.compiler.meaning.facts import Facts, constant, weight
from sceneql.compiler.passes.fall_through import pull_of
from sceneql.compiler.passes.fillings import Beginning, box_of
from sceneql.graph import Task
from sceneql.kinds import Interaction
from sceneql.quantities.diagnostic import Diagnostics

_BARE = re.compile(r"[\d.]+(?:e[-+]?\d+)?")
CRUSHED = 10.0
"""Weight of a column over what it resists by, from which on it certainly lies flat."""
OF_METALS, TABLED = 1700.0, 1000.0
"""Density [kg/m^3] of the lightest of metals, and what their moduli are below in GPa."""
FIRM = 0.1
"""The same, at which it keeps its form."""
WATER = 1000.0
"""[kg/m^3] Density of a solid that says none."""
DIAGONALS = 4.3
"""How often as stiff as its upright springs a column of a lattice is at most, by the diagonals beside it."""
UNITS = ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa"))


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such solid or lattice that is held or lies on something."""
    told = [one.span for one in found.found if one.code == "too-soft"]
    for island in facts.groups:
        pull = pull_of([cast(Interaction, one.kind) for one in weight(facts.forces(island))])
        if pull is None or pull[1] >= 0.0:
            continue
        for name in island.models:
            task = facts.tasks[name]
            if task.span is None or not (island.contacts or _kept(task.kind)):
                continue
            law = getattr(task.kind, "law", None)
            if hasattr(law, "law") and hasattr(task.kind, "block"):
                _solid(facts, task, hypot(*pull), told, found)
            elif getattr(task.kind, "lattice", None) is not None:
                _lattice(task, hypot(*pull), told, found)


def _kept(kind: Any) -> bool:
    return bool(getattr(kind, "hold", None) or getattr(kind, "pins", None))


def _solid(facts: Facts, task: Task, pull: float, told: list[Any], found: Diagnostics) -> None:
    """A solid of elements; of one that is turned, or that nothing but its sides is known of, the least side is high."""
    kind: Any = task.kind
    law = kind.law.law
    formula = getattr(law, "modulus", None)
    if formula is None or law.varies("modulus") or formula.span in told:
        return
    density = WATER if kind.density is None else value(kind.density, (), 0.0)
    modulus = value(formula, (), 0.0)
    box = _box(facts, task)
    if not isinstance(density, float | int) or not isinstance(modulus, float | int) or box is None:
        return
    sides = [float(b - a) for a, b in zip(*box, strict=True)]
    high = sides[1] if kind.rotation is None else min(sides)
    load = float(density) * pull * high
    if load > CRUSHED * modulus:
        text = f"'{task.name}' collapses: its weight, {high:.3g} m high, makes {_three(load)} Pa, "
        text += f"and its modulus is {modulus:.3g} Pa"
        meant = next(modulus * by for by in (1e3, 1e6, 1e9, 1e12) if load < FIRM * modulus * by or by > 1e9)
        if formula.span is not None and _BARE.fullmatch(formula.span.text) and density > OF_METALS:
            meant = modulus * (1e9 if modulus < TABLED else 1e6)  # as tables have it
        size, unit = next(one for one in UNITS if meant >= one[0] or one[0] == 1.0)
        help = f"write `modulus: {meant / size:.3g} {unit}`; metals have some GPa, rubber some MPa, jelly some kPa"
        found.warning("too-soft", text, formula.span or task.span, help=help)


def _box(facts: Facts, task: Task) -> Any:
    kind: Any = task.kind
    if kind.block is not None:
        return kind.block.box()
    return None if kind.of is None else box_of(kind.of, Beginning(facts.tasks))


def _lattice(task: Task, pull: float, told: list[Any], found: Diagnostics) -> None:
    """A lattice of springs, by the masses over the lowest layer."""
    kind: Any = task.kind
    stiffness, lattice = constant(kind.stiffness), kind.lattice
    if not isinstance(stiffness, float) or task.span in told or lattice.rotation is not None:
        return
    load = (lattice.count[1] - 1) * kind.mass * pull
    resists = DIAGONALS * stiffness * lattice.spacing
    if load > CRUSHED * resists:
        text = f"'{task.name}' collapses: {_three(load)} N press on each of its lowest springs, "
        text += f"which {_three(stiffness * lattice.spacing)} N press flat"
        help = f"write `mass: {_two(kind.mass * FIRM * resists / load)} kg`, or "
        help += f"`stiffness: {_two(stiffness * load / (FIRM * resists))} N/m`"
        found.warning("too-soft", text, task.span, help=help)


def _two(number: float) -> str:
    return f"{float(f'{number:.2g}'):.12g}"


def _three(number: float) -> str:
    return f"{float(f'{number:.3g}'):.12g}"
