"""Check of contacts: whether they can act on their models as the script says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Model, Tie
from sceneql.quantities.diagnostic import Diagnostics, Note


def report_contacts(tasks: Mapping[str, Task], groups: Iterable[Island], found: Diagnostics) -> None:
    """Report contacts whose models lack what they require, and rigid bodies with contacts in two words."""
    for island in groups:
        acting: dict[str, list[str]] = {}
        for contact, model, _ in island.contacts:
            acting.setdefault(contact, []).append(model)
        for contact, models in acting.items():
            kind = tasks[contact].kind
            assert isinstance(kind, Contact)
            kinds = {name: one for name in models if (one := _model(tasks[name])) is not None}
            span = tasks[contact].span
            found.extend(replace(one, span=one.span or span) for one in kind.refusals(kinds))
        _report_beside_barriers(acting, tasks, found)
        alone = [name for name in acting if not getattr(tasks[name].kind, "mutual", False)]
        _report_shared({name: acting[name] for name in alone}, island, tasks, found)


def _report_beside_barriers(acting: Mapping[str, list[str]], tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report nets in a contact that lets nothing pass and in another one, which moves their masses."""
    for contact, models in acting.items():
        kind = tasks[contact].kind
        kinds = {name: one for name in models if (one := _model(tasks[name])) is not None}
        if not isinstance(kind, Contact) or not kind.keeps_apart(kinds):
            continue
        for other, more in acting.items():
            beside = tasks[other].kind
            both = {name: one for name in more if (one := _model(tasks[name])) is not None}
            nets = [name for name in more if name in kinds and not (kinds[name].has_skin or kinds[name].turns)]
            if other == contact or not nets or (isinstance(beside, Contact) and beside.keeps_apart(both)):
                continue
            text = (
                f"nothing passes '{nets[0]}' by the barrier of '{contact}', and '{other}' would move its masses past it"
            )
            help = (
                f"leave '{nets[0]}' out of '{other}': a barrier keeps it off itself, too; objects stand in '{contact}'"
            )
            found.error("invalid", text, tasks[other].span, help=help)
            break


def warn_of_nothing_hit(tasks: Mapping[str, Task], groups: Iterable[Island], found: Diagnostics) -> None:
    """Warn of contacts of masses with objects where there are none: masses pass through each other."""
    acting = [one for island in groups for one in island.contacts]
    for contact in dict.fromkeys(name for name, _, _ in acting):
        task, kind = tasks[contact], tasks[contact].kind
        models = [tasks[model].kind for name, model, _ in acting if name == contact]
        masses = [one for one in models if isinstance(one, Model) and not (one.turns or one.has_skin or one.carried)]
        if getattr(kind, "mutual", False) or any(others for name, _, others in acting if name == contact):
            continue
        if not masses or len(masses) < len(models):
            continue
        text = f"'{contact}' is of masses with objects, and there is none to collide with"
        help = "write an object, as the floor"
        if len(masses) > 1 or len(masses[0].drives()) != 1:
            value = getattr(kind, "restitution", None) if "restitution" in kind.model_fields_set else None
            kept = "" if value is None or value.span is None else f"restitution: {value.span.text}"
            word = f"{contact}: {{mutual_collision: {{{kept}}}}}" if contact != task.word else "mutual_collision"
            help = f"masses hit one another by `{word}`; for a wall or a floor write an object"
        found.warning("nothing-hit", text, task.span, help=help)


def _report_shared(
    acting: Mapping[str, list[str]], island: Island, tasks: Mapping[str, Task], found: Diagnostics
) -> None:
    """Report a contact of rigid bodies that, or whose tied bodies, have an earlier contact word.

    Contacts and ties of a body are solved as one problem. If two were solved one after the other, a body between two
    surfaces would have the forces of neither.
    """
    held = _held(island, tasks)
    before: dict[str, tuple[str, str]] = {}
    for contact, models in acting.items():
        turning = [name for name in models if (kind := _model(tasks[name])) is not None and kind.turns]
        for name in turning:
            if held[name] not in before:
                continue
            word, other = before[held[name]]
            if other == name:
                text = f"'{name}' has its contacts in '{word}', and all contacts of a rigid body are solved together"
            else:
                text = (
                    f"a tie holds '{name}' to '{other}', which has its contacts in '{word}': they are solved together"
                )
            place = tasks[word].span
            notes = [] if place is None else [Note(f"'{word}' is here", place)]
            found.error("invalid", text, tasks[contact].span, help=_as_one(tasks[word], tasks[contact]), notes=notes)
            break
        for name in turning:
            before.setdefault(held[name], (contact, name))


def _as_one(first: Task, second: Task) -> str:
    """What to write in place of two contacts of one rigid body: the first, with all that both name."""
    both = [getattr(one.kind, "between", None) for one in (first, second)]
    left_out = f"leave out '{second.name}', as a body has one law for all that it touches"
    given = {name: getattr(second.kind, name) for name in second.kind.model_fields_set if name != "between"}
    fields = [f"`{name}: {one.span.text}`" for name, one in sorted(given.items()) if getattr(one, "span", None)]
    left_out += f"; {', '.join(fields)} would stand in '{first.name}', for all" if fields else ""
    if both[0] is None:
        return f"'{first.name}' names nothing, and so is of all: {left_out}"
    if both[1] is None:
        return f"write '{first.name}' without `between`, which is of all, and {left_out}"
    names = dict.fromkeys(ref.name for refs in both for ref in refs or ())
    return f"write `between: [{', '.join(names)}]` in '{first.name}', and {left_out}"


def _held(island: Island, tasks: Mapping[str, Task]) -> dict[str, str]:
    """For each model of an island, the first of the models that ties connect it with."""
    first = {name: name for name in island.models}
    for force in dict.fromkeys(force for force, _ in island.forces):
        if isinstance(tasks[force].kind, Tie):
            ends = [first[model] for name, model in island.forces if name == force]
            first = {name: ends[0] if root in ends else root for name, root in first.items()}
    return first


def _model(task: Task) -> Model | None:
    return task.kind if isinstance(task.kind, Model) else None
