"""Detection of singular ties at the start: motions that they allow to first order but forbid to second order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.bodies.rigid.ties.tie_system import MOST, integers
from sceneql.system import Led, Place

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Tied

DEPENDENT = 1e-9
"""Singular value of the constraint Jacobian, relative to the largest, below which rows are dependent."""
FORBIDDEN = 1e-6
"""Part of the velocity-dependent acceleration, relative to all of it, that counts as infeasible."""
TRIES = 32
"""Random velocities that are tried, among those that the ties allow."""


def singular(assembly: Assembly) -> tuple[list[Tied], list[Tied]]:
    """Ties in a singular position at the start: (those that cannot leave it, those that can in more than one way).

    Examples: a taut chain, a parallelogram folded flat. Dependent rows have self-stresses s, J^T s = 0. For a velocity
    v that all rows allow, J v = 0, the acceleration a must satisfy J a + bias(v) = 0, which has no solution unless
    s . bias(v) = 0 (Pellegrino & Calladine 1986). Where this product takes both signs, it vanishes for some velocities
    in between, and the mechanism can move. No ties where a body has a prescribed motion, or rows exceed MOST.
    """
    import numpy as np

    from sceneql.bodies.rigid.ties.tie_kernels import survey
    from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_BIAS, AT_J, ROW

    rows = [(tie, k) for tie in assembly.ties for k in range(len(tie.rows))]
    if not 0 < len(rows) <= MOST or any(isinstance(mover, Led) for tie in assembly.ties for mover in tie.movers):
        return [], []
    numbers, ints = assembly.numbers(), np.array(assembly.tie_ints)
    bodies: dict[tuple[int, ...], tuple[int, Place]] = {}
    for tie in assembly.ties:
        for mover in tie.movers:
            if isinstance(mover, Place) and numbers[mover.ints[3]] > 0.0:
                bodies.setdefault(integers(mover), (6 * len(bodies), mover))
    survey(0.0, _moving(assembly, bodies, np.zeros(6 * len(bodies))), numbers, ints)
    whole = np.zeros((len(rows), 6 * len(bodies)))
    for row, (tie, k) in enumerate(rows):
        for side, mover in enumerate(tie.movers):
            at, place = bodies.get(integers(mover), (-1, None))
            if place is not None:
                wide = 6 if place.bodies.turning is not None else 3
                first = tie.scratch_at + ROW * k + AT_J + 6 * side
                whole[row, at : at + wide] += numbers[first : first + wide]
    left, values, right = np.linalg.svd(whole)
    rank = int(np.count_nonzero(values > DEPENDENT * values.max(initial=0.0)))
    forces, free = left[:, rank:], right[rank:]
    if forces.shape[1] == 0 or len(free) == 0:
        return [], []
    random = np.random.default_rng(0)
    least, most = np.zeros(len(rows)), np.zeros(len(rows))
    for _ in range(TRIES):
        survey(0.0, _moving(assembly, bodies, random.normal(size=len(free)) @ free), numbers, ints)
        bias = np.array([numbers[tie.scratch_at + ROW * k + AT_BIAS] for tie, k in rows])
        missing = forces @ (forces.T @ bias)
        if np.linalg.norm(missing) > FORBIDDEN * np.linalg.norm(bias):
            least, most = np.minimum(least, missing), np.maximum(most, missing)
    size: Floats = np.maximum(-least, most)
    acts = size > 0.1 * size.max()
    held = {rows[k][0].name: rows[k][0] for k in np.flatnonzero(acts)}
    both = {rows[k][0].name for k in np.flatnonzero(acts & (np.minimum(-least, most) > FORBIDDEN * size))}
    return (
        [tie for name, tie in held.items() if name not in both],
        [tie for name, tie in held.items() if name in both],
    )


def _moving(assembly: Assembly, bodies: dict[tuple[int, ...], tuple[int, Place]], speeds: Floats) -> Floats:
    """The state at the start with the bodies' velocities and angular velocities replaced by ``speeds`` (6 a body)."""
    import numpy as np

    from sceneql.bodies.rigid.turning import unpacked
    from sceneql.shapes.placement import rotation_matrix

    y: Floats = assembly.start().copy()
    numbers = assembly.numbers()
    for at, place in bodies.values():
        _, velocity, _, _, rotation, momentum, inverse, _ = place.ints
        y[velocity : velocity + 3] = speeds[at : at + 3]
        if rotation >= 0:
            turn = rotation_matrix(y[rotation : rotation + 4])
            inertia = turn @ np.linalg.inv(unpacked(numbers[inverse : inverse + 6])) @ turn.T
            y[momentum : momentum + 3] = inertia @ speeds[at + 3 : at + 6]
    return y
