"""Objects moved by keys or formulas, in contacts with rigid bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.bodies.time_shift import later
from sceneql.contacts.shapes import implicit
from sceneql.kinds import Object, Ref, Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly

MOVING = ("position", "rotation", "height")
"""Fields of an object that move it without changing its shape; `height` belongs to planes."""


def is_led(kind: Object) -> bool:
    """Whether an object's given place varies in time."""
    return any(name in MOVING and isinstance(value, Value) and not value.constant for name, value in kind)


def lead(ref: Ref, kind: Object, place: Floats, assembly: Assembly) -> tuple[int, ...]:
    """Integers of an object with given motion (led_kernels); ``place`` (7,): position and quaternion at the start.

    Raises ScriptError for an object that follows a solved model.
    """
    import numpy as np

    try:
        for name, value in kind:
            if name in MOVING and isinstance(value, Value) and not value.constant:
                later(value.expr, 1.0, assembly.formula)
        own = type(kind).collider is not Object.collider
        found = kind.collider(assembly) if own else None
    except (TypeError, ValueError) as error:
        message = f"'{ref.name}' moves as rigid bodies cannot follow: {error}"
        raise ScriptError([Diagnostic("no-collider", message, ref.span)]) from None
    at = implicit.place(kind, assembly) if found is None else (found.position_at, found.rotation_at)
    start = assembly.numbers()
    shift = place[:3] - start[at[0] : at[0] + 3]
    memory = np.concatenate([[np.nan], place, [0.0], place])
    return (*at, assembly.floats(shift), assembly.floats(memory))
