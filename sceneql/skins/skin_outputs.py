"""Outputs of a skin at an instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows.layout import PRESSURE

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.skins.deep import Sheet
    from sceneql.skins.flat import Line
    from sceneql.system import ModelState

OFF = 3
"""Distance from the skin [cells] beyond which its pressure jump is measured: its forces spread over nearer cells."""


def positions(skin: Line | Sheet, state: ModelState) -> Floats:
    """Positions (n, 3) [m] of the vertices."""
    at, count = skin.membrane.position_at, skin.membrane.count
    return state.y[at : at + 3 * count].reshape(-1, 3).copy()


def measure(what: str, skin: Line | Sheet, state: ModelState) -> Any:
    """An output of the word `membrane`: float, (3,) or (n, 3)."""
    points = positions(skin, state)
    match what:
        case "positions":
            return points
        case "volume":
            return skin.volume(points)
        case "area":
            return skin.area(points)
        case "potential":
            return skin.potential(points)
        case "center":
            return skin.moments(points)[0]
        case "deformation":
            squares = np.linalg.eigvalsh(skin.moments(points)[1])
            least, most = np.sqrt(squares[[0, -1]])
            return float((most - least) / (most + least))
        case "volume_correction":
            return float(state.y[skin.membrane.position_at + 3 * skin.membrane.count])
        case "triangles":
            return skin.triangles.astype(float)
        case "stretch":
            return float((skin.sides_of(points) / skin.lengths).max())
        case "count":
            return float(skin.membrane.count)
    return _pressure_jump(skin, points, state)


def widest(skin: Line | Sheet, state: ModelState) -> float:
    """Length of the longest side [cells]."""
    return float(skin.sides_of(positions(skin, state)).max() / min(skin.flow.spacing[: len(skin.flow.areas)]))


def turned(skin: Line | Sheet, state: ModelState) -> str:
    """Message for a skin that is inside out or crosses itself at the end of a run; empty for others."""
    points = positions(skin, state)
    if not np.isfinite(points).all():
        return ""
    if skin.volume(points) <= 0.0:
        return "its skin is inside out at the end"
    if len(skin.triangles):
        return ""
    crossed = _crossing(points[:, :2])
    if crossed is None:
        return ""
    x, y = crossed
    return f"its skin crosses itself at the end, near ({x:.4g}, {y:.4g}, 0) m: part of it is inside out"


def _crossing(line: Floats) -> Floats | None:
    """Place (2,) near which two sides of a closed line (n, 2) cross each other; None if none do."""
    from scipy.spatial import cKDTree

    ends = np.roll(line, -1, axis=0)
    middles, longest = 0.5 * (line + ends), float(np.hypot(*(ends - line).T).max())
    pairs = cKDTree(middles).query_pairs(longest, output_type="ndarray")
    apart = np.abs(pairs[:, 1] - pairs[:, 0])
    a, b = pairs[(apart > 1) & (apart < len(line) - 1)].T

    def side(p: Floats, q: Floats, r: Floats) -> Floats:
        found: Floats = (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])
        return found

    over = side(line[a], ends[a], line[b]) * side(line[a], ends[a], ends[b]) < 0.0
    over &= side(line[b], ends[b], line[a]) * side(line[b], ends[b], ends[a]) < 0.0
    found: Floats | None = middles[a[np.argmax(over)]] if over.any() else None
    return found


def _pressure_jump(skin: Line | Sheet, points: Floats, state: ModelState) -> float:
    """Mean pressure inside minus that outside [Pa], without cells within OFF of the skin, or fewer in a thin skin."""
    flow = skin.flow
    shape, low, spacing = np.array(flow.cells.shape), np.array(flow.low), np.array(flow.spacing)
    flat = shape[2] == 1
    index = np.stack(np.unravel_index(np.arange(shape.prod()), tuple(shape[::-1]))[::-1], axis=1)
    centers = low + (index + 0.5) * spacing
    if flat:
        centers[:, 2] = 0.0
    around = np.where(flow.cells.periodic, shape * spacing, np.inf)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    shift = np.zeros_like(centers)
    np.divide(middle - centers, around, out=shift, where=np.isfinite(around))
    held: Any = skin.holds(centers + np.round(shift) * np.where(np.isfinite(around), around, 0.0), points)
    pressure = flow.density * state.floats[flow.ints[PRESSURE] : flow.ints[PRESSURE] + len(centers)]
    for off in range(OFF, -1, -1):
        beside = _beside(points, off, flow)
        inner, outer = held & ~beside, ~held & ~beside
        if inner.any() and outer.any():
            return float(pressure[inner].mean() - pressure[outer].mean())
    return float("nan")


def _beside(points: Floats, off: int, flow: Any) -> Any:
    """(cells,): whether a vertex lies at most ``off`` cells away along each axis."""
    shape = np.array(flow.cells.shape)
    axes = 2 if shape[2] == 1 else 3
    cell = np.floor((points - np.array(flow.low)) / np.array(flow.spacing)).astype(np.int64)
    cell[:, axes:] = 0
    reach = [np.arange(-off, off + 1) if axis < axes else np.zeros(1, dtype=np.int64) for axis in range(3)]
    near = cell[:, None] + np.stack(np.meshgrid(*reach, indexing="ij"), axis=-1).reshape(1, -1, 3)
    near = np.where(flow.cells.periodic, near % shape, np.clip(near, 0, shape - 1)).reshape(-1, 3)
    found = np.zeros(shape.prod(), dtype=bool)
    found[near[:, 0] + shape[0] * (near[:, 1] + shape[1] * near[:, 2])] = True
    return found
