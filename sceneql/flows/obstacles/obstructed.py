"""Geometry and viscous operator of a flow's faces: areas, control volumes, ties; without and with solids."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.obstacles.no_slip import seeping, skin
from sceneql.flows.obstacles.no_slip_numbers import LEAST

if TYPE_CHECKING:
    from sceneql.flows.obstacles.obstacles import Solids
    from sceneql.flows.obstacles.skin_velocities import SkinVelocities
    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Passage:
    """Data of a flow's faces; arrays are (faces,) unless stated."""

    areas: Floats
    """[m^2] open area."""
    volumes: Floats
    """[m^3] inertia of the face's control volume, divided by the density."""
    fills: Floats
    """Volume of fluid over ``volumes``, which small control volumes enlarge: the factor of a body force."""
    ties: tuple[Floats, ...]
    """For each axis [m^3/s]: kinematic viscous conductance to the face before."""
    friction: Floats
    """[m^3/s] viscous conductance to the walls of solids."""
    gains: Floats
    """[m^4/s^2] contribution of these walls' velocity."""
    walls: Floats
    """[m/s] these walls' velocity along the face's axis."""
    edges: Floats
    """Factor that solids leave of a tie to an edge on the box's wall."""
    seeping: Floats | None
    """(cells,) [m^3/s] volume flux that moving walls displace through the open faces; None where no wall moves."""


def whole(faces: Faces, areas: Floats, volumes: Floats, viscosity: float) -> Passage:
    """The faces without solids; kinematic viscosity [m^2/s]."""
    zeros, ones = np.zeros(faces.count), np.ones(faces.count)
    ties = tuple(_ties(faces, axis, viscosity) for axis in range(faces.axes))
    return Passage(areas, volumes, ones, ties, zeros, zeros, zeros, ones, None)


def _ties(faces: Faces, axis: int, viscosity: float) -> Floats:
    """Viscous conductance (faces,) [m^3/s] to the face before along an axis; 0 where there is none."""
    spacing = faces.cells.spacing
    strength = faces.volume / spacing[axis] ** 2 * viscosity
    found = []
    for component in range(faces.axes):
        widths = 1.0 if axis == component else faces.own_widths(component)
        tie = np.full(faces.shapes[component], strength) * widths
        if not faces.periodic[axis]:
            tie[tuple(0 if k == 2 - axis else slice(None) for k in range(3))] = 0.0
        found.append(tie.ravel())
    return np.concatenate(found)


def obstructed(solids: Solids, skins: SkinVelocities, open_: Passage, viscosity: float) -> Passage:
    """The faces ``open_`` cut by solids; kinematic viscosity [m^2/s]."""
    faces = solids.faces
    parts = solids.face_parts()
    areas = open_.areas * parts
    if solids.staircase:
        return _stepped(solids, skins, open_, areas)
    ties = [tie.copy() for tie in open_.ties]
    friction, gains, edges = (np.zeros(faces.count) for _ in range(3))
    rows, moving = np.zeros(faces.count), skins.formulas != []
    for component in range(faces.axes):
        mine = faces.index(component).ravel()
        own = skin(solids, component, [tie[mine] for tie in open_.ties], skins.at)
        friction[mine], gains[mine], edges[mine] = own.friction.ravel(), own.gains.ravel(), own.scale.ravel() ** 2
        row = own.friction.copy()
        for axis, tie in enumerate(own.ties):
            ties[axis][mine] = tie.ravel()
            row += 2.0 * (tie + np.roll(tie, -1, axis=2 - axis))
        rows[mine] = np.where((own.friction != 0.0) | (own.scale != 1.0), row, 0.0).ravel()
    fastest = 4.0 * viscosity * float((1.0 / faces.cells.spacing[: faces.axes] ** 2).sum())
    least = rows / fastest if fastest > 0.0 else 0.0  # the explicit step limit stays that of open faces
    full = open_.volumes * parts
    volumes = np.maximum(np.maximum(full, LEAST * open_.volumes), least)
    walls = np.concatenate([skins.at(faces.points(axis), axis) for axis in range(faces.axes)])
    pushed = seeping(solids, skins.at, areas) if moving else None
    return Passage(areas, volumes, full / volumes, tuple(ties), friction, gains, walls, edges, pushed)


def _stepped(solids: Solids, skins: SkinVelocities, open_: Passage, areas: Floats) -> Passage:
    """The faces cut by solids of whole cells (staircase)."""
    faces = solids.faces
    ties = [tie.copy() for tie in open_.ties]
    for axis, tie in enumerate(ties):
        for component in range(faces.axes):
            index = faces.index(component)
            tie[index] *= solids.steps(component, axis, areas[index] == 0.0)
    walls = np.concatenate([skins.at(faces.points(axis), axis) for axis in range(faces.axes)])
    return replace(open_, areas=areas, ties=tuple(ties), walls=walls)
