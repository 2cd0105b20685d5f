"""Boundary conditions of a domain: the faces that each part of a script selects, and their fluxes into cells."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from sceneql.grids.at_points import at_points
from sceneql.grids.domain.cells import SIDES
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.grids.domain.cells import BoundaryFaces
    from sceneql.grids.medium import Boundary
    from sceneql.grids.medium import Part as OfField
    from sceneql.kinds import Formula
    from sceneql.quantities.span import Span

GIVEN_FLUX = -1.0


@dataclass(frozen=True, slots=True, eq=False)
class Condition:
    """A boundary condition on m faces: a flux w (outside - c) into each face's cell, or a given flux."""

    cells: NDArray[int64]
    areas: Floats
    distances: Floats
    points: Floats
    outward: Floats
    formula: Formula | None
    """The value outside, or the flux; None: 0."""
    resistance: float
    """Resistance of the boundary [s/m]: 0 for a given value (Dirichlet), inf for no exchange; or GIVEN_FLUX."""
    open: bool = False
    """Whether a drift passes freely, without diffusive flux."""

    @property
    def through(self) -> bool:
        """Whether a drift passes through the boundary."""
        return self.open or self.resistance == 0.0

    def weights(self, d: Floats) -> Floats:
        """Factors (m,) of the formula: w = A D / (D r + distance) with the cells' coefficients D (m,), A for a flux."""
        if self.resistance == GIVEN_FLUX:
            return self.areas
        if self.open:
            return np.zeros(len(self.cells))
        weights: Floats = self.areas * d / (d * self.resistance + self.distances)
        return weights


class Bounded(Protocol):
    """A discretized domain with a boundary: cells, or finite elements."""

    @property
    def boundary(self) -> BoundaryFaces:
        """The faces of its boundary."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the boundary's pieces."""

    @property
    def flat(self) -> bool:
        """Whether it has two dimensions."""

    @property
    def shape(self) -> tuple[int, int, int]:
        """Cells along the axes, of a box."""


class Part(Protocol):
    """An entry of a script's `boundary`: a part of the boundary, and where it applies."""

    @property
    def periodic(self) -> bool:
        """Whether the two sides along its axis are identified."""

    @property
    def chosen(self) -> bool:
        """Whether it is restricted by `where` or `near`."""

    @property
    def where(self) -> Formula | None:
        """A formula of the position that is above 0 where the part applies."""

    @property
    def near(self) -> tuple[float, ...] | None:
        """Center [m] of the ball in which the part applies."""

    @property
    def within(self) -> float | None:
        """Radius [m] of this ball."""

    @property
    def span(self) -> Span | None:
        """Line of the part in the script."""


Said = TypeVar("Said", bound=Part)


def conditions(
    boundary: Boundary, cells: Bounded, line: Span | None
) -> tuple[list[Condition], tuple[bool, bool, bool]]:
    """The conditions of all parts that are not closed, and which axes are periodic. Raises ScriptError as ``shares``.

    ``line``: the model's place in the script.
    """
    shared, periodic = shares(boundary, cells, line)
    found = [_condition(part, cells, mine) for part, mine in shared]
    alive = [one for one in found if len(one.cells) and (one.open or one.resistance < float("inf"))]
    return alive, periodic


def shares(
    boundary: Mapping[str, Said], cells: Bounded, line: Span | None
) -> tuple[list[tuple[Said, Any]], tuple[bool, bool, bool]]:
    """The parts with the indices (m,) of their boundary faces, and which axes are periodic.

    Raises ScriptError for unknown names, parts that overlap, and parts that cannot be periodic.
    """
    faces = cells.boundary
    taken = np.zeros(len(faces.cells), dtype=bool)
    owner = np.full(len(faces.cells), -1)
    found: list[tuple[Said, Any]] = []
    periodic = [False, False, False]
    rest = [(name, part) for name, part in boundary.items() if name == "rest"]
    named = [(name, part) for name, part in boundary.items() if name != "rest"]
    for number, (name, part) in enumerate(named + rest):
        if name not in (*cells.names, "rest") and not part.chosen:
            known = ", ".join((*cells.names, "rest"))
            text = f"the boundary has no part '{name}'"
            help = f"it has {known}; a part of it says `where`, or `near` and `within`"
            raise ScriptError([Diagnostic("unknown-boundary", text, part.span or line, help)])
        if part.periodic and name in SIDES and periodic[cells.names.index(name) // 2]:
            continue  # the opposite side has set this axis
        mine = _faces_of(name, part, cells, taken)
        both = mine & taken
        if both.any():
            other = (named + rest)[int(owner[np.flatnonzero(both)[0]])]
            text = f"the boundary's parts '{other[0]}' and '{name}' overlap on {int(both.sum())} faces"
            raise ScriptError([Diagnostic("boundary-overlap", text, part.span or other[1].span or line, HELP)])
        taken |= mine
        owner[mine] = number
        if part.periodic:
            if name not in SIDES:
                text = f"'{name}' is no side of a box, which alone can be periodic"
                raise ScriptError([Diagnostic("unknown-boundary", text, line)])
            axis = cells.names.index(name) // 2
            if cells.shape[axis] < 3:
                text = f"'{name}' can be periodic where there are 3 cells or more in its direction"
                raise ScriptError([Diagnostic("too-few-cells", text, line)])
            periodic[axis] = True
        else:
            found.append((part, np.flatnonzero(mine)))
    return found, (periodic[0], periodic[1], periodic[2])


HELP = "give each face to one part: say `where` or `near`, or name other sides"


def _faces_of(name: str, part: Part, cells: Bounded, taken: Any) -> Any:
    """Mask (faces,) of a part's boundary faces; ``taken``: those of earlier parts, which `rest` leaves out."""
    faces = cells.boundary
    mine = ~taken if name == "rest" else np.ones(len(faces.cells), dtype=bool)
    if name in cells.names:
        piece = cells.names.index(name)
        mine = faces.pieces // 2 == piece // 2 if part.periodic else faces.pieces == piece
    points = faces.points.copy()
    if cells.flat:
        points[:, 2] = 0.0
    return mine & _chosen(part, points)


def _chosen(part: Part, points: Floats) -> Any:
    """Mask (m,) of the points (m, 3) at which a part applies, by its `where` and `near`."""
    found = np.ones(len(points), dtype=bool)
    if part.where is not None:
        found &= at_points(part.where, points) > 0.0
    if part.near is not None and part.within is not None:
        away = points[:, : len(part.near)] - np.array(part.near)
        found &= np.einsum("ij,ij->i", away, away) <= part.within**2
    return found


def _condition(part: OfField, cells: Bounded, mine: Any) -> Condition:
    faces = cells.boundary
    points = faces.points[mine]
    if cells.flat:
        points[:, 2] = 0.0
    formula, resistance = part.value, 0.0
    if part.flux is not None:
        formula, resistance = part.flux, GIVEN_FLUX
    elif part.robin is not None:
        k = part.robin.coefficient
        formula, resistance = part.robin.outside, (1.0 / k if k > 0.0 else float("inf"))
    if part.open:
        resistance = float("inf")
    ways = faces.cells[mine], faces.areas[mine], faces.distances[mine]
    return Condition(*ways, points, faces.outward[mine], formula, resistance, part.open)


def held_by(boundaries: Sequence[Boundary], names: tuple[str, ...]) -> Callable[[Floats, Any], Any] | None:
    """A function of boundary points (m, 3) and their pieces (m,) that tells where a field's value is given (Dirichlet).

    None where no part gives a value.
    """
    if all(part.value is None for boundary in boundaries for part in boundary.values()):
        return None

    def held(points: Floats, pieces: Any) -> Any:
        found = np.zeros(len(points), dtype=bool)
        for boundary in boundaries:
            found |= _held(boundary, names, points, pieces)
        return found

    return held


def _held(boundary: Boundary, names: tuple[str, ...], points: Floats, pieces: Any) -> Any:
    found, taken = np.zeros(len(points), dtype=bool), np.zeros(len(points), dtype=bool)
    for name, part in sorted(boundary.items(), key=lambda item: item[0] == "rest"):
        mine = ~taken
        if name in names:
            mine &= pieces == names.index(name)
        mine &= _chosen(part, points)
        taken |= mine
        found |= mine & (part.value is not None)
    return found
