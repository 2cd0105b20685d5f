"""Volume textures: colors by the place of the material, which it carries along."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.formulas.point_formula import COORDINATES, all_written_out, not_on_tapes
from sceneql.kinds import Color, Formula, Problem, Record, Symbols, field
from sceneql.quantities.dimension import PLAIN
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.frame import Tape
    from sceneql.kinds import Moment

SYMBOLS = (*COORDINATES, "t")
STRAIGHT, LIGHT = 0.04045, 12.92
"""sRGB is a straight line of this slope [1] up to here (IEC 61966-2-1:1999), see shapes/color.py."""


class Texture(Record):
    """Colors by the place x, y, z [m] that the material had before it moved, and by the time t [s].

    So they stick to the material, inside too. Formulas are evaluated at every point that is seen.
    """

    by: Annotated[Formula, Symbols(SYMBOLS, PLAIN)] | None = field(
        "A formula: where it is 0 or less the material has the first of `colors`, where it is 1 or more the last.", None
    )
    colors: tuple[Color, ...] = field("Colors evenly from 0 to 1, mixed in between.", ())
    color: Annotated[Formula, Symbols(SYMBOLS, PLAIN, several=True)] | None = field(
        "In place of these the color itself, as formulas of its red, green and blue from 0 to 1.", None
    )

    def problems(self) -> Iterator[Problem]:
        """Both ways or none, too few colors, and formulas that no point can have."""
        if (self.by is None) == (self.color is None):
            yield Problem("a paint is either `by` a formula and `colors`, or a `color` of three formulas")
        elif self.by is not None and len(self.colors) < 2:
            yield Problem("`by` a formula there are two `colors` or more", ("colors",) if self.colors else ())
        elif self.color is not None and self.colors:
            yield Problem("`colors` are mixed `by` a formula; a `color` is by formulas of its own", ("colors",))
        for name, formula, count in (("by", self.by, 1), ("color", self.color, 3)):
            if formula is not None:
                try:
                    lacks = not_on_tapes(formula.expr, count)
                except ValueError as error:
                    yield Problem(str(error), (name,))
                else:
                    if lacks:
                        yield Problem(f"a paint cannot have '{lacks}' of x, y or z; of t alone it can", (name,))

    def tape(self, moment: Moment) -> Tape:
        """Linear RGB by the place of the material, now."""
        from sceneql.field.tape.builder import TapeBuilder

        build = TapeBuilder()
        at = {"x": build.x, "y": build.y, "z": build.z}
        if self.color is not None:
            parts = [build.expression(one, at) for one in all_written_out(self.color.expr, moment, 3)]
            return build.finish(*(_decoded(build, part) for part in parts))
        assert self.by is not None
        (formula,) = all_written_out(self.by.expr, moment, 1)
        pieces = len(self.colors) - 1
        share = build.op("mul", build.expression(formula, at), build.constant(float(pieces)))
        colors = [linear(moment.at(color)) for color in self.colors]
        found = [build.constant(part) for part in colors[0]]
        for k in range(pieces):  # the part of each piece that lies below the share
            covered = build.op("sub", share, build.constant(float(k)))
            covered = build.op("min", build.op("max", covered, build.constant(0.0)), build.constant(1.0))
            for c in range(3):
                change = build.constant(colors[k + 1][c] - colors[k][c])
                found[c] = build.op("add", found[c], build.op("mul", covered, change))
        return build.finish(*found)


def _decoded(build: TapeBuilder, part: int) -> int:
    """Register of the linear part of a color by its sRGB part (``linear``), both from 0 to 1."""
    part = build.op("min", build.op("max", part, build.constant(0.0)), build.constant(1.0))
    edge = build.constant(STRAIGHT)
    straight = build.op("mul", build.op("min", part, edge), build.constant(1.0 / LIGHT))
    grown = build.op("add", build.op("max", part, edge), build.constant(0.055))
    grown = build.op("mul", grown, build.constant(1.0 / 1.055))
    curved = build.op("pow", grown, build.constant(2.4))
    at_edge = ((STRAIGHT + 0.055) / 1.055) ** 2.4
    return build.op("sub", build.op("add", straight, curved), build.constant(at_edge))
