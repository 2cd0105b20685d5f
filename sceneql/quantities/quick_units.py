"""Units: our own table (SI Brochure 2019; exact conversions of the international yard and pound), and its grammar."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from sceneql.quantities import dimension as dim
from sceneql.quantities.dimension import PLAIN, Dimension


class UnknownUnit(Exception):
    """``name``, at these characters of the text, is no unit."""

    def __init__(self, name: str, start: int, end: int) -> None:
        super().__init__(f"'{name}' is no unit")
        self.name, self.start, self.end = name, start, end


@dataclass(frozen=True, slots=True)
class Unit:
    """A value v in this unit is v*scale + offset in SI."""

    scale: float
    dimension: Dimension
    offset: float = 0.0


PREFIXES: Mapping[str, float] = {
    "Q": 1e30, "R": 1e27, "Y": 1e24, "Z": 1e21, "E": 1e18, "P": 1e15, "T": 1e12, "G": 1e9, "M": 1e6, "k": 1e3,
    "h": 1e2, "da": 1e1, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "n": 1e-9, "p": 1e-12,
    "f": 1e-15, "a": 1e-18, "z": 1e-21, "y": 1e-24, "r": 1e-27, "q": 1e-30,
}  # fmt: skip

CHARGE = dim.CURRENT * dim.TIME
VOLTAGE = dim.POWER / dim.CURRENT

_WITH_PREFIX: Mapping[str, Unit] = {
    "m": Unit(1, dim.LENGTH),
    "g": Unit(1e-3, dim.MASS),
    "s": Unit(1, dim.TIME),
    "A": Unit(1, dim.CURRENT),
    "K": Unit(1, dim.TEMPERATURE),
    "mol": Unit(1, dim.AMOUNT),
    "cd": Unit(1, dim.LUMINOUS_INTENSITY),
    "N": Unit(1, dim.FORCE),
    "Pa": Unit(1, dim.PRESSURE),
    "J": Unit(1, dim.ENERGY),
    "W": Unit(1, dim.POWER),
    "Wh": Unit(3600, dim.ENERGY),
    "eV": Unit(1.602176634e-19, dim.ENERGY),
    "Hz": Unit(1, dim.FREQUENCY),
    "C": Unit(1, CHARGE),
    "V": Unit(1, VOLTAGE),
    "ohm": Unit(1, VOLTAGE / dim.CURRENT),
    "F": Unit(1, CHARGE / VOLTAGE),
    "T": Unit(1, VOLTAGE * dim.TIME / dim.AREA),
    "L": Unit(1e-3, dim.VOLUME),
    "l": Unit(1e-3, dim.VOLUME),
    "bar": Unit(1e5, dim.PRESSURE),
    "lm": Unit(1, dim.LUMINOUS_INTENSITY),
    "lx": Unit(1, dim.LUMINOUS_INTENSITY / dim.AREA),
    "rad": Unit(1, PLAIN),
    "t": Unit(1e3, dim.MASS),
}

_ALONE: Mapping[str, Unit] = {
    "min": Unit(60, dim.TIME),
    "h": Unit(3600, dim.TIME),
    "day": Unit(86400, dim.TIME),
    "week": Unit(7 * 86400, dim.TIME),
    "year": Unit(365.25 * 86400, dim.TIME),
    "deg": Unit(math.pi / 180, PLAIN),
    "turn": Unit(math.tau, PLAIN),
    "rpm": Unit(math.tau / 60, dim.FREQUENCY),
    "%": Unit(0.01, PLAIN),
    "atm": Unit(101325, dim.PRESSURE),
    "degC": Unit(1, dim.TEMPERATURE, 273.15),
    "degF": Unit(5 / 9, dim.TEMPERATURE, 273.15 - 32 * 5 / 9),
    "inch": Unit(0.0254, dim.LENGTH),
    "ft": Unit(0.3048, dim.LENGTH),
    "yd": Unit(0.9144, dim.LENGTH),
    "mile": Unit(1609.344, dim.LENGTH),
    "au": Unit(149597870700, dim.LENGTH),
    "lb": Unit(0.45359237, dim.MASS),
    "kph": Unit(1 / 3.6, dim.VELOCITY),
    "mph": Unit(0.44704, dim.VELOCITY),
    "ha": Unit(1e4, dim.AREA),
}

NAMES: tuple[str, ...] = (*_WITH_PREFIX, *_ALONE, "kg", "mm", "cm", "km", "ms", "us", "kN", "MPa", "GPa", "kJ", "mg")
"""Names to suggest: every unit, and the usual prefixed ones."""

FACTOR = re.compile(r"(%|[^\W\d_]+)(?:\^(-?\d+))?")
OPERATOR = re.compile(r"[*/·]")


def unit_of(name: str) -> Unit | None:
    """The unit of a name, with or without an SI prefix; None if there is none."""
    unit = _ALONE.get(name) or _WITH_PREFIX.get(name)
    if unit is not None:
        return unit
    for size in (2, 1):
        scale, rest = PREFIXES.get(name[:size]), _WITH_PREFIX.get(name[size:])
        if scale is not None and rest is not None:
            return Unit(scale * rest.scale, rest.dimension)
    return None


def read_unit(text: str, start: int = 0) -> tuple[Unit, int] | None:
    """The longest unit that begins at ``start`` (as ``N*s/m``), and where it ends; None where none begins.

    After ``*`` or ``/`` the next name belongs to the unit only if it is one: ``1 m/dt`` divides by the name dt.
    """
    found = FACTOR.match(text, start)
    if found is None:
        return None
    unit = unit_of(found[1])
    if unit is None:
        return None
    end = found.end()
    first = _raised(unit, found[2])
    scale, dimension, offset, many = first.scale, first.dimension, unit.offset if found[2] is None else 0.0, False
    while (operator := OPERATOR.match(text, end)) is not None:
        found = FACTOR.match(text, operator.end())
        factor = None if found is None else unit_of(found[1])
        if found is None or factor is None or text[found.end() : found.end() + 1] in ("(", ".", "_"):
            break
        factor = _raised(factor, found[2])
        many, end = True, found.end()
        if operator[0] == "/":
            scale, dimension = scale / factor.scale, dimension / factor.dimension
        else:
            scale, dimension = scale * factor.scale, dimension * factor.dimension
    return Unit(scale, dimension, 0.0 if many else offset), end


def parse_unit(text: str) -> Unit:
    """The unit of a whole text such as ``kg*m/s^2`` or ``1/s``. Raises UnknownUnit."""
    if text.startswith("1/"):
        unit = parse_unit(text[2:].replace("/", "*"))
        return Unit(1 / unit.scale, PLAIN / unit.dimension)
    read = read_unit(text)
    if read is None or read[1] != len(text):
        start = 0 if read is None else read[1] + 1
        word = FACTOR.match(text, start)
        end = word.end() if word else len(text)
        raise UnknownUnit(text[start:end], start, end)
    return read[0]


def _raised(unit: Unit, exponent: str | None) -> Unit:
    if exponent is None:
        return unit
    power = int(exponent)
    if abs(power) > 12:
        return Unit(math.nan, unit.dimension)
    return Unit(unit.scale**power, unit.dimension**power)
