"""One instant of the run, as words see it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, Protocol, Self, TypeVar, Union

if TYPE_CHECKING:
    from sceneql.frame import Floats, Surface
    from sceneql.frame import Shape as Drawn
    from sceneql.kinds.field_builder import FieldBuilder
    from sceneql.kinds.values import Ref, Value
    from sceneql.kinds.volume_moments import VolumeMoments
    from sceneql.system import ModelState

T = TypeVar("T")


class Seen(Protocol):
    """Something that has a value at an instant, besides the values of fields."""

    def at(self, moment: Moment) -> Any:
        """Its value."""


class Shaped(Protocol):
    """An object of the script as other objects see it that are made of it; Object has the contract of each method."""

    @property
    def material(self) -> Ref | None:
        """Its material; None where the script names none."""

    @property
    def color(self) -> Value | None:
        """The color in place of the material's, if any."""

    @property
    def hidden(self) -> bool:
        """Whether it is not drawn."""

    @property
    def traced(self) -> str:
        """The kind of field that rays intersect it by."""

    def model_copy(self, *, update: Mapping[str, Any] | None = None) -> Self:
        """A copy with other fields."""

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Drawn]:
        """Its shapes."""

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of its implicit field."""

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """Registers of its color; None where its surface has a single one."""

    def domain(self) -> Any:
        """Its inside as a two-dimensional domain of fields."""

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of a world box around it."""

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """Volume, center and second moments of its inside, where it knows them better than its field does."""


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
    def room(self) -> tuple[float, float, float, float]:
        """What overlays take of the picture's left, top, right and bottom, in parts of its width and height."""

    @property
    def variants(self) -> tuple[str, ...]:
        """The names of the script's variants."""

    def at(self, value: Value) -> Any:
        """The value now: float, or float64 array of the field's shape, SI. Raises RunFailure if it is not finite."""

    def measure(self, value: Value) -> Any:
        """The value now, even where it is not finite."""

    def past(self, value: Remembered) -> list[tuple[float, Any]]:
        """(time [s], value) at the instants before now that a part asked for (its `remembers`), oldest first."""

    def course(self, value: Value, variant: str | None = None, until: float = ...) -> tuple[Floats, Floats]:
        """Times (n,) [s] of the run, whole or up to ``until``, and values (n, ...) of a value in `Overlay.courses`.

        With ``variant``, in that variant of the script. The course of a run that fails ends at the failure.
        """

    def read(self, task: str, output: str) -> Any:
        """An output of a part now."""

    def state(self, name: str) -> ModelState:
        """The state of a model that is solved, or of a contact, now."""

    def object(self, ref: Ref) -> Shaped:
        """An object of the script."""

    def place(self, name: str) -> Floats:
        """(3, 4) map to the world from the coordinates that an object's position is in: its group's or the world's."""

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        """The surface of object ``name``: its material's, with the color replaced where given; a default by order."""

    def coloring(self) -> AbstractContextManager[None]:
        """What is read inside gives colors: by it nothing that is drawn leaves the bounds that it has."""

    def kept(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        """The result of ``make`` for a part: the last one where its key equals this one, else a new one.

        So arrays of shapes are the same objects from frame to frame (frame.is_held): the key holds all that they depend
        on. One result a part is kept, and no longer than the run.
        """

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of what the named objects draw over the whole film (infinite planes left out).

        For no names of all that is drawn, but for what leaves for good.
        """

    def around(self) -> tuple[Floats, Floats] | None:
        """Low and high corner (3,) around what the picture shows now (infinite planes left out); None where that is
        not known, or nothing.
        """

    def outline(self) -> Floats:
        """Points (n, 3) [m] whose hull holds all that is drawn over the whole film, but for what leaves for good."""
