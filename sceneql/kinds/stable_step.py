"""The largest stable step of a method on one mode, in plain Python, for `check` before the run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from sceneql.kinds.eigenvalues import Rows, eigenvalues

LEAST, MOST = 1e-8, 1e3
"""Range of (step times frequency) that is searched."""
RATIO = 1.3
"""Ratio of successive steps that are tried; a narrower gap in the range of stable steps is missed."""
NEUTRAL = 1e-8
"""Growth per unit of (step times frequency) that counts as rounding."""


@dataclass(frozen=True, slots=True)
class Oscillation:
    """A bound on the fastest x'' = -frequency^2 x - (decay - i turn) x' of a model or a force.

    With frequency 0 it is of first order, in a velocity or another state: v' = -(decay - i turn) v.
    """

    frequency: float
    """Angular, undamped [1/s]."""
    decay: float
    """[1/s]; 0 where nothing damps it."""
    what: str
    """The cause, as ``spring 'tether'``."""
    at: tuple[str | int, ...] = ()
    """Path to the field that sets it: ``("springs", 2)``."""
    turn: float = 0.0
    """Angular velocity [1/s] at which velocities rotate in a magnetic field, or coupled states among each other."""
    later: bool = False
    """Whether it may appear only after the start, so that the spectrum at the start does not show it."""

    tension: bool = False
    """Whether it is that of a flat skin, which a solver may march implicitly (Solver.solves_tensions)."""

    @property
    def size(self) -> float:
        """Largest of its rates [1/s]."""
        return max(self.frequency, self.decay, abs(self.turn))


class StaticScene(NamedTuple):
    """The facts of a script that are known before the run, for bounds on steps."""

    objects: Mapping[str, Any]
    """Its objects, by name."""
    end: float
    """End of the run [s]."""
    box: Callable[[Any], tuple[Any, Any] | None] = lambda _: None
    """The low and high corners (3,) [m] of the box of an object (Ref) at the start; None where only a run knows it."""


class StaticMass(NamedTuple):
    """A mass at the start, as far as its model's fields alone determine it."""

    mass: float
    """[kg]"""
    position: tuple[float, ...] | None = None
    """[m]; None: not known."""
    velocity: tuple[float, ...] | None = None
    """[m/s]"""
    fixed: bool = False
    """Whether it never moves."""

    @property
    def inverse(self) -> float:
        """1/mass [1/kg]; 0 for a mass that never moves."""
        return 0.0 if self.fixed else 1.0 / self.mass


def oscillations(
    matrix: Rows, what: str, at: tuple[str | int, ...] = (), *, paired: bool = False
) -> Iterator[Oscillation]:
    """The modes of y' = matrix y, or of x'' = matrix x if ``paired``, fastest first; exponential growth is left out."""
    for value in sorted(eigenvalues(matrix), key=abs, reverse=True):
        if paired:
            mode = (-value) ** 0.5
            yield Oscillation(abs(mode.real), 0.0, what, at)
        elif abs(value.real) + abs(value.imag) > 0.0:
            yield Oscillation(0.0, max(0.0, -value.real), what, at, turn=value.imag)


def first_unstable(stable: Callable[[float], bool]) -> float:
    """Upper end of the interval of stable steps from LEAST on, to a relative 1e-6.

    0 where it is empty, inf beyond MOST.
    """
    low = high = LEAST
    if not stable(low):
        return 0.0
    while stable(high):
        low, high = high, high * RATIO
        if low > MOST:
            return math.inf
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def stable_step(growth: Callable[[float], float]) -> float:
    """Largest stable step; ``growth(step)``: growth factor. 0 where only rounding makes a step look stable."""

    def bound(neutral: float) -> float:
        return first_unstable(lambda step: growth(step) <= 1.0 + 1e-14 + neutral * step)

    sharp, sharper = bound(NEUTRAL), bound(NEUTRAL / 100)
    return 0.0 if sharp < 100 * LEAST or sharper < 0.8 * sharp else sharp
