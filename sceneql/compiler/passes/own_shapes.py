"""Objects that bodies drive: each body but the first of a shape has a copy, and what has no place becomes a group."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Model, Object, Ref, Value
from sceneql.quantities.diagnostic import Diagnostics


def own_shapes(tasks: Mapping[str, Task], catalogue: Catalogue) -> dict[str, Task]:
    """The parts, with a copy ``brick.1`` for the second body that has the shape ``brick``, and so on.

    What has no position and rotation (a tube, a blobby solid) becomes a group of its name, which the body drives and
    which holds the solid itself as ``blob.shape``.
    """
    result, taken = dict(tasks), set[str]()
    for task in tasks.values():
        if not isinstance(task.kind, Model):
            continue
        copies: list[str] = []
        drives = task.kind.drives()

        def own(ref: Ref, copies: list[str] = copies, drives: Mapping[str, Mapping[str, str]] = drives) -> Ref:
            turns = "rotation" in drives[ref.name] and not _placed(tasks[ref.name], drives[ref.name])
            single = _single(ref, copies)
            return carried(single, copies) if turns else single

        def carried(ref: Ref, copies: list[str]) -> Ref:
            shape = result[ref.name]
            assert isinstance(shape.kind, Object)
            name = f"{ref.name}.shape"
            group: Any = catalogue.load("objects", "group")
            kind = group(children=(replace(ref, name=name),), hidden=shape.kind.hidden)
            result[name] = replace(shape, name=name)
            result[ref.name] = Task(ref.name, "group", kind, shape.span, (name,))
            copies.append(name)
            return ref

        def _single(ref: Ref, copies: list[str]) -> Ref:
            if ref.name not in taken:
                taken.add(ref.name)
                return ref
            number = 1
            while (name := f"{ref.name}.{number}") in result:
                number += 1
            result[name] = replace(tasks[ref.name], name=name)
            copies.append(name)
            return replace(ref, name=name)

        kind = task.kind.with_own_shapes(own)
        if copies:
            result[task.name] = replace(task, kind=kind, needs=(*task.needs, *copies))
    return result


def report_placeless(tasks: Mapping[str, Task], measured: Any, found: Diagnostics) -> None:
    """Report objects without a position that masses would drive, and fields that are read of those that bodies drive.

    ``tasks``: as written, without groups of these; ``measured``: what has values beside them.
    """
    groups: set[str] = set()
    for task in tasks.values():
        for name, fields in task.kind.drives().items() if isinstance(task.kind, Model) else ():
            one, ref = tasks.get(name), getattr(task.kind, "of", None)
            if one is None or _placed(one, fields):
                continue
            if "rotation" in fields:
                groups.add(name)
            if "rotation" in fields or not isinstance(ref, Ref):
                continue
            text = f"'{name}' is a {one.word}, which has no position that a particle could drive"
            mass = f", mass: {task.kind.mass:g} kg" if "mass" in task.kind.model_fields_set else ""  # type: ignore[attr-defined]
            help = f"let it be a body, which moves as a whole and turns: write `{{rigid: {{of: {name}{mass}}}}}`"
            found.error("no-position", text, ref.span, help=help)
    kinds = [measured, *(task.kind for task in tasks.values())] if groups else []
    for link in {link for value in values_of(kinds) for link in value.links if link.task in groups}:
        text = f"'{link.task}' moves as a group of its shape, whose '{link.output}' cannot be read"
        help = f"write the value under `define`, and its name for both: `define: {{{link.output}: ...}}`"
        found.error("unsupported-link", text, link.span, help=help)


def _placed(task: Task, fields: Collection[str]) -> bool:
    """Whether an object has the fields that a model drives."""
    return all(isinstance(getattr(task.kind, field, None), Value) for field in fields)
