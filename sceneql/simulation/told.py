"""How fast forces make masses swing, slow down and turn, by what scripts alone tell of these: for `check`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from sceneql.kinds import Value
from sceneql.kinds.stable_step import Oscillation, Told, oscillations
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL, Expr, Link, Symbol

On = Mapping[str, Mapping[str, Told]]
"""Masses by model and name."""
MOST = 200
"""Masses of which every one, or every pair, is looked at."""
MOVE = 1e-5
"""Differences, as a part of the larger of a coordinate and 1."""


def number(value: Value) -> Any:
    """What a constant value is; None of one that varies."""
    return value.number() if value.constant else None


def each(on: On) -> list[Told]:
    """The first of all masses that move."""
    return [one for masses in on.values() for one in masses.values() if not one.fixed][:MOST]


def slowed(coefficient: float | None, on: On, what: str, at: str) -> Iterator[Oscillation]:
    """What a drag of so much force for a speed [N s/m] makes of the lightest."""
    masses = [one.mass for one in each(on)]
    if coefficient and masses:
        yield Oscillation(0.0, coefficient / min(masses), what, (at,))


def pulled(square: Callable[[Told, Told], float], on: On, what: str, at: str) -> Iterator[Oscillation]:
    """The fastest of two masses at told places; ``square`` gives (angular frequency)^2 [1/s^2], at most 0: none."""
    placed = [one for masses in on.values() for one in masses.values() if one.position is not None][:MOST]
    squares = [square(a, b) for a, b in combinations(placed, 2) if math.dist(a.position or (), b.position or ()) > 0.0]
    if squares and max(squares) > 0.0:
        yield Oscillation(math.sqrt(max(squares)), 0.0, what, (at,))


def by_formulas(
    rows: Sequence[Expr], on: On, what: str, at: str, others: Mapping[str, float] | None = None
) -> Iterator[Oscillation]:
    """What a force [N] of three formulas makes of the masses at told places; nothing where these read other parts."""
    fastest: list[Oscillation] = []
    for one in each(on):
        if one.position is None:
            continue
        known = {**(others or {}), "m": one.mass, TIME_SYMBOL: 0.0, "time": 0.0}
        try:
            place, motion = (_derivative(rows, names, one, known) for names in (("x", "y", "z"), ("vx", "vy", "vz")))
        except (LookupError, ArithmeticError, ValueError, TypeError):
            return
        if any(map(any, motion)):
            fastest += oscillations(motion, what, (at,))
        if any(map(any, place)):
            fastest += oscillations(place, what, (at,), paired=True)
    yield from sorted((one for one in fastest if one.size > 0.0), key=lambda one: -one.size)


def _derivative(rows: Sequence[Expr], names: Sequence[str], one: Told, known: Mapping[str, float]) -> list[list[float]]:
    """(3, 3) of the acceleration by the place or the velocity, by central differences."""
    start = dict(zip(("x", "y", "z"), one.position or (), strict=True))
    start |= dict(zip(("vx", "vy", "vz"), one.velocity or (0.0, 0.0, 0.0), strict=True))

    def accelerations(name: str, move: float) -> list[float]:
        moved = {**known, **start, name: start[name] + move}

        def look_up(node: Symbol | Link) -> float:
            if isinstance(node, Link):
                raise LookupError(node)
            return moved[node.name]

        return [float(evaluate(row, look_up)) / one.mass for row in rows]

    columns = []
    for name in names:
        move = MOVE * max(1.0, abs(start[name]))
        ends = zip(accelerations(name, move), accelerations(name, -move), strict=True)
        columns.append([(above - below) / (2.0 * move) for above, below in ends])
    return [list(row) for row in zip(*columns, strict=True)]
