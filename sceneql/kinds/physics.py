"""The families of physics: models, forces, ties, contacts."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.kinds.doubt import Doubt
from sceneql.kinds.probed import HeldPart, Probed
from sceneql.kinds.stable_step import Oscillation, StaticMass, StaticScene
from sceneql.kinds.types import BodyRef, ModelRef
from sceneql.kinds.values import Quantity, Ref, Value
from sceneql.kinds.word import Kind, Problem, field
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.dimension import FORCE
from sceneql.quantities.expression import Expr

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.frame import Shape as Drawn
    from sceneql.kinds.moment import Moment
    from sceneql.kinds.settings import Clock
    from sceneql.system import Assembly, Bodies, ModelState


class Model(Kind):
    """Something with a state in time. `kinematic` ones are functions of time; the others are solved."""

    family: ClassVar[str] = "models"
    kinematic: ClassVar[bool] = False
    is_field: ClassVar[bool] = False
    """Whether it is made of fields on a grid."""
    flows: ClassVar[bool] = False
    """Whether it is an incompressible flow (system.Flow)."""
    turns: ClassVar[bool] = False
    """Whether its bodies are rigid: all models of a contact with it are then solved together."""
    inert: ClassVar[bool] = False
    """Whether only forces, contacts and velocities at the start move it."""
    has_bodies: ClassVar[bool] = True
    """Whether forces that name no model act on it."""
    has_skin: ClassVar[bool] = False
    """Whether its masses are vertices of a surface: all models of a contact with it are then solved together."""
    carried: ClassVar[bool] = False
    """Whether it is a skin without inertia that a flow carries (system.Membrane)."""
    immersible: ClassVar[bool] = False
    """Whether a flow may carry it (Interaction.carrier): it is then assembled after the flow."""

    def assemble(self, name: str, assembly: Assembly) -> Bodies | None:
        """Reserve its state with initial values, and add its own rate's terms; the masses that forces may act on."""
        raise TypeError(f"{type(self).__name__} has no state")

    def assemble_part(
        self, name: str, assembly: Assembly, bodies: Bodies, start: ModelState, first: int, last: int
    ) -> Bodies | None:
        """Reserve only its bodies first..last-1, initially, as a block without interactions; None: indivisible."""
        return None

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state: float or float64 array."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Indices into `state.y` at which an output stands, in the output's shape; None: the output is computed.

        ``state``: at the start of the run, for its bodies, ints and floats; the indices stay. Values at stage times, as
        the place of an attractor, can read such outputs of models of their island alone; `read` is between steps.
        """
        return None

    def point(self, output: str, state: ModelState) -> tuple[int, tuple[float, float, float]] | None:
        """The index of the mass whose position an output is, and the point on it in its own axes from its center [m].

        None: the output is not such a position. ``state`` as in `places`.
        """
        found = None if state.bodies is None else self.places(output, state)
        if state.bodies is None or found is None or found.shape != (3,):
            return None
        body, rest = divmod(int(found[0]) - state.bodies.position_at, 3)
        return None if rest or not 0 <= body < state.bodies.count else (body, (0.0, 0.0, 0.0))

    def remark(self, state: ModelState) -> str:
        """Text for `explain` at the start of the run, as on the accuracy of its numbers."""
        return ""

    def trouble(self, state: ModelState) -> tuple[str, str]:
        """Text of a warning at the end of a run, and its remedy; both empty for none."""
        return "", ""

    def sums_up(self, output: str) -> bool:
        """Whether an output is accumulated over the run in the state (a tally): values that read it have no slopes."""
        return output in self.gives and self.gives[output].tally

    def field_count(self) -> int:
        """The number of cell-centered fields (system.Grid) of the model."""
        return 0

    def connect(self, name: str, assembly: Assembly) -> None:
        """Add the terms that read other models' reservations in the island; called once all models are assembled."""

    def items(self, output: str) -> int | None:
        """Number of items of an output, if its fields tell; else None."""
        return None

    def burdens(self, density: float) -> bool:
        """Whether its masses, carried by a flow, differ from the mass of displaced fluid of a density [kg/m^3]."""
        return False

    def fluid(self) -> tuple[float, float] | None:
        """Density [kg/m^3] and viscosity [Pa s] of the fluid inside it; None where it is the flow's own fluid."""
        return None

    def faceless(self) -> str:
        """Why contacts beside elastic solids do not take its masses; empty where they do: vertices of lasting faces."""
        return "has no faces"

    def fillings(self) -> Iterable[tuple[Ref, Callable[[Floats, Floats], None]]]:
        """Objects that it fills at a spacing, each with a function of the corners (3,) [m] of the object's box."""
        return ()

    def held_parts(self) -> Iterable[HeldPart]:
        """Its parts that are held fixed, selected by their position."""
        return ()

    def insides(self) -> Iterable[Ref]:
        """Objects whose insides it fills or spreads in."""
        return ()

    def probed(self) -> Iterable[Probed]:
        """Points that have to lie inside the objects that it fills or spreads in."""
        return ()

    def shaped(self) -> Iterable[Ref]:
        """Objects whose shape at the start it takes: they may only move rigidly as a whole."""
        return ()

    def standing(self) -> Iterable[Ref]:
        """Objects that it takes as they are at the start, so that they must not move."""
        return ()

    def lasts(self) -> bool:
        """Whether its bodies exist during the whole run: births add energy, and deaths remove it."""
        return True

    def conserves(self) -> tuple[str, ...]:
        """Outputs besides energy and momentum that an exact solution would keep."""
        return ()

    def size_of(self, output: str, state: ModelState) -> Any:
        """Magnitude of the terms whose sum a conserved output is: float or (count,)."""
        raise TypeError(f"{type(self).__name__} conserves no {output}")

    def computed(self, name: str, output: str) -> Expr | None:
        """An output of a solved model as an expression of others that `places` finds, as a point on a body."""
        return None

    def formula(self, output: str) -> Expr:
        """An output of a kinematic model as an expression of time."""
        raise TypeError(f"{type(self).__name__} is not a function of time")

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """Bounds on its fastest oscillations from its own fields, for `check`: without numpy, and quickly."""
        return ()

    def doubts(self, clock: Clock) -> Iterable[Doubt]:
        """Doubtful settings of its own fields, given the clock; warnings of `check`."""
        return ()

    def static_masses(self) -> Mapping[str, StaticMass]:
        """Masses by name that follow from its fields alone, for `check`; "" stands for the lightest nameless one."""
        return {}

    def lowest(self) -> float | None:
        """A lower bound of the heights [m] at which its masses start, from its fields alone; None: not known."""
        return None

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Drawn]:
        """Its shapes where no object of the script shows it, or where it is asked to draw itself."""
        return ()

    def shown_at(self, outputs: Collection[str]) -> bool:
        """Whether an object whose position reads these outputs shows the model, which then does not draw itself."""
        return True

    def asked_to_draw(self) -> bool:
        """Whether the script says how it draws itself; it then does so even where objects show it."""
        return False

    def shows(self, name: str) -> Value | None:
        """The field that tells most of it; None for a model without fields."""
        return None

    def drawn_by(self, name: str) -> tuple[str, Value] | None:
        """Word and `of` of the object by which it is drawn where no object of the script shows any of its fields."""
        return None if (field := self.shows(name)) is None else ("field_map", field)

    def called(self, output: str) -> str:
        """Name of an output in pictures."""
        return output

    def shown_in_place_of(self) -> Iterable[Ref]:
        """Objects that would hide it or its default map: it is drawn in their place."""
        return ()

    def drives(self) -> Mapping[str, Mapping[str, str]]:
        """Fields of objects that it sets: ``{object name: {field: output}}``."""
        return {}

    def with_own_shapes(self, own: Callable[[Ref], Ref]) -> Model:
        """A copy in which each body drives the object ``own(ref)`` instead of the object that the script names."""
        return self


class Interaction(Kind):
    """An addition to the rate of models: a force, or a tie between two bodies."""

    family: ClassVar[str] = "forces"

    weighs: ClassVar[bool] = False
    """Whether it is a weight: its masses fall, and pictures show a ground under them."""
    mutual: ClassVar[bool] = False
    """Whether its masses act on one another; their models are then solved together."""

    def targets(self) -> tuple[str, ...] | None:
        """Names of the models it acts on; None: all that have masses."""
        return None

    def carrier(self) -> Ref | None:
        """The flow that carries its models (Model.immersible), where it couples them to one; else None."""
        return None

    def fastest_carried(self, models: Mapping[str, Model], flow: Model, scene: StaticScene) -> Iterable[Oscillation]:
        """As `fastest`, for the models that its `carrier` carries."""
        return ()

    def assemble_carried(self, name: str, assembly: Assembly, model: str) -> None:
        """Add its terms for one skin, where there is a `carrier`."""
        raise NotImplementedError

    def assemble_weight(self, name: str, assembly: Assembly) -> None:
        """Add the weight of fluids of several densities, for an interaction that `weighs`."""
        raise NotImplementedError

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add its terms for one model."""
        raise NotImplementedError

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add its terms for all models at once; called where it is `mutual`."""
        raise NotImplementedError

    def fastest(self, name: str, on: Mapping[str, Mapping[str, StaticMass]]) -> Iterable[Oscillation]:
        """Bounds on the fastest oscillations of masses under this force, for `check`: without numpy, and quickly.

        ``on``: by model, the known masses that it acts on.
        """
        return ()

    def internal(self) -> bool:
        """Whether all its forces are pairs of action and reaction between masses, so that it conserves momentum."""
        return False

    def at_a_distance(self) -> bool:
        """Whether it is a smooth force at a distance, such as gravity."""
        return False

    def uniform(self) -> bool:
        """Whether it accelerates all masses alike, wherever they are; its acceleration may vary in time."""
        return False

    def remark(self, state: ModelState) -> str:
        """Text for `explain` on a `mutual` force at the start of the run, as on the error of its approximation."""
        return ""

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Potential energy [J] of the model in this force at a state; 0 where there is none."""
        return 0.0


class Force(Interaction):
    """A force on the masses of models."""

    on: tuple[ModelRef, ...] | None = field("The models it acts on; by default all that have masses.", None)

    def targets(self) -> tuple[str, ...] | None:
        """Names of the models it acts on; None: all that have masses."""
        return None if self.on is None else tuple(ref.name for ref in self.on)


class Tie(Interaction):
    """A constraint between two bodies, or a body and the world, that leaves some motions free.

    Its constraint forces are solved for together with those of all ties of the island.
    """

    family: ClassVar[str] = "ties"
    mutual: ClassVar[bool] = True

    between: tuple[BodyRef, BodyRef] = field(
        "Two bodies: `crate`, one of several, `stones.first`, a mass, `net.bob`, an object that moves by itself, or "
        "`world`."
    )
    breaks: Annotated[float, Quantity(FORCE)] | None = field(
        "Force above which it is gone, by default never: at once where a tolerance chooses steps and nothing collides, "
        "else at a step's end, within 1/240 s.", None, above=0
    )  # fmt: skip

    def problems(self) -> Iterable[Problem]:
        """The world held to itself."""
        if not any(ref.name for ref in self.between):
            yield Problem("a tie holds a body, and these are the world twice", ("between", 1))

    def targets(self) -> tuple[str, ...]:
        """The parts that it holds; objects are among them."""
        return tuple(dict.fromkeys(ref.name for ref in self.between if ref.name))

    def places(self) -> Iterable[tuple[Value, tuple[Ref, ...]]]:
        """Points at the start, each with the bodies that it must lie on."""
        return ()

    def pivot(self) -> Ref | None:
        """The body that can only rotate about a fixed point of the world; None where there is none."""
        return None

    def support(self) -> tuple[Value, Value | None] | None:
        """Where pictures show a bead that holds a body to the world, or a pin along an axis; None for none."""
        return None

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def trouble(self, state: ModelState) -> str:
        """Text of a warning at the end of a run; empty for none."""
        return ""


class Contact(Kind):
    """Contact of masses or bodies with objects, or with one another: events and impulses."""

    family: ClassVar[str] = "contacts"
    also_under: ClassVar[str] = "forces"
    mutual: ClassVar[bool] = False
    """Whether it acts between all masses of its models, which are solved together: it is assembled once for all."""

    def ties(self) -> tuple[Ref, ...]:
        """The models and objects that it acts between; empty: all models and the floor."""
        raise NotImplementedError

    def refusals(self, models: Mapping[str, Model]) -> Iterable[Diagnostic]:
        """Errors, for `check`, where its models lack what it requires."""
        return ()

    def keeps_apart(self, models: Mapping[str, Model]) -> bool:
        """Whether nothing passes through its models in any step; contacts that move their masses then may not act."""
        return False

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies, others: tuple[Ref, ...]) -> None:
        """Add gaps and impacts (or the local kernel that backs off) of one model against the others."""
        raise NotImplementedError

    def assemble_together(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> None:
        """Add its terms for all models at once, where it is `mutual`."""
        raise NotImplementedError

    def assemble_rigid(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> None:
        """Add its terms for all models at once; called where some of them are rigid bodies."""
        raise NotImplementedError

    def assemble_carried(
        self, name: str, assembly: Assembly, skins: Sequence[str], carried: Sequence[Bodies],
        everyone: Sequence[Bodies], others: tuple[Ref, ...],
    ) -> None:  # fmt: skip
        """Add its terms for all skins and masses that a flow carries, at once; ``everyone``: its other masses."""
        raise NotImplementedError

    def assemble_skins(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> bool:
        """Add its terms for all models at once, where some have skins; returns whether it acts on skins."""
        return False

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def remark(self, state: ModelState) -> str:
        """Text for `explain` at the start of the run, as on what it neglects."""
        return ""

    def trouble(self, state: ModelState) -> str:
        """Text of a warning at the end of the run; empty for none."""
        return ""
