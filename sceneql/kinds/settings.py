"""The top-level keys of a script that are not parts."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from sceneql.kinds.types import Color, Expected, FixedScalar, FixedTime
from sceneql.kinds.values import Quantity, Value
from sceneql.kinds.word import Problem, Record, field
from sceneql.quantities.dimension import comparable
from sceneql.quantities.units import describe, format_quantity, in_words

MOST_MOMENTS = 1_000_000
_NUMBER = re.compile(r"[-+]?\d[\d.]*(?:[eE][-+]?\d+)?")
_UNIT = re.compile(r"[\d.]\s*([^\W\d_][^\s:.()]*)\s*$")


class Exceeds(ValueError):
    """A size beyond what is allowed: refused with the code `limit-refused` where the script says it."""


class TooCoarse(ValueError):
    """A spacing at which an object cannot be filled: refused with the code `not-filled`."""


def bounded_moments(count: float) -> float:
    """Returns ``count``. Raises Exceeds where it is more than MOST_MOMENTS instants."""
    if not count <= MOST_MOMENTS:
        raise Exceeds(f"{count:.3g} instants are more than the {MOST_MOMENTS:,} that an output may take")
    return count


class Clock(Record):
    """Film time and simulation time."""

    end: FixedTime = field("Length of the simulation.", "4 s", above=0)
    fps: FixedScalar = field("Film frames a second.", "30", at_least=0.001, at_most=1000)
    speed: FixedScalar = field("Seconds of simulation in a second of film.", "1", above=0)
    seed: int = field("Seed of all chance.", 0, at_least=0)

    def frames(self, fps: float) -> list[float]:
        """Instants [s] of the film's frames: frame i stands at film time i/fps, before the end. Raises Exceeds."""
        count = max(1, math.ceil(round(bounded_moments(self.end / self.speed * fps), 9)))
        return [k / fps * self.speed for k in range(count)]


class Gallery(Record):
    """The small and short version of a scene that the gallery keeps."""

    size: tuple[int, int] = field("Width and height of the poster [pixels].", (320, 180), above=0)
    time: FixedTime = field("The instant of the poster.", "1 s", at_least=0)


_LAST = re.compile(r"([^\W\d][\w.]*)\[-1\]")
"""The last of a series, as in NumPy."""
_COMPARED = re.compile(r"([^<>=!]+)(<=?|>=?|={1,2}|≈|~=)([^<>=]+)")


class Expect(Record):
    """A number that the scene must give, and the source of that number."""

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("at", "time", "when"), "the instant stands in what is measured: `of: at(ball.position.y, 1 s)`"
    )

    of: Expected = field("What is measured: an expression of outputs, with final(), max(), at(x, 2 s), ...")
    value: Expected | None = field("What it must be.", None)
    tolerance: Annotated[Value, Quantity(None)] = field(
        "How far it may be off, as a number in SI or with a unit.", "1e-6", at_least=0
    )
    below: Expected | None = field("In place of a value: what it must stay below.", None)
    because: str = field("Why: exact, independent source, conservation, ...")
    variant: str | None = field("The variant that it holds for; by default the script as it stands.", None)

    @classmethod
    def meant_by(cls, text: str) -> str | None:
        """The fields of a comparison: ``a < b``, ``a == b``."""
        found = _COMPARED.fullmatch(text.strip())
        if found is None:
            return None
        of, sign, value = (found[k].strip() for k in (1, 2, 3))
        of, value = (value, of) if ">" in sign else (of, value)
        of = _LAST.sub(r"final(\1)", of)
        field = "value" if "=" in sign and sign[0] not in "<>" else "below"
        return f"write `{{of: {of}, {field}: {value}, because: WHY}}`"

    def problems(self) -> Iterator[Problem]:
        """An expectation that is compared with nothing, or with two things."""
        if (self.value is None) == (self.below is None):
            help = "write what it must be, `value: 2 m`, or what it stays below, `below: 3 m`"
            yield Problem("an expectation has either 'value' or 'below'", help=help)
        if not self.tolerance.constant:
            yield Problem("tolerance must be constant", ("tolerance",), code="not-constant")
        yield from _unlike(self.of, {"value": self.value, "tolerance": self.tolerance, "below": self.below})


def _unlike(of: Value, others: dict[str, Value | None]) -> Iterator[Problem]:
    """Problems of values whose dimension differs from that of the measured value that they are compared with."""
    measured = of.expr.type.dimension
    for name, value in others.items():
        given = None if value is None else value.expr.type.dimension
        if not comparable(given, measured):
            text = f"{name} is {describe(measured)} as what is measured, but this is {in_words(given)}"
            part = f"a tolerance is no part of the value, but in its unit: `{format_quantity(0.01, measured)}`"
            share = part if name == "tolerance" else None
            unlike = None if measured is None else f"write such a one, `{name}: {format_quantity(1.0, measured)}`"
            yield Problem(text, (name,), code="dimension-mismatch", help=share or unlike)


def _first(tried: Any) -> str:
    """The text of the first of the values that a sweep tries: of a list, or of a range with its unit."""
    text = tried.items[0].span.text if getattr(tried, "items", None) else getattr(tried, "text", "...")
    number, unit = _NUMBER.search(text), _UNIT.search(text.partition(",")[0])
    return text if number is None else f"{number[0]} {unit[1] if unit else ''}".strip()


class Study(Record):
    """Runs of the script with values in place of its own, compared with what they should give: `sceneql study`.

    A range is `1e0 .. 1e12 N/m, 13 points`, evenly spaced in the logarithm where both ends have one sign, or with
    `, linear`; other values are a list. Every value of one path is combined with every one of the others.
    """

    sweep: dict[str, Any] = field(
        "By dotted path, as in variants, the values that are tried: `{define.k: [1 N/m, 2 N/m]}`, or a range."
    )
    of: Expected = field("What is compared, such as `final(swing.bob.position)`.")
    exact: Expected | None = field("What it should be, where that is known.", None)
    reference: dict[str, Any] | None = field(
        "Else values by path for a run to compare with, such as `{solvers.main: {radau: {tolerance: 1e-12}}}`.", None
    )
    accuracy: FixedScalar = field("The largest relative error that counts as accurate.", "0.1", above=0)
    measure: dict[str, Expected] = field("What else stands in the table, by name.", {})
    longest: FixedTime = field("Run time after which a run is given up.", "5 s", above=0)

    def problems(self) -> Iterator[Problem]:
        """Nothing to try, or nothing to compare with."""
        if not self.sweep:
            yield Problem("a study tries values by path, `{define.k: 1 .. 1e6 N/m}`", ("sweep",))
        if (self.exact is None) == (self.reference is None):
            path, tried = next(iter(self.sweep.items()), ("define.k", None))
            known = f"exact: {format_quantity(1.0, self.of.expr.type.dimension)}"
            help = f"write what is known, `{known}`, or what to compare with, `reference: {{{path}: {_first(tried)}}}`"
            yield Problem("a study compares with either `exact` or a `reference`", help=help)
        yield from _unlike(self.of, {"exact": self.exact})


class Settings(Record):
    """The top-level keys of a script that are not parts."""

    about: str = field("One sentence on the scene.", "")
    clock: Clock = field("Film time and simulation time.", Clock())
    gallery: Gallery = field("The gallery's version of the scene.", Gallery())
    expect: dict[str, Expect] = field("Numbers that the scene must give.", {})
    studies: dict[str, Study] = field("Runs over ranges of values, for `sceneql study`.", {})
    background: Color | None = field("What the camera sees where nothing is; by default the sky.", None)
