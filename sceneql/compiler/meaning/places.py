"""Where objects stand, and how large they are, by their fields alone: in plain Python, for warnings of meaning."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Any, NamedTuple, cast

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN, field_at
from sceneql.kinds import Object

SIZES = ("radius", "size", "tube", "height")
"""Fields that tell of an object how far it reaches."""


class Ball(NamedTuple):
    """A ball that holds an object which stands still, and one that lies in it."""

    center: tuple[float, ...]
    """[m]"""
    reach: float
    """Radius of the ball that holds it [m]."""
    inner: float
    """Radius of the ball in it about the same center [m]; 0 where none is known."""


def ball(facts: Facts, name: str) -> Ball | None:
    """The balls of an object that nothing moves; None where its fields do not tell."""
    task = facts.tasks[name]
    kind: Any = task.kind
    if (
        task.original is not None
        or not isinstance(kind, Object)
        or kind.grounds
        or type(kind).implicit is Object.implicit
    ):
        return None
    center = constant(getattr(kind, "position", None))
    given = {field: constant(value) for field in SIZES if (value := getattr(kind, field, None)) is not None}
    if center is None or not given or None in given.values() or hasattr(kind, "of") or hasattr(kind, "through"):
        return None
    each = [hypot(*one) if isinstance(one, tuple) else float(one) for one in given.values()]
    if given.keys() == {"radius"}:
        return Ball(center, each[0], each[0])
    if given.keys() == {"size"}:
        return Ball(center, 0.5 * each[0], 0.5 * min(given["size"]))
    if given.keys() == {"radius", "height"}:
        return Ball(center, hypot(each[0], 0.5 * each[1]), min(given["radius"], 0.5 * given["height"]))
    return Ball(center, sum(each), 0.0)


def depth(facts: Facts, name: str, place: Sequence[float]) -> float:
    """How deep a place [m] lies inside an object at least [m]; below 0 where it lies outside, or that is not known."""
    import numpy as np  # here, where a place is near an object

    kind = facts.tasks[name].kind
    if hasattr(kind, "field"):
        return -1.0  # the value of a formula is no distance
    try:
        return -float(
            field_at(cast(Object, kind), np.array([place], dtype=float), cast(Any, Beginning(facts.tasks)))[0]
        )
    except UNKNOWN:
        return -1.0


def opaque(facts: Facts) -> dict[str, Ball]:
    """Objects that stand still, are drawn, and that one does not see through."""
    found = {}
    for name, kind in facts.objects.items():
        if name in facts.seen and not kind.hidden and not kind.decorates and not facts.clear(kind):
            held = ball(facts, name)
            if held is not None:
                found[name] = held
    return found


def distance(one: Sequence[float], other: Sequence[float]) -> float:
    """[m]"""
    return hypot(*(a - b for a, b in zip(one, other, strict=True)))


def text(place: Sequence[float]) -> str:
    """A place as scripts write it."""
    return " ".join(f"{0.0 + c:.4g}" for c in place) + " m"
