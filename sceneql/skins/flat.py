"""Skin in a flat flow, a closed line around fluid: its state, numbers and terms in the island."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.skins.closed_line import closed_line, signed_area
from sceneql.skins.elasticity import stiffness_in
from sceneql.system import Membrane

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.skins.elasticity import Elasticity
    from sceneql.system import Assembly, Flow

KERNELS = "sceneql.skins.closed_line_kernels"


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """Closed line with vertices (n, 2) in a flat flow."""

    flow: Flow
    membrane: Membrane
    lengths: Floats
    """(n,) [m]: lengths of sides at the start."""
    law: Elasticity

    @property
    def triangles(self) -> NDArray[int64]:
        """Empty array (0, 3): a line has no triangles."""
        return np.zeros((0, 3), dtype=np.int64)

    @property
    def depth(self) -> float:
        """Depth of the flow along z [m]."""
        return self.flow.spacing[2]

    def volume(self, points: Floats) -> float:
        """Volume inside the line over the flow's depth [m^3]."""
        return self.depth * signed_area(points[:, :2])

    def area(self, points: Floats) -> float:
        """Area of the skin: length times depth [m^2]."""
        return self.depth * float(self.sides_of(points).sum())

    def potential(self, points: Floats) -> float:
        """Energy of tension and elasticity [J], 0 at the start, plus that of bending."""
        law, s = self.law, self.sides_of(points) / self.lengths
        dense = law.tension * (s - 1.0) + 0.5 * law.stretch * (s - 1.0) ** 2
        dense += 0.5 * law.modulus * (s**2 + 1.0 / s**2 - 2.0) + 0.25 * law.shear * (1.0 + law.area) * (s**2 - 1.0) ** 2
        found = float((dense * self.lengths).sum())
        if law.bend > 0.0:
            from sceneql.skins.bending import of_line

            found += law.bend * of_line(points[:, :2])
        return self.depth * found

    def moments(self, points: Floats) -> tuple[Floats, Floats]:
        """Center (3,) [m] of the area inside, and its mean products (2, 2) [m^2] of coordinates from there."""
        base = points[:, :2].mean(axis=0)
        a = points[:, :2] - base
        b = np.roll(a, -1, axis=0)
        parts = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
        whole = 0.5 * parts.sum()
        center = (parts @ (a + b)) / (6.0 * whole)
        products = np.einsum("k,ki,kj->ij", parts, a, a) + np.einsum("k,ki,kj->ij", parts, b, b)
        crossed = np.einsum("k,ki,kj->ij", parts, a, b)
        second = (products + 0.5 * (crossed + crossed.T)) / (12.0 * whole) - np.outer(center, center)
        return np.append(base + center, points[0, 2]), second

    def holds(self, places: Floats, points: Floats) -> NDArray[bool_]:
        """(k,): whether places (k, 3) [m] lie inside, by the parity of crossings to their left."""
        found = np.zeros(len(places), dtype=bool)
        ends = np.roll(points, -1, axis=0)
        for height in np.unique(places[:, 1]):
            row = np.flatnonzero(places[:, 1] == height)
            over = (points[:, 1] > height) != (ends[:, 1] > height)
            part = (height - points[over, 1]) / (ends[over, 1] - points[over, 1])
            crossed = np.sort(points[over, 0] + part * (ends[over, 0] - points[over, 0]))
            found[row] = np.searchsorted(crossed, places[row, 0]) % 2 == 1
        return found

    def encloses(self, places: Floats, points: Floats) -> NDArray[bool_]:
        """(k,): whether places (k, 3) [m] lie inside."""
        return self.holds(places, points)

    def sides_of(self, points: Floats) -> Floats:
        """Lengths (n,) [m] of the sides."""
        found: Floats = np.hypot(*(np.roll(points, -1, axis=0) - points)[:, :2].T)
        return found


def add_line(
    of: Ref, spacing: float, law: Elasticity, largest: float, kept: bool, flow: Flow, assembly: Assembly
) -> Line:
    """Reserve the vertices of an object's outline, and add the terms of its elasticity.

    ``kept``: whether its area is conserved; ``largest`` [N/m]: as in Membrane.largest_tension.
    Raises ScriptError for an object that is no closed line.
    """
    points = closed_line(of, spacing, assembly)
    count, depth = len(points), flow.spacing[2]
    at = assembly.state(np.append(np.column_stack([points, np.zeros(count)]).ravel(), 0.0))
    lengths = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    number = np.arange(count)
    skin = Membrane(
        *(count, at, assembly.floats(np.zeros(3 * count)), np.column_stack([number, np.roll(number, -1)])),
        *(0.5 * depth * (lengths + np.roll(lengths, 1)), *stiffness_in(flow, largest)),
    )
    head = (skin.count, skin.position_at, skin.force_at)
    sheets = [law.modulus * depth, law.shear * (1.0 + law.area) * depth]
    tension, stretch = (assembly.floats([one * depth]) for one in (law.tension, law.stretch))
    held = assembly.floats(np.zeros(1 + 2 * count))
    ints = (*head, tension, stretch, assembly.floats(lengths), assembly.floats(sheets), held)
    assembly.term("internal", f"{KERNELS}:tension", ints, stiff=True)
    if law.bend > 0.0:
        from sceneql.skins.bending import add_to_line

        add_to_line(skin, law.bend * depth, held, assembly)
    if kept:
        volume, room = assembly.floats([signed_area(points) * depth]), assembly.floats(np.zeros(3 * count))
        within = (*head, volume, room, at + 3 * count, assembly.floats([depth]))
        assembly.after_step(f"{KERNELS}:keep_area", within, samples=True)
    return Line(flow, skin, lengths, law)
