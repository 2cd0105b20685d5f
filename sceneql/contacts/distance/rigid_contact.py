"""Contacts of rigid bodies with one another and with objects that stand: their shapes, and the arrays of the kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from sceneql.island.start import Start
from sceneql.kinds import Ref, Value
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError

if TYPE_CHECKING:
    from sceneql.contacts.distance.convex import Convex
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies

CONTACTS = 24
"""Contacts by the body whose forces are told and kept."""
DEEP = 1e-6
"""Part of a body's size by which it may start inside another: rounding in a script."""
SHAPE = 3
"""Integers of a shape (convex.SHAPE)."""
KERNEL = "sceneql.contacts.distance.rigid_local_kernels:back_off"


def assemble(
    assembly: Assembly, everyone: Sequence[Bodies], others: Sequence[Ref], restitution: Value, friction: Value
) -> tuple[int, ...]:
    """Add the contacts of rigid bodies; the offsets of count, points, normals, forces, loose and crowded steps.

    Raises ScriptError for a shape that is not covered, and for bodies that start inside each other.
    """
    import numpy as np

    from sceneql.bodies.rigid.turning import packed, unpacked
    from sceneql.contacts.distance import convex
    from sceneql.contacts.distance import rigid_local_kernels as kernels
    from sceneql.contacts.distance.rigid_rows_kernels import PLACE, WHO

    numbers, shapes, fixed, rows = assembly.numbers(), [], [], []
    moving: list[tuple[Ref | None, Floats]] = []
    standing: list[Ref | None] = []
    start = assembly.start()
    for bodies in everyone:
        turning = bodies.turning
        assert turning is not None
        model: Any = assembly.object(Ref(bodies.model))
        for k, (ref, center) in enumerate(model.solids()):
            shape = shape_of(ref, center, assembly)
            x, q = bodies.position_at + 3 * k, turning.rotation_at + 4 * k
            place = np.concatenate([start[x : x + 3], start[q : q + 4]])
            if numbers[bodies.inverse_at + k] == 0.0:
                fixed.append((shape, place))
                standing.append(ref)
                continue
            moving.append((ref, place))
            inertia: Floats = np.asarray(np.linalg.inv(unpacked(numbers[turning.inverse_at + 6 * k :][:6])))
            rows.append(
                (
                    *(x, bodies.velocity_at + 3 * k, q, turning.momentum_at + 3 * k),
                    *(bodies.mass_at + k, assembly.floats(packed(inertia)), bodies.work_at),
                )
            )
            shapes.append(shape)
    for ref in others:
        shape = shape_of(ref, np.zeros(3), assembly)
        fixed.append((shape, place_of(ref, assembly)))
        standing.append(ref)
    n = len(rows)
    everything = [*shapes, *(shape for shape, _ in fixed)]
    count, most = len(everything), CONTACTS * n + 64
    places = np.zeros((count, PLACE))
    for k, (_, place) in enumerate(fixed):
        places[n + k] = place
    names = [*(ref for ref, _ in moving), *standing]
    must_be_apart(everything, [*(place for _, place in moving), *(place for _, place in fixed)], n, names, assembly)
    room = convex.room_length(everything)
    places_at = assembly.floats(places)
    room_at, kept_at = (assembly.floats(np.zeros(size)) for size in (room, 3 * most))
    found = [assembly.floats([0.0]), *(assembly.floats(np.zeros(3 * most)) for _ in range(3))]
    loose, crowded = assembly.floats([0.0]), assembly.floats([0.0])
    data = assembly.floats(convex.joined(everything, 0, 0)[0])
    _, integers = convex.joined(everything, data, kernels.HEAD)
    bodies_at = kernels.HEAD + len(integers)
    names_at = bodies_at + kernels.BODY_INTS * n
    head = [n, count, kernels.HEAD, bodies_at, places_at, room_at, room, kept_at, names_at, most]
    head += [assembly.value(restitution), assembly.value(friction), *found, loose, crowded]
    names_room = [0] * (WHO * most)
    ints = [*head, *integers.tolist(), *(number for row in rows for number in row), *names_room]
    assembly.contact("local", (KERNEL,), [int(number) for number in ints], 0)
    return (*found, loose, crowded)


def must_be_apart(
    shapes: Sequence[Convex], places: Sequence[Floats], moving: int, refs: Sequence[Ref | None], assembly: Assembly
) -> None:
    """Raise ScriptError for bodies that start inside one another or inside what stands; all such pairs at once."""
    import numpy as np

    from sceneql.contacts.distance import convex
    from sceneql.contacts.distance.gap_kernels import gap
    from sceneql.contacts.distance.rigid_local_kernels import standing_pairs

    floats, ints = convex.joined(shapes)
    room, where = np.zeros(convex.room_length(shapes)), np.concatenate(places)
    found = Diagnostics()
    for a, b in standing_pairs(floats, ints, len(shapes), where, room).tolist():
        if a >= moving:
            break
        depth = -gap(floats, ints, SHAPE * a, SHAPE * b, where, 7 * a, 7 * b, room)[0]
        one, other = refs[a], refs[b]
        if one is not None and other is not None and depth > DEEP * shapes[a].reach:
            message = f"'{one.name}' starts {depth:.3g} m inside '{other.name}'"
            found.error("starts-inside", message, assembly.line(), help="move one of them away")
    found.raise_errors()


def shape_of(ref: Ref | None, center: Floats, assembly: Assembly) -> Convex:
    """The shape of an object in its own axes from a center. Raises ScriptError where it is not covered."""
    if ref is None:
        message = "a body without an object has no shape to touch with"
        raise ScriptError([Diagnostic("no-collider", message, assembly.line())])
    start: Any = Start(assembly)
    kind: Any = assembly.object(ref)
    try:
        found: Convex = kind.convex(start, center)
        return found
    except (TypeError, ValueError) as error:
        help = "spheres, boxes, planes and convex meshes do"
        message = f"'{ref.name}' does not collide with rigid bodies yet: {error}"
        raise ScriptError([Diagnostic("no-collider", message, ref.span, help)]) from None


def place_of(ref: Ref, assembly: Assembly) -> Floats:
    """Position and quaternion (7,) of an object that stands. Raises ScriptError for one that moves."""
    import numpy as np

    kind = assembly.object(ref)
    values = [getattr(kind, name, None) for name in ("position", "rotation")]
    if any(isinstance(value, Value) and not value.constant for value in values):
        message = f"'{ref.name}' moves by itself, and rigid bodies touch only what stands or what they are, so far"
        raise ScriptError([Diagnostic("no-collider", message, ref.span)])
    parts = [
        assembly.initial(value) if isinstance(value, Value) else rest
        for value, rest in zip(values, ((0, 0, 0), (1, 0, 0, 0)), strict=True)
    ]
    q = np.asarray(parts[1], dtype=float)
    return np.concatenate([np.asarray(parts[0], dtype=float), q / np.linalg.norm(q)])
