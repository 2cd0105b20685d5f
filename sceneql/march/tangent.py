"""Linearized motion of an island's masses about their rest: M x'' = F(t) - K x - D x'."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.failure import LimitRefused
from sceneql.island import layout
from sceneql.march.driver import jacobian

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.march.march import March

SAME = 1e-9
"""Relative difference, to the largest entry, below which matrices count as the same."""
MOVED, TELLS = 1e-4, 1e-5
"""Displacement, relative to the island's size, by which the term to blame is found, and the least difference that
counts, relative to the term's own change."""


@dataclass(frozen=True, slots=True, eq=False)
class Tangent:
    """Mass, stiffness and damping matrices of the n entries that move freely, sparse and symmetric (n, n)."""

    positions: NDArray[int64]
    """(n,) indices of their positions in y."""
    velocities: NDArray[int64]
    """(n,) indices of their velocities in y."""
    axes: NDArray[int64]
    """(n,) axis of each entry: 0, 1 or 2."""
    mass: Any
    """[kg]"""
    stiffness: Any
    """[N/m]"""
    damping: Any
    """[N s/m]"""


def tangent(march: March, functions: Any, rest: Floats, times: Floats) -> Tangent:
    """The matrices of a march's island about a state of zero velocities, equal at the times (k,) [s].

    ``functions``: the addresses that the Jacobian takes. Raises LimitRefused, at the line of the part to blame, where
    forces have no slopes, where the matrices change in time, and where forces have no potential.
    """
    from scipy.sparse import csr_array

    system = march.system
    if system.pattern is None or not system.pattern.exact:
        raise LimitRefused(
            f"modes are those of forces with slopes, and '{system.unsloped or system.ranges[0][2]}' has none",
            system.ranges[0][3][0],
            "let auto march it",
        )
    velocities = np.concatenate([np.arange(at, at + 3 * count) for at, _, count in system.masses])
    position_of = np.full(len(rest), -1)
    paired = np.flatnonzero(system.partner >= 0)
    position_of[system.partner[paired]] = paired
    positions, inertia = position_of[velocities], _inertia(system, march.floats)
    forces = _forces(system, march.floats)

    def matrices(t: float) -> list[Any]:
        rows = _slopes(march, functions, rest, t)[velocities].tocsc()
        return [-csr_array(forces @ rows[:, at]) for at in (positions, velocities)]

    found = matrices(float(times[0]))
    stiffness = abs(found[0])
    # Led entries: others depend on their positions, they on none.
    led = (stiffness.sum(axis=0) > 0.0) & (stiffness.sum(axis=1) == 0.0)
    free = np.flatnonzero((inertia.diagonal() > 0.0) & ~led)
    found = [one[free][:, free] for one in found]
    sizes, changes = [_largest(one) for one in found], [0.0, 0.0]
    for t in times[1:].tolist():  # one at a time, to keep few matrices in memory
        for which, one in enumerate(matrices(t)):
            now = one[free][:, free]
            sizes[which] = max(sizes[which], _largest(now))
            changes[which] = max(changes[which], _largest(now - found[which]))
    for first, size, change, what in zip(found, sizes, changes, ("stiffness", "damping"), strict=True):
        if change > SAME * size:
            raise _refused(march, rest, times, f"the {what} of '{{}}' changes in time, and modes are those of one")
        if _largest(first - first.T) > SAME * size:
            raise _refused(march, rest, times[:1], "the forces of '{}' have no potential, and modes are those of one")
    halves = [csr_array((one + one.T) * 0.5) for one in found]
    return Tangent(positions[free], velocities[free], free % 3, csr_array(inertia[free][:, free]), *halves)


def _largest(matrix: Any) -> float:
    """The largest magnitude of an entry; 0 of an empty matrix."""
    return float(np.abs(matrix.data).max(initial=0.0))


def _inertia(system: System, floats: Floats) -> Any:
    """(m, m) [kg] inertia of the entries of all masses, in their order; 0 where they are fixed."""
    from scipy.sparse import block_diag, diags_array

    parts, matrices = [], dict(system.inertia)
    for velocity_at, inverse_at, count in system.masses:
        inverse = np.repeat(floats[inverse_at : inverse_at + count], 3)
        lumped = diags_array(np.divide(1.0, inverse, out=np.zeros(3 * count), where=inverse > 0.0))
        parts.append(matrices.get(velocity_at, lumped))
    return block_diag(parts, format="csr")


def _forces(system: System, floats: Floats) -> Any:
    """(m, m) matrix that converts the Jacobian's rows from accelerations to forces.

    Rows of consistent masses are forces.
    """
    from scipy.sparse import block_diag, eye_array

    matrices = dict(system.inertia)
    own = _inertia(system, floats)
    parts, at = [], 0
    for velocity_at, _, count in system.masses:
        part = slice(at, at + 3 * count)
        parts.append(eye_array(3 * count) if velocity_at in matrices else own[part][:, part])
        at += 3 * count
    return block_diag(parts, format="csr")


def _slopes(march: March, functions: Any, rest: Floats, t: float) -> Any:
    """(n, n) sparse Jacobian of the island at rest."""
    from scipy.sparse import coo_array

    pattern = march.system.pattern
    assert pattern is not None
    values = np.zeros(pattern.room)
    march.rate(t, rest)
    jacobian(march.system)(functions, t, rest, values, march.floats, march.system.ints)
    entries = (values[: pattern.count], (pattern.rows, pattern.columns))
    return coo_array(entries, (len(rest), len(rest))).tocsr()


def _refused(march: March, rest: Floats, times: Floats, message: str) -> LimitRefused:
    """The refusal, naming the first term whose response to two motions differs in time or is not symmetric."""
    system = march.system
    random = np.random.Generator(np.random.Philox(3))
    moving = np.flatnonzero(system.partner >= 0)
    size = MOVED * max(float(np.ptp(rest[moving])), 1e-3)
    ways = []
    for _ in range(2):
        way = np.zeros(len(rest))
        way[moving] = size * random.standard_normal(len(moving))
        way[system.partner[moving]] = size * random.standard_normal(len(moving))
        ways.append(way)
    changes = []
    for t in times.tolist():
        ends = [[_of_terms(march, t, rest + sign * way) for sign in (1.0, -1.0)] for way in ways]
        changes.append([high - low for high, low in ends])
    velocities = system.partner[moving]
    blamed = system.origin(int(velocities[0]))
    for k, origin in enumerate(system.terms):
        one, two = (change[k][velocities] for change in changes[0])
        apart = abs(float(one @ ways[1][moving] - two @ ways[0][moving]))
        apart = max([apart, *(float(np.abs((a[0] - b[0])[k]).max()) for a, b in pairwise(changes))])
        if apart > TELLS * max(float(np.abs(one).max()), 1e-300) * (size if len(times) == 1 else 1.0):
            blamed = origin
            break
    return LimitRefused(message.format(blamed.part), blamed.span, "let auto march it")


def _of_terms(march: March, t: float, y: Floats) -> Floats:
    """(terms, n) the part of each term in the rate."""
    system = march.system
    ints = system.ints.copy()
    count = len(system.terms)
    kernels = len(system.structure.terms)
    firsts = ints[layout.GROUPS_AT : layout.GROUPS_AT + kernels + 1].copy()
    before, found = np.zeros(len(y)), np.zeros((count, len(y)))
    for k in range(count):
        ints[layout.GROUPS_AT : layout.GROUPS_AT + kernels + 1] = np.minimum(firsts, firsts[0] + k + 1)
        rate = np.empty(len(y))
        march.driver.rate(t, y, rate, march.floats.copy(), ints)
        found[k], before = rate - before, rate
    return found
