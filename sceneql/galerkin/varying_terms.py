"""Terms of a field on elements with formulas evaluated at points for each rate. Imports numpy."""

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
"""Offset of an absent array."""


@dataclass
class VaryingTerms:
    """Builder of the varying terms of a field whose unknowns begin at y[at] and whose inflow is y[inflow]."""

    assembly: Assembly
    at: int
    inflow: int
    tables: dict[int, tuple[int, int, Floats]] = field(default_factory=dict)
    """By the id of an array of points: offsets of the points and of the field there, and the array, kept alive."""
    sampled: set[int] = field(default_factory=set)
    """Ids of the arrays of points at which the field is sampled."""

    def given(self, formula: Formula, points: Floats, shapes: Floats, nodes: Any, weights: Floats) -> None:
        """Add values or fluxes at points (e, q, 3) that act on unknowns ``nodes`` (e, k) by ``weights`` (e, q, k)."""
        assembly = self.assembly
        at, bend = self.values(formula, points, shapes, nodes)
        each = np.repeat(nodes, points.shape[1], axis=0)
        slope = bend if bend >= 0 else assembly.floats(np.zeros(len(each)))
        own = np.broadcast_to(shapes, (*points.shape[:2], nodes.shape[1]))
        tables = (assembly.floats(weights.ravel()), at, slope, assembly.floats(own.ravel()))
        ints = (self.at, self.inflow, len(each), nodes.shape[1], *tables, *each.ravel().tolist())
        self.term("given", ints, self.pairs(each) if bend >= 0 else None)

    def values(self, formula: Formula, points: Floats, shapes: Floats, nodes: Any) -> tuple[int, int]:
        """Offsets of a formula's values at points (e, q, 3) and of its derivative by the field (NONE: it is 0).

        ``shapes``: functions, (q, nodes) of all elements or (e, q, nodes); ``nodes`` (e, nodes): unknowns.
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
        """Add a kernel that writes floats for later terms and for their derivatives."""
        self.assembly.term("internal", kernel, ints, Slopes(kernel, [self.at], [self.at]))

    def term(self, kernel: str, ints: tuple[int, ...], places: tuple[Any, Any] | None) -> None:
        """Add a kernel whose derivatives are entries at ``places``, (rows, columns); None: it has none."""
        none = np.zeros(0, dtype=np.int64)
        rows, columns = (none, none) if places is None else places
        slopes = WITHOUT_SLOPES if places is None else f"{SLOPES}:{kernel}"
        self.assembly.term("force", f"{KERNELS}:{kernel}", ints, Slopes(slopes, rows, columns))

    def pairs(self, nodes: Any) -> tuple[Any, Any]:
        """Rows and columns in y of the entries of blocks (e, nodes, nodes)."""
        k = nodes.shape[1]
        return self.at + np.repeat(nodes, k, axis=1).ravel(), self.at + np.tile(nodes, (1, k)).ravel()
