"""auto: the solver that suits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Methods, Solver, field
from sceneql.stepping.tableau import DORMAND_PRINCE
from sceneql.words.solvers.exact import Exact
from sceneql.words.solvers.radau import Radau
from sceneql.words.solvers.tr_bdf2 import TrBdf2

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class Auto(Solver):
    """The solver that suits: dopri5, and radau where stability rather than the tolerance would hold its steps.

    The choice is made at the start, by the fastest mode of the island, the step that the tolerance allows and what a
    step of radau costs with so many unknowns, and looked at again during the run; `explain` says the first and why.
    (On large nets tr_bdf2 is quicker where errors of 1e-4 will do: ask for it by name.) Local contacts of up to
    some sixty masses keep it with dopri5. A field on a grid is marched by
    tr_bdf2, and on a box whose coefficient and boundary do not vary by exact. Sources: see these words; the sign of
    stiffness is that of Hairer & Wanner, Solving Ordinary Differential Equations II (1996), IV.2.
    """

    tolerance: FixedScalar = field(
        "Relative error of a step; of a field on a grid, whose cells err more, 100 times that.",
        "1e-6",
        at_least=1e-14,
        below=1,
    )

    def explanation(self) -> str:
        """What it chooses from."""
        return "dopri5, and radau where the scene is stiff"

    def stepper(self) -> Stepper:
        """That of dopri5."""
        from dataclasses import replace

        explicit = DORMAND_PRINCE.adaptive(self.tolerance, self.tolerance)
        named = replace(explicit.method, name="dopri5", stability=DORMAND_PRINCE.stability_function)
        return replace(explicit, method=named)

    def choose(self, island: IslandFacts) -> Methods:
        """dopri5 with radau, but for few masses with local contacts; on a grid exact where it applies, else tr_bdf2."""
        from dataclasses import replace

        from sceneql.island.jacobian import BY_DIFFERENCES

        if island.grid is not None and island.floats is not None:
            from sceneql.grids.multigrid.separable import axes_of

            if axes_of(island.grid, island.floats()) is not None:
                return Exact().choose(island)
            return TrBdf2(tolerance=min(100.0 * self.tolerance, 0.1)).choose(island)
        if island.local_contacts and island.entries <= BY_DIFFERENCES:
            return Methods(self, self.stepper())
        stiff = Radau(tolerance=self.tolerance).stepper()
        return Methods(self, self.stepper(), stiff=replace(stiff, method=replace(stiff.method, name="radau")))

    def measure(self) -> str:
        """Those of its two methods."""
        return f"of an entry plus {self.tolerance} in SI units; by radau of how large entries have been"

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """That of dopri5."""
        return DORMAND_PRINCE.growth(jacobian, step)
