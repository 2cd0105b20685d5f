"""Warnings of attraction between masses where there is one mass alone, and of disks of stars that nothing attracts."""

from __future__ import annotations

from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts
from sceneql.kinds import Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such island."""
    for island in facts.groups if facts.whole else ():
        forces = facts.forces(island)
        mutual = [one for one in forces if cast(Interaction, one.kind).mutual]
        for name in island.models:
            task = facts.tasks[name]
            kind: Any = task.kind
            if not {"stars", "constant", "softening"} <= type(kind).model_fields.keys() or task.span is None:
                continue
            if any(not cast(Interaction, one.kind).weighs for one in forces):
                continue  # what it is may hold them together
            what = f"'{forces[0].name}' pulls all of them one way" if forces else "no force acts on them"
            text = f"nothing holds the stars of '{name}' together: {what}"
            fields = f"constant: {kind.constant:g} m^3/kg/s^2, softening: {kind.softening:g} m"
            found.warning("nothing-holds", text, task.span, help=f"write `forces: [{{mutual_gravity: {{{fields}}}}}]`")
        if len(mutual) != len(forces) or not mutual or len(island.models) != 1 or facts.ties(island):
            continue
        task = facts.tasks[island.models[0]]
        single = getattr(task.kind, "of", None) is not None and len(cast(Model, task.kind).static_masses()) == 1
        alone = len([one for one in facts.of(Model) if not cast(Model, one.kind).kinematic]) == 1
        plain = cast(Model, task.kind).inert and not getattr(task.kind, "bodies", None)
        if single and alone and plain and not facts.tasks[mutual[0].name].kind.model_fields_set & {"on", "by"}:
            text = f"'{mutual[0].name}' acts between masses, and '{task.name}' is the only one: nothing pulls it"
            found.warning("nothing-moves", text, mutual[0].span, help="write `gravity` for the Earth's weight")
