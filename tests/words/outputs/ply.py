"""ply: shapes as PLY files."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, ClassVar

from sceneql.files import whole
from sceneql.kinds import Clock, DrawnRef, FixedLength, Moment, Output, Ref, Sink, Tools, field


class Ply(Output):
    """The objects of a frame that have an inside, as triangles in a PLY file for each frame."""

    draws: ClassVar[bool] = True

    show: tuple[DrawnRef, ...] | None = field("Writes only these parts.", None)
    cell: FixedLength = field("Side of the cubes that triangles are made by.", "0.05 m", above=0)

    def shown(self) -> tuple[Ref, ...] | None:
        """What `show` names; nothing else is computed."""
        return self.show

    def times(self, clock: Clock) -> list[float]:
        """Those of a film's frames."""
        return clock.frames(clock.fps)

    def open(self, tools: Tools) -> Sink:
        """Nothing is written before the first frame."""
        return Files(self, tools)


class Files:
    """The files of one run."""

    def __init__(self, ply: Ply, tools: Tools) -> None:
        self.ply, self.tools, self.made = ply, tools, []

    def take(self, moment: Moment) -> None:
        """One frame, one file. Without ``fields=True`` the shapes come as they are drawn: spheres, meshes, lines."""
        import trimesh

        from sceneql.frame import Implicit
        from sceneql.mesh.facets import faceted

        frame = self.tools.frame(moment, fields=True)
        meshes = [faceted(shape, self.ply.cell, smooth=False) for shape in frame.shapes if isinstance(shape, Implicit)]
        joined = trimesh.util.concatenate([trimesh.Trimesh(m.vertices, m.triangles) for m in meshes])
        with whole(self.tools.path(f"{frame.index:04d}.ply")) as stream:
            stream.write(joined.export(file_type="ply"))
        self.made.append(self.tools.path(f"{frame.index:04d}.ply"))

    def close(self) -> Iterable[Any]:
        """All are whole already."""
        return self.made

    def abort(self) -> Iterable[Any]:
        """All that were written stay."""
        return self.made
