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

if TYPE_CHECKING:
    import numpy
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.simulation.island import System

DENSE, FRONTS, KRYLOV = range(3)
"""How a stage system is solved: dense LU, sparse multifrontal LU, preconditioned iterations."""

SMALL = 96
"""Up to so many unknowns a dense factorization is as quick as a sparse one."""
MOST_GROUPS = 100_000
MOST_OPERATIONS = 2e10
"""Multiplications of a factorization; above, iterations are quicker."""
SOLID = 16
"""Neighbors of a mass from which on a net counts as a solid, whose factors fill up."""
SOLID_GROUPS = 3000

HEAD = 24


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
    """(., 5): place in the Jacobian, of the position's one, row, column, position: the coefficient is -a^2."""
    tallies: NDArray[int64]
    """Entries that depend on others by unknown slopes and that nothing depends on."""


def stage_plan(system: System) -> StagePlan:
    """Analyze an island whose Jacobian was asked for. Raises LimitRefused where it could not be had."""
    import numpy as np

    if system.pattern is None:
        raise LimitRefused(
            f"an implicit solver needs the Jacobian of {len(system.y)} entries: a term gives no slopes, and those are "
            "too many for differences",
            None,
            "take an explicit solver, or fewer masses",
        )
    inverse = _inverse_masses(system)
    reduced = _reduce(system, inverse)
    scales = 1.0 / inverse[reduced.core]
    m = len(reduced.core)
    rows = np.concatenate([reduced.first[:, 1], reduced.second[:, 2], np.arange(m)])
    columns = np.concatenate([reduced.first[:, 2], reduced.second[:, 3], np.arange(m)])
    if m <= SMALL:
        places, solver, kind = rows * m + columns, _Solver(m * m, [], 0, m), DENSE
        twins = np.zeros(0, dtype=np.int64)
        text = f"dense LU factorization of {m} unknowns"
    else:
        pattern = _symmetric_pattern(rows, columns, m)
        kind, solver, text = _choose(pattern)
        order = np.repeat(np.arange(m, dtype=np.int64), np.diff(pattern.indptr)) * m + pattern.indices
        places = np.searchsorted(order, rows * m + columns)
        twins = np.searchsorted(order, pattern.indices.astype(np.int64) * m + order // m)
    f, s = len(reduced.first), len(reduced.second)
    first = np.column_stack([reduced.first[:, 0], places[:f], reduced.first[:, 1]])
    second = np.column_stack([reduced.second[:, :2], places[f : f + s], reduced.second[:, 2], reduced.second[:, 4]])
    parts = [reduced.core, reduced.positions.ravel(), first.ravel(), second.ravel(), places[f + s :], twins]
    parts += [solver.numbers, np.zeros(solver.pivots), reduced.tallies]
    starts = list(accumulate((len(part) for part in parts), initial=HEAD))
    counts = [len(system.y), kind, m, solver.values, len(reduced.positions), f, s, len(reduced.tallies)]
    head = [*counts, *starts[:-1], solver.factors, 0, 0, 0, 0, 0, 0]
    assert len(head) == HEAD
    numbers = np.concatenate([np.asarray(part, dtype=np.int64) for part in (head, *parts)])
    return StagePlan(numbers, scales, solver.values + solver.factors + solver.work + m, text)


@dataclass(frozen=True, slots=True, eq=False)
class _Solver:
    values: int
    numbers: Any
    factors: int
    pivots: int
    work: int = 0


def _inverse_masses(system: System) -> Floats:
    """(n,) what multiplies the rows of the Jacobian: the inverse mass of a velocity, 1 for all else."""
    import numpy as np

    assert system.pattern is not None
    inverse = np.ones(len(system.y))
    if system.pattern.exact:
        section = system.ints[4]
        at, count = system.ints[section + 4], system.ints[section + 5]
        for velocity_at, inverse_at, masses in system.ints[at : at + 3 * count].reshape(-1, 3).tolist():
            own = system.floats[inverse_at : inverse_at + masses]
            inverse[velocity_at : velocity_at + 3 * masses] = np.repeat(own, 3)
    return inverse


def _known(system: System) -> NDArray[numpy.bool_]:
    """(values,) which values of the Jacobian come from slopes; the others are zeros of the diagonal."""
    import numpy as np

    assert system.pattern is not None
    known = np.full(len(system.pattern.columns), not system.pattern.exact)
    if system.pattern.exact:
        section = system.ints[4]
        at = system.ints[section + 2]
        known[system.ints[at : at + system.ints[section + 1]]] = True
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
    direct = known & in_core[rows] & in_core[columns]
    through = known & in_core[rows] & position[columns] & in_core[partner[columns]]
    bare = columns[through]
    return _Reduced(
        core=core,
        positions=np.column_stack([eliminated, partner[eliminated], one[eliminated]]),
        first=np.column_stack([places[direct], number[rows[direct]], number[columns[direct]]]),
        second=np.column_stack([places[through], one[bare], number[rows[through]], number[partner[bare]], bare]),
        tallies=np.flatnonzero(tally),
    )


def _symmetric_pattern(rows: Any, columns: Any, m: int) -> Any:
    import numpy as np
    from scipy.sparse import csr_array

    both = (np.concatenate([rows, columns]), np.concatenate([columns, rows]))
    pattern = csr_array((np.ones(2 * len(rows)), both), shape=(m, m))
    pattern.sum_duplicates()
    return pattern


def _choose(pattern: Any) -> tuple[int, _Solver, str]:
    """How to solve systems of a pattern, by its size and fill."""
    import numpy as np

    from sceneql.simulation.linear import fronts
    from sceneql.simulation.linear.ordering import grouped

    m = pattern.shape[0]
    groups = grouped(pattern)
    graph = groups.graph
    size = graph.shape[0]
    solid = graph.nnz > (SOLID + 1) * size and size > SOLID_GROUPS
    if not solid and size <= MOST_GROUPS:
        plan = fronts.plan(pattern, groups)
        if plan.operations <= MOST_OPERATIONS:
            text = f"sparse factorization of {m} unknowns, {plan.factors:.3g} numbers in its factors"
            return FRONTS, _Solver(pattern.nnz, plan.numbers, plan.factors, 0, plan.work), text
    diagonal = np.searchsorted(
        np.repeat(np.arange(m, dtype=np.int64), np.diff(pattern.indptr)) * m + pattern.indices,
        np.arange(m, dtype=np.int64) * (m + 1),
    )
    numbers = np.concatenate([[m], pattern.indptr, diagonal, pattern.indices])
    text = f"iterations (conjugate gradients or BiCGStab, incomplete factors) on {m} unknowns"
    return KRYLOV, _Solver(pattern.nnz, numbers, pattern.nnz, 0, 8 * m), text
