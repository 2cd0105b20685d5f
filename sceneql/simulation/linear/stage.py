"""The linear systems of implicit stages, (1 - a J) d = r, analyzed once for an island.

Positions are eliminated: their rows say dx/dt = v, so d_x = r_x + a d_v, and what is left is a system in the velocities
(and other entries), 1 - a D - a^2 K for damping D and stiffness K: half the size, and symmetric when its rows are
multiplied by the masses. Entries that nothing depends on and fixed masses are left out too.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from sceneql.failure import LimitRefused
from sceneql.simulation.grids.species import one_grid

if TYPE_CHECKING:
    import numpy
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.simulation.island import System

SMALL = 96
"""Up to so many unknowns a dense factorization is as quick as a sparse one."""
MOST_GROUPS = 100_000
MOST_OPERATIONS = 2e10
"""Multiplications of a factorization; above, iterations are quicker."""
SOLID = 16
"""Neighbors of a mass from which on a net counts as a solid, whose factors fill up."""
SOLID_GROUPS = 3000


@dataclass(frozen=True, slots=True, eq=False)
class StagePlan:
    """What the kernels of stage_kernels.py need of an island."""

    numbers: NDArray[int64]
    """See stage_kernels for how they lie; changed by the kernels (pivots, symmetry)."""
    scales: Floats
    """(unknowns,) factor of each row."""
    store: int
    """Floats for the matrix, its factors and scratch."""
    text: str
    """How the systems are solved, for `explain`."""


@dataclass(frozen=True, slots=True, eq=False)
class _Reduced:
    """The unknowns that are left, and where entries of the Jacobian go."""

    core: NDArray[int64]
    positions: NDArray[int64]
    """(p, 3): position, velocity, place of the one in its row of the Jacobian."""
    first: NDArray[int64]
    """(., 3): place in the Jacobian, row and column of what is left: the coefficient is -a."""
    second: NDArray[int64]
    """(., 4): place in the Jacobian, row and column of what is left, which position: the coefficient is -a^2."""
    tallies: NDArray[int64]
    """Entries that depend on others by unknown slopes and that nothing depends on."""


def stage_plan(system: System) -> StagePlan:
    """Analyze an island whose Jacobian was asked for. Raises LimitRefused where it could not be had."""
    import numpy as np

    from sceneql.simulation.linear.solver_kernels import FACTOR_SYSTEM, SOLVE_SYSTEM
    from sceneql.simulation.linear.stage_kernels import HEAD
    from sceneql.simulation.numbered_kernels import number_of

    if system.pattern is None:
        raise LimitRefused(
            f"an implicit solver needs the Jacobian of {len(system.y)} entries: {system.unsloped} gives no slopes, "
            "and those are too many for differences",
            None,
            "take `auto`, `verlet` or `dop853`, which need none, or fewer masses",
        )
    inverse = _inverse_masses(system)
    reduced = _reduce(system, inverse)
    scales = 1.0 / inverse[reduced.core]
    m = len(reduced.core)
    rows = np.concatenate([reduced.first[:, 1], reduced.second[:, 1], np.arange(m)])
    columns = np.concatenate([reduced.first[:, 2], reduced.second[:, 2], np.arange(m)])
    pattern = _pattern(rows, columns, m)
    row_of = np.repeat(np.arange(m, dtype=np.int64), np.diff(pattern.indptr))
    places = np.searchsorted(row_of * m + pattern.indices, rows * m + columns)
    twins = _twins(pattern)
    if one_grid(system, reduced.core):
        solver = _over_grids(system, reduced.core, pattern)
    else:
        solver = _choose(pattern, _points(system, reduced.core))
    f, s = len(reduced.first), len(reduced.second)
    parts = np.full((pattern.nnz, 4), -1, dtype=np.int64)
    parts[:, 0] = row_of
    parts[places[:f], 1] = reduced.first[:, 0]
    parts[places[f : f + s], 2] = reduced.second[:, 0]
    parts[places[f : f + s], 3] = reduced.second[:, 3]
    lists = [reduced.core, reduced.positions.ravel(), parts.ravel(), places[f + s :], twins]
    lists += [solver.numbers, reduced.tallies]
    starts = list(accumulate((len(part) for part in lists), initial=HEAD))
    counts = [len(system.y), m, pattern.nnz, len(reduced.positions), len(reduced.tallies)]
    kernels = (
        number_of(solver.kernels.factor_system, FACTOR_SYSTEM),
        number_of(solver.kernels.solve_system, SOLVE_SYSTEM),
    )
    head = [*counts, *starts[:-1], solver.factors, 0, *kernels]
    assert len(head) == HEAD
    numbers = np.concatenate([np.asarray(part, dtype=np.int64) for part in (head, *lists)])
    return StagePlan(numbers, scales, pattern.nnz + solver.factors + solver.work + m, solver.text)


@dataclass(frozen=True, slots=True, eq=False)
class _Solver:
    kernels: Any
    """The module with its `factor` and `solve` (solver_kernels.py)."""
    numbers: Any
    factors: int
    work: int
    text: str


def _inverse_masses(system: System) -> Floats:
    """(n,) what multiplies the rows of the Jacobian: the inverse mass of a velocity, 1 for all else."""
    import numpy as np

    assert system.pattern is not None
    inverse = np.ones(len(system.y))
    for velocity_at, inverse_at, count in _masses(system):
        inverse[velocity_at : velocity_at + 3 * count] = np.repeat(system.floats[inverse_at : inverse_at + count], 3)
    return inverse


def _masses(system: System) -> list[list[int]]:
    """(velocity_at, inverse_at, count) of each model of masses, where the slopes are known."""
    assert system.pattern is not None
    if not system.pattern.exact:
        return []
    section = system.ints[4]
    at, count = system.ints[section + 4], system.ints[section + 5]
    masses: list[list[int]] = system.ints[at : at + 3 * count].reshape(-1, 3).tolist()
    return masses


def _known(system: System) -> NDArray[numpy.bool_]:
    """(values,) which values of the Jacobian come from slopes; the others are zeros of the diagonal."""
    import numpy as np

    assert system.pattern is not None
    known = np.full(len(system.pattern.columns), not system.pattern.exact)
    if system.pattern.exact:
        section = system.ints[4]
        at = system.ints[section + 2]
        known = np.diff(system.ints[at : at + len(known) + 1]) > 0
    return known


def _reduce(system: System, inverse: Floats) -> _Reduced:
    import numpy as np

    assert system.pattern is not None
    starts, columns = system.pattern.starts, system.pattern.columns
    n = len(system.y)
    rows = np.repeat(np.arange(n, dtype=np.int64), np.diff(starts))
    places = np.arange(len(columns), dtype=np.int64)
    known = _known(system)
    off = (rows != columns) & known
    partner = system.partner
    # A position whose row has nothing but its velocity.
    alien = np.bincount(rows[off & (columns != partner[rows])], minlength=n) > 0
    has_one = np.bincount(rows[off & (columns == partner[rows])], minlength=n) > 0
    position = (partner >= 0) & ~alien & has_one
    fixed = inverse == 0.0
    used = np.bincount(columns[known], minlength=n) + np.bincount(rows[known], minlength=n) > 0
    tally = ~used & (partner < 0) & ~np.isin(np.arange(n), partner[partner >= 0])
    in_core = ~position & ~fixed & ~tally
    core = np.flatnonzero(in_core)
    number = np.full(n, -1, dtype=np.int64)
    number[core] = np.arange(len(core))

    one = np.full(n, -1, dtype=np.int64)
    found = off & position[rows] & (columns == partner[rows])
    one[rows[found]] = places[found]
    eliminated = np.flatnonzero(position)
    rank = np.full(n, -1, dtype=np.int64)
    rank[eliminated] = np.arange(len(eliminated))
    direct = known & in_core[rows] & in_core[columns]
    through = known & in_core[rows] & position[columns] & in_core[partner[columns]]
    bare = columns[through]
    return _Reduced(
        core=core,
        positions=np.column_stack([eliminated, partner[eliminated], one[eliminated]]),
        first=np.column_stack([places[direct], number[rows[direct]], number[columns[direct]]]),
        second=np.column_stack([places[through], number[rows[through]], number[partner[bare]], rank[bare]]),
        tallies=np.flatnonzero(tally),
    )


def _pattern(rows: Any, columns: Any, m: int) -> Any:
    """The symmetric pattern of entries as (m, m) scipy CSR, indices sorted; where it is small, the full one."""
    import numpy as np
    from scipy.sparse import csr_array

    if m <= SMALL:
        return csr_array(np.ones((m, m)))
    one_way = csr_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(m, m))
    one_way.sum_duplicates()
    one_way.data[:] = 1
    return (one_way + one_way.T.tocsr()).astype(np.float64)


def _twins(pattern: Any) -> NDArray[int64]:
    """For each entry of a symmetric pattern, indices sorted, the place of the transposed one."""
    import numpy as np
    from scipy.sparse import csr_array

    numbered = (np.arange(pattern.nnz, dtype=np.int64), pattern.indices, pattern.indptr)
    found: NDArray[int64] = csr_array(numbered, shape=pattern.shape).T.tocsr().data
    return found


def _points(system: System, core: NDArray[int64]) -> Floats | None:
    """(unknowns, 3) where the masses whose velocities they are lie at the start; None where one is no velocity."""
    import numpy as np

    points = np.full((len(system.y), 3), np.nan)
    position_of = np.full(len(system.y), -1, dtype=np.int64)
    paired = np.flatnonzero(system.partner >= 0)
    position_of[system.partner[paired]] = paired
    for velocity_at, _, count in _masses(system):
        positions = position_of[velocity_at : velocity_at + 3 * count]
        if (positions >= 0).all():
            points[velocity_at : velocity_at + 3 * count] = system.y[positions].reshape(-1, 3).repeat(3, axis=0)
    found = points[core]
    return None if np.isnan(found).any() else found


def likely_kernels(system: System) -> tuple[str, ...]:
    """Modules that a plan will most likely ask for, to be compiled while the island is built."""
    if system.pattern is None or system.grids:
        return ()
    few = (system.partner < 0).sum() <= SMALL
    return tuple(f"{__package__}.{name}_kernels" for name in (("dense",) if few else ("fronts_symmetric", "fronts")))


def _choose(pattern: Any, points: Floats | None) -> _Solver:
    """How to solve systems of a pattern, by its size and fill."""
    import numpy as np

    m = pattern.shape[0]
    if m <= SMALL:
        from sceneql.simulation.linear import dense_kernels

        numbers = np.concatenate([[m], np.zeros(m)])
        return _Solver(dense_kernels, numbers, m * m, 0, f"dense LU factorization of {m} unknowns")

    from sceneql.simulation.linear import fronts
    from sceneql.simulation.linear.ordering import grouped

    groups = grouped(pattern)
    graph = groups.graph
    size = graph.shape[0]
    solid = graph.nnz > (SOLID + 1) * size and size > SOLID_GROUPS
    if not solid and size <= MOST_GROUPS:
        plan = fronts.plan(pattern, groups, points)
        if plan.operations <= MOST_OPERATIONS:
            from sceneql.simulation.linear import fronts_kernels

            text = f"sparse factorization of {m} unknowns, {plan.factors:.3g} numbers in its factors"
            return _Solver(fronts_kernels, plan.numbers, plan.factors, plan.work, text)

    from sceneql.simulation.linear import krylov_kernels

    numbers = _iterated(pattern, krylov_kernels)
    text = f"iterations (conjugate gradients or BiCGStab, incomplete factors) on {m} unknowns"
    return _Solver(krylov_kernels, numbers, pattern.nnz, 8 * m, text)


def _over_grids(system: System, core: NDArray[int64], pattern: Any) -> _Solver:
    """The solver of species on one grid."""
    import numpy as np

    from sceneql.simulation.grids import species, species_kernels

    own, floats, text = species.plan(system, core, pattern)
    numbers = np.concatenate([_iterated(pattern, species_kernels), own])
    return _Solver(species_kernels, numbers, floats, 8 * len(core), f"iterations (BiCGStab) with {text}")


def _iterated(pattern: Any, kernels: Any) -> NDArray[int64]:
    """The integers of krylov_kernels with a module's preconditioner."""
    import numpy as np

    from sceneql.simulation.linear.solver_kernels import PRECONDITION
    from sceneql.simulation.numbered_kernels import number_of

    m = pattern.shape[0]
    diagonal = np.searchsorted(
        np.repeat(np.arange(m, dtype=np.int64), np.diff(pattern.indptr)) * m + pattern.indices,
        np.arange(m, dtype=np.int64) * (m + 1),
    )
    near = number_of(kernels.precondition, PRECONDITION)
    return np.concatenate([[m], pattern.indptr, diagonal, pattern.indices, [near]]).astype(np.int64)
