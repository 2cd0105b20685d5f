"""Warnings of keyframes far beyond the clock: their times are seconds, and most likely frames were meant."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Clock
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Expr, Keys, Number, each_once

FEWEST = 2.0
"""Time of the second key, relative to the clock's end, from which on it is far beyond."""
FAR, SHORT = 10.0, 1.0
"""The same of a time with its unit, where the clock is at least so long [s]."""


def warn_of_keys(tasks: Mapping[str, Task], clock: Clock, found: Diagnostics) -> None:
    """Warn of keyframes whose second time is a whole number without unit far beyond the clock's end."""
    known: set[int] = set()
    for task in tasks.values():
        for value in values_of(task.kind):
            for node in each_once(value.expr) if id(value.expr) not in known else ():
                if isinstance(node, Keys) and len(node.keys) > 1 and _in_frames(node.keys[1].time, clock):
                    second = float(node.keys[1].time.value)  # type: ignore[union-attr]
                    text = f"the second of these keys is at {second:g} s, and the clock ends at {clock.end:g} s"
                    help = f"times of keys are seconds: frame {second:g} of {clock.fps:g} a second is at"
                    help += f" `{second / clock.fps:.4g} s`"
                    if node.keys[1].time.bare:  # type: ignore[union-attr]
                        help += f"; if {second:g} s is meant write it so, `{second:g} s`"
                    else:
                        help += f"; if {second:g} s is meant write a longer clock, `clock: {{end: {second:g} s}}`"
                    found.warning("keys-beyond", text, node.span, help=help)
            known.add(id(value.expr))


def _in_frames(time: Expr, clock: Clock) -> bool:
    if not isinstance(time, Number) or not float(time.value).is_integer():
        return False
    if time.bare:
        return bool(time.value > FEWEST * clock.end)
    return bool(clock.end >= SHORT and time.value > FAR * clock.end)
