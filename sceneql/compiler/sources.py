"""Help for a formula that is written as fields: a place, and how much there."""

from __future__ import annotations

from math import pi

from sceneql.compiler.names import Names
from sceneql.compiler.values import read_value
from sceneql.compiler.vector_fields import PLACES
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping, Node
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import LENGTH, VOLUME, Dimension
from sceneql.quantities.units import unit_of

AMOUNTS = ("rate", "strength", "amount", "value", "power", "flux", "intensity", "flow", "amplitude", "height")
"""Names of how much there is."""
SQUARE = 0.01
"""Square of the distance [m^2] at which the formula has fallen to 1/e."""
EXAMPLE = ((0.5, 0.5), 10.0)
"""Place [m] and peak of the formula where nothing is told."""


def around_place(node: Node, wanted: Dimension | None, what: str, names: Names) -> str:
    """The help that writes a bell of the given place and amount as a formula, in SI units.

    ``wanted``: the dimension of the formula. An amount with that times a volume is what the whole bell gives.
    """
    fields = node.entries if isinstance(node, Mapping) else {}
    place = next((value for key, one in fields.items() if key in PLACES and (value := _read(one, LENGTH, names))), None)
    amount = None
    whole = False
    for key, one in fields.items() if wanted is not None else ():
        if key in AMOUNTS and wanted is not None:
            amount = _read(one, wanted, names)
            whole = amount is None
            amount = _read(one, wanted * VOLUME, names) if whole else amount
            break
    at = EXAMPLE[0] if place is None else tuple(place)
    peak = EXAMPLE[1] if amount is None else amount[0] / ((pi * SQUARE) ** (len(at) / 2) if whole else 1.0)
    away = " + ".join(_square(axis, value) for axis, value in zip("xyz", at, strict=False))
    away = away if len(at) == 1 else f"({away})"
    unit = "" if wanted is None or wanted.plain else f", in {unit_of(wanted)}"
    deep = ", for a depth of 1 m" if amount is not None and whole and len(at) == 2 else ""
    return f"write one by place and time{unit}{deep}: `{what}: {peak:.3g}*exp(-{away}/{SQUARE:g})`"


def _square(axis: str, value: float) -> str:
    if value == 0.0:
        return f"{axis}^2"
    return f"({axis} {'-' if value > 0 else '+'} {abs(value):g})^2"


def _read(node: Node, dimension: Dimension, names: Names) -> tuple[float, ...] | None:
    """The numbers of a constant value in SI; None for another, or one of another dimension."""
    value = read_value(node, Quantity(dimension, None), "", names, Diagnostics())
    if not isinstance(value, Value) or not value.constant:
        return None
    number = value.number()
    return tuple(map(float, number)) if isinstance(number, tuple | list) else (float(number),)
