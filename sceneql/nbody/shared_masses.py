"""Masses of several models as one list, for forces between all masses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.nbody import layout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Bodies


def integers_of(everyone: Sequence[Bodies]) -> tuple[int, ...]:
    """Integers of all masses, which `gather` reads (layout.MASSES)."""
    numbers: list[int] = []
    total = 0
    for bodies in everyone:
        numbers += [bodies.position_at, bodies.velocity_at, bodies.count, total, bodies.mass_at]
        total += bodies.count
    return (total, len(everyone), *numbers)


def first_of(bodies: Bodies, ints: Sequence[int]) -> int:
    """Number of a model's first mass in the list; ``ints``: from `integers_of`."""
    rows = (ints[layout.ROWS + layout.MODEL * k :] for k in range(ints[layout.MODELS]))
    return next(row[layout.FIRST] for row in rows if row[layout.POSITION_AT] == bodies.position_at)
