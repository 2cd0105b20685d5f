"""Script fields of a rigid body: object, mass, inertia, initial motion and named points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from sceneql import kinds
from sceneql.bodies.rigid.mass_properties import impossible
from sceneql.kinds import Problem, Quantity, Record, Ref, Value, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.bodies.rigid.mass_properties import MassProperties
    from sceneql.frame import Floats
    from sceneql.system import Assembly

INERTIA = dim.MASS * dim.LENGTH**2
Triple = tuple[float, float, float]
WATER = 1000.0
"""Default density of a body [kg/m^3]."""


@dataclass(frozen=True, slots=True)
class Made:
    """Mass properties and pose of a rigid body at the start of the run."""

    mass: float
    """[kg]"""
    center: Floats
    """(3,) [m] center of mass in the body's axes, relative to its origin."""
    inertia: Floats
    """(3, 3) [kg m^2] inertia tensor about the center of mass, in the body's axes."""
    error: float
    """Estimated relative error of mass and inertia; 0 where they are exact or given."""
    position: Floats
    """(3,) [m] center of mass in the world."""
    rotation: Floats
    """(4,) unit quaternion [w, x, y, z] that maps the body's axes to the world's."""


class Body(Record):
    """A rigid body: an object with an inside whose matter is spread evenly, or a mass with an inertia of its own."""

    of: kinds.ObjectRef | None = field(
        "The object that is the body, and that it drives; without one it has `mass` and `inertia`.", None
    )
    density: Annotated[float, Quantity(dim.DENSITY)] | None = field(
        "Mass by volume; by default that of water, 1000 kg/m^3.", None, above=0
    )
    mass: kinds.FixedMass | None = field("Its mass, in place of `density`.", None, above=0)
    inertia: Annotated[Triple, Quantity(INERTIA, (3,))] | None = field(
        "Principal moments of inertia about the center of mass, with `mass`; by default those of the object.",
        None,
        above=0,
    )
    axes: kinds.Rotation = field("How the axes of `inertia` are turned against the body's own.", "1 0 0 0")
    center: kinds.FixedPosition | None = field(
        "The center of mass in the body's own axes, from its origin; by default that of the object.", None
    )
    position: kinds.FixedPosition | None = field("Where its origin starts; by default the object's place.", None)
    rotation: kinds.Rotation | None = field("How it is turned at the start; by default as the object is.", None)
    velocity: kinds.FixedVelocity = field(
        "Velocity of its center of mass at the start; where ties hold it and this is 0, what they ask for.", "0 0 0 m/s"
    )
    spin: Annotated[Triple, Quantity(dim.FREQUENCY, (3,), turning=True)] = field(
        "Angular velocity at the start, in the world's axes [rad/s]; with ties as the velocity.", "0 0 0 rad/s"
    )
    fixed: bool = field("It never moves.", False)
    points: dict[str, kinds.FixedPosition] = field(
        "Places on it by name, in its own axes from its origin: `name.hook.position` tells where one is.", {}
    )

    def problems(self) -> Iterator[Problem]:
        """Problems: mass given twice or not at all; an impossible inertia; motion of a fixed body; a bad point name."""
        if self.density is not None and self.mass is not None:
            yield Problem("a body has either a `density` or a `mass`", ("mass",), at_key=True)
        if self.inertia is not None and self.mass is None:
            yield Problem("a body of given `inertia` needs its `mass`, too", ("inertia",), at_key=True)
        elif self.of is None and self.inertia is None and self._alone():
            remedy = "write `of: NAME`, the object that it moves, whose shape tells the inertia"
            yield Problem("a body without an object (`of`) needs `mass` and `inertia`", help=remedy)
        if self.inertia is not None and (text := impossible(self.inertia)):
            yield Problem(text, ("inertia",))
        if self.fixed and (any(self.velocity) or any(self.spin)):
            moving = "velocity" if any(self.velocity) else "spin"
            yield Problem(f"a fixed body has no {moving}", (moving,))
        for name in self.points:
            if not name.isidentifier():
                yield Problem(
                    f"'{name}' is no name that a link could say: take letters, digits and _", ("points", name)
                )

    def _alone(self) -> bool:
        """Whether the fields describe a body, and not defaults for others."""
        return True

    def made(self, assembly: Assembly) -> Made:
        """The body at the start of the run. Raises ScriptError for an object without an inside, a place or a volume."""
        import numpy as np

        from sceneql.shapes.placement import rotation_matrix

        place: Floats = np.zeros(3)
        turn: Floats = np.array([1.0, 0.0, 0.0, 0.0])
        center: Floats = np.zeros(3)
        inertia: Floats = np.eye(3)
        mass, error = 1.0 if self.mass is None else self.mass, 0.0
        if self.of is not None:
            kind: Any = assembly.object(self.of)
            position, rotation = getattr(kind, "position", None), getattr(kind, "rotation", None)
            assert isinstance(position, Value)  # the compiler has put what has none into a group
            assert isinstance(rotation, Value)
            place, turn = (np.asarray(assembly.initial(value), dtype=np.float64) for value in (position, rotation))
            if self.inertia is None or self.center is None:
                found = self._uniform(self.of, kind, assembly)
                if self.mass is None:
                    mass = found.volume * (WATER if self.density is None else self.density)
                own = rotation_matrix(turn)
                center = own.T @ (found.center - place)
                inertia = own.T @ found.inertia @ own * (mass / found.volume)
                inertia = 0.5 * (inertia + inertia.T)
                size = float(np.linalg.norm(found.inertia))
                error = max(found.error.volume / found.volume, found.error.inertia / size)
        if self.center is not None:
            center = np.asarray(self.center)
        if self.inertia is not None:
            axes = rotation_matrix(assembly.initial(self.axes))
            inertia = axes @ np.diag(self.inertia) @ axes.T
        if self.position is not None:
            place = np.asarray(self.position)
        if self.rotation is not None:
            turn = np.asarray(assembly.initial(self.rotation), dtype=float)
        turn = turn / np.linalg.norm(turn)
        return Made(mass, center, inertia, error, place + rotation_matrix(turn) @ center, turn)

    def _uniform(self, ref: Ref, kind: Any, assembly: Assembly) -> MassProperties:
        """Mass properties, for density 1, of its object at the start. Raises ScriptError where it has none."""
        from sceneql.bodies.rigid.mass_properties import properties
        from sceneql.island.start import Start

        start: Any = Start(assembly)
        try:
            return properties(kind, start)
        except (TypeError, ValueError) as error:
            written = ref.span.text if ref.span is not None else ""
            name = written if ref.name.startswith(f"{written}.") else ref.name  # of a copy, or a group of it
            message = f"'{name}' cannot be a rigid body: {error}"
            raise ScriptError([Diagnostic("no-body", message, ref.span)]) from None
