"""Checks of a skin against the cells of its flow."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.kinds import Ref
    from sceneql.skins.deep import Sheet
    from sceneql.skins.flat import Line
    from sceneql.system import Assembly, Flow

APART = {2: 0.25, 3: 0.5}
"""Default distance of vertices [cells], by the number of the flow's axes. The area inside a curve 25 cells wide is
then conserved to 1e-7; twice this distance loses ten times as much."""
WIDE = 4.0
"""Least width of a skin [cells]: as many as its forces are spread over."""


def spacing_in(flow: Flow, spacing: float | None, of: Ref, assembly: Assembly) -> float:
    """Distance of a skin's vertices [m]. Raises ScriptError for a given ``spacing`` larger than a cell."""
    cell = min(flow.spacing[: len(flow.areas)])
    apart = APART[len(flow.areas)] * cell
    if spacing is not None and spacing > cell:
        text = f"vertices {spacing:g} m apart are too coarse for cells of {cell:g} m: fluid would pass between them"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), f"let `spacing` be {apart:.3g} m")])
    return apart if spacing is None else spacing


def must_fit(skin: Line | Sheet, of: Ref, assembly: Assembly) -> None:
    """Raise ScriptError for a skin outside its flow or its fluid, too small for its cells, or longer than a period."""
    flow, membrane = skin.flow, skin.membrane
    axes = len(flow.areas)
    points = assembly.start()[membrane.position_at : membrane.position_at + 3 * membrane.count].reshape(-1, 3)
    low, high = points[:, :axes].min(axis=0), points[:, :axes].max(axis=0)
    cell = min(flow.spacing[:axes])
    if (high - low).min() < WIDE * cell:
        text = f"'{of.name}' is {(high - low).min():.3g} m wide: its flow's cells of {cell:g} m are too coarse for it"
        raise ScriptError([Diagnostic("invalid", text, of.span, f"let `cell` be {(high - low).min() / 16:.2g} m")])
    for axis in range(axes):
        first, last = flow.low[axis], flow.low[axis] + flow.cells.shape[axis] * flow.spacing[axis]
        if flow.cells.periodic[axis]:
            if high[axis] - low[axis] > (last - first) - WIDE * cell:
                text = f"'{of.name}' is as long as its flow is periodic: it would touch itself"
                raise ScriptError([Diagnostic("invalid", text, of.span, "take a larger `size` of the flow")])
        elif low[axis] < first or high[axis] > last:
            text = f"'{of.name}' stands outside its flow, which ends at {'xyz'[axis]} = "
            text += f"{first if low[axis] < first else last:g} m"
            raise ScriptError([Diagnostic("invalid", text, of.span, "move it inside, or take a larger `size`")])
    if flow.fractions is None:
        return
    import numpy as np

    cells = [
        np.clip(((points[:, k] - flow.low[k]) // flow.spacing[k]).astype(int), 0, flow.cells.shape[k] - 1)
        for k in range(axes)
    ]
    shape = flow.cells.shape
    number = cells[0] + shape[0] * (cells[1] + shape[1] * (cells[2] if axes == 3 else 0))
    shut = np.flatnonzero(np.asarray(flow.fractions)[number] == 0.0)
    if len(shut):
        x, y, z = points[shut[0]]
        text = f"'{of.name}' stands where its flow has no fluid, at ({x:.4g}, {y:.4g}, {z:.4g}) m"
        raise ScriptError([Diagnostic("invalid", text, of.span, "move it to where the fluid is")])
