"""Warnings of held beams that their weight and loads bend by less than is seen: a modulus in GPa for kPa."""

from __future__ import annotations

from math import hypot
from typing import Any, cast

from sceneql.compiler.meaning.box_values import value
from sceneql.compiler.meaning.facts import Facts, constant, weight
from sceneql.compiler.passes.fall_through import pull_of
from sceneql.compiler.values_below import values_of
from sceneql.graph import Island, Task
from sceneql.kinds import Interaction, Output
from sceneql.quantities.diagnostic import Diagnostics

SEEN = 1e-4
"""Part of a beam's length by which it has to bend to be seen: a twentieth of a pixel where it fills the picture."""
SAFE = 6.0
"""Bound of a cantilever's sag E h^2/(w L^4), w its weight over its volume: 1.5 by Euler and Bernoulli, and room."""
WATER = 1000.0
"""[kg/m^3] Density of a solid that says none."""
PROPOSED = 0.3
"""The same bound over its length, of the modulus that is proposed: it bends by less than a tenth of it."""
TRIES = ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa"))


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such block that nothing reads, alone in its island, on which constant loads act."""
    read = {link.task for task in facts.tasks.values() for one in values_of(task.kind) for link in one.links}
    asked = "expect" in facts.script.settings or any(
        task.span and isinstance(task.kind, Output) and not facts.drawn.get(task.name) for task in facts.all
    )
    for island in facts.groups if facts.whole and not asked else ():
        task = facts.tasks[island.models[0]]
        kind: Any = task.kind
        if len(island.models) > 1 or island.contacts or facts.ties(island) or task.name in read or task.span is None:
            continue
        held = getattr(kind, "block", None) is not None and kind.hold and kind.bent is None
        if held and not any((*kind.velocity, *kind.spin)):
            _block(facts, island, task, found)


def _block(facts: Facts, island: Island, task: Task, found: Diagnostics) -> None:
    kind: Any = task.kind
    formula, size = getattr(kind.law.law, "modulus", None), kind.block.size
    forces = facts.forces(island)
    if size is None or formula is None or kind.law.law.varies("modulus") or len(weight(forces)) < len(forces):
        return
    moved = [hold.follows is not None or constant(hold.shift) != (0.0, 0.0, 0.0) for hold in kind.hold.values()]
    if any(moved):
        return
    pull = pull_of([cast(Interaction, one.kind) for one in forces])
    density = WATER if kind.density is None else value(kind.density, (), 0.0)
    modulus, loads = value(formula, (), 0.0), [constant(load.force) for load in kind.loads.values()]
    if not isinstance(density, float | int) or not isinstance(modulus, float | int) or None in loads:
        return
    length, thick = max(size), min(size)
    press = float(density) * hypot(*(pull or (0.0,)))
    press += sum(hypot(*one) for one in loads) / (size[0] * size[1] * size[2])
    bent = SAFE * press * length**4 / (modulus * thick**2)
    if 0.0 < bent < SEEN * length:
        text = f"'{task.name}' bends by less than {bent:.1g} m, and is {length:.3g} m long: nothing is seen to move"
        soft = modulus * bent / (PROPOSED * length)
        unit, name = next(one for one in TRIES if soft >= one[0] or one[0] == 1.0)
        help = f"write a smaller modulus, as `modulus: {float(f'{soft / unit:.2g}'):g} {name}`, or larger loads"
        found.warning("nothing-moves", text, formula.span or task.span, help=help)
