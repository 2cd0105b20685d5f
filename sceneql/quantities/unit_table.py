"""The units that a script may write: name, exact ratio to SI, dimension, and the SI prefixes it takes.

Values: BIPM, The International System of Units, 9th ed. (2019); the inch and the pound by the 1959 agreement; the
astronomical unit by IAU 2012 B2; the parsec is 648000/pi astronomical units.
"""

from __future__ import annotations

import math
from fractions import Fraction

from sceneql.quantities import dimension as dim
from sceneql.quantities.dimension import Dimension

CHARGE = dim.CURRENT * dim.TIME
VOLTAGE = dim.POWER / dim.CURRENT

PREFIXES = {
    "f": -15, "p": -12, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "c": -2, "d": -1,
    "h": 2, "k": 3, "M": 6, "G": 9, "T": 12, "P": 15,
}  # fmt: skip
"""Powers of ten. Both signs for micro (U+00B5, U+03BC) are read, and ``u``."""

_SMALL, _LARGE = "fpnuµμm", "kMGTP"
_ALL = _SMALL + _LARGE
_PI = Fraction(math.pi)

# Prefixes are listed so that no likely name of a script is a unit: `dt` is a time step, never a decitonne.
SINGLE: tuple[tuple[str, Fraction | int | str, Dimension, str], ...] = (
    ("m", 1, dim.LENGTH, _ALL + "cd"),
    ("g", "1/1000", dim.MASS, _SMALL + "k"),
    ("t", 1000, dim.MASS, ""),
    ("s", 1, dim.TIME, _SMALL),
    ("min", 60, dim.TIME, ""),
    ("h", 3600, dim.TIME, ""),
    ("day", 86400, dim.TIME, ""),
    ("week", 604800, dim.TIME, ""),
    ("year", 31557600, dim.TIME, ""),
    ("A", 1, dim.CURRENT, _ALL),
    ("K", 1, dim.TEMPERATURE, _SMALL + "kM"),
    ("mol", 1, dim.AMOUNT, _SMALL + "k"),
    ("cd", 1, dim.LUMINOUS_INTENSITY, _SMALL + "k"),
    ("rad", 1, dim.ANGLE, "num"),
    ("deg", _PI / 180, dim.ANGLE, ""),
    ("arcmin", _PI / 10800, dim.ANGLE, ""),
    ("arcsec", _PI / 648000, dim.ANGLE, "m"),
    ("turn", 2 * _PI, dim.ANGLE, ""),
    ("%", "1/100", dim.PERCENTAGE, ""),
    ("Hz", 1, dim.FREQUENCY, _ALL),
    ("rpm", 2 * _PI / 60, dim.FREQUENCY, ""),
    ("N", 1, dim.FORCE, _ALL),
    ("Pa", 1, dim.PRESSURE, _ALL + "h"),
    ("bar", 100000, dim.PRESSURE, "m"),
    ("atm", 101325, dim.PRESSURE, ""),
    ("J", 1, dim.ENERGY, _ALL),
    ("W", 1, dim.POWER, _ALL),
    ("Wh", 3600, dim.ENERGY, "mkMGT"),
    ("cal", "4.184", dim.ENERGY, "k"),
    ("eV", "1.602176634e-19", dim.ENERGY, _ALL),
    ("L", "1/1000", dim.VOLUME, "umcdh"),
    ("C", 1, CHARGE, _ALL),
    ("V", 1, VOLTAGE, _ALL),
    ("ohm", 1, VOLTAGE / dim.CURRENT, _ALL),
    ("Ω", 1, VOLTAGE / dim.CURRENT, _ALL),
    ("S", 1, dim.CURRENT / VOLTAGE, _SMALL),
    ("F", 1, CHARGE / VOLTAGE, _SMALL),
    ("H", 1, VOLTAGE * dim.TIME / dim.CURRENT, _SMALL),
    ("Wb", 1, VOLTAGE * dim.TIME, _SMALL),
    ("T", 1, VOLTAGE * dim.TIME / dim.AREA, _SMALL),
    ("lm", 1, dim.LUMINOUS_INTENSITY, "mk"),
    ("lx", 1, dim.LUMINOUS_INTENSITY / dim.AREA, "mk"),
    ("inch", "0.0254", dim.LENGTH, ""),
    ("ft", "0.3048", dim.LENGTH, ""),
    ("yd", "0.9144", dim.LENGTH, ""),
    ("mile", "1609.344", dim.LENGTH, ""),
    ("au", 149597870700, dim.LENGTH, ""),
    ("ly", 9460730472580800, dim.LENGTH, ""),
    ("pc", 149597870700 * 648000 / _PI, dim.LENGTH, "kMG"),
    ("mph", "0.44704", dim.VELOCITY, ""),
    ("oz", "0.028349523125", dim.MASS, ""),
    ("lb", "0.45359237", dim.MASS, ""),
    ("lbf", "4.4482216152605", dim.FORCE, ""),
    ("psi", Fraction("4.4482216152605") / Fraction("0.0254") ** 2, dim.PRESSURE, ""),
)
"""Name, ratio to SI, dimension, prefixes."""


def _with_prefixes() -> dict[str, tuple[Fraction, Dimension]]:
    table = {name: (Fraction(ratio), dimension) for name, ratio, dimension, _ in SINGLE}
    for name, ratio, dimension, prefixes in SINGLE:
        for prefix in prefixes:
            # A unit's own name goes before a prefixed one: `min` is a minute, `cd` a candela.
            table.setdefault(prefix + name, (Fraction(ratio) * Fraction(10) ** PREFIXES[prefix], dimension))
    return table


UNITS = _with_prefixes()
"""Every name, prefixes included, with its ratio to SI and its dimension."""

_CELSIUS, _FAHRENHEIT = (Fraction(1), Fraction("273.15")), (Fraction(5, 9), Fraction("459.67") * Fraction(5, 9))
OFFSET_UNITS = {"degC": _CELSIUS, "°C": _CELSIUS, "degF": _FAHRENHEIT, "°F": _FAHRENHEIT}
"""Temperature scales that do not start at absolute zero: (ratio to the kelvin, their zero [K])."""

KNOWN_UNITS = (*UNITS, *OFFSET_UNITS)
"""All names, for suggestions."""

QUANTITIES = (
    ("m", "a length"), ("kg", "a mass"), ("s", "a time"), ("A", "an electric current"), ("K", "a temperature"),
    ("mol", "an amount of substance"), ("cd", "a luminous intensity"), ("m^2", "an area"), ("m^3", "a volume"),
    ("m/s", "a velocity"), ("m/s^2", "an acceleration"), ("1/s", "a frequency"), ("1/s^2", "an angular acceleration"),
    ("N", "a force"), ("N/m", "a stiffness"), ("N*s/m", "a damping"), ("J", "an energy"), ("W", "a power"),
    ("Pa", "a pressure"), ("Pa*s", "a viscosity"), ("kg/m^3", "a density"), ("kg/m^2", "an areal density"),
    ("kg/m", "a linear density"), ("kg*m/s", "a momentum"), ("kg*m^2", "a moment of inertia"),
    ("J*s", "an angular momentum"), ("m^2/s", "a diffusivity"), ("C", "a charge"), ("V", "a voltage"),
    ("ohm", "a resistance"), ("S", "a conductance"), ("F", "a capacitance"), ("H", "an inductance"),
    ("Wb", "a magnetic flux"), ("T", "a magnetic flux density"), ("lx", "an illuminance"),
)  # fmt: skip
"""Coherent SI units (ratio 1) in which messages show a quantity of their dimension, and the quantity's name."""
