"""The command ``mesh``: writes an object of a scene as triangles, and accounts for them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from sceneql import pipeline
from sceneql.failure import Unsuitable, failing_as
from sceneql.files import refuse_unwritable, try_folder
from sceneql.frame import Grid, Implicit
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import suggestion

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from sceneql.frame import Shape, Tape
    from sceneql.graph import SimulationGraph, Task
    from sceneql.mesh.bounded import Corner
    from sceneql.mesh.cubes.tolerance import Within
    from sceneql.mesh.cubes.unresolved import Unresolved
    from sceneql.mesh.polygons import Polygons
    from sceneql.run.instant import Instant

CELLS = 128
"""Default number of cells along the longest side of an object's box."""
COARSE = 16
"""The same at the beginning of the search for a tolerance."""


@dataclass(frozen=True, slots=True)
class Account:
    """The account of a written mesh."""

    file: Path
    vertices: int
    triangles: int
    cell: float
    """[m]"""
    euler: int
    volume: float
    """[m^3]"""
    area: float
    """[m^2]"""
    boundary_edges: int
    folded: int
    """Triangles that are folded over (``told``; for sharp meshes ``folds``)."""
    unresolved: int
    """Number of cells in which surface may pass between corners of one sign."""
    unresolved_volume: float
    """[m^3]"""
    missed: float
    """Largest distance found from the surface to all triangles, where it exceeds the tolerance; else 0 [m]."""

    def text(self) -> str:
        """The account as lines of text."""
        lines = [
            f"made {self.file}",
            f"{self.triangles} triangles, {self.vertices} vertices, cells of {self.cell:.4g} m",
            f"Euler characteristic {self.euler}, volume {self.volume:.8g} m^3, area {self.area:.8g} m^2",
        ]
        if self.boundary_edges:
            lines.append(f"{self.boundary_edges} edges of one triangle: the mesh is open")
        if self.folded:
            triangles = "1 triangle is" if self.folded == 1 else f"{self.folded} triangles are"
            lines.append(
                f"{triangles} folded over, where the surface is finer than cells; a smaller --cell leaves fewer"
            )
        if self.unresolved:
            cells = "1 cell" if self.unresolved == 1 else f"{self.unresolved} cells"
            lines.append(
                f"{cells} unresolved, {self.unresolved_volume:.3g} m^3 in all: not proved to hold no surface that"
                " passes between their corners; a smaller --cell resolves more"
            )
        if self.missed:
            lines.append(
                f"the tolerance is not kept: there is surface {self.missed:.3g} m from the triangles, which passes"
                " between the corners of cells, and shorter ones would be too many"
            )
        return "\n".join(lines)


def mesh(
    graph: SimulationGraph, name: str, output: Path, *, cell: float | None = None, tolerance: float | None = None,
    time: float = 0.0, sharp: bool = False,
) -> Account:  # fmt: skip
    """Polygonise an object at an instant [s] by cells [m], or by cells that keep within a distance [m] of the surface.

    With ``sharp``, edges and corners are kept. A surface on a field's grid has cells of its own. Raises OSError,
    Unsuitable for something that is no object or file, and RunFailure for an object that has no inside, is empty or
    unbounded, or needs too many cells.
    """
    from sceneql.mesh.write_mesh import format_of, write

    format_of(output)
    refuse_unwritable(output, graph.origin.files)
    try_folder(output.parent)
    if not 0.0 <= time <= graph.settings.clock.end:
        raise Unsuitable(f"the scene ends at {graph.settings.clock.end:g} s, so there is nothing at {time:g} s")
    task = _object(graph, name)
    moment = next(pipeline.simulate(graph, [time]))
    shapes = pipeline.shapes_of([name], moment, fields=True).shapes
    colors = None
    if grids := [shape for shape in shapes if isinstance(shape, Grid)]:
        if cell is not None or tolerance is not None or sharp:
            raise Unsuitable(f"'{name}' is meshed between the cells of its field, so nothing can be said of cells here")
        from sceneql.grids.maps.iso_mesh import polygons_of

        polygons, cell = polygons_of(grids)
        hidden, missed, folded = None, 0.0, 0
    else:
        from sceneql.mesh.bounded import bounded
        from sceneql.mesh.repair.folds import folds, told

        solid = _solid(shapes, task, name, moment)
        polygons, hidden, cell, missed = _of_solid(solid, task, name, moment.time, cell, tolerance, sharp)
        folded = 0
        if sharp or not polygons.unfolded:
            folded = len((folds if sharp else told)(bounded(solid.tape, solid.low, solid.high), polygons))
        missed = missed if tolerance is not None and missed > tolerance else 0.0
        if solid.paint is not None:
            from sceneql.field.tape.tape_solid import paint_values

            colors = paint_values(solid.paint, polygons.vertices)
    write(output, polygons, colors)
    return _account(output, polygons, cell, hidden, missed, folded)


def _of_solid(
    solid: Implicit, task: Task, name: str, time: float, cell: float | None, tolerance: float | None, sharp: bool
) -> Within:
    """Polygons of a solid, their cell size, and what they do not resolve."""
    from sceneql.mesh.cubes.grid import grid_around
    from sceneql.mesh.cubes.refine import refined
    from sceneql.mesh.cubes.tolerance import Within, polygonise_within
    from sceneql.mesh.dual.kept_sharp import kept_sharp

    box = solid.tape, solid.low, solid.high
    size = max(high - low for low, high in zip(solid.low, solid.high, strict=True))
    if cell is None:
        cell = size / CELLS
    with failing_as(name, time, task.span):
        grid_around(solid.low, solid.high, cell)
        least = cell
        method = kept_sharp if sharp else partial(refined, tolerance=tolerance)
        if tolerance is None:
            polygons, left = method(*box, cell)
            made = Within(polygons, left, (left and left.cell) or cell, 0.0)
        else:
            made = polygonise_within(*box, tolerance, size / COARSE, method)
        while not len(made.polygons.triangles) and made.cell > least:  # nothing is no distance from coarse cells
            cell = max(0.5 * made.cell, least)
            made = Within(*method(*box, cell), cell, 0.0)
        if not len(made.polygons.triangles):
            raise ValueError(_why_empty(*box, made.cell))
    return made


def _account(
    output: Path, polygons: Polygons, cell: float, hidden: Unresolved | None, missed: float, folded: int
) -> Account:
    """The account of a written mesh."""
    from sceneql.mesh.measures import euler_and_open_edges, volume_and_area

    vertices, triangles = polygons.vertices, polygons.triangles
    euler, boundary = euler_and_open_edges(triangles)
    volume, area = volume_and_area(vertices, triangles)
    return Account(
        file=output,
        vertices=len(vertices),
        triangles=len(triangles),
        cell=cell,
        euler=euler,
        volume=volume,
        area=area,
        boundary_edges=boundary,
        folded=folded,
        unresolved=0 if hidden is None else hidden.cells,
        unresolved_volume=0.0 if hidden is None else hidden.volume,
        missed=missed,
    )


def _why_empty(tape: Tape, low: Corner, high: Corner, cell: float) -> str:
    """The reason why there is no surface."""
    from sceneql.field.tape.emptiness import nowhere_defined, nowhere_finite, why_empty

    if nowhere_defined(tape, low, high):
        return "its field is nowhere defined in its bounds"
    if why := why_empty(tape, low, high):
        return f"its field is {why} in its bounds, so it has no surface that cells could meet"
    if nowhere_finite(tape, low, high):
        return "its field is nowhere finite in its bounds"
    return f"no surface was met by cells of {cell:g} m; a smaller --cell finds smaller things"


def _object(graph: SimulationGraph, name: str) -> Task:
    """The task of an object. Raises Unsuitable where none is named so."""
    task = graph.tasks.get(name)
    if task is None or not isinstance(task.kind, Object):
        objects = [other for other, found in graph.tasks.items() if isinstance(found.kind, Object)]
        hint = suggestion(name, objects)
        raise Unsuitable(f"no object is named '{name}'" + (f": {hint}" if hint else ""))
    return task


def _solid(shapes: Sequence[Shape], task: Task, name: str, moment: Instant) -> Implicit:
    """An object's field in its box in the world. Raises RunFailure where it has none."""
    with failing_as(name, moment.time, task.span):
        if not shapes:
            raise ValueError("it is empty")
        solid = shapes[0]
        if not isinstance(solid, Implicit) or solid.within is not None:
            raise TypeError(f"`{task.word}` has no inside")
    return solid
