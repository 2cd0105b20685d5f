"""How an object writes its implicit field: straight-line code on registers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.quantities.expression import Expr


class FieldBuilder(Protocol):
    """What an object writes its implicit field with (sceneql.field.tape.builder.TapeBuilder)."""

    def constant(self, value: float) -> int:
        """Register of a number."""

    def op(self, name: str, *registers: int) -> int:
        """Register of an operation of the one table."""

    def expression(self, expr: Expr, symbols: Mapping[str, int]) -> int:
        """Register of a scalar expression whose symbols have registers."""

    def affine(self, matrix: Floats, x: int, y: int, z: int) -> tuple[int, int, int]:
        """Registers of a point mapped by a (3, 4) matrix."""

    def skeleton(self, skeleton: Any, x: int, y: int, z: int) -> int:
        """Register of the density of a skeleton (sceneql.field.skeleton.skeleton.Skeleton) at a point."""
