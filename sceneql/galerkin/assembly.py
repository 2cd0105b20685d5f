"""Diffusing fields on finite elements: state, numbers and terms in the island. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.consistent import factored
from sceneql.galerkin.between import BetweenNodes
from sceneql.galerkin.element_field import ElementField
from sceneql.galerkin.meshes import mesh_of
from sceneql.galerkin.varying_terms import NONE, WITHOUT_SLOPES, VaryingTerms
from sceneql.galerkin.weak_form import Edge, WeakForm, firmness
from sceneql.grids.assembly import varies
from sceneql.grids.at_points import at_points
from sceneql.grids.domain.boundary import GIVEN_FLUX, Condition, conditions
from sceneql.grids.domain.cells import BoundaryFaces, counts
from sceneql.grids.domain.picture_mask import sampled
from sceneql.grids.medium import FieldLayout
from sceneql.kinds import Formula
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Slopes

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.galerkin.field_mesh import FieldMesh
    from sceneql.grids.assembly import Spreading
    from sceneql.grids.medium import Boundary, Medium, Picture
    from sceneql.system import Assembly

CLOSING = "sceneql.galerkin.closing_kernels"
POWERS = 60
"""Steps of power iteration for the fastest decay."""


@dataclass(frozen=True, slots=True, eq=False)
class Rim:
    """Outer sides of a mesh, from which boundary conditions choose theirs (grids.domain.boundary)."""

    boundary: BoundaryFaces
    names: tuple[str, ...]
    flat: bool
    shape: tuple[int, int, int]


def add_field(model: Medium, spreading: Spreading, boundary: Boundary, degree: int, assembly: Assembly) -> ElementField:
    """Reserve an entry of y for each unknown and one for the inflow, and add the terms of the rate.

    Raises ScriptError for a domain without a mesh, a coefficient below 0, a start that is not finite, boundary parts
    that overlap, and probes outside the domain; LimitRefused for too many elements.
    """
    mesh = mesh_of(model, degree, boundary, assembly)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    shape = counts(tuple((high - low).tolist()), model.cell / degree)
    flat = mesh.element.dimension == 2
    spacing = (high - low) / shape[: len(low)]
    corner = (*low.tolist(), -0.5 * model.depth) if flat else tuple(low.tolist())
    sides = (*spacing.tolist(), model.depth) if flat else tuple(spacing.tolist())
    layout = FieldLayout((shape[0], shape[1], shape[2]), 0, 0, corner, sides)
    between = BetweenNodes(mesh, layout)
    probed = {name: _probed(between, name, place, assembly) for name, place in model.probes.items()}
    build = _Builder(spreading, boundary, mesh, model.depth, layout.shape, assembly)
    build.add()
    return ElementField(mesh, build.at, build.form, layout, between, probed, build.fastest)


def _probed(between: BetweenNodes, name: str, place: tuple[float, ...], assembly: Assembly) -> Any:
    point = np.array([[*place, 0.0][:3]])
    if not between.beside(point).all():
        text = f"the probe '{name}' stands outside the domain"
        raise ScriptError([Diagnostic("probe-outside", text, assembly.line())])
    return between.weights(point)[0]


@dataclass
class _Builder:
    spreading: Spreading
    boundary: Boundary
    mesh: FieldMesh
    depth: float
    shape: tuple[int, int, int]
    assembly: Assembly

    def add(self) -> None:
        """Reserve the state and add all terms."""
        mesh, assembly = self.mesh, self.assembly
        self.form = WeakForm(mesh, self.depth)
        self.at = assembly.state(np.append(self._start(mesh.places), 0.0))
        self.inflow = self.at + mesh.count
        self.terms = VaryingTerms(assembly, self.at, self.inflow)
        assembly.alike(self.at, mesh.count)
        self.varying = varies(self.spreading.coefficient)
        inner = self.form.points
        d = self._coefficients(inner)
        matrix = self.form.stiffness(np.zeros(inner.shape[:2]) if self.varying else d)
        crossing, fixed, fed = np.zeros(mesh.count), np.zeros(mesh.count), 0.0
        for one in self._conditions():
            added = self._given(one)
            if added is not None:
                blocks, owners, load = added
                if blocks is not None:
                    own = self.form.gathered(blocks, owners)
                    matrix = matrix + own
                    crossing += np.asarray(own.sum(axis=0)).ravel()
                if load is not None:
                    np.add.at(fixed, mesh.unknowns[owners], load)
                    fed += float(load.sum())
        source = self.spreading.source
        if source is not None and not varies(source):
            load = (self.form.weights * self._at(source, inner)) @ self.form.functions
            np.add.at(fixed, mesh.unknowns, load)
            fed += float(load.sum())
        self._bulk(source if varies(source) else None)
        self._balance(matrix, fixed, crossing, fed)
        mass = self.form.mass()
        self._close(mass)
        assembly.capacity(self.at, mass)
        self.matrix, self.mass = matrix, mass

    def fastest(self) -> float:
        """Largest eigenvalue [1/s] of the constant matrix relative to the mass, by power iteration."""
        from scipy.sparse.linalg import splu

        matrix, solve = self.matrix, splu(self.mass.tocsc()).solve
        way = np.random.Generator(np.random.Philox(7)).standard_normal(self.mesh.count)
        rate = 0.0
        for _ in range(POWERS):
            way /= np.linalg.norm(way)
            after = solve(matrix @ way)
            rate = float(way @ (matrix @ way) / (way @ (self.mass @ way)))
            way = after if np.linalg.norm(after) > 0.0 else way
        return rate

    def _at(self, formula: Formula, points: Floats) -> Floats:
        found: Floats = at_points(formula, points.reshape(-1, 3)).reshape(points.shape[:2])
        return found

    def _start(self, places: Floats) -> Floats:
        initial = self.spreading.initial
        if initial is None:
            return np.zeros(len(places))
        if not isinstance(initial, Formula):
            return self._pictured(initial, places)
        start = at_points(initial, places)
        if not np.isfinite(start).all():
            message = "the field at the start is not finite everywhere"
            raise ScriptError([Diagnostic("not-finite", message, initial.span)])
        return start

    def _pictured(self, initial: Picture, places: Floats) -> Floats:
        low, high = (pick(self.mesh.points, axis=0)[:2] for pick in (np.min, np.max))
        try:
            light = sampled(initial.file, (places[:, :2] - low) / (high - low))
        except ValueError as error:
            raise ScriptError([Diagnostic("no-picture", str(error), self.assembly.line())]) from error
        found: Floats = initial.black + (initial.white - initial.black) * light
        return found

    def _coefficients(self, points: Floats) -> Floats:
        """Coefficients (e, q) [m^2/s] at points (e, q, 3); zeros if they depend on time or on the field.

        Raises ScriptError for a value below 0.
        """
        formula = self.spreading.coefficient
        if formula is None or self.varying:
            return np.zeros(points.shape[:2])
        d = self._at(formula, points)
        bad = np.argwhere(~(d >= 0.0))
        if len(bad):
            x, y, z = points[tuple(bad[0])]
            message = f"the coefficient must be at least 0, and is {d[tuple(bad[0])]:g} at ({x:g}, {y:g}, {z:g}) m"
            raise ScriptError([Diagnostic("out-of-range", message, formula.span)])
        return d

    def _conditions(self) -> list[Condition]:
        mesh = self.mesh
        everything = np.arange(len(mesh.faces))
        corners = np.array(mesh.element.sides)[mesh.faces[:, 1]]
        middles = np.zeros((len(everything), 3))
        middles[:, : mesh.points.shape[1]] = mesh.points[mesh.cells[mesh.faces[:, :1], corners]].mean(axis=1)
        zeros = np.zeros(len(everything))
        rim = Rim(
            BoundaryFaces(everything, zeros, zeros, middles, np.zeros_like(middles), mesh.pieces),
            mesh.names,
            mesh.element.dimension == 2,
            self.shape,
        )
        self.given, _ = conditions(self.boundary, rim, self.assembly.line())
        held = [one.cells for one in self.given if one.resistance == 0.0]
        # An element may have several sides with given values: the strength sums over all of them.
        self.firm = np.zeros(len(everything))
        if held:
            faces = np.concatenate(held)
            self.firm[faces] = firmness(self.form.edge(faces))
        return self.given

    def _given(self, one: Condition) -> tuple[Any, Any, Any] | None:
        """Matrices (f, nodes, nodes), elements (f,) and loads (f, nodes) of a condition; None if terms contain all."""
        edge = self.form.edge(one.cells)
        shapes, area = edge.functions, edge.weights[..., None]
        moving = varies(one.formula)
        if one.resistance == 0.0:
            firm = self.firm[one.cells][:, None, None]
            if self.varying:
                self._held(one, edge)
                return None
            d = self._coefficients(edge.points)[..., None]
            weights = area * d * (firm * shapes - edge.normal)
            blocks = np.einsum("fqi,fqj->fij", weights, shapes)
            blocks -= np.einsum("fqi,fqj->fij", area * d * shapes, edge.normal)
        elif one.resistance == GIVEN_FLUX:
            weights, blocks = area * shapes, None
        else:
            weights = area * shapes / one.resistance
            blocks = np.einsum("fqi,fqj->fij", weights, shapes)
        if moving:
            assert one.formula is not None
            self.terms.given(one.formula, edge.points, shapes, self.mesh.unknowns[edge.owners], weights)
            return blocks, edge.owners, None
        if one.formula is None:
            return blocks, edge.owners, None
        return blocks, edge.owners, np.einsum("fqi,fq->fi", weights, self._at(one.formula, edge.points))

    def _held(self, one: Condition, edge: Edge) -> None:
        """Add the term of given boundary values with a coefficient that varies."""
        assembly, nodes = self.assembly, self.mesh.unknowns[edge.owners]
        formula = self.spreading.coefficient
        assert formula is not None
        conducts, bend = self.terms.values(formula, edge.points, edge.functions, nodes)
        slope = NONE
        if one.formula is None:
            value = assembly.floats(np.zeros(edge.weights.size))
        elif varies(one.formula):
            value, slope = self.terms.values(one.formula, edge.points, edge.functions, nodes)
        else:
            value = assembly.floats(self._at(one.formula, edge.points).ravel())
        each = np.repeat(nodes, edge.points.shape[1], axis=0)
        firm = np.repeat(self.firm[one.cells], edge.points.shape[1])
        tables = [assembly.floats(part.ravel()) for part in (edge.functions, edge.normal, edge.weights, firm)]
        ints = (
            self.at,
            self.inflow,
            len(each),
            nodes.shape[1],
            *tables,
            conducts,
            value,
            slope,
            bend,
            *each.ravel().tolist(),
        )
        self.terms.term("held", ints, self.terms.pairs(each))

    def _bulk(self, source: Formula | None) -> None:
        """Add the term of a varying coefficient and source; with a lumped mass a source acts at the nodes alone."""
        if source is not None and self.mesh.element.degree == 1:
            nodes, weights = np.arange(self.mesh.count)[:, None], self.form.volumes[:, None, None]
            self.terms.given(source, self.mesh.places[:, None], np.ones((1, 1)), nodes, weights)
            source = None
        if source is None and not self.varying:
            return
        assembly, nodes = self.assembly, self.mesh.unknowns
        form = WeakForm(self.mesh, self.depth, self.mesh.element.coarse_rule)
        shapes = form.functions
        made = slope = conducts = bend = NONE
        if source is not None:
            made, slope = self.terms.values(source, form.points, shapes, nodes)
        slopes_at = 0
        if self.varying:
            assert self.spreading.coefficient is not None
            conducts, bend = self.terms.values(self.spreading.coefficient, form.points, shapes, nodes)
            slopes_at = assembly.floats(form.gradients().ravel())
        head = (self.at, self.inflow, *form.points.shape[:2], nodes.shape[1], self.mesh.element.dimension)
        tables = (assembly.floats(shapes.ravel()), slopes_at, assembly.floats(form.weights.ravel()))
        ints = (*head, *tables, conducts, made, slope, bend, *nodes.ravel().tolist())
        self.terms.term("bulk", ints, self.terms.pairs(nodes) if slope >= 0 or conducts >= 0 else None)

    def _balance(self, matrix: Any, fixed: Floats, crossing: Floats, fed: float) -> None:
        assembly, n = self.assembly, self.mesh.count
        matrix = matrix.tocsr()
        matrix.sort_indices()
        tables = [assembly.floats(part) for part in (matrix.data, fixed, crossing, [fed])]
        lists = np.concatenate([matrix.indptr, matrix.indices]).tolist()
        rows = np.repeat(np.arange(n), np.diff(matrix.indptr))
        places = self.at + rows, self.at + matrix.indices.astype(np.int64)
        self.terms.term("balance", (self.at, n, self.inflow, *tables, *lists), places)

    def _close(self, mass: Any) -> None:
        n, assembly = self.mesh.count, self.assembly
        if self.mesh.element.degree == 1:
            kernel, tables = "lumped", [assembly.floats(self.form.volumes)]
        else:
            *floats, plan = factored(mass, assembly)
            kernel, tables = "consistent", [*floats, *plan]
        none = np.zeros(0, dtype=np.int64)
        assembly.term("close", f"{CLOSING}:{kernel}", (self.at, n, *tables), Slopes(WITHOUT_SLOPES, none, none))
