"""The terms of a field on elements that vary: formulas at points, evaluated at each rate. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.grids.assembly import ZERO
from sceneql.grids.cell_program import FIELD, over_points
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.expression import Expr, Symbol, walk
from sceneql.system import Slopes

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Formula
    from sceneql.system import Assembly

KERNELS = "sceneql.galerkin.field_kernels"
SLOPES = "sceneql.galerkin.field_slopes_kernels"
WITHOUT_SLOPES = "sceneql.galerkin.closing_kernels:nothing"
NONE = -1
"""An offset of what is not there."""


@dataclass
class VaryingTerms:
    """Adds terms of a field whose unknowns begin at y[at], and whose inflow is y[inflow]."""

    assembly: Assembly
    at: int
    inflow: int
    tables: dict[int, tuple[int, int, Floats]] = field(default_factory=dict)
    """Offsets of points, and of the field at them, by the identity of the points, which are held."""
    sampled: set[int] = field(default_factory=set)
    """Those at which the field is found."""

    def given(self, formula: Formula, points: Floats, shapes: Floats, nodes: Any, weights: Floats) -> None:
        """Values or fluxes at points (e, q, 3), which act on the unknowns ``nodes`` (e, k) by ``weights`` (e, q, k)."""
        assembly = self.assembly
        at, bend = self.values(formula, points, shapes, nodes)
        each = np.repeat(nodes, points.shape[1], axis=0)
        slope = bend if bend >= 0 else assembly.floats(np.zeros(len(each)))
        own = np.broadcast_to(shapes, (*points.shape[:2], nodes.shape[1]))
        tables = (assembly.floats(weights.ravel()), at, slope, assembly.floats(own.ravel()))
        ints = (self.at, self.inflow, len(each), nodes.shape[1], *tables, *each.ravel().tolist())
        self.term("given", ints, self.pairs(each) if bend >= 0 else None)

    def values(self, formula: Formula, points: Floats, shapes: Floats, nodes: Any) -> tuple[int, int]:
        """Offsets of a formula at points (e, q, 3), evaluated at each rate, and of its derivative (-1: it is 0).

        ``shapes`` (q, nodes) of all elements or (e, q, nodes); ``nodes`` (e, nodes): their unknowns.
        """
        assembly, count = self.assembly, points.shape[0] * points.shape[1]
        key = id(points)
        if key not in self.tables:
            self.tables[key] = assembly.floats(points.ravel()), assembly.floats(np.zeros(count)), points
        places, values, _ = self.tables[key]
        reads = any(isinstance(node, Symbol) and node.name == FIELD for node in walk(formula.expr))
        if reads and key not in self.sampled:
            self.sampled.add(key)
            table = assembly.floats(shapes.ravel())
            head = (self.at, len(nodes), points.shape[1], nodes.shape[1], table, int(shapes.ndim == 2), values)
            self._writes(f"{KERNELS}:sample", (*head, *nodes.ravel().tolist()))
        found = self._formula(components(formula.expr)[0], places, values, count)
        slope = differentiate(components(formula.expr)[0], Symbol(FIELD))
        return found, self._formula(slope, places, values, count) if slope != ZERO else NONE

    def _formula(self, expr: Expr, places: int, values: int, count: int) -> int:
        target = self.assembly.floats(np.zeros(count))
        self._writes(*over_points(self.assembly, expr, values, target, count, places))
        return target

    def _writes(self, kernel: str, ints: tuple[int, ...]) -> None:
        """A kernel that writes floats for the terms after it, and for their slopes."""
        self.assembly.term("internal", kernel, ints, Slopes(kernel, [self.at], [self.at]))

    def term(self, kernel: str, ints: tuple[int, ...], places: tuple[Any, Any] | None) -> None:
        """Add a kernel, whose slopes stand at rows and columns; None: it has none."""
        none = np.zeros(0, dtype=np.int64)
        rows, columns = (none, none) if places is None else places
        slopes = WITHOUT_SLOPES if places is None else f"{SLOPES}:{kernel}"
        self.assembly.term("force", f"{KERNELS}:{kernel}", ints, Slopes(slopes, rows, columns))

    def pairs(self, nodes: Any) -> tuple[Any, Any]:
        """Rows and columns of the entries of blocks (e, nodes, nodes)."""
        k = nodes.shape[1]
        return self.at + np.repeat(nodes, k, axis=1).ravel(), self.at + np.tile(nodes, (1, k)).ravel()
