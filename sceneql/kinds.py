"""The vocabulary's grammar: what a word of each family is, and the types its fields may have.

A word is one file with one class, named as the file in CamelCase (``mass_spring.py``: ``MassSpring``), derived from a
family class below. The class is the schema and the manual: fields with type, default, range and a line of text;
``gives``, its outputs; its docstring. Read this file first when adding a word.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Protocol

from pydantic import BaseModel, ConfigDict, Field, model_validator

from sceneql.quantities import dimension as dim
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Link, Shape, Symbol, Type, walk
from sceneql.quantities.parser import parse_value
from sceneql.quantities.span import Source, Span

if TYPE_CHECKING:
    from sceneql.frame import RGB, Floats, Light, Surface, View
    from sceneql.frame import Shape as Drawn
    from sceneql.system import Assembly, Bodies, ModelState, Stepper


# --- what a field may hold -------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Value:
    """A value in time: a constant, an expression of `time`, a link to another part's output, or keyframes."""

    expr: Expr
    span: Span | None = None

    @property
    def constant(self) -> bool:
        """Whether it depends neither on time nor on another part."""
        return not any(isinstance(node, Symbol | Link) for node in walk(self.expr))

    @property
    def links(self) -> tuple[Link, ...]:
        """The outputs of other parts that it reads."""
        return tuple(node for node in walk(self.expr) if isinstance(node, Link))

    def number(self) -> Any:
        """The float, or nested tuple of floats, of a constant value, in SI."""
        return evaluate(self.expr, {})


@dataclass(frozen=True, slots=True)
class Quantity:
    """Type of a field that holds a quantity: dimension and shape.

    On a ``Value`` it may vary in time; on a ``float`` or ``tuple`` it must be constant and is stored in SI.
    """

    dimension: Dimension | None
    """None: any."""
    shape: Shape | None = ()
    """None: any."""
    needs_unit: bool = False
    """A bare number is refused (angles, temperatures)."""
    direction: bool = False
    """Not all components may be 0."""
    over_time: bool = False
    """May look over the whole run, as with `final`."""


class Paint:
    """Marks a color: CSS name, ``#rrggbb``, three sRGB numbers or an expression such as ``hue(i/7)``."""


class Turn:
    """Marks a rotation: ``{about: z, angle: 30 deg}``, intrinsic ``{xyz: ...}``, or a quaternion ``[w, x, y, z]``."""


@dataclass(frozen=True, slots=True)
class Refers:
    """Marks a ``Ref`` and the family it names; an entry written in place is allowed too."""

    family: str
    also: str = ""
    """A second family whose parts it may name."""

    def __str__(self) -> str:
        return f"{self.family} or {self.also}" if self.also else self.family


class SceneFile:
    """Marks a text that is the path of a file, read as a path below the scene's folder where there is a file."""


@dataclass(frozen=True, slots=True)
class Ref:
    """A named part of the script."""

    name: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Formula:
    """A textbook formula of an `implicit` or `equations` entry: bound over plain numbers, symbols free."""

    expr: Expr
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Symbols:
    """Marks a ``Formula`` and names the free symbols that it may use besides defines; ``None``: the kind binds them."""

    names: tuple[str, ...] | None


Scalar = Annotated[Value, Quantity(dim.PLAIN)]
Length = Annotated[Value, Quantity(dim.LENGTH)]
Time = Annotated[Value, Quantity(dim.TIME)]
Mass = Annotated[Value, Quantity(dim.MASS)]
Angle = Annotated[Value, Quantity(dim.PLAIN, needs_unit=True)]
Speed = Annotated[Value, Quantity(dim.VELOCITY)]
Power = Annotated[Value, Quantity(dim.POWER)]
Stiffness = Annotated[Value, Quantity(dim.STIFFNESS)]
Damping = Annotated[Value, Quantity(dim.DAMPING)]
Position = Annotated[Value, Quantity(dim.LENGTH, (3,))]
Velocity = Annotated[Value, Quantity(dim.VELOCITY, (3,))]
Acceleration = Annotated[Value, Quantity(dim.ACCELERATION, (3,))]
Direction = Annotated[Value, Quantity(dim.PLAIN, (3,), direction=True)]
Points = Annotated[Value, Quantity(dim.LENGTH, (None, 3))]
Lengths = Annotated[Value, Quantity(dim.LENGTH, (None,))]
Color = Annotated[Value, Paint()]
Rotation = Annotated[Value, Turn()]
Axis = Annotated[tuple[float, float, float], Quantity(dim.PLAIN, (3,))]

FixedScalar = Annotated[float, Quantity(dim.PLAIN)]
FixedLength = Annotated[float, Quantity(dim.LENGTH)]
FixedTime = Annotated[float, Quantity(dim.TIME)]
FixedMass = Annotated[float, Quantity(dim.MASS)]
FixedAngle = Annotated[float, Quantity(dim.PLAIN, needs_unit=True)]
FixedStiffness = Annotated[float, Quantity(dim.STIFFNESS)]
FixedDamping = Annotated[float, Quantity(dim.DAMPING)]
FixedFrequency = Annotated[float, Quantity(dim.FREQUENCY)]
FixedPosition = Annotated[tuple[float, float, float], Quantity(dim.LENGTH, (3,))]
FixedVelocity = Annotated[tuple[float, float, float], Quantity(dim.VELOCITY, (3,))]

Measured = Annotated[Value, Quantity(None, None)]
"""Any output or expression: what a record writes."""
Expected = Annotated[Value, Quantity(None, None, over_time=True)]
"""Any expression, over the whole run too: what an expectation compares."""

ObjectRef = Annotated[Ref, Refers("objects")]
ModelRef = Annotated[Ref, Refers("models")]
CameraRef = Annotated[Ref, Refers("cameras")]
MaterialRef = Annotated[Ref, Refers("materials")]
RendererRef = Annotated[Ref, Refers("renderers")]
DrawnRef = Annotated[Ref, Refers("objects", also="models")]
"""Something that can be seen."""

File = Annotated[str, SceneFile()]

REQUIRED: Any = ...

MOST_MOMENTS = 1_000_000


class Exceeds(ValueError):
    """A size beyond what is allowed: refused with the code `limit-refused` where the script says it."""


def field(
    doc: str,
    default: Any = REQUIRED,
    *,
    above: float | None = None,
    at_least: float | None = None,
    below: float | None = None,
    at_most: float | None = None,
) -> Any:
    """A field with its line of the manual, its default *as a script would write it*, and its range in SI.

    A text default (``"0.5 m"``) is read by the field's own grammar; None means that the field may be left out.
    Ranges hold for every component; a value that varies in time is checked where it is evaluated.
    """
    limits = {"above": above, "at_least": at_least, "below": below, "at_most": at_most}
    extra: Any = {"limits": {k: v for k, v in limits.items() if v is not None}, "default": default}
    if default is REQUIRED:
        return Field(description=doc, json_schema_extra=extra)
    return Field(default=default, description=doc, json_schema_extra=extra)


def literal(text: str, quantity: Quantity) -> Value:
    """The Value of a text without names, as in a default. Raises ScriptError."""
    source = Source("default", text)
    found = Diagnostics()
    expr = bind(parse_value(text, Span(source, 0, len(text))), lambda parts, span: None, found)
    found.raise_errors()
    if expr is None:
        raise ScriptError([])
    return Value(expr)


GRAMMAR: Mapping[type, Any] = {Paint: Quantity(dim.PLAIN, (3,)), Turn: Quantity(dim.PLAIN, (4,))}
"""How the default of a color (three sRGB numbers) and of a rotation (a quaternion) is written."""


def written_name(name: str) -> str:
    """A field's name in a script: ``from_`` is written ``from``, which Python does not allow as a name."""
    return name.removesuffix("_")


class Record(BaseModel):
    """A group of fields inside a word (a mass, a spring, a clock): the same types, no methods of a family."""

    # Schemas are built when a word is first used: most words of the vocabulary never are.
    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", arbitrary_types_allowed=True, defer_build=True)

    @model_validator(mode="before")
    @classmethod
    def _read_defaults(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        filled = dict(given)
        for name, info in cls.model_fields.items():
            if name in filled or not isinstance(info.default, str):
                continue
            for mark in info.metadata:
                if isinstance(mark, Quantity | Paint | Turn):
                    value = literal(info.default, GRAMMAR.get(type(mark), mark))
                    filled[name] = value if info.annotation is Value else value.number()
        return filled


@dataclass(frozen=True, slots=True)
class Gives:
    """An output of a word: its type and its line of the manual."""

    type: Type
    doc: str


def quantity_type(dimension: Dimension, shape: Shape = ()) -> Type:
    """Type of an output."""
    return Type(shape, dimension)


class Kind(Record):
    """A word: its fields, its outputs, its manual."""

    family: ClassVar[str] = ""
    also_under: ClassVar[str] = ""
    """Another section whose entries may be of this family too (a collision is a force to most)."""
    gives: ClassVar[Mapping[str, Gives]] = {}
    imports: ClassVar[tuple[str, ...]] = ()
    """Libraries that its running methods import and that scenes without it do without (told by `explain`)."""

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """The outputs of an entry. ``written`` is its fields as plain nested dicts, lists and texts.

        Words whose outputs have the script's own names (``spring.bob.position``) add them here.
        """
        return cls.gives

    @classmethod
    def formula_symbols(cls, written: Mapping[str, Any]) -> tuple[str, ...]:
        """The free symbols of its formulas that are marked ``Symbols(None)``; ``written`` as in `outputs`."""
        return ()


# --- the families ----------------------------------------------------------------------------------------------------


class Moment(Protocol):
    """One instant of the run, as words see it."""

    @property
    def time(self) -> float:
        """[s]"""

    def at(self, value: Value) -> Any:
        """The value now: float, or float64 array of the field's shape, SI. Raises RunFailure if it is not finite."""

    def measure(self, value: Value) -> Any:
        """The value now, finite or not."""

    def read(self, task: str, output: str) -> Any:
        """An output of a part now."""

    def object(self, ref: Ref) -> Object:
        """The kind of an object."""

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        """The surface of object ``name``: its material's, with the color replaced where given; a default by order."""

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of what the named objects draw over the whole film (infinite planes left out)."""


class FieldBuilder(Protocol):
    """What an object needs to write its implicit field (sceneql.field.builder.TapeBuilder)."""

    def constant(self, value: float) -> int:
        """Register of a number."""

    def op(self, name: str, *registers: int) -> int:
        """Register of an operation of the one table."""

    def expression(self, expr: Expr, symbols: Mapping[str, int]) -> int:
        """Register of a scalar expression whose symbols have registers."""

    def affine(self, matrix: Floats, x: int, y: int, z: int) -> tuple[int, int, int]:
        """Registers of a point mapped by a (3, 4) matrix."""

    def density(self, parts: Floats, x: int, y: int, z: int) -> int:
        """Register of a density field: parts (p, 8) as in frame.Tape."""


class Object(Kind):
    """Something to draw, to collide with, to be moved."""

    family: ClassVar[str] = "objects"
    collides: ClassVar[bool] = False
    """Whether contacts that name no surface take it as one (it has a collider)."""

    material: MaterialRef | None = field("How it looks; by default glossy, in a color by order.", None)
    color: Color | None = field("Color in place of the material's.", None)
    hidden: bool = field("Not drawn (but may be used by others).", False)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Drawn]:
        """Closed-set shapes of this instant; ``place`` (3, 4) maps the parent's coordinates to the world."""
        raise TypeError(f"{type(self).__name__} cannot be drawn")

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of a field that is negative inside; (x, y, z) are registers of a point in the parent's coordinates.

        Near the surface it should behave like a distance. Raises TypeError where the object has no inside.
        """
        raise TypeError(f"{type(self).__name__} has no inside")

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of a world box around it; infinite where it is unbounded."""
        raise TypeError(f"{type(self).__name__} has no extent")

    def members(self) -> tuple[Ref, ...]:
        """Objects that are drawn by this one, and so not by themselves."""
        return ()

    def collider(self, assembly: Assembly) -> Collider:
        """Its surface for contacts. Raises TypeError where the object cannot be collided with."""
        raise TypeError(f"{type(self).__name__} cannot be collided with")


@dataclass(frozen=True, slots=True)
class Collider:
    """A surface for contacts: ``shape`` names the gap function of the collision kernels; offsets into the floats.

    ``position_at``: 3 floats, center; ``rotation_at``: 4 floats, quaternion; ``size_at``: shape-specific (plane:
    normal (3); sphere: radius; box: half sides (3)).
    """

    shape: str
    position_at: int
    rotation_at: int
    size_at: int


class Model(Kind):
    """Something with a state in time. `kinematic` ones are functions of time; the others are solved."""

    family: ClassVar[str] = "models"
    kinematic: ClassVar[bool] = False
    has_bodies: ClassVar[bool] = True
    """Whether forces that name no model act on it."""

    def assemble(self, name: str, assembly: Assembly) -> Bodies | None:
        """Reserve state, give initial values, add the terms of its own rate; the point masses forces may act on."""
        raise TypeError(f"{type(self).__name__} has no state")

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state: float or float64 array."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def formula(self, output: str) -> Expr:
        """An output of a kinematic model as an expression of time."""
        raise TypeError(f"{type(self).__name__} is not a function of time")

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Drawn]:
        """How it draws itself where no object of the script does."""
        return ()

    def drives(self) -> Mapping[str, tuple[str, str]]:
        """Fields of objects that it sets: ``{object name: (field, output)}``."""
        return {}


class Force(Kind):
    """Adds to the rate of models."""

    family: ClassVar[str] = "forces"

    on: tuple[ModelRef, ...] | None = field("The models it acts on; by default all that have masses.", None)

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add its terms for one model."""
        raise NotImplementedError

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Potential energy [J] of the model in this force at a state; 0 where there is none."""
        return 0.0


class Contact(Kind):
    """Gives events and impulses."""

    family: ClassVar[str] = "contacts"
    also_under: ClassVar[str] = "forces"

    def ties(self) -> tuple[Ref, ...]:
        """The models and objects it acts between; empty: all models and the floor."""
        raise NotImplementedError

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies, others: tuple[Ref, ...]) -> None:
        """Add gaps and impacts (or local backing off) of one model against the others."""
        raise NotImplementedError

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state."""
        raise TypeError(f"{type(self).__name__} gives no {output}")


class Solver(Kind):
    """Marches a system in time. Sees only its rate, its Jacobian, its invariants and its events."""

    family: ClassVar[str] = "solvers"

    on: tuple[ModelRef, ...] | None = field("The models it marches; by default all.", None)

    def choice(self) -> str:
        """What it chose to do and why, where it chooses a method by itself."""
        return ""

    def stepper(self) -> Stepper:
        """Its compiled step and control."""
        raise NotImplementedError

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest growth factor of a step of the linear system y' = jacobian y (its spectral radius).

        ``partner`` (n,) int: for a position entry of y the index of its velocity, else -1.
        """
        raise NotImplementedError


class Camera(Kind):
    """Where the film is seen from."""

    family: ClassVar[str] = "cameras"

    def looks_ahead(self) -> bool:
        """Whether it frames what is drawn over the whole film, so that the physics runs once ahead of it."""
        return True

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of this instant."""
        raise NotImplementedError


class Illumination(Kind):
    """A light (named so because frame.Light is what it lowers to)."""

    family: ClassVar[str] = "lights"

    def lower(self, moment: Moment) -> Iterable[Light]:
        """Closed-set lights of this instant."""
        raise NotImplementedError


class Material(Kind):
    """How a surface looks."""

    family: ClassVar[str] = "materials"

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """The surface record; ``color``, linear, replaces the material's own where given."""
        raise NotImplementedError


class Renderer(Kind):
    """Draws a frame."""

    family: ClassVar[str] = "renderers"
    kernels: ClassVar[str] = ""
    """The module whose import compiles what it draws with."""
    data: ClassVar[bool] = False
    """Whether its pictures are data (depth, normals), which are not developed."""

    def draw(self, frame: Any) -> Any:
        """The Picture of a frame."""
        raise NotImplementedError


class Tools(Protocol):
    """What the pipeline lends to an output."""

    @property
    def clock(self) -> Clock:
        """Film time and simulation time."""

    def path(self, extension: str) -> Any:
        """Path of the output's file."""

    def pixels(self, output: Picture, moment: Moment) -> Any:
        """The developed picture (h, w, 3) uint8 of this output's camera, renderer and size."""

    def encoder(self, word: str, **settings: Any) -> Any:
        """A writer with ``write``, ``close`` (whole under its final name) and ``abort`` (what was made, beside it)."""


class Sink(Protocol):
    """An open output. The paths that it returns are those of the files it has made."""

    def take(self, moment: Moment) -> None:
        """One instant of those asked for."""

    def close(self) -> Iterable[Any]:
        """Finish: files appear under their final names."""

    def abort(self) -> Iterable[Any]:
        """The run failed: keep what was made beside the final name."""


class Output(Kind):
    """Something that is made: a film, a picture, a table."""

    family: ClassVar[str] = "outputs"

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] of the simulation that it wants, increasing, from 0 to ``clock.end``."""
        raise NotImplementedError

    def open(self, tools: Tools) -> Sink:
        """Start it."""
        raise NotImplementedError


class Picture(Output):
    """An output that draws frames: what every picture has."""

    size: tuple[int, int] | Literal["360p", "480p", "720p", "1080p", "4k"] = field(
        "Width and height [pixels], or the name of a 16:9 size.", (960, 540), at_least=2, at_most=16384
    )
    camera: CameraRef | None = field("Seen from; by default the script's first camera.", None)
    renderer: RendererRef | None = field("Drawn by; by default `trace`.", None)
    show: tuple[DrawnRef, ...] | None = field("Draws only these parts; by default all that is not hidden.", None)
    exposure: FixedScalar = field("Stops by which the picture is brightened.", "0", at_least=-20, at_most=20)

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height."""
        named = {"360p": (640, 360), "480p": (854, 480), "720p": (1280, 720), "1080p": (1920, 1080), "4k": (3840, 2160)}
        return named[self.size] if isinstance(self.size, str) else self.size


def bounded_moments(count: float) -> float:
    """The number itself. Raises Exceeds where an output would take more instants than a run can have."""
    if not count <= MOST_MOMENTS:
        raise Exceeds(f"{count:.3g} instants are more than the {MOST_MOMENTS:,} that an output may take")
    return count


class Clock(Record):
    """Film time and simulation time."""

    end: FixedTime = field("Length of the simulation.", "4 s", above=0)
    fps: FixedScalar = field("Film frames a second.", "30", above=0, at_most=1000)
    speed: FixedScalar = field("Seconds of simulation in a second of film.", "1", above=0)
    seed: int = field("Seed of all chance.", 0, at_least=0)

    def frames(self, fps: float) -> list[float]:
        """Instants [s] of the film's frames: frame i stands at film time i/fps, before the end. Raises Exceeds."""
        count = max(1, math.ceil(round(bounded_moments(self.end / self.speed * fps), 9)))
        return [k / fps * self.speed for k in range(count)]


class Gallery(Record):
    """The small and short version of a scene that the gallery keeps."""

    size: tuple[int, int] = field("Width and height of the poster [pixels].", (320, 180), above=0)
    time: FixedTime = field("The instant of the poster.", "1 s", at_least=0)


class Expect(Record):
    """A number that the scene must give, and where that is known from."""

    of: Expected = field("What is measured: an expression of outputs, with final(), max(), at(x, 2 s), ...")
    value: Expected | None = field("What it must be.", None)
    tolerance: FixedScalar = field("How far it may be off, as a number in SI.", "1e-6", at_least=0)
    below: Expected | None = field("In place of a value: what it must stay below.", None)
    because: str = field("Why: exact, independent source, conservation, ...")
    variant: str | None = field("The variant that it holds for; by default the script as it stands.", None)

    @model_validator(mode="after")
    def _one_target(self) -> Expect:
        if (self.value is None) == (self.below is None):
            raise ValueError("an expectation has either 'value' or 'below'")
        return self


class Settings(Record):
    """The top-level keys of a script that are not parts."""

    about: str = field("One sentence on the scene.", "")
    clock: Clock = field("Film time and simulation time.", Clock())
    gallery: Gallery = field("The gallery's version of the scene.", Gallery())
    expect: dict[str, Expect] = field("Numbers that the scene must give.", {})
    background: Color | None = field("What the camera sees where nothing is; by default the sky.", None)


FAMILIES: tuple[type[Kind], ...] = (
    Object,
    Model,
    Force,
    Contact,
    Solver,
    Camera,
    Illumination,
    Material,
    Renderer,
    Output,
)
