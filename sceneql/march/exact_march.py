"""The march of a field on a box with constant coefficients: its exact solution at any instant."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.failure import LimitRefused
from sceneql.grids.multigrid.separable import axes_of
from sceneql.march.march import March
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper

NAMES = ("z", "y", "x")


class ExactMarch(March):
    """Solves each mode by itself, c(t) = c0 exp(-k t) + f (1 - exp(-k t))/k, without steps."""

    def _engage(self, stepper: Stepper) -> None:
        """Find the modes of the field.

        Raises ScriptError where the island is no field, LimitRefused where the field has no such modes.
        """
        grid = self.system.fields.single
        if grid is None:
            _, _, part, spans = self.system.ranges[0]
            message = f"exact marches a field on a grid, and '{part}' is none"
            raise ScriptError([Diagnostic("no-grid", message, spans[0], "let auto march it")])
        axes = axes_of(grid, self.floats)
        if axes is None:
            _, _, _, spans = self.system.ranges[0]
            raise LimitRefused(
                "an exact solution needs a box of two cells or more along each side, whose coefficient, boundary and "
                "sources do not vary (a source may, with the place)",
                spans[0],
                "let auto march it",
            )
        self._grid, self._axes = grid, axes
        self._modes: tuple[Any, Any] | None = None
        rank = len(axes)
        self._decays = sum(
            axis.decays.reshape([-1 if k == m else 1 for m in range(rank)]) for k, axis in enumerate(axes)
        )
        first = 3 - len(axes)
        kinds = (f"{axis.kind} along {name}" for axis, name in zip(axes, NAMES[first:], strict=True))
        self.prepared_text = f"the exact solution of every mode: {', '.join(kinds)}"

    def _fields(self, values: Floats) -> Any:
        shape = self._grid.cells.shape[::-1]
        return values.reshape(shape if len(self._axes) == 3 else shape[1:])

    def _weights(self, values: Floats) -> Any:
        found = self._fields(values)
        for k, axis in enumerate(self._axes):
            found = axis.forward(found, k)
        return found

    def _reach(self, t: float) -> tuple[Floats, bool]:
        """The state at an instant, by an inverse transform along each axis."""
        if not self._started:
            self._start()
        started = time.perf_counter()
        grid, y = self._grid, self._y1.copy()
        n = grid.cells.shape[0] * grid.cells.shape[1] * grid.cells.shape[2]
        cells = slice(grid.at, grid.at + n)
        volume = float(self.floats[grid.volumes_at])
        if self._modes is None:
            self.statistics.steps = 1  # one step reaches any instant
            self._modes = (
                self._weights(self._y1[cells]),
                self._weights(self.floats[grid.fed_at : grid.fed_at + n] / volume),
            )
        if t > 0.0:
            decays = self._decays
            gone = -np.expm1(-decays * t)
            grown = np.where(decays > 0.0, gone / np.where(decays > 0.0, decays, 1.0), t)
            field = self._modes[0] * np.exp(-decays * t) + self._modes[1] * grown
            for k, axis in enumerate(self._axes):
                field = axis.backward(field, k)
            y[cells] = field.real.ravel()
            # Fluxes inside cancel, so the increase of the total is the inflow.
            y[grid.at + n] += volume * float((y[cells] - self._y1[cells]).sum())
        self.statistics.seconds += time.perf_counter() - started
        return y, False
