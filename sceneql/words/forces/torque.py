"""torque: any torque on rigid bodies, written as a formula."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.kinds import Force, Formula, Problem, Symbols, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Torque(Force):
    """A torque by formula, on every rigid body: three components in N m, in the world's axes.

    x y z (center of mass [m]), vx vy vz (its velocity [m/s]), t (time [s]) and m (mass [kg]) are plain numbers in the
    formulas. Its power is counted in the work, so that the energy is conserved with it.
    """

    components: Annotated[
        Formula, Symbols(("x", "y", "z", "vx", "vy", "vz", "t", "m"), dim.FORCE * dim.LENGTH, several=True)
    ] = field("Its components [N m]: `components: [0, 3, 0]` is about y.")

    def problems(self) -> Iterator[Problem]:
        """Formulas that are no torque."""
        from sceneql.bodies.point_program import problem, remedy

        if (text := problem(self.components, 3)) is not None:
            yield Problem(text, ("components",), help=remedy(self.components, 3))

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the torque to every body. Raises ScriptError where it is to act on masses that do not turn."""
        from sceneql.bodies.point_program import add_force_at
        from sceneql.quantities import derivative
        from sceneql.system import Place

        if bodies.turning is None:
            if self.on is None:
                return
            message = f"a torque acts on rigid bodies, and the masses of '{bodies.model}' do not turn"
            raise ScriptError([Diagnostic("no-rotation", message, assembly.line())])
        rows = derivative.components(self.components.expr)
        for k in range(bodies.count):
            add_force_at(assembly, Place(bodies, k), rows, counted=True, torque=True)
