"""Shapes of bodies and objects in exact contacts of rigid bodies, and the given motion of objects.

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.rigid.joint import led_side
from sceneql.compiled.numbered_kernels import number_of
from sceneql.contacts import layout
from sceneql.contacts.distance import convex
from sceneql.contacts.distance.convex import Convex
from sceneql.contacts.distance.core_kernels import REACH
from sceneql.contacts.distance.led import is_led
from sceneql.contacts.distance.rigid_contact import DEEP, must_be_apart
from sceneql.contacts.distance.way_out import help_out
from sceneql.contacts.rigid_exact.curved import COLUMN, CURVED, FIELD, FORM, SIZES, Curved, axis_of
from sceneql.contacts.shape_kernels import SURFACE_TYPE
from sceneql.contacts.shapes import implicit
from sceneql.failure import RunFailure
from sceneql.island.start import Start
from sceneql.kinds import Ref, Value
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.shapes.placement import UPRIGHT, Placed, rotation_matrix
from sceneql.system import Led

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.contacts.distance.rigid_shapes import Shapes
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly

HELP = "mode `exact` takes spheres, ellipsoids, cylinders, tori, boxes, planes, convex meshes and implicit surfaces"


def exact_shape(ref: Ref | None, center: Floats, place: Floats | None, known: Shapes, assembly: Assembly) -> Convex:
    """Shape of an object from ``center`` (3,) [m] in its own axes; ``place`` (7,): position and quaternion if fixed.

    Raises ScriptError for a shape that only points of its surface could represent.
    """
    if ref is None:
        return known.of(ref, center, place)
    start: Any = Start(assembly)
    kind: Any = assembly.object(ref)
    with suppress(TypeError, ValueError):
        kind.convex(start, center)
        return known.of(ref, center, place)
    with suppress(TypeError, ValueError):
        curved: Curved = kind.curved(start)
        return curved.shape(center)
    if kind.edgeless:
        return field_shape(kind, ref, center, assembly)
    message = f"'{ref.name}' touches by points of its surface, which mode `local` alone can do"
    raise ScriptError([Diagnostic("no-collider", message, ref.span or assembly.line(), HELP)])


def point(radius: float, size: float) -> Convex:
    """Shape of a mass: a ball, or for radius 0 a point, whose gap tolerances are relative to ``size`` [m]."""
    ball = convex.ball(radius)
    numbers = ball.floats.copy()
    numbers[REACH] = radius or size
    return Convex(ball.kind, numbers, ball.ints)


def upright(x: Floats) -> Floats:
    """Place (7,): position x (3,) and the identity quaternion."""
    return np.concatenate([x, [1.0, 0.0, 0.0, 0.0]])


def field_shape(kind: Any, ref: Ref, center: Floats, assembly: Assembly) -> Convex:
    """Shape of an object's field, from ``center`` (3,) [m] in its own axes.

    Its integers are those of an object (contacts/layout.py), which `joined_fields` completes.
    Raises ScriptError for an object without a field or an extent.
    """
    own = kind
    if isinstance(kind, Placed):
        own = kind.model_copy(update={"position": implicit.ORIGIN, "rotation": UPRIGHT})
    try:
        collider = implicit.collider(own, assembly)
        low, high = own.extent(np.eye(3, 4), Start(assembly))
    except (TypeError, ValueError, RunFailure) as error:
        message = f"'{ref.name}' does not collide with rigid bodies: {error}"
        raise ScriptError([Diagnostic("no-collider", message, ref.span or assembly.line())]) from None
    reach = float(np.linalg.norm(np.maximum(np.abs(low - center), np.abs(high - center))))
    where = [0] * layout.OBJECT
    where[layout.SURFACE] = number_of(import_module(collider.kernels).surface, SURFACE_TYPE)
    pose = assembly.floats([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    where[layout.PLACE], where[layout.ROTATION] = pose, pose + 3
    where[layout.SIZE], where[layout.DEPTH] = collider.size_at, collider.depth_at
    floats = np.concatenate([[0.0, reach, FIELD], -center, np.eye(3).ravel(), np.zeros(3)])
    return Convex(CURVED, floats, np.array([*where, *collider.data], dtype=np.int64))


def joined_fields(shapes: Sequence[Convex], floats_at: int, ints_at: int) -> tuple[Floats, NDArray[np.int64]]:
    """Floats and integers as from `convex.joined`, with the indices of the fields' integers filled in."""
    floats, ints = convex.joined(shapes, floats_at, ints_at)
    for k, shape in enumerate(shapes):
        if is_field(shape):
            _, numbers, at = (int(number) for number in ints[convex.SHAPE * k : convex.SHAPE * (k + 1)])
            ints[at - ints_at + layout.DATA] = at + layout.OBJECT
            floats[numbers - floats_at + SIZES] = at
    return floats, ints


def is_field(shape: Convex) -> bool:
    """Whether a shape is given by a field; only balls can touch such shapes."""
    numbers = shape.floats
    return bool(shape.kind == CURVED and numbers[FORM] == FIELD)


def is_column(shape: Convex) -> bool:
    """Whether a shape is a circular cylinder."""
    numbers = shape.floats
    return bool(shape.kind == CURVED and numbers[FORM] == COLUMN)


def comes_first(one: Convex, other: Convex) -> bool:
    """Whether ``one`` is first in a pair: curved shapes come first, and of two curved ones a column comes last."""
    return one.kind == CURVED and (other.kind != CURVED or (is_column(other) and not is_column(one)))


def is_ball(shape: Convex) -> bool:
    """Whether a shape is a ball: a single point with a radius."""
    return bool(shape.kind == convex.CORE and shape.ints[0] == 1)


def led_by(ref: Ref, assembly: Assembly) -> Led | None:
    """Given motion of an object; None if it is fixed. Raises ScriptError for a plane whose height varies."""
    kind: Any = assembly.object(ref)
    if not is_led(kind):
        return None
    height = getattr(kind, "height", None)
    if isinstance(height, Value) and not height.constant:
        message = f"the height of '{ref.name}' varies, by which mode `exact` does not follow it"
        raise ScriptError(
            [Diagnostic("no-collider", message, height.span, "`mode: local` does; a plane moves by `position`, too")]
        )
    mover = led_side(ref, kind, assembly).mover
    assert isinstance(mover, Led)
    return mover


def apart_exactly(
    known: Shapes,
    shapes: Sequence[Convex],
    places: Sequence[Floats],
    moving: int,
    names: Sequence[Ref | str],
    joined: set[tuple[int, int]],
    assembly: Assembly,
) -> None:
    """Raise ScriptError for bodies that start inside each other or inside fixed shapes, and for unsupported pairs.

    ``names``: object of each shape, or its description in messages.
    """
    flat = [k for k, shape in enumerate(shapes) if shape.kind != CURVED]
    number = {old: new for new, old in enumerate(flat)}
    both = {(number[a], number[b]) for a, b in joined if a in number and b in number}
    some, there, refs = [shapes[k] for k in flat], [places[k] for k in flat], [names[k] for k in flat]
    found, count = Diagnostics(), sum(k < moving for k in flat)
    if some:
        objects = [ref if isinstance(ref, Ref) else None for ref in refs]
        must_be_apart(known, some, there, count, objects, both, assembly)
        for (a, b), gap in known.gaps(some, there, count) if None in objects else ():
            mass, body = (a, b) if objects[a] is None else (b, a)
            if objects[mass] is None and objects[body] is not None and -gap > DEEP * some[mass].reach:
                message = f"{refs[mass]} starts inside {said(refs[body])}, {-gap:.3g} m deep"
                found.error("starts-inside", message, assembly.line(), help="move it outside")
    for a, b in combinations(range(len(shapes)), 2):
        if a >= moving or (a, b) in joined or (a in number and b in number):
            continue
        one, other = names[a], names[b]
        both_curved = a not in number and b not in number
        meet = is_column(shapes[a]) or is_column(shapes[b])
        if both_curved and not (meet and not is_field(shapes[a]) and not is_field(shapes[b])):
            message = f"{said(one)} and {said(other)} are both curved, which mode `exact` does not know to meet"
            help = "let only those that meet collide, by `between`; mode `local` takes both"
            found.error("no-collider", message, _place(one, assembly), help=help)
            continue
        first, second = (b, a) if comes_first(shapes[b], shapes[a]) else (a, b)
        if is_field(shapes[first]) and not is_ball(shapes[second]):
            which, what = (other, one) if first == b else (one, other)
            message = f"{said(which)} is met by balls alone in mode `exact`, and {said(what)} is none"
            found.error("no-collider", message, _place(what, assembly), help="mode `local` takes both")
            continue
        gap, met = gap_of(shapes[first], places[first], shapes[second], places[second], assembly.numbers())
        if both_curved and not met and gap < DEEP * min(shapes[a].reach, shapes[b].reach):
            sides = "two curved bodies meet in mode `exact` by round sides and rims alone"
            message = f"{said(one)} and {said(other)} touch where one is flat: {sides}"
            found.error("no-collider", message, _place(one, assembly), help="mode `local` takes both")
            continue
        if -gap > DEEP * min(shapes[a].reach, shapes[b].reach):
            who, what = (other, one) if isinstance(other, str) else (one, other)
            message = f"{said(who)} starts {-gap:.3g} m inside {said(what)}"

            def moved(way: Floats, k: int = a, one: int = first, other: int = second) -> float:
                there = [places[j] + np.append(way, np.zeros(4)) * (j == k) for j in (one, other)]
                return gap_of(shapes[one], there[0], shapes[other], there[1], assembly.numbers())[0]

            help = help_out(one.name, moved) if isinstance(one, Ref) else "move one of them away"
            found.error("starts-inside", message, assembly.line(), help=help)
    found.raise_errors()


def said(name: Ref | str) -> str:
    """Name of a shape in messages."""
    return f"'{name.name}'" if isinstance(name, Ref) else name


def _place(name: Ref | str, assembly: Assembly) -> Span | None:
    """Place in the script for messages about a shape."""
    return (name.span if isinstance(name, Ref) else None) or assembly.line()


def gap_of(curved: Convex, place: Floats, other: Convex, there: Floats, numbers: Floats) -> tuple[float, bool]:
    """Gap [m] between a curved shape at ``place`` (7,) and another at ``there`` (7,), and whether a contact was found.

    ``numbers``: floats of the island.
    """
    from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R, AT_X, MOVED
    from sceneql.contacts.rigid_exact.contact_kernels import RECORD
    from sceneql.contacts.rigid_exact.curved_find_kernels import (
        COLUMN_B,
        CORE_OF_A,
        MOVER_A,
        MOVER_B,
        SHAPE_OF_A,
        SHAPE_OF_B,
        WHO,
    )
    from sceneql.contacts.rigid_exact.curved_meet_kernels import meet

    floats, ints = joined_fields([curved, other, axis_of(curved), axis_of(other)], len(numbers), 0)
    floats = np.concatenate([numbers, floats])
    movers = np.zeros((2, MOVED))
    for mover, at in zip(movers, (place, there), strict=True):
        mover[AT_X : AT_X + 3] = at[:3]
        mover[AT_R : AT_R + 9] = rotation_matrix(at[3:]).ravel()
    who, asked = len(ints), np.zeros(2 * WHO, dtype=np.int64)
    both = other.kind == CURVED
    asked[SHAPE_OF_A], asked[SHAPE_OF_B] = 0, convex.SHAPE * (3 if both else 1)
    asked[COLUMN_B], asked[CORE_OF_A] = convex.SHAPE if both else -1, 2 * convex.SHAPE
    asked[MOVER_A], asked[MOVER_B] = len(floats), len(floats) + MOVED
    room = len(floats) + movers.size
    floats, ints = np.concatenate([floats, movers.ravel(), np.zeros(RECORD)]), np.concatenate([ints, asked])
    count, gap = meet(floats, ints, who, DEEP * min(curved.reach, other.reach), room, 1)
    return float(gap), count > 0
