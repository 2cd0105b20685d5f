"""All warnings of numbers that are far off, in the order in which they are told."""

from __future__ import annotations

from sceneql.compiler.magnitudes import collapses, creeping, drifting, no_side, on_held, stiff, thousandths
from sceneql.compiler.meaning.facts import Facts
from sceneql.quantities.diagnostic import Diagnostics

ALL = (collapses, creeping, drifting, no_side, on_held, stiff, thousandths)


def warn_of_magnitudes(facts: Facts, found: Diagnostics) -> None:
    """Warn of all numbers that are most likely in another unit than meant."""
    for one in ALL:
        one.warn(facts, found)
