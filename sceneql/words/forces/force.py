"""force: any force, written as a formula."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar

from sceneql.bodies.place import model_of, place_of, place_problems
from sceneql.island.static_rates import On, by_formulas
from sceneql.kinds import Force as Family
from sceneql.kinds import Formula, Position, Problem, Symbols, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState

SYMBOLS = ("x", "y", "z", "vx", "vy", "vz", "t", "m")


class Force(Family):
    """A force by formula, on every mass: three components in N, or minus the gradient of a potential energy in J.

    With `at` it acts at one place, a mass or a point of a rigid body, `crate.hook`, which it turns, too. x y z (place
    [m]), vx vy vz (velocity [m/s]), t (time [s]) and m (mass [kg]) are plain numbers in the formulas. What a force by
    components does to the masses is counted in the work, so that the energy is conserved with both.
    """

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("start", "end", "until", "duration", "from", "to", "begin"),
        "a formula says when, from 1 s to 2 s `components: [where((t > 1)*(t < 2), 5, 0), 0, 0]`",
    )

    components: Annotated[Formula, Symbols(SYMBOLS, dim.FORCE, several=True)] | None = field(
        "Its components [N]: `components: [0, 5, 0]` is upwards.", None
    )
    potential_: Annotated[Formula, Symbols(("x", "y", "z", "t", "m"), dim.ENERGY)] | None = field(
        "The potential energy of one mass [J].", None
    )

    at: Position | None = field("The mass, or the point of a body, on which it acts.", None)

    def targets(self) -> tuple[str, ...] | None:
        """The model of its place."""
        return super().targets() if self.at is None else model_of(self.at)

    def problems(self) -> Iterator[Problem]:
        """Two formulas or none, those that are no force, and a place that is none."""
        from sceneql.bodies.point_program import problem, remedy

        yield from place_problems(self.at, self.on is not None)
        if (self.components is None) == (self.potential_ is None):
            yield Problem("a force is said in one way: `components` or `potential`")
        for name, formula, count in (("components", self.components, 3), ("potential_", self.potential_, 1)):
            if formula is not None and (text := problem(formula, count)) is not None:
                yield Problem(text, (name,), help=remedy(formula, count))

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """Swings about the places where masses start, and what acts against their velocities."""
        from sceneql.bodies.point_program import downhill
        from sceneql.quantities.derivative import components

        if self.potential_ is not None:
            yield from by_formulas(downhill(self.potential_), on, f"force '{name}'", "potential")
        elif self.components is not None:
            yield from by_formulas(components(self.components.expr), on, f"force '{name}'", "components")

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, or at its place."""
        from sceneql.bodies.point_program import add_force, add_force_at, downhill, store_links
        from sceneql.quantities import derivative

        if self.at is not None:
            place = place_of(self.at, assembly)
            assembly.remember(*place.ints)
            rows = () if self.components is None else derivative.components(self.components.expr)
            if self.potential_ is not None:
                assembly.remember(*store_links(assembly, self.potential_))
                rows = downhill(self.potential_)
            add_force_at(assembly, place, rows, counted=self.potential_ is None)
            return
        if self.potential_ is not None:
            assembly.remember(*store_links(assembly, self.potential_))
            add_force(assembly, bodies, downhill(self.potential_), counted=False)
        elif self.components is not None:
            add_force(assembly, bodies, derivative.components(self.components.expr), counted=True)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """The sum of the potential [J]; 0 where the work is counted."""
        from sceneql.bodies import bodies as masses
        from sceneql.bodies.point_program import potential_at

        if self.potential_ is None:
            return 0.0
        if self.at is not None:
            return self._potential_at(bodies, state)
        known = {"m": masses.masses(bodies, state)}
        moving = masses.moving_masses(bodies, state) > 0
        at = masses.positions(bodies, state)
        return float(potential_at(self.potential_, at, state, state.ints, known)[moving].sum())

    def _potential_at(self, bodies: Bodies, state: ModelState) -> float:
        """Potential energy [J] at the force's place."""
        import numpy as np

        from sceneql.bodies import bodies as masses
        from sceneql.bodies.point_program import potential_at
        from sceneql.bodies.rigid.place_kernels import INVERSE_AT, PLACE, where

        assert self.potential_ is not None
        ints = np.array(state.ints[:PLACE])
        if state.floats[ints[INVERSE_AT]] == 0.0:
            return 0.0
        known = {"m": masses.masses(bodies, state)[ints[INVERSE_AT] - bodies.inverse_at]}
        place = np.array([where(state.y, state.floats, ints, 0)])
        return float(potential_at(self.potential_, place, state, state.ints[PLACE:], known)[0])
