"""Fluxes of a drift through the faces of cells, from velocity or stream function, made divergence-free if asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.failure import LimitRefused
from sceneql.quantities.derivative import components
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.domain.boundary import Condition
    from sceneql.grids.domain.cells import Cells
    from sceneql.grids.drift import Drift
    from sceneql.kinds import Formula

LARGEST_FACTORED = {2: 300_000, 3: 20_000}
"""Most cells of a 2D or 3D grid for which the projection's matrix is factored; larger ones are solved iteratively."""
SMALL = 1e-12
"""Divergence that counts as rounding, relative to the largest flux through a face."""
ROUNDS = 2
"""Number of projections; the second removes the first one's rounding errors, which matter in small cells."""
UNBALANCED = 1e-6
"""Largest relative imbalance of the fluxes through a boundary: it arises from sampling a velocity at faces."""


@dataclass(frozen=True, slots=True, eq=False)
class Flow:
    """Volume fluxes [m^3/s] of a drift of strength 1."""

    axes: tuple[Floats, ...]
    """For each axis (cells,), through the low face of each cell."""
    through: tuple[Floats, ...]
    """For each boundary condition (m,), outward through its faces."""

    def outward(self, cells: Cells, conditions: list[Condition]) -> Floats:
        """Net outflow (cells,) [m^3/s] of each cell."""
        total = np.zeros(len(cells.volumes))
        for axis, flow in enumerate(self.axes):
            total += np.roll(flow.reshape(cells.shape[::-1]), -1, axis=2 - axis).ravel() - flow
        for one, flow in zip(conditions, self.through, strict=True):
            np.add.at(total, one.cells, flow)
        return total


def flow_of(
    drift: Drift, cells: Cells, ties: list[Floats], conditions: list[Condition], periodic: tuple[bool, ...]
) -> Flow:
    """The fluxes of a drift; ``ties``: for each axis area over distance (cells,) of the low faces.

    They cross the boundary where a condition has ``through``. Raises ScriptError for a drift that is not finite, or one
    that cannot be made divergence-free because inflow and outflow through the boundary do not balance.
    """
    found = _given(drift, cells, ties, conditions)
    formula = drift.formula
    if not all(np.isfinite(flow).all() for flow in (*found.axes, *found.through)):
        raise ScriptError([Diagnostic("not-finite", "the drift is not finite everywhere", formula.span)])
    if not drift.incompressible:
        return found
    largest = max((np.abs(flow).max(initial=0.0) for flow in (*found.axes, *found.through)), default=0.0)
    divergence = found.outward(cells, conditions)
    if np.abs(divergence).max(initial=0.0) <= SMALL * largest:
        return found
    return _projected(found, divergence, cells, ties, conditions, formula)


def _given(drift: Drift, cells: Cells, ties: list[Floats], conditions: list[Condition]) -> Flow:
    centers = cells.centers()
    if cells.flat:
        centers[:, 2] = 0.0
    axes = []
    for axis, tie in enumerate(ties):
        faces = centers.copy()
        faces[:, axis] -= 0.5 * cells.spacing[axis]
        outward = np.zeros_like(faces)
        outward[:, axis] = 1.0
        areas = tie * cells.spacing[axis]
        width = cells.spacing[1 - axis] if cells.flat else 1.0
        axes.append(_through(drift, faces, outward, areas, np.full(len(areas), width)))
    through = []
    for one in conditions:
        width = one.areas / cells.spacing[2] if cells.flat else np.ones(len(one.areas))
        flow = _through(drift, one.points, one.outward, one.areas, width)
        through.append(flow if one.through else np.zeros(len(one.cells)))
    return Flow(tuple(axes), tuple(through))


def _through(drift: Drift, points: Floats, outward: Floats, areas: Floats, widths: Floats) -> Floats:
    """Fluxes (k,) through faces: by the velocity at their points, or by the stream function at their ends."""
    if drift.stream_function is not None:
        side = 0.5 * widths[:, None] * np.column_stack([-outward[:, 1], outward[:, 0], np.zeros(len(points))])
        (ahead,) = _at(drift.stream_function, points + side)
        (behind,) = _at(drift.stream_function, points - side)
        speed = (ahead - behind) / widths
    else:
        assert drift.velocity is not None
        parts = _at(drift.velocity, points)
        speed = np.sum([part * outward[:, axis] for axis, part in enumerate(parts)], axis=0)
    flow: Floats = np.where(areas > 0.0, areas * np.where(areas > 0.0, speed, 0.0), 0.0)
    return flow


def _at(formula: Formula, points: Floats) -> list[Floats]:
    """The components of a formula at points (k, 3), each (k,)."""
    known = dict(zip("xyz", points.T, strict=True))

    def look_up(node: Any) -> Any:
        return known[node.name]

    with np.errstate(all="ignore"):
        parts = [evaluate(part, look_up, arrays=True) for part in components(formula.expr)]
    return [np.broadcast_to(np.asarray(part, dtype=float), len(points)) for part in parts]


def _projected(
    given: Flow, divergence: Floats, cells: Cells, ties: list[Floats], conditions: list[Condition], formula: Formula
) -> Flow:
    """The nearest divergence-free fluxes, by projection (Chorin 1968).

    The gradient of a potential is subtracted; the potential is 0 on open boundaries, where the flow is free.
    """
    from scipy.sparse import csr_array, diags_array
    from scipy.sparse.csgraph import connected_components
    from scipy.sparse.linalg import cg, splu

    n = len(cells.volumes)
    index = np.arange(n).reshape(cells.shape[::-1])
    befores = [np.roll(index, 1, axis=2 - axis).ravel() for axis in range(len(ties))]
    rows = np.concatenate([index.ravel(), *(part for before in befores for part in (index.ravel(), before))])
    columns = np.concatenate([index.ravel(), *(part for before in befores for part in (before, index.ravel()))])
    diagonal = np.zeros(n)
    for before, tie in zip(befores, ties, strict=True):
        diagonal += tie
        np.add.at(diagonal, before, tie)
    for one in conditions:
        if one.open:
            np.add.at(diagonal, one.cells, one.areas / one.distances)
    values = np.concatenate([diagonal, *(-tie for tie in ties for _ in range(2))])
    matrix = csr_array((values, (rows, columns)), shape=(n, n))
    matrix.eliminate_zeros()
    count, piece = connected_components(matrix, directed=False)
    freed = np.zeros(count, dtype=bool)
    for one in conditions:
        if one.open:
            freed[piece[one.cells]] = True
    left = np.bincount(piece, weights=divergence, minlength=count)
    scale = sum(float(np.abs(flow).sum()) for flow in given.through)
    if np.any(~freed & (np.abs(left) > UNBALANCED * scale + SMALL * float(np.abs(divergence).sum()))):
        text = "what the drift brings in through the boundary does not leave: an incompressible flow needs a way out"
        help = "give a part of the boundary `open: yes`, or take the drift as it is by `incompressible: no`"
        raise ScriptError([Diagnostic("no-way-out", text, formula.span, help)])
    _, firsts = np.unique(piece, return_index=True)
    held = np.zeros(n)
    held[firsts[~freed]] = diagonal[firsts[~freed]]
    inside = np.flatnonzero(diagonal > 0.0)
    matrix = (matrix + diags_array(held))[inside][:, inside].tocsc()
    if len(inside) <= LARGEST_FACTORED[2 if cells.flat else 3]:
        solved = splu(matrix).solve
    else:
        scaled = diags_array(1.0 / matrix.diagonal())

        def solved(target: Floats) -> Floats:
            potential: Floats
            potential, missed = cg(matrix, target, rtol=1e-12, maxiter=20_000, M=scaled)
            if missed:
                text = "the drift could not be made free of divergence on so many cells"
                raise LimitRefused(text, formula.span, "take larger cells, or the drift as it is: `incompressible: no`")
            return potential

    def solve(target: Floats) -> Floats:
        potential = np.zeros(n)
        potential[inside] = solved(target[inside])
        return potential

    found = given
    for _ in range(ROUNDS):
        potential = solve(np.where(freed, 0.0, left / np.bincount(piece, minlength=count))[piece] - divergence)
        found = _less(found, potential, befores, ties, conditions)
        divergence, left = found.outward(cells, conditions), np.zeros(count)
    return found


def _less(flow: Flow, potential: Floats, befores: list[Any], ties: list[Floats], conditions: list[Condition]) -> Flow:
    """Fluxes minus those of the gradient of a potential (cells,)."""
    axes = tuple(
        one - tie * (potential - potential[before]) for one, tie, before in zip(flow.axes, ties, befores, strict=True)
    )
    through = tuple(
        one + condition.areas / condition.distances * potential[condition.cells] if condition.open else one
        for one, condition in zip(flow.through, conditions, strict=True)
    )
    return Flow(axes, through)
