"""Ties in the velocity step of contacts: the bodies that they add, their rows in the cone program, kernel integers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.bodies.rigid.ties.tie_system import integers
from sceneql.system import Place

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, Drive, Mover, Tied

OFTEN = 1 / 240
"""Longest step [s] that an adaptive solver takes."""
FOLLOWS = ("nothing", "speed", "place")
"""Targets of a motor, in the order of the kernel's numbers."""


@dataclass(frozen=True, slots=True)
class TiedStep:
    """Bodies and constraint rows of the ties in a velocity step."""

    bodies: list[tuple[int, ...]]
    """Integers of all bodies (velocity_step_kernels): the given ones first, then those that ties add."""
    pairs: list[tuple[int, int]]
    """The two bodies of each row, the smaller number first; -1 for a fixed one or one with prescribed motion."""
    joined: list[tuple[int, int]]
    """Pairs of position offsets of the bodies that a tie joins."""
    _ties: tuple[int, ...]
    _sides: list[int]
    _groups: list[int]
    _movers: list[int]
    _always: list[int]
    _drives: list[tuple[int, ...]]
    _first: bool

    def ints(self, assembly: Assembly) -> list[int]:
        """The integers that tied_rows_kernels read."""
        import numpy as np

        from sceneql.bodies.rigid.moved_bodies_kernels import HEAD

        bodies = [body for pair in self.pairs for body in pair]
        drives = [k for drive in self._drives for k in drive]
        lists = [self._sides, self._groups, self._movers, self._always, drives, bodies]
        begins = np.cumsum([HEAD, *(len(some) for some in lists)]).tolist()
        sides_at, groups_at, movers_at, always_at, drives_at, bodies_at, ties_at = begins
        active = assembly.floats(np.zeros(len(self._always)))
        head = [ties_at, len(self._ties), sides_at, groups_at, movers_at, len(self._always), always_at]
        head += [len(self._drives), drives_at, active, bodies_at, len(self.pairs), int(self._first)]
        return [*head, *(number for some in lists for number in some), *self._ties]


def moves(mover: Mover, assembly: Assembly) -> bool:
    """Whether a mover is a body or mass that forces accelerate."""
    return isinstance(mover, Place) and float(assembly.numbers()[mover.bodies.inverse_at + mover.body]) > 0.0


def body_integers(bodies: Bodies, k: int, assembly: Assembly) -> tuple[int, ...]:
    """The integers of body k, which is not fixed (velocity_step_kernels)."""
    import numpy as np

    from sceneql.bodies.rigid.turning import packed, unpacked

    x, v, turning, numbers = bodies.position_at + 3 * k, bodies.velocity_at + 3 * k, bodies.turning, assembly.numbers()
    if turning is None:  # a point mass does not rotate: any inertia will do
        inertia = numbers[bodies.mass_at + k] * np.eye(3)
        return (x, v, -1, -1, bodies.mass_at + k, assembly.floats(packed(inertia)), bodies.work_at)
    inertia = np.asarray(np.linalg.inv(unpacked(numbers[turning.inverse_at + 6 * k :][:6])))
    q, momentum = turning.rotation_at + 4 * k, turning.momentum_at + 3 * k
    return (x, v, q, momentum, bodies.mass_at + k, assembly.floats(packed(inertia)), bodies.work_at)


def tied_step(assembly: Assembly, bodies: Sequence[tuple[int, ...]], drives: bool) -> TiedStep | None:
    """The ties of the given bodies and of all bodies connected with them by ties; None where there are none.

    ``bodies``: by their integers. With ``drives`` also the bodies connected with limits, motors or friction, and the
    rows of these.
    """
    ties = assembly.ties
    root: dict[int, int] = {}

    def find(x: int) -> int:
        while root[x] != x:
            x = root[x]
        return x

    places: dict[int, Place] = {}
    for tie in ties:
        ends = [mover for mover in tie.movers if moves(mover, assembly)]
        for mover in ends:
            assert isinstance(mover, Place)
            places.setdefault(mover.ints[0], mover)
            root.setdefault(mover.ints[0], mover.ints[0])
        if len(ends) == 2:
            one, other = (find(integers(mover)[0]) for mover in ends)
            root[other] = one
    wanted = {find(row[0]) for row in bodies if row[0] in root}
    if drives:
        wanted |= {find(integers(m)[0]) for tie in ties if tie.drive for m in tie.movers if moves(m, assembly)}
    if not wanted:
        return None
    rows = list(bodies)
    known = {row[0]: k for k, row in enumerate(rows)}
    for x, place in places.items():
        if find(x) in wanted and x not in known:
            known[x] = len(rows)
            rows.append(body_integers(place.bodies, place.body, assembly))
    names = {g: k for k, g in enumerate(sorted(wanted))}
    groups = [names[find(row[0])] if row[0] in root else -1 for row in rows]
    always = [0] * len(names)
    numbers: dict[tuple[int, ...], int] = {}
    for tie in ties:
        for mover in tie.movers:
            numbers.setdefault(integers(mover), len(numbers))
    body_movers = [-1] * len(rows)
    for which, number in numbers.items():
        if which[0] in known:
            body_movers[known[which[0]]] = number

    def side(tie: Tied) -> tuple[tuple[int, int], tuple[int, int]]:
        """(numbers of the two bodies of a tie in order, (group, 1 where the order is reversed))."""
        one, other = (known.get(integers(mover)[0], -1) for mover in tie.movers)
        flipped = one < 0 or (0 <= other < one)
        pair = (other, one) if flipped else (one, other)
        return pair, (groups[pair[0]] if pair[0] >= 0 else -1, int(flipped))

    pairs: list[tuple[int, int]] = []
    sides: list[int] = []
    for tie in ties:
        pair, more = side(tie)
        pairs += [pair] * len(tie.rows)
        sides += len(tie.rows) * more
    found = []
    for tie in ties:
        pair, (group, flipped) = side(tie)
        if drives and tie.drive is not None and group >= 0:
            found.append((*drive_integers(tie.drive), group, flipped))
            pairs += [pair] * 4
            always[group] |= int(tie.drive.always)
    joined = [tuple(sorted(integers(mover)[0] for mover in tie.movers)) for tie in ties]
    both = [(one, other) for one, other in joined if one >= 0]
    return TiedStep(rows, pairs, both, assembly.tie_ints, sides, groups, body_movers, always, found, drives)


def drive_integers(drive: Drive) -> tuple[int, ...]:
    """The integers of limits, motor and friction (drive_kernels)."""
    follows = FOLLOWS.index(drive.follows)
    motor = (follows, drive.target_at, drive.most_at, drive.settling_at, drive.reached_at)
    return (*drive.along, drive.limits_at, drive.restitution_at, *motor, drive.friction_at, drive.effort_at)


def add_bounded_step(assembly: Assembly) -> None:
    """Add limits, motors and friction of ties as a velocity step, for an island whose rigid bodies have no contacts."""
    from sceneql.bodies.rigid.bounded_step_kernels import HEAD

    step = tied_step(assembly, (), True)
    if step is None:
        return
    bodies = [number for body in step.bodies for number in body]
    own = step.ints(assembly)
    head = [len(step.bodies), HEAD, HEAD + len(bodies), len(own)]
    assembly.step_at_most(OFTEN)
    kernel = "sceneql.bodies.rigid.bounded_step_kernels:back_off"
    assembly.contact("local", (kernel,), [int(number) for number in (*head, *bodies, *own)], 0)
