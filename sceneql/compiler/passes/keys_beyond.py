"""Warnings of keyframes beyond the clock: times in frames, where seconds are meant, and motions that are cut off."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Clock
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Expr, Keys, Number, Symbol, each_once

FEWEST = 2.0
"""Time of the second key, relative to the clock's end, from which on it is far beyond."""
FAR, SHORT = 10.0, 1.0
"""The same of a time with its unit, where the clock is at least so long [s]."""

ROUNDING = 1e-9


def warn_of_keys(tasks: Mapping[str, Task], clock: Clock, found: Diagnostics) -> None:
    """Warn of keyframes whose last time is beyond the clock's end: most likely in frames, where the second is far."""
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
                elif isinstance(node, Keys) and (last := _last(node)) > clock.end * (1.0 + ROUNDING):
                    text = f"the last of these keys is at {last:g} s, and the clock ends at {clock.end:g} s"
                    found.warning("keys-beyond", text, node.span, help=f"write `clock: {{end: {last:g} s}}`")
            known.add(id(value.expr))


def _last(keys: Keys) -> float:
    """The time of the last key [s]; 0 where it is not known, or they go round, or over something else than time."""
    time, of = keys.keys[-1].time, keys.argument
    over_time = isinstance(of, Symbol) and of.name == "time"
    return float(time.value) if over_time and keys.cycle is None and isinstance(time, Number) else 0.0


def _in_frames(time: Expr, clock: Clock) -> bool:
    if not isinstance(time, Number) or not float(time.value).is_integer():
        return False
    if time.bare:
        return bool(time.value > FEWEST * clock.end)
    return bool(clock.end >= SHORT and time.value > FAR * clock.end)
