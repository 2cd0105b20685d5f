"""Check of models carried by flows: whether there is such a flow, only one, and it can carry them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sceneql.graph import Task
from sceneql.kinds import Force, Model, Tie
from sceneql.quantities.diagnostic import Diagnostics, Note


def report_carried(
    models: Iterable[Task], forces: Mapping[str, Sequence[str]], tasks: Mapping[str, Task], found: Diagnostics
) -> None:
    """Report skins without a flow, models with two, models that no flow can carry, and ties on carried models.

    ``forces``: the models that each force and tie acts on.
    """
    carriers: dict[str, list[Task]] = {}
    for name, targets in forces.items():
        kind = tasks[name].kind
        flow = kind.carrier() if isinstance(kind, Force) else None
        if flow is None:
            continue
        if not getattr(tasks[flow.name].kind, "flows", False):
            found.error("no-flow", f"'{flow.name}' is no flow", flow.span, help="name a model `flow`")
        places = {ref.name: ref.span for ref in getattr(kind, "on", None) or ()}
        for target in dict.fromkeys(targets):
            other = tasks[target].kind
            if isinstance(other, Model) and not other.immersible:
                text = f"'{target}' is nothing that a flow can carry: a `membrane`, `mass_spring` or `cloth` is"
                around = "let the flow go `around` an object, which may move by keys or a formula"
                help = around if other.turns or other.has_skin else None
                found.error("no-skin", text, places.get(target) or tasks[name].span, help=help)
            carriers.setdefault(target, []).append(tasks[name])
    for name, targets in forces.items():
        for target in targets if isinstance(tasks[name].kind, Tie) else ():
            if target in carriers:
                text = f"'{target}' is carried by a flow, and ties hold nothing that moves as a fluid"
                help = "hold masses by `pins`, or by springs to places"
                found.error("refuses-ties", text, tasks[name].span, help=help)
    for task in models:
        by = carriers.get(task.name, [])
        skin = isinstance(task.kind, Model) and task.kind.carried
        if skin and not by and not found.errors:  # refused forces are missing in `by`
            text = f"no flow carries '{task.name}', and by itself it does not move"
            flows = [one.name for one in tasks.values() if getattr(one.kind, "flows", False)]
            more = "" if len(flows) == 1 else " with the name of a flow"
            force = f"immersion: {{on: [{task.name}], in: {flows[0] if flows else '...'}}}"
            help = f"write `forces: [{{{force}}}]`{more}"
            found.error("not-carried", text, task.span, help=help)
        if len(by) > 1:
            notes = [Note("the other is here", by[0].span)] if by[0].span else []
            found.error("carried-twice", f"'{task.name}' is carried by two forces", by[1].span, notes=notes)
