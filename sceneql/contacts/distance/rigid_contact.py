"""Contacts of rigid bodies with one another and with objects: shapes, and the kernel's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from sceneql.contacts.distance import led
from sceneql.contacts.distance.rigid_masses import Solid
from sceneql.kinds import Object, Ref, Value
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError

if TYPE_CHECKING:
    from sceneql.contacts.distance.convex import Convex
    from sceneql.contacts.distance.rigid_masses import Masses
    from sceneql.contacts.distance.rigid_shapes import Shapes
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies

CONTACTS = 24
"""Contacts per body whose forces are kept for outputs and for the next step."""
DEEP = 1e-6
"""Depth, relative to a body's size, to which it may start inside another: rounding in a script."""
KERNEL = "sceneql.contacts.distance.rigid_local_kernels:back_off"
ANSWERS = ("sceneql.bodies.rigid.groups_kernels", "sceneql.bodies.rigid.moved_bodies_kernels")
"""The modules of kernels that find the forces of contacts, and move by them."""


def assemble(
    assembly: Assembly,
    everyone: Sequence[Bodies],
    others: Sequence[Ref],
    restitution: Value,
    friction: Value,
    rolling: Value,
    masses: Masses | None = None,
) -> tuple[int, ...]:
    """Add the contacts of rigid bodies.

    Returns the offsets of count, points, normals, forces, and of the numbers of loose and crowded steps.
    Raises ScriptError for a shape that is not supported, and for bodies that start inside each other.
    """
    import numpy as np

    from sceneql.compiled.compile_beside import compile_beside

    compile_beside(ANSWERS)  # while what finds contacts is compiled here

    from sceneql.bodies.rigid.point_list import WHO
    from sceneql.bodies.rigid.ties.tied_step import body_integers, tied_step
    from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS
    from sceneql.contacts.distance import convex, rigid_layout
    from sceneql.contacts.distance.depths import Overlaps
    from sceneql.contacts.distance.rigid_rows_kernels import PLACE
    from sceneql.contacts.distance.rigid_shapes import Shapes

    numbers, known, shapes, fixed, rows, still = assembly.numbers(), Shapes(assembly), [], [], [], []
    leads: list[tuple[int, ...]] = []
    moving: list[tuple[Ref | None, Floats]] = []
    standing: list[Ref | None] = []
    centers: list[Floats] = []
    start = assembly.start()
    for bodies in everyone:
        turning = bodies.turning
        assert turning is not None
        model: Any = assembly.object(Ref(bodies.model))
        for k, (ref, center) in enumerate(model.solids()):
            shape = known.of(ref, center)
            x, q = bodies.position_at + 3 * k, turning.rotation_at + 4 * k
            place = np.concatenate([start[x : x + 3], start[q : q + 4]])
            if numbers[bodies.inverse_at + k] == 0.0:
                fixed.append((shape, place))
                standing.append(ref)
                centers.append(center)
                still.append(x)
                continue
            centers.insert(len(moving), center)
            moving.append((ref, place))
            rows.append(body_integers(bodies, k, assembly))
            shapes.append(shape)
    for ref in others:
        place = place_of(ref, assembly)
        shape = known.of(ref, np.zeros(3), place)
        kind: Any = assembly.object(ref)
        if led.is_led(kind):
            leads.append((len(fixed), *led.lead(ref, kind, place, assembly)))
        fixed.append((shape, place))
        standing.append(ref)
        centers.append(np.zeros(3))
    r = len(rows)
    points = [] if masses is None else masses.rows(assembly)
    rows, n = [*rows, *points], r + len(points)
    leads = [(n + first, *rest) for first, *rest in leads]
    real = [*shapes, *(shape for shape, _ in fixed)]
    everything = [*shapes, *(convex.mass() for _ in points), *(shape for shape, _ in fixed)]
    count, most = len(everything), CONTACTS * r + 64 + 2 * len(points)
    places = np.zeros((count, PLACE))
    for k, (_, place) in enumerate(fixed):
        places[n + k] = place
    names = [*(ref for ref, _ in moving), *standing]
    ties = tied_step(assembly, rows, not assembly.driven)
    shape_of = {at: k for k, at in enumerate([*(row[0] for row in rows[:r]), *still])}
    between = [] if ties is None else [[shape_of.get(at, -1) for at in pair] for pair in ties.joined]
    joined = {(min(pair), max(pair)) for pair in between if min(pair) >= 0}
    starts = [*(place for _, place in moving), *(place for _, place in fixed)]
    must_be_apart(known, real, starts, r, names, joined, assembly)
    joined = {(a, b if b < r else b + len(points)) for a, b in joined}
    held = []
    if ties is not None:
        assembly.driven, rows, held = True, ties.bodies, ties.ints(assembly)
    room = convex.room_length(everything)
    places_at = assembly.floats(places)
    room_at, kept_at = (assembly.floats(np.zeros(size)) for size in (room, 3 * most))
    found = [assembly.floats([0.0]), *(assembly.floats(np.zeros(3 * most)) for _ in range(3))]
    loose, crowded = assembly.floats([0.0]), assembly.floats([0.0])
    data = assembly.floats(convex.joined(everything, 0, 0)[0])
    _, integers = convex.joined(everything, data, rigid_layout.HEAD)
    bodies_at = rigid_layout.HEAD + len(integers)
    ties_at = bodies_at + BODY_INTS * len(rows)
    joined_at = ties_at + len(held)
    names_at = joined_at + 1 + 2 * len(joined)
    leads_at = names_at + WHO * most
    skins_at = leads_at + rigid_layout.LED * len(leads)
    skins = known.written(everything, skins_at)
    head = [n, count, rigid_layout.HEAD, bodies_at, places_at, room_at, room, kept_at, names_at, most]
    head += [assembly.value(restitution), assembly.value(friction), *found, loose, crowded]
    masses_at = skins_at + len(skins) if points else 0
    head += [len(rows), ties_at, len(held), joined_at, len(leads), leads_at, skins_at if skins else 0, masses_at]
    head += [assembly.value(rolling)]
    meets = []
    if masses is not None:
        solids = [
            Solid(k if k < r else k + len(points), ref, center, place)
            for k, (ref, center, place) in enumerate(zip(names, centers, starts, strict=True))
            if ref is not None
        ]
        meets = masses.written(masses_at, r, solids, assembly)
    names_room = [0] * (WHO * most)
    ints = [*head, *integers.tolist(), *(number for row in rows for number in row), *held]
    ints += [len(joined), *(number for pair in sorted(joined) for number in pair), *names_room]
    ints += [*(number for one in leads for number in one), *skins, *meets]
    assembly.contact("local", (KERNEL,), [int(number) for number in ints], 0)
    own = [k for k, shape in enumerate(everything) if shape.kind != convex.POINT]
    moved = [(row[0], row[2]) for row in rows[:r]]
    stand = [own.index(first) for first, *_ in leads]
    apart = {(a, own.index(b)) for a, b in joined}
    begins = [skins[k] for k in own] if skins else []
    assembly.overlaps.append(Overlaps(real, starts, moved, names, stand, apart, begins, ints, assembly.line()))
    return (*found, loose, crowded)


def must_be_apart(
    known: Shapes,
    shapes: Sequence[Convex],
    places: Sequence[Floats],
    moving: int,
    refs: Sequence[Ref | None],
    joined: set[tuple[int, int]],
    assembly: Assembly,
) -> None:
    """Raise ScriptError for bodies that start inside one another or inside fixed shapes; it lists all such pairs."""
    import numpy as np

    from sceneql.contacts.distance.way_out import help_out

    found = Diagnostics()
    for (a, b), gap in known.gaps(shapes, places, moving):
        if (a, b) in joined:
            continue
        one, other = refs[a], refs[b]
        if one is not None and other is not None and -gap > DEEP * shapes[a].reach:
            message = f"'{one.name}' starts {-gap:.3g} m inside '{other.name}'"

            def moved(way: Floats, k: int = a, pair: tuple[int, int] = (a, b)) -> float:
                there = [*places[:k], places[k] + np.append(way, np.zeros(4)), *places[k + 1 :]]
                return float(dict(known.gaps(shapes, there, moving)).get(pair, 0.0))

            found.error("starts-inside", message, assembly.line(), help=help_out(one.name, moved))
    found.raise_errors()


def place_of(ref: Ref, assembly: Assembly) -> Floats:
    """Position and quaternion (7,) of an object at the start. Raises ScriptError for one whose shape varies."""
    import numpy as np

    kind: Any = assembly.object(ref)
    for name, value in kind:
        own = name not in led.MOVING and name not in Object.model_fields
        if own and isinstance(value, Value) and not value.constant:
            message = f"`{name}` of '{ref.name}' varies in time, and rigid bodies touch only what keeps its shape"
            raise ScriptError([Diagnostic("no-collider", message, value.span)])
    values = [getattr(kind, name, None) for name in ("position", "rotation")]
    parts = [
        assembly.initial(value) if isinstance(value, Value) else rest
        for value, rest in zip(values, ((0, 0, 0), (1, 0, 0, 0)), strict=True)
    ]
    q = np.asarray(parts[1], dtype=float)
    return np.concatenate([np.asarray(parts[0], dtype=float), q / np.linalg.norm(q)])
