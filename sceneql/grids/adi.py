"""Preparation of alternating direction implicit (ADI) steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.island.system import System


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of adi_kernels.step. Raises ScriptError for an island that is no single field."""
    grid = system.fields.single
    if grid is None:
        _, _, part, spans = system.ranges[0]
        message = f"alternating directions march a field on a grid, and '{part}' is none"
        raise ScriptError([Diagnostic("no-grid", message, spans[0], "let auto march it")])
    numbers = [grid.at, *grid.cells.shape, grid.volumes_at, grid.sink_at, *grid.faces_at]
    axes = "x, y and z" if grid.cells.shape[2] > 1 else "x and y"
    text = f"tridiagonal systems along {axes} in turn"
    return Prepared(np.zeros(1), np.array(numbers, dtype=np.int64), 4 * len(system.y), text)
