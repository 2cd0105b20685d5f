"""One instant of the run, as words see it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol, Union

if TYPE_CHECKING:
    from sceneql.frame import Floats, Surface
    from sceneql.kinds.objects import Object
    from sceneql.kinds.values import Ref, Value
    from sceneql.system import ModelState


class Seen(Protocol):
    """Something that has a value at an instant, besides the values of fields."""

    def at(self, moment: Moment) -> Any:
        """Its value."""


Remembered = Union["Value", Seen]


class Moment(Protocol):
    """One instant of the run, as words see it."""

    @property
    def time(self) -> float:
        """[s]"""

    @property
    def end(self) -> float:
        """When the run ends [s]."""

    @property
    def variants(self) -> tuple[str, ...]:
        """The names of the script's variants."""

    def at(self, value: Value) -> Any:
        """The value now: float, or float64 array of the field's shape, SI. Raises RunFailure if it is not finite."""

    def measure(self, value: Value) -> Any:
        """The value now, finite or not."""

    def past(self, value: Remembered) -> list[tuple[float, Any]]:
        """(time [s], value) at the instants before that a part asked for (its `remembers`), oldest first."""

    def course(self, value: Value, variant: str | None = None, until: float = ...) -> tuple[Floats, Floats]:
        """Times (n,) [s] of the run, whole or up to an instant, and at each a value (n, ...) of `Overlay.courses`.

        With ``variant`` in that variant of the script. A run that fails has the course up to there.
        """

    def read(self, task: str, output: str) -> Any:
        """An output of a part now."""

    def state(self, name: str) -> ModelState:
        """The state of a model that is solved, or of a contact, now."""

    def object(self, ref: Ref) -> Object:
        """The kind of an object."""

    def place(self, name: str) -> Floats:
        """(3, 4) map to the world from the coordinates that an object's position is told in: its group's, or these."""

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        """The surface of object ``name``: its material's, with the color replaced where given; a default by order."""

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of what the named objects draw over the whole film (infinite planes left out)."""
