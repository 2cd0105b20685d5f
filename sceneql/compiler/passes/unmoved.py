"""Check of objects whose shape or place at the start a model takes: what varies in time of it is lost."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import TIME
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL, Expr, Keys, Symbol, Type, each_once

HELP = "let it move or turn as a whole: by its own `position` and `rotation`"
PLACES = ("position", "rotation")
"""Fields of an object that move it as a whole."""


def report_moving(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report time-varying values of objects whose shape a model takes, and of their members; and bodies there."""
    for task in tasks.values():
        if not isinstance(task.kind, Model):
            continue
        for name, fields in task.kind.drives().items():
            _warn_of_two_movers(task, tasks[name], fields, found)
        for ref in task.kind.standing():
            for _, field, value in _varying(tasks[ref.name], tasks):
                text = f"'{task.name}' begins as '{ref.name}' is at the start, but its {field} varies in time"
                found.error("moves", text, value.span or ref.span, help="give it one place and shape")
        for ref in task.kind.shaped():
            if tasks[ref.name].original is not None:
                text = f"'{task.name}' has cells cut by '{ref.name}', but a model moves it, and fluid would stay behind"
                found.error("moves", text, ref.span, help="move it by keys or a formula of time")
                continue
            for name, field, value in _varying(tasks[ref.name], tasks):
                if name == ref.name and field in PLACES:
                    continue
                which = f"'{ref.name}'" if name == ref.name else f"'{name}' in '{ref.name}'"
                text = (
                    f"'{task.name}' has cells cut by {which} in its shape at the start, but its {field} varies in time"
                )
                found.error("moves", text, value.span or ref.span, help=HELP)


def _warn_of_two_movers(model: Task, driven: Task, fields: Iterable[str], found: Diagnostics) -> None:
    """Warn of fields of a driven object that the script lets vary with the time: only their start counts."""
    if driven.original is None:
        return
    for field in fields:
        value = getattr(driven.original, field, None)
        if isinstance(value, Value) and any(map(_timed, each_once(value.expr))):
            text = f"'{driven.name}' has a {field} that varies in time, but '{model.name}' moves it"
            text += ": only its start counts"
            help = f"to move it by keys or formulas leave '{model.name}' out; for forces to move it write one {field}"
            if (start := _start(value)) is not None:
                help += f", `{field}: {start}`"
            found.warning("moved-twice", text, value.span, help=help)


def _start(value: Value) -> str | None:
    """A place at the start as a script writes it; None where other parts tell it, or for a rotation."""
    try:
        numbers = evaluate(value.expr, {Symbol(TIME_SYMBOL, Type((), TIME)): 0.0}.__getitem__)
    except (KeyError, TypeError, ValueError):
        return None
    return " ".join(f"{0.0 + number:.6g}" for number in numbers) + " m" if len(numbers) == 3 else None


def _timed(node: Expr) -> bool:
    return isinstance(node, Keys) or (isinstance(node, Symbol) and node.name == TIME_SYMBOL)


def _varying(task: Task, tasks: Mapping[str, Task]) -> Iterator[tuple[str, str, Value]]:
    """(object, field, value) of each value that varies in time, except fields that all objects have (their look)."""
    stack, seen = [task], set[str]()
    while stack:
        one = stack.pop()
        if not isinstance(one.kind, Object) or one.name in seen:
            continue
        seen.add(one.name)
        for name, content in one.kind:
            if name not in Object.model_fields:
                yield from ((one.name, name, value) for value in values_of(content) if not value.constant)
        stack += [tasks[ref.name] for ref in reversed(one.kind.members())]
