"""Checks of instants against the run's end, and of operations over the run (`final`, `at`), for `expect` alone."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Expect, Output
from sceneql.language.patch import SET
from sceneql.language.script import Script
from sceneql.language.tree import Mapping as MappingNode
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Link, Symbol, each_once
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.span import Span


def momentary(expr: Expr, span: Span, found: Diagnostics) -> bool:
    """Whether an expression has a value at an instant; operations over the whole run are reported."""
    calls = [node for node in each_once(expr) if isinstance(node, Call) and OPERATIONS[node.op].series]
    for call in calls:
        message = f"'{call.op}' looks over the whole run, which `expect` alone can"
        found.error("over-time", message, call.span or span)
    return not calls


def check_instants(expect: Expect, end: float, found: Diagnostics) -> None:
    """Report the instants of ``at(x, instant)`` that are not constant or before 0; warn of those after ``end`` [s]."""
    for value in (expect.of, expect.value, expect.below):
        if value is not None:
            for call in each_once(value.expr):
                if isinstance(call, Call) and call.op == "at":
                    _check_instant(call.args[1], end, call.args[1].span or call.span or value.span, found)


def _check_instant(instant: Expr, end: float, span: Span | None, found: Diagnostics) -> None:
    if any(isinstance(node, Symbol | Link) for node in each_once(instant)):
        found.error("not-constant", "the instant of 'at' must be constant", span)
        return
    at = evaluate(instant, {})
    if not at >= 0:
        found.error("out-of-range", f"the instant of 'at' must be at least 0 s, not {at:g} s", span)
    elif at > end:  # no error: runs are cut short by --set clock.end
        found.warning("beyond-end", f"this is not measured: the run ends at {end:g} s", span)


def check_latest(script: Script, tasks: Mapping[str, Task], end: float, found: Diagnostics) -> None:
    """Report outputs of an instant after ``end`` [s], but for runs that are cut short by --set clock.end."""
    clock = script.settings.get("clock")
    ends = clock.entries.get("end") if isinstance(clock, MappingNode) else None
    if ends is not None and ends.span.source.name == SET:
        return
    entries = script.sections.get(Output.family, {})
    for task in tasks.values():
        asked = task.kind.latest() if isinstance(task.kind, Output) else None
        if asked is not None and asked[1] > end * (1 + 1e-12):
            field, instant = asked
            place = entries[task.name].place((field,)) if task.name in entries else task.span
            help = f"raise its end, `clock: {{end: {instant:g} s}}`, or take an instant before"
            found.error("beyond-end", f"the clock ends at {end:g} s, before this", place, help=help)
