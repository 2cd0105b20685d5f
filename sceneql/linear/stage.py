"""Linear systems of implicit stages, (1 - a J) d = r, analyzed once for an island.

Positions are eliminated: their rows are dx/dt = v, so d_x = r_x + a d_v. A system in the velocities and other entries
remains, 1 - a D - a^2 K for damping D and stiffness K. It has half the size, and is symmetric after its rows are
multiplied by the masses. Entries on which no rate depends, and fixed masses, are left out too.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from sceneql.failure import LimitRefused
from sceneql.island import layout
from sceneql.linear.species import one_grid

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.linear.elimination import Kinds, Left

SMALL = 96
"""Largest number of unknowns for which a dense factorization is as fast as a sparse one."""
MOST_GROUPS = 100_000
MOST_OPERATIONS = 2e10
"""Multiplications of a factorization above which iterations are faster."""
SOLID = 16
"""Mean number of neighbors of a mass above which a net counts as a solid, whose factors fill in."""
SOLID_GROUPS = 3000
KEPT = 100
"""Multiplications of a factorization over the numbers in its factors from which on these are kept."""
TILE = 40_000
"""Number of matrix values that a thread assembles at a time; fewer are not worth threads."""


@dataclass(frozen=True, slots=True, eq=False)
class StagePlan:
    """Arrays of an island for the kernels of stage_kernels.py."""

    numbers: NDArray[int64]
    """Integers in the layout of stage_kernels; the kernels change some (pivots, symmetry)."""
    scales: Floats
    """(unknowns,): factor of each row; then Inertia.numbers."""
    store: int
    """Number of floats for the matrix, its factors and scratch."""
    text: str
    """Description of the solver, for `explain`."""


def stage_plan(system: System, exact: bool = False, signs: bool = False) -> StagePlan:
    """Analyze an island whose Jacobian was requested. Raises LimitRefused for an island without a Jacobian.

    ``exact``: False allows errors of some percent in solutions, which Newton's method corrects. ``signs``: whether
    negative eigenvalues are counted on islands without a potential, too.
    """
    import numpy as np

    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.compiled.threads_kernels import threads, tile_address
    from sceneql.linear.elimination import Inertia, borders, kinds_of
    from sceneql.linear.solver_kernels import FACTOR_SYSTEM, NEGATIVES, SOLVE_SYSTEM
    from sceneql.linear.stage_kernels import HEAD, assemble_tile, compare_tile

    if system.pattern is None:
        raise LimitRefused(
            f"an implicit solver needs the Jacobian of {len(system.y)} entries: {system.unsloped} gives no slopes, "
            "and those are too many for differences",
            None,
            "take `auto`, `verlet` or `dop853`, which need none, or fewer masses",
        )
    inverse = _inverse_masses(system)
    left, pattern, solver = _chosen(system, kinds_of(system, inverse), exact, signs)
    square = left.unit**2
    parts, diagonal = _parts(left, pattern)
    inertia = Inertia.of(system, left, pattern)
    bordering = borders(system, left, pattern)
    lists = [left.core, left.positions.ravel(), parts.ravel(), diagonal, _twins(pattern), solver.numbers, left.tallies]
    lists += [inertia.entries.ravel(), inertia.held, bordering.ravel()]
    starts = list(accumulate((len(part) for part in lists), initial=HEAD))
    counts = [len(system.y), len(left.core), square * pattern.nnz, len(left.positions), len(left.tallies)]
    kernels = (
        number_of(solver.kernels.factor_system, FACTOR_SYSTEM),
        number_of(solver.kernels.solve_system, SOLVE_SYSTEM),
    )
    tiles = square * pattern.nnz // TILE + 1
    shared = (tiles, *threads(), tile_address(assemble_tile), tile_address(compare_tile))
    told = solver.counts and (signs or system.structure.energies is not None)
    negatives = number_of(solver.kernels.negatives, NEGATIVES) if told else -1
    head = [*counts, *starts[:7], solver.factors, 0, *kernels, left.unit, *shared, negatives]
    head += [len(inertia.entries), len(inertia.held), *starts[7:9], system.border, len(bordering), starts[9]]
    head += [int(solver.keeps), int(system.fields.on_elements > 0)]
    assert len(head) == HEAD
    numbers = np.concatenate([np.asarray(part, dtype=np.int64) for part in (head, *lists)])
    room = 5 if solver.keeps else 1
    store = square * pattern.nnz + solver.factors + solver.work + 2 * tiles + room * len(left.core)
    scales = np.concatenate([1.0 / inverse[left.core], inertia.numbers])
    return StagePlan(numbers, scales, store, solver.text)


@dataclass(frozen=True, slots=True, eq=False)
class _Solver:
    kernels: Any
    """Module with `factor_system` and `solve_system` (solver_kernels.py)."""
    numbers: Any
    factors: int
    work: int
    text: str
    counts: bool = False
    """Whether the module counts negative eigenvalues, by `negatives`."""
    keeps: bool = False
    """Whether factors serve later matrices too (kept_factors_kernels)."""


def _chosen(system: System, kinds: Kinds, exact: bool, signs: bool) -> tuple[Left, Any, _Solver]:
    """Reduced system, its pattern and solver: in units of masses unless their factors fill in too much."""
    from sceneql.linear.elimination import inertia_places, left_by_entries, left_by_masses

    by_masses = left_by_masses(system, kinds) if kinds.core.sum() > SMALL else None
    if by_masses is not None:
        pattern = _pattern(by_masses, inertia_places(system, by_masses))
        # Barriers are so stiff that iterations take as long as ten factorizations, even of solids.
        solver = _factored(pattern, 3, _points(system, by_masses), exact, signs or bool(system.structure.limits))
        if solver is not None:
            return by_masses, pattern, solver
    left = left_by_entries(system, kinds)
    pattern = _pattern(left, inertia_places(system, left))
    if one_grid(system, left.core):
        return left, pattern, _over_grids(system, left.core, pattern)
    solver = _beside_few(pattern, _places(system, left), exact) if by_masses is None else None
    if by_masses is None and solver is None:
        points = None if system.border else _points(system, left)
        # Factors of a field's matrix serve many steps, so they pay even if iterations would be faster for one.
        solver = _factored(pattern, 1, points, exact, signs or system.fields.on_elements > 0, system.border)
    return left, pattern, solver or _iterations(pattern)


def _parts(left: Left, pattern: Any) -> tuple[NDArray[int64], NDArray[int64]]:
    """Parts (blocks, 4) of each block of the matrix (stage_kernels.py), and indices of the diagonal blocks."""
    import numpy as np

    units = pattern.shape[0]
    row_of = np.repeat(np.arange(units, dtype=np.int64), np.diff(pattern.indptr))
    keys = row_of * units + pattern.indices
    direct, through = (np.searchsorted(keys, part[:, 1] * units + part[:, 2]) for part in (left.first, left.second))
    parts = np.full((pattern.nnz, 4), -1, dtype=np.int64)
    parts[:, 0] = row_of
    parts[direct, 1] = left.first[:, 0]
    parts[through, 2:] = left.second[:, [0, 3]]
    return parts, np.searchsorted(keys, np.arange(units) * (units + 1))


def _inverse_masses(system: System) -> Floats:
    """Factors (n,) of the Jacobian's rows: inverse masses of velocities [1/kg]; 1 for others and for matrix inertia."""
    import numpy as np

    assert system.pattern is not None
    inverse = np.ones(len(system.y) + 2 * system.border)
    for velocity_at, inverse_at, count in _masses(system):
        if inverse_at < 0:
            continue
        inverse[velocity_at : velocity_at + 3 * count] = np.repeat(system.floats[inverse_at : inverse_at + count], 3)
    return inverse


def _masses(system: System) -> list[list[int]]:
    """(velocity_at, inverse_at, count) of each model of masses; empty without exact derivatives."""
    assert system.pattern is not None
    if not system.pattern.exact:
        return []
    section = system.ints[layout.SLOPES_AT]
    at, count = system.ints[section + layout.MASSES_AT], system.ints[section + layout.MASSES]
    masses: list[list[int]] = system.ints[at : at + 3 * count].reshape(-1, 3).tolist()
    return masses


class _Full:
    """Full pattern with the attributes of scipy's CSR, without the 0.1 s that importing scipy.sparse takes."""

    def __init__(self, units: int) -> None:
        import numpy as np

        self.shape, self.nnz = (units, units), units * units
        self.indptr = np.arange(0, self.nnz + 1, max(units, 1))
        self.indices = np.tile(np.arange(units), units)


def _pattern(left: Left, inertia: NDArray[int64]) -> Any:
    """Symmetric pattern of units as scipy CSR, indices sorted; the full pattern for a small system.

    ``inertia`` (k, 2): rows and columns (units) of sparse inertia.
    """
    import numpy as np

    units = len(left.core) // left.unit
    if units <= SMALL and left.unit == 1:
        return _Full(units)
    from scipy.sparse import csr_array

    own = np.arange(units)
    rows, columns = (np.concatenate([left.first[:, k], left.second[:, k], own]) for k in (1, 2))
    if len(inertia):
        rows, columns = np.concatenate([rows, inertia[:, 0]]), np.concatenate([columns, inertia[:, 1]])
    one_way = csr_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(units, units))
    one_way.sum_duplicates()
    one_way.data[:] = 1
    found = (one_way + one_way.T.tocsr()).astype(np.float64)
    found.sort_indices()
    return found


def _twins(pattern: Any) -> NDArray[int64]:
    """Place of the transposed entry for each entry of a symmetric pattern, indices sorted."""
    import numpy as np

    return np.argsort(pattern.indices, kind="stable").astype(np.int64)


def _points(system: System, left: Left) -> Floats | None:
    """Positions (units, 3) [m] of the units' masses at the start; None if a unit is no velocity."""
    import numpy as np

    found = _places(system, left)
    return None if np.isnan(found).any() else found


def _places(system: System, left: Left) -> Floats:
    """Positions (units, 3) [m] of the units' masses at the start; NaN for what is no velocity of a mass."""
    import numpy as np

    points = np.full((len(system.y) + system.border, 3), np.nan)
    position_of = np.full(len(system.y), -1, dtype=np.int64)
    paired = np.flatnonzero(system.partner >= 0)
    position_of[system.partner[paired]] = paired
    for velocity_at, _, count in _masses(system):
        positions = position_of[velocity_at : velocity_at + 3 * count]
        if (positions >= 0).all():
            points[velocity_at : velocity_at + 3 * count] = system.y[positions].reshape(-1, 3).repeat(3, axis=0)
    found: Floats = points[left.core[:: left.unit]]
    return found


def likely_kernels(system: System) -> tuple[str, ...]:
    """Kernel modules that a plan most likely needs, to be compiled while the island is built."""
    if system.pattern is None or system.grids:
        return ()
    few = (system.partner < 0).sum() <= SMALL
    if few:
        return ("sceneql.linear.dense_systems_kernels",)
    if system.border:
        return ("sceneql.linear.multifrontal.systems_kernels", "sceneql.linear.multifrontal.general_kernels")
    return (  # the process beside begins with the first, this one with the last
        "sceneql.linear.multifrontal.forward_kernels",
        "sceneql.linear.multifrontal.systems_kernels",
        "sceneql.linear.multifrontal.backward_kernels",
        "sceneql.linear.multifrontal.symmetric_kernels",
    )


def _factored(
    pattern: Any, unit: int, points: Floats | None, exact: bool, filling: bool, border: int = 0
) -> _Solver | None:
    """Factorization on a pattern of units; None if it would fill in too much.

    A system with a border is always factored, as iterations fail on it. ``filling``: whether the fill of solids is
    accepted, for signs, which iterations do not give, and for thin parts at rest and barriers, where they are slow.
    """
    import numpy as np

    size = pattern.shape[0]
    m = unit * size
    if m <= SMALL:
        from sceneql.linear import dense_systems_kernels

        numbers = np.concatenate([[m], np.zeros(m)])
        return _Solver(
            dense_systems_kernels,
            numbers,
            m * m,
            m * m,
            f"dense LU factorization of {m} unknowns",
            True,
        )

    from sceneql.linear.multifrontal import planning, systems_kernels
    from sceneql.linear.multifrontal.ordering import Groups, grouped

    groups = grouped(pattern) if unit == 1 else Groups(list(np.arange(size).reshape(-1, 1)), pattern)
    count = groups.graph.shape[0]
    solid = not filling and groups.graph.nnz > (SOLID + 1) * count and count > SOLID_GROUPS
    if (solid or count > MOST_GROUPS) and not border:
        return None
    plan = planning.plan(pattern, groups, points, unit, exact, border)
    if plan.operations > MOST_OPERATIONS and not border:
        return None
    tied = f", {border} of them forces of ties" if border else ""
    text = f"sparse factorization of {m} unknowns{tied}, {plan.factors:.3g} numbers in its factors"
    return _Solver(
        systems_kernels,
        plan.numbers,
        plan.factors,
        plan.work,
        text,
        True,
        plan.operations > KEPT * plan.factors,
    )


def _beside_few(pattern: Any, places: Floats, exact: bool) -> _Solver | None:
    """Factors of the masses among the unknowns, with all others as a border; None where that does not pay."""
    from sceneql.linear import bordered
    from sceneql.linear.multifrontal import planning

    many = bordered.split(places)
    if many is None:
        return None
    plan = planning.plan(bordered.within(pattern, many), None, places[many], 1, exact)
    if plan.operations > MOST_OPERATIONS:
        return None
    from sceneql.linear import bordered_kernels  # compiled by those alone that need them

    found = bordered.bordered(pattern, many, plan.numbers, plan.factors, plan.work)
    few, all_ = int((~many).sum()), len(many)
    text = f"sparse factorization of {all_} unknowns, {plan.factors:.3g} numbers in its factors, and {few} beside them"
    return _Solver(bordered_kernels, found.numbers, found.factors, found.work, text)


def _iterations(pattern: Any) -> _Solver:
    from sceneql.linear import krylov_kernels

    m = pattern.shape[0]
    numbers = _iterated(pattern, krylov_kernels)
    text = f"iterations (conjugate gradients or BiCGStab, incomplete factors) on {m} unknowns"
    return _Solver(krylov_kernels, numbers, pattern.nnz, 8 * m, text)


def _over_grids(system: System, core: NDArray[int64], pattern: Any) -> _Solver:
    """Iterative solver of species on one grid."""
    import numpy as np

    from sceneql.linear import species, species_kernels

    own, floats, text = species.plan(system, core, pattern)
    numbers = np.concatenate([_iterated(pattern, species_kernels), own])
    return _Solver(species_kernels, numbers, floats, 8 * len(core), f"iterations (BiCGStab) with {text}")


def _iterated(pattern: Any, kernels: Any) -> NDArray[int64]:
    """Integers of krylov_kernels with the preconditioner of a kernel module."""
    import numpy as np

    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.linear.solver_kernels import PRECONDITION

    m = pattern.shape[0]
    diagonal = np.searchsorted(
        np.repeat(np.arange(m, dtype=np.int64), np.diff(pattern.indptr)) * m + pattern.indices,
        np.arange(m, dtype=np.int64) * (m + 1),
    )
    near = number_of(kernels.precondition, PRECONDITION)
    return np.concatenate([[m], pattern.indptr, diagonal, pattern.indices, [near]]).astype(np.int64)
