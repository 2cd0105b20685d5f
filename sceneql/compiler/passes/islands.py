"""Grouping of models into islands: which are solved together, by which solver, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sceneql.compiler.passes.reads import reads
from sceneql.compiler.passes.touchable import no_collider, touchable
from sceneql.compiler.passes.uncarried import report_carried
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Interaction, Kind, Model, Object, Solver, Tie
from sceneql.quantities.diagnostic import Diagnostics, Note
from sceneql.quantities.instead import instead

_SUITS = {
    "a field": ("is_field", "a field on a grid"),
    "a flow": ("flows", "an island with a flow"),
    "several fluids": ("flows", "an island with a flow"),
}
"""By what a solver marches: what one of its models must be, and its name."""
_COLLIDES = "choose auto, rk4, dop853 or verlet for it, or leave the contact out"
_OTHER = "name the models that it is for, `on: [NAME]`, or let `auto` march; masses take rk4, verlet or dop853, too"


def islands(tasks: Mapping[str, Task], found: Diagnostics) -> tuple[Island, ...]:
    """The islands of a script's dynamic models, in script order.

    Models are tied by a force or contact whose values read one and act on the other, by a mutual force, by a contact
    between two of them, and by values of their own that read another's outputs.
    """
    models = [t for t in tasks.values() if isinstance(t.kind, Model) and not t.kind.kinematic]
    names = [t.name for t in models]
    root = {name: name for name in names}

    def find(name: str) -> str:
        while root[name] != name:
            name = root[name]
        return name

    def tie(a: str, b: str) -> None:
        if a in root and b in root:
            root[max(find(a), find(b), key=names.index)] = min(find(a), find(b), key=names.index)

    forces = {t.name: acts_on(t, models, tasks) for t in tasks.values() if isinstance(t.kind, Interaction)}
    for force, targets in forces.items():
        kind = tasks[force].kind
        if isinstance(kind, Interaction) and kind.carrier() is not None:
            continue
        weighed = isinstance(kind, Interaction) and kind.weighs
        if targets and not any(_has_mass(tasks[name].kind, weighed) for name in targets):
            text = f"{tasks[force].word} acts on masses, and there are none in {' and '.join(targets)}"
            found.error("no-mass", text, tasks[force].span)
        named = kind.targets() if isinstance(kind, Interaction) and not isinstance(kind, Tie) else None
        if named and not targets:
            text = f"{tasks[force].word} acts on masses, and no model moves {' and '.join(map(repr, named))}"
            found.error(
                "no-mass", text, tasks[force].span, help=f"write `models: {{fall: {{particles: {{of: {named[0]}}}}}}}`"
            )
    report_carried(models, forces, tasks, found)
    driver = {
        name: _body(t.name, led) for t in models if isinstance(t.kind, Model) for name, led in t.kind.drives().items()
    }
    inside = {ref.name: t.name for t in tasks.values() if isinstance(t.kind, Object) for ref in t.kind.members()}
    for task in models:
        for name in task.kind.drives() if isinstance(task.kind, Model) and task.kind.turns else ():
            if name in inside:
                text = f"'{name}' is part of '{inside[name]}', in whose coordinates it stands: it is no body by itself"
                found.error("no-body", text, task.span, help=f"let '{inside[name]}' be the body")
    for task in tasks.values():
        for ref in task.kind.between if isinstance(task.kind, Tie) else ():
            if ref.name in inside:
                text = f"'{ref.name}' is part of '{inside[ref.name]}', in whose coordinates it stands"
                found.error("no-body", text, ref.span, help=f"name that: `{inside[ref.name]}`")
            elif ref.name in driver:
                text = f"'{ref.name}' is moved by '{driver[ref.name].partition('.')[0]}'"
                found.error("no-body", text, ref.span, help=f"name that: `{driver[ref.name]}`")
        if isinstance(task.kind, Tie) and task.kind.targets() and not set(forces[task.name]) & set(names):
            text = "a tie needs a body that it can hold: neither of these is moved by forces"
            if not {ref.name for ref in task.kind.between} & {*inside, *driver}:
                found.error("no-mass", text, task.kind.between[0].span)
    contacts = {t.name: _touching(t, tasks, names, found) for t in tasks.values() if isinstance(t.kind, Contact)}
    for task in models:
        for other in reads(task.name, tasks):
            tie(task.name, other)
    for force, targets in forces.items():
        for other in reads(force, tasks):
            for target in targets:
                tie(target, other)
        kind = tasks[force].kind
        if isinstance(kind, Interaction) and kind.mutual:
            for target in targets[1:]:
                tie(targets[0], target)
    for contact, (targets, others) in contacts.items():
        kind = tasks[contact].kind
        if len(targets) > 1 and (not others or (isinstance(kind, Contact) and kind.mutual)):
            for target in targets[1:]:
                tie(targets[0], target)
        together = ("has_skin", "turns", "carried")
        if any(getattr(tasks[target].kind, what, False) for target in targets for what in together):
            for target in targets[1:]:
                tie(targets[0], target)
        for surface in others:
            for other in reads(surface, tasks):
                for target in targets:
                    tie(target, other)

    result = []
    for first in [name for name in names if find(name) == name]:
        group = tuple(name for name in names if find(name) == first)
        solver, reason = _solver(group, tasks, found)
        tied = [f for f, targets in forces.items() if isinstance(tasks[f].kind, Tie) and set(targets) & set(group)]
        marching = tasks[solver].kind
        if isinstance(marching, Solver) and marching.refuses_ties and not pivots(tied, tasks):
            word = tasks[solver].word
            message = f"{word} does not march bodies that ties hold, as '{tied[0]}' does: {marching.refuses_ties}"
            help = "choose auto, rk4, dop853 or verlet for them"
            found.error("refuses-ties", message, tasks[solver].span, help=help)
        if (
            isinstance(marching, Solver)
            and marching.refuses_contacts
            and any(set(targets) & set(group) for targets, _ in contacts.values())
        ):
            message = f"{tasks[solver].word} does not march what collides: {marching.refuses_contacts}"
            found.error("refuses-contacts", message, tasks[solver].span, help=_COLLIDES)
        suits = _SUITS.get(marching.marches) if isinstance(marching, Solver) else None
        fitting = suits is not None and (
            any(getattr(task.kind, suits[0], False) for task in models)
            or (
                # one may have been lost by an error of its own
                bool(found.errors) and not any(getattr(task.kind, suits[0], False) for task in tasks.values())
            )
        )
        if suits is not None and not fitting:
            message = f"{tasks[solver].word} marches {suits[1]}, and '{group[0]}' is none"
            found.error("no-grid" if suits[0] == "is_field" else "no-flow", message, tasks[solver].span, help=_OTHER)
        result.append(
            Island(
                models=group,
                forces=tuple((f, m) for f, targets in forces.items() for m in targets if m in group),
                contacts=tuple(
                    (c, m, others) for c, (targets, others) in contacts.items() for m in targets if m in group
                ),
                solver=solver,
                reason=reason,
            )
        )
    return tuple(result)


def _body(model: str, led: Mapping[str, str]) -> str:
    """The body of a model whose outputs drive an object, as ``stones.first``; the model itself where it is one body."""
    body = led.get("position", "").rpartition(".")[0]
    return f"{model}.{body}" if body else model


def pivots(ties: Sequence[str], tasks: Mapping[str, Task]) -> bool:
    """Whether ties leave each body only rotation about a fixed point of the world, which is integrated exactly."""
    kinds = [kind for name in ties if isinstance(kind := tasks[name].kind, Tie)]
    bodies = {(ref.name, ref.within) for kind in kinds if (ref := kind.pivot()) is not None}
    return len(bodies) == len(kinds)


def acts_on(force: Task, models: list[Task], tasks: Mapping[str, Task]) -> tuple[str, ...]:
    """The models that a force or tie acts on: those it names, else all that have masses."""
    assert isinstance(force.kind, Interaction)
    named = force.kind.targets()
    if named is not None:
        return tuple(name for name in named if not (name in tasks and isinstance(tasks[name].kind, Object)))
    return tuple(t.name for t in models if _has_mass(t.kind, force.kind.weighs))


def _has_mass(kind: Kind, weighed: bool) -> bool:
    """Whether a model has masses or, for a weight, encloses a fluid of its own."""
    return isinstance(kind, Model) and (kind.has_bodies or (weighed and kind.fluid() is not None))


def _touching(
    task: Task, tasks: Mapping[str, Task], models: list[str], found: Diagnostics
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The models that a contact acts on, and the objects that they may touch."""
    assert isinstance(task.kind, Contact)
    ties = [ref.name for ref in task.kind.ties()]
    driver = {name: t.name for t in tasks.values() if isinstance(t.kind, Model) for name in t.kind.drives()}
    for ref in task.kind.ties():
        why = None if ref.name in driver else no_collider(tasks[ref.name], tasks)
        if why is not None:
            name = ref.name if ref.span is None else ref.span.text
            names = [one.name if one.span is None else one.span.text for one in task.kind.ties()]
            told = ", ".join(dict.fromkeys("floor" if one == name else one for one in names))
            help = instead("collider", name) and f"what masses touch is the `floor`: write `between: [{told}]`"
            help = help or f"name under `between` what may touch, without '{name}'"
            found.error("no-collider", f"'{name}': {why}", ref.span, help=help)
        elif ref.name in models and not _collides(tasks[ref.name], task.kind):
            text = f"{task.word} acts on masses, and there are none in {ref.name}"
            found.error("no-mass", text, ref.span, help=f"name under `between` what may touch, without '{ref.name}'")
    ties = list(dict.fromkeys(driver.get(name, name) for name in ties))
    targets = [name for name in ties if name in models]
    surfaces = [name for name in ties if isinstance(tasks[name].kind, Object)]
    if not targets:
        targets = [n for n in models if _collides(tasks[n], task.kind)]
    if (not surfaces and len(targets) < 2) or not ties:
        return tuple(targets), touchable(tasks, found)
    return tuple(targets), tuple(surfaces)


def _collides(model: Task, contact: Contact) -> bool:
    """Whether a model has masses, or a skin that touches others."""
    return isinstance(model.kind, Model) and (model.kind.has_bodies or (model.kind.carried and not contact.mutual))


def _solver(group: tuple[str, ...], tasks: Mapping[str, Task], found: Diagnostics) -> tuple[str, str]:
    solvers = [t for t in tasks.values() if isinstance(t.kind, Solver)]
    named = [
        t for t in solvers if isinstance(t.kind, Solver) and t.kind.on and {r.name for r in t.kind.on} & set(group)
    ]
    default = [t for t in solvers if isinstance(t.kind, Solver) and t.kind.on is None]
    for candidates, reason in ((named, "named for {}"), (default, "the script's default solver")):
        if len(candidates) > 1:
            found.error(
                "two-solvers",
                f"'{candidates[0].name}' and '{candidates[1].name}' both march {', '.join(group)}",
                candidates[1].span,
                notes=[Note("the other is here", candidates[0].span)] if candidates[0].span else [],
                help="models that are tied are solved together, by one solver; give each its own with `on: [models]`",
            )
        if candidates:
            chosen = candidates[0]
            if chosen.span is None:
                return chosen.name, "no solver is named"
            return chosen.name, reason.format(", ".join(group))
    raise LookupError("the default solver is missing")
