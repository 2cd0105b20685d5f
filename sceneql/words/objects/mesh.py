"""mesh: triangles from a file."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import field_validator

from sceneql.doing import doing
from sceneql.kinds import Collider, File, FixedAngle, Moment, Shaped, VolumeMoments, field
from sceneql.shapes.mesh_header import declared
from sceneql.shapes.placement import Placed, Scale, affine, apply, compose
from sceneql.shapes.read_mesh import Loaded, load

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly


CONVEX = 1e-6
"""Largest empty fraction of a mesh's convex hull for which it counts as convex."""


class Mesh(Placed):
    """Triangles of a file: OBJ, PLY, STL, OFF, GLB or glTF with all its numbers inside (.gltf). Lengths are in meters.

    Edges that turn by less than `crease` are shaded smooth, others stay sharp. Where neither `color` nor `material` is
    given, it has the colors that the file has at its vertices. Nodes of a GLB stand where they are placed; textures,
    points and lines are left out, and no other file is read. Faces of an OBJ may be concave, those of other files are
    taken as convex, and all of a binary PLY have as many corners. It has no field, so it is no member of a union,
    intersection or difference; it can be collided with, filled, and be the domain of a field: holes are closed, and
    told. A file may have 4 million triangles, and 1 GiB as OBJ, 512 MiB as binary PLY, STL or GLB, 64 MiB as other
    text, 16 MiB as .gltf.
    """

    imports: ClassVar[tuple[str, ...]] = ("trimesh",)

    file: File = field("Path of the file, inside the scene's folder; its ending names the format.")
    scale: Scale = field("Factor on the file's numbers, which are taken as meters, or three.", "1", above=0)
    crease: FixedAngle = field("Edges that turn by more stay sharp.", "40 deg", at_least=0)

    @field_validator("file")
    @classmethod
    def _can_be_read(cls, file: str) -> str:
        try:
            declared(file)
        except OSError as error:
            raise ValueError(str(error)) from error
        return file

    @cached_property
    def _loaded(self) -> Loaded:
        """Triangles of the file, the same for a whole run. Raises ValueError for a file that is no mesh."""
        try:
            with doing(f"reading {Path(self.file).name}"):
                return load(self.file, self.crease)
        except OSError as error:
            raise ValueError(str(error)) from error

    def local(self, moment: Moment) -> Floats:
        """(3, 4) map from the file's coordinates to its parent's."""
        return affine(moment.at(self.position), moment.at(self.rotation), moment.at(self.scale))

    def triangles_at(self, moment: Moment) -> Floats:
        """(m, 3, 3) corners of its triangles in its parent's coordinates, for what fills it."""
        loaded = self._loaded
        corners: Floats = apply(self.local(moment), loaded.vertices)[loaded.triangles]
        return corners

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its vertices."""
        vertices = apply(compose(place, self.local(moment)), self._loaded.vertices)
        return vertices.min(axis=0), vertices.max(axis=0)

    def holes(self) -> str:
        """Those of its triangles. Raises ValueError for a file that is no mesh."""
        from sceneql.mesh.holes import described

        loaded = self._loaded
        return described(loaded.vertices, loaded.triangles)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its triangles in the world. Raises ValueError for a file that is no mesh, LimitRefused for too many."""
        from sceneql.frame import Mesh as Triangles
        from sceneql.shapes.placed_triangles import still

        made = still(self._loaded, name, compose(place, self.local(moment)), moment)
        surface = moment.surface(name, self.material, self.color)
        colors = self._loaded.colors if self.color is None and self.material is None else None
        yield Triangles(name, surface, made.vertices, made.triangles, made.normals, colors)

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments:
        """By the divergence theorem. Raises ValueError for a mesh that is open or turned inside out."""
        from sceneql.mesh.polyhedra import moments

        loaded = self._loaded
        return moments(loaded.vertices, loaded.triangles).mapped(self.local(moment))

    def convex(self, moment: Moment, center: Floats) -> Any:
        """The convex hull of its vertices, where it fills that. Raises ValueError where it does not."""
        import numpy as np
        from scipy.spatial import ConvexHull

        from sceneql.contacts.distance.convex import hull
        from sceneql.mesh.polyhedra import moments

        points = self._loaded.vertices * np.asarray(moment.at(self.scale))
        whole, own = ConvexHull(points).volume, moments(points, self._loaded.triangles).volume
        if own < (1 - CONVEX) * whole:
            raise ValueError(f"it fills {100 * own / whole:.3g}% of its convex hull")
        return hull(points - center)

    def collider(self, assembly: Assembly) -> Collider:
        """Its triangles. Raises ValueError for a mesh that is open, or whose scale varies."""
        from sceneql.contacts.shapes.mesh import collider

        if not self.scale.constant:
            raise ValueError("a mesh whose scale varies in time cannot be collided with")
        loaded = self._loaded
        vertices = loaded.vertices * assembly.initial(self.scale)
        place = assembly.value(self.position), assembly.value(self.rotation)
        return collider(vertices, loaded.triangles, *place, assembly)
