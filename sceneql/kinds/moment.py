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
    """Something besides field values that can be evaluated at an instant."""

    def at(self, moment: Moment) -> Any:
        """Its value at the moment."""


class Shaped(Protocol):
    """An object of the script as seen by objects composed of it; Object has the contract of each method."""

    @property
    def material(self) -> Ref | None:
        """Reference to its material; None where the script names none."""

    @property
    def color(self) -> Value | None:
        """Its color, which replaces the material's; None: the material's."""

    @property
    def hidden(self) -> bool:
        """Whether it is not drawn."""

    @property
    def traced(self) -> str:
        """The kind of field by which rays are intersected with it (Object.traced)."""

    def model_copy(self, *, update: Mapping[str, Any] | None = None) -> Self:
        """A copy with other fields."""

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Drawn]:
        """Its shapes in the world at the moment."""

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of its implicit field at a point given by registers."""

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """Registers of its linear RGB color at a point; None where its surface has a single color."""

    def domain(self) -> Any:
        """Its inside as a two-dimensional domain of fields; None where it is none."""

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) [m] of a bounding box in the world."""

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """Volume, center and second moments of its inside, where it knows them better than quadrature of its field."""


Remembered = Union["Value", Seen]


class Moment(Protocol):
    """One instant of the run, as words see it."""

    @property
    def time(self) -> float:
        """Time of the instant [s]."""

    @property
    def end(self) -> float:
        """End of the run [s]."""

    @property
    def room(self) -> tuple[float, float, float, float]:
        """Margins covered by overlays at the picture's left, top, right and bottom, as parts of width and height."""

    @property
    def rooms(self) -> tuple[tuple[float, tuple[float, float, float, float]], ...]:
        """The margins that are needed at some instants [s] of the film; without any they are always ``room``."""

    @property
    def variants(self) -> tuple[str, ...]:
        """The names of the script's variants."""

    def at(self, value: Value) -> Any:
        """The value now: float, or float64 array of the field's shape, SI. Raises RunFailure if it is not finite."""

    def measure(self, value: Value) -> Any:
        """The value now, even where it is not finite."""

    def past(self, value: Remembered) -> list[tuple[float, Any]]:
        """Past values (time [s], value), oldest first, at instants that a part asked for by its `remembers`."""

    def course(self, value: Value, variant: str | None = None, until: float = ...) -> tuple[Floats, Floats]:
        """Times (n,) [s] of the run, whole or up to ``until``, and values (n, ...) of a value in `courses`.

        ``variant``: the name of a variant of the script to take the values from. The course of a run that fails ends at
        the failure.
        """

    def read(self, task: str, output: str) -> Any:
        """An output of a part now."""

    def state(self, name: str) -> ModelState:
        """The state of a solved model, or of a contact, now."""

    def object(self, ref: Ref) -> Shaped:
        """An object of the script."""

    def place(self, name: str) -> Floats:
        """(3, 4) map to the world from the coordinates of object ``name``'s position: its group's, or the world's."""

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        """The surface of object ``name``: the material's, recolored where ``color`` is given.

        Without a material a default color.
        """

    def coloring(self) -> AbstractContextManager[None]:
        """Context manager: values read inside only color shapes, so they cannot move a shape out of its bounds."""

    def kept(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        """The result of ``make`` for part ``name``: the cached one where its key equals ``key``, else a new one.

        So arrays of shapes are the same objects from frame to frame (frame.is_held): the key holds all that they depend
        on. One result a part is kept, and no longer than the run.
        """

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats]:
        """Low and high corner (3,) [m] of what the named objects draw over the whole film, without infinite planes.

        Without names: of all that is drawn, except what leaves the scene for good.
        """

    def around(self) -> tuple[Floats, Floats] | None:
        """Low and high corner (3,) [m] around what the picture shows now, without infinite planes.

        None where that is not known, or where nothing is shown.
        """

    def boxes(self) -> Floats:
        """Low and high corners (n, 2, 3) [m] of each part that is drawn, over the whole film."""

    def outline(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that is drawn over the whole film, except what leaves for good."""

    def standing(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that is drawn and does not change."""

    def moving(self, window: float | None) -> Floats:
        """Instants [s] over the film and points [m], rows (n, 1 + 3).

        Their hull at each instant encloses all that moves and stays. Without rows nothing moves. ``window``: for how
        long at once a camera shows it [s], with all that stands; None: a camera shows it alone.
        """

    def left_out(self) -> Floats:
        """Instants [s] and points [m], rows (n, 1 + 3), of what moves where panels' common framing leaves this one out.

        It is a variant that diverges by its solver alone; without rows the framing shows it.
        """
