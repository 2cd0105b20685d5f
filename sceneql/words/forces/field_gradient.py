"""field_gradient: a force along the gradient of a field on a grid."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.grids.into_field import dimension, numbers, unfit
from sceneql.kinds import Force, Problem, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.units import describe, in_words

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class FieldGradient(Force):
    """The force F = factor grad c of a field c of the same island on every mass in its domain: up the field, or down.

    The gradient is that of central differences at the centers of cells, linear between them (one-sided beside the
    boundary, of cells inside alone); outside the domain there is none. A flat field acts along x and y at every z.
    What it does to the masses is counted in the work. The model and the field are solved together, by an explicit
    method unless the island is small. Source: Hockney & Eastwood, Computer Simulation Using Particles (1988), 5-3.
    """

    of: Annotated[Value, Quantity(None, (None,))] = field("The field: `lake.concentration`.")
    factor: Annotated[Value, Quantity(None)] = field("Force for a gradient: N m for a unit of the field.")

    def problems(self) -> Iterator[Problem]:
        """A value that is no field, a factor of another dimension."""
        yield from unfit(self.of, "of")
        own, given = dimension(self.of), self.factor.expr.type.dimension
        if own is not None and not dim.suits(given, dim.ENERGY / own):
            wanted = describe(dim.ENERGY / own)
            yield Problem(
                f"the factor is {wanted}, and this is {in_words(given)}", ("factor",), code="dimension-mismatch"
            )

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, and its power to the work. Raises ScriptError where it is of no field."""
        own = (bodies.position_at, bodies.velocity_at, bodies.count, bodies.work_at, bodies.inverse_at)
        kernel = "sceneql.words.forces.field_gradient_kernels:field_gradient"
        assembly.term("force", kernel, (*own, assembly.value(self.factor), *numbers(self.of, assembly)))
