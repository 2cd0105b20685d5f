"""Outputs of a flow at an instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows import layout
from sceneql.flows.obstacles.no_slip_numbers import UNEVEN
from sceneql.grids.multigrid.layout import HISTORY, RECORD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout
    from sceneql.system import ModelState


def crowded(ints: Sequence[int], floats: Floats) -> bool:
    """Whether moving solids displace fluid in a closed box, close to the limit UNEVEN; ``ints``: the flow's."""
    if ints[layout.LED] <= 0 or ints[layout.SINGULAR] == 0:
        return False
    cells = int(np.prod(ints[layout.CELLS : layout.CELLS + 3]))
    return bool(abs(floats[ints[layout.SEEPING] + 2 * cells]) > 0.5 * UNEVEN)


def measure(
    what: str, cells: FieldLayout, ints: tuple[int, ...], density: float, state: ModelState, masses_at: int = -1
) -> Any:
    """Value of an output of the word `flow`: (cells,), (cells, 3), (3,), (iterations,) or float.

    ``masses_at``: offset of the masses of the faces' control volumes, for a flow of several fluids; -1: one density.
    """
    match what:
        case "centers":
            return cells.centers()
        case "velocity":
            return np.column_stack([*_at_centers(ints, state.y), *[np.zeros(cells.count)] * (3 - ints[layout.AXES])])
        case "speed":
            return np.sqrt(sum(part**2 for part in _at_centers(ints, state.y)))
        case "largest_speed":
            return float(np.sqrt(sum(part**2 for part in _at_centers(ints, state.y))).max())
        case "vorticity":
            return _vorticity(ints, cells.spacing, state)
        case "pressure":
            at = ints[layout.PRESSURE]
            pressure = density * state.floats[at : at + cells.count]
            return pressure - pressure.mean() if ints[layout.SINGULAR] else pressure
        case "residuals":
            end = ints[layout.STORE] + cells.count + ints[layout.STORE_SIZE]
            history = state.floats[end - RECORD + HISTORY : end]
            return history[history >= 0.0]
        case "divergence":
            from sceneql.flows.projection_kernels import outflow

            out = np.zeros(cells.count)
            outflow(state.y, out, layout.VELOCITY, state.floats, np.array(ints))
            return float(np.abs(out).max() / np.prod(cells.spacing))
    velocities = components(ints, state.y)
    if masses_at < 0:
        masses = [density * _own(ints, state.floats, cells, axis) for axis in range(ints[layout.AXES])]
    else:
        first = [masses_at + ints[layout.STARTS + axis] for axis in range(ints[layout.AXES])]
        masses = [state.floats[at : at + u.size].reshape(u.shape) for at, u in zip(first, velocities, strict=True)]
    if what == "kinetic_energy":
        return float(0.5 * sum((mass * u**2).sum() for mass, u in zip(masses, velocities, strict=True)))
    parts = [(mass * u).sum() for mass, u in zip(masses, velocities, strict=True)]
    return np.array([*parts, 0.0][:3])


def at_place(
    what: str, place: Sequence[float], cells: FieldLayout, ints: tuple[int, ...], density: float, state: ModelState
) -> Any:
    """`velocity` (3,) [m/s] or `pressure` [Pa] at a place (2,) or (3,) [m], linear between what is known around it.

    Velocities are known at faces, the pressure at centers of cells outside of solids; at the boundary the nearest are
    taken.
    """
    axes = ints[layout.AXES]
    index = [(x - low) / side for x, low, side in zip(place, cells.low, cells.spacing, strict=False)][:axes]
    index += [0.5] * (axes - len(index))
    if what == "pressure":
        values = measure("pressure", cells, ints, density, state).reshape(cells.shape[::-1])
        volumes = state.floats[cells.volumes_at : cells.volumes_at + cells.count].reshape(values.shape)
        places, weights = _around([x - 0.5 for x in index], cells.shape, ints)
        weights = weights * (volumes[places] > 0.0)
        return float((weights * values[places]).sum() / weights.sum()) if weights.any() else 0.0
    found = np.zeros(3)
    for axis, u in enumerate(components(ints, state.y)):
        places, weights = _around([x - 0.5 * (k != axis) for k, x in enumerate(index)], u.shape[::-1], ints)
        found[axis] = (weights * u[places]).sum()
    return found


def _around(index: Sequence[float], shape: Sequence[int], ints: tuple[int, ...]) -> tuple[Any, Any]:
    """Indices (z, y, x) of the 2^axes numbers around a place, given in steps from the first, and their weights."""
    ends, shares = [], []
    for axis, at in enumerate(index):
        first, count = int(np.floor(at)), shape[axis]
        pair = np.array([first, first + 1])
        ends.append(pair % count if ints[layout.PERIODIC + axis] else pair.clip(0, count - 1))
        shares.append(np.array([first + 1 - at, at - first]))
    while len(ends) < 3:
        ends.append(np.array([0]))
        shares.append(np.array([1.0]))
    places = np.meshgrid(*ends[::-1], indexing="ij")
    weights = np.einsum("k,j,i->kji", *shares[::-1])
    return tuple(places), weights


def components(ints: tuple[int, ...], y: Floats) -> list[Floats]:
    """For each component its velocities at its faces, (nz, ny, nx) views of y."""
    found = []
    for axis in range(ints[layout.AXES]):
        shape = list(ints[layout.CELLS : layout.CELLS + 3])
        shape[axis] += not ints[layout.PERIODIC + axis]
        first = ints[layout.AT] + ints[layout.STARTS + axis]
        found.append(y[first : first + int(np.prod(shape))].reshape(shape[::-1]))
    return found


def _own(ints: tuple[int, ...], floats: Floats, cells: FieldLayout, axis: int) -> Floats:
    """Volumes (nz, ny, nx) [m^3] of fluid in the control volumes of a component's faces."""
    shape = list(cells.shape)
    shape[axis] += not ints[layout.PERIODIC + axis]
    volumes = np.full(shape[::-1], np.prod(cells.spacing))
    if not ints[layout.PERIODIC + axis]:
        for end in (0, -1):
            volumes[tuple(end if k == 2 - axis else slice(None) for k in range(3))] *= 0.5
    first = ints[layout.STARTS + axis]
    areas, inverses, fills = (
        floats[ints[at] + first : ints[at] + first + volumes.size].reshape(volumes.shape)
        for at in (layout.AREAS, layout.INVERSES, layout.FILLS)
    )
    free = inverses > 0.0
    return np.where(free, fills / np.where(free, inverses, 1.0), np.where(areas > 0.0, volumes, 0.0))


def _at_centers(ints: tuple[int, ...], y: Floats) -> list[Floats]:
    """Each velocity component, averaged to the centers of cells (cells,)."""
    found = []
    for axis, u in enumerate(components(ints, y)):
        if ints[layout.PERIODIC + axis]:
            found.append((0.5 * (u + np.roll(u, -1, axis=2 - axis))).ravel())
        else:
            low, high = (u[tuple(cut if k == 2 - axis else slice(None) for k in range(3))] for cut in CUTS)
            found.append((0.5 * (low + high)).ravel())
    return found


CUTS = (slice(0, -1), slice(1, None))


def _vorticity(ints: tuple[int, ...], spacing: tuple[float, ...], state: ModelState) -> Floats:
    """Vorticity (2D) or its magnitude (3D) at cells' centers (cells,) [1/s]: the mean of differences at edges.

    At walls the differences use the wall's velocity.
    """
    axes = ints[layout.AXES]
    u = components(ints, state.y)
    turns = []
    for a, b in ((0, 1),) if axes == 2 else ((1, 2), (2, 0), (0, 1)):
        turns.append(_slope(u[b], b, a, spacing, ints, state) - _slope(u[a], a, b, spacing, ints, state))
    return turns[0].ravel() if axes == 2 else np.sqrt(sum(turn**2 for turn in turns)).ravel()


def _slope(
    u: Floats, component: int, axis: int, spacing: tuple[float, ...], ints: tuple[int, ...], state: ModelState
) -> Floats:
    """d(component)/d(axis) (nz, ny, nx) [1/s] at cells' centers: the mean over each cell's four edges."""
    line = 2 - axis
    if ints[layout.PERIODIC + axis]:
        steps = np.roll(u, -1, axis=line) - u
        slopes = np.concatenate([steps.take([-1], axis=line), steps], axis=line) / spacing[axis]
    else:
        ends = []
        for high in range(2):
            own = u.take([-1 if high else 0], axis=line)
            first = ints[layout.EDGE_FIRST + 6 * component + 2 * axis + high]
            edges = slice(first, first + own.size)
            given, weight = (
                state.floats[ints[at] :][edges].reshape(own.shape) for at in (layout.EDGE_VALUES, layout.EDGE_WEIGHTS)
            )
            step = np.where(weight > 0.0, 2.0 * (given - own), 0.0)
            ends.append(step if high else -step)
        slopes = np.concatenate([ends[0], np.diff(u, axis=line), ends[1]], axis=line) / spacing[axis]
    slopes = 0.5 * (
        slopes.take(range(slopes.shape[line] - 1), axis=line) + slopes.take(range(1, slopes.shape[line]), axis=line)
    )
    other = 2 - component
    if ints[layout.PERIODIC + component]:
        return 0.5 * (slopes + np.roll(slopes, -1, axis=other))
    count = slopes.shape[other]
    return 0.5 * (slopes.take(range(count - 1), axis=other) + slopes.take(range(1, count), axis=other))
