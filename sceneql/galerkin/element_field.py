"""Outputs of a field on elements. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.galerkin.between import BetweenNodes
    from sceneql.galerkin.field_mesh import FieldMesh
    from sceneql.galerkin.weak_form import WeakForm
    from sceneql.grids.medium import FieldLayout
    from sceneql.system import ModelState


@dataclass(frozen=True, slots=True, eq=False)
class ElementField:
    """Field on finite elements in an island."""

    mesh: FieldMesh
    at: int
    """Offset: y[at : at + count] are the values at the nodes, y[at + count] is the integrated inflow."""
    form: WeakForm
    """Integrals of the mesh."""
    layout: FieldLayout
    """Grid on which pictures sample the field."""
    between: BetweenNodes
    probed: Mapping[str, Any]
    """Sparse weights (1, count) of the nodes at each probe."""
    fastest: Callable[[], float]
    """Fastest decay rate [1/s] of the terms that are constant in time."""

    def values(self, state: ModelState) -> Floats:
        """Values (count,) at the nodes."""
        return state.y[self.at : self.at + self.mesh.count]

    def measure(self, what: str, state: ModelState) -> Any:
        """Output ``what``: `field` (count,), `centers` (count, 3) of nodes, or a float for others and for probes."""
        values = self.values(state)
        match what:
            case "field":
                return values
            case "centers":
                return self.mesh.places
            case "mass":
                return float(self.form.volumes @ values)
            case "inflow":
                return float(state.y[self.at + self.mesh.count])
            case "max":
                return float(values.max())
            case "min":
                return float(values.min())
            case "mean":
                return float(self.form.volumes @ values / self.form.volumes.sum())
        return float((self.probed[what] @ values)[0])

    def samples(self, state: ModelState) -> tuple[Floats, Floats, Floats]:
        """Quadrature points (k, 3) [m] of the elements, the field (k,) there, and their volumes (k,) [m^3]."""
        values = self.values(state)[self.mesh.unknowns] @ self.form.functions.T
        return self.form.points.reshape(-1, 3), values.ravel(), self.form.weights.ravel()

    def places_of(self, what: str) -> NDArray[int64] | None:
        """Indices in y of an output (kinds.Model.places); None for outputs that are computed."""
        if what == "field":
            return self.at + np.arange(self.mesh.count)
        return np.array(self.at + self.mesh.count) if what == "inflow" else None

    def remark(self, name: str) -> str:
        """Remark of a run: number of elements, their worst angles, bound of explicit steps, and range of values."""
        mesh = self.mesh
        what, between = ("triangles", "") if mesh.element.dimension == 2 else ("tetrahedra", "between faces ")
        least, largest = (float(np.degrees(angle)) for angle in mesh.worst)
        bound = 2.0 / rate if (rate := self.fastest()) > 0.0 else np.inf
        told = f"; forward steps up to {bound:.3g} s are stable" if np.isfinite(bound) else ""
        swing = "values may leave the range of the start and the boundary by the error of the elements"
        return (
            f"{len(mesh.cells):,} {what} {name} with {mesh.count:,} nodes, angles {between}from {least:.0f} to "
            f"{largest:.0f} degrees{told}; {swing}"
        )
