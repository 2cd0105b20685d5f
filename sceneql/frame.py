"""Plain values handed to renderers: a closed set. Every object, material and light lowers itself to these.

Space is right-handed, y up, meters; a camera looks along its -z; pixel (0, 0) is top left; the front of a triangle
is counterclockwise. Colors are linear, scene-referred RGB. Arrays are numpy arrays; this module imports none.

An array of a shape that never changes is read-only (``held``), and it is the same object from frame to frame for as
long as its numbers are the same. So ``mesh.vertices is before.vertices`` says that nothing has moved, and what is made
of arrays that ``is_held`` is good for as long as these live (``shapes.held_arrays``). All other arrays tell nothing
about those of the next frame: what is made of them goes with the frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from numpy import float64, int32
    from numpy.typing import NDArray

    Floats = NDArray[float64]
    Ints = NDArray[int32]
else:  # names to import where numpy is not
    Floats = Ints = object

RGB = tuple[float, float, float]


def held(array: Any) -> Any:
    """The array, read-only from now on, as those are that it is a view of: a promise that its numbers never change.

    A view of it that was made before may still be written to, and must not be.
    """
    one = array
    while hasattr(one, "flags"):
        one.flags.writeable = False
        one = one.base
    return array


def is_held(array: Any) -> bool:
    """Whether an array never changes: it is read-only, and so are all that it is a view of."""
    while hasattr(array, "flags") and not array.flags.writeable:
        array = array.base
    return array is None


@dataclass(frozen=True, slots=True)
class Surface:
    """How a surface answers light: one parametric record (Burley 2012, simplified: metallic and roughness)."""

    color: RGB = (0.8, 0.8, 0.8)
    roughness: float = 0.5
    """0 mirror-sharp to 1 matte; the GGX width is its square (Walter et al. 2007; Burley 2012)."""
    metallic: float = 0.0
    specular: float = 0.04
    """Reflectance at normal incidence of the dielectric part; 0 for a perfectly matte one."""
    transmission: float = 0.0
    index_of_refraction: float = 1.5
    emission: RGB = (0.0, 0.0, 0.0)
    checker_size: float = 0.0
    """Side [m] of a checker pattern in world x and z (and y off horizontal faces); 0 for none."""
    checker_color: RGB = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles; with ``normals`` they are shaded smooth, without they are flat.

    Of one that holds still the arrays are held (``is_held``), each by itself: colors may change where places do not.
    """

    name: str
    surface: Surface
    vertices: Floats
    """(n, 3) [m], world."""
    triangles: Ints
    """(m, 3) indices, counterclockwise seen from the front."""
    normals: Floats | None = None
    """(n, 3) unit."""
    colors: Floats | None = None
    """(n, 3) linear RGB in place of the surface's."""
    rest: Floats | None = None
    """(n, 3) [m] where the material of each vertex stood before it was deformed: of one solid held, and the same array
    over the film, but where it is cut open."""
    paint: Tape | None = None
    """The color by ``rest``, evaluated at every point of a triangle, in place of colors: the last three registers are
    linear RGB; the surface's where they are undefined."""


@dataclass(frozen=True, slots=True, eq=False)
class Quadric:
    """The convex solid {sum squares_k p_k^2 + linear_k p_k + constant <= 0} within low <= p <= high, p local.

    Carries sphere, ellipsoid, plane (half-space), box (squares and linear zero, constant -1) and capped cylinder.
    """

    name: str
    surface: Surface
    to_local: Floats
    """(3, 4) affine map from world to local coordinates."""
    squares: tuple[float, float, float]
    """>= 0, so that the solid is convex."""
    linear: tuple[float, float, float]
    constant: float
    low: tuple[float, float, float]
    """May be -inf."""
    high: tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """An implicit field f(x, y, z) as straight-line code in static single assignment; the solid is {f < 0}.

    Row k of ``code`` is (operation, left, right, third) and writes register k; operands are registers, or for the
    constant operation an index into ``constants`` and for a density a range of ``parts``. The last register is the
    value. Numbers are data: a film with moving parts changes constants and parts, never code.
    """

    code: Ints
    """(n, 4)."""
    constants: Floats
    """(c,)."""
    parts: Floats
    """(p, 8): skeleton parts of density fields: end a (3), end b (3), radius [m], weight; two rows each where they are
    of other shapes or kernels (field.skeleton_kernels)."""


@dataclass(frozen=True, slots=True, eq=False)
class Implicit:
    """The solid {tape < 0} inside the world box low..high (it is cut at the box and capped there).

    With ``within`` it is the sheet {tape = 0} inside the solid {within < 0} and the box instead: seen from both sides,
    open where it is cut, and there also where the field only touches zero.
    """

    name: str
    surface: Surface
    tape: Tape
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    paint: Tape | None = None
    """The color at a point of the surface, in place of the surface's: the last three registers are linear RGB."""
    within: Tape | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Spheres, many: particles. Or soft discs that face the camera, each brightest in its middle."""

    name: str
    surface: Surface
    centers: Floats
    """(n, 3) [m]."""
    radii: Floats
    """(n,) [m]."""
    colors: Floats | None = None
    """(n, 3) linear RGB."""
    soft: Literal["adds", "covers"] | None = None
    """None: solid spheres. Discs: their light is added to what is behind, or covers it. Those that add, or whose
    surface emits, take no light. They throw shadows on one another alone and are not seen in mirrors."""
    opacity: float = 1.0
    """Of a disc in its middle; of one that adds, what its light is multiplied by."""


@dataclass(frozen=True, slots=True, eq=False)
class Segments:
    """Capsules, many: springs, ropes, bones, trails."""

    name: str
    surface: Surface
    ends: Floats
    """(n, 2, 3) [m]."""
    radii: Floats
    """(n,) [m]."""
    colors: Floats | None = None
    """(n, 3) linear RGB."""


@dataclass(frozen=True, slots=True, eq=False)
class Mist:
    """A volume that absorbs light on its way, and scatters the share of it that is its surface's color.

    It stands in the box low..high of coordinates in which absorption[k, j, i] is that of the point (i, j, k); between
    these it is trilinear. Where it is not lit it throws no shadow, and has that color itself where it is thick.
    """

    name: str
    surface: Surface
    to_cells: Floats
    """(3, 4) affine map from the world to these coordinates."""
    absorption: Floats
    """(nz, ny, nx) [1/m], not below 0."""
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    lit: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """The surface on which numbers on a grid, trilinear between its nodes, change their sign; seen from both sides.

    It stands in the box low..high of coordinates in which values[k, j, i] is that of the point (i, j, k), open where it
    is cut. Its front is where the values are positive; it is shaded by their central differences at the nodes.
    """

    name: str
    surface: Surface
    to_nodes: Floats
    """(3, 4) affine map from the world to these coordinates."""
    values: Floats
    """(nz, ny, nx), two or more along each axis."""
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    """Within 0 and (nx, ny, nz) - 1."""
    bounds: Floats | None = None
    """(nz, ny, nx): with these, the surface is only where their interpolant is negative."""


Shape = Mesh | Quadric | Implicit | Points | Segments | Mist | Grid


@dataclass(frozen=True, slots=True)
class Sun:
    """A distant light: ``direction`` points from the scene towards it (unit)."""

    direction: RGB
    irradiance: RGB
    """On a surface facing it (a white matte surface there has radiance irradiance/pi)."""
    angle: float = 0.009
    """Angular diameter [rad]; larger gives softer shadows."""


@dataclass(frozen=True, slots=True)
class PointLight:
    """A small glowing sphere; intensity falls with the square of the distance."""

    position: RGB
    intensity: RGB
    """Radiant intensity [W/sr]; a power P shines P/(4 pi) in every direction."""
    radius: float = 0.05
    """[m]; larger gives softer shadows."""


@dataclass(frozen=True, slots=True)
class SoftBox:
    """A rectangle of the sky that polished surfaces mirror, upright; ``direction`` points from the scene towards it."""

    direction: RGB
    size: tuple[float, float]
    """Width and height [rad], below pi."""
    radiance: RGB
    """What it adds to the sky's."""


@dataclass(frozen=True, slots=True)
class Sky:
    """Light from all around: radiance blends from ``horizon`` to ``zenith`` above and to ``ground`` below."""

    zenith: RGB
    horizon: RGB
    ground: RGB
    visible: RGB | None = None
    """Seen by camera rays in place of the sky, where given (a plain background)."""
    below: RGB | None = None
    """What `visible` becomes below the horizon, as a floor that fades into it would; by default it stays as it is."""
    fade: float | None = None
    """Sine of the angle to an endless floor below which that fades into the background; by default near the horizon."""
    boxes: tuple[SoftBox, ...] = ()
    """Seen in reflections alone: matte surfaces have the blended light, which is that of a sky with boxes in it."""


LightSource = Sun | PointLight | Sky


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A camera at an instant."""

    origin: tuple[float, float, float]
    """[m]; of an orthographic view, the center of its window."""
    axes: Floats
    """(3, 3): rows right, up, back (unit, world); it looks along -back."""
    size: tuple[int, int]
    """Width and height [pixels]."""
    half_height: float
    """Perspective: tan(vertical field of view / 2). Orthographic: half the window's height [m]."""
    orthographic: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """What is drawn at one instant: what an output gets that makes no picture (`Tools.frame`)."""

    index: int
    """Of the output's frames, from 0."""
    time: float
    """[s] of simulation."""
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True, eq=False)
class SeenFrame(Frame):
    """A frame in its light, from a camera: all that a renderer needs to know of one instant."""

    lights: tuple[LightSource, ...]
    view: View
    seed: int = 0
