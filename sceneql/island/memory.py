"""How much memory bodies and springs take: what is too much is refused before it is made."""

from __future__ import annotations

from sceneql.kinds import Exceeds

LARGEST_MEMORY = 8 * 2**30
"""[bytes] that a model may take."""
BODY, SPRING, PLACE = 900, 350, 100
"""[bytes] of a mass with its part of the state, of an explicit solver's stages and of the picture; of a spring; of a
place of a grid that is looked at. Measured as the growth of the peak of runs by `rk4` with the count."""


def bounded(count: float, what: str = "particles", each: int = BODY) -> None:
    """Raise Exceeds for more particles, or others of ``each`` bytes, than memory is allowed for."""
    if count * each > LARGEST_MEMORY:
        raise Exceeds(f"{_needs(count, what, count * each)}, {LARGEST_MEMORY / each:.2g} {what}, are allowed")


def bounded_net(masses: float, springs: float) -> None:
    """Raise Exceeds for more masses and springs than memory is allowed for."""
    memory = masses * BODY + springs * SPRING
    if memory > LARGEST_MEMORY:
        raise Exceeds(f"{_needs(masses, f'masses and {springs:.3g} springs', memory)} are allowed")


def _needs(count: float, what: str, memory: float) -> str:
    return f"{count:.3g} {what} need about {memory / 2**30:.3g} GiB; at most {LARGEST_MEMORY >> 30} GiB"
