"""Whether ties are singular at the start: motions that they leave to first order they forbid to second, all of these or
some."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.bodies.rigid.tie_system import MOST, integers
from sceneql.system import Led, Place

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Tied

DEPENDENT = 1e-9
"""Singular value, in parts of the largest, of rows that the others imply."""
FORBIDDEN = 1e-6
"""Part of the acceleration by speeds that such rows ask for and nothing gives."""
TRIES = 32
"""Velocities that are tried, of those that ties leave."""


def singular(assembly: Assembly) -> tuple[list[Tied], list[Tied]]:
    """The ties that hold each other in a singular position at the start: that nothing leaves, as a taut chain; and that
    is left in more than one way, as by a parallelogram folded flat.

    Rows that others imply have forces s that hold each other, J^T s = 0. With a velocity v that all rows leave,
    J v = 0, accelerations must meet J a + bias(v) = 0: there are none unless s . bias(v) = 0 (Pellegrino & Calladine
    1986). Where this takes both signs, velocities between these go on.
    """
    import numpy as np

    from sceneql.bodies.rigid.tie_kernels import survey
    from sceneql.bodies.rigid.tie_rows_kernels import AT_BIAS, AT_J, ROW

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
    """The state at the start, of bodies that move at these velocities and angular velocities (6 each)."""
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
