"""The masses of several models as one: what forces between all of them lay out."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Bodies

MODEL = 5
"""Integers of one model: position_at, velocity_at, count, the number of its first mass among all, mass_at."""


def layout(everyone: Sequence[Bodies]) -> tuple[int, ...]:
    """Integers that `gather` reads: number of masses, number of models, then MODEL for each."""
    numbers: list[int] = []
    total = 0
    for bodies in everyone:
        numbers += [bodies.position_at, bodies.velocity_at, bodies.count, total, bodies.mass_at]
        total += bodies.count
    return (total, len(everyone), *numbers)


def first_of(bodies: Bodies, ints: Sequence[int]) -> int:
    """Number of a model's first mass among all, from what `layout` gave."""
    rows = (ints[2 + MODEL * k : 2 + MODEL * (k + 1)] for k in range(ints[1]))
    return next(first for position_at, _, _, first, _ in rows if position_at == bodies.position_at)
