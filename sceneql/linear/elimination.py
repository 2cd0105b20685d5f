"""Reduction of the systems (1 - a J) d = r of implicit stages: positions and idle entries are eliminated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.island.rising import rising

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System

    Numbers = NDArray[int64]
    Mask = NDArray[bool_]

_THREE = np.arange(3)


@dataclass(frozen=True, slots=True, eq=False)
class Left:
    """Reduced system: its unknowns, and the map from the Jacobian. A unit is one entry, or the three of a mass."""

    unit: int
    """Number of entries of a unit: 1 or 3. Values are blocks (unit, unit), row by row."""
    core: Numbers
    """(m,): entries of y that remain, then unknowns that border the system (Slopes.border)."""
    positions: Numbers
    """(p, 3): position, velocity, and index of the 1 in the position's row among the Jacobian's values."""
    first: Numbers
    """(., 3): place in the Jacobian, row and column (units) in the reduced matrix; the coefficient is -a."""
    second: Numbers
    """(., 4): place, row and column as in ``first``, and index of the position (of a unit's first one); the
    coefficient is -a^2."""
    tallies: Numbers
    """Entries without derivatives, on which no rate depends."""


@dataclass(frozen=True, slots=True, eq=False)
class Kinds:
    """Role of every entry of y in the elimination."""

    core: Mask
    position: Mask
    tally: Mask
    one: Numbers
    """Index of d(dx/dt)/dv among the Jacobian's values for a position x; -1: none."""


def kinds_of(system: System, inverse: Floats) -> Kinds:
    """Kinds of all entries: positions with rows dx/dt = v, fixed and idle entries, and the core.

    ``inverse`` (n,): inverse masses, as from stage._inverse_masses.
    """
    pattern = system.pattern
    assert pattern is not None
    n, border = len(system.y), system.border
    (rows, columns), known, partner = pattern.others.T, pattern.known, partners(system)
    in_blocks, by_blocks = ((pattern.blocks[:, side, None] + _THREE).ravel() for side in (0, 1))
    off = (rows != columns) & known
    # A position whose row has entries other than its own velocity is not eliminated.
    alien = np.bincount(rows[off & (columns != partner[rows])], minlength=len(partner)) > 0
    alien[in_blocks] = True
    ones = off & (columns == partner[rows])
    one = np.full(len(partner), -1, dtype=np.int64)
    one[rows[ones]] = 9 * len(pattern.blocks) + np.flatnonzero(ones)
    position = (partner >= 0) & ~alien & (one >= 0)
    used = np.zeros(len(partner), dtype=bool)
    for entries in (rows[known], columns[known], in_blocks, by_blocks, partner[partner >= 0]):
        used[entries] = True
    tally = ~used & (partner < 0)
    tally[n:] = False
    core = ~position & (inverse != 0.0) & ~tally
    core[n + border :] = False
    return Kinds(core, position, tally, one)


def partners(system: System) -> Numbers:
    """Index of the velocity for each row of the pattern that is a position, else -1."""
    return np.concatenate([system.partner, np.full(2 * system.border, -1, dtype=np.int64)])


def left_by_masses(system: System, kinds: Kinds) -> Left | None:
    """Reduced system in units of three; None unless its unknowns are all velocities of whole masses."""
    pattern, partner = system.pattern, partners(system)
    assert pattern is not None
    if system.border:
        return None
    core = np.flatnonzero(kinds.core)
    rows, columns = pattern.blocks.T
    mine = kinds.core[rows]
    tops = core[::3]
    whole = len(core) % 3 == 0 and (core.reshape(-1, 3) == tops[:, None] + _THREE).all()
    if not whole or not np.array_equal(tops, rising(rows[mine])):
        return None
    if (kinds.core[pattern.others[:, 0]] & pattern.known).any():
        return None
    for mask in (kinds.core, kinds.position):
        if not (mask[columns] == mask[columns + 1]).all() or not (mask[columns] == mask[columns + 2]).all():
            return None
    bare = columns[mine & kinds.position[columns]]
    if any((partner[bare + k] != partner[bare] + k).any() for k in (1, 2)):
        return None
    return _left(system, kinds, 3, rows, columns, 9 * np.arange(len(rows)))


def left_by_entries(system: System, kinds: Kinds) -> Left:
    """Reduced system in units of one entry."""
    pattern = system.pattern
    assert pattern is not None
    known = np.concatenate([np.ones(9 * len(pattern.blocks), dtype=bool), pattern.known])
    return _left(system, kinds, 1, pattern.rows[known], pattern.columns[known], np.flatnonzero(known))


def _left(system: System, kinds: Kinds, unit: int, rows: Numbers, columns: Numbers, places: Numbers) -> Left:
    partner = partners(system)
    core, eliminated = np.flatnonzero(kinds.core), np.flatnonzero(kinds.position)
    number, rank = (np.full(len(partner), -1, dtype=np.int64) for _ in range(2))
    number[core] = np.arange(len(core)) // unit
    rank[eliminated] = np.arange(len(eliminated))
    mine = kinds.core[rows]
    direct = mine & kinds.core[columns]
    through = mine & kinds.position[columns] & kinds.core[partner[columns]]
    bare = columns[through]
    return Left(
        unit=unit,
        core=core,
        positions=np.column_stack([eliminated, partner[eliminated], kinds.one[eliminated]]),
        first=np.column_stack([places[direct], number[rows[direct]], number[columns[direct]]]),
        second=np.column_stack([places[through], number[rows[through]], number[partner[bare]], rank[bare]]),
        tallies=np.flatnonzero(kinds.tally),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Inertia:
    """Lists of a plan for inertia that is a matrix; all empty without one."""

    entries: Numbers
    """(k, 3): place among the values of the reduced matrix, row and column (unknowns)."""
    held: Numbers
    """Places of values that are left out, because their row or column is held."""
    numbers: Floats
    """(unknowns,): 1 for a row of the inertia matrix, 0 for a held one, -1 for others; then each entry's value [kg]."""

    @staticmethod
    def of(system: System, left: Left, pattern: Any) -> Inertia:
        """Lists for a system; ``pattern``: CSR of units, indices sorted."""
        none = np.zeros(0, dtype=np.int64)
        if not system.inertia:
            return Inertia(none.reshape(0, 3), none, np.zeros(0))
        m, unit, units = len(left.core), left.unit, pattern.shape[0]
        free = np.full(m, -1.0)
        rows, columns, values = _entries(system, left)
        for velocity_at, matrix in system.inertia:
            mine = (left.core >= velocity_at) & (left.core < velocity_at + matrix.shape[0])
            free[mine] = 1.0 * (matrix.diagonal()[left.core[mine] - velocity_at] > 0.0)
        fixed = np.flatnonzero(free == 0.0)
        rows, columns = np.concatenate([rows, fixed]), np.concatenate([columns, fixed])
        values = np.concatenate([values, np.ones(len(fixed))])
        row_of = np.repeat(np.arange(units, dtype=np.int64), np.diff(pattern.indptr))
        keys = row_of * units + pattern.indices
        block = np.searchsorted(keys, rows // unit * units + columns // unit)
        places = (block * unit + rows % unit) * unit + columns % unit
        i = (unit * row_of[:, None, None] + np.arange(unit)[:, None]).repeat(unit, axis=2).ravel()
        j = (unit * pattern.indices.astype(np.int64)[:, None, None] + np.arange(unit)).repeat(unit, axis=1).ravel()
        held = np.flatnonzero((free[i] == 0.0) | (free[j] == 0.0))
        return Inertia(np.column_stack([places, rows, columns]), held, np.concatenate([free, values]))


def borders(system: System, left: Left, pattern: Any) -> Numbers:
    """(k, 4): entries of the border's rows for rates of entries of y.

    Each has its place among the values of the matrix (in units of one entry), its row, the entry of y, and its place in
    the Jacobian. ``pattern``: CSR of units, indices sorted.
    """
    n, border, m = len(system.y), system.border, len(left.core)
    if not border:
        return np.zeros((0, 4), dtype=np.int64)
    assert system.pattern is not None
    number = np.full(n + 2 * border, -1, dtype=np.int64)
    number[left.core] = np.arange(m)
    rows, columns = system.pattern.rows, system.pattern.columns
    places = np.flatnonzero((rows >= n + border) & (number[columns] >= 0) & (columns < n))
    own, entries = number[rows[places] - border], columns[places]
    keys = np.repeat(np.arange(m, dtype=np.int64), np.diff(pattern.indptr)) * m + pattern.indices
    return np.column_stack([np.searchsorted(keys, own * m + number[entries]), own, entries, places])


def inertia_places(system: System, left: Left) -> Numbers:
    """Rows and columns (k, 2), in units, of the reduced matrix's entries with inertia."""
    rows, columns, _ = _entries(system, left)
    return np.column_stack([rows, columns]) // left.unit


def _entries(system: System, left: Left) -> tuple[Numbers, Numbers, Floats]:
    """Rows and columns (unknowns), and values [kg], of all inertia matrices, restricted to the unknowns."""
    number = np.full(len(partners(system)), -1, dtype=np.int64)
    number[left.core] = np.arange(len(left.core))
    rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for velocity_at, matrix in system.inertia:
        found = matrix.tocoo()
        places = number[velocity_at + found.row], number[velocity_at + found.col]
        kept = (places[0] >= 0) & (places[1] >= 0) & (found.data != 0.0)
        rows.append(places[0][kept])
        columns.append(places[1][kept])
        values.append(found.data[kept])
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
