"""The families of pictures: cameras, lights, materials, renderers, overlays."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds.types import FixedTime, Scalar
from sceneql.kinds.word import Kind, field

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import RGB, LightSource, Surface, View
    from sceneql.kinds.doubt import Doubt
    from sceneql.kinds.moment import Moment, Remembered
    from sceneql.kinds.values import Value


class Camera(Kind):
    """Where the film is seen from."""

    family: ClassVar[str] = "cameras"
    yields: ClassVar[bool] = False
    """Whether it frames the scene within the margins that overlays leave free (`Moment.room`)."""

    def looks_ahead(self) -> bool:
        """Whether it frames all that is drawn over the whole film: the physics then runs once before the pictures."""
        return True

    def aims(self) -> Iterable[str]:
        """Names of the parts that it is aimed at: what the picture is about, where the script says so."""
        return ()

    def remembers(self) -> Iterable[tuple[Remembered, float, float]]:
        """Past values that it needs (`Moment.past`): each with how far back [s] and at which interval [s]."""
        return ()

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view at the moment; ``size``: width and height [pixels]."""
        raise NotImplementedError


class Light(Kind):
    """A light; it lowers to frame.LightSource."""

    family: ClassVar[str] = "lights"
    stages: ClassVar[bool] = False
    """Whether it is a stage light: a scene with such lights alone, and no ground of its own, may get a ground."""

    def doubts(self) -> Iterable[Doubt]:
        """Doubtful settings of its own fields where there is a ground; warnings of `check`."""
        return ()

    def lower(self, moment: Moment) -> Iterable[LightSource]:
        """Its light sources (the closed set of sceneql.frame) at the moment."""
        raise NotImplementedError


class Material(Kind):
    """How a surface looks."""

    family: ClassVar[str] = "materials"
    clear: ClassVar[bool] = False
    """Whether one sees through it."""
    told_by: ClassVar[Mapping[str, str]] = {}
    """Fields that tell that this material is meant, as other programs call them, each with the field here that takes
    its value; or "" for none."""

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """The surface at the moment; ``color`` (linear RGB), where given, replaces the material's own."""
        raise NotImplementedError


class Renderer(Kind):
    """Draws a frame."""

    family: ClassVar[str] = "renderers"
    data: ClassVar[bool] = False
    """Whether its pictures are data (depth, normals), which are not developed."""

    def kernels(self, traced: Collection[str]) -> tuple[str, ...]:
        """Modules whose import compiles its kernels; ``traced``: the kinds of the objects' fields (Object.traced)."""
        return ()

    def draw(self, frame: Any) -> Any:
        """The Picture of a frame."""
        raise NotImplementedError

    def draft(self) -> Renderer | None:
        """The renderer for the coarser frames of `render --draft`; None where that is refused."""
        return None


class Overlay(Kind):
    """Something that is drawn over a finished picture: a legend, a caption."""

    family: ClassVar[str] = "overlays"

    fills: ClassVar[bool] = False
    """Whether it can fill a panel of a layout."""
    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("from", "until", "to", "start", "end", "begin", "time", "times"),
        "from when to when it is there is said by `show`: `show: (time > 1 s)*(time < 3 s)`",
    )

    show: Scalar | None = field("It is there only while this is not 0, as `time > 2 s`; by default always.", None)
    fade: FixedTime = field(
        "How long it takes to come once `show` begins, and to go before it ends.", "0 s", at_least=0
    )
    dark: bool = field("Light letters on a dark panel.", False)

    def courses(self) -> Iterable[Value]:
        """Values needed over the whole run (`Moment.course`); the physics then runs once before."""
        return ()

    def places(self) -> tuple[str, ...]:
        """Candidate places in the picture (`place`), best first; only the one that the script names, if it does.

        Of several it gets the one that hides the least of the scene. Empty for an overlay that follows the scene.
        """
        return ()

    def box(self, place: str, size: tuple[int, int], moment: Moment, scale: float) -> tuple[int, int, int, int] | None:
        """Left, top, right, bottom [pixels] of its box at a place; the whole picture is ``scale`` times as high."""
        return None

    def fades(self) -> Iterable[Value]:
        """Values needed over the whole run in order to fade in and out: those of `show`."""
        return () if self.show is None or self.fade == 0 else (self.show,)

    def variants(self) -> bool:
        """Whether it shows the variants of the script."""
        return False

    def fill(self, pixels: NDArray[uint8], moment: Moment, scale: float) -> None:
        """Draw over all pixels (h, w, 3) of a panel; the whole picture is ``scale`` times as high."""
        raise NotImplementedError

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
        scale: float = 1.0,
    ) -> None:
        """Draw on a developed picture (h, w, 3); ``develop`` brings linear RGB (h, w, 3) to its display pixels.

        The whole picture, of which this may be a panel, is ``scale`` times as high.
        """
        raise NotImplementedError
