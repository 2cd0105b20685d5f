"""Contacts of rigid bodies in mode `exact`: shapes, movers and ties of an island as arrays for the kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

from sceneql.contacts.distance.rigid_contact import place_of
from sceneql.kinds import Ref, Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Number
from sceneql.system import Place

if TYPE_CHECKING:
    from sceneql.contacts.distance.convex import Convex
    from sceneql.contacts.distance.rigid_masses import Masses
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, Led

ROOM = "sceneql.contacts.rigid_exact"
HOLD, SETTLE = f"{ROOM}.exact_hold_kernels:hold", f"{ROOM}.exact_hold_kernels:settle"
CONTACTS = f"{ROOM}.watch_kernels:gap", f"{ROOM}.strike_kernels:impact"
MOST = 24
"""Largest number of bodies: all their conditions form one dense system."""
ADVICE = "`mode: local` takes what jams or tumbles without end"
"""Help of the message for a contact that cannot go on."""
MOST_DRIVEN = 8
"""Largest number of bodies on ties that touch nothing."""
FEW = 8
"""Contacts that storage is reserved for: this many per body, and this many more."""


def assemble(
    assembly: Assembly,
    everyone: Sequence[Bodies],
    others: Sequence[Ref],
    restitution: Value,
    friction: Value,
    rolling: Value,
    masses: Masses | None = None,
    *,
    gives_way: bool = False,
) -> tuple[int, ...]:
    """Add the exact contacts of rigid bodies, and of masses with them; returns the integers that outputs read.

    ``gives_way``: whether another mode takes over after this one fails or exceeds its share of work.

    Raises ScriptError for an unsupported shape, for bodies that start inside each other, for too many bodies.
    """
    import numpy as np

    from sceneql.bodies.rigid.tie_rows_kernels import MOVED, POSITION
    from sceneql.bodies.rigid.tie_rows_kernels import ROW as TIE_ROW
    from sceneql.bodies.rigid.tie_system import integers
    from sceneql.contacts.distance import convex
    from sceneql.contacts.rigid_exact import (
        contact_kernels,
        curved_find_kernels,
        energy_made_kernels,
        exact_law_kernels,
    )
    from sceneql.contacts.rigid_exact import exact_rows_kernels as rows
    from sceneql.contacts.rigid_exact.curved import axis_of
    from sceneql.contacts.rigid_exact.drives import drives_of
    from sceneql.contacts.rigid_exact.exact_shapes import comes_first, joined_fields
    from sceneql.contacts.rigid_exact.stop_kernels import DRIVEN

    if assembly.ints_of(HOLD):
        message = "bodies in mode `exact` collide by one `collision` an island: its contacts are solved together"
        raise ScriptError([Diagnostic("invalid", message, assembly.line(), "name all that collide in one `between`")])
    found = _shapes(assembly, everyone, others, masses) if everyone or others else Touching([], [], [], set())
    n = len(found.moving)
    if n > MOST:
        message = f"{n} rigid bodies are too many for contacts in mode `exact`: at most {MOST}"
        raise ScriptError([Diagnostic("invalid", message, assembly.line(), "`mode: local` takes more")])
    movers: list[tuple[int, ...]] = []
    works: list[int] = []
    for bodies, k in found.moving:
        movers.append(integers(Place(bodies, k)))
        works.append(bodies.work_at)
    for place, led in found.standing:
        if led is not None:
            movers.append(integers(led))
            works.append(-1)
            continue
        at = assembly.floats([*place, *(0.0 for _ in range(12))])
        movers.append((*(6 * (-1,)), at, at + 3, at + 7, at + 10, at + 13, at + 16))
        works.append(-1)
    tied, ties = _tied(assembly, movers, works, TIE_ROW, integers, POSITION)
    drives, drive_ints = drives_of(assembly, movers, works)
    count = len(found.shapes)
    pairs = [
        (b, a) if comes_first(found.shapes[b], found.shapes[a]) else (a, b)
        for a in range(n)
        for b in range(a + 1, count)
        if (a, b) not in found.joined and not (found.is_mass(a) and found.is_mass(b))
    ]
    most = FEW * n + FEW
    never = rolling.constant and rolling.number() == 0.0
    room = len(tied) + (3 if never else 6) * most + 2 * len(drives)
    spots = len(pairs) + 2 * len(drives)
    length = convex.room_length(found.shapes)
    moved, places, begun = (
        assembly.floats(np.zeros(size)) for size in ((MOVED + 12) * len(movers), 7 * count, 7 * count)
    )
    working = assembly.floats(np.zeros(length + 12))
    records = assembly.floats(np.zeros((2 * most + 1) * contact_kernels.RECORD + 1))
    units = assembly.floats(np.zeros(rows.UNIT * room))
    dense = assembly.floats(np.zeros(2 * room * room + (10 + exact_law_kernels.VECTORS) * room + 2))
    kept = assembly.floats(np.zeros(4 * spots))
    driven = assembly.floats(np.reshape(drives, len(drives) * DRIVEN))
    account = energy_made_kernels.ROOM + energy_made_kernels.EACH * len(movers)
    memory = assembly.floats([0.0] * rows.BOUNDED + [float(gives_way)] + [0.0] * account)
    assembly.gives_way = assembly.gives_way or gives_way
    outputs = [assembly.floats([0.0]), *(assembly.floats(np.zeros(3 * most)) for _ in range(3))]
    nan = float("nan")
    tally = assembly.floats([0.0, nan, nan, 0.0, nan])
    whole = [*found.shapes, *map(axis_of, found.shapes)]
    data = assembly.floats(convex.joined(whole, 0, 0)[0])
    numbers, shapes = joined_fields(whole, data, rows.HEAD)
    assembly.write(data, numbers)
    lists = [
        shapes.tolist(),
        list(chain(*movers)),
        list(chain(*pairs)),
        list(ties),
        list(chain(*tied)),
        [0] * (6 * room + len(movers) + most),
        works,
        [0] * (2 * curved_find_kernels.WHO),
        [0] * (len(drives) + 1),
    ]
    *begins, who_at, drives_at, at = np.cumsum([rows.HEAD, *(len(some) for some in lists)]).tolist()
    lists[-1][:] = np.cumsum([at, *(len(each) for each in drive_ints)]).tolist()
    lists += drive_ints
    head = [len(movers), count, n, len(pairs), len(tied), most, len(ties), length, *begins]
    head += [moved, places, begun, working, records, units, dense, kept, memory]
    head += [assembly.value(restitution), assembly.value(friction), assembly.value(rolling), *outputs, tally, who_at]
    head += [len(drives), drives_at, driven, room]
    ints = [int(number) for number in chain(head, *lists)]
    watched = spots + rows.WATCHED * most + 2 * len(drives)
    assembly.contact("exact", CONTACTS, ints, watched, help=ADVICE)
    assembly.term("tie", HOLD, ints)
    assembly.after_step(SETTLE, ints, samples=True)
    return (
        tally,
        -1,
        *outputs,
        memory + rows.LOOSE,
        memory + rows.CROWDED,
        -2,
        memory + rows.JAMMED,
    )


def assemble_drives(assembly: Assembly) -> bool:
    """Add stops, motors and friction of the ties of few bodies that touch nothing; returns whether it takes them.

    It takes them where the solver chooses its steps by a tolerance and is explicit, up to the instant at which it finds
    no way. The reason is kept for `explain`.
    """
    from sceneql.bodies.rigid.tie_system import integers
    from sceneql.bodies.rigid.tied_step import moves

    held = {integers(mover) for tie in assembly.ties for mover in tie.movers if moves(mover, assembly)}
    none, why = Value(Number(0.0)), ""
    if assembly.went_on:
        since = next(iter(assembly.went_on.values())).t
        why = f"what is left of the run from {since:.6g} s on, where `exact` found no way"
    elif len(held) > MOST_DRIVEN:
        why = f"more than {MOST_DRIVEN} bodies are tied"
    elif not assembly.by_tolerance:
        why = "`exact` locates events in steps that a tolerance chooses, of an explicit method"
    else:
        try:
            assemble(assembly, (), (), none, none, none, gives_way=True)
        except ScriptError as refused:  # a motor that follows what has no known rate, or jumps
            why = refused.diagnostics[0].message
    assembly.contact_why = why or f"chosen for up to {MOST_DRIVEN} bodies; `local` goes on where it finds no way"
    return not why


@dataclass(frozen=True, slots=True)
class Touching:
    """Shapes and bodies of an exact contact."""

    shapes: list[Convex]
    """Shapes of the moving bodies, then of fixed and led ones."""
    moving: list[tuple[Bodies, int]]
    """Moving bodies: their model, and their number in it."""
    standing: list[tuple[Floats, Led | None]]
    """Position and quaternion (7,) of each fixed or led shape at the start, and its given motion or None."""
    joined: set[tuple[int, int]]
    """Pairs of bodies joined by a tie, which do not touch each other."""

    def is_mass(self, number: int) -> bool:
        """Whether a shape is a mass; contacts among masses belong to `mutual_collision`."""
        return number < len(self.moving) and self.moving[number][0].turning is None


def _shapes(
    assembly: Assembly, everyone: Sequence[Bodies], others: Sequence[Ref], masses: Masses | None = None
) -> Touching:
    """Shapes of a contact. Raises ScriptError for an unsupported one, or one that starts inside another."""
    import numpy as np

    from sceneql.contacts.distance.rigid_shapes import Shapes
    from sceneql.contacts.rigid_exact.exact_shapes import apart_exactly, exact_shape, led_by, point, upright

    numbers, start, known = assembly.numbers(), assembly.start(), Shapes(assembly)
    moving: list[tuple[Bodies, int]] = []
    solid: list[tuple[Convex, Floats, Ref | str]] = []
    fixed: list[tuple[Convex, Floats, Ref | str]] = []
    for bodies in everyone:
        assert bodies.turning is not None
        model: Any = assembly.object(Ref(bodies.model))
        for k, (ref, center) in enumerate(model.solids()):
            x, q = bodies.position_at + 3 * k, bodies.turning.rotation_at + 4 * k
            one = (
                exact_shape(ref, center, None, known, assembly),
                np.concatenate([start[x : x + 3], start[q : q + 4]]),
                ref,
            )
            if numbers[bodies.inverse_at + k] == 0.0:
                fixed.append(one)
            else:
                moving.append((bodies, k))
                solid.append(one)
    leds: list[Led | None] = [None] * len(fixed)
    smallest = min((shape.reach for shape, *_ in solid), default=1.0)
    thickness = 0.0 if masses is None else masses.thickness
    for bodies in () if masses is None else masses.everyone:
        for k in range(bodies.count):
            x = start[bodies.position_at + 3 * k :][:3]
            moving.append((bodies, k))
            ball = point(float(numbers[bodies.radius_at + k]) + thickness, smallest)
            solid.append((ball, upright(x), f"mass {k} of '{bodies.model}'"))
    for ref in others:
        place = place_of(ref, assembly)
        fixed.append((exact_shape(ref, np.zeros(3), place, known, assembly), place, ref))
        leds.append(led_by(ref, assembly))
    shapes, places, names = (list(some) for some in zip(*solid, *fixed, strict=True))
    numbered = {bodies.position_at + 3 * k: number for number, (bodies, k) in enumerate(moving)}
    sides = [
        [numbered.get(mover.ints[0], -1) if isinstance(mover, Place) else -1 for mover in tie.movers]
        for tie in assembly.ties
    ]
    joined = {(min(pair), max(pair)) for pair in sides}
    apart_exactly(known, shapes, places, len(moving), names, joined, assembly)
    standing = list(zip((place for _, place, _ in fixed), leds, strict=True))
    return Touching(shapes, moving, standing, joined)


def _tied(
    assembly: Assembly, movers: list[tuple[int, ...]], works: list[int], row: int, integers: Any, position: int
) -> tuple[list[tuple[int, int, int]], tuple[int, ...]]:
    """Both movers and offset of floats of each row of the island's ties, and the integers of all ties.

    Adds the tied bodies to ``movers`` and ``works``.
    """
    from sceneql.contacts.rigid_exact.drives import work_of

    rows = []
    for tie in assembly.ties:
        sides = []
        for mover in tie.movers:
            one = integers(mover)
            if one not in movers:
                movers.append(one)
                works.append(work_of(mover))
            sides.append(movers.index(one))
        rows += [(sides[0], sides[1], tie.scratch_at + row * k) for k in range(len(tie.rows))]
    return rows, assembly.tie_ints if rows else ()
