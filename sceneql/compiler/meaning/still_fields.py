"""Warnings of fields on grids that stay as they are, change too slowly to be seen, or are over before it is seen."""

from __future__ import annotations

from math import inf
from typing import Any

from sceneql.compiler.meaning.box_values import box, flat, nothing, over
from sceneql.compiler.meaning.facts import Facts
from sceneql.graph import Task
from sceneql.kinds import Formula, Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Number

SEEN = 1.0
"""Part of a cell by which a wave has to run to be seen."""
GONE = 20.0
"""Decay from frame to frame, as an exponent, at which nothing is left in the second."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such field in a box."""
    if not facts.whole:
        return
    told = [one.span for one in found.found if one.code == "nothing-moves"]
    for task in facts.of(Model):
        kind: Any = task.kind
        ends = box(kind)
        if ends is None or kind.flows or "initial" not in type(kind).model_fields or task.span is None:
            continue
        initial = kind.initial
        place = getattr(initial, "span", None) or task.span
        if _fed(facts, task) or place in told or task.span in told:
            continue
        if _even(task, ends, facts.clock.end):
            level = _number(initial) or 0.0
            text = f"'{task.name}' is {level:g} everywhere at the start, and nothing comes in: it stays so"
            help = "write what it starts with, as `initial: exp(-((x - 0.5)^2 + (y - 0.5)^2)/0.01)`, or a `source`"
            found.warning("nothing-moves", text, place, help=help)
        else:
            _rates(facts, task, [high - low for low, high in ends], found)


def _number(formula: Any) -> float | None:
    if formula is None:
        return 0.0
    node = formula.expr if isinstance(formula, Formula) else None
    return float(node.value) if isinstance(node, Number) else None


def _fed(facts: Facts, task: Task) -> bool:
    """Whether masses give into a field."""
    into = [getattr(one.kind, "into", None) for one in facts.of(Interaction)]
    return any(link.task == task.name for one in into if one is not None for link in one.links)


def _even(task: Task, ends: Any, end: float) -> bool:
    """Whether a field is one number at the start, as on its boundary, and nothing changes it."""
    kind: Any = task.kind
    level = _number(kind.initial)
    if level is None or not nothing(getattr(kind, "source", None), end):
        return False
    if not nothing(getattr(kind, "velocity", None), end):
        return False
    for side in kind.boundary.values():
        given = [getattr(side, name, None) for name in ("value", "flux", "robin")]
        if given[1] is not None and not nothing(given[1], end):
            return False
        if given[2] is not None and _number(given[2].outside) != level:
            return False
        if given[0] is not None and _number(given[0]) != level:
            return False
    return True


def _rates(facts: Facts, task: Task, sides: list[float], found: Diagnostics) -> None:
    """What is too slow, or too fast, for the film."""
    kind: Any = task.kind
    longest, frame, end = max(sides), facts.frame, facts.clock.end
    speed, spread, damping = (_number(getattr(kind, name, None)) or 0.0 for name in ("speed", "coefficient", "damping"))
    source = getattr(kind, "source", None)
    slower = "`clock: {{end: {0:.2g} s, speed: {1:.2g}}}`"
    if speed > 0.0 and source is None and getattr(kind, "velocity", None) is None:
        if speed * end < SEEN * kind.cell:
            text = f"waves of '{task.name}' run {speed * end:.2g} m until {end:g} s, less than a cell: nothing moves"
            help = f"write a larger `speed`, as `speed: {longest / end:.2g} m/s`, or a longer clock"
            found.warning("nothing-moves", text, kind.speed.span or task.span, help=help)
        elif speed * frame > longest:
            text = f"waves of '{task.name}' run {speed * frame:.3g} m from frame to frame"
            text += f", and its box is {longest:g} m long"
            few = 4.0 * longest / speed
            help = f"for slow motion write {slower.format(few, few / 10.0)}, or a smaller `speed`"
            found.warning("too-fast", text, kind.speed.span or task.span, help=help)
        elif damping * frame > GONE:
            text = f"waves of '{task.name}' are gone before the second frame, by this damping"
            help = f"write a smaller one, as `damping: {2.0 / end:.2g}`"
            found.warning("too-fast", text, kind.damping.span or task.span, help=help)
    drift = getattr(kind, "drift", None)
    still = source is None and all(_still(side) for side in kind.boundary.values())
    if spread * frame > longest * longest and still and drift is None:
        text = f"'{task.name}' is even, or at its end, before the second frame: it spreads over its box in "
        text += f"{longest * longest / spread:.2g} s"
        few = longest * longest / spread
        help = f"write a smaller `coefficient`, as `coefficient: {0.1 * longest * longest / end:.2g}`, or "
        found.warning("too-fast", text, kind.coefficient.span or task.span, help=help + slower.format(few, few / 10.0))
    carried = getattr(drift, "velocity", None)
    if drift is not None and isinstance(carried, Formula) and source is None:
        least = _least(carried, sides, longest / frame)
        if least > longest / frame and _number(drift.strength) is None:
            text = f"the drift of '{task.name}' crosses its box {least * frame / longest:.2g} times from frame to frame"
            help = f"write a smaller `velocity`, of {longest / end:.2g} m/s or so"
            found.warning("too-fast", text, carried.span or task.span, help=help)


def _least(carried: Formula, sides: list[float], enough: float) -> float:
    """The least speed [m/s] of a drift at the start; 0 where it is not known, or below what is ``enough`` anywhere."""
    least = inf
    for one in over(carried, [(0.0, side) for side in sides], (0.0,)):
        least = 0.0 if one is None else min(least, sum(c * c for c in flat(one)) ** 0.5)
        if least <= enough:
            return 0.0
    return least


def _still(side: Any) -> bool:
    """Whether what a side gives does not vary in time."""
    given = [getattr(side, name, None) for name in ("value", "flux")]
    return all(one is None or one.constant for one in given)
