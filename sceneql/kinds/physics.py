"""The families of physics: models, forces, ties, contacts."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.kinds.probed import HeldPart, Probed
from sceneql.kinds.stable_step import Oscillation, StaticMass, StaticScene
from sceneql.kinds.types import BodyRef, ModelRef
from sceneql.kinds.values import Quantity, Ref, Value
from sceneql.kinds.word import Kind, Problem, field
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.dimension import FORCE
from sceneql.quantities.expression import Expr
from sceneql.quantities.span import Span

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.frame import Shape as Drawn
    from sceneql.kinds.moment import Moment
    from sceneql.system import Assembly, Bodies, ModelState


@dataclasses.dataclass(frozen=True, slots=True)
class Doubt:
    """What a run will do, and yet may not be meant."""

    code: str
    text: str
    place: Span | None
    help: str


class Model(Kind):
    """Something with a state in time. `kinematic` ones are functions of time; the others are solved."""

    family: ClassVar[str] = "models"
    kinematic: ClassVar[bool] = False
    is_field: ClassVar[bool] = False
    """Whether it is made of fields on a grid."""
    flows: ClassVar[bool] = False
    """Whether it is an incompressible flow (system.Flow)."""
    turns: ClassVar[bool] = False
    """Whether its bodies are rigid: those of a contact are solved together."""
    has_bodies: ClassVar[bool] = True
    """Whether forces that name no model act on it."""
    has_skin: ClassVar[bool] = False
    """Whether its masses span a surface: all of a contact with such a model are solved together."""

    carried: ClassVar[bool] = False
    """Whether it is a skin without inertia that a flow carries (system.Membrane)."""
    immersible: ClassVar[bool] = False
    """Whether a flow may carry it (Interaction.carrier): it is then assembled after the flow."""

    def assemble(self, name: str, assembly: Assembly) -> Bodies | None:
        """Reserve state, give initial values, add the terms of its own rate; the point masses forces may act on."""
        raise TypeError(f"{type(self).__name__} has no state")

    def assemble_part(
        self, name: str, assembly: Assembly, bodies: Bodies, start: ModelState, first: int, last: int
    ) -> Bodies | None:
        """Reserve its bodies first..last-1 alone, as they start: a block of those that feel no other one.

        None: it cannot be divided.
        """
        return None

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state: float or float64 array."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Where in the state an output stands: indices into `state.y`, of the output's shape; None: it is computed.

        ``state``: at the start of the run, for its bodies, ints and floats; the same all the time. Values that are
        evaluated at stage times, as the place of an attractor, read such outputs of models of their island. Of a model
        that does not say it they read none: such a link is refused. All that is read between steps is `read`.
        """
        return None

    def point(self, output: str, state: ModelState) -> tuple[int, tuple[float, float, float]] | None:
        """The number of the mass whose position an output is, and where on it, in its own axes from its center [m].

        None: it is not the position of one. ``state`` as in `places`.
        """
        found = None if state.bodies is None else self.places(output, state)
        if state.bodies is None or found is None or found.shape != (3,):
            return None
        body, rest = divmod(int(found[0]) - state.bodies.position_at, 3)
        return None if rest or not 0 <= body < state.bodies.count else (body, (0.0, 0.0, 0.0))

    def remark(self, state: ModelState) -> str:
        """What `explain` says of it at the start of the run, as how exact its numbers are."""
        return ""

    def trouble(self, state: ModelState) -> tuple[str, str]:
        """What a warning says of it at the end of a run, and what helps; empty for nothing."""
        return "", ""

    def sums_up(self, output: str) -> bool:
        """Whether an output is a sum over the run that the state holds: values that read it have no slopes."""
        return output in self.gives and self.gives[output].tally

    def field_count(self) -> int:
        """The number of fields at centers of cells (system.Grid) that it is made of."""
        return 0

    def connect(self, name: str, assembly: Assembly) -> None:
        """Add the terms that read what other models of the island have reserved: all are assembled by now."""

    def items(self, output: str) -> int | None:
        """How many items an output has, where its fields tell."""
        return None

    def burdens(self, density: float) -> bool:
        """Whether its masses, where a flow carries them, weigh other than what they displace of a density [kg/m^3]."""
        return False

    def fluid(self) -> tuple[float, float] | None:
        """Density [kg/m^3] and viscosity [Pa s] of what it holds, where these are not those of its flow."""
        return None

    def fillings(self) -> Iterable[tuple[Ref, Callable[[Floats, Floats], None]]]:
        """Objects that it fills by a measure, with a function of the low and high corner (3,) of their boxes.

        The function raises Exceeds where that is sure to be too much.
        """
        return ()

    def held_parts(self) -> Iterable[HeldPart]:
        """Parts of it that it holds by their places."""
        return ()

    def insides(self) -> Iterable[Ref]:
        """Objects whose insides it fills or spreads in."""
        return ()

    def probed(self) -> Iterable[Probed]:
        """Places of which it tells, which have to lie inside objects that it spreads in or fills."""
        return ()

    def shaped(self) -> Iterable[Ref]:
        """Objects whose shape it takes as it is at the start: they may be moved and turned, but as a whole alone."""
        return ()

    def standing(self) -> Iterable[Ref]:
        """Objects that it takes as they are at the start, so that they must not move."""
        return ()

    def lasts(self) -> bool:
        """Whether its bodies are there all the time: births bring energy, and deaths take it."""
        return True

    def conserves(self) -> tuple[str, ...]:
        """Outputs besides energy and momentum that an exact solution would keep."""
        return ()

    def size_of(self, output: str, state: ModelState) -> Any:
        """How large the terms are that such an output is a sum of: float or (count,)."""
        raise TypeError(f"{type(self).__name__} conserves no {output}")

    def computed(self, name: str, output: str) -> Expr | None:
        """An output of a solved model by others of its own that `places` tells, as a place on a body by the body's."""
        return None

    def formula(self, output: str) -> Expr:
        """An output of a kinematic model as an expression of time."""
        raise TypeError(f"{type(self).__name__} is not a function of time")

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """Bounds on its fastest oscillations by its own fields, for `check`: without numpy, and quickly."""
        return ()

    def doubts(self) -> Iterable[Doubt]:
        """What its own fields make doubtful, for warnings of `check`."""
        return ()

    def static_masses(self) -> Mapping[str, StaticMass]:
        """Masses by name as its fields alone tell them, for `check`; one without a name stands for the lightest."""
        return {}

    def lowest(self) -> float | None:
        """A height [m] below which none of its masses starts, as its fields alone tell it; None: they do not."""
        return None

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Drawn]:
        """How it draws itself where no object of the script does, or it is asked to."""
        return ()

    def shown_at(self, outputs: Collection[str]) -> bool:
        """Whether an object whose position reads these outputs shows it, so that it does not draw itself."""
        return True

    def asked_to_draw(self) -> bool:
        """Whether the script says how it draws itself: then it does, whatever shows it besides."""
        return False

    def shows(self, name: str) -> Value | None:
        """The field that a `field_map` draws where no object of the script shows any of it."""
        return None

    def called(self, output: str) -> str:
        """What pictures call an output."""
        return output

    def shown_in_place_of(self) -> Iterable[Ref]:
        """Objects that would hide it, or that map: it is drawn in their place."""
        return ()

    def drives(self) -> Mapping[str, Mapping[str, str]]:
        """Fields of objects that it sets: ``{object name: {field: output}}``."""
        return {}

    def with_own_shapes(self, own: Callable[[Ref], Ref]) -> Model:
        """Itself, each of its bodies driving the object that ``own`` gives for the one that the script names."""
        return self


class Interaction(Kind):
    """What adds to the rate of models: a force, or a tie between two bodies."""

    family: ClassVar[str] = "forces"

    weighs: ClassVar[bool] = False
    """Whether it is weight: what it acts on falls, and a picture shows a ground under it."""
    mutual: ClassVar[bool] = False
    """Whether the masses that it acts on act on one another: then their models are solved together."""

    def targets(self) -> tuple[str, ...] | None:
        """Names of the models it acts on; None: all that have masses."""
        return None

    def carrier(self) -> Ref | None:
        """The flow by which it has models carried (Model.immersible), in place of acting on masses; else None."""
        return None

    def fastest_carried(self, models: Mapping[str, Model], flow: Model, scene: StaticScene) -> Iterable[Oscillation]:
        """As `fastest`, of models that its `carrier` carries."""
        return ()

    def assemble_carried(self, name: str, assembly: Assembly, model: str) -> None:
        """Add its terms for one skin, where it has a `carrier`."""
        raise NotImplementedError

    def assemble_weight(self, name: str, assembly: Assembly) -> None:
        """Add what fluids of several densities weigh, where it is weight: `weighs`."""
        raise NotImplementedError

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add its terms for one model."""
        raise NotImplementedError

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add its terms for all models at once, where it is `mutual`."""
        raise NotImplementedError

    def fastest(self, name: str, on: Mapping[str, Mapping[str, StaticMass]]) -> Iterable[Oscillation]:
        """Bounds on the fastest that it makes of its models' masses, for `check`: without numpy, and quickly.

        ``on``: by model what is told of the masses that it acts on.
        """
        return ()

    def internal(self) -> bool:
        """Whether it acts between masses alone, each on the other as much: then their momentum stays."""
        return False

    def at_a_distance(self) -> bool:
        """Whether it is as smooth as the paths of masses in it, as gravity is: no spring, no friction, no far end."""
        return False

    def remark(self, state: ModelState) -> str:
        """What `explain` says of a `mutual` force at the start of the run, as how far it is from exact."""
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
    """Holds two bodies together, or one to the world, so that some motions are left.

    Its forces are those that let the bodies keep to it, found together with those of all ties of the island.
    """

    family: ClassVar[str] = "ties"
    mutual: ClassVar[bool] = True

    between: tuple[BodyRef, BodyRef] = field(
        "Two bodies: `crate`, one of several, `stones.first`, a mass, `net.bob`, an object that moves by itself, or "
        "`world`."
    )
    breaks: Annotated[float, Quantity(FORCE)] | None = field(
        "Force above which it is gone, at the end of a step; by default it never is.", None, above=0
    )

    def problems(self) -> Iterable[Problem]:
        """The world held to itself."""
        if not any(ref.name for ref in self.between):
            yield Problem("a tie holds a body, and these are the world twice", ("between", 1))

    def targets(self) -> tuple[str, ...]:
        """The parts that it holds; objects are among them."""
        return tuple(dict.fromkeys(ref.name for ref in self.between if ref.name))

    def places(self) -> Iterable[tuple[Value, tuple[Ref, ...]]]:
        """Places at the start, each with the bodies that it is to be on."""
        return ()

    def pivot(self) -> Ref | None:
        """The body that only turns about a point of the world, where it leaves it no other motion; else None."""
        return None

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def trouble(self, state: ModelState) -> str:
        """What a warning says of it at the end of a run; empty for nothing."""
        return ""


class Contact(Kind):
    """Gives events and impulses."""

    family: ClassVar[str] = "contacts"
    also_under: ClassVar[str] = "forces"
    mutual: ClassVar[bool] = False
    """Whether it acts between all masses of its models: these are tied, and it is assembled for all at once."""

    def ties(self) -> tuple[Ref, ...]:
        """The models and objects it acts between; empty: all models and the floor."""
        raise NotImplementedError

    def refusals(self, models: Mapping[str, Model]) -> Iterable[Diagnostic]:
        """What it asks of the models that it acts on and they do not have, for `check`."""
        return ()

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies, others: tuple[Ref, ...]) -> None:
        """Add gaps and impacts (or local backing off) of one model against the others."""
        raise NotImplementedError

    def assemble_together(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> None:
        """Add its terms for all models at once, where it is `mutual`."""
        raise NotImplementedError

    def assemble_rigid(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> None:
        """Add its terms for all models at once, where there are rigid bodies among them."""
        raise NotImplementedError

    def assemble_carried(
        self,
        name: str,
        assembly: Assembly,
        skins: Sequence[str],
        carried: Sequence[Bodies],
        everyone: Sequence[Bodies],
        others: tuple[Ref, ...],
    ) -> None:
        """Add its terms for all skins and masses at once that a flow carries; ``everyone``: its other masses."""
        raise NotImplementedError

    def assemble_skins(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> bool:
        """Add its terms for all models at once, some of which have skins; whether it acts on skins."""
        return False

    def read(self, output: str, state: ModelState) -> Any:
        """An output at a state."""
        raise TypeError(f"{type(self).__name__} gives no {output}")

    def remark(self, state: ModelState) -> str:
        """What `explain` says of it at the start of the run, as what it leaves out."""
        return ""

    def trouble(self, state: ModelState) -> str:
        """What a warning says of it at the end of a run; empty for nothing."""
        return ""
