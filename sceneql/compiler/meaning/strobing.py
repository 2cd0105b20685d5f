"""Warnings of motions that a film shows as standing, since they come round from frame to frame."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, isclose, pi
from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Object, Picture, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL

MOST = 200
"""Largest number of values that are looked at, the first ones."""
FRAMES = 6
"""Number of frames in which such a motion is the same."""
BETWEEN = (0.19, 0.43, 0.71)
"""Places between two frames at which it is another, in parts of the time between them."""
ALIKE = 1e-6
"""Relative difference up to which two values are one."""
HALF = 0.5
"""Turns from frame to frame from which on a wheel seems to run backwards."""
PARTS = ("spin", "motor")
"""Fields of models, bodies and ties that say how fast something turns."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each formula of the time that is the same in all frames, and not between, and of turns too fast."""
    if any(getattr(task.kind, "shutter", 0.0) for task in facts.of(Picture)) or not facts.drawn:
        return
    step, slower = facts.frame, "write a smaller `speed` of the `clock`, for slow motion, or a slower motion"
    for task, value in _moving(facts):
        if _strobes(value, step):
            text = f"this is the same in each frame, every {step:.3g} s, and moves in between: it seems to stand"
            found.warning("strobes", text, value.span or task.span, help=slower)
    for task, place, rate in _turning(facts):
        turns = rate * step / (2.0 * pi)
        if turns > HALF:
            text = f"'{task.name}' turns {turns:.2g} times from frame to frame: it seems to turn at another speed"
            help = f"write `clock: {{speed: {facts.clock.speed * 0.1 / turns:.1g}}}`, for slow motion, or a slower turn"
            found.warning("strobes", text, place or task.span, help=help)


def _moving(facts: Facts) -> Iterator[tuple[Task, Value]]:
    """The values of drawn objects that vary in time by formulas alone."""
    known: set[int] = set()
    for task in facts.of(Object):
        for value in values_of(task.original or task.kind) if len(known) < MOST else ():
            if id(value.expr) not in known and not value.constant and not value.links:
                known.add(id(value.expr))
                yield task, value


def _strobes(value: Value, step: float) -> bool:
    first = _at(value, 0.0)
    if first is None or not all(_alike(first, _at(value, k * step)) for k in range(1, FRAMES)):
        return False
    return not all(_alike(first, _at(value, part * step)) for part in BETWEEN)


def _at(value: Value, time: float) -> Any:
    def look_up(node: Any) -> float:
        if node.name != TIME_SYMBOL:
            raise KeyError(node)
        return time

    try:
        return evaluate(value.expr, look_up)
    except (KeyError, TypeError, ValueError, AttributeError):
        return None


def _alike(one: Any, other: Any) -> bool:
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_alike, one, other))
    both = isinstance(one, float | int) and isinstance(other, float | int)
    return both and isclose(one, other, rel_tol=ALIKE, abs_tol=ALIKE)


def _turning(facts: Facts) -> Iterator[tuple[Task, Any, float]]:
    """Parts that turn at a given rate, the place that says so, and the rate [rad/s]."""
    for task in facts.tasks.values():
        spin = getattr(task.kind, "spin", None)
        if isinstance(spin, tuple) and task.span is not None:
            yield task, None, hypot(*spin)
        for body in (getattr(task.kind, "bodies", None) or {}).values():
            yield task, None, hypot(*(getattr(body, "spin", None) or (0.0,)))
        motor = getattr(task.kind, "motor", None)
        speed = getattr(motor, "speed", None)
        if motor is not None and isinstance(speed, Value) and "angle" in type(motor).model_fields:
            rate = constant(speed)
            if rate is not None:
                yield task, speed.span, abs(float(rate))
