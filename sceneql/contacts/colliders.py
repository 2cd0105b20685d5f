"""Integers that describe the surfaces of objects to contact kernels (shape_kernels)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

from sceneql.bodies.time_shift import APART, exact_rate, goes_evenly, later
from sceneql.contacts import layout
from sceneql.contacts.shapes import implicit
from sceneql.doing import doing
from sceneql.kinds import Collider, Object, Ref, Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.instead import instead

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly

OFTEN = 1 / 240
"""Longest adaptive step [s] with contacts that act at the ends of steps, or objects that accelerate. The error estimate
sees neither, and a body that approaches no faster than gravity makes it in two steps counts as at rest."""
SHIFTING = ("position", "height")
"""Fields of an object that only translate it; `height` belongs to planes."""
FAR_APART = 1.0
"""Time [s] between the poses that give the rates of an object in uniform motion. Any is exact; a long one loses least
to rounding."""


def surfaces(refs: Sequence[Ref], assembly: Assembly, at: int, often: float = OFTEN) -> tuple[int, ...]:
    """Integers of objects, to stand at index ``at`` of a contact's integers, followed by the data of their shapes.

    ``often``: longest step [s] where one moves unevenly.
    Raises ScriptError for an object without a collider.
    """
    heads: list[int] = []
    tail: list[int] = []
    for ref in refs:
        head, data = _surface(ref, assembly, often)
        heads += [*head, at + len(refs) * layout.OBJECT + len(tail)]
        tail += data
    return (*heads, *tail)


def must_be_free(model: str, assembly: Assembly) -> None:
    """Raise ScriptError for masses with ties, which are not solved together with contacts."""
    if assembly.tied(model):
        message = f"ties hold masses of '{model}', and such masses do not collide yet"
        help = "name under `between` what may touch, without it"
        raise ScriptError([Diagnostic("no-collider", message, assembly.line(), help)])


def must_be_outside(model: str, refs: Sequence[Ref], ints: Sequence[int], assembly: Assembly) -> None:
    """Raise ScriptError for a mass that starts inside an object; ``ints``: integers of the contact."""
    import numpy as np

    from sceneql.contacts.near_kernels import deepest

    depth, body, other = deepest(assembly.start(), assembly.numbers(), np.array(ints, dtype=np.int64))
    if depth > 0.0:
        ref = refs[other]
        text = f"mass {body} of '{model}' starts inside '{ref.name}', {depth:.3g} m deep"
        help = f"move it outside, or name under `between` what may touch, without '{ref.name}'"
        raise ScriptError([Diagnostic("starts-inside", text, ref.span or assembly.line(), help)])


def _surface(ref: Ref, assembly: Assembly, often: float) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Integers of an object without the last (the index of its data), and the data of its shape."""
    kind = cast(Object, assembly.object(ref))
    try:
        noted = _Noted(assembly)
        with doing(f"looking at the surface of {ref.name}"):
            here = _collider(kind, cast("Assembly", noted))
        if not is_moving(kind):
            poses = (0, here.position_at, here.rotation_at, here.position_at, here.rotation_at)
        else:
            even = _moves_evenly(kind, assembly)
            if not even:
                assembly.step_at_most(often)
            exact = None if even else noted.motion(here)
            if exact is not None:
                poses = (assembly.floats([0.0]), *exact)
            else:
                apart = FAR_APART if even else APART
                before, after = _shifted(kind, -apart, assembly), _shifted(kind, apart, assembly)
                poses = (assembly.floats([apart]), *before, *after)
    except (TypeError, ValueError) as error:
        name = ref.name if ref.span is None else ref.span.text
        help = instead("collider", name) or f"name under `between` what may touch, without '{name}'"
        place = ref.span or assembly.line()
        raise ScriptError([Diagnostic("no-collider", f"'{name}': {error}", place, help)]) from None
    places = (here.position_at, here.rotation_at, here.size_at, here.depth_at)
    flat = int(here.flat and not is_moving(kind))
    return (*shape_kernels(here), *places, *poses, flat), here.data


def shape_kernels(here: Collider) -> list[int]:
    """Numbers of a shape's four kernels: surface, bend, clear and near."""
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.contacts.shape_kernels import BEND_TYPE, CLEAR_TYPE, NEAR_TYPE, SURFACE_TYPE

    shape = import_module(here.kernels)
    signatures = {"surface": SURFACE_TYPE, "bend": BEND_TYPE, "clear": CLEAR_TYPE}
    numbers = [number_of(getattr(shape, name), signature) for name, signature in signatures.items()]
    if not hasattr(shape, "near"):
        shape = import_module("sceneql.contacts.near_kernels")
    return [*numbers, number_of(shape.near, NEAR_TYPE)]


def surface_of(
    ref: Ref, center: Floats, place: Floats, assembly: Assembly
) -> tuple[tuple[int, ...], tuple[int, ...], Floats]:
    """Integers of a moving solid's surface without the last, the data of its shape, and its relative place (7,).

    The relative place is position [m] and quaternion in the solid's axes, from ``center`` (3,) [m], which is in the
    object's axes. ``place`` (7,): position and quaternion of the solid at the start.
    Raises ScriptError for an object without a collider.
    """
    import numpy as np

    from sceneql.bodies.rigid.turning import quaternion
    from sceneql.shapes.placement import rotation_matrix

    kind = cast(Object, assembly.object(ref))
    try:
        with doing(f"looking at the surface of {ref.name}"):
            here = _collider(kind, assembly)
    except (TypeError, ValueError) as error:
        name = ref.name if ref.span is None else ref.span.text
        help = instead("collider", name) or f"name under `between` what may touch, without '{name}'"
        at = ref.span or assembly.line()
        raise ScriptError([Diagnostic("no-collider", f"'{name}': {error}", at, help)]) from None
    values = [getattr(kind, name, None) for name in ("position", "rotation")]
    rests = (np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    x, q = (
        np.asarray(assembly.initial(value), dtype=float) if isinstance(value, Value) else rest
        for value, rest in zip(values, rests, strict=True)
    )
    own, numbers = rotation_matrix(q).T, assembly.numbers()
    relative = own @ (numbers[here.position_at :][:3] - x) - center
    turn = own @ rotation_matrix(numbers[here.rotation_at :][:4])
    body = rotation_matrix(place[3:])
    position = assembly.floats(place[:3] + body @ relative)
    rotation = assembly.floats(quaternion(body @ turn))
    head = (
        *shape_kernels(here),
        position,
        rotation,
        here.size_at,
        here.depth_at,
        0,
        position,
        rotation,
        position,
        rotation,
    )
    return (*head, int(here.flat)), here.data, np.concatenate([relative, quaternion(turn)])


class _Noted:
    """Assembly that records the value at each offset, so that its time derivatives can be found."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._values: dict[int, Value] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._assembly, name)

    def value(self, value: Value) -> int:
        """Offset of a value, as Assembly.value returns it."""
        at = self._assembly.value(value)
        self._values[at] = value
        return at

    def motion(self, here: Collider) -> tuple[int, int, int, int] | None:
        """Offsets of first, then second derivatives of position and rotation; None if one is not known."""
        found = []
        for at, size in ((here.position_at, 3), (here.rotation_at, 4)):
            value, rates = self._values.get(at), []
            for _ in range(2):
                value = None if value is None or value.constant else self._rate(value)
                if value is None and at in self._values and not self._values[at].constant:
                    return None
                rates.append(self._assembly.floats([0.0] * size) if value is None else self._assembly.value(value))
            found.append(rates)
        (velocity, acceleration), (turn, twist) = found
        return velocity, turn, acceleration, twist

    def _rate(self, value: Value) -> Value | None:
        """Time derivative of a value; None if it is not known or not finite at the start."""
        import numpy as np

        expr = exact_rate(value.expr, self._assembly.formula)
        rate = None if expr is None else Value(expr, value.span)
        return rate if rate is not None and np.isfinite(self._assembly.initial(rate)).all() else None


def _has_own(kind: Object) -> bool:
    return type(kind).collider is not Object.collider


def _collider(kind: Object, assembly: Assembly) -> Collider:
    """Collider of an object, its own or that of its field.

    Raises TypeError for an object without an inside, ValueError for one without a collider.
    """
    return kind.collider(assembly) if _has_own(kind) else implicit.collider(kind, assembly)


def _shifted(kind: Object, by: float, assembly: Assembly) -> tuple[int, int]:
    """Offsets of position and rotation of an object's collider at a time later by ``by`` [s]."""
    there = shifted(kind, by, assembly)
    if not _has_own(kind):
        return implicit.place(there, assembly)
    collider = there.collider(assembly)
    return collider.position_at, collider.rotation_at


def is_moving(kind: Object) -> bool:
    """Whether any value of the object varies in time."""
    return any(isinstance(value, Value) and not value.constant for _, value in kind)


def _moves_evenly(kind: Object, assembly: Assembly) -> bool:
    """Whether an object is known to move uniformly, so that its contacts are those of an object at rest."""
    return all(
        name in SHIFTING and goes_evenly(value.expr, assembly.formula)
        for name, value in kind
        if isinstance(value, Value) and not value.constant
    )


def shifted(kind: Object, by: float, assembly: Assembly) -> Object:
    """Object with every value at a time later by ``by`` [s]. Raises ValueError for one that follows a solved model."""
    changed = {
        name: replace(value, expr=later(value.expr, by, assembly.formula))
        for name, value in kind
        if isinstance(value, Value) and not value.constant
    }
    return kind.model_copy(update=changed)
