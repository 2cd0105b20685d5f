"""mesh: triangles from an OBJ file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from pydantic import field_validator

from sceneql.doing import doing
from sceneql.kinds import Collider, Exceeds, File, FixedAngle, Moment, field
from sceneql.shapes.placement import Placed, Scale, affine, apply, compose
from sceneql.shapes.read_mesh import LARGEST_FILE, Loaded, load

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly


class Mesh(Placed):
    """Triangles of an OBJ file. Edges that turn by less than `crease` are shaded smooth, others stay sharp.

    It has no field, so it is no member of a union, intersection or difference; it can be collided
    with, filled, and be the domain of a field: holes are closed, and told. A file of more than 64 MiB or 4 million
    triangles is refused.
    """

    imports: ClassVar[tuple[str, ...]] = ("trimesh",)

    file: File = field("Path of the OBJ file, inside the scene's folder.")
    scale: Scale = field("Factor on the file's numbers, which are taken as meters, or three.", "1", above=0)
    crease: FixedAngle = field("Edges that turn by more stay sharp.", "40 deg", at_least=0)

    @field_validator("file")
    @classmethod
    def _is_no_giant(cls, file: str) -> str:
        size = Path(file).stat().st_size
        if size > LARGEST_FILE:
            raise Exceeds(f"{file} has {size} bytes; a mesh may have {LARGEST_FILE}")
        return file

    def _load(self) -> Loaded:
        """The file's triangles. Raises ValueError for a file that is no mesh."""
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
        loaded = self._load()
        corners: Floats = apply(self.local(moment), loaded.vertices)[loaded.triangles]
        return corners

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its vertices."""
        vertices = apply(compose(place, self.local(moment)), self._load().vertices)
        return vertices.min(axis=0), vertices.max(axis=0)

    def holes(self) -> str:
        """Those of its triangles. Raises ValueError for a file that is no mesh."""
        from sceneql.mesh.holes import described

        loaded = self._load()
        return described(loaded.vertices, loaded.triangles)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its triangles in the world. Raises ValueError for a file that is no mesh, LimitRefused for too many."""
        from sceneql.frame import Mesh as Triangles
        from sceneql.shapes.placed_triangles import still

        made = still(self._load(), name, compose(place, self.local(moment)), moment)
        surface = moment.surface(name, self.material, self.color)
        yield Triangles(name, surface, made.vertices, made.triangles, made.normals)

    def collider(self, assembly: Assembly) -> Collider:
        """Its triangles. Raises ValueError for a mesh that is open, or whose scale varies."""
        from sceneql.contacts.shapes.mesh import collider

        if not self.scale.constant:
            raise ValueError("a mesh whose scale varies in time cannot be collided with")
        loaded = self._load()
        vertices = loaded.vertices * assembly.initial(self.scale)
        place = assembly.value(self.position), assembly.value(self.rotation)
        return collider(vertices, loaded.triangles, *place, assembly)
