"""The fields on grids, the flow and its skins that models of an island offer to one another."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sceneql.island.reserved import Reserved
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.quantities.expression import Link
    from sceneql.system import Flow, Grid, Membrane


@dataclass
class Offered(Reserved):
    """Registry of fields, flow and skins by the model that offers them."""

    fields: dict[tuple[str, str], Grid] = field(init=False, default_factory=dict)
    """The grids by model and output."""
    overlaps: list[Any] = field(init=False, default_factory=list)
    """Of contacts of rigid bodies (system.Assembly)."""
    _grids: list[Grid] = field(init=False, default_factory=list)
    _flows: dict[str, Flow] = field(init=False, default_factory=dict)
    _membranes: dict[str, Membrane] = field(init=False, default_factory=dict)
    _following: list[tuple[int, int]] = field(init=False, default_factory=list)

    def grid(self, grid: Grid) -> None:
        """Declare part of the state as a field (system.Assembly)."""
        self._grids.append(grid)

    def offer(self, output: str, grid: Grid) -> None:
        """Name the grid of a field output (system.Assembly)."""
        self.fields[self._word[0], output] = grid

    def field_of(self, link: Link) -> Grid | None:
        """The grid of a linked field (system.Assembly)."""
        return self.fields.get((link.task, link.output))

    def flow(self, flow: Flow) -> None:
        """Declare part of the state as a flow (system.Assembly). Raises ScriptError for a second one."""
        if self._flows:
            text = f"'{next(iter(self._flows))}' is solved together with it, and an island has one flow"
            raise ScriptError([Diagnostic("two-flows", text, self.line(), "let them not read one another")])
        self._flows[self._word[0]] = flow

    def flow_of(self, model: str | None = None) -> Flow | None:
        """The flow of a model, or the only one (system.Assembly)."""
        return next(iter(self._flows.values()), None) if model is None else self._flows.get(model)

    def membrane(self, membrane: Membrane) -> None:
        """Declare entries as a skin's vertices (system.Assembly)."""
        self._membranes[self._word[0]] = membrane

    def membrane_of(self, model: str) -> Membrane | None:
        """The skin of a model (system.Assembly)."""
        return self._membranes.get(model)

    def follows(self, at: int, count: int) -> None:
        """Declare entries as functions of others (system.Assembly)."""
        self._following.append((at, count))
