"""rigid: rigid bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import PrivateAttr

from sceneql.bodies import bodies as masses
from sceneql.bodies.rigid.body import INERTIA, Body, Made
from sceneql.kinds import Gives, Model, Problem, Ref, field, quantity_type
from sceneql.kinds.stable_step import StaticMass
from sceneql.kinds.word import read_default
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Call, Expr, Link, Number, Type, Vector
from sceneql.quantities.turned import rotated

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState

MOST_TOLD = 6
"""Largest number of bodies whose masses `explain` lists."""
TURN, PLACE = Type((4,)), Type((3,), dim.LENGTH)

ONE: Mapping[str, Gives] = {
    "position": Gives(PLACE, "Where its center of mass is."),
    "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast that moves."),
    "acceleration": Gives(quantity_type(dim.ACCELERATION, (3,)), "How fast that changes.", computed=True),
    "origin": Gives(PLACE, "Where the origin of its own axes, and of its object, is."),
    "rotation": Gives(TURN, "How its axes are turned: quaternion [w, x, y, z]."),
    "spin": Gives(quantity_type(dim.FREQUENCY, (3,)), "Angular velocity in the world's axes.", computed=True),
    "body_spin": Gives(quantity_type(dim.FREQUENCY, (3,)), "Angular velocity in its own axes.", computed=True),
    "inertia": Gives(
        quantity_type(INERTIA, (3, 3)), "Inertia about the center of mass, in its own axes.", computed=True
    ),
}
"""Outputs of one body."""
POINT: Mapping[str, Gives] = {
    "position": Gives(PLACE, "Where it is."),
    "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast it moves.", computed=True),
}
"""Outputs of a point of a body."""


class Member(Body):
    """One of several bodies: what it does not say the model does, so that they are looked at together."""

    def problems(self) -> Iterator[Problem]:
        """None of its own."""
        return iter(())


class Rigid(Body, Model):
    """Rigid bodies: m dv/dt = F and dL/dt = torque (Euler 1776), L = R I R^T w being the angular momentum in the world.

    One is described by the fields themselves, several under `bodies` by name; the fields are then what each has that
    says no other. A body is an object with an inside (`of`), which it drives, of even density; bodies that name one
    object are drawn as copies of it. Or a body has a mass and principal moments of inertia. Forces act at its center of
    mass, or at one of its `points`. The angular momentum is part of the state, so that every method keeps it to
    rounding where no torque acts; `verlet`, `blanes_moan` and `semi_implicit_euler` turn bodies by their exact free
    rotation between the forces' kicks. A body tells its `position`, `velocity`, `acceleration`, `origin`, `rotation`,
    `spin`, `body_spin` and `inertia`, as `crate.spin` or `stones.first.spin`; a point its `position` and `velocity`,
    as `crate.hook.position`.
    """

    turns: ClassVar[bool] = True
    inert: ClassVar[bool] = True
    gives: ClassVar[Mapping[str, Gives]] = masses.BODY_OUTPUTS

    bodies: dict[str, Member] | None = field("Several bodies by name.", None)

    _made: dict[str, Made] = PrivateAttr(default_factory=dict)
    _whole: dict[str, Body] = PrivateAttr(default_factory=dict)

    def problems(self) -> Iterator[Problem]:
        """Those of a body; one body and several, or none."""
        yield from super().problems()
        if self.bodies is not None and (self.of is not None or self.inertia is not None or self.points):
            yield Problem(
                "either the fields describe one body, or there are `bodies` by name", ("bodies",), at_key=True
            )
        if self.bodies is not None and not self.bodies:
            yield Problem("there are no bodies in this list", ("bodies",))
        for name, body in self._each.items() if self.bodies is not None else ():
            for problem in Body.problems(body):
                yield replace(problem, path=("bodies", name, *problem.path))

    def _alone(self) -> bool:
        return self.bodies is None

    @property
    def _each(self) -> Mapping[str, Body]:
        """Bodies by name, with the model's fields as defaults; a single body has an empty name."""
        if self.bodies is None:
            return {"": self}
        if self._whole:
            return self._whole
        defaults = {name: read_default(info) for name, info in Body.model_fields.items()}
        said = {name: value for name, default in defaults.items() if (value := getattr(self, name)) != default}

        def whole(body: Body) -> Body:
            density = body.mass is None and body.density is None
            more = {name: value for name, value in said.items() if getattr(body, name) == defaults[name]}
            if not density:  # either mass or density is given
                more = {name: value for name, value in more.items() if name not in ("mass", "density")}
            return body.model_copy(update=more)

        self._whole = {name: whole(body) for name, body in self.bodies.items()}
        return self._whole

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all masses, and of each body and its points by name."""
        bodies = written.get("bodies")
        several = bodies if isinstance(bodies, Mapping) else {"": written}
        found = dict(cls.gives)
        for name, body in several.items():
            points = body.get("points") if isinstance(body, Mapping) else None
            own = {f"{point}.{output}": gives for point in points or () for output, gives in POINT.items()}
            found |= {_joined(name, output): gives for output, gives in {**ONE, **own}.items()}
        return found

    def items(self, output: str) -> int | None:
        """How many there are."""
        several = masses.BODY_OUTPUTS.get(output)
        return len(self._each) if several is not None and several.type.shape[:1] == (None,) else None

    def static_masses(self) -> Mapping[str, StaticMass]:
        """Those whose mass is told."""
        return {
            name: StaticMass(body.mass, body.position, body.velocity, body.fixed)
            for name, body in self._each.items()
            if body.mass is not None
        }

    def remark(self, state: ModelState) -> str:
        """The masses, and how exact those are that are integrals over cells."""
        heaviest = sorted(self._made.items(), key=lambda one: -one[1].mass)
        told = ", ".join(
            f"{name or 'it'} {made.mass:.6g} kg" + (f" (within {made.error:.1g} of it)" if made.error > 0 else "")
            for name, made in heaviest[:MOST_TOLD]
        )
        more = len(heaviest) - MOST_TOLD
        return f"{told} and {more} lighter" if more > 0 else told

    def assemble(self, name: str, assembly: Assembly) -> Bodies:
        """Reserve the bodies."""
        import numpy as np

        from sceneql.bodies.rigid import turning

        each = list(self._each.values())
        made = [body.made(assembly) for body in each]
        self._made = dict(zip(self._each, made, strict=True))
        bodies = masses.reserve(
            name,
            assembly,
            positions=np.array([one.position for one in made]),
            velocities=np.array([body.velocity for body in each]),
            masses=np.array([one.mass for one in made]),
            radii=np.zeros(len(made)),
            fixed=np.array([body.fixed for body in each]),
        )
        return turning.reserve(
            assembly,
            bodies,
            rotations=np.array([one.rotation for one in made]),
            spins=np.array([body.spin for body in each]),
            inertias=np.array([one.inertia for one in made]),
        )

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual; of a body among several by its name first."""
        import numpy as np

        from sceneql.bodies.rigid import turning
        from sceneql.shapes.placement import rotation_matrix

        bodies = state.bodies
        assert bodies is not None
        assert bodies.turning is not None
        if output in masses.BODY_OUTPUTS:
            return masses.read(output, bodies, state)
        name, point, what = self._said(output)
        k = list(self._each).index(name)
        x, v = masses.positions(bodies, state)[k], masses.velocities(bodies, state)[k]
        q = turning.rotations(bodies.turning, bodies.count, state)[k]
        spin = turning.spins(bodies.turning, bodies.count, state)[k]
        arm = rotation_matrix(q) @ self._arm(name, point)
        match what:
            case "position":
                return x + arm if point else x.copy()
            case "velocity":
                return v + np.cross(spin, arm) if point else v.copy()
            case "acceleration":
                return masses.accelerations(bodies, state)[k].copy()
            case "origin":
                return x + arm
            case "rotation":  # of length 1, because outputs read settled states
                return state.y[bodies.turning.rotation_at + 4 * k :][:4].copy()
            case "spin":
                return spin
            case "body_spin":
                return turning.body_spins(bodies.turning, bodies.count, state)[k]
        return self._made[name].inertia

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the centers of mass and their velocities, and of quaternions, within a step nearly of length 1."""
        import numpy as np

        bodies = state.bodies
        assert bodies is not None
        assert bodies.turning is not None
        if output in masses.BODY_OUTPUTS:
            return masses.places(output, bodies)
        name, point, what = self._said(output)
        k = list(self._each).index(name)
        at = {"position": bodies.position_at + 3 * k, "velocity": bodies.velocity_at + 3 * k}.get(what)
        if (point or what == "origin") and what != "velocity" and not any(self._arm(name, point)):
            at = bodies.position_at + 3 * k
        elif point or what not in ("position", "velocity", "rotation"):
            return None
        return np.arange(3) + at if at is not None else np.arange(4) + bodies.turning.rotation_at + 4 * k

    def point(self, output: str, state: ModelState) -> tuple[int, tuple[float, float, float]] | None:
        """Centers of mass, origins, and points."""
        found = super().point(output, state)
        if found is not None or output in masses.BODY_OUTPUTS:
            return found
        name, point, what = self._said(output)
        if not (what == "origin" or (point and what == "position")):
            return None
        x, y, z = (float(c) for c in self._arm(name, point))
        return list(self._each).index(name), (x, y, z)

    def _arm(self, body: str, point: str) -> Sequence[float]:
        """Vector (3,) [m] from a body's center of mass to one of its points, or to its origin, in its own axes."""
        # Before assembly the center is neither known nor needed.
        center = self._made[body].center if body in self._made else (0.0, 0.0, 0.0)
        return [p - c for p, c in zip(self._each[body].points[point] if point else (0, 0, 0), center, strict=True)]

    def computed(self, name: str, output: str) -> Expr | None:
        """The origin and points, by the place of the center of mass and the rotation."""
        if output in masses.BODY_OUTPUTS:
            return None
        body, point, what = self._said(output)
        if not (what == "origin" or (point and what == "position")) or not any(self._arm(body, point)):
            return None
        arm = tuple(Number(float(c), Type((), dim.LENGTH)) for c in self._arm(body, point))
        place, turn = Link(name, _joined(body, "position"), PLACE), Link(name, _joined(body, "rotation"), TURN)
        return Call("add", (place, rotated(Call("normalize", (turn,), TURN), Vector(arm, PLACE))), PLACE)

    def solids(self) -> list[tuple[Ref | None, Floats]]:
        """The object of each body, and its center of mass in the object's own axes (3,) [m]."""
        return [(body.of, self._made[name].center) for name, body in self._each.items()]

    def drives(self) -> Mapping[str, Mapping[str, str]]:
        """Position and rotation of the objects that are bodies."""
        return {
            body.of.name: {"position": _joined(name, "origin"), "rotation": _joined(name, "rotation")}
            for name, body in self._each.items()
            if body.of is not None
        }

    def with_own_shapes(self, own: Callable[[Ref], Ref]) -> Rigid:
        """Itself with an object for each body."""

        def shaped(body: Body) -> dict[str, Ref]:
            return {} if body.of is None else {"of": own(body.of)}

        several = {name: body.model_copy(update=shaped(body)) for name, body in (self.bodies or {}).items()}
        found = self.model_copy(update={**shaped(self), "bodies": several or None})
        found._whole, found._made = {}, {}
        return found

    def insides(self) -> Iterable[Ref]:
        """The objects whose mass properties it takes."""
        return [body.of for body in self._each.values() if body.of is not None]

    def _said(self, output: str) -> tuple[str, str, str]:
        """Body, point and output in a name such as ``crate.hook.position``; each empty if absent."""
        rest, _, what = output.rpartition(".")
        body = rest if self.bodies is not None else ""
        while body and body not in self._each:  # a copy's name contains a dot: ``stone.0.hook.position``
            body = body.rpartition(".")[0]
        return body, rest[len(body) :].removeprefix("."), what


def _joined(name: str, output: str) -> str:
    return f"{name}.{output}" if name else output
