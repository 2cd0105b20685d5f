"""Warnings of what happens, or is measured, after the clock has ended."""

from __future__ import annotations

from sceneql.compiler.meaning.facts import Facts
from sceneql.kinds import Interaction, Output, Picture
from sceneql.quantities.diagnostic import Diagnostics


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of blows, shots and rows of tables that the film does not come to."""
    end = facts.clock.end
    for task in facts.tasks.values():
        at = getattr(task.kind, "at", None)
        if isinstance(task.kind, Interaction) and isinstance(at, float) and at > end:
            text = f"'{task.name}' acts at {at:g} s, and the clock ends at {end:g} s"
            found.warning(
                "after-end", text, task.span, help=f"write `clock: {{end: {at + 1.0:g} s}}`, or an earlier time"
            )
        shots = (getattr(task.kind, "shots", None) or ()) if isinstance(task.kind, Picture) else ()
        for number, shot in enumerate(shots, 1):
            if shot.until is not None and shot.until >= end and number < len(shots):
                text = f"shot {number} of '{task.name}' lasts until {shot.until:g} s, and the clock ends at {end:g} s: "
                help = f"write an earlier `until`, or a longer clock, `clock: {{end: {2.0 * shot.until:g} s}}`"
                found.warning("after-end", text + "those behind it are never seen", task.span, help=help)
                break
        every = getattr(task.kind, "every", None) if isinstance(task.kind, Output) else None
        if isinstance(every, float) and every > end:
            text = f"'{task.name}' has but the row at 0 s: the next is at {every:g} s, and the clock ends at {end:g} s"
            found.warning("after-end", text, task.span, help=f"write `every: {end / 100.0:.3g} s`, or `every: frame`")
