"""Warnings of parts that no other uses: materials that nothing is of, motions that nothing follows."""

from __future__ import annotations

import re
from collections.abc import Mapping

from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Material, Model
from sceneql.quantities.diagnostic import Diagnostics

_WORD = re.compile(r"\w+")


def warn(facts: Facts, order: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each material and each kinematic model of the script itself that nothing needs.

    ``order``: the parts that outputs need.
    """
    if not any(facts.written(name) for name in facts.seen):
        return
    settings = facts.settings
    measured = {link.task for part in (settings.expect, settings.studies) for v in values_of(part) for link in v.links}
    users = {need for task in facts.tasks.values() for need in task.needs} | measured
    main = facts.script.sources[0].name
    variants = facts.script.root.entries.get("variants") or facts.script.base.entries.get("variants")
    varied = set() if variants is None else {*_WORD.findall(variants.span.text)}
    for task in facts.tasks.values():
        span = task.span
        if task.name in varied:
            continue  # a variant may use it
        if task.name in users or task.name in order or span is None or span.source.name != main or "." in task.name:
            continue
        if isinstance(task.kind, Material):
            one = next((name for name in facts.objects if name in facts.seen and facts.written(name)), "ball")
            text = f"nothing is of the material '{task.name}'"
            help = f"write `material: {task.name}` in what looks so, as in '{one}', or leave it out"
            found.warning("unused-part", text, span, help=help)
        elif isinstance(task.kind, Model) and task.kind.kinematic:
            outputs = [name for name in task.kind.outputs(_named(task.kind)) if name.endswith("position")]
            first = f"{task.name}.{outputs[0]}" if outputs else f"{task.name}.position"
            text = f"nothing follows '{task.name}': no part reads where it is"
            found.warning("unused-part", text, span, help=f"write `position: {first}` in the object that it moves")


def _named(kind: Model) -> dict[str, object]:
    """The fields of a model whose entries name outputs, as `outputs` reads them."""
    return {name: value for name, value in kind if isinstance(value, dict)}
