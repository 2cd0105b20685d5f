"""rod: a massless rod with a ball joint at each end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.bodies.rigid.joint import FORCES, Joint, Side, point_of
from sceneql.kinds import Gives, Position, Ref, Value, field
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import TieRow

if TYPE_CHECKING:
    from sceneql.system import Assembly


class Rod(Joint):
    """Two points, one of each body, keep the distance that they have at the start.

    For example `stay: {rod: {between: [swing.bob, world], to: 0 2 0 m}}`.
    """

    gives: ClassVar[Mapping[str, Gives]] = FORCES

    from_: Position | None = field("The point of the first body at the start; by default its center of mass.", None)
    to: Position | None = field("The point of the second body at the start; by default its center of mass.", None)

    def places(self) -> Iterator[tuple[Value, tuple[Ref, ...]]]:
        """An end on each."""
        for end, ref in zip((self.from_, self.to), self.between, strict=True):
            if end is not None:
                yield end, (ref,)

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The distance."""
        import numpy as np

        ends = [
            point_of(value, (ref,), (side,), assembly, center=True)
            for value, ref, side in zip((self.from_, self.to), self.between, (first, second), strict=True)
        ]
        length = float(np.linalg.norm(ends[0] - ends[1]))
        if length == 0.0:
            message = "the two points of a rod are one at the start"
            raise ScriptError([Diagnostic("no-length", message, assembly.line(), "a `ball` holds two points together")])
        return [TieRow("distance", (first.place(ends[0]), second.place(ends[1])), (length,))]
