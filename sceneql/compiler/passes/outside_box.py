"""Warnings of fields whose hill at the start lies outside of their box, so that next to nothing of it is inside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, log
from typing import Any

from sceneql.graph import Task
from sceneql.kinds import Formula, Model
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate

FAINT = 1e-6
"""The largest value in a box, relative to the one on top of the hill, below which nothing is seen inside."""
STEP = 1.0 / 64.0
"""Distance at which the curvature of a logarithm is taken, in parts of a side of the box."""


def warn_of_outside(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each field in a box that is exp(-(x - a)^2 ...) at the start, of a place a outside of the box."""
    for task in tasks.values():
        kind: Any = task.kind
        initial, size = getattr(kind, "initial", None), getattr(kind, "size", None)
        if not isinstance(kind, Model) or not isinstance(initial, Formula) or not size or kind.flows:
            continue
        corner = getattr(kind, "corner", None) or (0.0,) * len(size)
        top = _top(initial, corner, size)
        ends = [*zip(corner, (c + s for c, s in zip(corner, size, strict=True)), strict=True)]
        if top is None or all(low <= at <= high for at, (low, high) in zip(top, ends, strict=True)):
            continue
        nearest = [min(max(at, low), high) for at, (low, high) in zip(top, ends, strict=True)]
        inside, outside = _value(initial, nearest), _value(initial, top)
        if inside is None or outside is None or not 0.0 <= inside < FAINT * outside:
            continue
        text = f"'{task.name}' is at most {inside:.2g} in its box at the start, and {outside:.3g}"
        text += f" at {', '.join(f'{at:.3g}' for at in top)} outside"
        told = ", ".join(f"{axis} from {low:g} to {high:g}" for axis, (low, high) in zip("xyz", ends, strict=False))
        help = f"places in formulas are in meters, here {told}: put its middle there"
        found.warning("outside-box", text, initial.span or task.span, help=help)


def _top(initial: Formula, corner: Sequence[float], size: Sequence[float]) -> tuple[float, ...] | None:
    """Where the formula is largest if its logarithm is of second order along each axis; None where it is not known."""
    middle = [c + s / 2 for c, s in zip(corner, size, strict=True)]
    top = list(middle)
    for k, side in enumerate(size):
        step, logs = STEP * side, []
        for m in (-1, 0, 1):
            value = _value(initial, [at + (m * step if j == k else 0.0) for j, at in enumerate(middle)])
            if value is None or value <= 0.0:
                return None
            logs.append(log(value))
        bend = logs[0] - 2 * logs[1] + logs[2]
        if bend < 0.0:
            top[k] -= step * (logs[2] - logs[0]) / (2 * bend)
    return tuple(top) if all(map(isfinite, top)) else None


def _value(initial: Formula, place: Sequence[float]) -> float | None:
    """The formula at a place; None where it reads more than the place, or is no number."""
    known = {"x": 0.0, "y": 0.0, "z": 0.0, "t": 0.0, **dict(zip("xyz", place, strict=False))}

    def look_up(node: Any) -> float:
        return known[node.name]

    try:
        return float(evaluate(initial.expr, look_up))
    except (AttributeError, KeyError, TypeError, ValueError, ArithmeticError):
        return None
