"""Skin in a deep flow, a closed sheet of triangles around fluid: its state, numbers and terms in the island."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.skins.closed_surface import closed_surface
from sceneql.skins.elasticity import stiffness_in
from sceneql.system import Membrane

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.skins.elasticity import Elasticity
    from sceneql.system import Assembly, Flow

KERNELS = "sceneql.skins.closed_sheet_kernels"
EVEN = 2.0 / 3.0
"""Factor of the stiffness of springs along sides, k = EVEN stretch (adjacent areas)/length^2. A uniform relative
stretch then makes a tension of ``stretch`` times it (after Van Gelder 1998, J. Graphics Tools 3, 21-41)."""
ASIDE = 1e-7 * np.array([1.0, 0.6180339887])
"""Offset [cells] along y and z of the test lines from centers of cells, so that none meets a vertex there."""


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """Closed sheet with vertices (n, 3) in a deep flow."""

    flow: Flow
    membrane: Membrane
    triangles: NDArray[int64]
    """(m, 3): vertices, counterclockwise from outside."""
    sides: NDArray[int64]
    """(k, 2): vertices of each side."""
    lengths: Floats
    """(k,) [m]: lengths of sides at the start."""
    stiffness: Floats
    """(k,) [N/m]: stiffness of the springs along sides."""
    rest: Floats
    """(m, 4): inverse (p, q; 0, r) [1/m] of each triangle's sides in its plane at the start, and its area [m^2]."""
    law: Elasticity

    def volume(self, points: Floats) -> float:
        """Volume inside the sheet [m^3]."""
        a, b, c = self._corners(points - points[0])
        return float((a * np.cross(b, c)).sum() / 6.0)

    def area(self, points: Floats) -> float:
        """Area of the sheet [m^2]."""
        return float(_areas(points, self.triangles).sum())

    def potential(self, points: Floats) -> float:
        """Energy of tension and elasticity [J], 0 at the start, plus that of bending."""
        found = self.law.tension * (self.area(points) - float(self.rest[:, 3].sum()))
        if self.law.stretch > 0.0:
            more = self.sides_of(points) - self.lengths
            found += float(0.5 * (self.stiffness * more**2).sum())
        if max(self.law.modulus, self.law.shear) > 0.0:
            a, b, c = self._corners(points)
            p, q, r, areas = self.rest.T[:, :, None]
            u, v = p * (b - a), q * (b - a) + r * (c - a)
            trace, square = ((u * u) + (v * v)).sum(axis=1), (u * u).sum(axis=1) * (v * v).sum(axis=1)
            square -= (u * v).sum(axis=1) ** 2
            dense = 0.5 * self.law.modulus * (trace + 1.0 / square - 3.0)
            i, k = trace - 2.0, square - 1.0
            dense += 0.25 * self.law.shear * (i**2 + 2.0 * i - 2.0 * k + self.law.area * k**2)
            found += float((areas[:, 0] * dense).sum())
        if self.law.bend > 0.0:
            from sceneql.skins.bending import of_sheet

            found += self.law.bend * of_sheet(points, self.triangles)
        return found

    def moments(self, points: Floats) -> tuple[Floats, Floats]:
        """Center (3,) [m] of the volume inside, and its mean products (3, 3) [m^2] of coordinates from there."""
        base = points.mean(axis=0)
        a, b, c = self._corners(points - base)
        parts = (a * np.cross(b, c)).sum(axis=1) / 6.0
        whole, sums = parts.sum(), a + b + c
        center = parts @ sums / (4.0 * whole)
        second = sum(np.einsum("k,ki,kj->ij", parts, one, one) for one in (a, b, c, sums))
        return base + center, second / (20.0 * whole) - np.outer(center, center)

    def holds(self, places: Floats, points: Floats) -> NDArray[bool_]:
        """(k,): whether centers of cells (k, 3) [m] lie inside, by the parity of crossings on lines along x."""
        low, spacing = np.array(self.flow.low), np.array(self.flow.spacing)
        lines = (points - low)[:, 1:] / spacing[1:] - 0.5 - ASIDE  # in cells from the first one's center
        corners = lines[self.triangles]
        first = np.ceil(corners.min(axis=1)).astype(np.int64)
        reach = np.floor(corners.max(axis=1)).astype(np.int64) - first
        keys, crossed = [], []
        for j in range(int(reach[:, 0].max()) + 1):
            for k in range(int(reach[:, 1].max()) + 1):
                mine = np.flatnonzero((reach >= (j, k)).all(axis=1))
                line = first[mine] + (j, k)
                a, b, c = (corners[mine, n] - line for n in range(3))
                parts = np.column_stack([_turn(b, c), _turn(c, a), _turn(a, b)])
                through = (parts > 0.0).all(axis=1) | (parts < 0.0).all(axis=1)
                weights = parts[through] / parts[through].sum(axis=1)[:, None]
                keys.append(line[through])
                crossed.append((weights * points[self.triangles[mine[through]], 0]).sum(axis=1))
        own = np.round((places - low)[:, 1:] / spacing[1:] - 0.5).astype(np.int64)
        count = sum(map(len, crossed))
        where = np.concatenate([*keys, own])
        order = np.lexsort((np.concatenate([*crossed, places[:, 0]]), where[:, 0], where[:, 1]))
        is_crossing: Any = order < count
        before = np.cumsum(is_crossing)
        fresh = np.append(True, (np.diff(where[order], axis=0) != 0).any(axis=1))
        begun = np.maximum.accumulate(np.where(fresh, before - is_crossing, 0))
        found = np.zeros(len(places), dtype=bool)
        found[order[~is_crossing] - count] = ((before - begun)[~is_crossing] % 2).astype(bool)
        return found

    def encloses(self, places: Floats, points: Floats) -> NDArray[bool_]:
        """(k,): whether places (k, 3) [m] lie inside, by solid angles."""
        from sceneql.bodies.filling.clusters import Clusters, tiled
        from sceneql.bodies.filling.winding_kernels import hold

        found, arrays = np.zeros(len(places), dtype=bool), Clusters.of(points[self.triangles]).arrays
        tiled(len(places), lambda first, last: hold(*arrays, np.ascontiguousarray(places), found, first, last))
        return found

    def sides_of(self, points: Floats) -> Floats:
        """Lengths (k,) [m] of the sides."""
        found: Floats = np.linalg.norm(points[self.sides[:, 1]] - points[self.sides[:, 0]], axis=1)
        return found

    def _corners(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        a, b, c = (points[self.triangles[:, k]] for k in range(3))
        return a, b, c


def _turn(a: Floats, b: Floats) -> Floats:
    """Cross products (k,) of vectors (k, 2)."""
    found: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return found


def _areas(points: Floats, triangles: NDArray[int64]) -> Floats:
    """Areas (m,) [m^2] of triangles."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    found: Floats = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return found


def add_sheet(
    of: Ref, spacing: float, law: Elasticity, largest: float, kept: bool, flow: Flow, assembly: Assembly
) -> Sheet:
    """Reserve the vertices of an object's surface, and add the terms of its elasticity.

    ``kept``: whether its volume is conserved; ``largest`` [N/m]: as in Membrane.largest_tension.
    Raises ScriptError for an object that is no closed surface.
    """
    points, triangles = closed_surface(of, spacing, assembly)
    count, areas = len(points), _areas(points, triangles)
    at = assembly.state(np.append(points.ravel(), 0.0))
    shares = np.asarray(np.bincount(triangles.ravel(), np.repeat(areas / 3.0, 3), count), dtype=np.float64)
    stiffness = stiffness_in(flow, largest)
    skin = Membrane(count, at, assembly.floats(np.zeros(3 * count)), triangles, shares, *stiffness)
    ends = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    sides, which = np.unique(ends, axis=0, return_inverse=True)
    lengths = np.linalg.norm(points[sides[:, 1]] - points[sides[:, 0]], axis=1)
    beside = np.bincount(which.ravel(), np.repeat(areas, 3))
    made = Sheet(
        flow, skin, triangles, sides, lengths, EVEN * law.stretch * beside / lengths**2,
        _inverses(points, triangles, areas), law,
    )  # fmt: skip
    head, faces = (skin.count, skin.position_at, skin.force_at), tuple(triangles.ravel().tolist())
    if law.tension > 0.0:
        assembly.term("internal", f"{KERNELS}:tension", (*head, assembly.floats([law.tension]), 0, 0, 0, *faces))
    if law.stretch > 0.0:
        numbers = assembly.floats(made.stiffness), assembly.floats(lengths)
        assembly.term("internal", f"{KERNELS}:springs", (*head, *numbers, *sides.ravel().tolist()))
    if law.modulus > 0.0:
        numbers = assembly.floats([law.modulus]), assembly.floats(made.rest)
        assembly.term("internal", f"{KERNELS}:neo_hookean", (*head, *numbers, 0, 0, *faces))
    if law.shear > 0.0:
        numbers = assembly.floats([law.shear, law.area]), assembly.floats(made.rest)
        assembly.term("internal", f"{KERNELS}:skalak", (*head, *numbers, 0, 0, *faces))
    if law.bend > 0.0:
        from sceneql.skins.bending import add_to_sheet

        add_to_sheet(skin, law.bend, assembly)
    if kept:
        volume, room = assembly.floats([made.volume(points)]), assembly.floats(np.zeros(3 * count))
        ints = (*head, volume, room, at + 3 * count, 0, *faces)
        assembly.after_step(f"{KERNELS}:keep_volume", ints, samples=True)
    return made


def _inverses(points: Floats, triangles: NDArray[int64], areas: Floats) -> Floats:
    """(m, 4): p, q, r [1/m] of each triangle, (p, q; 0, r) being the inverse of its sides in its plane; its area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    length = np.linalg.norm(b - a, axis=1)
    along, height = ((b - a) * (c - a)).sum(axis=1) / length, 2.0 * areas / length
    return np.column_stack([1.0 / length, -along / (length * height), 1.0 / height, areas])
