"""Where the wheels of a gear have their axles: what two wheels turn against is the line from axle to axle."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sceneql.system import Led, Place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Mover, Tied, TieRow
    from sceneql.system.ties import Triple

HINGE = ["ball", "written", "written", "angle", "angle"]
"""Rows of a tie that leaves a body an axle."""
ONE = 1e-9
"""Part of the length of a line below which two axles are one."""
NOWHERE = (0.0, 0.0, 0.0)


def geared(ties: Sequence[Tied], assembly: Assembly) -> Sequence[Tied]:
    """The ties, those of gears about one axis with their axles.

    An axle is where a hinge holds the wheel, of several the one nearest to its center of mass, and that center where
    none does. Wheels about two axes, or about one axle, turn against the world.
    """
    if not any(row.kind == "gear" for tie in ties for row in tie.rows):
        return ties
    held: dict[tuple[int, int], list[Triple]] = {}
    for tie in ties:
        if [row.kind for row in tie.rows] == HINGE:
            for mover, place in zip(tie.movers, tie.rows[0].vectors, strict=True):
                held.setdefault(_number(mover), []).append(place)
    return [replace(tie, rows=tuple(_lined(row, tie, held, assembly) for row in tie.rows)) for tie in ties]


def _number(mover: Mover) -> tuple[int, int]:
    """Two numbers that no other mover has."""
    if isinstance(mover, Place):
        return 0, mover.ints[0]
    return (1, mover.position_at) if isinstance(mover, Led) else (2, 0)


def _pose(mover: Mover, assembly: Assembly) -> tuple[Floats, Floats]:
    """Position (3,) [m] and axes (3, 3) at the start."""
    from sceneql.shapes.placement import rotation_matrix

    if isinstance(mover, Place):
        y, at = assembly.start(), mover.ints
        return y[at[0] : at[0] + 3], rotation_matrix(y[at[4] : at[4] + 4])
    assert isinstance(mover, Led), "gear refuses the world"
    numbers = assembly.numbers()
    return numbers[mover.position_at :][:3], rotation_matrix(numbers[mover.rotation_at :][:4])


def _lined(row: TieRow, tie: Tied, held: dict[tuple[int, int], list[Triple]], assembly: Assembly) -> TieRow:
    import numpy as np

    if row.kind != "gear":
        return row

    axis, other = np.array(row.vectors[0]), np.array(row.vectors[3])
    if np.abs(np.cross(axis, other)).max() > ONE or axis @ other < 0:
        return row
    axles, ends = [], []
    for mover in tie.movers:
        position, axes = _pose(mover, assembly)
        own = axes.T @ axis
        axles.append(min(held.get(_number(mover), [NOWHERE]), key=lambda place: _away(np.array(place), own)))
        ends.append(position + axes @ np.array(axles[-1]))
    line = ends[1] - ends[0]
    length = _away(line, axis)
    if length <= ONE * (1.0 + float(np.abs(ends).max())):
        return row
    x, y, z = (float(part) for part in line)
    return replace(row, vectors=(*row.vectors[:6], *axles, (x, y, z)), constants=(*row.constants[:2], length))


def _away(place: Floats, axis: Floats) -> float:
    """How far a place is from an axis through the origin."""
    import numpy as np

    return float(np.linalg.norm(np.cross(axis, place)))
