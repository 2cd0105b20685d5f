"""No-slip walls of solids that cut cells: the viscous operator near them, of second order.

The unknown velocity of a face is the mean over its open part. Near a wall the velocity is w + d g, with the wall's
velocity w, the distance d from it and a nearly constant g; this gives the velocity at the face's center. Viscosity acts
between centers of faces, and from these to the wall at its true distance along each axis (Gibou, Fedkiw, Cheng & Kang
2002, J. Comput. Phys. 176, 205-227). If a face's center lies in the solid or close to it, the face's velocity is tied
to that of the next face away from the wall, scaled by the ratio of distances. The operator stays symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows.obstacles.no_slip_numbers import BESIDE, FARTHEST, HALVINGS, NEAREST

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sceneql.flows.obstacles.obstacles import Solids
    from sceneql.frame import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The viscous operator of a component, arrays (nz, ny, nx) of its faces.

    V du/dt = sum of ties (u of neighbor - u) - friction u + gains, V the control volume.
    """

    ties: list[Floats]
    """[m^3/s] for x, y, z: viscous conductance to the face before."""
    friction: Floats
    """[m^3/s] drag coefficient of the wall; may be negative next to faces with a larger one."""
    gains: Floats
    """[m^4/s^2] contribution of the wall's velocity."""
    scale: Floats
    """Velocity at the face's center over the mean of its open part, next to a wall at rest."""


class _Component:
    def __init__(
        self, solids: Solids, component: int, ties: Sequence[Floats], velocity: Callable[[Floats, int], Floats]
    ) -> None:
        faces, one = solids.faces, solids.opened[component]
        shape = faces.shapes[component]
        self.solids, self.component, self.velocity = solids, component, velocity
        self.faces, self.one, self.base = faces, one, [tie.reshape(shape) for tie in ties]
        self.points = faces.points(component)
        self.level, self.depth = one.levels.reshape(shape), one.depths.reshape(shape)
        part = one.parts.reshape(shape)
        self.free = (part > 0.0) & (self.level > BESIDE * float(min(solids.spacing[: faces.axes])))
        cut = self.free & (part < 1.0)
        self.scale = np.where(cut, self.level / np.where(cut, self.depth, 1.0), 1.0)
        self.beside = (part > 0.0) & ~self.free
        self.wall = np.zeros(shape)
        near = np.flatnonzero(cut | self.beside)
        self.wall.ravel()[near] = self._wall(one.centers[near])
        self.fixed = np.zeros(shape)
        near = np.flatnonzero(cut)
        middle = self._wall(self.points[near])
        self.fixed.ravel()[near] = middle - self.scale.ravel()[near] * self.wall.ravel()[near]
        self.friction, self.gains = np.zeros(shape), np.zeros(shape)

    def _wall(self, points: Floats) -> Floats:
        """The component of the velocity (k,) [m/s] of the wall nearest to points (k, 3)."""
        return self.velocity(points, self.component)

    def skin(self) -> Skin:
        ties = [self._along(axis, tie) for axis, tie in enumerate(self.base)]
        self._drawn(ties)
        return Skin(ties, self.friction, self.gains, np.where(self.beside, 0.0, self.scale))

    def _along(self, axis: int, base: Floats) -> Floats:
        """Viscous ties along an axis between face centers in the fluid; adds friction where a wall is in between."""
        line = 2 - axis
        found = np.zeros(base.shape)
        for way in (-1, 1):
            tie = base if way < 0 else np.roll(base, -1, axis=line)
            free = np.roll(self.free, -way, axis=line)
            scale, fixed = (np.roll(one, -way, axis=line) for one in (self.scale, self.fixed))
            pair = np.where(self.free & free, tie, 0.0)
            self.friction += self.scale * (self.scale - scale) * pair
            self.gains += self.scale * (fixed - self.fixed) * pair
            if way < 0:
                found = self.scale * scale * pair
            crossing = np.flatnonzero(self.free & ~free & (tie > 0.0))
            share = self._share(crossing, axis, way)
            points = self.points[crossing].copy()
            points[:, axis] += way * share * self.solids.spacing[axis]
            own = self.scale.ravel()[crossing]
            strength = own * tie.ravel()[crossing] / share
            self.friction.ravel()[crossing] += own * strength
            self.gains.ravel()[crossing] += strength * (self._wall(points) - self.fixed.ravel()[crossing])
        return found

    def _share(self, chosen: Any, axis: int, way: int) -> Floats:
        """Distance (k,) [cells] of the wall from the centers of the chosen faces along an axis.

        By bisection; extrapolated where the wall is beyond the next center.
        """
        move = np.zeros(3)
        move[axis] = way * self.solids.spacing[axis]
        points, values = self.points[chosen], self.solids.values
        low, high = np.zeros(len(chosen)), np.ones(len(chosen))
        first, last = values(points), values(points + move)
        between = last <= 0.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            there = values(points + middle[:, None] * move)
            fluid, solid = between & (there > 0.0), between & (there <= 0.0)
            low, first = np.where(fluid, middle, low), np.where(fluid, there, first)
            high, last = np.where(solid, middle, high), np.where(solid, there, last)
        falls = first > last
        share = np.where(falls, low + (high - low) * first / np.where(falls, first - last, 1.0), 1.0)
        found: Floats = np.clip(share, NEAREST, FARTHEST)
        return found

    def _drawn(self, ties: list[Floats]) -> None:
        """Tie the velocities of faces close to the wall to those of the next faces away from it."""
        flat = [tie.reshape(-1) for tie in ties]
        mine = np.flatnonzero(self.beside)
        strength = sum(2.0 * self._largest(axis) for axis in range(self.faces.axes))
        friction, gains = self.friction.reshape(-1), self.gains.reshape(-1)
        wall, depth, free = self.wall.ravel(), self.depth.ravel(), self.free.ravel()
        friction[mine] += strength
        gains[mine] += strength * wall[mine]
        index = np.arange(free.size).reshape(self.free.shape)
        normals = self.one.normals[mine]
        order = np.argsort(-np.abs(normals[:, : self.faces.axes]), axis=1, kind="stable")
        left = np.ones(len(mine), dtype=bool)
        for rank in range(self.faces.axes):
            for axis in range(self.faces.axes):
                base = self.base[axis].ravel()
                for way in (-1, 1):
                    other = np.roll(index, -way, axis=2 - axis).ravel()[mine]
                    place = mine if way < 0 else other
                    fits = left & (order[:, rank] == axis) & (way * normals[:, axis] > 0.0)
                    fits &= free[other] & (base[place] > 0.0)
                    here, there, tie = mine[fits], other[fits], place[fits]
                    ratio = np.minimum(depth[here] / depth[there], 1.0)
                    flat[axis][tie] += strength * ratio
                    beyond = self._wall(self.one.centers[there])
                    friction[here] -= strength * ratio
                    gains[here] -= strength * ratio * beyond
                    np.add.at(friction, there, strength * ratio * (ratio - 1.0))
                    np.add.at(gains, there, strength * ratio * (ratio * beyond - wall[here]))
                    left &= ~fits

    def _largest(self, axis: int) -> float:
        return float(self.base[axis].max(initial=0.0))


def skin(solids: Solids, component: int, ties: Sequence[Floats], velocity: Callable[[Floats, int], Floats]) -> Skin:
    """The viscous operator of a component with solids; ``ties``: that without solids, along x, y, z.

    ``velocity``: from points (k, 3) and a component to the nearest wall's velocity (k,) [m/s].
    """
    return _Component(solids, component, ties, velocity).skin()


def seeping(solids: Solids, velocity: Callable[[Floats, int], Floats], areas: Floats) -> Floats:
    """Volume flux (cells,) [m^3/s] that moving walls displace through each cell's open faces (``areas`` by face).

    Computed as the outflow of the walls' velocity, extended into the fluid, minus that of the uncut cell. The sum over
    all cells is made zero, since tangentially moving walls displace nothing.
    """
    faces = solids.faces
    found = np.zeros(faces.cells.shape[::-1])
    alive = np.zeros(found.shape, dtype=bool)
    for component in range(faces.axes):
        index, line = faces.index(component), 2 - component
        count = faces.cells.shape[component]
        through = areas[index] * velocity(solids.opened[component].centers, component).reshape(index.shape)
        whole = faces.areas[component] * velocity(faces.points(component), component).reshape(index.shape)
        for high in range(2):
            shift = [np.roll(one, -1, axis=line) if high else one for one in (through, whole)]
            ends = [one.take(range(count), axis=line) for one in shift]
            alive |= np.roll(areas[index], -high, axis=line).take(range(count), axis=line) > 0.0
            found += (2 * high - 1) * (ends[0] - solids.parts.reshape(found.shape) * ends[1])
    found = np.where(alive, found, 0.0)
    beside = np.abs(found)
    found -= beside * (found.sum() / max(beside.sum(), 1e-300))
    return found.ravel()
