"""Force and torque of a flow on solids, as the momentum and angular momentum that the fluid loses at their walls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows import layout

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout
    from sceneql.system import ModelState


def on_solid(
    what: str, number: int, cells: FieldLayout, ints: tuple[int, ...], density: float, state: ModelState
) -> Floats:
    """`force` (3,) [N] on the solid of a number, or `torque` (3,) [N m] about the origin."""
    force, torque = np.zeros(3), np.zeros(3)
    floats, axes = state.floats, ints[layout.AXES]
    count = ints[layout.FACES]
    owners = floats[ints[layout.OWNERS] : ints[layout.OWNERS] + count + cells.count]
    pressure = density * floats[ints[layout.PRESSURE] : ints[layout.PRESSURE] + cells.count]
    pressure = np.where(owners[count:] == number, pressure, 0.0).reshape(cells.shape[::-1])
    centers = cells.centers()
    carried = _carried_in(ints, state)
    for axis in range(axes):
        shape = _shape(axis, cells, ints)
        first, n = ints[layout.STARTS + axis], int(np.prod(shape))
        areas = floats[ints[layout.AREAS] + first : ints[layout.AREAS] + first + n].reshape(shape)
        low = areas.take(range(cells.shape[axis]), axis=2 - axis)
        high = np.roll(areas, -1, axis=2 - axis).take(range(cells.shape[axis]), axis=2 - axis)
        pushed = (pressure * (low - high)).ravel()
        mine = owners[first : first + n] == number
        brought = density * np.where(mine, carried[first : first + n], 0.0)
        points = _points(axis, cells, ints, floats)
        for strength, places in ((pushed, centers), (brought, points)):
            force[axis] += strength.sum()
            torque += np.cross(places * strength[:, None], np.eye(3)[axis]).sum(axis=0)
        force[axis] += density * _lost(axis, np.ones(n), mine, cells, ints, state)
        for turn in range(3):
            rigid = np.cross(np.eye(3)[turn], points)[:, axis]
            torque[turn] += density * _lost(axis, rigid, mine, cells, ints, state)
    return force if what == "force" else torque


def _shape(axis: int, cells: FieldLayout, ints: tuple[int, ...]) -> tuple[int, ...]:
    """Numbers of a component's faces along z, y, x."""
    shape = list(cells.shape)
    shape[axis] += not ints[layout.PERIODIC + axis]
    return tuple(shape[::-1])


def _points(axis: int, cells: FieldLayout, ints: tuple[int, ...], floats: Floats) -> Floats:
    """Centroids (m, 3) [m] of the open parts of a component's faces."""
    shape, first = _shape(axis, cells, ints), ints[layout.STARTS + axis]
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij")[::-1], axis=-1).reshape(-1, 3) + 0.5
    index[:, axis] -= 0.5
    points: Floats = np.array(cells.low) + index * np.array(cells.spacing)
    if ints[layout.AXES] == 2:
        points[:, 2] = 0.0
    at, count = ints[layout.MIDDLES], ints[layout.CUT_FACES]
    faces, *places = floats[at : at + 4 * count].reshape(4, count)
    mine = (faces >= first) & (faces < first + len(points))
    points[faces[mine].astype(int) - first] = np.stack(places, axis=1)[mine]
    return points


def _carried_in(ints: tuple[int, ...], state: ModelState) -> Floats:
    """Momentum over density (faces,) [m^4/s^2] advected per second into control volumes of closed faces.

    The solid takes it up.
    """
    from sceneql.flows.advection_kernels import advected

    count, at = ints[layout.FACES], ints[layout.AT]
    floats, rate = state.floats.copy(), np.zeros(len(state.y))
    floats[ints[layout.INVERSES] : ints[layout.INVERSES] + count] = 1.0
    advected(state.y, rate, floats, np.array(ints))
    shut = floats[ints[layout.AREAS] : ints[layout.AREAS] + count] == 0.0
    carried = rate[at : at + count]
    if ints[layout.LED] > 0:  # without what a moving wall had given itself
        carried = carried + _pushed(ints, floats) * state.y[at : at + count]
    found: Floats = np.where(shut, carried, 0.0)
    return found


def _pushed(ints: tuple[int, ...], floats: Floats) -> Floats:
    """Volume flux (faces,) [m^3/s] that walls displace through each face's control volume."""
    shape = ints[layout.CELLS : layout.CELLS + 3]
    at = ints[layout.SEEPING]
    out = floats[at : at + int(np.prod(shape))].reshape(shape[::-1])
    found = []
    for axis in range(ints[layout.AXES]):
        line = 2 - axis
        if ints[layout.PERIODIC + axis]:
            found.append(0.5 * (out + np.roll(out, 1, axis=line)))
        else:
            wide = np.pad(out, [(1, 1) if k == line else (0, 0) for k in range(3)])
            n = shape[axis]
            found.append(0.5 * (wide.take(range(n + 1), axis=line) + wide.take(range(1, n + 2), axis=line)))
    return np.concatenate([one.ravel() for one in found])


def _lost(
    axis: int, field: Floats, owned: Floats, cells: FieldLayout, ints: tuple[int, ...], state: ModelState
) -> float:
    """Rate at which walls take up sum(field * momentum) of a component, over the density [m^4/s^2 times the field].

    ``field`` (m,): a component of a rigid motion, which viscosity leaves unchanged away from walls. By the symmetry of
    the viscous operator the rate is the velocities times the operator applied to the field beside the walls, less the
    walls' own contributions.
    """
    floats = state.floats
    shape, first = _shape(axis, cells, ints), ints[layout.STARTS + axis]
    n = int(np.prod(shape))

    def by_face(at: int) -> Floats:
        found: Floats = floats[at + first : at + first + n].reshape(shape)
        return found

    u = state.y[ints[layout.AT] + first : ints[layout.AT] + first + n].reshape(shape)
    own = field.reshape(shape)
    shut = by_face(ints[layout.AREAS]) == 0.0
    friction, gains = by_face(ints[layout.FRICTION]).copy(), by_face(ints[layout.GAINS]).copy()
    passed = np.zeros(shape)
    for other in range(ints[layout.AXES]):
        ties, line = by_face(ints[layout.VISCOUS + other]), 2 - other
        for way in (1, -1):
            tie = ties if way > 0 else np.roll(ties, -1, axis=line)
            behind = np.roll(shut, way, axis=line)
            friction += np.where(behind, tie, 0.0)
            gains += np.where(behind, tie * np.roll(u, way, axis=line), 0.0)
            passed += np.where(behind, 0.0, tie * (np.roll(own, way, axis=line) - own))
    mine = owned.reshape(shape) & ~shut & (friction != 0.0)
    return float(np.where(mine, (friction * own - passed) * u - own * gains, 0.0).sum())
