"""A viscosity by formula, of place, time and a field that the flow carries, as numbers of its halves of cells."""

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
    """Have the coefficients of a flow be those of its fluids where these are; ``ints``: of fluid_layout."""
    assembly.term("velocity", FLAT if flat else DEEP, tuple(ints))


def by_formula(formula: Formula, at: int, faces: Faces, assembly: Assembly) -> int:
    """Offset of the viscosity by half: blocks of those at the same place in their cells, as many as cells.

    Of a field that is `c` in it `thicken` writes them. ``at``: any entry in y. Raises ScriptError where it is not above
    0 at the start.
    """
    halves = Halves(faces.cells.shape, faces.cells.low, faces.cells.spacing)
    values = np.ones(halves.count) if of_field(formula) else halves.at_start(formula)
    found = assembly.floats(values)
    if timed(formula.expr) and not of_field(formula):
        halves.write(formula, at, found, assembly)
    return found


def thicken(by: Value, formula: Formula, name: str, assembly: Assembly) -> None:
    """Have a field in the box of the flow of a model say its viscosity. Raises ScriptError where there is none."""
    flow = assembly.flow_of(name)
    if flow is None:
        return  # its own assembly has failed
    grid = field_in(by, flow, name, assembly)
    halves = Halves(flow.cells.shape, flow.low, flow.spacing)
    halves.at_start(formula, assembly.start()[grid.at : grid.at + halves.cells])
    halves.write(formula, grid.at, flow.varying[own.BASE], assembly)
    measure(flow.varying, halves.flat, assembly)


class Halves:
    """The halves of the cells of a box, those at one place in their cells after another."""

    def __init__(self, shape: Sequence[int], low: Any, spacing: Any) -> None:
        self.shape, self.flat = (shape[0], shape[1], shape[2]), shape[2] == 1
        self.cells = int(np.prod(shape))
        self.spacing = np.array(spacing)
        self.low = np.array([*low[:2], -0.5 * self.spacing[2] if self.flat else low[2]])
        deep = (0.0,) if self.flat else (-0.25, 0.25)
        self.shifts = [np.array((a, b, c)) for c in deep for b in (-0.25, 0.25) for a in (-0.25, 0.25)]
        self.count = len(self.shifts) * self.cells

    def at_start(self, formula: Formula, field: Floats | None = None) -> Floats:
        """A formula at the start (halves,), by the field (cells,) that is `c` in it. Raises ScriptError where it is not
        above 0."""
        index = np.stack(np.meshgrid(*map(np.arange, self.shape[::-1]), indexing="ij")[::-1], axis=-1).reshape(-1, 3)
        known = {"t": 0.0, TIME_SYMBOL: 0.0, **({} if field is None else {FIELD: field})}
        places = (self.low + (index + 0.5 + shift) * self.spacing for shift in self.shifts)
        values = np.concatenate([at_points(formula, place, **known) for place in places])
        if not (values > 0.0).all():
            text = f"the viscosity is {values.min():.3g} Pa s at some places at the start"
            raise ScriptError([Diagnostic("out-of-range", text, formula.span, "let it be above 0 everywhere")])
        return values

    def write(self, formula: Formula, at: int, target: int, assembly: Assembly) -> None:
        """Have it written at every instant; ``at``: the field in y that is `c` in it."""
        zeros, ones = assembly.floats(np.zeros(self.cells)), assembly.floats(np.ones(self.cells))
        for number, shift in enumerate(self.shifts):
            box = assembly.floats([*(self.low + shift * self.spacing), *self.spacing])
            arrays = (target + self.cells * number, zeros, ones)
            kernel, ints = over_cells(assembly, components(formula.expr)[0], at, arrays, self.shape, box)
            assembly.term("velocity", kernel, ints)
