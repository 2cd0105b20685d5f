"""mist: a deep field that absorbs light."""

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
    """A field that fills a space as mist or smoke: light that passes is absorbed (Beer 1852; Lambert 1760).

    Of light the part exp(-integral of absorption times field) is left, on its way to the camera, also by mirrors and
    glass, and on that from a lamp or the sky: mist throws shadows on itself and on objects. Of the rest its color's
    share is scattered in all directions alike (Chandrasekhar 1950): white loses no light, black throws shadows alone.
    That of lamps is found at each center of a cell, what solids and mist leave of it; that of the sky, of surfaces and
    of the mist itself at a few places in 24 directions, six times over. The integral is exact for the field between
    the centers of cells. Of mists in one another one covers the other, and sprites do not stand in them.
    """

    of: Field = field("The field: `room.concentration`.")
    absorption: Annotated[Value, Quantity(None)] = field(
        "How much a meter of a unit of the field takes away: `30 m^2/kg` of a concentration.", at_least=0
    )
    color: Color = field("The share of the light taken away that goes on in other directions.", "0.9 0.9 0.92")
    lit: bool = field(
        "Without it, it throws no shadow, and its color is what it looks like where it is thick, whatever the light: "
        "as a picture of data.",
        True,
    )

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
        if level_of(whole, moment) is not None:  # no mist outside the domain; the walls of a box cut it off sharply
            cells = np.where(whole.interpolation.known, cells, 0.0)
        strength = float(moment.at(self.absorption)) / uniform_scale(place)
        look = frame.Surface(color=linear(moment.at(self.color)))
        absorption = strength * np.maximum(cells, 0.0)
        to_cells, low, high = whole.nodes(place)
        yield frame.Mist(name, look, to_cells, absorption, low, high, self.lit)
