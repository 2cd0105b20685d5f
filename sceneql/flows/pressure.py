"""The equation of a flow's pressure as numbers and integers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows import layout
from sceneql.flows.transforms import plans

if TYPE_CHECKING:
    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.system import Assembly


def write_pressure(
    faces: Faces, opened: Any, solid: bool, areas: Floats, scales: Floats, assembly: Assembly, ints: Any
) -> None:
    """Write the integers of the pressure's equation, by the open ``areas`` of faces and those over volumes.

    ``opened``: by boundary face, whether fluid leaves there; ``solid``: whether solids stand in the flow.
    """
    cells = faces.cells
    n = len(cells.volumes)
    sink, entries = np.zeros(n), np.zeros(n)
    ends_open = []
    uniform = True
    for axis in range(faces.axes):
        ends = []
        for high in range(2):
            side = opened[faces.side(axis, high).ravel()]
            uniform &= bool(side.all() or not side.any())
            ends.append(bool(side.all()))
            if not faces.periodic[axis]:
                index = np.arange(n).reshape(cells.shape[::-1]).take(-1 if high else 0, axis=2 - axis).ravel()
                mine = faces.on_side(axis, high).ravel()
                sink[index] += areas[mine] * scales[mine]
        ends_open.append((ends[0], ends[1]))
        ties = (areas * scales)[faces.index(axis)]
        ties = ties[tuple(slice(0, m) for m in cells.shape[::-1])].copy()
        if not faces.periodic[axis]:
            ties[tuple(0 if k == 2 - axis else slice(None) for k in range(3))] = 0.0
        entries += (ties + np.roll(ties, -1, axis=2 - axis)).ravel()
        ints[layout.CONDUCTANCES + axis] = assembly.floats(ties.ravel())
    if solid:
        uniform = False
        whole = sum(np.bincount(np.arange(n), weights=_around_cell(faces, areas, axis)) for axis in range(faces.axes))
        sink[whole == 0.0] = -1.0
    ints[layout.SINK] = assembly.floats(sink)
    if not uniform:
        entries += sink
        cut = (sink >= 0.0) & (entries > 0.0) & (np.abs(entries - np.median(entries)) > 1e-9 * entries.max())
        ints[layout.CUT] = assembly.floats(np.where(cut, 0.5 / np.where(cut, entries, 1.0), 0.0))
    ints[layout.ITERATES] = not uniform
    ints[layout.SINGULAR] = not opened.any()
    inner = [faces.areas[axis] / float(cells.spacing[axis]) for axis in range(faces.axes)]
    tables, spectrum, room = plans(cells.shape, faces.periodic, ends_open, inner, assembly)
    ints[layout.PLANS : layout.EDGE_FIRST] = tables
    ints[layout.SPECTRUM] = assembly.floats(spectrum)
    ints[layout.PRESSURE] = assembly.floats(np.zeros(n))
    rows = (cells.shape[0] + 9) * 8 + (cells.shape[0] + 1) * (cells.shape[1] + 1)
    room = max(room, faces.count + rows)
    ints[layout.WORK] = assembly.floats(np.zeros(room + (0 if uniform else 5 * n))) + (0 if uniform else 5 * n)


def _around_cell(faces: Faces, areas: Floats, axis: int) -> Floats:
    """By cell: the open areas of its two faces across an axis."""
    shape = faces.cells.shape[::-1]
    own = areas[faces.index(axis)]
    count = shape[2 - axis]
    low = own.take(range(count), axis=2 - axis)
    high = np.roll(own, -1, axis=2 - axis).take(range(count), axis=2 - axis)
    total: Floats = (low + high).ravel()
    return total
