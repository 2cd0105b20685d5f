"""Errors for what a barrier does not act on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.quantities.span import Span


def beside_solids(model: str, why: str, place: Span | None, mode: str = "together with elastic solids") -> Diagnostic:
    """The error for masses beside elastic solids, or in a ``mode``, that have no lasting faces (Model.faceless)."""
    message = f"'{model}' {why}, and does not collide {mode}"
    help = "name under `between` what may touch, without it: solids, cloth and rigid bodies"
    return Diagnostic("no-collider", message, place, help)
