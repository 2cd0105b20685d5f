"""The interface by which an object writes its implicit field as straight-line code on registers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.quantities.expression import Expr


class FieldBuilder(Protocol):
    """Builder of an implicit field's straight-line code (implemented by sceneql.field.tape.builder.TapeBuilder)."""

    def constant(self, value: float) -> int:
        """Register that holds a constant."""

    def op(self, name: str, *registers: int) -> int:
        """Register of the result of an operation, by its name in the operation table, on registers."""

    def expression(self, expr: Expr, symbols: Mapping[str, int]) -> int:
        """Register of the value of a scalar expression; ``symbols``: the registers of its symbols."""

    def affine(self, matrix: Floats, x: int, y: int, z: int) -> tuple[int, int, int]:
        """Registers of the point (x, y, z), given by registers, mapped by a (3, 4) affine matrix."""

    def skeleton(self, skeleton: Any, x: int, y: int, z: int) -> int:
        """Register of a skeleton's density (sceneql.field.skeleton.skeleton.Skeleton) at a point given by registers."""
