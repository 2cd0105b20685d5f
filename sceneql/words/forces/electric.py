"""electric: the force of an electric field on charges."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.bodies.charges import Charges, ElectricField, each, of_moving
from sceneql.island.static_rates import On, by_formulas, number
from sceneql.kinds import Force, Formula, Problem, Symbols, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim
from sceneql.quantities.unit_table import VOLTAGE

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState


class Electric(Force):
    """The force of an electric field: F = q E (Lorentz 1895).

    The field is uniform (``field``), or three formulas of x y z t in V/m (``formula``), or minus the gradient of a
    formula in V (``potential``). The energy of charges in a uniform field or a potential is -q E . x or q phi; what a
    field by formula does to them is counted in the work.
    """

    charge: Charges = field("Charge of every mass, or a list with one for each.")
    field_: ElectricField | None = field("The same field everywhere; it may vary in time.", None)
    formula: Annotated[Formula, Symbols(("x", "y", "z", "t"), VOLTAGE / dim.LENGTH, several=True)] | None = field(
        "Its components [V/m].", None
    )
    potential_: Annotated[Formula, Symbols(("x", "y", "z", "t"), VOLTAGE)] | None = field("Its potential [V].", None)

    def problems(self) -> Iterator[Problem]:
        """Several fields or none, and formulas that are no field."""
        from sceneql.bodies.point_program import problem, remedy

        if sum(given is not None for given in (self.field_, self.formula, self.potential_)) != 1:
            yield Problem("an electric field is said in one way: `field`, `formula` or `potential`")
        for name, formula, count in (("formula", self.formula, 3), ("potential_", self.potential_, 1)):
            if formula is not None and (text := problem(formula, count)) is not None:
                yield Problem(text, (name,), help=remedy(formula, count))

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """Swings of charges in a field that varies with the place."""
        from sceneql.bodies.point_program import CHARGE, downhill, scaled
        from sceneql.quantities.derivative import components

        charge, formula = number(self.charge), self.formula or self.potential_
        if isinstance(charge, float | int) and formula is not None:
            rows = downhill(formula) if self.formula is None else components(formula.expr)
            at = "potential" if self.formula is None else "formula"
            yield from by_formulas(scaled(rows, CHARGE), on, f"force '{name}'", at, {"q": charge})

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add q E to every mass."""
        from sceneql.system import Slopes

        charge = each(assembly, self.charge, bodies.count, "charge")
        if self.field_ is not None:
            at = assembly.value(self.field_)
            ints = (bodies.velocity_at, bodies.count, *charge, at)
            assembly.term("force", "sceneql.words.forces.electric_kernels:electric", ints, Slopes("", (), ()))
            assembly.remember(*charge, at)
            return
        from sceneql.bodies.point_program import CHARGE, add_force, downhill, scaled, store_links
        from sceneql.quantities.derivative import components

        assembly.remember(*charge)
        if self.potential_ is not None:
            rows = downhill(self.potential_)
            assembly.remember(*store_links(assembly, self.potential_))
        else:
            assert self.formula is not None
            rows = components(self.formula.expr)
        add_force(assembly, bodies, scaled(rows, CHARGE), charge, counted=self.potential_ is None)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Sum of -q E . x, or of q phi [J]; 0 where the work is counted."""
        from sceneql.bodies import bodies as masses
        from sceneql.bodies.point_program import potential_at

        charges = of_moving(bodies, state, state.ints[0], state.ints[1])
        places = masses.positions(bodies, state)
        if self.field_ is not None:
            at = state.ints[2]
            return -float(charges @ (places @ state.floats[at : at + 3]))
        if self.potential_ is not None:
            return float(charges @ potential_at(self.potential_, places, state, state.ints[2:]))
        return 0.0
