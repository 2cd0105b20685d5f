"""mist: a deep field as what absorbs light."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.grids.maps.seen import Field, level_of, seen, unfit
from sceneql.kinds import Color, Moment, Object, Problem, Quantity, Value, field
from sceneql.quantities.dimension import LENGTH, PLAIN, suits
from sceneql.shapes.color import linear
from sceneql.shapes.placement import uniform_scale

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Mist(Object):
    """A field that fills a space as mist: light on the way to the camera is absorbed (Beer 1852; Lambert 1760).

    Of what is behind, the part exp(-integral of absorption times field) is left; the mist's own color stands for the
    rest: black absorbs alone. The integral is exact for the field between the centers of cells. It throws no shadow, is
    not seen in mirrors, and sprites do not stand in it.
    """

    of: Field = field("The field: `room.concentration`.")
    absorption: Annotated[Value, Quantity(None)] = field(
        "How much a meter of a unit of the field absorbs: `30 m^2/kg` of a concentration.", at_least=0
    )
    color: Color = field("What it looks like where it is thick.", "0.9 0.9 0.92")

    def problems(self) -> Iterator[Problem]:
        """Fields of no part or of several; an absorption that is of something else."""
        yield from unfit(self.of, {})
        own, has = self.of.expr.type.dimension, self.absorption.expr.type.dimension
        if own is not None and not suits(has, PLAIN / own / LENGTH):
            yield Problem("absorption is told for a meter of a unit of the field: `30 m^2/kg`", ("absorption",))

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A volume in the cells' own coordinates. Raises ValueError for a flat field."""
        import numpy as np

        from sceneql import frame

        whole = seen(self.of, moment)
        if whole.layout.shape[2] == 1:
            raise ValueError("a flat field is no mist: a `field_map` draws it")
        cells = whole.filled
        if level_of(whole, moment) is not None:  # nothing outside the domain; the walls of a box cut it sharply
            cells = np.where(whole.interpolation.known, cells, 0.0)
        strength = float(moment.at(self.absorption)) / uniform_scale(place)
        look = frame.Surface(color=linear(moment.at(self.color)))
        absorption = strength * np.maximum(cells, 0.0)
        to_cells, low, high = whole.nodes(place)
        yield frame.Mist(name, look, to_cells, absorption, low, high)
