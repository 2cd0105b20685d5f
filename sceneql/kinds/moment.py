"""One instant of the run, as words see it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Protocol, Self, TypeVar, Union

if TYPE_CHECKING:
    from sceneql.frame import Floats, Surface
    from sceneql.frame import Shape as Drawn
    from sceneql.kinds.field_builder import FieldBuilder
    from sceneql.kinds.values import Ref, Value
    from sceneql.system import ModelState

T = TypeVar("T")


class Seen(Protocol):
    """Something that has a value at an instant, besides the values of fields."""

    def at(self, moment: Moment) -> Any:
        """Its value."""


class Shaped(Protocol):
    """An object of the script as those see it that are made of it (Object has the contract of each method)."""

    @property
    def material(self) -> Ref | None:
        """How it looks; None: the script does not say."""

    @property
    def color(self) -> Value | None:
        """In place of the material's."""

    @property
    def hidden(self) -> bool:
        """Whether it is not drawn."""

    @property
    def traced(self) -> str:
        """What field it may be drawn by."""

    def model_copy(self, *, update: Mapping[str, Any] | None = None) -> Self:
        """It with other fields."""

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Drawn]:
        """Its shapes."""

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of its field."""

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """Registers of its color; None: its surface has one."""

    def domain(self) -> Any:
        """Its inside as a flat domain of fields."""

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of a world box around it."""


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

    def object(self, ref: Ref) -> Shaped:
        """An object of the script."""

    def place(self, name: str) -> Floats:
        """(3, 4) map to the world from the coordinates that an object's position is told in: its group's, or these."""

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        """The surface of object ``name``: its material's, with the color replaced where given; a default by order."""

    def kept(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        """What ``make`` made for a part when it was last asked for, if the key was equal, else what it makes now.

        So arrays of shapes are the same from frame to frame (frame.is_held): the key says all that they are made of.
        One result a part is kept, and no longer than the run.
        """

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of what the named objects draw over the whole film (infinite planes left out)."""
