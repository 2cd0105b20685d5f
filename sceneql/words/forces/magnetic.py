"""magnetic: the force of a magnetic field on moving charges."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

from sceneql.bodies.charges import Charges, MagneticField, each
from sceneql.island import static_rates
from sceneql.island.static_rates import On, by_formulas, number
from sceneql.kinds import Force, Formula, Problem, Symbols, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Call, Expr, Symbol
from sceneql.quantities.unit_table import VOLTAGE

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState


class Magnetic(Force):
    """The force of a magnetic field: F = q v x B (Lorentz 1895). It does no work.

    The field is uniform (``field``), or three formulas of x y z t in T (``formula``). In a uniform field charges run
    round at the angular frequency q B / m.
    """

    needs_speed: ClassVar[bool] = True

    charge: Charges = field("Charge of every mass, or a list with one for each.")
    field_: MagneticField | None = field("The same field everywhere; it may vary in time.", None)
    formula: Annotated[Formula, Symbols(("x", "y", "z", "t"), VOLTAGE * dim.TIME / dim.AREA, several=True)] | None = (
        field("Its components [T].", None)
    )

    def problems(self) -> Iterator[Problem]:
        """Two fields or none, and a formula that is no field."""
        from sceneql.bodies.point_program import problem, remedy

        if (self.field_ is None) == (self.formula is None):
            yield Problem("a magnetic field is said in one way: `field` or `formula`")
        if self.formula is not None and (text := problem(self.formula, 3)) is not None:
            yield Problem(text, ("formula",), help=remedy(self.formula, 3))

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """How fast charges run round."""
        from sceneql.bodies.point_program import CHARGE, scaled

        charge, field_ = number(self.charge), None if self.field_ is None else number(self.field_)
        if not isinstance(charge, float | int):
            return
        if self.formula is not None:
            rows = scaled(self._turned(self.formula), CHARGE)
            yield from by_formulas(rows, on, f"force '{name}'", "formula", {"q": charge})
        elif field_ is not None:
            for one in static_rates.each(on):
                yield Oscillation(0.0, 0.0, f"force '{name}'", ("field",), turn=charge * math.hypot(*field_) / one.mass)

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add q v x B to every mass."""
        from sceneql.bodies import bodies as masses
        from sceneql.system import Slopes

        charge = each(assembly, self.charge, bodies.count, "charge")
        if self.field_ is not None:
            ints = (bodies.velocity_at, bodies.count, *charge, assembly.value(self.field_))
            slopes = "sceneql.words.forces.magnetic_slopes_kernels:magnetic"
            kernel = "sceneql.words.forces.magnetic_kernels:magnetic"
            places = (bodies, bodies.velocity_at)
            assembly.term("force", kernel, ints, lambda: Slopes(slopes, *masses.own_blocks(*places), blocks=True))
            return
        from sceneql.bodies.point_program import CHARGE, add_force, scaled

        assert self.formula is not None
        add_force(assembly, bodies, scaled(self._turned(self.formula), CHARGE), charge, counted=False)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """None, and it takes no energy either."""
        return 0.0

    @staticmethod
    def _turned(formula: Formula) -> list[Expr]:
        """Components of v x B as expressions."""
        from sceneql.quantities.derivative import components

        return _cross([Symbol("vx"), Symbol("vy"), Symbol("vz")], list(components(formula.expr)))


def _cross(a: list[Expr], b: list[Expr]) -> list[Expr]:
    """Components of the vector product a x b as expressions."""
    pairs = ((1, 2), (2, 0), (0, 1))
    return [Call("sub", (Call("mul", (a[i], b[j])), Call("mul", (a[j], b[i])))) for i, j in pairs]
