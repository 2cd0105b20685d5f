"""What an island's assembly asks of the scene."""

from __future__ import annotations

from typing import Protocol

from sceneql.kinds import Object, Ref
from sceneql.quantities.expression import Expr, Link


class Setting(Protocol):
    """What an assembly asks of the scene."""

    @property
    def end(self) -> float:
        """Of the run [s]."""

    def object(self, ref: Ref) -> Object:
        """The kind of an object of the script."""

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression of time; None for one of a model that is solved."""
