"""Regions of a solid with smaller elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from sceneql import kinds
from sceneql.kinds import Record, field

if TYPE_CHECKING:
    from sceneql.frame import Floats

GROWTH = 0.5
"""Growth of the wanted edge length with the distance from a region [m/m]."""


class Finer(Record):
    """Smaller elements near a place; away from it they grow to those of the rest, by half the distance."""

    near: kinds.FixedPosition = field("A place of the material.")
    within: kinds.FixedLength = field(
        "The distance from there up to which elements have the spacing.", "0 m", at_least=0
    )
    spacing: kinds.FixedLength = field(
        "The longest edge of elements there, before outer ones are bent onto the object.", above=0
    )

    def reaches(self, places: Floats) -> bool:
        """Whether any of the places (n, 3) [m] lies within `within` + `spacing` of `near`."""
        import numpy as np

        away = np.linalg.norm(places - np.asarray(self.near), axis=1)
        return bool(away.min() <= self.within + self.spacing)


def lengths(finer: Mapping[str, Finer]) -> Callable[[Floats], Floats]:
    """The size function: from places (k, 3) [m] to the longest wanted edges (k,) [m]; inf without any region."""
    import numpy as np

    def wanted(places: Floats) -> Floats:
        found = np.full(len(places), np.inf)
        for one in finer.values():
            away = np.linalg.norm(places - np.asarray(one.near), axis=1)
            found = np.minimum(found, one.spacing + GROWTH * np.maximum(away - one.within, 0.0))
        return found

    return wanted
