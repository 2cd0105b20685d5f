"""Warnings of maps of fields whose range, contours or height do not fit the field."""

from __future__ import annotations

import re
from typing import Any

from sceneql.compiler.meaning.box_values import box, flat, over
from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.kinds import Formula, Object, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Link

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
HIGH, FLAT = 20.0, 1e-3
"""Height over the box's longest side from which on a map is a needle, and below which it is even."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each map of a field in a box that starts by a formula and has no source."""
    for task in facts.of(Object):
        kind: Any = task.kind
        of = getattr(kind, "of", None)
        if "contours" not in type(kind).model_fields or not isinstance(of, Value) or not isinstance(of.expr, Link):
            continue
        model: Any = facts.models.get(of.expr.task)
        ends = box(model)
        initial = getattr(model, "initial", None)
        if ends is None or not isinstance(initial, Formula):
            continue
        values = list(over(initial, ends, (0.0,)))
        if None in values or not values:
            continue
        numbers = [c for one in values for c in flat(one)]
        low, high = min(numbers), max(numbers)
        longest = max(b - a for a, b in ends)
        lift = constant(kind.height)
        if lift is not None and lift and high > low:
            height = abs(float(lift)) * (high - low)
            if height > HIGH * longest or (height < FLAT * longest and kind.colors == "none"):
                told = f"'{task.name}' is lifted by {height:.2g} m, and is {longest:g} m wide"
                told += ": it is a needle" if height > longest else ": it seems even"
                number = NUMBER.match(kind.height.span.text) if kind.height.span is not None else None
                help = "leave `height` out"
                if number is not None:
                    unit = kind.height.span.text[number.end() :]
                    better = float(number[0]) * 0.2 * longest / height
                    help = f"write `height: {float(f'{better:.2g}'):g}{unit}`, or leave it out"
                found.warning("odd-height", told, kind.height.span or task.span, help=help)
        sides = [getattr(side, name, None) for side in model.boundary.values() for name in ("value", "flux", "robin")]
        kept = "coefficient" in type(model).model_fields and model.source is None and model.drift is None
        if not kept or any(not isinstance(one, Formula) for one in sides if one is not None):
            continue
        fluxes = any(getattr(side, "flux", None) is not None for side in model.boundary.values())
        both = (0.0, facts.clock.end)
        given = [c for one in sides if one is not None for v in over(one, ends, both) for c in flat(v or 0.0)]
        if fluxes or (model.boundary and not given):
            continue
        low, high = min([low, *given]), max([high, *given])
        ends_of = constant(kind.range)
        if ends_of is not None and (min(ends_of) > high or max(ends_of) < low):
            told = f"'{task.name}' has one color: its range is {min(ends_of):g} to {max(ends_of):g}"
            told += f", and the field goes from {low:.4g} to {high:.4g}"
            found.warning("odd-range", told, kind.range.span or task.span, help="leave `range` out, or write these")
        lines = constant(kind.contours)
        if lines is not None and not any(low <= c <= high for c in flat(lines)):
            told = f"'{task.name}' has no contours: the field goes from {low:.4g} to {high:.4g}"
            found.warning("odd-range", told, kind.contours.span or task.span, help="write values in between")
