"""Volume, center and inertia of objects of density 1, with estimates of their errors."""

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
"""Cells along the longest side of an object whose moments are integrated by its field."""
SAFE = 2.0
"""Estimated error relative to the difference of the results with two cell sizes."""
DOUBT = 0.01
"""Volume of unresolved cells, relative to the object's, above which it counts as an error. Less is mostly empty, as
where fields touch 0."""
BROKEN = 1e-9
"""Largest relative excess of the largest principal moment over the sum of the others: rounding in a script."""


class Errors(NamedTuple):
    """Estimated absolute errors; zero where the values are exact except for rounding."""

    volume: float
    """[m^3]"""
    center: float
    """Distance [m]."""
    inertia: float
    """Frobenius norm of the error of the inertia tensor [m^5]."""


@dataclass(frozen=True, slots=True, eq=False)
class MassProperties:
    """Mass properties of a solid of density 1: multiply volume and inertia by a density [kg/m^3]."""

    volume: float
    """[m^3]"""
    center: Floats
    """(3,) [m], in the coordinates that the object stands in."""
    inertia: Floats
    """(3, 3) [m^5] inertia tensor about the center, in the axes of these coordinates."""
    error: Errors

    @property
    def exact(self) -> bool:
        """Whether they are exact except for rounding."""
        return not any(self.error)


def properties(solid: Shaped, moment: Moment, cells: int = CELLS) -> MassProperties:
    """Mass properties of an object at a moment, in the coordinates of its parent, or of the world without one.

    Exact where the object has moments in closed form (``Object.volume_moments``), else integrated by its field with
    ``cells`` cells along the longest side. Raises TypeError for an object without an inside or an unbounded one,
    ValueError for an empty one, for a mesh that is open or inside out, and for too many cells.
    """
    return of_moments(moments_of(solid, moment, cells))


def of_moments(moments: VolumeMoments) -> MassProperties:
    """Mass properties from second moments. Raises ValueError for a volume that is not positive."""
    import numpy as np

    if not (moments.volume > 0.0 and np.isfinite(moments.second).all()):
        raise ValueError(f"it has no volume: {moments.volume:g} m^3")
    inertia = np.trace(moments.second) * np.eye(3) - moments.second
    volume, center, second = moments.error
    # |tr C| <= sqrt(3) |C| in the Frobenius norm, so the norm of tr(C) 1 - C is at most twice that of C.
    return MassProperties(moments.volume, moments.center, inertia, Errors(volume, center, 2.0 * second))


def moments_of(solid: Shaped, moment: Moment, cells: int = CELLS) -> VolumeMoments:
    """Volume, center and second moments of an object in its parent's coordinates; raises as ``properties``."""
    exact = solid.volume_moments(moment, lambda member: moments_of(member, moment, cells))
    return by_field(solid, moment, cells) if exact is None else exact


def by_field(solid: Shaped, moment: Moment, cells: int = CELLS) -> VolumeMoments:
    """As ``moments_of``, integrated by the field, with ``cells`` and with half as many cells for an error estimate.

    The largest relative difference of the two results, times SAFE, is the relative error of volume, center and second
    moments alike: along edges errors are erratic, so a single difference may be small by chance.
    """
    import numpy as np

    from sceneql.shapes.placement import Placed, affine
    from sceneql.shapes.solid import field_in_box

    # In its own axes, with which its sides may be aligned; the result then depends on its pose by rounding only.
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
"""Cache of moments by field in an object's own axes, so that equal bodies in different poses are integrated once."""


def _in_cells(tape: Tape, low: Corner, high: Corner, cells: int) -> VolumeMoments:
    """Moments of the solid {tape < 0} in the box low..high, with the error estimate of ``by_field``."""
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
    if doubt > DOUBT:  # such as walls thinner than cells, which both cell sizes miss
        share = max(share, doubt)
    return VolumeMoments(fine.volume, fine.center, fine.second, (share * fine.volume, share * length, share * whole))


def principal(inertia: Floats) -> tuple[Floats, Floats]:
    """Principal moments (3,) of an inertia tensor, ascending, and its axes as columns of a rotation matrix (3, 3).

    The first two axes are directed so that their largest component is positive.
    """
    import numpy as np

    values, axes = np.linalg.eigh(0.5 * (inertia + inertia.T))
    for k in range(2):
        axes[:, k] *= np.copysign(1.0, axes[np.argmax(np.abs(axes[:, k])), k])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return values, axes


def impossible(values: Sequence[float]) -> str:
    """The message on three principal moments of inertia [kg m^2] that no body has; empty for possible ones.

    None is negative or exceeds the sum of the others: each is the integral of the sum of two of the three squares.
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
