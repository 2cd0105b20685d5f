"""Warnings of overlays that do not show what they should: never there, of hidden parts, or names instead of values."""

from __future__ import annotations

import re
from collections.abc import Callable

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.graph import Task
from sceneql.kinds import Object, Overlay, Picture, Ref, Text
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL

PATH = re.compile(r"(?<![\w.{])([^\W\d]\w*)((?:\.\w+)+)(?![\w}(])")
"""An output of a part, as it stands in a text."""
MOST = 600
"""Largest number of frames at which it is asked whether an overlay is there."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such overlay."""
    for task in facts.of(Overlay):
        _names(task, facts, found)
        _never(task, facts, found)
        _hidden(task, facts, found)
        y = getattr(task.kind, "y", None)
        curves = [*y.values()] if isinstance(y, dict) else [] if y is None else [y]
        if curves and all(constant(curve) is not None for curve in curves) and getattr(task.kind, "x", None) is None:
            text = f"'{task.name}' draws nothing but constants: its curves are level lines"
            help = "write an output of a part, as `fall.position.y`, or a formula of `time`"
            found.warning("level-graph", text, curves[0].span or task.span, help=help)


def _names(task: Task, facts: Facts, found: Diagnostics) -> None:
    """Outputs in a text that are not in braces."""
    text = getattr(task.kind, "text", None)
    for piece in text.pieces if isinstance(text, Text) else ():
        for match in PATH.finditer(piece) if isinstance(piece, str) else ():
            name, path = match[1], match[2][1:]
            gives = facts.models[name].outputs({}) if name in facts.models else {}
            if path in gives or (gives and path.split(".")[-1] in ("position", "velocity", "x", "y", "z")):
                told = f"'{task.name}' says `{match[0]}` itself, not what it is: values stand in braces"
                help = f"write `{{{match[0]}}}`; with two digits `{{{match[0]}:.2f}}`"
                found.warning("unread-value", told, task.span, help=help)


def _never(task: Task, facts: Facts, found: Diagnostics) -> None:
    """One that is never there, or that takes longer to come than the film lasts."""
    show, fade = getattr(task.kind, "show", None), getattr(task.kind, "fade", 0.0)
    if show is None or show.links or not facts.drawn:
        return
    end = facts.clock.end
    try:
        there = [bool(evaluate(show.expr, _time(end * k / MOST))) for k in range(MOST + 1)]
    except (KeyError, TypeError, ValueError):
        return
    if not any(there):
        text = f"'{task.name}' is never there: `show` is 0 all the time, and the clock ends at {end:g} s"
        found.warning("not-shown", text, show.span or task.span, help="write an earlier time, or a longer clock")
    elif fade * facts.clock.speed > end > 0.0:
        text = f"'{task.name}' takes {fade:g} s to come, and the film lasts {end / facts.clock.speed:g} s"
        found.warning("not-shown", text, task.span, help="write a shorter `fade`, as `fade: 0.5 s`")


def _time(now: float) -> Callable[[object], float]:
    """What a formula of the time alone reads at an instant. Raises KeyError for anything else."""

    def look_up(node: object) -> float:
        if getattr(node, "name", "") != TIME_SYMBOL:
            raise KeyError(node)
        return now

    return look_up


def _hidden(task: Task, facts: Facts, found: Diagnostics) -> None:
    """One of an object that no picture shows."""
    of = getattr(task.kind, "of", None)
    if not any(True for _ in facts.of(Picture)):
        return
    for ref in [of] if isinstance(of, Ref) else [*of] if isinstance(of, dict) else []:
        kind = facts.tasks[ref.name].kind if isinstance(ref, Ref) and ref.name in facts.tasks else None
        users = {need for one in facts.of(Object) for need in one.needs}
        if isinstance(kind, Object) and kind.hidden and ref.name not in users:
            text = f"'{task.name}' is of '{ref.name}', which is hidden"
            found.warning("not-shown", text, ref.span or task.span, help=f"leave out `hidden: yes` of '{ref.name}'")
