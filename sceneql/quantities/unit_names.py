"""Units written out in words (`meters`), for suggestions alone: scripts write the unit's sign."""

from __future__ import annotations

SIGNS = {
    "meter": "m", "metre": "m", "gram": "g", "gramme": "g", "kilo": "kg", "tonne": "t", "ton": "t",
    "second": "s", "sec": "s", "minute": "min", "hour": "h", "hr": "h",
    "degree": "deg", "radian": "rad", "percent": "%", "revolution": "turn",
    "newton": "N", "joule": "J", "watt": "W", "pascal": "Pa", "hertz": "Hz", "kelvin": "K", "celsius": "degC",
    "fahrenheit": "degF", "ampere": "A", "amp": "A", "volt": "V", "coulomb": "C", "liter": "L", "litre": "L",
    "kmh": "km/h", "kph": "km/h", "kmph": "km/h", "mps": "m/s", "revs": "turn", "rev": "turn",
    "foot": "ft", "feet": "ft", "inche": "inch", "yard": "yd", "pound": "lb", "ounce": "oz",
}  # fmt: skip
"""Names in the singular."""

PREFIXES = {
    "femto": "f", "pico": "p", "nano": "n", "micro": "u", "milli": "m", "centi": "c", "deci": "d",
    "hecto": "h", "kilo": "k", "mega": "M", "giga": "G", "tera": "T",
}  # fmt: skip


def sign_of(name: str) -> str | None:
    """The sign of a unit written out, singular or plural and with any prefix: ``cm`` for ``centimeters``."""
    plain = name.lower()
    singular = plain if plain in SIGNS else plain.removesuffix("s")
    if singular in SIGNS:
        return SIGNS[singular]
    for prefix, letter in PREFIXES.items():
        if (rest := singular.removeprefix(prefix)) != singular and rest in SIGNS:
            return letter + SIGNS[rest]
    return None
