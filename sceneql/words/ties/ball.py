"""ball: a ball-and-socket joint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.bodies.rigid.joint import FORCES, Joint, Side, point_of, together
from sceneql.kinds import Gives, Position, Ref, Value, field

if TYPE_CHECKING:
    from sceneql.system import Assembly, TieRow


class Ball(Joint):
    """A point of one body stays at a point of the other; they turn about it freely.

    Pictures show a bead where it holds an object to the world, unless something at rest stands there.
    """

    gives: ClassVar[Mapping[str, Gives]] = FORCES

    at: Position | None = field("Where it is at the start; by default where the mass is that it holds.", None)

    def pivot(self) -> Ref | None:
        """The other body, where one is the world."""
        first, second = self.between
        if first.name and second.name:
            return None
        return first if first.name else second

    def support(self) -> tuple[Value, None] | None:
        """A bead at its point, where one of the bodies is the world."""
        return None if self.at is None or self.pivot() is None else (self.at, None)

    def places(self) -> Iterator[tuple[Value, tuple[Ref, ...]]]:
        """Its point, on both."""
        if self.at is not None:
            yield self.at, self.between

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The point, along three axes."""
        return together(first, second, point_of(self.at, self.between, (first, second), assembly))
