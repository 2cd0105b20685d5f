"""A plane that cuts something open."""

from __future__ import annotations

from sceneql.kinds import FixedPosition, Record, field
from sceneql.kinds.types import Axis


class Section(Record):
    """A plane."""

    through: FixedPosition = field("A point of the plane.", "0 0 0 m")
    normal: Axis = field("The direction that it faces, of any length.", "0 0 1")
