"""Estimates of the memory of bodies and springs, so that too many are refused before they are made."""

from __future__ import annotations

from sceneql.kinds import Exceeds

LARGEST_MEMORY = 8 * 2**30
"""Largest memory of a model [bytes]."""
BODY, SPRING, PLACE = 900, 350, 100
"""Memory [bytes] of a mass (with its entries of the state, an explicit solver's stages and its picture), of a spring,
and of a candidate position on a grid. Measured as the growth of the peak memory of runs by `rk4` with the count."""
MOST = 1e300
"""Counts are clipped to this: a whole number may be larger than the largest float."""


def bounded(count: float, what: str = "particles", each: int = BODY) -> None:
    """Raise Exceeds where ``count`` items of ``each`` bytes take more than LARGEST_MEMORY."""
    count = min(count, MOST)
    if count * each > LARGEST_MEMORY:
        raise Exceeds(f"{_needs(count, what, count * each)}, {LARGEST_MEMORY / each:.2g} {what}, are allowed")


def bounded_net(masses: float, springs: float) -> None:
    """Raise Exceeds where masses and springs take more than LARGEST_MEMORY."""
    masses, springs = min(masses, MOST), min(springs, MOST)
    memory = masses * BODY + springs * SPRING
    if memory > LARGEST_MEMORY:
        raise Exceeds(f"{_needs(masses, f'masses and {springs:.3g} springs', memory)} are allowed")


def _needs(count: float, what: str, memory: float) -> str:
    return f"{count:.3g} {what} need about {memory / 2**30:.3g} GiB; at most {LARGEST_MEMORY >> 30} GiB"
