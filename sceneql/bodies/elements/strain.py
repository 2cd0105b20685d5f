"""An elastic solid in an island: mass matrix, term of the elastic forces, energy and stress."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.elements.element_mesh import ElementMesh, gathered
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Symbol

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.bodies.elements.laws.law import Law
    from sceneql.frame import Floats
    from sceneql.kinds import Formula
    from sceneql.system import Assembly, Bodies, ModelState, Slopes

POINTS_A_TILE = 2000
"""Integration points of a tile, a task of one thread."""


@dataclass(frozen=True, slots=True, eq=False)
class Inertia:
    """Mass matrices of a solid."""

    matrix: Any
    """(n, n) sparse [kg]: consistent (Archer 1963) for elements with nodes on edges, else the lumped one."""
    lumped: Floats
    """(n,) [kg] sums of the elements' diagonals, scaled to the elements' masses (Hinton, Rock & Zienkiewicz 1976)."""
    least: Floats
    """(e,) [kg] least eigenvalue of each element's own matrix."""

    @classmethod
    def of(cls, mesh: ElementMesh, density: Callable[[Floats], Floats]) -> Inertia:
        """The mass matrices of a mesh; ``density``: a function of material positions (k, 3) [m], in kg/m^3."""
        from scipy.sparse import coo_array, diags_array

        whole, count, nodes = mesh.mass(density), len(mesh.points), mesh.cells.shape[1]
        own = np.einsum("eaa->ea", whole)
        own = own * (whole.sum(axis=(1, 2)) / own.sum(axis=1))[:, None]
        lumped: Floats = np.bincount(mesh.cells.ravel(), own.ravel(), count).astype(np.float64)
        if not mesh.element.edges:
            return cls(diags_array(lumped).tocsr(), lumped, own.min(axis=1))
        rows, columns = np.repeat(mesh.cells, nodes, axis=1).ravel(), np.tile(mesh.cells, nodes).ravel()
        matrix = coo_array((whole.ravel(), (rows, columns)), (count, count)).tocsr()
        least: Floats = np.linalg.eigvalsh(whole)[:, 0].astype(np.float64)
        return cls(matrix, lumped, least)

    @property
    def consistent(self) -> bool:
        """Whether the matrix has entries off its diagonal."""
        return bool(self.matrix.nnz > len(self.lumped))

    @property
    def sums(self) -> Floats:
        """Row sums (n,) [kg], the masses for uniform gravity; they may be negative at corners of quadratic elements."""
        return np.asarray(self.matrix.sum(axis=1)).ravel()

    def freed(self, held: Any) -> Any:
        """The matrix of all components, (3 n, 3 n) sparse [kg]; rows and columns of held (n, 3) components are zero."""
        from scipy.sparse import csr_array, diags_array, eye_array, kron

        free = diags_array(1.0 * ~np.ravel(held))
        return csr_array(free @ kron(self.matrix, eye_array(3), format="csr") @ free)


@dataclass(frozen=True, slots=True, eq=False)
class Strain:
    """The term of a solid's elastic forces in an island."""

    mesh: ElementMesh
    ints: NDArray[int64]
    volumes: Floats
    """(e, q) [m^3] shares of volume of the integration points."""
    kept: tuple[Any, ...]
    """Kernels called by their addresses, referenced here so that they are not freed."""
    squared: float
    """Bound [1/s^2] of squared angular frequencies of small motions: the largest of a single element (Irons 1970)."""
    stiffest: int
    """The element with this largest bound."""
    inertia: Inertia
    slopes: Callable[[], Slopes]
    """Makes the Jacobian of the forces."""

    def energy(self, state: ModelState) -> float:
        """Strain energy [J]."""
        from sceneql.bodies.elements.strain_energy_kernels import energy

        return float(energy(state.t, state.y, _writable(state.floats), self.ints))

    def looked_at(self, state: ModelState) -> tuple[Floats, Floats]:
        """Deformation gradients and first Piola-Kirchhoff stresses [Pa] at integration points, each (e, q, 3, 3)."""
        from sceneql.bodies.elements.strain_energy_kernels import stresses

        found = np.zeros((*self.volumes.shape, 18))
        stresses(state.y, _writable(state.floats), self.ints, found)
        shape = (*self.volumes.shape, 3, 3)
        return found[..., :9].reshape(shape), found[..., 9:].reshape(shape)


def _writable(floats: Floats) -> Floats:
    return floats if floats.flags.writeable else floats.copy()


def add_strain(
    assembly: Assembly,
    bodies: Bodies,
    mesh: ElementMesh,
    places: Floats,
    law: Law,
    retardation: float,
    held: Any,
    inertia: Inertia,
) -> Strain:
    """Add the term of a solid's elastic forces to an island.

    ``places`` (n, 3) [m]: stress-free positions of the nodes, the mesh's moved and turned; ``held`` (n, 3) bool: held
    components of nodes; ``retardation`` [s]: time constant of viscosity, 0 for none. Raises ScriptError for parameters
    of the law out of range.
    """
    from sceneql.compiled.compile_beside import compile_beside

    compile_beside((law.kernels,))  # while those of elements are compiled here

    from sceneql.bodies.elements import strain_kernels, strain_slopes_kernels
    from sceneql.bodies.elements.laws import law_kernels
    from sceneql.compiled.kernels import address
    from sceneql.compiled.threads_kernels import threads, tile_address
    from sceneql.system import Slopes

    gradients, volumes = replace(mesh, points=places).tables()
    elements, points, nodes, _ = gradients.shape
    if mesh.element.mean or points == 1:
        material = np.repeat(mesh.at(((0.25,) * 4,)), points, axis=1)
    else:
        material = mesh.at(mesh.element.rule[0])
    flat = material.reshape(-1, 3)
    numbers = np.column_stack([law.numbers(flat), *law.moduli(flat)])
    module = import_module(law.kernels)
    kinds = (law_kernels.STRESS_FUNCTION, law_kernels.STIFFNESS_FUNCTION, law_kernels.ENERGY_FUNCTION)
    kernels = (module.stress, module.stiffness, module.energy)
    addresses = [address(one, kind) for one, kind in zip(kernels, kinds, strict=True)]
    tiles = elements * points // POINTS_A_TILE + 1
    node_tiles = bodies.count // (4 * POINTS_A_TILE) + 1
    several, count = threads()
    gather = gathered(mesh.cells, bodies.count)
    head = [
        *(bodies.position_at, bodies.velocity_at, bodies.work_at, bodies.count),
        *(elements, nodes, points, int(mesh.element.mean)),
        *(assembly.floats(gradients), assembly.floats(volumes), assembly.floats(numbers), numbers.shape[1]),
        assembly.floats([retardation]) if retardation > 0.0 else -1,
        *addresses,
        assembly.floats(np.zeros(elements * (3 * nodes + 1))),
        assembly.floats(np.zeros(tiles * strain_kernels.ROOM)),
        *(tiles, node_tiles, tile_address(strain_kernels.element_tile), tile_address(strain_kernels.node_tile)),
        *(several, count),
        strain_kernels.NODES_AT + mesh.cells.size,
        assembly.floats(places),
    ]
    ints = np.concatenate([np.array(head, dtype=np.int64), mesh.cells.ravel().astype(np.int64), gather])
    slopes_room = assembly.floats(np.zeros(tiles * strain_slopes_kernels.ROOM))

    def slopes() -> Slopes:
        at = 3 * mesh.cells.astype(np.int64)
        rows = np.repeat(at, nodes, axis=1).ravel() + bodies.velocity_at
        columns = np.tile(at, nodes).ravel()
        by = [bodies.position_at, bodies.velocity_at] if retardation > 0.0 else [bodies.position_at]
        own = [slopes_room, tiles, tile_address(strain_slopes_kernels.slopes_tile), int(law.turns), len(ints)]
        return Slopes(
            "sceneql.bodies.elements.strain_slopes_kernels:strain",
            np.tile(rows, len(by)),
            np.concatenate([columns + start for start in by]),
            np.concatenate([ints, np.ravel(held).astype(np.int64), own]),
            blocks=True,
            positive="sceneql.bodies.elements.strain_slopes_kernels:positive",
        )

    assembly.term(
        "internal",
        "sceneql.bodies.elements.strain_kernels:strain",
        ints,
        slopes,
        energy="sceneql.bodies.elements.strain_energy_kernels:energy",
        damped=retardation > 0.0,
    )
    stiffest = numbers[:, -2] + 2.0 * numbers[:, -1]
    steep = np.einsum("eqni,eqni->eq", gradients, gradients).ravel() * stiffest * volumes.ravel()
    bounds = steep.reshape(elements, points).sum(axis=1) / inertia.least
    worst = int(np.argmax(bounds))
    return Strain(mesh, ints, volumes, kernels, float(bounds[worst]), worst, inertia, slopes)


def density_of(formula: Formula | None, default: float) -> Callable[[Floats], Floats]:
    """The density as a function from material positions (k, 3) [m] to (k,) [kg/m^3].

    The function raises ScriptError where the density is not above 0.
    """

    def at(places: Floats) -> Floats:
        if formula is None:
            return np.full(len(places), default)
        known = {Symbol(axis): places[:, k] for k, axis in enumerate("xyz")}
        found = np.broadcast_to(np.asarray(evaluate(formula.expr, known, arrays=True), dtype=float), len(places))
        k = int(np.argmin(found))
        if not found[k] > 0.0 or not np.isfinite(found).all():
            message = f"density must be above 0 kg/m^3, not {found[k]:g} kg/m^3"
            raise ScriptError([Diagnostic("out-of-range", message, formula.span)])
        return found

    return at


def add_mass_damping(assembly: Assembly, bodies: Bodies, damping: float, inertia: Any) -> None:
    """Add mass-proportional damping -damping M v; ``damping`` [1/s]; ``inertia``: M, sparse (n, n) [kg]."""
    from sceneql.system import Slopes

    folder = "sceneql.bodies.elements.mass_damping_kernels"
    matrix = inertia.tocsr()
    numbers = (assembly.floats([damping]), assembly.floats(matrix.data))
    ints = (
        bodies.velocity_at,
        bodies.work_at,
        bodies.count,
        *numbers,
        *matrix.indptr.tolist(),
        *matrix.indices.tolist(),
    )

    def slopes() -> Slopes:
        found = matrix.tocoo()
        rows, columns = (bodies.velocity_at + 3 * one.astype(np.int64) for one in (found.row, found.col))
        return Slopes(f"{folder}:slopes", rows, columns, blocks=True)

    assembly.term("internal", f"{folder}:force", ints, slopes, energy=f"{folder}:potential", damped=True)
