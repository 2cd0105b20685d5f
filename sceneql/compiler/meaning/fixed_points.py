"""Warnings of equations that start where nothing changes."""

from __future__ import annotations

from typing import Any

from sceneql.compiler.meaning.facts import Facts
from sceneql.kinds import Formula, Model
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each system whose rates are all exactly 0 at its start, and later at the same state."""
    for task in facts.of(Model) if facts.whole else ():
        kind: Any = task.kind
        if not {"start", "rate", "copies"} <= type(kind).model_fields.keys() or kind.copies is not None or kind.where:
            continue
        start = {name: _number(formula, {}) for name, formula in kind.start.items()}
        end = facts.clock.end
        rates = [
            _number(one, {**start, "t": t, "time": t}) for one in kind.rate.values() for t in (0.0, 0.31 * end, end)
        ]
        moving = [name for name in start if name.endswith("'") and start[name] != 0.0]
        if None not in start.values() and rates and all(rate == 0.0 for rate in rates) and not moving:
            text = f"'{task.name}' starts where all its rates are 0: nothing changes"
            first = next(iter(kind.start))
            place = kind.start[first].span or task.span
            found.warning("nothing-moves", text, place, help=f"start beside it, as `{first}: 0.1`")


def _number(formula: Formula, known: dict[str, Any]) -> float | None:
    try:
        return float(evaluate(formula.expr, lambda node: known[node.name]))
    except (AttributeError, KeyError, TypeError, ValueError, ArithmeticError):
        return None
