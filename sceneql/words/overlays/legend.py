"""legend: a bar with the color map of a field."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from sceneql.kinds import FixedScalar, Moment, Overlay, Problem, Ref, Refers, field
from sceneql.kinds.texts import overlong
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.units import describe, parse_unit, unit_of

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View
    from sceneql.grids.maps.key import ColorKey
    from sceneql.pictures.anchors import Box
    from sceneql.pictures.lettering import Letterer

LONG = 0.62
"""Length of the bar, relative to the picture's height."""
WIDEST = 0.2
"""Width of a default title, relative to the picture's, above which it is left out."""
SIDES = ("right", "left")


class Legend(Overlay):
    """A bar of the colors of a field with numbers beside it, in the unit that is wanted, and its contours as lines."""

    of: Annotated[Ref, Refers("objects", showing="field_map")] = field("What shows the field in colors: a `field_map`.")
    unit: str | None = field("The unit of the numbers: `mg/L`; by default that of SI.", None)
    title: str | None = field(
        "What is said above the bar, by default the field's name where there is room; the unit follows.", None
    )
    place: Literal["left", "right"] | None = field(
        "The side of the picture where it stands; by default right, or where what is shown leaves more room.", None
    )
    numbers: int = field("About how many numbers there are.", 5, at_least=2, at_most=20)
    text: FixedScalar = field("Height of its letters in parts of the picture's.", "0.034", above=0, at_most=0.2)
    panel: FixedScalar = field("Opacity of the panel that it stands on.", "0.7", at_least=0, at_most=1)

    def problems(self) -> Iterator[Problem]:
        """A unit that there is not; a title that is too long."""
        if said := overlong(self.title):
            yield Problem(said, ("title",), code="limit-refused")
        if self.unit is not None:
            try:
                parse_unit(self.unit)
            except ScriptError as error:
                yield Problem(
                    error.diagnostics[0].message,
                    ("unit",),
                    code=error.diagnostics[0].code,
                    help=error.diagnostics[0].help,
                )

    def places(self) -> tuple[str, ...]:
        """Both sides."""
        return SIDES if self.place is None else (self.place,)

    def box(self, place: str, size: tuple[int, int], moment: Moment, scale: float) -> Box | None:
        """The box of its panel."""
        from sceneql.pictures.layout import page
        from sceneql.pictures.lettering import Letterer

        letters = Letterer(page(size), self.text, scale=scale)
        return self._told(moment, letters).box(place, letters)

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
        scale: float = 1.0,
    ) -> None:
        """Draw the bar. Raises ValueError for what shows no field, and for a unit of another dimension."""
        from sceneql.pictures.lettering import DARK, LIGHT, Letterer

        letters = Letterer(pixels, self.text, DARK if self.dark else LIGHT, scale)
        told = self._told(moment, letters)
        box = told.box(self.place or SIDES[0], letters)
        letters.panel(box, self.panel)
        told.draw(letters, box, develop)
        letters.done()

    def _told(self, moment: Moment, letters: Letterer) -> _Bar:
        """Bar to draw now. Raises ValueError for an object without a color key, and for a unit of another dimension."""
        from sceneql.kinds.texts import shown_unit
        from sceneql.pictures.lettering import marked_numbers

        shows: Any = moment.object(self.of)
        if not hasattr(shows, "color_key"):
            raise ValueError(f"'{self.of.name}' shows no field in colors; a field_map does")
        key: ColorKey = shows.color_key(moment)
        text = unit_of(key.dimension) if self.unit is None else self.unit
        unit = parse_unit(text) if text != "1" else parse_unit("%")
        scale, offset = (1.0, 0.0) if text == "1" else (unit.scale, unit.offset)
        if text != "1" and unit.dimension != key.dimension:
            raise ValueError(f"the field is {describe(key.dimension)}, which {text} is no unit of")
        low, high = (key.low - offset) / scale, (key.high - offset) / scale
        ticks = [(value, (value - low) / (high - low)) for value in marked_numbers(low, high, self.numbers)]
        fits = letters.extent(key.name)[0] <= WIDEST * letters.width
        title = self.title if self.title is not None else key.name if fits else ""
        lines = [line for line in (title, "" if text == "1" else shown_unit(text)) if line]
        marks = [(mark - key.low) / (key.high - key.low) for mark in key.marks]
        return _Bar(key, lines, ticks, [mark for mark in marks if 0 < mark < 1])


@dataclass(frozen=True, slots=True)
class _Bar:
    """Bar with ticks (number, place from 0 to 1) and marks (place from 0 to 1), under lines of text."""

    key: ColorKey
    lines: list[str]
    ticks: list[tuple[float, float]]
    marks: list[float]

    @property
    def words(self) -> list[str]:
        """Texts of the ticks' numbers."""
        return [f"{value:.6g}".replace("-", "\u2212") for value, _ in self.ticks]

    def _head(self, em: int) -> int:
        """Height of the lines of text above the bar [pixels]."""
        return round((1.25 * len(self.lines) + 0.35) * em) if self.lines else 0

    def box(self, place: str, letters: Letterer) -> Box:
        """Left, top, right, bottom [pixels] of the panel at the left or the right of a picture."""
        em = letters.em
        widest = max((letters.extent(word)[0] for word in self.words), default=0)
        width = max(em + round(0.5 * em) + widest, *(letters.extent(line)[0] for line in self.lines), 0)
        height = self._head(em) + round(LONG * letters.height)
        margin, room = round(0.8 * em), round(0.7 * em)
        left = margin if place == "left" else letters.width - margin - width - 2 * room
        top = (letters.height - height) // 2 - room
        return left, top, left + width + 2 * room, top + height + 2 * room

    def draw(self, letters: Letterer, box: Box, develop: Callable[[Any], NDArray[uint8]]) -> None:
        """Draw the bar on its panel."""
        import numpy as np

        em = letters.em
        long, wide, room = round(LONG * letters.height), em, round(0.7 * em)
        left, top = box[0] + room, box[1] + room
        for k, line in enumerate(self.lines):
            letters.text((left, top + (0.5 + 1.25 * k) * em), line)
        top += self._head(em)
        ramp = self.key.ramp((np.arange(long, 0, -1) - 0.5) / long).astype(np.float32)
        letters.paste(develop(np.repeat(ramp[:, None], wide, axis=1)), left, top)
        thick = max(1, em // 14)
        for word, (_, place) in zip(self.words, self.ticks, strict=True):
            y = top + (1 - place) * (long - 1)
            letters.draw.line((left + wide, y, left + wide + 0.25 * em, y), letters.look.ink, thick)
            letters.text((left + wide + 0.5 * em, y), word)
        for mark in self.marks:
            y = top + (1 - mark) * (long - 1)
            letters.draw.line((left, y, left + wide, y), letters.look.ink, thick)
