"""Objects a little earlier or later, from which a moving surface's velocity is found."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sceneql.kinds import Object, Value
from sceneql.simulation.shift import later

if TYPE_CHECKING:
    from sceneql.system import Assembly


def is_moving(kind: Object) -> bool:
    """Whether any of its values varies in time."""
    return any(isinstance(value, Value) and not value.constant for _, value in kind)


def shifted(kind: Object, by: float, assembly: Assembly) -> Object:
    """The object with every value taken ``by`` [s] later. Raises ValueError for one that follows a solved model."""
    changed = {
        name: replace(value, expr=later(value.expr, by, assembly.formula))
        for name, value in kind
        if isinstance(value, Value) and not value.constant
    }
    return kind.model_copy(update=changed)
