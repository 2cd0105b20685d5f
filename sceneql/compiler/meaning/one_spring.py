"""Warnings of a mass on one spring along its weight that moves too little, or too slowly, to be seen."""

from __future__ import annotations

from math import dist, hypot, inf
from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.passes.fall_through import pull_of
from sceneql.compiler.passes.unforced import starts_moving
from sceneql.graph import Task
from sceneql.kinds import Interaction
from sceneql.quantities.diagnostic import Diagnostics

SEEN = 2e-3
"""Part of the spring's length by which the mass has to move to be seen."""
ALONG = 1e-6
"""Part of a length up to which a mass hangs beside its weight's line."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such mass, alone in its island, that starts at rest."""
    told = [one.span for one in found.found if one.code == "nothing-moves"]
    for island in facts.groups if facts.whole else ():
        task = facts.tasks[island.models[0]]
        kind: Any = task.kind
        alone = len(island.models) == 1 and not island.contacts and not facts.ties(island)
        if not alone or task.span in told or len(getattr(kind, "springs", None) or ()) != 1 or starts_moving(kind):
            continue
        forces = [cast(Interaction, one.kind) for one in facts.forces(island)]
        pull = pull_of(forces) if forces else (0.0, 0.0, 0.0)
        if pull is not None and getattr(kind, "masses", None) and not kind.tear:
            _spring(facts, task, pull, found)


def _spring(facts: Facts, task: Task, pull: tuple[float, ...], found: Diagnostics) -> None:
    kind: Any = task.kind
    spring, masses = kind.springs[0], kind.static_masses()
    free = [name for name in spring.between if name in masses and not masses[name].fixed]
    if len(masses) != 2 or len(free) != 1 or not all(name in masses for name in spring.between):
        return
    stiffness, damping = (
        own if own is not None else (of.number() if of.constant else None)
        for own, of in ((spring.stiffness, kind.stiffness), (spring.damping, kind.damping))
    )
    mass, ends = masses[free[0]], [masses[name].position for name in spring.between]
    if stiffness is None or damping is None or None in ends:
        return
    length, size = dist(*ends), hypot(*pull)
    across = [a - b for a, b in zip(*ends, strict=True)]
    turned = [across[k - 2] * pull[k - 1] - across[k - 1] * pull[k - 2] for k in range(3)]
    if length == 0.0 or hypot(*turned) > ALONG * length * size:
        return
    end, most = facts.clock.end, abs(length - (length if spring.rest is None else spring.rest))
    force = stiffness * most + mass.mass * size
    ways = {
        "a softer spring": 2.0 * force / stiffness,
        "less `damping`": force / damping * end if damping else inf,
        "a stiffer spring, a smaller mass, or a longer clock": 0.5 * force / mass.mass * end * end,
    }
    help, way = min(ways.items(), key=lambda one: one[1])
    if force > 0.0 and way < SEEN * length:
        text = f"'{free[0]}' of '{task.name}' moves by at most {way:.1g} m until {end:g} s: nothing is seen to move"
        more = f": as `stiffness: {float(f'{40.0 * force / length:.1g}'):g} N/m`" if help.startswith("a softer") else ""
        found.warning("nothing-moves", text, task.span, help=f"write {help}{more}, or let it start aside")
