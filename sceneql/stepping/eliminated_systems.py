"""The plan by which eliminated_systems_kernels.py reduces an island's linear systems (Schur complement)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.island import layout

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.island.system import System


def elimination(system: System) -> NDArray[int64]:
    """The plan for (mu - J) d = r, from which pairs, held masses and tallies are eliminated.

    The system has a pattern.
    """
    pattern = system.pattern
    assert pattern is not None
    n = len(system.y)
    rows, columns = pattern.rows, pattern.columns
    place = dict(zip(zip(rows.tolist(), columns.tolist(), strict=True), range(len(rows)), strict=True))
    idle = set(pattern.tallies.tolist()) | _held(system)
    length = np.bincount(rows, minlength=n)
    pairs = {
        x: int(v)
        for x, v in enumerate(system.partner)
        if v >= 0 and x not in idle and int(v) not in idle and length[x] == 2 and (x, int(v)) in place
    }
    left = [i for i in range(n) if i not in idle and i not in pairs]
    rank = {i: k for k, i in enumerate(left)}
    order = {x: k for k, x in enumerate(pairs)}
    direct, through = [], []
    for k, (i, j) in enumerate(zip(rows.tolist(), columns.tolist(), strict=True)):
        if i in rank and j in rank:
            direct += [k, rank[i] * len(left) + rank[j]]
        elif i in rank and j in order:
            through += [k, rank[i], order[j]]
    eliminated = [number for x, v in pairs.items() for number in (x, rank[v], place[x, x], place[x, v])]
    sizes = [len(left), len(pairs), len(idle), len(direct) // 2, len(through) // 3]
    return np.array([*sizes, *left, *eliminated, *sorted(idle), *direct, *through], dtype=np.int64)


def _held(system: System) -> set[int]:
    """The entries of masses with an inverse mass of 0, whose rates are always 0."""
    ints = system.ints
    found: set[int] = set()
    if system.pattern is None or not system.pattern.exact:
        return found
    at = ints[layout.SLOPES_AT]
    masses_at, masses = ints[at + layout.MASSES_AT], ints[at + layout.MASSES]
    velocities = {int(v): x for x, v in enumerate(system.partner) if v >= 0}
    for velocity_at, inverse_at, count in ints[masses_at : masses_at + 3 * masses].reshape(-1, 3).tolist():
        for k in (
            [] if inverse_at < 0 else np.flatnonzero(system.floats[inverse_at : inverse_at + count] == 0.0).tolist()
        ):
            for v in range(velocity_at + 3 * k, velocity_at + 3 * k + 3):
                found |= {v, velocities[v]} if v in velocities else {v}
    return found
