"""Contact skins: points of a shape's surface, and its field, for contacts of curved or nonconvex shapes.

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from math import inf
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.contacts import layout
from sceneql.contacts.distance.convex import CORE, SKINNED, Convex
from sceneql.contacts.shapes import implicit
from sceneql.doing import doing
from sceneql.island.start import Start
from sceneql.kinds import Object, Ref
from sceneql.mesh.box_tree import box_tree
from sceneql.shapes.placement import UPRIGHT, Placed, rotation_matrix

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Collider
    from sceneql.system import Assembly

LEAF = 8
"""Largest number of points in a leaf of the box tree."""
PIECES = 8
"""Number of pieces of the longest straight edge that a polyhedron can have."""
ON_BALL = 400
"""Number of points on a ball."""


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points of a surface in the object's axes; spacing of the points and thickness of the solid [m]."""

    edges: Floats
    """(n, 12): records of points on edges and corners (contact_skin_kernels.RECORD)."""
    smooth: Floats
    """(m, 12): records of points on the smooth surface."""
    spacing: float
    thickness: float


def skin_of(ref: Ref, center: Floats, shape: Convex | None, place: Floats | None, assembly: Assembly) -> Skin:
    """Skin of an object: of a body with ``center`` (3,) [m] in the object's axes, or of one that starts at ``place``.

    ``shape``: its convex shape from the center, if it has one; ``place`` (7,): position and quaternion.
    Raises TypeError and ValueError for an object without an inside.
    """
    kind: Any = assembly.object(ref)
    if isinstance(kind, Placed):
        kind = kind.model_copy(update={"position": implicit.ORIGIN, "rotation": UPRIGHT})
    own = type(kind).collider is not Object.collider
    with doing(f"looking at the surface of {ref.name}"):
        collider = kind.collider(assembly) if own else implicit.collider(cast(Object, kind), assembly)
        if place is not None and not isinstance(kind, Placed):
            turn = rotation_matrix(place[3:])
            center = turn.T @ (place[:3] - assembly.numbers()[collider.position_at :][:3])
        known = _points_of_convex(shape, center) if shape is not None else _points(kind, collider, assembly)
    return Skin(collider, center, known, shape is not None and shape.kind != CORE)


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """Shape as points of its surface and a field."""

    collider: Collider
    center: Floats
    """(3,) [m]: center of the body, in the object's axes."""
    points: Points
    unbounded: bool

    @property
    def reach(self) -> float:
        """Distance of the farthest point from the center [m]; infinite for a half space."""
        every = np.concatenate([self.points.edges, self.points.smooth])
        return inf if self.unbounded else float(np.linalg.norm(every[:, :3] - self.center, axis=1).max())

    def shape(self) -> Convex:
        """Ball around the skin, in place of a convex shape, for its swept boxes."""
        floats = np.concatenate([[self.reach, self.reach], np.zeros(3)])
        return Convex(SKINNED, floats, np.array([1, 0, 0, 0, 0], dtype=np.int64))

    def written(self, at: int, assembly: Assembly) -> list[int]:
        """Integers of the skin, to stand at index ``at``: by contact_skin_kernels, of its object, of its trees."""
        from sceneql.compiled.numbered_kernels import number_of
        from sceneql.contacts.distance import contact_skin_kernels as kernels
        from sceneql.contacts.shape_kernels import SURFACE_TYPE

        field = import_module(self.collider.kernels).surface
        pose = assembly.floats([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        head = [0] * kernels.SKIN
        head[kernels.FIELD_AT] = at + kernels.SKIN
        head[kernels.CENTER_AT], head[kernels.POSE_AT] = assembly.floats(self.center), pose
        low, high = np.full(3, -inf), np.full(3, inf)
        if not self.unbounded:
            every = np.concatenate([self.points.edges, self.points.smooth])[:, :3] - self.center
            room = self.points.spacing
            low, high = every.min(axis=0) - room, every.max(axis=0) + room
        sizes = [*low, *high, self.points.spacing, self.points.thickness]
        head[kernels.SIZES_AT] = assembly.floats(sizes)
        where = [0] * layout.OBJECT
        where[layout.SURFACE] = number_of(field, SURFACE_TYPE)
        where[layout.PLACE], where[layout.ROTATION] = pose, pose + 3
        where[layout.SIZE], where[layout.DEPTH] = self.collider.size_at, self.collider.depth_at
        where[layout.FLAT] = int(self.collider.flat)
        where[layout.DATA] = at + kernels.SKIN + layout.OBJECT
        tail = [*where, *self.collider.data]
        for tree, records in ((kernels.EDGES_AT, self.points.edges), (kernels.SMOOTH_AT, self.points.smooth)):
            if not len(records):
                continue
            mine = records.copy()
            mine[:, :3] -= self.center
            ends = 1.2 * mine[:, kernels.AT_ALONG : kernels.AT_ALONG + 3]
            corners = np.stack([mine[:, :3] - ends, mine[:, :3] + ends, mine[:, :3]], axis=1)
            order, boxes, links = box_tree(corners, LEAF)
            head[tree + kernels.BOXES], head[tree + kernels.NODES] = assembly.floats(boxes), len(boxes)
            head[tree + kernels.POINTS] = assembly.floats(mine[order])
            head[tree + kernels.LINKS] = at + kernels.SKIN + len(tail)
            tail += links.ravel().tolist()
        return [*head, *tail]


def _records(places: Floats, normals: Floats | None = None, along: Floats | None = None) -> Floats:
    found = np.zeros((len(places), 12))
    found[:, :3] = places
    if normals is not None:
        found[:, 3:6] = normals
    if along is not None:
        found[:, 6:9] = along
    return found


def _points_of_convex(shape: Convex, center: Floats) -> Points:
    """Points of a convex shape: corners and edges of a polyhedron, points all over a ball, none of a half space."""
    none = np.zeros((0, 12))
    if shape.kind != CORE:
        return Points(none, none, inf, inf)
    _, f, e, loops = (int(number) for number in shape.ints[:4])
    radius, vertices = shape.radius, shape.vertices + center
    if f == 0:
        turn = np.pi * (3 - np.sqrt(5)) * np.arange(ON_BALL)
        z = 1 - (2 * np.arange(ON_BALL) + 1) / ON_BALL
        normals = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), z, np.sqrt(1 - z * z) * np.sin(turn)])
        spacing = radius * np.sqrt(4 * np.pi / ON_BALL)
        return Points(none, _records(vertices[0] + radius * normals, normals), spacing, radius)
    edges = shape.ints[5 + f + loops :].reshape(e, 4)[:, :2]
    normals = shape.normals
    starts, ring = shape.ints[4 : 5 + f], shape.ints[5 + f : 5 + f + loops]
    inside = [float(normals[k] @ vertices[ring[starts[k]]] - (vertices @ normals[k]).min()) for k in range(f)]
    size = 2.0 * float(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1).max())
    return Points(
        np.concatenate([_records(vertices), _cut(vertices[edges], size / PIECES)]),
        none,
        size / PIECES,
        0.5 * min(inside),
    )


def _cut(ends: Floats, longest: float) -> Floats:
    """Records of edges (e, 2, 3) [m], cut into pieces no longer than ``longest`` [m]."""
    found = [np.zeros((0, 12))]
    for a, b in ends:
        pieces = max(1, int(np.ceil(np.linalg.norm(b - a) / longest)))
        middles = a + (np.arange(pieces)[:, None] + 0.5) / pieces * (b - a)
        found.append(_records(middles, along=np.tile(0.5 * (b - a) / pieces, (pieces, 1))))
    return np.concatenate(found)


def _points(kind: Any, collider: Collider, assembly: Assembly) -> Points:
    """Points of any object with an inside."""
    triangles = getattr(kind, "triangles_at", None)
    if triangles is not None:
        return _points_of_mesh(triangles(Start(assembly)))
    from sceneql.contacts.distance.skin_points import points_of_field

    edges, smooth, spacing, thickness = points_of_field(kind, collider, assembly)
    return Points(edges, smooth, spacing, thickness)


def _points_of_mesh(corners: Floats) -> Points:
    """Points on the convex edges of a mesh and at their corners."""
    from sceneql.contacts.shapes.closed_mesh import closed
    from sceneql.mesh.holes import welded
    from sceneql.mesh.measures import area, volume

    made = closed(corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3))
    numbers = np.arange(3 * len(made.corners), dtype=np.int32)
    vertices, triangles = welded(made.corners.reshape(-1, 3), numbers.reshape(-1, 3))
    beside: dict[tuple[int, int], int] = {}
    for number, (a, b, c) in enumerate(triangles.tolist()):
        beside |= {(a, b): number, (b, c): number, (c, a): number}
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    edges = []
    for (i, j), one in beside.items():
        other = beside.get((j, i))
        if other is None or i > j:
            continue
        across = np.cross(normals[one], normals[other]) @ (vertices[j] - vertices[i])
        if across > 1e-9 * np.linalg.norm(vertices[j] - vertices[i]):
            edges.append((i, j))
    pairs = np.array(edges, dtype=np.int64).reshape(-1, 2)
    kept = np.unique(pairs)
    size = float(np.ptp(vertices, axis=0).max())
    thickness = 2.0 * abs(volume(vertices, triangles)) / area(vertices, triangles)
    records = np.concatenate([_records(vertices[kept]), _cut(vertices[pairs], size / PIECES)])
    return Points(records, np.zeros((0, 12)), size / PIECES, 0.5 * thickness)
