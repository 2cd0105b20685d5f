"""streamlines: lines along the velocity of a flow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.grids.maps.seen import unfit
from sceneql.kinds import FixedLength, Moment, Object, Problem, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.shapes.placement import apply, uniform_scale

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Streamlines(Object):
    """Lines along the velocity of a flow at an instant, each a chain of capsules.

    They begin on an even lattice, and end at the box, where the fluid is at rest, or where one comes nearer to another
    than half of `apart` (Jobard & Lefer 1997, Visualization in Scientific Computing '97, 43-55).
    """

    decorates: ClassVar[bool] = True

    of: Annotated[Value, Quantity(dim.VELOCITY, (None, 3))] = field("The velocity: `air.velocity`.")
    apart: FixedLength | None = field(
        "How far from one another they begin; by default a 24th of the box's longest side.", None, above=0
    )
    radius: FixedLength | None = field("Their radius; by default a 20th of `apart`.", None, above=0)
    length: FixedLength | None = field("Longest way either side of where one begins; by default any.", None, above=0)

    def problems(self) -> Iterator[Problem]:
        """Velocities of no part or of several."""
        yield from unfit(self.of, {})

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """The lines as segments. Raises ValueError where the value is no flow's."""
        import numpy as np

        from sceneql.flows.drawn_lines import lines
        from sceneql.frame import Segments
        from sceneql.kinds import Ref

        task = self.of.links[0].task
        model: Any = moment.object(Ref(task, self.of.span))
        if not getattr(model, "flows", False):
            raise ValueError(f"'{task}' is no flow")
        layout = model.layout(moment.state(task), "velocity")
        longest = max(n * side for n, side in zip(layout.shape[:2], layout.spacing[:2], strict=True))
        apart = self.apart or longest / 24
        ends = lines(np.asarray(moment.at(self.of), dtype=float), layout, apart, self.length or np.inf)
        if len(ends):
            radii = np.full(len(ends), (self.radius or apart / 20) * uniform_scale(place))
            yield Segments(name, moment.surface(name, self.material, self.color), apply(place, ends), radii)
