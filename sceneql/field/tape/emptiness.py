"""Proofs that a box contains no point of a tape's solid {f < 0} or surface {f = 0}, for Python callers.

Imports numpy and numba: to be imported by the function that needs it.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.enclose import interval_kernels
from sceneql.field.tape import tape_kernels
from sceneql.field.tape.magnitude import lattice
from sceneql.field.tape.tape_ops import HIT, INSIDE, NOWHERE, WHOLE
from sceneql.field.tape.tape_solid import cast, field_values, scratch

if TYPE_CHECKING:
    from sceneql.frame import Tape

BOXES = 4096
"""Most boxes that a proof evaluates; beyond that the property counts as not proved."""
SHALLOW = 1e-12
"""Largest -f of a solid that counts as empty, relative to the smaller of the box's size and the median |f| in it."""
PLACES = 500
"""Random points at which bounds of rounding errors are evaluated."""
RAYS = 16
"""Rays parallel to an axis, along each of the other two axes, by which shallow solids are searched."""

Corner = tuple[float, float, float]


def proved_empty(tape: Tape, low: Corner, high: Corner) -> bool:
    """Whether f is proved to be nowhere negative, where it is defined, in the box low..high [m].

    Values down to -SHALLOW count as 0: rounding may cause them where f touches 0 from above.
    """
    slack = SHALLOW * _depth(tape, low, high)
    return _all_settled(
        tape,
        low,
        high,
        lambda least, most, status: status == NOWHERE or least >= -slack,
        _negative,
    )


def _negative(value: float, status: int) -> bool:
    """Whether the value of f at the center of a box is a counterexample to f >= 0."""
    return value < 0.0


def why_empty(tape: Tape, low: Corner, high: Corner) -> str:
    """Why the box low..high [m] shows no solid, as a clause about f; "" where nothing is proved, or a ray meets one."""
    if not proved_empty(tape, low, high):
        return ""
    if _all_settled(tape, low, high, lambda least, most, status: status == NOWHERE or least >= 0.0, _negative):
        return "nowhere negative"
    if _met(tape, low, high):
        return ""
    return f"shallower than {SHALLOW * _depth(tape, low, high):.1g} wherever it is negative"


def _met(tape: Tape, low: Corner, high: Corner) -> bool:
    """Whether one of RAYS^2 rays along each axis is found to enter the solid in the box low..high [m]."""
    first, last = np.array(low), np.array(high)
    ticks = (np.arange(RAYS) + 0.5) / RAYS
    for axis in range(3):
        places = np.stack([*np.meshgrid(ticks, ticks), np.zeros((RAYS, RAYS))], axis=-1).reshape(-1, 3)
        origins = first + np.roll(places, axis, axis=1) * (last - first)
        way = np.roll([0.0, 0.0, 1.0], axis) * (last - first)
        status, _ = cast(tape, origins, way, 0.0, 1.0)
        if ((status == HIT) | (status == INSIDE)).any():
            return True
    return False


def proved_rootless(tape: Tape, low: Corner, high: Corner) -> bool:
    """Whether f is proved to be nowhere zero in the box low..high [m]."""
    return _all_settled(
        tape,
        low,
        high,
        lambda least, most, status: status == NOWHERE or least > 0.0 or most < 0.0,
        lambda value, status: value == 0.0,
    )


def nowhere_defined(tape: Tape, low: Corner, high: Corner) -> bool:
    """Whether f is proved to be undefined in all of the box low..high [m]."""
    return _all_settled(
        tape,
        low,
        high,
        lambda least, most, status: status == NOWHERE,
        lambda value, status: status == WHOLE or value == value,
    )


def nowhere_finite(tape: Tape, low: Corner, high: Corner) -> bool:
    """Whether f is infinite or NaN at all points of a lattice in the box low..high [m]: evidence, no proof."""
    return not np.isfinite(field_values(tape, lattice(low, high))).any()


def bottomless(tape: Tape, low: tuple[float, ...], high: tuple[float, ...]) -> bool:
    """Whether f is finite at no point of a lattice in the box low..high [m], and minus infinity at some."""
    values = field_values(tape, lattice(low, high))
    return bool((values == -np.inf).any() and not np.isfinite(values).any())


def blurred(tape: Tape, low: Corner, high: Corner) -> float:
    """Share of PLACES points in the box low..high [m] at which bounds of rounding errors leave the sign of f open."""
    places = np.random.default_rng(0).uniform(low, high, (PLACES, 3)).tolist()
    program = (tape.code, tape.constants, tape.parts, scratch(tape))
    bounds = [interval_kernels.box(*program, x, x, y, y, z, z) for x, y, z in places]
    return float(np.mean([status == WHOLE and least < 0.0 < most for least, most, status in bounds]))


def _depth(tape: Tape, low: Corner, high: Corner) -> float:
    """The smaller of the size [m] of the box low..high and the median of |f| on a lattice in it."""
    values = np.abs(field_values(tape, lattice(low, high)))
    values = values[np.isfinite(values)]
    size = max(b - a for a, b in zip(low, high, strict=True))
    return min(size, float(np.median(values))) if len(values) else size


def _all_settled(
    tape: Tape,
    low: Corner,
    high: Corner,
    settled: Callable[[float, float, int], bool],
    refuted: Callable[[float, int], bool],
) -> bool:
    """Whether a property is proved in the whole box, by branch and bound (Land and Doig 1960).

    The box with the lowest bound is bisected first. ``settled`` (lower and upper bound of f in a box, status) tells
    whether the property is proved in a box, ``refuted`` (f at its center, status) whether that is a counterexample. The
    status is WHOLE, PARTIAL or NOWHERE.
    """
    program = (tape.code, tape.constants, tape.parts, scratch(tape))
    boxes: list[tuple[float, int, Corner, Corner]] = [(0.0, 0, low, high)]
    for count in range(1, BOXES, 2):
        if not boxes:
            return True
        _, _, first, last = heappop(boxes)
        sides = [b - a for a, b in zip(first, last, strict=True)]
        axis = sides.index(max(sides))
        middle = 0.5 * (first[axis] + last[axis])
        for part, (a, b) in enumerate(((first[axis], middle), (middle, last[axis]))):
            one, two = _moved(first, axis, a), _moved(last, axis, b)
            least, most, status = interval_kernels.box(
                *program, *(c for pair in zip(one, two, strict=True) for c in pair)
            )
            if settled(least, most, status):
                continue
            center = (0.5 * (c + d) for c, d in zip(one, two, strict=True))
            if refuted(tape_kernels.value(*program, *center), status):
                return False
            heappush(boxes, (least, count + part, one, two))
    return False


def _moved(corner: Corner, axis: int, place: float) -> Corner:
    x, y, z = (place if k == axis else c for k, c in enumerate(corner))
    return x, y, z
