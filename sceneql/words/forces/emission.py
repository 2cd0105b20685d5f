"""emission: masses as sources of a field on a grid."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.grids.into_field import dimension, numbers, unfit
from sceneql.kinds import Force, Problem, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.units import describe, in_words

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Emission(Force):
    """Every free mass gives into a field where it is, `rate` a second; below 0 it takes.

    It goes to the cells around by their weights in the linear interpolant (of cells inside the domain alone), so that
    all of it comes in, and is counted in the field's inflow; from outside the domain nothing does. It moves no mass.
    The model and the field are solved together, by an explicit method unless the island is small. Source: Hockney &
    Eastwood, Computer Simulation Using Particles (1988), 5-3 (cloud in cell).
    """

    into: Annotated[Value, Quantity(None, (None,))] = field("The field: `lake.concentration`.")
    rate: Annotated[Value, Quantity(None)] = field("What each mass gives a second: `1 g/s`; it may vary in time.")

    def problems(self) -> Iterator[Problem]:
        """A value that is no field, a rate of another dimension."""
        yield from unfit(self.into, "into")
        own, given = dimension(self.into), self.rate.expr.type.dimension
        if own is not None and not dim.suits(given, own * dim.VOLUME / dim.TIME):
            wanted = describe(own * dim.VOLUME / dim.TIME)
            yield Problem(f"the rate is {wanted}, and this is {in_words(given)}", ("rate",), code="dimension-mismatch")

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add what its masses give. Raises ScriptError where it is into no field."""
        own = (bodies.position_at, bodies.count, bodies.inverse_at, assembly.value(self.rate))
        kernel = "sceneql.words.forces.emission_kernels:emission"
        assembly.term("force", kernel, (*own, *numbers(self.into, assembly)))
