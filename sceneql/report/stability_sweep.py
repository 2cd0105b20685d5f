"""The sweep of `stability`: a value of the script by its path, or the solvers' own steps or tolerances."""

from __future__ import annotations

import re
from dataclasses import dataclass

from sceneql.compiler.studies import MOST_POINTS, NUMBER, POINTS, spaced
from sceneql.failure import Unsuitable

SHAPE = re.compile(rf"\s*([^=\s]+)\s*=\s*({NUMBER})\s*\.\.\s*({NUMBER})\s*(.*?)\s*")
FEWEST = 30
"""Smallest number of steps in which an instability may show."""
OWN = ("step", "tolerance")
"""Names of the solvers' own settings ([s] and [1]); any other is a path of the script as for ``--set``."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """A path and the values that it takes one after the other."""

    path: str
    values: tuple[float, ...]
    unit: str = ""

    @property
    def own(self) -> bool:
        """Whether the swept value is a setting of the solvers."""
        return self.path in OWN

    @property
    def label(self) -> str:
        """``define.k [N/m]``."""
        return f"{self.path} [{self.unit}]" if self.unit else self.path

    def sets(self, value: float) -> tuple[str, ...]:
        """The patches of the script for one value."""
        return () if self.own else (f"{self.path}={value!r} {self.unit}".rstrip(),)


def parse_sweep(text: str, points: int = POINTS) -> Sweep:
    """A sweep from a text such as ``define.k=1e0..1e12 N/m``.

    The values are evenly spaced in the logarithm, or linearly where 0 lies between. Raises Unsuitable.
    """
    match = SHAPE.fullmatch(text)
    if match is None:
        raise Unsuitable(f"'{text}' is no sweep: write --sweep 'define.k=1e0..1e12 N/m', or 'step=1e-5..1e-1'")
    path, low, high, unit = match[1], float(match[2]), float(match[3]), match[4]
    if path in OWN and unit not in ("", "s" if path == "step" else ""):
        raise Unsuitable(f"a sweep of {path} is told {'in s' if path == 'step' else 'without unit'}, not in '{unit}'")
    if path in OWN and min(low, high) <= 0:
        raise Unsuitable(f"a {path} is above 0")
    if not 2 <= points <= MOST_POINTS:
        raise Unsuitable(f"a sweep has 2 to {MOST_POINTS} points, not {points}")
    return Sweep(path, spaced(low, high, points), "s" if path == "step" else unit)


def around(bound: float, end: float) -> Sweep:
    """Steps over two decades on both sides of a bound [s], such that at least FEWEST fit into the run up to ``end``."""
    values = [float(f"{bound * 10 ** (k / 4):.4g}") for k in range(-8, 9)]
    return Sweep("step", tuple(value for value in values if value * FEWEST <= end) or (end / FEWEST,), "s")
