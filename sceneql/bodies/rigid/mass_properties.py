"""Volume, center and inertia of objects for a density of 1, with what is known of their errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from sceneql.doing import doing
from sceneql.kinds import Value, VolumeMoments
from sceneql.quantities.expression import Number, Type, Vector
from sceneql.shapes.of_contents import OfContents

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape
    from sceneql.kinds import Moment, Shaped
    from sceneql.mesh.bounded import Corner

CELLS = 64
"""Cells along the longest side of an object that is measured by its field."""
SAFE = 2.0
"""Error over the difference of two runs."""
DOUBT = 0.01
"""What cells leave undecided, in parts of the volume, from which on it counts as an error; in less, as where fields
touch, there is mostly nothing."""
BROKEN = 1e-9
"""By how much of itself the largest principal value may exceed the sum of the others: rounding in a script."""


class Errors(NamedTuple):
    """Estimated errors; zero where the values are exact but for rounding."""

    volume: float
    """[m^3]"""
    center: float
    """Distance [m]."""
    inertia: float
    """In the Frobenius norm [m^5]."""


@dataclass(frozen=True, slots=True, eq=False)
class MassProperties:
    """Of a solid whose density is 1: times a density [kg/m^3], volume is mass [kg] and inertia is in kg m^2."""

    volume: float
    """[m^3]"""
    center: Floats
    """(3,) [m], in the coordinates that the object stands in."""
    inertia: Floats
    """(3, 3) about the center, along the axes of these coordinates [m^5]."""
    error: Errors

    @property
    def exact(self) -> bool:
        """Whether they were found in closed form."""
        return not any(self.error)


def properties(solid: Shaped, moment: Moment, cells: int = CELLS) -> MassProperties:
    """Of an object now, placed as it is in its parent, or in the world where it has none.

    Exact where it has moments of its own (``Object.volume_moments``), else by its field with so many cells along it.
    Raises TypeError for one without an inside or without an end, ValueError for one that is empty, for a mesh that is
    open or turned inside out, and for too many cells.
    """
    return of_moments(moments_of(solid, moment, cells))


def of_moments(moments: VolumeMoments) -> MassProperties:
    """Mass properties by second moments. Raises ValueError where there is no volume."""
    import numpy as np

    if not (moments.volume > 0.0 and np.isfinite(moments.second).all()):
        raise ValueError(f"it has no volume: {moments.volume:g} m^3")
    inertia = np.trace(moments.second) * np.eye(3) - moments.second
    volume, center, second = moments.error
    # The trace is at most sqrt(3) of the norm, so that of tr(C) 1 - C is at most twice that of C.
    return MassProperties(moments.volume, moments.center, inertia, Errors(volume, center, 2.0 * second))


def moments_of(solid: Shaped, moment: Moment, cells: int = CELLS) -> VolumeMoments:
    """Volume, center and second moments of an object in its parent's coordinates; raises as ``properties``."""
    exact = solid.volume_moments(moment, lambda member: moments_of(member, moment, cells))
    return by_field(solid, moment, cells) if exact is None else exact


def by_field(solid: Shaped, moment: Moment, cells: int = CELLS) -> VolumeMoments:
    """As ``moments_of``, by the field alone: with cells and with half as many.

    The largest relative difference of the two, times SAFE, is the error of all three: at edges errors are as by chance,
    so one alone may be small by luck.
    """
    import numpy as np

    from sceneql.shapes.placement import Placed, affine
    from sceneql.shapes.solid import field_in_box

    # In its own axes, along which its sides may lie: then its place changes nothing but rounding.
    place = np.eye(3, 4)
    if isinstance(solid, Placed):
        place = affine(moment.at(solid.position), moment.at(solid.rotation))
        solid = solid.model_copy(
            update={"position": _constant(0.0, 0.0, 0.0), "rotation": _constant(1.0, 0.0, 0.0, 0.0)}
        )
    found = field_in_box(solid, "it", np.eye(3, 4), moment, "weighed")
    if found is None:
        raise ValueError("it is empty")
    tape, low, high = found
    of = tape.code, tape.constants, tape.parts, np.array([*low, *high, cells])
    with doing("finding mass and inertia"):
        return _KNOWN.get(of, lambda: _in_cells(tape, low, high, cells)).mapped(place)


def _constant(*numbers: float) -> Value:
    return Value(Vector(tuple(map(Number, numbers)), Type((len(numbers),))))


_KNOWN: OfContents[VolumeMoments] = OfContents(64)
"""Equal bodies are measured once, wherever they are: a field in an object's own axes does not tell its place."""


def _in_cells(tape: Tape, low: Corner, high: Corner, cells: int) -> VolumeMoments:
    """Of the solid {tape < 0} in a box, with the error as of ``by_field``."""
    import numpy as np

    from sceneql.mesh.cubes.unresolved import unresolved
    from sceneql.mesh.curved_moments import curved_moments

    cell = max(np.subtract(high, low)) / cells
    fine = curved_moments(tape, low, high, cell)
    if fine is None:
        raise ValueError(f"it is empty, or smaller than cells of {cell:.3g} m")
    coarse = curved_moments(tape, low, high, 2.0 * cell)
    whole = float(np.linalg.norm(fine.second))
    length = (whole / fine.volume) ** 0.5
    share = 1.0
    if coarse is not None:
        away = np.linalg.norm(fine.center - coarse.center) / length
        turned = np.linalg.norm(fine.second - coarse.second) / whole
        share = SAFE * float(max(abs(1.0 - coarse.volume / fine.volume), away, turned))
    doubt = unresolved(tape, low, high, cell).volume / fine.volume
    if doubt > DOUBT:  # as of walls thinner than cells, which neither run sees
        share = max(share, doubt)
    return VolumeMoments(fine.volume, fine.center, fine.second, (share * fine.volume, share * length, share * whole))


def principal(inertia: Floats) -> tuple[Floats, Floats]:
    """Principal values (3,), rising, and the axes (3, 3), which are columns and right-handed, of an inertia tensor.

    Of the axes' two directions each has the one whose largest component is positive, but for the last.
    """
    import numpy as np

    values, axes = np.linalg.eigh(0.5 * (inertia + inertia.T))
    for k in range(2):
        axes[:, k] *= np.copysign(1.0, axes[np.argmax(np.abs(axes[:, k])), k])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return values, axes


def impossible(values: Sequence[float]) -> str:
    """Why no body has three principal values of inertia [kg m^2]; empty where one has.

    None is below 0, and none above the sum of the others, since each is the integral of two squares of three.
    """
    if not all(0.0 <= value < float("inf") for value in values) or not max(values) > 0.0:
        return "principal values of inertia are finite numbers above 0"
    first, second, third = sorted(float(value) for value in values)
    if third - (first + second) > BROKEN * third:
        return (
            f"no body has these principal values of inertia: the largest, {third:g}, is above the sum of the others,"
            f" {first + second:g}"
        )
    if not first > 0.0:
        return "a body with no inertia about an axis is a line: its spin about that axis has no meaning"
    return ""
