"""Whether what flows in finds a way out: in each part of a flow that solids, or the walls of its box, close off."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span

UNBALANCED = 1e-6
"""Net flux through the boundary, relative to the sum of magnitudes, that counts as rounding of inflow profiles."""
TIMES = (0.0, 0.37, 1.0, 7.3)
"""Instants [s] at which the balance of inflows into a closed part is tested."""


def must_have_ways_out(
    faces: Faces, areas: Floats, opened: Any, velocity: Callable[[float], Floats], solids: list[str], span: Span | None
) -> None:
    """Raise ScriptError where inflows do not balance in a part of the flow without an outflow.

    ``areas``: open areas (faces,) [m^2]; ``opened``: of the boundary's faces, in the order of ``Faces.side``, which are
    outflows; ``velocity`` gives the inflows' velocities (faces,) at a time [s]; ``solids``: names of what stands in it.
    """
    sides = [(axis, high) for axis in range(faces.axes) if not faces.periodic[axis] for high in range(2)]
    if not sides:
        return
    mine = np.concatenate([faces.on_side(axis, high).ravel() for axis, high in sides])
    out = np.concatenate([opened[faces.side(axis, high).ravel()] for axis, high in sides])
    if not solids and out.any():
        return
    signs = np.concatenate([np.full(faces.side(axis, high).size, 2.0 * high - 1.0) for axis, high in sides])
    flows = [(time, signs * areas[mine] * velocity(time)[mine]) for time in TIMES]
    if not any(flow.any() for _, flow in flows):
        return
    owner = np.concatenate([_cells_beside(faces, axis, high) for axis, high in sides])
    part = np.zeros(len(owner), dtype=int) if not solids else _parts(faces, areas)[owner]
    free = np.bincount(part, weights=out & (areas[mine] > 0.0)) > 0.0
    for time, flow in flows:
        net, gross = np.bincount(part, weights=flow), np.bincount(part, weights=np.abs(flow))
        wrong = np.flatnonzero(~free & (np.abs(net) > UNBALANCED * gross))
        if not len(wrong):
            continue
        own = float(net[wrong[0]])
        text = f"{abs(own):.3g} m^3/s more come {'in' if own < 0 else 'out'} than "
        text += f"{'out' if own < 0 else 'in'} at {time:g} s, and the flow cannot be compressed"
        help = "give a part of the boundary `outflow: {}`"
        if out.any():
            names = ", ".join(f"'{name}'" for name in solids)
            text += f": {names} {'closes' if len(solids) == 1 else 'close'} this part of it off"
            help = "leave a cell or more between solids and walls, or let them touch"
            if faces.axes == 2:
                help += "; a flat flow has their sections at z = 0: a cylinder with `rotation: {about: x, angle: 90 "
                help += "deg}` is a circle there"
        raise ScriptError([Diagnostic("no-way-out", text, span, help)])


def _cells_beside(faces: Faces, axis: int, high: int) -> NDArray[int64]:
    """The numbers of the cells on a side of the box, in the order of ``Faces.side``."""
    index = np.arange(np.prod(faces.cells.shape)).reshape(faces.cells.shape[::-1])
    found: NDArray[int64] = index.take(-1 if high else 0, axis=2 - axis).ravel()
    return found


def _parts(faces: Faces, areas: Floats) -> NDArray[int64]:
    """The number (cells,) of the part of the flow that each cell belongs to: parts have no open face between them."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    shape = faces.cells.shape[::-1]
    index = np.arange(np.prod(shape)).reshape(shape)
    rows, columns = [], []
    for axis in range(faces.axes):
        line = 2 - axis
        open_ = areas[faces.index(axis)].take(range(shape[line]), axis=line) > 0.0  # the faces on the cells' low sides
        if not faces.periodic[axis]:
            open_[tuple(0 if k == line else slice(None) for k in range(3))] = False
        rows.append(index[open_])
        columns.append(np.roll(index, 1, axis=line)[open_])
    ends = np.concatenate(rows), np.concatenate(columns)
    found: NDArray[int64] = connected_components(coo_array((np.ones(len(ends[0])), ends), shape=(index.size,) * 2))[1]
    return found
