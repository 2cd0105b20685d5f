"""A viscosity given by a formula of position, time and a field that the flow carries, evaluated in each half cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows.carried import field_in
from sceneql.flows.edges import timed
from sceneql.flows.parts import of_field
from sceneql.flows.varying import fluid_layout as own
from sceneql.grids.at_points import at_points
from sceneql.grids.cell_program import FIELD, over_cells
from sceneql.quantities.derivative import components
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import TIME_SYMBOL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.kinds import Formula, Value
    from sceneql.system import Assembly

FLAT, DEEP = "sceneql.flows.varying.flat_parts_kernels:measure", "sceneql.flows.varying.deep_parts_kernels:measure"


def measure(ints: Sequence[int], flat: bool, assembly: Assembly) -> None:
    """Add the term that computes density and viscosity of each half cell from its fluids; ``ints``: fluid_layout."""
    assembly.term("velocity", FLAT if flat else DEEP, tuple(ints))


def by_formula(formula: Formula, at: int, faces: Faces, assembly: Assembly) -> int:
    """Offset of the viscosity (halves,) [Pa s]: one block of all cells for each position of a half in its cell.

    Where it depends on a field `c`, ``thicken`` writes it later. ``at``: any index in y. Raises ScriptError for a
    viscosity that is not above 0 at the start.
    """
    halves = Halves(faces.cells.shape, faces.cells.low, faces.cells.spacing)
    values = np.ones(halves.count) if of_field(formula) else halves.at_start(formula)
    found = assembly.floats(values)
    if timed(formula.expr) and not of_field(formula):
        halves.write(formula, at, found, assembly)
    return found


def thicken(by: Value, formula: Formula, name: str, assembly: Assembly) -> None:
    """Add the terms that compute a model's viscosity from a field. Raises ScriptError for a value that is no field."""
    flow = assembly.flow_of(name)
    if flow is None:
        return  # its own assembly has failed
    grid = field_in(by, flow, name, assembly)
    halves = Halves(flow.cells.shape, flow.low, flow.spacing)
    halves.at_start(formula, assembly.start()[grid.at : grid.at + halves.cells])
    halves.write(formula, grid.at, flow.varying[own.BASE], assembly)
    measure(flow.varying, halves.flat, assembly)


class Halves:
    """Half cells of a box: each cell is divided into 4 (2D) or 8 (3D), ordered by position in the cell."""

    def __init__(self, shape: Sequence[int], low: Any, spacing: Any) -> None:
        self.shape, self.flat = (shape[0], shape[1], shape[2]), shape[2] == 1
        self.cells = int(np.prod(shape))
        self.spacing = np.array(spacing)
        self.low = np.array([*low[:2], -0.5 * self.spacing[2] if self.flat else low[2]])
        deep = (0.0,) if self.flat else (-0.25, 0.25)
        self.shifts = [np.array((a, b, c)) for c in deep for b in (-0.25, 0.25) for a in (-0.25, 0.25)]
        self.count = len(self.shifts) * self.cells

    def at_start(self, formula: Formula, field: Floats | None = None) -> Floats:
        """Values (halves,) of a formula at the start; ``field`` (cells,): its symbol `c`.

        Raises ScriptError where one is not above 0.
        """
        index = np.stack(np.meshgrid(*map(np.arange, self.shape[::-1]), indexing="ij")[::-1], axis=-1).reshape(-1, 3)
        known = {"t": 0.0, TIME_SYMBOL: 0.0, **({} if field is None else {FIELD: field})}
        places = (self.low + (index + 0.5 + shift) * self.spacing for shift in self.shifts)
        values = np.concatenate([at_points(formula, place, **known) for place in places])
        if not (values > 0.0).all():
            text = f"the viscosity is {values.min():.3g} Pa s at some places at the start"
            raise ScriptError([Diagnostic("out-of-range", text, formula.span, "let it be above 0 everywhere")])
        return values

    def write(self, formula: Formula, at: int, target: int, assembly: Assembly) -> None:
        """Add the terms that evaluate the formula at every instant; ``at``: start in y of the field `c`."""
        zeros, ones = assembly.floats(np.zeros(self.cells)), assembly.floats(np.ones(self.cells))
        for number, shift in enumerate(self.shifts):
            box = assembly.floats([*(self.low + shift * self.spacing), *self.spacing])
            arrays = (target + self.cells * number, zeros, ones)
            kernel, ints = over_cells(assembly, components(formula.expr)[0], at, arrays, self.shape, box)
            assembly.term("velocity", kernel, ints)
