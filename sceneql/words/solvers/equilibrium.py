"""equilibrium: static equilibrium under the loads of each instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import FixedScalar, FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper

APART = "sceneql.stepping.equilibrium_apart_kernels:step"


class Equilibrium(Solver):
    """Rest under the loads of each instant: the places of the masses where all forces are zero; nothing moves.

    It begins with the rest that the start goes down to, and follows it as loads and led places change in time, by
    Newton's method in steps of its own between frames. A limit load, beyond which no rest is near, and a rest that is
    unstable, as a column that would buckle, end the run with the time and the forces reached. Forces need slopes.
    Where solids touch friction does not act, since nothing slides at rest.
    Sources: Riks (1979), Int. J. Solids Struct. 15, 529-551; Crisfield, Non-linear Finite Element Analysis (1991).
    """

    static: ClassVar[bool] = True
    refuses_ties: ClassVar[str] = "the forces of ties are no part of its linear systems"

    tolerance: FixedScalar = field(
        "Relative and absolute error that Newton's method leaves in places, in SI units.", "1e-10", above=0, below=1
    )
    step: FixedTime | None = field(
        "No step between frames is longer; by default as long as its path allows.", None, above=0
    )

    def stepper(self) -> Stepper:
        """Steps of implicit Euler from rest, far longer than all periods."""
        from sceneql.stepping.implicit_tableau import NO_MEMORY
        from sceneql.system import Control, Method, Needs, Stepper

        return Stepper(
            Method(
                step="sceneql.stepping.equilibrium_kernels:step",
                order=1,
                dense="sceneql.stepping.implicit_runge_kutta_kernels:linear",
                settings=(0.0, 1.0, self.tolerance, self.tolerance, 1.0, *NO_MEMORY, 0.0, 0.0, 0.0, 0.0),
            ),
            Control(
                first_step=self.step or 1.0,
                adaptive=True,
                tolerance=self.tolerance,
                largest_step=self.step or float("inf"),
                self_controlled=True,
            ),
            Needs(
                jacobian=True,
                newton=True,
                at_rest=True,
                prepare="sceneql.words.solvers.equilibrium:prepare",
                march="sceneql.march.equilibrium_march:EquilibriumMarch",
            ),
        )

    def choose(self, island: IslandFacts) -> Methods:
        """Steps down the potential where a barrier keeps surfaces apart, since paths bend where they meet."""
        from dataclasses import replace

        stepper = self.stepper()
        if island.apart:
            stepper = replace(stepper, method=replace(stepper.method, step=APART))
        return Methods(self, stepper)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """0: nothing of a motion is left."""
        return 0.0


def prepare(system: Any, stepper: Stepper) -> Any:
    """Arrays for equilibrium_kernels.step on an island."""
    import numpy as np

    from sceneql.linear.stage import stage_plan
    from sceneql.stepping.equilibrium_kernels import ARRAYS, HEAD
    from sceneql.system import Prepared

    plan = stage_plan(system, exact=True, signs=True)
    velocities = np.unique(system.partner[system.partner >= 0])
    tallies = system.pattern.tallies
    lists = np.concatenate([velocities, tallies]).astype(np.int64)
    head = [system.pattern.room, HEAD + len(lists), len(velocities), len(tallies)]
    return Prepared(
        settings=np.concatenate([stepper.method.settings, plan.scales]),
        numbers=np.concatenate([head, lists, plan.numbers]),
        work=ARRAYS * len(system.y) + system.pattern.room + plan.store,
        text=f"rest by Newton's method: {plan.text}",
    )
