"""auto: choice of a solver for each island."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Methods, Solver, field
from sceneql.stepping.tableau import DORMAND_PRINCE
from sceneql.words.solvers.ark3 import Ark3
from sceneql.words.solvers.bdf2 import Bdf2
from sceneql.words.solvers.dop853 import Dop853
from sceneql.words.solvers.dopri5 import Dopri5
from sceneql.words.solvers.exact import Exact
from sceneql.words.solvers.gauss_radau15 import GaussRadau15
from sceneql.words.solvers.imex_midpoint import ImexMidpoint
from sceneql.words.solvers.radau import Radau
from sceneql.words.solvers.tr_bdf2 import TrBdf2

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper

TIGHT = 1e-4
"""Tolerance up to which order 8 takes less time than order 5 for the same error (tests/bench/bench_auto.py)."""
IN_CONTACT = 1e-6
"""Tolerance below which order 8 takes less time with impacts, for which it computes dense output in each step."""
HOPEFUL = 1e-7
"""Tolerance above which order 8 gets a tenth of it: with its long steps its error exceeds that of order 5."""
ORBITS = 1e-10
"""Tolerance up to which order 15 takes less time on orbits, with its own tolerance IN_ORBITS and errors < 1e-12."""
IN_ORBITS = 1e-6
APART, LEFT = 1.0 / 480.0, 1e-3
"""Step [s] of tr_bdf2 with barriers, and residual of Newton's method in it, relative and, for solids of 1 m or more, in
m/s. A bouncing soft ball then loses 5 % of its energy; with bdf2 in steps of twice that, which take as long, it loses
40 %. By a residual of 1e-5 its nodes moved as by this, to 4e-5 m."""
MANY = 6000
"""Unknowns in elastic solids above which a step of radau, three stages at once in complex numbers, takes seconds."""
NOT_BDF2 = "; bdf2, of one stage a step, would take {} for the same error on so many unknowns"
"""Why large solids are marched by tr_bdf2. A bar of 12,000 unknowns to an error of 1.5e-4 (9e-4) of its length: 3.7
(2.5) s of a processor by tr_bdf2, 12 (5.3) by bdf2; one of 56,000 to 4e-4: 17 and 40 s. A step has two stages, but one
matrix. A block in touch with a torus to 1.3 (2.1) mm: 15.6 (7.3) and 17.3 (7.9) s (bench_large_elements.py)."""
COARSER = 100.0
"""Factor of the tolerance for a method of order 2 that replaces one of order 5, and for elastic solids, whose fast
modes would else be followed to parts in a million of motions that nobody sees."""
FINEST = 1e-5
"""Tolerance of elastic solids below which radau is cheaper than tr_bdf2, which has order 2."""
STAGES_OF_SOLIDS = 3.0
"""Steps of dopri5 that one of tr_bdf2 costs on elastic solids: 1.7 on 263 nodes, 2.8 on 729, 2.3 on 550 of p2_mean."""


class Auto(Solver):
    """The solver that suits: dop853, or dopri5 for a tolerance above 1e-4, and radau where the scene is stiff.

    Where contacts, tears or births act it is dopri5 for one of 1e-6 or more. From there up to 1e-4, dop853 has a
    tenth of the tolerance, with which it errs less than dopri5. Stiff is where stability rather than the tolerance
    would hold the steps of the explicit method. That choice is made at the start, by the fastest mode of the
    island, the step that the tolerance allows, the length of the run and what a step of radau costs with so many
    unknowns, and looked at again as long as enough of the run is left; `explain` says the first and why. Few masses
    that nothing but forces at a distance moves (gravity, attractors) are marched by gauss_radau15 for a tolerance
    of 1e-10 or less. (On large nets tr_bdf2 is quicker where errors of 1e-4 will do: ask for it by name.) Rigid
    bodies that nothing but uniform gravity acts on move by exact, without steps. Local contacts of up to some sixty
    masses keep it with dopri5. A field on a grid, or on elements, is marched by tr_bdf2, and on cells of a box
    whose coefficient and boundary do not vary by exact; a flow, with all that is solved with it, by ark3, and by
    imex_midpoint where its density or viscosity varies; elastic solids that may touch by tr_bdf2 in steps of 1/480
    s, others by these explicit methods with 100 times the tolerance and, where they are stiff, by tr_bdf2 with
    that; for a tolerance below 1e-7 as all else, but large ones by bdf2. (For larger tolerances bdf2 takes two to
    three times as long as tr_bdf2 for the same error, on 12,000 and on 56,000 unknowns, and as long in contact.)
    Errors are measured as those of `radau` are. Sources: see these words; the sign of stiffness is that of Hairer &
    Wanner, Solving Ordinary Differential Equations II (1996), IV.2.
    """

    tolerance: FixedScalar = field(
        "Relative error of a step; of a field on a grid, whose cells err more, 100 times that.",
        "1e-6",
        at_least=1e-14,
        below=1,
    )
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default none: errors are relative to how large entries have been.",
        None,
        above=0,
    )

    def explanation(self) -> str:
        """What it chooses from."""
        if self.tolerance > TIGHT:
            return f"dopri5, as its tolerance is above {TIGHT:g}, and radau where the scene is stiff"
        if self.tolerance < IN_CONTACT:
            return f"dop853, as its tolerance is below {IN_CONTACT:g}, and radau where the scene is stiff"
        part = f"dop853 with a tenth of its tolerance {self.tolerance:g} (at least {HOPEFUL:g})"
        return (
            f"{part}, or dopri5 with all of it where contacts, tears or births act, and radau where the scene is stiff"
        )

    def stepper(self) -> Stepper:
        """That of its explicit method."""
        return self._order_5() if self.tolerance > TIGHT else self._order_8()

    def choose(self, island: IslandFacts) -> Methods:
        """An explicit method with radau, but for few masses with local contacts and for orbits; on a grid others."""
        from dataclasses import replace

        from sceneql.island.jacobian import BY_DIFFERENCES

        if island.free:
            return replace(Exact().choose(island), remark="on rigid bodies that move freely")
        grid = island.fields.single
        if grid is not None and island.floats is not None:
            from sceneql.grids.multigrid.separable import axes_of

            if axes_of(grid, island.floats()) is not None:
                return Exact().choose(island)
            return TrBdf2(tolerance=min(100.0 * self.tolerance, 0.1), absolute=self.absolute).choose(island)
        if island.fields.on_elements:
            there = "for a field on elements"
            tr_bdf2 = TrBdf2(tolerance=min(100.0 * self.tolerance, 0.1), absolute=self.absolute)
            return replace(tr_bdf2.choose(island), remark=there)
        if island.fields.flow is not None and island.fields.flow.varying:
            there = "as its density or viscosity varies"
            several = ImexMidpoint(tolerance=min(100.0 * self.tolerance, 0.1))
            return replace(several.choose(island), remark=there)
        if island.fields.flow is not None:
            return Ark3(tolerance=min(100.0 * self.tolerance, 0.1)).choose(island)
        if island.apart and self.tolerance != type(self)().tolerance:
            there = "by its tolerance, which is written, where a barrier keeps surfaces apart"
            radau = Radau(tolerance=self.tolerance, absolute=self.absolute)
            return replace(radau.choose(island), remark=there)
        if island.apart:
            there = (
                "in steps of one length, since a barrier keeps surfaces apart, towards which others would creep; they "
                "take some percent of the energy of an impact, `implicit_midpoint` nearly none, in more time"
            )
            there += NOT_BDF2.format("as long, or a little longer,") if island.in_solids >= MANY else ""
            return replace(TrBdf2(step=APART, newton=LEFT * min(1.0, island.solids_size)).choose(island), remark=there)
        if island.in_solids and not island.impacts and COARSER * self.tolerance >= FINEST:
            return self._of_solids(island)
        if island.in_solids >= MANY:
            coarser = Bdf2(tolerance=round(min(COARSER * self.tolerance, 0.1), 16), absolute=self.absolute)
            there = (
                f"for solids with {island.in_solids:,} unknowns, of which each stage of radau would cost too much, "
                f"at a tolerance of {coarser.tolerance:g}"
            )
            return replace(coarser.choose(island), remark=there)
        few = island.entries <= BY_DIFFERENCES
        if island.local_contacts and few:
            return Methods(self, self._order_5(), bounded_by=Dopri5(tolerance=self.tolerance))
        if island.orbits and few and self.tolerance <= ORBITS:
            there = "for few masses that attract each other, at so small a tolerance"
            return replace(GaussRadau15(tolerance=IN_ORBITS).choose(island), remark=there)
        stiff = Radau(tolerance=self.tolerance, absolute=self.absolute).stepper()
        of_order_5 = island.impacts and self.tolerance >= IN_CONTACT
        return Methods(
            self,
            self._order_5() if of_order_5 else self.stepper(),
            stiff=replace(stiff, method=replace(stiff.method, name="radau")),
            bounded_by=Dopri5(tolerance=self.tolerance) if of_order_5 else None,
        )

    def _of_solids(self, island: IslandFacts) -> Methods:
        """An explicit method and tr_bdf2, for elastic solids that touch nothing."""
        from dataclasses import replace

        coarser = type(self)(tolerance=round(min(COARSER * self.tolerance, 0.1), 16), absolute=self.absolute)
        absolute = self.absolute or coarser.tolerance * min(1.0, island.solids_size)
        stiff = TrBdf2(tolerance=coarser.tolerance, absolute=absolute).stepper()
        there = f"elastic solids at a tolerance of {coarser.tolerance:g}, by tr_bdf2, not radau, where they are stiff"
        there += NOT_BDF2.format("two or three times as long") if island.in_solids >= MANY else ""
        return Methods(
            coarser,
            coarser.stepper(),
            stiff=replace(stiff, method=replace(stiff.method, name="tr_bdf2")),
            stiff_cost=STAGES_OF_SOLIDS,
            remark=there,
        )

    def measure(self) -> str:
        """As its methods do."""
        return "of how large entries have been" if self.absolute is None else super().measure()

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """That of its explicit method."""
        if self.tolerance <= TIGHT:
            return Dop853().growth(jacobian, partner, step)
        return DORMAND_PRINCE.growth(jacobian, step)

    def _order_5(self) -> Stepper:
        from dataclasses import replace

        absolute = self.tolerance if self.absolute is None else self.absolute
        stepper = DORMAND_PRINCE.adaptive(self.tolerance, absolute, by_scale=self.absolute is None)
        named = replace(stepper.method, name="dopri5", stability=DORMAND_PRINCE.stability_function)
        return replace(stepper, method=named)

    def _order_8(self) -> Stepper:
        from dataclasses import replace

        from sceneql.stepping.dormand_prince_8 import DORMAND_PRINCE_8

        tolerance = min(self.tolerance, max(0.1 * self.tolerance, HOPEFUL))
        stepper = Dop853(tolerance=tolerance, absolute=self.absolute).stepper()
        return replace(
            stepper,
            method=replace(stepper.method, name="dop853", stability=DORMAND_PRINCE_8.stability_function),
            control=replace(stepper.control, by_scale=self.absolute is None),
        )
