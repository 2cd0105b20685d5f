"""Warnings of films of a few frames, of pictures of nothing but the ground, and of steps longer than the film."""

from __future__ import annotations

import re
from math import ceil
from typing import Any

from sceneql.compiler.meaning.facts import Facts
from sceneql.kinds import Model, Picture, Solver
from sceneql.quantities.diagnostic import Diagnostics

FEW = 4
"""Number of frames below which a film that a `speed` or `fps` makes so short shows no motion."""
USUAL = 10.0
"""[s] Length of a film that is proposed."""
SHORT = re.compile(r"([\d.]+) ?(ms|us|µs|ns|milliseconds?)")
"""An end in a unit far below that of films."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such film, picture and step."""
    clock = facts.clock
    frames = clock.end / clock.speed * clock.fps
    films = [task for task in facts.of(Picture) if "fps" in type(task.kind).model_fields]
    settings = facts.script.settings.get("clock")
    if films and frames < FEW and (clock.speed > 1.0 or clock.fps < 1.0) and settings is not None:
        one = "`speed`" if clock.speed > 1.0 else "`fps`"
        text = f"the film has {max(1, round(frames))} frame{'s' if frames >= 1.5 else ''}, by this {one}"
        better = clock.end / USUAL
        help = f"write `speed: {better:.2g}` for {USUAL:g} s" if clock.speed > 1.0 else "write `fps: 30`"
        found.warning("few-frames", text, settings.span, help=help)
    elif films and frames < FEW and settings is not None:
        _short(facts, max(1, ceil(round(frames, 9))), found)
    moved = {name for task in facts.of(Model) for name in task.kind.drives()}  # type: ignore[attr-defined]
    for task in facts.of(Picture):
        kind: Any = task.kind
        only = kind.shown()
        if only and moved and all(getattr(facts.tasks[ref.name].kind, "grounds", False) for ref in only):
            text = f"'{task.name}' shows nothing but the ground"
            names = ", ".join([*(ref.name for ref in only), *sorted(moved)])
            found.warning("nothing-drawn", text, task.span, help=f"write `show: [{names}]`, or leave `show` out")
    for task in facts.of(Solver):
        step = getattr(task.kind, "step", None)
        if isinstance(step, float) and step > clock.end and task.span is not None:
            text = f"a step of '{task.name}' is {step:g} s, and the clock ends at {clock.end:g} s: it makes one"
            found.warning("long-step", text, task.span, help=f"write a shorter one, as `step: {clock.end / 1000:g} s`")


def _short(facts: Facts, frames: int, found: Diagnostics) -> None:
    """A film that ends after some thousandths of a second, by its end's unit, and is told to last no longer."""
    clock, node = facts.clock, facts.script.settings["clock"]
    end = getattr(node, "entries", {}).get("end")
    unit = SHORT.fullmatch(end.span.text.strip("\"' ")) if end is not None else None
    if end is None or unit is None or clock.speed != 1.0:
        return
    text = f"the film has {frames} frame{'s' * (frames > 1)}: {clock.end:g} s at {clock.fps:g} frames a second"
    help = f"write `end: {unit[1]} s`, or for {USUAL:g} s of slow motion `speed: {clock.end / USUAL:.2g}` beside it"
    found.warning("few-frames", text, end.span, help=help)
