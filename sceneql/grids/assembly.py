"""Assembly of a diffusing field on cells: state, numbers and terms of an island."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from sceneql.grids.at_points import at_points
from sceneql.grids.cell_program import FIELD, over_cells, over_faces
from sceneql.grids.domain.boundary import GIVEN_FLUX, Condition, conditions
from sceneql.grids.flow import Flow, flow_of
from sceneql.kinds import Formula
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import TIME_SYMBOL, Expr, Link, Number, Symbol, walk
from sceneql.system import Cells, Grid, Slopes

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.drift import Drift
    from sceneql.grids.ground import Ground
    from sceneql.grids.medium import Boundary, Picture
    from sceneql.system import Assembly

KERNELS = "sceneql.grids.diffusion_kernels"
SLOPES = "sceneql.grids.diffusion_slopes_kernels:spread"
ZERO = Number(0.0)


class Spreading(Protocol):
    """A field of a model, as a script describes it."""

    @property
    def coefficient(self) -> Formula | None:
        """Diffusion coefficient D [m^2/s]; None: 0."""

    @property
    def initial(self) -> Formula | Picture | None:
        """The field at the start; None: 0."""

    @property
    def source(self) -> Formula | None:
        """Source per second and cubic meter; None: 0."""

    @property
    def made(self) -> bool:
        """Whether there are sources or sinks inside the domain."""

    @property
    def positive(self) -> bool:
        """Whether the field cannot be negative."""


def add_field(field: Spreading, boundary: Boundary, drift: Drift | None, ground: Ground, assembly: Assembly) -> Grid:
    """Reserve an entry of y per cell and one for the total inflow, and add the terms of the field's rate.

    Raises ScriptError for a coefficient below 0 and for boundary parts that overlap.
    """
    return _Builder(field, boundary, drift, ground, assembly).build()


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Arguments of the kernel `diffusion_kernels.spread` for a field at ``at`` in y, and of its Jacobian."""

    at: int
    ints: tuple[int, ...]
    """Integers of the kernel."""
    more: tuple[int, ...]
    """Integers of its Jacobian: those of the kernel, then more."""
    places: Callable[[], tuple[Any, Any]]
    """Returns rows and columns, (k,) each, of the Jacobian's entries."""
    radiating: list[Condition]
    """Open parts of the boundary."""


def spread_of(field: Spreading, boundary: Boundary, ground: Ground, assembly: Assembly) -> Spread:
    """Reserve an entry of y per cell and one for the total inflow, and the numbers of the diffusion kernel.

    The caller adds the term itself. Raises ScriptError as `add_field`.
    """
    return _Builder(field, boundary, None, ground, assembly).spread()


def varies(formula: Formula | None) -> bool:
    """Whether a formula depends on time, on the field or on other parts."""
    return formula is not None and any(
        isinstance(node, Link) or (isinstance(node, Symbol) and node.name in (TIME_SYMBOL, FIELD))
        for node in walk(formula.expr)
    )


@dataclass
class _Builder:
    field: Spreading
    boundary: Boundary
    drift: Drift | None
    ground: Ground
    assembly: Assembly

    def build(self) -> Grid:
        cells, assembly = self.ground.cells, self.assembly
        spread = self.spread()
        _, _, _, _, volumes, sink, fed, *faces, _ = spread.ints
        kernel = f"{KERNELS}:spread"
        assembly.term("close", kernel, spread.ints, lambda: Slopes(SLOPES, *spread.places(), spread.more))
        if self.drift is not None and self.drift.by is None:
            flow = flow_of(self.drift, cells, self.ties, self.given, self.periodic)
            self._drifts(self.drift, flow, self.given, self.periodic)
        return Grid(
            cells=Cells(cells.shape, self.periodic, ~self.inside, self.ground.volumes_at, self.ground.box_at),
            at=self.at,
            volumes_at=volumes,
            sink_at=sink,
            faces_at=(faces[0], faces[1], faces[2]),
            varying=self.varying or spread.more[-1] > 0,
            fed_at=-1 if self.varying or self.feeding or self.drift is not None else fed,
            carried=self.drift is not None,
            keeps=self._keeps(self.given),
        )

    def spread(self) -> Spread:
        cells, assembly = self.ground.cells, self.assembly
        nx, ny, nz = cells.shape
        n = self.count = self.ground.count
        self.cells, self.inside, self.centers = cells, self.ground.inside, self.ground.centers
        self.at = assembly.state(np.append(self._start(), 0.0))
        self.given, self.periodic = conditions(self.boundary, cells, assembly.line())
        self.conditions = [one for one in self.given if not one.open]
        ties = self.ties = [self._ties(axis, self.periodic[axis]) for axis in range(3 if nz > 1 else 2)]
        self.varying = varies(self.field.coefficient)
        if self.varying:
            faces, sink, weights, bend = self._varying_coefficient(ties)
        else:
            faces, sink, weights = self._constant_coefficient(ties)
            bend = 0
        fed, reaction = self._fed(weights)
        faces = (*faces, faces[0])[:3] if len(faces) == 2 else faces
        ties_at = tuple(self.ties_at) if bend else (0, 0, 0)
        ints = (self.at, nx, ny, nz, self.ground.divisors_at, sink, fed, *faces, self.at + n)
        more = (*ints, bend, *(*ties_at, 0)[:3], reaction)
        radiating = [one for one in self.given if one.open]
        return Spread(self.at, ints, more, lambda: self._slopes(self.periodic), radiating)

    def _keeps(self, given: list[Condition]) -> tuple[float, float]:
        """Bounds of the field by the maximum principle (Protter and Weinberger 1967, chapter 3); infinite if unknown.

        Sources and given fluxes allow any value, except that a concentration stays nonnegative.
        """
        gathered = self.drift is not None and not self.drift.incompressible
        made, positive = self.field.made or gathered, self.field.positive
        known = [self.assembly.start()[self.at : self.at + self.count][self.inside]]
        for one in given:
            if varies(one.formula):
                made, positive = True, False
                continue
            values = np.zeros(len(one.cells)) if one.formula is None else at_points(one.formula, one.points)
            if one.resistance == GIVEN_FLUX:
                made |= bool(values.any())
            else:
                known.append(values)
        values = np.concatenate(known)
        least = float(values.min(initial=math.inf))
        if made:
            return (0.0 if positive and least >= 0.0 else -math.inf), math.inf
        return least, float(values.max(initial=-math.inf))

    def _drifts(self, drift: Drift, flow: Flow, given: list[Condition], periodic: tuple[bool, ...]) -> None:
        """Add the advection by a drift, and its fluxes through the boundary."""
        from sceneql.grids.carrying import add_drift

        forth, back = self._exchange(flow.through, given), self._exchange([-out for out in flow.through], given)
        add_drift(drift, flow, self.at, self.ground, periodic, (*forth, *back), self.assembly)

    def _exchange(self, through: Sequence[Floats], given: list[Condition]) -> tuple[int, int]:
        """Offsets of arrays (cells,): amount per second that inflow brings in, and outflow [m^3/s]."""
        assembly, n = self.assembly, self.count
        leaving, coming = np.zeros(n), np.zeros(n)
        later: list[tuple[Condition, Floats]] = []
        for one, out in zip(given, through, strict=True):
            np.add.at(leaving, one.cells, np.maximum(out, 0.0))
            into = np.maximum(-out, 0.0)
            if one.formula is not None and into.any():
                if varies(one.formula):
                    later.append((one, into))
                else:
                    np.add.at(coming, one.cells, into * at_points(one.formula, one.points))
        brought = base = assembly.floats(coming)
        if later:
            brought = assembly.floats(coming)
            assembly.term("internal", f"{KERNELS}:begin", (n, base, brought), self._dummy(f"{KERNELS}:begin"))
        for one, into in later:
            self._faces_kernel(one, brought, assembly.floats(into))
        return brought, assembly.floats(leaving)

    def _start(self) -> Floats:
        initial = self.field.initial
        if initial is None:
            return np.zeros(self.count)
        if not isinstance(initial, Formula):
            return self._pictured(initial)
        start = at_points(initial, self.centers)
        start[~self.inside] = 0.0
        if not np.isfinite(start).all():
            message = "the field at the start is not finite everywhere"
            raise ScriptError([Diagnostic("not-finite", message, initial.span)])
        return start

    def _pictured(self, initial: Picture) -> Floats:
        """The field at the start from the brightness of a picture that covers the domain's bounding box."""
        from sceneql.grids.domain.picture_mask import sampled

        low, high = (corner[:2] for corner in self.cells.around)
        try:
            light = sampled(initial.file, (self.centers[:, :2] - low) / (high - low))
        except ValueError as error:
            raise ScriptError([Diagnostic("no-picture", str(error), self.assembly.line())]) from error
        return np.where(self.inside, initial.black + (initial.white - initial.black) * light, 0.0)

    def _ties(self, axis: int, periodic: bool) -> Floats:
        """Area over distance of centers [m] (cells,) of the low faces along an axis."""
        cells = self.cells
        areas = cells.areas[axis].copy()
        if periodic:
            nx, ny, nz = cells.shape
            first = np.arange(self.count).reshape(nz, ny, nx).take(0, axis=2 - axis).ravel()
            areas[first] = cells.volumes[first] / cells.spacing[axis]
        ties: Floats = areas / cells.spacing[axis]
        return ties

    def _before(self, axis: int) -> Any:
        """Number (cells,) of the cell before each along an axis, with periodic wrapping."""
        nx, ny, nz = self.cells.shape
        index = np.arange(self.count).reshape(nz, ny, nx)
        return np.roll(index, 1, axis=2 - axis).ravel()

    def _constant_coefficient(self, ties: list[Floats]) -> tuple[tuple[int, ...], int, list[Floats]]:
        """Offsets of the faces' conductances and of the boundary's sink, and the weights of the conditions.

        Conductances use the harmonic mean of both cells' coefficients.
        """
        assembly = self.assembly
        formula = self.field.coefficient
        d = np.zeros(self.count) if formula is None else at_points(formula, self.centers)
        self._must_be_positive(d)
        faces = []
        for axis, tie in enumerate(ties):
            other = d[self._before(axis)]
            total = d + other
            mean = np.where(total > 0.0, 2.0 * d * other / np.where(total > 0.0, total, 1.0), 0.0)
            faces.append(assembly.floats(tie * mean))
        sink = np.zeros(self.count)
        weights = []
        for one in self.conditions:
            weights.append(one.weights(d[one.cells]))
            if one.resistance >= 0.0:
                np.add.at(sink, one.cells, weights[-1])
        return tuple(faces), assembly.floats(sink), weights

    def _varying_coefficient(self, ties: list[Floats]) -> tuple[tuple[int, ...], int, list[Floats], int]:
        assembly, n = self.assembly, self.count
        formula = self.field.coefficient
        assert formula is not None
        start = at_points(formula, self.centers, time=0.0, c=assembly.start()[self.at : self.at + n]) if not any(
            isinstance(node, Link) for node in walk(formula.expr)) else np.zeros(n)  # fmt: skip
        self._must_be_positive(start)
        self.zeros, self.ones = assembly.floats(np.zeros(n)), assembly.floats(self.inside.astype(float))
        d = assembly.floats(np.zeros(n))
        self._cells_kernel(formula.expr, (d, self.zeros, self.ones))
        bend = 0
        slope = differentiate(components(formula.expr)[0], Symbol(FIELD))
        if slope != ZERO:
            bend = assembly.floats(np.zeros(n))
            self._cells_kernel(slope, (bend, self.zeros, self.ones))
        self.ties_at = [assembly.floats(tie) for tie in ties]
        faces = tuple(assembly.floats(np.zeros(n)) for _ in ties)
        sink = assembly.floats(np.zeros(n))
        everything = self.conditions
        m = sum(len(one.cells) for one in everything)
        owners = np.concatenate([one.cells for one in everything]) if m else np.zeros(0, dtype=np.int64)
        areas, distances, resistances = (
            assembly.floats(np.concatenate([part(one) for one in everything]) if m else [])
            for part in (
                lambda one: one.areas,
                lambda one: one.distances,
                lambda one: np.full(len(one.cells), one.resistance),
            )
        )
        fixed = [one.areas if one.resistance < 0.0 else np.zeros(len(one.cells)) for one in everything]
        self.weights_at = assembly.floats(np.concatenate(fixed) if m else [])
        third = (*faces, faces[0])[:3]
        ties_third = (*self.ties_at, self.ties_at[0])[:3]
        ints = (d, *self.cells.shape, *third, *ties_third, sink, m, areas, distances, resistances, self.weights_at)
        assembly.term("internal", f"{KERNELS}:conduct", (*ints, *owners.tolist()), self._dummy(f"{KERNELS}:conduct"))
        return faces, sink, [np.full(len(one.cells), np.nan) for one in everything], bend

    def _fed(self, weights: list[Floats]) -> tuple[int, int]:
        """Offsets of the sources of cells (cells,), boundary included, and of d(source)/dc times volume (0: none)."""
        assembly, n = self.assembly, self.count
        moving = varies(self.field.coefficient)
        fixed = np.zeros(n)
        later: list[tuple[Condition, int]] = []
        first = 0
        for one, weight in zip(self.conditions, weights, strict=True):
            if one.formula is not None and (varies(one.formula) or (moving and one.resistance >= 0.0)):
                later.append((one, self.weights_at + first if moving else assembly.floats(weight)))
            elif one.formula is not None:
                given = one.areas if moving else weight
                np.add.at(fixed, one.cells, given * at_points(one.formula, one.points))
            first += len(one.cells)
        source = self.field.source
        volumes = np.where(self.inside, self.cells.volumes, 0.0)
        if source is not None and not varies(source):
            fixed += volumes * at_points(source, self.centers)
        fed = assembly.floats(fixed)
        self.feeding = bool(later) or varies(source)
        if not self.feeding:
            return fed, 0
        base, fed = fed, assembly.floats(fixed)
        reaction = 0
        if source is not None and varies(source):
            measure = assembly.floats(volumes)
            self._cells_kernel(source.expr, (fed, base, measure))
            slope = differentiate(components(source.expr)[0], Symbol(FIELD))
            if slope != ZERO:
                reaction = assembly.floats(np.zeros(n))
                zeros = getattr(self, "zeros", None) or assembly.floats(np.zeros(n))
                self._cells_kernel(slope, (reaction, zeros, measure))
        else:
            assembly.term("internal", f"{KERNELS}:begin", (n, base, fed), self._dummy(f"{KERNELS}:begin"))
        for one, weight_at in later:
            self._faces_kernel(one, fed, weight_at)
        return fed, reaction

    def _faces_kernel(self, one: Condition, target: int, weight: int) -> None:
        assert one.formula is not None
        points = self.assembly.floats(one.points)
        kernel, ints = over_faces(self.assembly, one.formula.expr, self.at, target, weight, points, one.cells.tolist())
        self.assembly.term("internal", kernel, ints, self._dummy(kernel))

    def _cells_kernel(self, expr: Expr, arrays: tuple[int, int, int]) -> None:
        kernel, ints = over_cells(self.assembly, expr, self.at, arrays, self.cells.shape, self.ground.box_at)
        self.assembly.term("internal", kernel, ints, self._dummy(kernel))

    def _dummy(self, kernel: str) -> Slopes:
        """Slopes of a kernel that only writes floats, which later kernels' Jacobians read: one entry that stays 0."""
        return Slopes(kernel, [self.at], [self.at])

    def _slopes(self, periodic: tuple[bool, bool, bool]) -> tuple[Any, Any]:
        """Rows and columns of the entries of diffusion_slopes_kernels.spread; on the diagonal for missing neighbors."""
        own = np.arange(self.count, dtype=np.int64)
        rows, columns = [own], [own]
        nx, ny, nz = self.cells.shape
        for axis in range(3 if nz > 1 else 2):
            before = self._before(axis)
            if not periodic[axis]:
                first = own.reshape(nz, ny, nx).take(0, axis=2 - axis).ravel()
                before[first] = first
            rows += [own, before]
            columns += [before, own]
        return self.at + np.concatenate(rows), self.at + np.concatenate(columns)

    def _must_be_positive(self, d: Floats) -> None:
        bad = np.flatnonzero(self.inside & ~(d >= 0.0))
        if len(bad):
            x, y, z = self.centers[bad[0]]
            message = f"the coefficient must be at least 0, and is {d[bad[0]]:g} at ({x:g}, {y:g}, {z:g}) m"
            formula = self.field.coefficient
            raise ScriptError([Diagnostic("out-of-range", message, None if formula is None else formula.span)])
