"""The scene at the start of the run, as objects see it while an island is assembled."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any, TypeVar, cast

from sceneql.kinds import Object

if TYPE_CHECKING:
    from sceneql.kinds import Ref, Shaped, Value
    from sceneql.system import Assembly

T = TypeVar("T")


class Start:
    """The part of kinds.Moment that an object's field and extent may read, at the start."""

    time = 0.0

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly

    def at(self, value: Value) -> Any:
        """A value at the start."""
        return self._assembly.initial(value)

    def kept(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        """The result of ``make``: nothing is cached at this start."""
        return make()

    def object(self, ref: Ref) -> Shaped:
        """An object of the script."""
        return cast(Object, self._assembly.object(ref))
