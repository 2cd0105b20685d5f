"""Force and torque of a flow on the solids in it: what the momentum of the fluid loses at their walls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows import layout
from sceneql.flows.edges import component_at

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout
    from sceneql.kinds import Formula
    from sceneql.system import ModelState


def on_solid(
    what: str, number: int, cells: FieldLayout, ints: tuple[int, ...], fluid: tuple[float, float],
    wall: Formula | None, state: ModelState,
) -> Floats:  # fmt: skip
    """(3,) `force` [N] on a solid, or `torque` about the origin [N m].

    ``fluid``: density [kg/m^3] and viscosity [Pa s]; ``wall``: the velocity of its wall. Where that turns, the stress
    viscosity (grad u + its transpose) has a second part, which moves no momentum and yet twists the solid.
    """
    density, viscosity = fluid
    force, torque = np.zeros(3), np.zeros(3)
    floats, axes = state.floats, ints[layout.AXES]
    count = ints[layout.FACES]
    owners = floats[ints[layout.OWNERS] : ints[layout.OWNERS] + count + cells.count]
    pressure = density * floats[ints[layout.PRESSURE] : ints[layout.PRESSURE] + cells.count]
    pressure = np.where(owners[count:] == number, pressure, 0.0).reshape(cells.shape[::-1])
    centers = cells.centers()
    carried = _carried_in(ints, state)
    slopes = _slopes(wall, centers, cells, axes)
    for axis in range(axes):
        shape = list(cells.shape)
        shape[axis] += not ints[layout.PERIODIC + axis]
        first, n = ints[layout.STARTS + axis], int(np.prod(shape))
        mine = slice(ints[layout.AREAS] + first, ints[layout.AREAS] + first + n)
        areas = floats[mine].reshape(shape[::-1])
        if ints[layout.PERIODIC + axis]:
            low, high = areas, np.roll(areas, -1, axis=2 - axis)
        else:
            low, high = (
                areas.take(range(shape[axis] - 1), axis=2 - axis),
                areas.take(range(1, shape[axis]), axis=2 - axis),
            )
        pushed = (pressure * (low - high)).ravel()
        mine_by_face = owners[first : first + n]
        dragged, points = _dragged(axis, number, cells, ints, density, state, mine_by_face)
        dragged += density * np.where(mine_by_face == number, carried[first : first + n], 0.0)
        for strength, places in ((pushed, centers), (dragged, points)):
            force[axis] += strength.sum()
            torque += np.cross(places * strength[:, None], np.eye(3)[axis]).sum(axis=0)
        outward = np.where(owners[count:] == number, (high - low).ravel(), 0.0)
        for other in range(axes):
            twist = viscosity * slopes[other, axis] * outward
            torque += np.cross(centers * twist[:, None], np.eye(3)[other]).sum(axis=0)
    return force if what == "force" else torque


def _slopes(wall: Formula | None, centers: Floats, cells: FieldLayout, axes: int) -> Floats:
    """(i, j, cells): the derivative by x_i of the wall's velocity along j, beside the centers of cells [1/s]."""
    found = np.zeros((axes, axes, len(centers)))
    for i in range(axes if wall is not None else 0):
        assert wall is not None
        step = 0.5 * np.array(cells.spacing) * np.eye(3)[i]
        for j in range(axes):
            ends = [component_at(wall, j, centers + way * step, 0.0) for way in (1, -1)]
            found[i, j] = (ends[0] - ends[1]) / cells.spacing[i]
    return found


def _carried_in(ints: tuple[int, ...], state: ModelState) -> Floats:
    """By face: what is carried into the own cells of shut faces, whose momentum the solid takes [m^4/s^2]."""
    from sceneql.flows.advection_kernels import advected

    count, at = ints[layout.FACES], ints[layout.AT]
    floats, rate = state.floats.copy(), np.zeros(len(state.y))
    floats[ints[layout.INVERSES] : ints[layout.INVERSES] + count] = 1.0
    advected(state.y, rate, floats, np.array(ints))
    shut = floats[ints[layout.AREAS] : ints[layout.AREAS] + count] == 0.0
    found: Floats = np.where(shut, rate[at : at + count], 0.0)
    return found


def _dragged(
    axis: int, number: int, cells: FieldLayout, ints: tuple[int, ...], density: float, state: ModelState, owners: Floats
) -> tuple[Floats, Floats]:
    """Friction of a component by its faces (m,) [N], and where these are (m, 3)."""
    floats = state.floats
    shape = list(cells.shape)
    shape[axis] += not ints[layout.PERIODIC + axis]
    first, n = ints[layout.STARTS + axis], int(np.prod(shape))

    def by_face(at: int) -> Floats:
        found: Floats = floats[at + first : at + first + n].reshape(shape[::-1])
        return found

    u = state.y[ints[layout.AT] + first : ints[layout.AT] + first + n].reshape(shape[::-1])
    shut = by_face(ints[layout.AREAS]) == 0.0
    total = by_face(ints[layout.FRICTION]) * (u - by_face(ints[layout.WALLS]))
    for other in range(ints[layout.AXES]):
        ties, line = by_face(ints[layout.VISCOUS + other]), 2 - other
        total += ties * (u - np.roll(u, 1, axis=line)) * np.roll(shut, 1, axis=line)
        total += np.roll(ties, -1, axis=line) * (u - np.roll(u, -1, axis=line)) * np.roll(shut, -1, axis=line)
    index = np.stack(np.meshgrid(*map(np.arange, shape[::-1]), indexing="ij")[::-1], axis=-1).reshape(-1, 3) + 0.5
    index[:, axis] -= 0.5
    points = np.array(cells.low) + index * np.array(cells.spacing)
    if ints[layout.AXES] == 2:
        points[:, 2] = 0.0
    mine = (owners == number) & ~shut.ravel()
    return density * np.where(mine, total.ravel(), 0.0), points
