"""The family of objects: what is drawn, collided with and moved."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds.types import Color, MaterialRef
from sceneql.kinds.values import Ref, Value
from sceneql.kinds.word import Kind, field

if TYPE_CHECKING:
    from sceneql.frame import Floats, Surface
    from sceneql.frame import Shape as Drawn
    from sceneql.kinds.doubt import Doubt
    from sceneql.kinds.field_builder import FieldBuilder
    from sceneql.kinds.moment import Moment, Shaped
    from sceneql.kinds.settings import Clock
    from sceneql.kinds.volume_moments import VolumeMoments
    from sceneql.system import Assembly


class Object(Kind):
    """Something to draw, to collide with, to be moved."""

    family: ClassVar[str] = "objects"
    collides: ClassVar[bool] = False
    """Whether contacts that name no objects include it, even where more than its placement varies in time."""

    unseen: ClassVar[str] = ""
    """For words that draw their members in another form: the text of a warning that nothing of it was drawn."""

    grounds: ClassVar[bool] = False
    """Whether it serves as a ground: a scene that has one gets no default ground."""

    edgeless: ClassVar[bool] = False
    """Whether its surface is the zero set of a field, as a rule without edges."""

    covers: ClassVar[bool] = False
    """Whether it shows a field where the object that the field fills would hide it."""
    decorates: ClassVar[bool] = False
    """Whether a model whose outputs it reads still draws itself."""

    material: MaterialRef | None = field("How it looks; by default glossy, in a color by order.", None)
    color: Color | None = field("Color in place of the material's.", None)
    hidden: bool = field("Not drawn (but may be used by others).", False)

    def own_box(self) -> str:
        """The fields `size` and `corner` of a model that spreads in the same box, for messages; empty for no box."""
        return ""

    @property
    def traced(self) -> str:
        """The kind of field by which rays are intersected with it (frame.Implicit).

        "formula"; "density" (a sum over points); "skeleton" (a density of other primitives); or "" for none.
        """
        return ""

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Drawn]:
        """Shapes of `sceneql.frame` now, as ``Mesh(name, surface, vertices, triangles)``, counterclockwise outside.

        ``place`` (3, 4) maps the parent's coordinates to the world; an object with a position and rotation of its own
        is a `sceneql.shapes.placement.Placed`, whose ``local(moment)`` is composed with it. A field's value now is
        ``moment.at(self.radius)``, its look ``moment.surface(name, self.material, self.color)``;
        what is the same in every frame is made once by ``moment.kept``.
        """
        raise TypeError(f"`{self._word()}` cannot be drawn")

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of a field, negative inside, at the point (x, y, z) of the parent's coordinates, given by registers.

        Near the surface it should approximate a signed distance. Raises TypeError where the object has no inside.
        """
        raise TypeError(f"`{self._word()}` has no inside")

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """Registers of the linear RGB at a point of the parent's coordinates; None: its ``surface`` has one color."""
        return None

    def domain(self) -> Any:
        """Its inside as a two-dimensional domain of fields (grids.domain.cut.Level with bounds); None: it is none."""
        return None

    def doubts(self, clock: Clock) -> Iterable[Doubt]:
        """Doubtful settings of its own fields, given the clock; warnings of `check`."""
        return ()

    def odd_section(self) -> str:
        """What its section at z = 0 is, where that is most likely not meant, and how it would be; empty for others."""
        return ""

    def holes(self) -> str:
        """The holes of a surface that should be closed, as ``3 holes of 117 edges``; empty where there are none."""
        return ""

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) [m] of a bounding box in the world; infinite where it is unbounded."""
        raise TypeError(f"`{self._word()}` has no extent")

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """Volume, center and second moments of its inside in its parent's coordinates, for rigid bodies.

        None: they are to be integrated from its field. ``measure`` returns those of a member in this object's own
        coordinates. Raises ValueError where it has no inside to weigh, as an open mesh.
        """
        return None

    def convex(self, moment: Moment, center: Floats) -> Any:
        """Its convex shape for contacts of rigid bodies (contacts.distance.convex), in its own axes.

        ``center`` (3,) [m]: the origin of the shape. Raises TypeError or ValueError where it has none that these
        contacts cover.
        """
        raise TypeError(f"`{self._word()}` has no convex shape that they know")

    def curved(self, moment: Moment) -> Any:
        """Its smooth shape for exact contacts of rigid bodies (contacts.rigid_exact.curved), in its own axes.

        Raises TypeError or ValueError where it has none that these contacts cover.
        """
        raise TypeError(f"`{self._word()}` has no smooth shape that they know")

    def read(self, output: str, moment: Moment) -> Any:
        """An output of ``gives`` now, SI."""
        raise KeyError(output)

    def excess(self, count: Callable[[Value], int | None]) -> Iterable[tuple[Value, str]]:
        """Lists that are too long for it, each with the reason.

        ``count`` returns the length of a list where it is known.
        """
        return ()

    def cut_by_default(self, flat: bool = False) -> tuple[str, str]:
        """The default bounds, as text, that cut an unbounded object where the script gives none, and larger ones.

        ``flat``: whether its section at z = 0 alone counts. Empty where nothing is cut; the second also where none are
        known that hold all of it.
        """
        return "", ""

    def members(self) -> tuple[Ref, ...]:
        """The objects that this one draws, so that they are not drawn by themselves."""
        return ()

    def joins(self) -> tuple[Ref, ...]:
        """The members from whose insides its own is made."""
        return ()

    def labels(self, name: str, moment: Moment) -> Iterable[tuple[Any, Any, str]]:
        """Labels: the world points (n, 3) [m] that each stands beside, the direction (3,) of its line, and its text."""
        return ()

    def remembers(self) -> Iterable[tuple[Value, float, float]]:
        """Past values that it needs (`Moment.past`): each with how far back [s] and at which interval [s]."""
        return ()

    def courses(self, start: Moment) -> Iterable[Value]:
        """Values that it needs over the whole run (`Moment.course`), found at its start.

        The physics then runs once ahead.
        """
        return ()

    def looks_ahead(self) -> str:
        """What it derives from the bounds of the whole film (`Moment.bounds`), as text for `explain`.

        Empty for nothing.
        """
        return ""

    def _word(self) -> str:
        """Its name in scripts, which is its file's."""
        return type(self).__module__.rpartition(".")[2]

    def collider(self, assembly: Assembly) -> Collider:
        """Its surface for contacts. Raises TypeError where the object cannot be collided with."""
        raise TypeError(f"`{self._word()}` cannot be collided with")


@dataclass(frozen=True, slots=True)
class Collider:
    """A surface for contacts: the module of its kernels (contacts/shape_kernels.py), and offsets into the floats.

    ``position_at``: 3 floats, center; ``rotation_at``: 4 floats, quaternion; ``size_at``: as the shape's file says;
    ``depth_at``: a lower bound of the greatest depth [m] inside; ``data``: further integers for the shape.
    """

    kernels: str
    """``"package.module"``."""
    position_at: int
    rotation_at: int
    size_at: int
    depth_at: int
    data: tuple[int, ...] = ()
    flat: bool = False
    """Whether it is a whole plane."""
