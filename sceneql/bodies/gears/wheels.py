"""What the wheels of a gear turn against: the line from axle to axle, or axes, and whether these turn themselves."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Led, Place, TieRow

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Mover, Tied
    from sceneql.system.ties import Triple

HINGE = ["ball", "written", "written", "angle", "angle"]
"""Rows of a tie that leaves a body an axle."""
ONE = 1e-9
"""Part of the length of a line below which two axles are one."""
ASLANT = 1e-2
"""Sine of the angle between two axes above which each wheel counts against the axis of the other."""
NOWHERE = (0.0, 0.0, 0.0)
DIRECTIONS = 3
"""Rows of angles of a tie that leaves no rotation."""


@dataclass(slots=True)
class _Axles:
    """The hinges of a body, and what else gives it directions of other bodies."""

    hinges: list[tuple[Triple, Triple, Mover]] = field(default_factory=list)
    """Where each is and its axis, in the body's position and axes, and its other body."""
    welds: list[Mover] = field(default_factory=list)
    """Bodies against which it does not turn."""
    ties: int = 0
    """How many ties it has that are no gears."""


def geared(ties: Sequence[Tied], assembly: Assembly) -> Sequence[Tied]:
    """The ties, those of gears with their axles, and with axes that bodies carry where these turn themselves.

    An axle is where a hinge holds the wheel, of several the one nearest to its center of mass, and that center where
    none does. Of axes that stay, wheels about two, or about one axle, turn against the world. Raises ScriptError for
    wheels about one axle that turns, and for an axis that is not that of the wheel's hinge.
    """
    if not any(row.kind == "gear" for tie in ties for row in tie.rows):
        return ties
    held: dict[tuple[int, int], _Axles] = {}
    for tie in ties:
        kinds = [row.kind for row in tie.rows]
        for mover in tie.movers if "gear" not in kinds else ():
            held.setdefault(_number(mover), _Axles()).ties += 1
        if kinds == HINGE:
            axes = _axes_of(tie, assembly)
            for mover, place, axis, other in zip(
                tie.movers, tie.rows[0].vectors, axes, reversed(tie.movers), strict=True
            ):
                held.setdefault(_number(mover), _Axles()).hinges.append((place, axis, other))
        elif kinds.count("angle") == DIRECTIONS:
            for mover, other in zip(tie.movers, reversed(tie.movers), strict=True):
                held.setdefault(_number(mover), _Axles()).welds.append(other)
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
    if mover is None:
        return np.zeros(3), np.eye(3)
    numbers = assembly.numbers()
    return numbers[mover.position_at :][:3], rotation_matrix(numbers[mover.rotation_at :][:4])


def _axes_of(tie: Tied, assembly: Assembly) -> tuple[Triple, Triple]:
    """The axis of a hinge in the axes of both its bodies."""
    (_, first), (_, second) = (_pose(mover, assembly) for mover in tie.movers)
    own = tie.rows[-1].vectors[0]
    return own, _triple(second.T @ (first @ np.array(own)))


def _turns(mover: Mover, axis: Floats, held: dict[tuple[int, int], _Axles], assembly: Assembly) -> bool:
    """Whether an axis (3,) of a body at the start may turn: hinges about it hold the body, but none on what stays."""
    seen, left, hinged = set(), [mover], False
    while left:
        one = left.pop()
        if one is None or (isinstance(one, Place) and assembly.numbers()[one.ints[3]] == 0.0):
            return False
        if _number(one) in seen:
            continue
        seen.add(_number(one))
        _, axes = _pose(one, assembly)
        mine = held.get(_number(one), _Axles())
        along = [
            other for _, own, other in mine.hinges if np.linalg.norm(np.cross(axes @ np.array(own), axis)) < ASLANT
        ]
        left += [*along, *mine.welds]
        hinged = hinged or bool(along)
    return hinged


def _lined(row: TieRow, tie: Tied, held: dict[tuple[int, int], _Axles], assembly: Assembly) -> TieRow:
    if row.kind != "gear":
        return row

    both = [np.array(row.vectors[k]) for k in (0, 3)]
    axis, other = both
    for which, mover, one in zip(("first", "second"), tie.movers, both, strict=True):
        _must_fit(which, tie, held.get(_number(mover), _Axles()), _pose(mover, assembly)[1].T @ one)
    carried = any(_turns(mover, one, held, assembly) for mover, one in zip(tie.movers, both, strict=True))
    if not carried and (np.abs(np.cross(axis, other)).max() > ONE or axis @ other < 0):
        return row
    axles, ends, poses = [], [], []
    for mover, one in zip(tie.movers, both, strict=True):
        position, axes = _pose(mover, assembly)
        own = axes.T @ one
        places = [place for place, _, _ in held.get(_number(mover), _Axles()).hinges]
        axles.append(min(places or [NOWHERE], key=lambda place: _away(np.array(place), own)))
        ends.append(position + axes @ np.array(axles[-1]))
        poses.append(axes)
    line = ends[1] - ends[0]
    lengths = [_away(line, one) for one in both]
    least = ONE * (1.0 + float(np.abs(ends).max()))
    if not carried:
        if lengths[0] <= least:
            return row
        vectors = (*row.vectors[:6], *axles, _triple(line))
        return replace(row, vectors=vectors, constants=(*row.constants[:2], lengths[0]))
    against, length = [line, line], min(lengths)
    if np.linalg.norm(np.cross(axis, other)) > ASLANT:
        against, length = both[::-1], 0.0
    elif length <= least:
        message = f"the wheels of '{tie.name}' turn about one axle, in what turns itself: their teeth do not meet"
        help_text = "let each mesh with a third wheel beside them, by a gear of its own"
        raise ScriptError([Diagnostic("one-axle", message, tie.span, help_text)])
    own = [_triple(axes.T @ one) for axes, one in zip(poses, both, strict=True)]
    seen = [_triple(axes.T @ _across(one, n)) for axes, one, n in zip(poses, against, both, strict=True)]
    return TieRow("carried", (*own, *seen, *axles), (*row.constants[:2], length))


def _must_fit(which: str, tie: Tied, mine: _Axles, axis: Floats) -> None:
    """Raise ScriptError for a wheel that one hinge alone holds, about another axis (3,), in its axes, than the gear."""
    if mine.ties == len(mine.hinges) == 1 and _away(np.array(mine.hinges[0][1]), axis) > ASLANT:
        message = f"'{tie.name}' counts turns of its {which} wheel about an axis that its hinge does not have"
        name = "axis" if which == "first" else "other_axis"
        help_text = f"give the gear the hinge's axis as its `{name}`"
        raise ScriptError([Diagnostic("other-axle", message, tie.span, help_text)])


def _triple(vector: Floats) -> Triple:
    x, y, z = (float(part) for part in vector)
    return x, y, z


def _across(vector: Floats, axis: Floats) -> Floats:
    """The direction of a vector's part across an axis (3,)."""
    part = vector - (vector @ axis) * axis
    return part / np.linalg.norm(part)


def _away(place: Floats, axis: Floats) -> float:
    """How far a place is from an axis through the origin."""
    return float(np.linalg.norm(np.cross(axis, place)))
