"""Solids: objects with an implicit field, negative inside; how they are drawn and measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import Gives, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Type
from sceneql.shapes.placement import Placed, compose, inverse, mapped_box

if TYPE_CHECKING:
    from sceneql import frame
    from sceneql.frame import Floats, Surface
    from sceneql.kinds import FieldBuilder, Moment, Object, Shaped
    from sceneql.mesh.bounded import Corner

INFINITY = float("inf")
LARGEST, SMALLEST = 1e100, 1e-100
"""[m] Bounds of coordinates and sizes of drawn solids: products of a few lengths neither overflow nor underflow."""
COARSEST = 1e-7
"""Spacing of float64 numbers relative to a traced solid's size, above which the certified root search along a ray does
not end: it would bisect the ray forever, since rounding prevents a proof on any piece."""
MARGIN = 1e-6
"""Margin of the box around a traced field, relative to the solid's size."""
CELLS = 96
"""Cells along the longest side of the box in which a solid is measured."""
MEASURES: Mapping[str, Gives] = {
    "pieces": Gives(Type(), f"Of how many closed surfaces it is, by marching cubes with {CELLS} cells along it."),
    "volume": Gives(quantity_type(dim.VOLUME), "What they hold, likewise, but curved between the vertices."),
}


class Solid(Placed):
    """An object with an implicit field in its own coordinates."""

    gives: ClassVar[Mapping[str, Gives]] = MEASURES

    @property
    def traced(self) -> str:
        """A field of its own."""
        return "formula"

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of its field, negative inside; (x, y, z) are registers of a point in its own coordinates."""
        raise NotImplementedError

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """Low and high corner of a box around it in its own coordinates."""
        raise NotImplementedError

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of its field; (x, y, z) are registers of a point in its parent's coordinates."""
        return self.inside(build, *build.affine(inverse(self.local(moment)), x, y, z), moment)

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of the box around its own box, which ``place`` maps to the world."""
        return mapped_box(compose(place, self.local(moment)), *self.reach(moment))

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[frame.Shape]:
        """The solid as a shape with its field as a tape."""
        return traced(self, name, place, moment)

    def read(self, output: str, moment: Moment) -> Any:
        """One of its measures."""
        return measure(self, output, moment)


def field_in_box(
    solid: Shaped, name: str, place: Floats, moment: Moment, verb: str
) -> tuple[frame.Tape, Corner, Corner] | None:
    """(tape of an object's field, low and high corner of its box with a margin); None where the box is empty.

    ``verb``: a participle for messages, as ``drawn``. Raises TypeError for an unbounded object or one without an
    inside, ValueError for one too large, too small or too far away for float64.
    """
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder

    low, high = solid.extent(place, moment)
    if not (high > low).all():
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        finite = np.isfinite(high - low).all()
    if not finite:
        raise TypeError(f"{name} is unbounded, and cannot be {verb}: intersect it with a box")
    told_by_numbers(low, high)
    _not_rounded_away(low, high)
    build = TapeBuilder()
    value = solid.implicit(build, *build.affine(inverse(place), build.x, build.y, build.z), moment)
    room = MARGIN * float(np.max(high - low))
    return build.finish(value), triple(low - room), triple(high + room)


def traced(solid: Shaped, name: str, place: Floats, moment: Moment) -> Iterable[frame.Implicit]:
    """An object with a field as one frame.Implicit in its box with a margin; none where the box is empty.

    Raises as ``field_in_box``.
    """
    from sceneql import frame
    from sceneql.field.tape.builder import TapeBuilder

    found = field_in_box(solid, name, place, moment, "drawn")
    if found is None:
        return
    tape, low, high = found
    surface = moment.surface(name, solid.material, solid.color)
    colored = TapeBuilder()
    at = colored.affine(inverse(place), colored.x, colored.y, colored.z)
    hues = solid.hues(colored, *at, surface, moment)
    yield frame.Implicit(name, surface, tape, low, high, None if hues is None else colored.finish(*hues))


def by_field(kind: Object, name: str, place: Floats, moment: Moment) -> Iterable[frame.Shape]:
    """Shapes of an object: its implicit field (`traced`) where it has an inside, else the shapes it is drawn by."""
    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.kinds import Object

    if type(kind).implicit is Object.implicit:
        return kind.lower(name, place, moment)
    found: list[frame.Shape] = []
    try:
        found += traced(kind, name, place, moment)
    finally:
        if not found:
            build = TapeBuilder()
            kind.implicit(build, build.x, build.y, build.z, moment)  # raises first where a part has no inside
    return found


def told_by_numbers(low: Floats, high: Floats) -> None:
    """Raise ValueError for a box beyond LARGEST or smaller than SMALLEST, where squares overflow or underflow."""
    import numpy as np

    farthest, size = float(np.abs([low, high]).max()), float((high - low).max())
    if farthest > LARGEST:
        raise ValueError(f"it reaches {farthest:.3g} m away from the origin, more than {LARGEST:g} m")
    if size < SMALLEST:
        raise ValueError(f"its size is {size:.3g} m, less than {SMALLEST:g} m")


def _not_rounded_away(low: Floats, high: Floats) -> None:
    """Raise ValueError for a box so far from the origin that float64 does not resolve a surface in it (COARSEST)."""
    import numpy as np

    farthest, size = float(np.abs([low, high]).max()), float((high - low).max())
    apart = float(np.spacing(farthest))
    if apart > COARSEST * size:
        raise ValueError(
            f"it reaches {farthest:.3g} m away from the origin, where float64 numbers are {apart:.2g} m apart:"
            f" too coarse for the surface of a solid of {size:.3g} m"
        )


def measure(solid: Object, output: str, moment: Moment) -> Any:
    """The output ``pieces``, a number of closed surfaces, or ``volume`` [m^3] of an object with a field; 0 if empty.

    By marching cubes with CELLS cells along the longest side. Raises TypeError for an unbounded object.
    """
    import numpy as np

    from sceneql.mesh.cubes.polygonise import polygonise
    from sceneql.mesh.measures import curved_volume, pieces

    for shape in traced(solid, "it", np.eye(3, 4), moment):
        cell = max(high - low for low, high in zip(shape.low, shape.high, strict=True)) / CELLS
        mesh = polygonise(shape.tape, shape.low, shape.high, cell)
        if output == "pieces":
            return pieces(mesh.triangles)
        return curved_volume(mesh.vertices, mesh.triangles, mesh.normals)
    return 0.0


def quadric(
    name: str,
    surface: Surface,
    place: Floats,
    *,
    squares: tuple[float, float, float] = (0.0, 0.0, 0.0),
    linear: tuple[float, float, float] = (0.0, 0.0, 0.0),
    constant: float,
    half: tuple[float, float, float] = (INFINITY, INFINITY, INFINITY),
) -> frame.Quadric:
    """A convex quadric solid, clipped at the box -half..half; ``place`` (3, 4) maps its coordinates to the world.

    Raises ValueError where it is too large or too small for float64.
    """
    from sceneql import frame

    low = (-half[0], -half[1], -half[2])
    if max(half) < INFINITY:
        told_by_numbers(*mapped_box(place, low, half))
    return frame.Quadric(name, surface, inverse(place), squares, linear, constant, low, half)


def triple(vector: Any) -> tuple[float, float, float]:
    """A vector (3,) as floats."""
    x, y, z = (float(c) for c in vector)
    return x, y, z


def length(build: FieldBuilder, *registers: int) -> int:
    """Register of the Euclidean length of a vector."""
    total = build.op("square", registers[0])
    for register in registers[1:]:
        total = build.op("add", total, build.op("square", register))
    return build.op("sqrt", total)


def less(build: FieldBuilder, register: int, number: float) -> int:
    """Register of a value minus a number."""
    return build.op("sub", register, build.constant(number))


def largest(build: FieldBuilder, *registers: int) -> int:
    """Register of the largest of some values."""
    result = registers[0]
    for register in registers[1:]:
        result = build.op("max", result, register)
    return result


def block(build: FieldBuilder, registers: tuple[int, int, int], low: Any, high: Any) -> int:
    """Register of the signed distance in the maximum norm to the box low..high, whose sides may be infinite."""
    sides = []
    for register, down, up in zip(registers, low, high, strict=True):
        if down == -up and up < INFINITY:
            sides.append(less(build, build.op("abs", register), up))
            continue
        if up < INFINITY:
            sides.append(less(build, register, up))
        if down > -INFINITY:
            sides.append(build.op("sub", build.constant(down), register))
    return largest(build, *sides)
