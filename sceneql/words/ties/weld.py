"""weld: a rigid connection of two bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.bodies.rigid.joint import FORCES, Joint, Side, must_turn, parallel, together
from sceneql.kinds import Gives

if TYPE_CHECKING:
    from sceneql.system import Assembly, TieRow


class Weld(Joint):
    """Two bodies keep the place and the rotation that they have to each other at the start."""

    gives: ClassVar[Mapping[str, Gives]] = FORCES

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The place of the first, and three directions."""
        must_turn(self.between, (first, second))
        return together(first, second, first.position) + parallel(first, second)
