"""Objects that move by keys or formulas, for rigid bodies that touch them."""

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
"""Fields of an object that move it and leave its shape; `height` is a plane's."""


def is_led(kind: Object) -> bool:
    """Whether an object moves by itself."""
    return any(name in MOVING and isinstance(value, Value) and not value.constant for name, value in kind)


def lead(ref: Ref, kind: Object, place: Floats, assembly: Assembly) -> tuple[int, ...]:
    """The integers of an object that moves (led_kernels); ``place``: position and quaternion (7,) at the start.

    Raises ScriptError for one that follows what is solved.
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
