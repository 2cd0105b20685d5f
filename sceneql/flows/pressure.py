"""The pressure equation of a flow: conductances, sinks, transforms and linear solver, as an island's numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows import layout
from sceneql.flows.transforms import plans
from sceneql.grids.prepare_stages import laid_out
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Cells, Grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.system import Assembly


def write_pressure(
    faces: Faces, opened: Any, solid: bool, areas: Floats, scales: Floats, solver: str, assembly: Assembly, ints: Any,
    varies: bool = False,
) -> tuple[NDArray[int64], str]:  # fmt: skip
    """Write the integers of the pressure equation into ``ints``: (plan of a named linear solver, text for `explain`).

    ``areas``: open areas of faces, ``scales``: areas over control volumes; ``opened``: for each boundary face whether
    it is an outflow; ``solid``: whether there are solids; ``varies``: whether coefficients change. The plan is empty
    for `auto` and `fast_transform`. Raises ScriptError where the named solver cannot solve on this grid.
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
    ints[layout.UNCUT] = assembly.floats(np.array(inner))
    ints[layout.SPECTRUM] = assembly.floats(spectrum)
    ints[layout.PRESSURE] = assembly.floats(np.zeros(n))
    if solver == "fast_transform" and not uniform:
        text = "a fast transform needs a box each side of which is a way out as a whole or not at all"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), "take `pressure: auto`")])
    wide, layer = cells.shape[0] + 9, (cells.shape[0] + 1) * (cells.shape[1] + 1)
    rows = 6 * wide + faces.axes * (wide + layer)
    room = max(room, faces.count + rows)
    before = 0 if uniform else 1 + 5 * n  # of iterations
    ints[layout.WORK] = assembly.floats(np.zeros(before + room)) + before
    if solver in ("auto", "fast_transform"):
        return np.zeros(0, dtype=np.int64), "" if uniform else " by conjugate gradients"
    return _by_name(solver, faces, sink, assembly, ints, varies)


def _by_name(
    solver: str, faces: Faces, sink: Floats, assembly: Assembly, ints: Any, varies: bool
) -> tuple[NDArray[int64], str]:
    """(plan of a linear solver chosen by name (grids/multigrid/linear_kernels), text for `explain`)."""
    cells, axes = faces.cells, faces.axes
    n, shape = len(sink), cells.shape
    numbers = assembly.numbers()
    ties = [numbers[at : at + n] for at in ints[layout.CONDUCTANCES : layout.CONDUCTANCES + axes].tolist()]
    around = sum(tie + np.roll(tie.reshape(shape[::-1]), -1, axis=2 - axis).ravel() for axis, tie in enumerate(ties))
    held = np.where(sink < 0.0, 1.0, sink)
    if solver == "direct":  # one cell of each component without outflow has pressure 0
        alone = _parts(faces, ties)
        firsts = np.unique(alone, return_index=True)[1]
        closed = np.bincount(alone, weights=held) == 0.0
        held[firsts[closed]] = np.maximum(around[firsts[closed]], 1e-300)
    volumes, sinks = assembly.floats(np.zeros(n)), assembly.floats(held)
    gx, gy, *gz = ints[layout.CONDUCTANCES : layout.CONDUCTANCES + axes].tolist()
    described = Cells(shape, faces.periodic, np.zeros(n, dtype=bool), 0, 0)
    plan, room, text = laid_out(solver, Grid(described, 0, volumes, sinks, (gx, gy, *gz, gx)[:3], varies, -1, True))
    ints[layout.ITERATES], ints[layout.SOLVER_AT] = 2, len(ints)
    ints[layout.STORE], ints[layout.STORE_SIZE] = assembly.floats(np.zeros(n + room)), room
    return plan, f" by {solver}, {text}, as the script says"


def _parts(faces: Faces, ties: Sequence[Floats]) -> NDArray[int64]:
    """For each cell (cells,) the number of its connected component, by open faces."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    index = np.arange(len(ties[0])).reshape(faces.cells.shape[::-1])
    tied = [tie > 0.0 for tie in ties]
    rows = np.concatenate([index.ravel()[one] for one in tied])
    columns = np.concatenate([np.roll(index, 1, axis=2 - axis).ravel()[one] for axis, one in enumerate(tied)])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(index.size, index.size))
    found: NDArray[int64] = connected_components(graph, directed=False)[1]
    return found


def _around_cell(faces: Faces, areas: Floats, axis: int) -> Floats:
    """For each cell (cells,) the sum of the open areas of its two faces normal to an axis."""
    shape = faces.cells.shape[::-1]
    own = areas[faces.index(axis)]
    count = shape[2 - axis]
    low = own.take(range(count), axis=2 - axis)
    high = np.roll(own, -1, axis=2 - axis).take(range(count), axis=2 - axis)
    total: Floats = (low + high).ravel()
    return total
