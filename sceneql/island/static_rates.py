"""Frequencies and decay rates of masses under forces, estimated from constants of the script for `check`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from sceneql.kinds import Value
from sceneql.kinds.stable_step import Oscillation, StaticMass, oscillations
from sceneql.quantities.derivative import differentiate
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL, Expr, Link, Symbol, Type, Vector, walk

On = Mapping[str, Mapping[str, StaticMass]]
"""Known masses, by model and by name."""
MOST = 200
"""Largest number of masses that are examined one by one, or in pairs."""
MOTION = ("x", "y", "z", "vx", "vy", "vz")


def number(value: Value) -> Any:
    """The number, or nested tuple of numbers, of a constant value; None for one that varies."""
    return value.number() if value.constant else None


def each(on: On) -> list[StaticMass]:
    """The first MOST of the masses that are not fixed."""
    return [one for masses in on.values() for one in masses.values() if not one.fixed][:MOST]


def slowed(coefficient: float | None, on: On, what: str, at: str) -> Iterator[Oscillation]:
    """The decay rate of the lightest mass under linear drag, ``coefficient`` [N s/m]."""
    masses = [one.mass for one in each(on)]
    if coefficient and masses:
        yield Oscillation(0.0, coefficient / min(masses), what, (at,))


def pulled(square: Callable[[StaticMass, StaticMass], float], on: On, what: str, at: str) -> Iterator[Oscillation]:
    """The fastest oscillation of two masses at known positions; ``square``: (angular frequency)^2 [1/s^2] of a pair."""
    placed = [one for masses in on.values() for one in masses.values() if one.position is not None][:MOST]
    squares = [square(a, b) for a, b in combinations(placed, 2) if math.dist(a.position or (), b.position or ()) > 0.0]
    if squares and max(squares) > 0.0:
        yield Oscillation(math.sqrt(max(squares)), 0.0, what, (at,))


def by_formulas(
    rows: Sequence[Expr], on: On, what: str, at: str, others: Mapping[str, float] | None = None
) -> Iterator[Oscillation]:
    """The modes of masses at known positions under a force [N], given as three formulas.

    None where these read other parts.
    """
    if any(isinstance(node, Link) for row in rows for node in walk(row)):
        return
    slopes = [[differentiate(row, Symbol(name)) for name in MOTION] for row in rows]
    formulas = Vector(tuple(Vector(tuple(row), Type((6,))) for row in slopes), Type((len(rows), 6)))
    matrices: dict[tuple[tuple[float, ...], ...], None] = {}
    for one in each(on):
        if one.position is not None:
            start = zip(MOTION, (*one.position, *(one.velocity or (0.0, 0.0, 0.0))), strict=True)
            known = {**(others or {}), "m": one.mass, TIME_SYMBOL: 0.0, "time": 0.0, **dict(start)}
            found = evaluate(formulas, {Symbol(name): value for name, value in known.items()})
            matrices[tuple(tuple(told_slope(slope) / one.mass for slope in row) for row in found)] = None
    fastest: list[Oscillation] = []
    for matrix in matrices:  # equal masses share one matrix
        place, motion = ([row[part] for row in matrix] for part in (slice(3), slice(3, 6)))
        if any(map(any, motion)):
            fastest += oscillations(motion, what, (at,))
        if any(map(any, place)):
            fastest += oscillations(place, what, (at,), paired=True)
    yield from sorted((one for one in fastest if one.size > 0.0), key=lambda one: -one.size)


def told_slope(value: float) -> float:
    """A derivative at the start; 0 where it is not finite, as that of a square root at 0, which the run reports."""
    return value if math.isfinite(value) else 0.0
